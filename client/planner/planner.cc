/* planner.cc - an arm finds its way among boxes; each edge of it is proved to be free.
 *
 * Plan by RRTConnect with pccd as its judge, and print the states of the path, four joint
 * angles a line. With --edges N, 1 or more: no plan, but so many random edges, each as
 * `free` or `refused`, the angles of its begin and of its end. --seed N, 1 or more: other
 * random numbers.
 */
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/RandomNumbers.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <arm.hpp>
#include <pccd_motion.hpp>

namespace ob = ompl::base;

namespace {

arm::angles angles_of(const ob::State *state)
{
    const double *q = state->as<ob::RealVectorStateSpace::StateType>()->values;
    return {q[0], q[1], q[2], q[3]};
}

class arm_links final : public pccd::links {
public:
    void hang(const ob::State *from, const ob::State *to, pccd::joints &joints,
              std::vector<std::uint32_t> &on) const override
    {
        arm::hang(angles_of(from), angles_of(to), joints);
        on = {1, 2, 3}; // the first joint turns the base
    }
};

void print(const char *word, const ob::State *a, const ob::State *b)
{
    std::printf("%s", word);
    for (const ob::State *state : {a, b}) {
        for (int i = 0; state && i < arm::joints; i++) {
            std::printf(" %.17g", angles_of(state)[static_cast<std::size_t>(i)]);
        }
    }
    std::printf("\n");
}

const char usage[] = "usage: planner [--edges N] [--seed N], N from 1 to 4294967295\n";

// Read a number from 1 to 2^32 - 1; false: `text` is none.
bool take_number(const char *text, long &number)
{
    char *end = nullptr;
    number = std::strtol(text, &end, 10);
    return end != text && *end == '\0' && number >= 1 && number <= 0xffffffffL;
}

// Edges between random states that are free, at most 1 long in each joint.
void print_edges(const ob::SpaceInformationPtr &space, long count)
{
    ompl::RNG random;
    ob::State *a = space->allocState(), *b = space->allocState();
    const auto sampler = space->allocStateSampler();
    for (long i = 0; i < count;) {
        sampler->sampleUniform(a);
        sampler->sampleUniformNear(b, a, 1);
        if (space->isValid(a) && space->isValid(b)) {
            print(space->checkMotion(a, b) ? "free" : "refused", a, b);
            i++;
        }
    }
    space->freeState(a);
    space->freeState(b);
}

} // namespace

int main(int argc, char **argv)
{
    long edges = 0, seed = 1;
    if (argc == 2 && std::strcmp(argv[1], "--help") == 0) {
        std::printf("%s", usage);
        return 0;
    }
    for (int i = 1; i < argc; i += 2) {
        const bool is_edges = std::strcmp(argv[i], "--edges") == 0;
        if ((!is_edges && std::strcmp(argv[i], "--seed") != 0) || i + 1 == argc ||
            !take_number(argv[i + 1], is_edges ? edges : seed)) {
            std::fprintf(stderr, "planner: %s: unknown, or without such a number\n%s",
                         argv[i], usage);
            return 2;
        }
    }
    ompl::msg::setLogLevel(ompl::msg::LOG_WARN);
    ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed));
    try {
        pccd::client client("direct:");
        arm::world world = arm::make_world(client);
        auto space = std::make_shared<ob::RealVectorStateSpace>(arm::joints);
        ob::RealVectorBounds bounds(arm::joints);
        bounds.setLow(-2.6);
        bounds.setHigh(2.6);
        space->setBounds(bounds);
        ompl::geometric::SimpleSetup setup(space);
        const ob::SpaceInformationPtr &info = setup.getSpaceInformation();
        const arm_links robot;
        const auto judge = std::make_shared<pccd::motion_validator>(
            info, robot, world.scene, world.bodies);
        info->setMotionValidator(judge);
        setup.setStateValidityChecker(
            [&judge](const ob::State *state) { return judge->is_free(state); });
        info->setup();
        if (edges > 0) {
            print_edges(info, edges);
            return 0;
        }
        ob::ScopedState<> start(space), goal(space);
        const arm::angles from = {-1.1, .1, .2, .1}, to = {.75, .2, .1, .2};
        for (unsigned i = 0; i < arm::joints; i++) {
            start[i] = from[i];
            goal[i] = to[i];
        }
        setup.setStartAndGoalStates(start, goal);
        auto planner = std::make_shared<ompl::geometric::RRTConnect>(info);
        planner->setRange(.5);
        setup.setPlanner(planner);
        if (setup.solve(10) != ob::PlannerStatus::EXACT_SOLUTION) {
            std::fprintf(stderr, "no path was found\n");
            return 1;
        }
        for (const ob::State *state : setup.getSolutionPath().getStates()) {
            print("path", state, nullptr);
        }
        std::fprintf(stderr, "%zu states in %.3f s; %u edges were free, %u refused\n",
                     setup.getSolutionPath().getStateCount(),
                     setup.getLastPlanComputationTime(), judge->getValidMotionCount(),
                     judge->getInvalidMotionCount());
    } catch (const pccd::error &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
