/* falling.cc - a body that falls on a floor, in C++: how to begin. */
#include <array>
#include <cstdio>
#include <vector>

#include <pccd.hpp>

using point = std::array<float, 3>;

static std::vector<point> lowered(std::vector<point> x, float by)
{
    for (point &p : x) {
        p[2] -= by;
    }
    return x;
}

int main()
{
    const std::vector<point> floor_x = {
        {{-9, -9, 0}}, {{9, -9, 0}}, {{9, 9, 0}}, {{-9, 9, 0}}};
    const std::vector<std::uint32_t> floor_faces = {0, 1, 2, 0, 2, 3};
    std::vector<point> x = {{{0, 0, 2}}, {{1, 0, 3}}, {{0, 1, 3}}, {{-1, -1, 3}}};
    const std::vector<std::uint32_t> faces = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};

    try {
        pccd::options options;
        options.private_daemon = true; // of our own; without this line: the user's daemon
        pccd::client client(options);
        pccd::scene scene = client.make_scene();
        pccd::mesh floor_mesh = client.make_mesh({floor_x, floor_faces});
        pccd::mesh body_mesh = client.make_mesh({x, faces});
        pccd::object floor = scene.add(floor_mesh);
        pccd::object body = scene.add(body_mesh);
        for (int frame = 0; frame < 9; frame++) {
            const std::vector<point> next = lowered(x, 0.3f);
            std::vector<point> safe(x.size());
            void *const ends[] = {safe.data()};
            const pccd_motion motion = pccd::between(body, x, next);
            double part = 0;
            pccd::answer answer = scene.step_safe({&motion, 1}, ends, part);
            for (const pccd_contact &contact : answer.contacts()) {
                std::printf("frame %d: %s %u meets %u at t = %.4f\n", frame,
                            contact.kind == PCCD_VF ? "vertex" : "edge",
                            contact.feature_a, contact.feature_b, contact.toi);
            }
            x = safe;
            if (part < 1) {
                std::printf("the lowest point is %g above the floor\n",
                            static_cast<double>(x[0][2]));
                return x[0][2] > 0 ? 0 : 1;
            }
        }
    } catch (const pccd::error &error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}
