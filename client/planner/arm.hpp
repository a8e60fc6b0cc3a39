/* arm.hpp - the robot of the example and of its test: an arm of three links and what
 * stands around it.
 *
 * Room:     client/planner; an example. May include: pccd.hpp.
 * Does:     say where the links are for four joint angles, how much their paths bend, and
 *           make the scene. The first joint turns about z, the others about y.
 * Threads:  those of the client.
 */
#ifndef PLANNER_ARM_HPP
#define PLANNER_ARM_HPP

#include <array>
#include <cmath>
#include <vector>

#include <pccd.hpp>

struct arm {
    static constexpr int joints = 4, links = 3;
    static constexpr double length[links] = {.4, .35, .25}, base = .4, half = .03;
    using angles = std::array<double, joints>;
    using matrix = std::array<double, 12>; // rows of [R | t]

    static matrix times(const matrix &a, const matrix &b)
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
    static std::array<matrix, links> place(const angles &q)
    {
        std::array<matrix, links> made;
        double c = std::cos(q[0]), s = std::sin(q[0]), x = 0;
        matrix at = {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, base};
        for (std::size_t i = 0; i < links; i++) {
            c = std::cos(q[i + 1]);
            s = std::sin(q[i + 1]);
            at = times(at, {c, 0, s, x, 0, 1, 0, 0, -s, 0, c, 0});
            made[i] = at;
            x = length[i];
        }
        return made;
    }
    // A point of a link is a sum of vectors p_i, each turned by joints 0 .. i + 1 at the
    // rates w_m: |x''| <= sum of |p_i| (|w_0| + .. + |w_i+1|)^2.
    static double bend(const angles &a, const angles &b, std::size_t link)
    {
        double rate = std::fabs(b[0] - a[0]), sum = 0;
        for (std::size_t i = 0; i <= link; i++) {
            rate += std::fabs(b[i + 1] - a[i + 1]);
            const double wide = i == link ? 2 * half : 0; // more than half a diagonal
            sum += (length[i] + wide) * rate * rate;
        }
        return sum;
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
