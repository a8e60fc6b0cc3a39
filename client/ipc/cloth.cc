/* cloth.cc - an implicit cloth that falls on a ball, by ipc-toolkit with its broad phase
 * and with ours, side by side.
 *
 * Solve each step twice, from the same positions: once with ipc-toolkit's LBVH and
 * additive CCD, once with pccd, whose solution goes on. Each minimises the incremental
 * potential of Li et al. 2020 (masses, springs, barriers) by projected Newton with a line
 * search. Tell how long each part took.
 */
#include <ipc/barrier/barrier.hpp>
#include <ipc/ccd/additive_ccd.hpp>
#include <ipc/collisions/normal/normal_collisions.hpp>
#include <ipc/utils/logger.hpp>
#include <tbb/global_control.h>

#include <Eigen/SparseCholesky>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>

#include <pccd_ipc.hpp>

namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXi;
using Eigen::RowVector3d;
using Eigen::VectorXd;

constexpr double step_s = .02, gravity = -9.81, density = .3; // kg for each square metre
constexpr double dhat = 4e-3, stiffness = 1e5, spring = 60,
                 tolerance = 1e-2; // of a speed

double now_ms()
{
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

// ---- the world ------------------------------------------------------------------------

struct world {
    int cloth_vertices = 0; // those that move; the ball's come after them
    ipc::CollisionMesh mesh;
    MatrixXd x;
    std::vector<std::array<int, 2>> springs;
    VectorXd rest; // length of each
    double mass = 0;
};

// The middle of each edge of a triangle becomes a vertex on the ball.
void refine(std::vector<RowVector3d> &x, std::vector<std::array<int, 3>> &faces)
{
    std::map<std::pair<int, int>, int> middles;
    auto middle = [&](int a, int b) {
        const auto [at, is_new] =
            middles.insert({std::minmax(a, b), static_cast<int>(x.size())});
        if (is_new) {
            x.push_back((x[static_cast<std::size_t>(a)] + x[static_cast<std::size_t>(b)])
                            .normalized());
        }
        return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto &[a, b, c] : faces) {
        const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        finer.insert(finer.end(),
                     {{{a, ab, ca}}, {{ab, b, bc}}, {{ca, bc, c}}, {{ab, bc, ca}}});
    }
    faces = std::move(finer);
}

world make_world(int side)
{
    world made;
    const int n = side + 1;
    std::vector<RowVector3d> x;
    std::vector<std::array<int, 3>> faces;
    auto join = [&made](int a, int b) { made.springs.push_back({{a, b}}); };
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            const int a = i * n + k;
            x.push_back({double(i) / side - .5, double(k) / side - .5, .32});
            if (i < side && k < side) {
                faces.push_back({{a, a + n, a + 1}});
                faces.push_back({{a + n, a + n + 1, a + 1}});
                join(a, a + n + 1);
                join(a + 1, a + n);
            }
            for (int far = 1; far <= 2; far++) { // along a side, and against bending
                if (i + far < n) {
                    join(a, a + far * n);
                }
                if (k + far < n) {
                    join(a, a + far);
                }
            }
        }
    }
    made.cloth_vertices = n * n;
    made.mass = density / (n * n);
    std::vector<RowVector3d> ball = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                     {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    std::vector<std::array<int, 3>> ball_faces = {{{0, 2, 4}}, {{2, 1, 4}}, {{1, 3, 4}},
                                                  {{3, 0, 4}}, {{2, 0, 5}}, {{1, 2, 5}},
                                                  {{3, 1, 5}}, {{0, 3, 5}}};
    for (int fine = 8; fine < side; fine *= 2) {
        refine(ball, ball_faces);
    }
    for (const auto &[a, b, c] : ball_faces) {
        faces.push_back({{a + n * n, b + n * n, c + n * n}});
    }
    MatrixXi f(faces.size(), 3);
    std::map<std::pair<int, int>, int> edges;
    for (std::size_t i = 0; i < faces.size(); i++) {
        for (std::size_t k = 0; k < 3; k++) {
            f(static_cast<int>(i), static_cast<int>(k)) = faces[i][k];
            edges[std::minmax(faces[i][k], faces[i][(k + 1) % 3])] = 0;
        }
    }
    MatrixXi e(edges.size(), 2);
    int row = 0;
    for (const auto &[ends, _] : edges) {
        e.row(row++) << ends.first, ends.second;
    }
    made.x.resize(static_cast<int>(x.size() + ball.size()), 3);
    for (std::size_t i = 0; i < x.size() + ball.size(); i++) {
        made.x.row(static_cast<int>(i)) = i < x.size() ? x[i] : .3 * ball[i - x.size()];
    }
    made.mesh = ipc::CollisionMesh(made.x, e, f);
    made.mesh.can_collide =
        ipc::make_static_obstacle_filter(static_cast<std::size_t>(n * n));
    made.rest.resize(static_cast<int>(made.springs.size()));
    for (std::size_t i = 0; i < made.springs.size(); i++) {
        const auto &[a, b] = made.springs[i];
        made.rest[static_cast<int>(i)] = (made.x.row(a) - made.x.row(b)).norm();
    }
    return made;
}

// ---- two ways to ask about collisions -------------------------------------------------

struct way {
    virtual ~way() = default;
    virtual const char *name() const = 0;
    virtual void near(const world &w, const MatrixXd &x, ipc::NormalCollisions &set) = 0;
    virtual double part(const world &w, const MatrixXd &x, const MatrixXd &x1) = 0;
};
struct their_way : way {
    ipc::LBVH broad_phase;
    ipc::AdditiveCCD ccd;
    const char *name() const override { return "LBVH, additive CCD"; }
    void near(const world &w, const MatrixXd &x, ipc::NormalCollisions &set) override
    {
        set.build(w.mesh, x, dhat, 0, &broad_phase);
    }
    double part(const world &w, const MatrixXd &x, const MatrixXd &x1) override
    {
        ipc::Candidates candidates;
        candidates.build(w.mesh, x, x1, 0, &broad_phase);
        return candidates.compute_collision_free_stepsize(w.mesh, x, x1, 0, ccd);
    }
};
struct our_way : way {
    pccd::ipc_broad_phase broad_phase;
    const char *name() const override { return "pccd"; }
    void near(const world &w, const MatrixXd &x, ipc::NormalCollisions &set) override
    {
        broad_phase.build_collisions(set, w.mesh, x, dhat);
    }
    double part(const world &w, const MatrixXd &x, const MatrixXd &x1) override
    {
        return broad_phase.collision_free_stepsize(w.mesh, x, x1);
    }
};

// ---- the incremental potential --------------------------------------------------------

struct system {
    double value = 0;
    VectorXd gradient;
    std::vector<Eigen::Triplet<double>> hessian;
};

struct simulation {
    const world &w;
    way &ask;
    MatrixXd x = w.x, v = MatrixXd::Zero(w.x.rows(), 3);
    double near_ms = 0, part_ms = 0, rest_ms = 0;
    long newton = 0, near_calls = 0, part_calls = 0;
    std::size_t most_collisions = 0;

    // Blocks of vertices that move alone are in the system.
    template <class Ids, class Gradient, class Hessian>
    void add(system &to, const Ids &ids, int count, const Gradient &g,
             const Hessian &h) const
    {
        for (int i = 0; i < count; i++) {
            const int a = static_cast<int>(ids[static_cast<std::size_t>(i)]);
            if (a >= w.cloth_vertices) {
                continue;
            }
            to.gradient.segment<3>(3 * a) += g.template segment<3>(3 * i);
            for (int k = 0; k < count; k++) {
                const int b = static_cast<int>(ids[static_cast<std::size_t>(k)]);
                for (int r = 0; r < 9 && b < w.cloth_vertices; r++) {
                    to.hessian.emplace_back(3 * a + r / 3, 3 * b + r % 3,
                                            h(3 * i + r / 3, 3 * k + r % 3));
                }
            }
        }
    }
    void add_springs(system &to, const MatrixXd &at, bool is_whole) const
    {
        for (std::size_t i = 0; i < w.springs.size(); i++) {
            const auto &ends = w.springs[i];
            const Eigen::Vector3d d = (at.row(ends[0]) - at.row(ends[1])).transpose();
            const double rest = w.rest[static_cast<int>(i)], length = d.norm();
            const double k = step_s * step_s * spring;
            to.value += .5 * k * (length - rest) * (length - rest);
            if (is_whole) {
                const Eigen::Vector3d n = d / length;
                const double side = std::max(0., 1 - rest / length);
                const Eigen::Matrix3d b = k * (side * Eigen::Matrix3d::Identity() +
                                               (1 - side) * n * n.transpose());
                Eigen::Matrix<double, 6, 1> g;
                Eigen::Matrix<double, 6, 6> h;
                g.head<3>() = k * (length - rest) * n;
                g.tail<3>() = -g.head<3>();
                h.topLeftCorner<3, 3>() = h.bottomRightCorner<3, 3>() = b;
                h.topRightCorner<3, 3>() = h.bottomLeftCorner<3, 3>() = -b;
                add(to, ends, 2, g, h);
            }
        }
    }
    // weight * mollifier * barrier(squared distance) of each collision.
    void add_barriers(system &to, const MatrixXd &at, const ipc::NormalCollisions &set,
                      bool is_whole) const
    {
        const double d2 = dhat * dhat, k = step_s * step_s * stiffness;
        for (std::size_t i = 0; i < set.size(); i++) {
            const ipc::NormalCollision &c = set[i];
            const auto p = c.dof(at, w.mesh.edges(), w.mesh.faces());
            const double d = c.compute_distance(p), b = ipc::barrier(d, d2);
            const double m = c.is_mollified() ? c.mollifier(p) : 1;
            to.value += k * c.weight * m * b;
            if (!is_whole) {
                continue;
            }
            const double b1 = ipc::barrier_first_derivative(d, d2);
            const ipc::VectorMax12d d1 = c.compute_distance_gradient(p);
            ipc::VectorMax12d g = m * b1 * d1;
            ipc::MatrixMax12d h =
                m * ipc::barrier_second_derivative(d, d2) * d1 * d1.transpose() +
                m * b1 * c.compute_distance_hessian(p);
            if (c.is_mollified()) {
                const ipc::VectorMax12d m1 = c.mollifier_gradient(p);
                g += b * m1;
                h += b * c.mollifier_hessian(p) +
                     b1 * (m1 * d1.transpose() + d1 * m1.transpose());
            }
            h = ipc::project_to_psd(h);
            add(to, c.vertex_ids(w.mesh.edges(), w.mesh.faces()), c.num_vertices(),
                ipc::VectorMax12d(k * c.weight * g), ipc::MatrixMax12d(k * c.weight * h));
        }
    }
    system potential(const MatrixXd &at, const MatrixXd &aim,
                     const ipc::NormalCollisions &set, bool is_whole) const
    {
        system made;
        made.gradient.setZero(3 * w.cloth_vertices);
        for (int i = 0; i < w.cloth_vertices; i++) {
            const RowVector3d off = at.row(i) - aim.row(i);
            made.value += .5 * w.mass * off.squaredNorm();
            made.gradient.segment<3>(3 * i) = w.mass * off.transpose();
            for (int k = 0; k < 3; k++) {
                made.hessian.emplace_back(3 * i + k, 3 * i + k, w.mass);
            }
        }
        add_springs(made, at, is_whole);
        add_barriers(made, at, set, is_whole);
        return made;
    }

    void near(const MatrixXd &at, ipc::NormalCollisions &set)
    {
        const double begin = now_ms();
        ask.near(w, at, set);
        near_ms += now_ms() - begin;
        near_calls++;
        most_collisions = std::max(most_collisions, set.size());
    }
    void step()
    {
        const MatrixXd before = x;
        MatrixXd aim = x + step_s * v;
        aim.topRows(w.cloth_vertices).col(2).array() += step_s * step_s * gravity;
        ipc::NormalCollisions set;
        const double begin = now_ms(), asked = near_ms + part_ms;
        near(x, set);
        for (int i = 0; i < 60; i++) {
            newton++;
            const system s = potential(x, aim, set, true);
            Eigen::SparseMatrix<double> h(s.gradient.size(), s.gradient.size());
            h.setFromTriplets(s.hessian.begin(), s.hessian.end());
            const VectorXd dx =
                Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(h).solve(-s.gradient);
            if (dx.cwiseAbs().maxCoeff() < tolerance * step_s) {
                break;
            }
            MatrixXd x1 = x;
            for (int k = 0; k < w.cloth_vertices; k++) {
                x1.row(k) += dx.segment<3>(3 * k).transpose();
            }
            const double since = now_ms();
            double part = ask.part(w, x, x1);
            part_ms += now_ms() - since;
            part_calls++;
            MatrixXd at;
            do {
                at = x + part * (x1 - x);
                near(at, set);
                part /= 2;
            } while (potential(at, aim, set, false).value > s.value && part > 1e-12);
            x = at;
        }
        v = (x - before) / step_s;
        rest_ms += now_ms() - begin - (near_ms + part_ms - asked);
    }
};

void print(const simulation &s, int steps)
{
    std::printf("%-20s %9.2f %9.2f %9.2f %9.2f   %ld Newton, %ld sets, %ld parts\n",
                s.ask.name(), s.near_ms / steps, s.part_ms / steps, s.rest_ms / steps,
                (s.near_ms + s.part_ms + s.rest_ms) / steps, s.newton, s.near_calls,
                s.part_calls);
}

} // namespace

int main(int argc, char **argv)
{
    int threads = 1, side = 30, steps = 16;
    for (int i = 1; i < argc; i++) {
        const bool has_value = i + 1 < argc;
        if (std::strcmp(argv[i], "--smoke") == 0) {
            side = 10;
            steps = 12;
        } else if (has_value && std::strcmp(argv[i], "--threads") == 0) {
            threads = std::atoi(argv[++i]);
        } else if (has_value && std::strcmp(argv[i], "--side") == 0) {
            side = std::atoi(argv[++i]);
        } else if (has_value && std::strcmp(argv[i], "--steps") == 0) {
            steps = std::atoi(argv[++i]);
        } else {
            std::fprintf(stderr,
                         "usage: cloth [--threads N] [--side N] [--steps N] [--smoke]\n");
            return 2;
        }
    }
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                              static_cast<std::size_t>(threads));
    ipc::logger().set_level(spdlog::level::off);
    const world w = make_world(side);
    their_way theirs;
    our_way ours;
    ours.broad_phase.threads = static_cast<std::uint32_t>(threads);
    simulation by[2] = {{w, theirs}, {w, ours}};
    double apart = 0;
    for (int i = 0; i < steps; i++) {
        by[i % 2].step();
        by[1 - i % 2].step();
        apart = std::max(apart, (by[0].x - by[1].x).rowwise().norm().maxCoeff());
        by[0].x = by[1].x; // what buckles is chaotic: each step begins alike
        by[0].v = by[1].v;
    }
    std::printf("cloth of %d triangles on a ball of %ld, %d steps of %g s, threads: %d\n"
                "milliseconds a step:    the set  the part  the rest       all\n",
                2 * side * side, static_cast<long>(w.mesh.num_faces()) - 2 * side * side,
                steps, step_s, threads);
    bool is_sound = true;
    for (const simulation &s : by) {
        print(s, steps);
        is_sound &= !ours.broad_phase.has_intersections(w.mesh, s.x);
    }
    std::printf("at most %zu normal collisions; after a step the two are at most %.2g "
                "apart; %s\n",
                by[1].most_collisions, apart,
                is_sound ? "nothing intersects" : "SOMETHING INTERSECTS");
    return is_sound && by[0].most_collisions > 0 ? 0 : 1;
}
