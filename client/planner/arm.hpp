/* arm.hpp - the robot of the example and of its test: an arm of three links and what
 * stands around it.
 *
 * Room:     client/planner; an example. May include: pccd.hpp.
 * Does:     say the joints for four angles, and make the scene. The first joint turns
 *           about z, the others about y.
 * Threads:  those of the client.
 */
#ifndef PLANNER_ARM_HPP
#define PLANNER_ARM_HPP

#include <array>
#include <vector>

#include <pccd.hpp>

struct arm {
    static constexpr int joints = 4, links = 3;
    static constexpr double length[links] = {.4, .35, .25}, base = .4, half = .03;
    using angles = std::array<double, joints>;

    // The joints of a motion from a to b; link i hangs on joint i + 1.
    static void hang(const angles &a, const angles &b, pccd::joints &chain)
    {
        for (std::size_t i = 0; i < a.size(); i++) {
            pccd_joint joint{};
            joint.kind = PCCD_JOINT_TURN;
            joint.parent = i == 0 ? PCCD_NO_JOINT : static_cast<std::uint32_t>(i - 1);
            joint.position[0] = i < 2 ? 0 : length[i - 2];
            joint.position[2] = i == 0 ? base : 0;
            joint.rotation[3] = 1;
            joint.axis[i == 0 ? 2 : 1] = 1;
            joint.from[0] = a[i];
            joint.to[0] = b[i];
            chain.add(joint);
        }
    }

    static pccd::mesh box(pccd::client &client, const std::array<double, 3> &low,
                          const std::array<double, 3> &high)
    {
        std::vector<double> x;
        for (unsigned i = 0; i < 8; i++) {
            for (unsigned k = 0; k < 3; k++) {
                x.push_back(i >> k & 1 ? high[k] : low[k]);
            }
        }
        const std::vector<std::uint32_t> faces = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6,
                                                  0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7,
                                                  0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
        return client.make_mesh({x, faces});
    }
    // The links of the arm; obstacles stay in the scene.
    struct world {
        pccd::scene scene;
        std::vector<pccd::object> bodies, obstacles;
    };
    static world make_world(pccd::client &client)
    {
        world made = {client.make_scene(), {}, {}};
        pccd::object_settings settings; // groups: 1 links, 2 obstacles
        settings.what = PCCD_OBJECT_GROUP | PCCD_OBJECT_MASK | PCCD_OBJECT_SELF;
        settings.group = 1;
        settings.mask = 3;
        for (const double reach : length) { // a gap for the joint
            made.bodies.push_back(
                made.scene.add(box(client, {half, -half, -half}, {reach, half, half})));
            made.bodies.back().set(settings);
        }
        made.scene.ignore(made.bodies[0], made.bodies[1]); // joined
        made.scene.ignore(made.bodies[1], made.bodies[2]);
        settings.group = 2;
        settings.mask = 1;
        const std::array<double, 3> boxes[][2] = {
            {{-1, -1, -.1}, {1, 1, 0}},       // a floor,
            {{.45, -.1, 0}, {.6, .1, .85}},   // a pillar between start and goal,
            {{-.7, -.9, .9}, {.9, -.2, .95}}, // a shelf over the start
            {{.2, .72, .1}, {.7, .8, .45}}};  // and a wall behind the goal
        for (const auto &[low, high] : boxes) {
            made.obstacles.push_back(made.scene.add(box(client, low, high)));
            made.obstacles.back().set(settings);
        }
        return made;
    }
};

#endif
