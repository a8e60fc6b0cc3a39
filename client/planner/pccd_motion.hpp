/* pccd_motion.hpp - pccd for planners of OMPL: an edge is called free only if that is
 * proved.
 *
 * Room:     client/planner; installed. May include: pccd.hpp, OMPL, the standard
 *           library. C++17; nothing is compiled until a program includes it.
 * Does:     cut a motion into k pieces and test the straight piece between both ends of
 *           each; the last one ends at the state that is given. Every link is thicker by
 *           so much as its true path may leave the chord.
 * Does not: look for the first contact, or halve pieces: one that is not proved to be
 *           free is refused. An edge is taken to begin where nothing intersects, as OMPL
 *           does; is_free asks that of a state. Links and obstacles are surfaces: what is
 *           wholly inside a closed one meets nothing.
 * Threads:  those of the client of its scene: one at a time.
 * Source:   a point whose path x(t), t = 0 .. 1, has |x''| <= a is at most a / (8 k^2)
 *           off the chord of a piece: the error of linear interpolation.
 */
#ifndef PCCD_MOTION_HPP
#define PCCD_MOTION_HPP

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>

#include <cmath>
#include <vector>

#include <pccd.hpp>

namespace pccd {

// Rows of [R | t], as pccd_frame_rigid says.
struct pose {
    double m[12];
};

// A robot of rigid links: what the validator has to know of it.
class links {
public:
    virtual ~links() = default;
    // Where each link is in a state; as many as the validator has bodies.
    virtual void place(const ompl::base::State *state,
                       std::vector<pose> &poses) const = 0;
    // At least |x''| of each point x of a link, on the whole way that the state space
    // interpolates between the two, over which t goes from 0 to 1. A body that turns by
    // theta about a fixed axis: theta^2 times the distance of its farthest point.
    virtual double bend(const ompl::base::State *from, const ompl::base::State *to,
                        std::size_t link) const = 0;
    // At least the greatest coordinate that a point of it ever has.
    virtual double size() const = 0;
};

class motion_validator : public ompl::base::MotionValidator {
public:
    // `bodies` are the links in `world`, in the order of `robot`. Which of them may meet
    // is the scene's. All are referred to, and have to stay.
    motion_validator(const ompl::base::SpaceInformationPtr &space, const links &robot,
                     scene &world, std::vector<object> &bodies, unsigned pieces)
        : MotionValidator(space), robot_(robot), world_(world), bodies_(bodies),
          pieces_(pieces)
    {
    }

    // True: proved to be free, as `from` is. False: something meets, or might.
    bool checkMotion(const ompl::base::State *from,
                     const ompl::base::State *to) const override
    {
        const bool is_free = free_pieces(from, to) == pieces_;
        ++(is_free ? valid_ : invalid_);
        return is_free;
    }
    // The same; of a motion that is refused also how far it is proved to be free.
    bool checkMotion(const ompl::base::State *from, const ompl::base::State *to,
                     std::pair<ompl::base::State *, double> &last) const override
    {
        const unsigned count = free_pieces(from, to);
        ++(count == pieces_ ? valid_ : invalid_);
        if (count < pieces_) {
            last.second = double(count) / pieces_;
            if (last.first) {
                si_->getStateSpace()->interpolate(from, to, last.second, last.first);
            }
        }
        return count == pieces_;
    }
    // For OMPL's StateValidityChecker. An edge that goes through the inside of a face
    // meets nothing as long as neither moves, so a step alone would not do.
    bool is_free(const ompl::base::State *state) const
    {
        robot_.place(state, before_);
        after_ = before_;
        thicken(nullptr, nullptr, 1);
        if (!is_piece_free()) {
            return false;
        }
        const answer crossed = world_.near(near_settings(PCCD_NEAR_CROSSINGS));
        return crossed.is_complete() && crossed->verdict == PCCD_VERDICT_NO;
    }

private:
    // Sines, products and sums of poses and positions are off by less than 2^-41 of the
    // size, and so is what is nearly the end; the bound is multiplied by more than its own
    // rounding.
    void thicken(const ompl::base::State *from, const ompl::base::State *to,
                 unsigned pieces) const
    {
        for (std::size_t i = 0; i < bodies_.size(); i++) {
            const double bend = from ? robot_.bend(from, to, i) : 0;
            bodies_[i].set_radius(bend / (8. * pieces * pieces) * (1 + 0x1p-40) +
                                  0x1p-40 * robot_.size());
        }
    }
    bool is_piece_free() const
    {
        motions_.clear();
        for (std::size_t i = 0; i < bodies_.size(); i++) {
            motions_.push_back(rigid(bodies_[i], before_[i].m, after_[i].m));
        }
        step_settings settings;
        settings.mode = PCCD_MODE_ANY;
        const answer found = world_.step(motions_, settings);
        return found.is_complete() && found->verdict == PCCD_VERDICT_NO;
    }
    // Are the links in after_ nearly where they are at the end?
    bool is_nearly_end() const
    {
        for (std::size_t i = 0; i < end_.size(); i++) {
            for (std::size_t k = 0; k < 12; k++) {
                const double unit = k % 4 == 3 ? robot_.size() : 1;
                if (!(std::fabs(after_[i].m[k] - end_[i].m[k]) <= 0x1p-44 * unit)) {
                    return false;
                }
            }
        }
        return true;
    }
    // Of pieces_: so many are free, from the begin on. A space that turns less than it
    // should (SO3 of OMPL stays at `from`, up to 8.9e-5 rad) has no states on the way; the
    // motion is one piece then, from the one given state to the other.
    unsigned free_pieces(const ompl::base::State *from, const ompl::base::State *to) const
    {
        ompl::base::State *at = si_->allocState();
        robot_.place(to, end_);
        si_->getStateSpace()->interpolate(from, to, 1, at);
        robot_.place(at, after_);
        const unsigned count = is_nearly_end() ? pieces_ : 1;
        thicken(from, to, count);
        robot_.place(from, before_);
        unsigned i = 0;
        for (; i < count; i++) {
            if (i + 1 < count) {
                si_->getStateSpace()->interpolate(from, to, double(i + 1) / count, at);
                robot_.place(at, after_);
            } else {
                after_ = end_;
            }
            if (!is_piece_free()) {
                break;
            }
            before_.swap(after_);
        }
        si_->freeState(at);
        return i == count ? pieces_ : i;
    }

    const links &robot_;
    scene &world_;
    std::vector<object> &bodies_;
    unsigned pieces_;
    mutable std::vector<pose> before_, after_, end_;
    mutable std::vector<pccd_motion> motions_;
};

} // namespace pccd

#endif
