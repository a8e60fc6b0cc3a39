/* pccd_motion.hpp - pccd for planners of OMPL: an edge is called free only if that is
 * proved.
 *
 * Room:     client/planner; installed. May include: pccd.hpp, OMPL, the standard
 *           library. C++17; nothing is compiled until a program includes it.
 * Does:     ask of an edge by one step, in which the links hang on the joints that the
 *           robot says for its two states: along the curve, from one to the other.
 * Does not: interpolate states, but for the last one that is free. An edge is taken to
 *           begin where nothing intersects, as OMPL does; is_free asks that of a state.
 *           Links and obstacles are surfaces: what is wholly inside a closed one meets
 *           nothing.
 * Threads:  those of the client of its scene: one at a time.
 */
#ifndef PCCD_MOTION_HPP
#define PCCD_MOTION_HPP

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/util/Console.h>

#include <cmath>
#include <vector>

#include <pccd.hpp>

namespace pccd {

// Where an angle ends that goes from `from` the shorter way, as OMPL's SO2 interpolates:
// at `to`, or a turn (to the last bit of 2 pi) before or after it.
inline double shorter(double from, double to)
{
    constexpr double half = 3.14159265358979323846;
    return std::fabs(to - from) <= half ? to : to > from ? to - 2 * half : to + 2 * half;
}
inline pccd_pose pose_of(const ompl::base::SO3StateSpace::StateType &q)
{
    return {{0, 0, 0}, {q.x, q.y, q.z, q.w}};
}
inline pccd_pose pose_of(const ompl::base::SE3StateSpace::StateType &state)
{
    pccd_pose pose = pose_of(state.rotation());
    pose.position[0] = state.getX();
    pose.position[1] = state.getY();
    pose.position[2] = state.getZ();
    return pose;
}

// A robot of rigid links: what the validator has to know of it.
class links {
public:
    virtual ~links() = default;
    // Add the joints of the motion between two states, with the values of one and of the
    // other; set on[i] to that on which body i hangs. What throws PCCD_E_INVAL, as
    // joints::poses does near half a turn, whose way only rounding would choose, is an
    // edge that is refused.
    virtual void hang(const ompl::base::State *from, const ompl::base::State *to,
                      joints &joints, std::vector<std::uint32_t> &on) const = 0;
    // Set `at` to where that motion is at t.
    virtual void interpolate(const ompl::base::StateSpace &space,
                             const ompl::base::State *from, const ompl::base::State *to,
                             double t, ompl::base::State *at) const
    {
        space.interpolate(from, to, t, at);
    }
};

// The robot of an SE3StateSpace: a body that flies. It goes straight, and turns at
// constant speed the shorter way.
class flying final : public links {
public:
    void hang(const ompl::base::State *from, const ompl::base::State *to, joints &joints,
              std::vector<std::uint32_t> &on) const override
    {
        on.assign(on.size(), joints.poses(pose_of(*from->as<state>()),
                                          pose_of(*to->as<state>())));
    }
    // OMPL does not turn by less than 8.9e-5 radians: there the quaternion goes straight.
    void interpolate(const ompl::base::StateSpace &space, const ompl::base::State *from,
                     const ompl::base::State *to, double t,
                     ompl::base::State *at) const override
    {
        const pccd_pose a = pose_of(*from->as<state>()), b = pose_of(*to->as<state>());
        double dot = 0, q[4];
        for (int i = 0; i < 4; i++) {
            dot += a.rotation[i] * b.rotation[i];
        }
        for (int i = 0; i < 4; i++) {
            const double end = dot < 0 ? -b.rotation[i] : b.rotation[i];
            q[i] = a.rotation[i] + t * (end - a.rotation[i]);
        }
        space.interpolate(from, to, t, at);
        if (std::fabs(dot) > 1 - 2e-9) {
            auto &turn = at->as<state>()->rotation();
            turn.x = q[0];
            turn.y = q[1];
            turn.z = q[2];
            turn.w = q[3];
        }
    }

private:
    using state = ompl::base::SE3StateSpace::StateType;
};

class motion_validator : public ompl::base::MotionValidator {
public:
    // `bodies` are the links in `world`, in the order of `robot`. Which of them may meet
    // is the scene's. They keep farther than `clearance` from all that they may meet; an
    // obstacle that is tested against itself and thinner meets itself. All are referred
    // to, and have to stay.
    motion_validator(const ompl::base::SpaceInformationPtr &space, const links &robot,
                     scene &world, const std::vector<object> &bodies,
                     double clearance = 0)
        : MotionValidator(space), robot_(robot), world_(world), bodies_(bodies),
          on_(bodies.size())
    {
        settings_.separation = clearance;
    }

    // True: proved to be free, as `from` is. False: something meets, or might.
    bool checkMotion(const ompl::base::State *from,
                     const ompl::base::State *to) const override
    {
        return count(free_part(from, to, PCCD_MODE_ANY));
    }
    // The same; of a motion that is refused also how far it is proved to be free.
    bool checkMotion(const ompl::base::State *from, const ompl::base::State *to,
                     std::pair<ompl::base::State *, double> &last) const override
    {
        const double part = free_part(from, to, PCCD_MODE_FIRST);
        if (part < 1) {
            last.second = part;
            if (last.first) {
                robot_.interpolate(*si_->getStateSpace(), from, to, part, last.first);
            }
        }
        return count(part);
    }
    // For OMPL's StateValidityChecker. An edge that goes through the inside of a face
    // meets nothing as long as neither moves, so a step alone would not do.
    bool is_free(const ompl::base::State *state) const
    {
        if (free_part(state, state, PCCD_MODE_ANY) < 1) {
            return false;
        }
        const answer crossed = world_.near(near_settings(PCCD_NEAR_CROSSINGS));
        return crossed.is_complete() && crossed->verdict == PCCD_VERDICT_NO;
    }

private:
    bool count(double part) const
    {
        ++(part == 1 ? valid_ : invalid_);
        return part == 1;
    }
    // Up to this t nothing meets; mode any: 1, or it is not proved.
    double free_part(const ompl::base::State *from, const ompl::base::State *to,
                     pccd_mode mode) const
    {
        joints_.all().clear();
        try {
            robot_.hang(from, to, joints_, on_);
        } catch (const error &why) {
            if (why.status() != PCCD_E_INVAL) {
                throw;
            }
            OMPL_WARN("pccd refuses a motion: %s", why.what());
            return 0;
        }
        motions_.clear();
        for (std::size_t i = 0; i < bodies_.size(); i++) {
            motions_.push_back(turning(bodies_[i], on_.at(i)));
        }
        settings_.mode = mode;
        return world_.step(motions_, joints_.with(settings_))->safe_step;
    }

    const links &robot_;
    scene &world_;
    const std::vector<object> &bodies_;
    mutable step_settings settings_;
    mutable joints joints_;
    mutable std::vector<std::uint32_t> on_;
    mutable std::vector<pccd_motion> motions_;
};

} // namespace pccd

#endif
