/* turns.cc - turns so small that OMPL's SO3 has no states between their ends (TAP). */
#include <ompl/base/spaces/SE3StateSpace.h>

#include <cmath>
#include <cstdio>

#include <arm.hpp>
#include <pccd_motion.hpp>

namespace ob = ompl::base;

namespace {

int count = 0, failed = 0;

void tell(bool is_right, const char *name)
{
    count++;
    failed += !is_right;
    std::printf("%sok %d - %s\n", is_right ? "" : "not ", count, name);
}

using so3 = ob::SO3StateSpace::StateType;
using se3 = ob::SE3StateSpace::StateType;

class bar final : public pccd::links {
public:
    explicit bar(bool has_place) : has_place_(has_place) {}
    const so3 &turn(const ob::State *state) const
    {
        return has_place_ ? state->as<se3>()->rotation() : *state->as<so3>();
    }
    // About z alone.
    static double angle(const so3 &q) { return 2 * std::atan2(q.z, q.w); }
    void place(const ob::State *state, std::vector<pccd::pose> &poses) const override
    {
        const double a = angle(turn(state)), c = std::cos(a), s = std::sin(a);
        const double z = has_place_ ? state->as<se3>()->getZ() : 0;
        poses = {{{c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, z}}};
    }
    double bend(const ob::State *from, const ob::State *to, std::size_t) const override
    {
        const double way = angle(turn(to)) - angle(turn(from));
        return 10.1 * way * way;
    }
    double size() const override { return 11; }

private:
    bool has_place_;
};

struct plate {
    pccd::client client{"direct:"};
    pccd::scene scene = client.make_scene();
    std::vector<pccd::object> bodies, obstacles;
    plate()
    {
        const std::vector<double> x = {0, 0, 0, 10, 0, 0, 10, 0, .1};
        const std::vector<std::uint32_t> face = {0, 1, 2};
        bodies.push_back(scene.add(client.make_mesh({x, face})));
        obstacles.push_back(scene.add(arm::box(client, {9, .0004, -1}, {9.5, .0006, 1})));
    }
};

// Is the turn by `angle` called free? In SE3 with a way of `rise` along the plate.
bool is_free(plate &world, bool has_place, double angle, double rise, unsigned pieces)
{
    const auto se3_space = std::make_shared<ob::SE3StateSpace>();
    ob::RealVectorBounds bounds(3);
    bounds.setLow(-1);
    bounds.setHigh(1);
    se3_space->setBounds(bounds);
    const ob::StateSpacePtr space =
        has_place ? ob::StateSpacePtr(se3_space) : std::make_shared<ob::SO3StateSpace>();
    const auto info = std::make_shared<ob::SpaceInformation>(space);
    const bar robot(has_place);
    const pccd::motion_validator judge(info, robot, world.scene, world.bodies, pieces);
    ob::State *ends[2];
    for (int i = 0; i < 2; i++) {
        ends[i] = info->allocState();
        if (has_place) {
            ends[i]->as<se3>()->setXYZ(0, 0, i * rise);
        }
        so3 &q = has_place ? ends[i]->as<se3>()->rotation() : *ends[i]->as<so3>();
        q.setAxisAngle(0, 0, 1, i * angle);
    }
    const bool is_free = judge.checkMotion(ends[0], ends[1]);
    std::pair<ob::State *, double> last = {nullptr, -1};
    if (judge.checkMotion(ends[0], ends[1], last) != is_free ||
        (is_free ? last.second != -1 : !(last.second >= 0 && last.second < 1))) {
        std::printf("# %g: it says otherwise of where it ends\n", angle);
        failed++;
    }
    for (ob::State *end : ends) {
        info->freeState(end);
    }
    return is_free;
}

} // namespace

int main()
{
    try {
        plate world;
        bool are_refused = true, are_free = true;
        for (const bool has_place : {false, true}) {
            for (const double angle : {7e-5, 8e-5, 8.9e-5, 8.95e-5, 9e-5, 1e-4, .01}) {
                for (const double rise : {0., .2}) {
                    for (const unsigned pieces : {1u, 2u, 16u}) {
                        are_refused &= !is_free(world, has_place, angle, rise, pieces);
                        are_free &= is_free(world, has_place, -angle, rise, pieces);
                    }
                }
            }
        }
        tell(are_refused, "small_turns__through_a_plate_are_refused");
        tell(are_free, "small_turns__away_from_it_are_free");
    } catch (const pccd::error &error) {
        std::printf("Bail out! %s\n", error.what());
        return 1;
    }
    std::printf("1..%d\n", count);
    return failed != 0;
}
