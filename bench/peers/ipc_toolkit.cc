/* ipc_toolkit.cc - ipc-toolkit: its hierarchy, candidates, collision set.
 *
 * Ask it what is near, and how far a step may go, as a simulation does in every
 * iteration: boxes and hierarchy (LBVH) anew, candidates, then distances, the set or the
 * times.
 */
#include <ipc/broad_phase/lbvh.hpp>
#include <ipc/candidates/candidates.hpp>
#include <ipc/ccd/additive_ccd.hpp>
#include <ipc/ccd/tight_inclusion_ccd.hpp>
#include <ipc/collision_mesh.hpp>
#include <ipc/collisions/normal/normal_collisions.hpp>
#include <ipc/distance/distance_type.hpp>
#include <ipc/utils/logger.hpp>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "near_peer.h"

namespace
{

struct state {
    tbb::global_control one{tbb::global_control::max_allowed_parallelism, 1};
    Eigen::MatrixXd x;
    ipc::CollisionMesh mesh;
    ipc::LBVH tree;
    ipc::Candidates candidates;
    std::vector<std::size_t> near; /* candidates, by their numbers */
    std::vector<double> squared;   /* of each */
    ipc::NormalCollisions set;
};

Eigen::MatrixXd positions(const double (*x)[3], uint32_t count)
{
    Eigen::MatrixXd m(count, 3);
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            m(i, k) = x[i][k];
        }
    }
    return m;
}

Eigen::MatrixXi table(const uint32_t (*corners)[3], uint32_t count, int columns)
{
    Eigen::MatrixXi m(count, columns);
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < columns; k++) {
            m(i, k) = static_cast<int>(corners[i][k]);
        }
    }
    return m;
}

void version(char *text, size_t capacity)
{
    std::snprintf(text, capacity, "ipc-toolkit");
}

void *open(const near_input *input)
{
    auto *self = new state;
    ipc::logger().set_level(spdlog::level::off);
    self->x = positions(input->x, input->vertex_count);
    self->mesh = ipc::CollisionMesh(self->x, table(input->edges, input->edge_count, 2),
                                    table(input->faces, input->face_count, 3));
    return self;
}

void close(void *state_of)
{
    delete static_cast<state *>(state_of);
}

/* Boxes grow by half the distance on each side. */
void build(state *self, double d)
{
    self->candidates.build(self->mesh, self->x, 0.5 * d, &self->tree);
}

uint64_t pairs(void *state_of, double d)
{
    auto *self = static_cast<state *>(state_of);
    build(self, d);
    self->near.clear();
    self->squared.clear();
    for (std::size_t i = 0; i < self->candidates.size(); i++) {
        double squared = self->candidates[i].compute_distance(self->x, self->mesh.edges(),
                                                              self->mesh.faces());
        if (squared < d * d) {
            self->near.push_back(i);
            self->squared.push_back(squared);
        }
    }
    return self->near.size();
}

uint64_t features(void *state_of, double d)
{
    auto *self = static_cast<state *>(state_of);
    build(self, d);
    self->set.build(self->candidates, self->mesh, self->x, d);
    return self->set.size();
}

void vertices(void *state_of, double d, double *bounds)
{
    auto *self = static_cast<state *>(state_of);
    build(self, d);
    Eigen::VectorXd found =
        self->candidates.compute_per_vertex_safe_distances(self->mesh, self->x, d, 0);
    std::copy(found.data(), found.data() + found.size(), bounds);
}

/* ---- what it has found, in our words ----------------------------------------------- */

near_name name_of(near_kind kind, ipc::index_t a, ipc::index_t b)
{
    bool swap = (kind == NEAR_EE || kind == NEAR_VV) && a > b;
    return {static_cast<uint32_t>(kind), static_cast<uint32_t>(swap ? b : a),
            static_cast<uint32_t>(swap ? a : b)};
}

near_name closest_of(const state *self, const ipc::FaceVertexCandidate &pair)
{
    ipc::index_t f = pair.face_id;
    ipc::index_t v = pair.vertex_id;
    const Eigen::MatrixXi &faces = self->mesh.faces();
    auto type = ipc::point_triangle_distance_type(
        self->x.row(v), self->x.row(faces(f, 0)), self->x.row(faces(f, 1)),
        self->x.row(faces(f, 2)));
    int number = static_cast<int>(type); /* three corners, three edges, the face */
    return number < 3   ? name_of(NEAR_VV, v, faces(f, number))
           : number < 6 ? name_of(NEAR_VE, v, self->mesh.faces_to_edges()(f, number - 3))
                        : name_of(NEAR_VF, v, f);
}

near_name closest_of(const state *self, ipc::index_t a, ipc::index_t b,
                     ipc::EdgeEdgeDistanceType type)
{
    const Eigen::MatrixXi &edges = self->mesh.edges();
    int number = static_cast<int>(type); /* four pairs of ends, four of an end, both */
    return number < 4   ? name_of(NEAR_VV, edges(a, number / 2), edges(b, number % 2))
           : number < 6 ? name_of(NEAR_VE, edges(b, number - 4), a)
           : number < 8 ? name_of(NEAR_VE, edges(a, number - 6), b)
                        : name_of(NEAR_EE, a, b);
}

near_name closest_of(const state *self, const ipc::EdgeEdgeCandidate &pair)
{
    const Eigen::MatrixXi &edges = self->mesh.edges();
    ipc::index_t a = pair.edge0_id;
    ipc::index_t b = pair.edge1_id;
    return closest_of(
        self, a, b,
        ipc::edge_edge_distance_type(self->x.row(edges(a, 0)), self->x.row(edges(a, 1)),
                                     self->x.row(edges(b, 0)), self->x.row(edges(b, 1))));
}

void take_pairs(void *state_of, near_pair *found)
{
    auto *self = static_cast<state *>(state_of);
    /* They are numbered through: of two edges first. */
    std::size_t edges = self->candidates.ee_candidates.size();
    for (std::size_t i = 0; i < self->near.size(); i++) {
        std::size_t at = self->near[i];
        if (at < edges) {
            const auto &pair = self->candidates.ee_candidates[at];
            found[i].name = name_of(NEAR_EE, pair.edge0_id, pair.edge1_id);
            found[i].closest = closest_of(self, pair);
        } else {
            const auto &pair = self->candidates.fv_candidates[at - edges];
            found[i].name = name_of(NEAR_VF, pair.vertex_id, pair.face_id);
            found[i].closest = closest_of(self, pair);
        }
        found[i].squared = self->squared[i];
    }
}

/* Weights are counts where areas are not asked for. */
void take_features(void *state_of, near_feature *found, uint64_t *relabelled)
{
    auto *self = static_cast<state *>(state_of);
    *relabelled = 0;
    for (const auto &each : self->set.vv_collisions) {
        *found++ = {name_of(NEAR_VV, each.vertex0_id, each.vertex1_id),
                    static_cast<uint32_t>(each.weight)};
    }
    for (const auto &each : self->set.ev_collisions) {
        *found++ = {name_of(NEAR_VE, each.vertex_id, each.edge_id),
                    static_cast<uint32_t>(each.weight)};
    }
    for (const auto &each : self->set.fv_collisions) {
        *found++ = {name_of(NEAR_VF, each.vertex_id, each.face_id),
                    static_cast<uint32_t>(each.weight)};
    }
    for (const auto &each : self->set.ee_collisions) {
        near_name name = closest_of(self, each.edge0_id, each.edge1_id, each.dtype);
        *relabelled += name.kind != NEAR_EE;
        *found++ = {name, static_cast<uint32_t>(each.weight)};
    }
}

} // namespace

/* With the settings that it has by itself: it stops at 0.9 or 0.8 of the way to the time
 * that it finds. */
double near_ipc_toolkit_allowed(void *state_of, const double (*x1)[3], double r,
                                near_way way)
{
    auto *self = static_cast<state *>(state_of);
    static const ipc::AdditiveCCD additive;
    static const ipc::TightInclusionCCD inclusion;
    const ipc::NarrowPhaseCCD &narrow =
        way == NEAR_ADDITIVE ? static_cast<const ipc::NarrowPhaseCCD &>(additive)
                             : inclusion;
    Eigen::MatrixXd target = positions(x1, static_cast<uint32_t>(self->x.rows()));
    self->candidates.build(self->mesh, self->x, target, 0.5 * r, &self->tree);
    return self->candidates.compute_collision_free_stepsize(self->mesh, self->x, target,
                                                            r, narrow);
}

const near_peer near_ipc_toolkit = {"ipc-toolkit", version,    open,
                                    close,         pairs,      features,
                                    vertices,      take_pairs, take_features};
