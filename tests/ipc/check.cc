/* check.cc - what pccd_ipc.hpp promises, beside ipc-toolkit and exact arithmetic (TAP).
 *
 * Generate scenes of the sorts that ipc-toolkit's own tests have (surfaces that lie in
 * each other, boxes on boxes, rods and loose points, static obstacles, planes), and
 * compare: normal collisions as sets with those of its LBVH, candidates and steps with
 * what exact arithmetic says of every pair. The recorded scenes are compared, too,
 * where $PCCD_DATA says.
 */
#include <ipc/broad_phase/brute_force.hpp>
#include <ipc/ccd/additive_ccd.hpp>
#include <ipc/collisions/normal/normal_collisions.hpp>
#include <ipc/utils/logger.hpp>

#include <cstdio>
#include <cstring>
#include <map>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include <gmp.h>

#include <pccd_ipc.hpp>

extern "C" {
#include "data.h"
#include "oracle_distance.h"
#include "oracle_thick.h"
#include "ply.h"
#include "prng.h"
}

namespace {

using Eigen::MatrixXd;
using Eigen::MatrixXi;
using Eigen::RowVector3d;

int count = 0, failed = 0;

void tell(bool is_right, const std::string &name)
{
    count++;
    failed += !is_right;
    std::printf("%sok %d - %s\n", is_right ? "" : "not ", count, name.c_str());
}
void skip(const std::string &name, const char *why)
{
    count++;
    std::printf("ok %d - %s # SKIP %s\n", count, name.c_str(), why);
}

// ---- scenes ---------------------------------------------------------------------------

struct shape {
    std::vector<RowVector3d> x;
    std::vector<std::array<int, 3>> faces;
    std::vector<std::array<int, 2>> rods;

    void add(const shape &other, const RowVector3d &by)
    {
        const int first = static_cast<int>(x.size());
        for (const RowVector3d &p : other.x) {
            x.push_back(p + by);
        }
        for (const auto &f : other.faces) {
            faces.push_back({{f[0] + first, f[1] + first, f[2] + first}});
        }
        for (const auto &r : other.rods) {
            rods.push_back({{r[0] + first, r[1] + first}});
        }
    }
};

// side x side squares of length h, wavy by `wave`, cut along one or the other diagonal.
shape sheet(int side, double h, double wave, bool is_other = false)
{
    shape made;
    for (int i = 0; i <= side; i++) {
        for (int k = 0; k <= side; k++) {
            made.x.push_back({i * h, k * h, wave * std::sin(i * 1.3) * std::cos(k * .9)});
        }
    }
    for (int i = 0; i < side; i++) {
        for (int k = 0; k < side; k++) {
            const int a = i * (side + 1) + k, b = a + side + 1;
            made.faces.push_back({{a, b, is_other ? b + 1 : a + 1}});
            made.faces.push_back({{is_other ? a : b, b + 1, a + 1}});
        }
    }
    return made;
}
shape box(double h)
{
    shape made;
    for (int i = 0; i < 8; i++) {
        made.x.push_back({h * (i & 1), h * (i >> 1 & 1), h * (i >> 2)});
    }
    made.faces = {{{0, 2, 1}}, {{1, 2, 3}}, {{4, 5, 6}}, {{5, 7, 6}},
                  {{0, 1, 4}}, {{1, 5, 4}}, {{2, 6, 3}}, {{3, 6, 7}},
                  {{0, 4, 2}}, {{2, 4, 6}}, {{1, 3, 5}}, {{3, 7, 5}}};
    return made;
}
shape rod(int pieces, const RowVector3d &to)
{
    shape made;
    for (int i = 0; i <= pieces; i++) {
        made.x.push_back(to * i / pieces);
        if (i > 0) {
            made.rods.push_back({{i - 1, i}});
        }
    }
    return made;
}

struct test_scene {
    std::string name;
    ipc::CollisionMesh mesh;
    MatrixXd x0, x1;
    double dhat = .1;
};

MatrixXi edges_of(const shape &of)
{
    std::set<std::pair<int, int>> found;
    for (const auto &f : of.faces) {
        for (std::size_t k = 0; k < 3; k++) {
            found.insert(std::minmax(f[k], f[(k + 1) % 3]));
        }
    }
    for (const auto &r : of.rods) {
        found.insert(std::minmax(r[0], r[1]));
    }
    MatrixXi edges(found.size(), 2);
    int i = 0;
    for (const auto &[a, b] : found) { // another order than ours, and both directions
        edges.row(i) << (i % 2 == 0 ? a : b), (i % 2 == 0 ? b : a);
        i++;
    }
    return edges;
}

// Each vertex moves by up to `by` along each axis, and from number `first` on by `push`.
test_scene scene_of(const char *name, const shape &of, double by, int first,
                    const RowVector3d &push)
{
    static std::mt19937_64 random(prng_seed());
    std::uniform_real_distribution<double> some(-1, 1);
    test_scene made;
    made.name = name;
    const int n = static_cast<int>(of.x.size());
    made.x0.resize(n, 3);
    made.x1.resize(n, 3);
    for (int i = 0; i < n; i++) {
        const RowVector3d way(some(random), some(random), some(random));
        made.x0.row(i) = of.x[static_cast<std::size_t>(i)];
        made.x1.row(i) = made.x0.row(i) + by * way;
        if (i >= first) {
            made.x1.row(i) += push;
        }
    }
    MatrixXi faces(of.faces.size(), 3);
    for (std::size_t i = 0; i < of.faces.size(); i++) {
        faces.row(static_cast<int>(i)) << of.faces[i][0], of.faces[i][1], of.faces[i][2];
    }
    made.mesh = ipc::CollisionMesh(made.x0, edges_of(of), faces);
    return made;
}

std::vector<test_scene> scenes()
{
    std::vector<test_scene> all;
    shape a = sheet(5, .2, 0);
    const int n = static_cast<int>(a.x.size());
    a.add(sheet(5, .2, 0), {0, 0, .05}); // parallel edges, vertices over vertices
    all.push_back(scene_of("flat_sheets", a, .02, n, {0, 0, -.1}));
    a = sheet(5, .2, .04);
    a.add(sheet(5, .23, .05), {.03, -.07, .16});
    all.push_back(scene_of("wavy_sheets", a, .05, n, {0, 0, -.2}));
    a = box(.5);
    a.add(box(.5), {.1, .1, .55});
    a.add(box(.25), {.3, .2, 1.1});
    all.push_back(scene_of("boxes_on_boxes", a, .01, 8, {0, 0, -.2}));
    a = sheet(4, .25, .03);
    a.add(rod(5, {.9, .8, 0}), {.05, .1, .08});
    a.add(rod(4, {.1, .9, .1}), {.5, 0, .13});
    const int loose = static_cast<int>(a.x.size());
    for (int i = 0; i < 6; i++) {
        a.x.push_back({.15 * i + .01, .13 * i, .06 + .02 * (i % 3)});
    }
    all.push_back(scene_of("rods_and_points", a, .03, loose, {0, 0, -.2}));
    a = rod(6, {1, 0, 0});
    a.add(rod(6, {1, 1e-4, 0}), {0, 0, .05}); // nearly parallel
    a.add(rod(6, {0, 1, .1}), {.5, -.5, .07});
    all.push_back(scene_of("rods", a, .03, 7, {0, 0, -.1}));
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> some(0, 1);
    a = shape();
    for (int i = 0; i < 60; i++) {
        a.x.push_back({some(random), some(random), some(random)});
        if (i % 3 == 2) {
            a.faces.push_back({{i - 2, i - 1, i}});
        }
    }
    all.push_back(scene_of("soup", a, .2, 60, {0, 0, 0}));
    a = sheet(5, .2, .04);
    a.add(box(.3), {.1, .3, .06}); // goes through the sheet first, which does not count
    const std::size_t m = a.x.size();
    a.add(sheet(5, .23, .05), {.53, -.07, .2});
    all.push_back(scene_of("bodies_that_ignore_some", a, .05, n, {0, 0, -.25}));
    all.back().dhat = .25; // more than the length of edges
    all.back().mesh.can_collide = ipc::CollisionFilter(
        [m](std::size_t i, std::size_t k) { return (i < m) != (k < m); });
    a = box(.5);
    a.add(box(.5), {.1, .1, .52});
    all.push_back(scene_of("boxes_above_a_plane", a, .04, 0, {0, 0, -.2}));
    all.back().mesh.planes.push_back(
        {Eigen::Vector3d(0, .6, .8), Eigen::Vector3d(0, 0, -.03)});
    return all;
}

// ---- sets -----------------------------------------------------------------------------

using key = std::array<long, 4>; // kind, both features, the type of two edges
using weighed = std::map<key, double>;

weighed sets_of(const ipc::NormalCollisions &set)
{
    weighed found;
    const auto both = [](long kind, long a, long b, long type = 0) {
        return key{{kind, std::min(a, b), std::max(a, b), type}};
    };
    for (const auto &c : set.vv_collisions) {
        found[both(0, c.vertex0_id, c.vertex1_id)] += c.weight;
    }
    for (const auto &c : set.ev_collisions) {
        found[key{{1, c.edge_id, c.vertex_id, 0}}] += c.weight;
    }
    for (const auto &c : set.ee_collisions) {
        found[both(2, c.edge0_id, c.edge1_id, static_cast<long>(c.dtype))] += c.weight;
    }
    for (const auto &c : set.fv_collisions) {
        found[key{{3, c.face_id, c.vertex_id, 0}}] += c.weight;
    }
    for (const auto &c : set.pv_collisions) {
        found[key{{4, c.vertex_id, 0, 0}}] += c.weight;
    }
    // Weights that cancel leave 0, or what rounding in another order leaves of it.
    for (auto i = found.begin(); i != found.end();) {
        i = std::fabs(i->second) < 1e-12 ? found.erase(i) : std::next(i);
    }
    return found;
}
bool is_equal(const weighed &a, const weighed &b)
{
    bool is_same = a.size() == b.size();
    for (auto i = a.begin(), k = b.begin(); is_same && i != a.end(); ++i, ++k) {
        is_same = i->first == k->first && std::fabs(i->second - k->second) <=
                                              1e-9 * std::max(1., std::fabs(k->second));
    }
    return is_same;
}

using set_type = ipc::NormalCollisions::CollisionSetType;

// What its LBVH finds, with the edge of the smaller number first. In which order it finds
// two edges depends on where they lie; where their distance is one of two types, as
// between parallel edges, ipc-toolkit's type depends on the order.
ipc::Candidates theirs_of(const test_scene &s, double dmin)
{
    ipc::LBVH theirs;
    ipc::Candidates found;
    found.build(s.mesh, s.x0, .5 * (s.dhat + dmin), &theirs);
    for (auto &c : found.ee_candidates) {
        std::tie(c.edge0_id, c.edge1_id) =
            std::pair(std::min(c.edge0_id, c.edge1_id), std::max(c.edge0_id, c.edge1_id));
    }
    return found;
}

bool has_equal_sets(pccd::ipc_broad_phase &ours, const test_scene &s, double dmin,
                    bool has_areas, set_type type, std::size_t *size)
{
    ipc::NormalCollisions sets[3];
    for (ipc::NormalCollisions &set : sets) {
        set.set_use_area_weighting(has_areas);
        set.set_collision_set_type(type);
    }
    sets[0].build(theirs_of(s, dmin), s.mesh, s.x0, s.dhat, dmin);
    sets[1].build(s.mesh, s.x0, s.dhat, dmin, &ours);
    ours.build_collisions(sets[2], s.mesh, s.x0, s.dhat, dmin);
    *size += sets[0].size();
    bool has_dmin = true;
    for (std::size_t i = 0; i < sets[2].size(); i++) {
        has_dmin &= sets[2][i].dmin == dmin;
    }
    return has_dmin && is_equal(sets_of(sets[1]), sets_of(sets[0])) &&
           is_equal(sets_of(sets[2]), sets_of(sets[0]));
}

// ---- exact truth ----------------------------------------------------------------------

// Do a candidate's two features come within r of each other on the way from x0 to x1?
bool meets(const ipc::CollisionStencil &pair, int points_a, const MatrixXd &x0,
           const MatrixXd &x1, const ipc::CollisionMesh &mesh, double r)
{
    double p[8][3] = {};
    const auto ids = pair.vertex_ids(mesh.edges(), mesh.faces());
    for (std::size_t i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            p[i][k] = x0(ids[i], k);
            p[i + 4][k] = x1(ids[i], k);
        }
    }
    oracle_thick thick = {};
    thick.points_a = points_a;
    thick.points_b = 4 - points_a;
    thick.p = p;
    thick.radius[0] = r;
    oracle_first *first = oracle_thick_first_new(&thick);
    oracle_first_free(first);
    return first != nullptr;
}

struct truth {
    std::set<std::pair<int, int>> ee, fv; // those that meet within the step
};
truth truth_of(const test_scene &s, const MatrixXd &x1, double r)
{
    ipc::BruteForce all;
    ipc::Candidates pairs;
    pairs.build(s.mesh, s.x0, x1, .51 * r + 1e-12, &all);
    truth found;
    for (const auto &c : pairs.ee_candidates) {
        if (meets(c, 2, s.x0, x1, s.mesh, r)) {
            found.ee.insert(std::minmax(c.edge0_id, c.edge1_id));
        }
    }
    for (const auto &c : pairs.fv_candidates) {
        if (meets(c, 1, s.x0, x1, s.mesh, r)) {
            found.fv.insert({c.face_id, c.vertex_id});
        }
    }
    return found;
}
bool has_all(const ipc::Candidates &candidates, const truth &true_pairs)
{
    truth have;
    for (const auto &c : candidates.ee_candidates) {
        have.ee.insert(std::minmax(c.edge0_id, c.edge1_id));
    }
    for (const auto &c : candidates.fv_candidates) {
        have.fv.insert({c.face_id, c.vertex_id});
    }
    return have.ee.size() == candidates.ee_candidates.size() &&
           have.fv.size() == candidates.fv_candidates.size() &&
           std::includes(have.ee.begin(), have.ee.end(), true_pairs.ee.begin(),
                         true_pairs.ee.end()) &&
           std::includes(have.fv.begin(), have.fv.end(), true_pairs.fv.begin(),
                         true_pairs.fv.end());
}

// ---- cases ----------------------------------------------------------------------------

// If one failed, a simulation would feel other forces with our broad phase than with
// theirs, or none where surfaces are near.
void check_sets(const test_scene &s)
{
    pccd::ipc_broad_phase ours;
    bool is_right = true;
    std::size_t size = 0;
    for (const set_type type :
         {set_type::IPC, set_type::IMPROVED_MAX_APPROX, set_type::OGC}) {
        for (const double dmin : {0., .4 * s.dhat}) {
            for (const bool has_areas : {false, true}) {
                const bool is_same =
                    has_equal_sets(ours, s, dmin, has_areas, type, &size);
                is_right &= is_same;
                if (!is_same) {
                    std::printf("# type %d, dmin %g, areas %d\n", static_cast<int>(type),
                                dmin, has_areas);
                }
            }
        }
    }
    tell(is_right && size > 0, "normal_collisions__are_those_of_lbvh_in_" + s.name);
}

// If one failed, a pair that meets would never be tested.
void check_candidates(const test_scene &s)
{
    pccd::ipc_broad_phase ours;
    bool is_right = true;
    std::size_t size = 0;
    for (const double r : {0., .3 * s.dhat}) {
        const truth found = truth_of(s, s.x1, r);
        ipc::Candidates candidates;
        candidates.build(s.mesh, s.x0, s.x1, .5 * r, &ours);
        is_right &= has_all(candidates, found);
        size += found.ee.size() + found.fv.size();
    }
    tell(is_right && size > 0, "candidates__have_all_that_meets_in_" + s.name);
}

// If one failed, a step that is said to be safe would go through something, or stop far
// from it.
void check_step(const test_scene &s)
{
    pccd::ipc_broad_phase ours;
    ours.conservative_rescaling = 1;
    bool is_safe = true, is_far = true, is_beyond = true;
    for (const double dmin : {0., 1e-3, .01}) {
        const double a = ours.collision_free_stepsize(s.mesh, s.x0, s.x1, dmin);
        const truth begin = truth_of(s, s.x0, dmin);
        if (!begin.ee.empty() || !begin.fv.empty()) { // too near to begin with
            is_safe &= a == 0;
            continue;
        }
        const MatrixXd safe = s.x0 + a * (s.x1 - s.x0);
        const truth none = truth_of(s, safe, dmin);
        is_safe &= a > 0 && none.ee.empty() && none.fv.empty();
        for (const auto &plane : s.mesh.planes) {
            for (int i = 0; i < safe.rows(); i++) {
                is_safe &= plane.signedDistance(safe.row(i).transpose()) > dmin;
            }
        }
        if (a < 1 && s.mesh.planes.empty()) {
            const MatrixXd more = s.x0 + (a + 2e-6) * (s.x1 - s.x0);
            const truth some = truth_of(s, more, dmin + 1e-9);
            is_far &=
                !some.ee.empty() || !some.fv.empty() || s.mesh.num_codim_vertices() > 0;
        }
        ipc::Candidates pairs;
        ipc::BruteForce all;
        pairs.build(s.mesh, s.x0, s.x1, .5 * dmin, &all);
        const double theirs = pairs.compute_collision_free_stepsize(
            s.mesh, s.x0, s.x1, dmin, ipc::AdditiveCCD());
        // Its planes know no least distance.
        is_beyond &= a >= theirs - 2e-6 || !s.mesh.planes.empty();
        is_beyond &= ours.is_step_collision_free(s.mesh, s.x0, safe, dmin);
        std::printf("# %s, dmin %g: %.9f, additive CCD %.9f\n", s.name.c_str(), dmin, a,
                    theirs);
    }
    tell(is_safe, "step__meets_nothing_in_" + s.name);
    tell(is_far && is_beyond, "step__goes_as_far_as_it_may_in_" + s.name);
}

// If it failed, a mesh that passes through itself would be taken for sound, or the other
// way round.
void check_intersections(const std::vector<test_scene> &all)
{
    pccd::ipc_broad_phase ours;
    bool is_right = true;
    int crossed = 0;
    for (const test_scene &s : all) {
        for (const MatrixXd *x : {&s.x0, &s.x1}) {
            bool is_crossed = false;
            ipc::BruteForce brute;
            std::vector<ipc::EdgeFaceCandidate> pairs;
            brute.can_vertices_collide = s.mesh.can_collide;
            brute.build(*x, s.mesh.edges(), s.mesh.faces(), 0);
            brute.detect_edge_face_candidates(pairs);
            for (const auto &c : pairs) {
                double p[5][3];
                for (int i = 0; i < 5; i++) {
                    const int v = i < 2 ? s.mesh.edges()(c.edge_id, i)
                                        : s.mesh.faces()(c.face_id, i - 2);
                    for (int k = 0; k < 3; k++) {
                        p[i][k] = (*x)(v, k);
                    }
                }
                is_crossed |= oracle_crosses(p);
            }
            is_right &= ours.has_intersections(s.mesh, *x) == is_crossed;
            crossed += is_crossed;
        }
    }
    tell(is_right && crossed > 0, "intersections__are_those_of_exact_arithmetic");
}

std::set<std::uint32_t> meshes_of(const pccd::client &client)
{
    std::set<std::uint32_t> handles;
    pccd_list_meshes(
        client.get(), 0,
        [](void *to, const pccd_registered_mesh *info) {
            static_cast<std::set<std::uint32_t> *>(to)->insert(info->mesh);
        },
        &handles);
    return handles;
}

// If one failed, each call would build hierarchies anew, or answer for a mesh that has
// gone.
void check_residence(const std::vector<test_scene> &all)
{
    pccd::client client("direct:");
    pccd::ipc_broad_phase ours(client);
    std::size_t size = 0;
    std::set<std::uint32_t> meshes;
    bool is_same = true;
    test_scene s = all[1];
    for (int i = 0; i < 4; i++) {
        is_same &= has_equal_sets(ours, s, 0, false, set_type::IPC, &size);
        const double a = ours.collision_free_stepsize(s.mesh, s.x0, s.x1);
        s.x0 += .5 * a * (s.x1 - s.x0);
        const auto now = meshes_of(client);
        is_same &= now.size() == 1 && (i == 0 || now == meshes);
        meshes = now;
    }
    tell(is_same, "mesh__stays_while_its_topology_does");
    bool is_right = true;
    std::vector<test_scene> others = all;
    shape cut = sheet(5, .2, 0, true); // as many vertices, other edges and faces
    cut.add(sheet(5, .2, 0, true), {0, 0, .05});
    others.insert(others.begin() + 1, scene_of("cut", cut, 0, 0, {0, 0, 0}));
    for (int i = 0; i < 2; i++) {
        for (const test_scene &other : others) {
            is_right &= has_equal_sets(ours, other, 0, false, set_type::IPC, &size);
        }
    }
    tell(is_right && meshes_of(client).size() == 1,
         "mesh__is_replaced_with_its_topology");
}

// If one failed, flat problems would need another broad phase, or an error were hidden.
void check_others()
{
    test_scene flat;
    flat.x0.resize(4, 2);
    flat.x0 << 0, 0, 1, 0, .2, .05, .8, .06;
    MatrixXi edges(2, 2);
    edges << 0, 1, 2, 3;
    flat.mesh = ipc::CollisionMesh(flat.x0, edges);
    pccd::ipc_broad_phase ours;
    std::size_t size = 0;
    tell(has_equal_sets(ours, flat, 0, false, set_type::IPC, &size) && size > 0,
         "two_dimensions__are_lbvhs");
    int status = 0;
    try {
        ours.collision_free_stepsize(flat.mesh, flat.x0, flat.x0);
    } catch (const pccd::error &error) {
        status = error.status();
    }
    tell(status == PCCD_E_INVAL, "step__in_two_dimensions_is_told");
    MatrixXd x(3, 3);
    x << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    MatrixXi twice(2, 2);
    twice << 0, 1, 1, 0;
    status = 0;
    try {
        ours.collision_free_stepsize(ipc::CollisionMesh(x, twice), x, x);
    } catch (const pccd::error &error) {
        status = error.status();
    }
    tell(status == PCCD_E_INVAL, "mesh__with_an_edge_twice_is_told");
}

// ---- recorded scenes ------------------------------------------------------------------

MatrixXd positions_of(const ply &from)
{
    MatrixXd x(from.vertex_count, 3);
    for (std::uint32_t i = 0; i < from.vertex_count; i++) {
        x.row(i) << from.x[i][0], from.x[i][1], from.x[i][2];
    }
    return x;
}

bool read_recorded(const data_scene &names, test_scene *made)
{
    ply frames[2] = {};
    char path[DATA_PATH_MAX];
    bool is_read = true;
    for (int i = 0; i < 2 && is_read; i++) {
        is_read = data_find(names.frames[i], path) && ply_read(path, &frames[i]);
    }
    if (is_read) {
        made->name = names.name;
        made->x0 = positions_of(frames[0]);
        made->x1 = positions_of(frames[1]);
        const RowVector3d size =
            made->x0.colwise().maxCoeff() - made->x0.colwise().minCoeff();
        made->dhat = 1e-3 * size.norm();
        shape of;
        MatrixXi faces(frames[0].triangle_count, 3);
        for (std::uint32_t i = 0; i < frames[0].triangle_count; i++) {
            const std::uint32_t *f = frames[0].triangles[i];
            of.faces.push_back({{int(f[0]), int(f[1]), int(f[2])}});
            faces.row(i) << int(f[0]), int(f[1]), int(f[2]);
        }
        made->mesh = ipc::CollisionMesh(made->x0, edges_of(of), faces);
    }
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
    return is_read;
}

// Pairs of the scene's truth that the candidates lack. Its edges are numbered as ours.
std::size_t missing(const test_scene &s, const data_scene &names,
                    const ipc::Candidates &candidates, std::size_t *true_count)
{
    std::map<std::pair<int, int>, int> by_ends; // (larger, smaller)
    for (int i = 0; i < s.mesh.edges().rows(); i++) {
        const auto [a, b] = std::minmax(s.mesh.edges()(i, 0), s.mesh.edges()(i, 1));
        by_ends[{b, a}] = i;
    }
    std::vector<int> edge_of; // its number to ipc-toolkit's
    for (const auto &[ends, i] : by_ends) {
        edge_of.push_back(i);
    }
    truth have;
    for (const auto &c : candidates.ee_candidates) {
        have.ee.insert(std::minmax(c.edge0_id, c.edge1_id));
    }
    for (const auto &c : candidates.fv_candidates) {
        have.fv.insert({c.face_id, c.vertex_id});
    }
    std::size_t lacking = 0;
    const auto n = static_cast<std::uint32_t>(s.x0.rows());
    const auto e = static_cast<std::uint32_t>(edge_of.size());
    for (int kind = 0; kind < 2; kind++) {
        char ids[DATA_PATH_MAX], is_true[DATA_PATH_MAX];
        data_pairs pairs = {};
        if (!data_find(names.ids[kind], ids) || !data_find(names.truth[kind], is_true) ||
            !data_pairs_read(ids, is_true, &pairs)) {
            return 1;
        }
        for (std::size_t i = 0; i < pairs.count; i++) {
            const auto [a, b] = std::pair(pairs.ids[i][0], pairs.ids[i][1]);
            if (!pairs.truth[i]) {
                continue;
            }
            ++*true_count;
            lacking +=
                kind == 0
                    ? have.fv.count({int(b - n - e), int(a)}) == 0
                    : have.ee.count(std::minmax(edge_of[a - n], edge_of[b - n])) == 0;
        }
        data_pairs_deinit(&pairs);
    }
    return lacking;
}

// Steps in which all stays farther apart than half of the least distance to begin with.
// If it failed, a simulation of a real scene would go through something, or stop early.
void check_recorded_step(const test_scene &s)
{
    pccd::ipc_broad_phase ours;
    ours.conservative_rescaling = 1;
    ipc::NormalCollisions set;
    ours.build_collisions(set, s.mesh, s.x0, s.dhat);
    const double r = .5 * std::sqrt(set.compute_minimum_distance(s.mesh, s.x0));
    const double a = ours.collision_free_stepsize(s.mesh, s.x0, s.x1, r);
    ipc::LBVH lbvh;
    ipc::Candidates pairs;
    pairs.build(s.mesh, s.x0, s.x1, .5 * r, &lbvh);
    const double theirs =
        pairs.compute_collision_free_stepsize(s.mesh, s.x0, s.x1, r, ipc::AdditiveCCD());
    bool is_right = a >= theirs - 2e-6 && a < 1;
    const MatrixXd safe = s.x0 + a * (s.x1 - s.x0);
    pairs.build(s.mesh, s.x0, safe, .5 * r + 1e-12, &lbvh);
    const bool is_checked = a > 0 && pairs.size() < 100000; // it takes a while for each
    for (std::size_t i = 0; is_checked && i < pairs.ee_candidates.size(); i++) {
        is_right &= !meets(pairs.ee_candidates[i], 2, s.x0, safe, s.mesh, r);
    }
    for (std::size_t i = 0; is_checked && i < pairs.fv_candidates.size(); i++) {
        is_right &= !meets(pairs.fv_candidates[i], 1, s.x0, safe, s.mesh, r);
    }
    std::printf("# r %g: %.9g, additive CCD %.9g; of %zu pairs %s\n", r, a, theirs,
                pairs.size(), is_checked ? "all were looked at" : "none was looked at");
    tell(is_right, "recorded__step_is_safe_in_" + s.name);
}

void check_recorded(const data_scene &names)
{
    const std::string name = names.name;
    test_scene s;
    if (!read_recorded(names, &s)) {
        const char why[] = "the recorded scenes are not here";
        skip("recorded__has_equal_sets_in_" + name, why);
        skip("recorded__candidates_have_the_truth_of_" + name, why);
        skip("recorded__step_is_safe_in_" + name, why);
        return;
    }
    pccd::ipc_broad_phase ours;
    std::size_t size = 0, true_count = 0;
    const bool is_same = has_equal_sets(ours, s, 0, false, set_type::IPC, &size);
    std::printf("# %s: %zu normal collisions\n", s.name.c_str(), size);
    // If it failed, forces in a real scene would be others.
    tell(is_same && size > 0, "recorded__has_equal_sets_in_" + name);
    ipc::Candidates candidates;
    candidates.build(s.mesh, s.x0, s.x1, 0, &ours);
    const std::size_t lacking = missing(s, names, candidates, &true_count);
    std::printf("# %zu candidates, %zu of %zu that meet are missing\n", candidates.size(),
                lacking, true_count);
    // If it failed, what truly meets there would never be tested.
    tell(lacking == 0 && true_count > 0,
         "recorded__candidates_have_the_truth_of_" + name);
    check_recorded_step(s);
}

} // namespace

int main()
{
    ipc::logger().set_level(spdlog::level::off);
    try {
        const std::vector<test_scene> all = scenes();
        for (const test_scene &s : all) {
            check_sets(s);
            check_candidates(s);
            check_step(s);
        }
        check_intersections(all);
        check_residence(all);
        check_others();
        for (const data_scene &names : data_scenes) {
            check_recorded(names);
        }
    } catch (const std::exception &error) {
        std::printf("Bail out! %s\n", error.what());
        return 1;
    }
    std::printf("1..%d\n", count);
    return failed != 0;
}
