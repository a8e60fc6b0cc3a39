/* check.cc - are edges that the planner calls free really so? By dense samples and exact
 * tests (TAP).
 *
 * Read the planner's lines; place the arm at many states of each edge and ask which edges
 * pass through or touch faces there. Knows nothing of joints, nor of OMPL.
 */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <arm.hpp>

namespace {

int count = 0, failed = 0;

void tell(bool is_right, const char *name)
{
    count++;
    failed += !is_right;
    std::printf("%sok %d - %s\n", is_right ? "" : "not ", count, name);
}

using matrix = std::array<double, 12>; // rows of [R | t]

matrix times(const matrix &a, const matrix &b)
{
    matrix c{};
    for (std::size_t i = 0; i < 3; i++) {
        for (std::size_t k = 0; k < 4; k++) {
            for (std::size_t j = 0; j < 3; j++) {
                c[4 * i + k] += a[4 * i + j] * b[4 * j + k];
            }
        }
        c[4 * i + 3] += a[4 * i + 3];
    }
    return c;
}
std::array<matrix, arm::links> place(const arm::angles &q)
{
    std::array<matrix, arm::links> made;
    double c = std::cos(q[0]), s = std::sin(q[0]), x = 0;
    matrix at = {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, arm::base};
    for (std::size_t i = 0; i < arm::links; i++) {
        c = std::cos(q[i + 1]);
        s = std::sin(q[i + 1]);
        at = times(at, {c, 0, s, x, 0, 1, 0, 0, -s, 0, c, 0});
        made[i] = at;
        x = arm::length[i];
    }
    return made;
}

struct judge {
    pccd::client client{"direct:"};
    arm::world world = arm::make_world(client);

    bool is_free(const arm::angles &q)
    {
        const auto placed = place(q);
        double m[arm::links][12];
        std::vector<pccd_motion> motions;
        for (std::size_t i = 0; i < placed.size(); i++) {
            std::memcpy(m[i], placed[i].data(), sizeof m[i]);
            motions.push_back(pccd::rigid(world.bodies[i], m[i], m[i]));
        }
        const pccd::near_settings settings(PCCD_NEAR_CROSSINGS);
        return world.scene.near(settings, motions)->verdict == PCCD_VERDICT_NO;
    }
    bool is_free(const arm::angles &a, const arm::angles &b, int samples)
    {
        bool is_free_everywhere = true;
        for (int i = 0; i <= samples && is_free_everywhere; i++) {
            arm::angles q;
            for (std::size_t k = 0; k < q.size(); k++) {
                q[k] = a[k] + (b[k] - a[k]) * i / samples;
            }
            is_free_everywhere = is_free(q);
        }
        return is_free_everywhere;
    }
};

bool read(arm::angles &q)
{
    bool is_read = true;
    for (double &angle : q) {
        is_read &= std::scanf("%lf", &angle) == 1;
    }
    return is_read;
}

} // namespace

int main(int argc, char **argv)
{
    const int samples = argc > 1 ? std::atoi(argv[1]) : 1000;
    long path = 0, blocked = 0, said_free = 0, wrong = 0, refused = 0, wasted = 0;
    bool is_read = true;
    try {
        judge judge;
        arm::angles last{}, a, b;
        char word[16];
        while (is_read && std::scanf("%15s", word) == 1) {
            is_read = read(a);
            if (std::strcmp(word, "path") == 0) {
                blocked += path++ > 0 && !judge.is_free(last, a, samples);
                last = a;
                continue;
            }
            is_read &= read(b);
            const bool is_free = judge.is_free(a, b, samples);
            if (std::strcmp(word, "free") == 0) {
                said_free++;
                wrong += !is_free;
            } else {
                refused++;
                wasted += is_free;
            }
        }
        // It would be caught if the arm stood in the pillar.
        tell(is_read && !judge.is_free({0, .1, 0, 0}), "samples__see_the_pillar");
    } catch (const pccd::error &error) {
        std::printf("Bail out! %s\n", error.what());
        return 1;
    }
    if (path > 0) {
        std::printf("# %ld states\n", path);
        tell(path > 2 && blocked == 0, "path__is_free_at_every_sample");
    } else {
        std::printf("# %ld free; %ld refused, of which %ld are free at every sample\n",
                    said_free, refused, wasted);
        tell(said_free > 0 && wrong == 0, "free_edges__are_free_at_every_sample");
        tell(refused > wasted, "refused_edges__meet_something");
    }
    std::printf("1..%d\n", count);
    return failed != 0;
}
