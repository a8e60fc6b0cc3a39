/* turns.cc - bodies of OMPL's SO3, SE3 and SO2 against what is thin (TAP).
 *
 * SO3 has no states between the ends of turns below 8.9e-5 radians.
 */
#include <ompl/base/spaces/SO2StateSpace.h>
#include <ompl/util/RandomNumbers.h>

#include <cmath>
#include <cstdio>

#include <arm.hpp>
#include <pccd_motion.hpp>

namespace ob = ompl::base;

namespace {

constexpr double pi = 3.14159265358979323846;
int count = 0, failed = 0;

void tell(bool is_right, const char *name)
{
    count++;
    failed += !is_right;
    std::printf("%sok %d - %s\n", is_right ? "" : "not ", count, name);
}

using so2 = ob::SO2StateSpace::StateType;
using so3 = ob::SO3StateSpace::StateType;
using se3 = ob::SE3StateSpace::StateType;

class turning_in_so3 final : public pccd::links {
public:
    void hang(const ob::State *from, const ob::State *to, pccd::joints &joints,
              std::vector<std::uint32_t> &on) const override
    {
        on = {joints.poses(pccd::pose_of(*from->as<so3>()),
                           pccd::pose_of(*to->as<so3>()))};
    }
};

class turning_in_so2 final : public pccd::links {
public:
    void hang(const ob::State *from, const ob::State *to, pccd::joints &joints,
              std::vector<std::uint32_t> &on) const override
    {
        const double a = from->as<so2>()->value, b = to->as<so2>()->value;
        pccd_joint joint{};
        joint.kind = PCCD_JOINT_TURN;
        joint.parent = PCCD_NO_JOINT;
        joint.rotation[3] = joint.axis[2] = 1;
        joint.from[0] = a;
        joint.to[0] = pccd::shorter(a, b);
        on = {joints.add(joint)};
    }
};

// A blade of length 10 along x at angle 0, and a plate beside its end.
struct world {
    pccd::client client{"direct:"};
    pccd::scene scene = client.make_scene();
    std::vector<pccd::object> bodies, obstacles;
    explicit world(double low, double high)
    {
        const std::vector<double> x = {0, 0, 0, 10, 0, 0, 10, 0, .1};
        const std::vector<std::uint32_t> face = {0, 1, 2};
        bodies.push_back(scene.add(client.make_mesh({x, face})));
        obstacles.push_back(scene.add(arm::box(client, {9, low, -1}, {9.5, high, 1})));
        pccd::object_settings settings; // none against itself
        settings.what = PCCD_OBJECT_SELF;
        bodies[0].set(settings);
        obstacles[0].set(settings);
    }
};

enum kind { SO2, SO3, SE3 };

class judge {
public:
    judge(world &world, kind kind, double clearance = 0) : kind_(kind)
    {
        ob::StateSpacePtr space;
        if (kind == SE3) {
            const auto made = std::make_shared<ob::SE3StateSpace>();
            ob::RealVectorBounds bounds(3);
            bounds.setLow(-1);
            bounds.setHigh(1);
            made->setBounds(bounds);
            space = made;
        } else if (kind == SO3) {
            space = std::make_shared<ob::SO3StateSpace>();
        } else {
            space = std::make_shared<ob::SO2StateSpace>();
        }
        info_ = std::make_shared<ob::SpaceInformation>(space);
        const pccd::links &robot = kind == SE3   ? static_cast<const pccd::links &>(se3_)
                                   : kind == SO3 ? static_cast<const pccd::links &>(so3_)
                                                 : so2_;
        judge_ = std::make_unique<pccd::motion_validator>(info_, robot, world.scene,
                                                          world.bodies, clearance);
        for (ob::State *&state : states_) {
            state = info_->allocState();
        }
    }
    judge(const judge &) = delete;
    judge &operator=(const judge &) = delete;
    ~judge()
    {
        for (ob::State *state : states_) {
            info_->freeState(state);
        }
    }
    // Is the turn about z between two angles called free? In SE3 it rises by `rise`.
    bool is_free(double from, double to, double rise = 0)
    {
        set(states_[0], from, 0);
        set(states_[1], to, rise);
        const bool is_free = judge_->checkMotion(states_[0], states_[1]);
        last.second = -1;
        last.first = states_[2];
        if (judge_->checkMotion(states_[0], states_[1], last) != is_free ||
            (is_free ? last.second != -1 : !(last.second >= 0 && last.second < 1))) {
            std::printf("# %g to %g: it says otherwise of where it ends\n", from, to);
            failed++;
        }
        return is_free;
    }
    bool is_last_free() const
    {
        return judge_->is_free(last.first) &&
               judge_->checkMotion(states_[0], last.first);
    }
    bool is_last_at(double angle) const
    {
        const so3 &q = last.first->as<se3>()->rotation();
        return std::fabs(2 * std::atan2(q.z, q.w) - angle) < 1e-9;
    }
    std::pair<ob::State *, double> last = {nullptr, -1};

private:
    void set(ob::State *state, double angle, double rise) const
    {
        if (kind_ == SO2) {
            state->as<so2>()->value = angle;
            return;
        }
        if (kind_ == SE3) {
            state->as<se3>()->setXYZ(0, 0, rise);
        }
        so3 &q = kind_ == SE3 ? state->as<se3>()->rotation() : *state->as<so3>();
        q.setAxisAngle(0, 0, 1, angle);
    }

    kind kind_;
    pccd::flying se3_;
    turning_in_so3 so3_;
    turning_in_so2 so2_;
    ob::SpaceInformationPtr info_;
    std::unique_ptr<pccd::motion_validator> judge_;
    ob::State *states_[3];
};

// If it failed, a body could turn through what is thin, by less than OMPL interpolates.
void check_small_turns()
{
    bool are_refused = true, are_free = true, are_ends_right = true;
    world plate(.0004, .0006); // from 4e-5 radians on
    for (const kind kind : {SO2, SO3, SE3}) {
        judge judge(plate, kind);
        for (const double angle : {7e-5, 8e-5, 8.9e-5, 8.95e-5, 9e-5, 1e-4, .01}) {
            for (const double rise : {0., .2}) {
                are_refused &= !judge.is_free(0, angle, rise);
                const double met = judge.last.second * angle;
                are_ends_right &= met > 4e-5 && met < 4.5e-5 && judge.is_last_free() &&
                                  (kind != SE3 || judge.is_last_at(met));
                are_free &= judge.is_free(0, -angle, rise);
            }
        }
    }
    tell(are_refused, "small_turns__through_a_plate_are_refused");
    tell(are_ends_right, "small_turns__are_free_up_to_the_plate");
    tell(are_free, "small_turns__away_from_it_are_free");
}

// If it failed, what no step of samples sees would be called free.
void check_thin()
{
    bool are_refused = true, are_free = true;
    world foil(2, 2 + 1e-9);
    for (const kind kind : {SO2, SO3, SE3}) {
        judge judge(foil, kind);
        for (const double angle : {.3, 1., 2., 3.}) {
            are_refused &= !judge.is_free(0, angle);
            are_free &= judge.is_free(0, -angle);
        }
    }
    tell(are_refused, "foil__is_found");
    tell(are_free, "foil__behind_is_not_met");
}

// If it failed, SO2 would be proved the other way round than OMPL goes.
void check_ways()
{
    world plate(.4, .6); // at 2.5 to 4 degrees
    judge flat(plate, SO2), body(plate, SE3);
    tell(flat.is_free(-3, 3) && flat.is_free(3, -3) && !flat.is_free(-1.5, 1.5) &&
             flat.last.second > .5 && flat.is_free(1.5, pi),
         "so2__turns_the_shorter_way");
    tell(!body.is_free(0, -pi) && body.last.second == 0 && body.is_free(0, 1e-5 - pi),
         "half_a_turn__is_refused");
}

// If it failed, links would come nearer than they may, or could not come as near.
void check_clearance()
{
    world plate(2, 2.1);
    judge near(plate, SO2, 1.999), far(plate, SO2, 2.001);
    tell(near.is_free(0, -.3) && !near.is_free(0, .01) && !far.is_free(0, -.3),
         "clearance__is_kept");
}

// If it failed, a body that flies could be called free where it meets something, or its
// last free state would not be one.
void check_flights()
{
    pccd::client client("direct:");
    arm::world world = arm::make_world(client);
    world.bodies.erase(world.bodies.begin() + 1, world.bodies.end());
    const auto space = std::make_shared<ob::SE3StateSpace>();
    ob::RealVectorBounds bounds(3);
    bounds.setLow(-1);
    bounds.setHigh(1);
    space->setBounds(bounds);
    const auto info = std::make_shared<ob::SpaceInformation>(space);
    const pccd::flying robot;
    const pccd::motion_validator judge(info, robot, world.scene, world.bodies);
    ob::State *a = info->allocState(), *b = info->allocState(), *at = info->allocState();
    const auto sampler = info->allocStateSampler();
    int free = 0, refused = 0, wrong = 0, wasted = 0, lasting = 0;
    while (free + refused < 300) {
        sampler->sampleUniform(a);
        sampler->sampleUniformNear(b, a, 2);
        if (!judge.is_free(a) || !judge.is_free(b)) {
            continue;
        }
        std::pair<ob::State *, double> end = {at, 1};
        const bool is_free = judge.checkMotion(a, b, end);
        if (!is_free) {
            lasting += judge.is_free(at) && judge.checkMotion(a, at);
        }
        bool is_hit = false;
        for (int i = 1; i < 200 && !is_hit; i++) {
            space->interpolate(a, b, i / 200., at);
            is_hit = !judge.is_free(at);
        }
        ++(is_free ? free : refused);
        wrong += is_free && is_hit;
        wasted += !is_free && !is_hit;
    }
    for (ob::State *state : {a, b, at}) {
        info->freeState(state);
    }
    std::printf("# %d free; %d refused, of which %d are free at every sample\n", free,
                refused, wasted);
    tell(free > 0 && wrong == 0 && wasted * 10 < refused,
         "flights__are_what_samples_say");
    tell(lasting == refused, "flights__are_free_to_their_last_states");
}

} // namespace

int main()
{
    ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);
    ompl::RNG::setSeed(1);
    try {
        check_small_turns();
        check_thin();
        check_ways();
        check_clearance();
        check_flights();
    } catch (const pccd::error &error) {
        std::printf("Bail out! %s\n", error.what());
        return 1;
    }
    std::printf("1..%d\n", count);
    return failed != 0;
}
