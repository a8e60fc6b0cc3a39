/* mesh_fill.c - registration of a mesh.
 *
 * Threads: one thread until commit, any afterwards; the reference count is atomic.
 */
#include "mesh.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ingest.h"
#include "kernel.h"
#include "memory.h"
#include "query.h"
#include "topology.h"
#include "vec.h"

#define RADIUS_MAX 1e18

/* More than what squares below the normal range take off a length. */
#define LOST 0x1p-530

/* Leaves of which the typical size is told. */
#define FINENESS_SAMPLES 64u

int eng_mesh_make(const struct eng_mesh_counts *counts, struct eng_mesh **mesh)
{
    uint64_t named = (uint64_t)counts->triangles + counts->edges + counts->points;
    if (counts->vertices == 0 || counts->vertices > PROTO_COUNT_MAX || named == 0 ||
        named > PROTO_COUNT_MAX) {
        return PCCD_E_INVAL;
    }
    struct eng_mesh *m = eng_alloc(1, sizeof *m);
    if (!m) {
        return PCCD_E_NOMEM;
    }
    memset(m, 0, sizeof *m);
    atomic_init(&m->references, 1);
    atomic_init(&m->clearance.state, ENG_CLEARANCE_UNKNOWN);
    m->counts = *counts;
    m->account = eng_payer()->account;
    m->info.vertex_count = counts->vertices;
    m->info.triangle_count = counts->triangles;
    m->x = eng_alloc(counts->vertices, sizeof *m->x);
    m->corners = eng_alloc(named, sizeof *m->corners);
    if (!m->x || !m->corners) {
        eng_mesh_release(m);
        return PCCD_E_NOMEM;
    }
    *mesh = m;
    return PCCD_OK;
}

int eng_mesh_new(uint32_t vertex_count, uint32_t triangle_count, struct eng_mesh **mesh)
{
    return eng_mesh_make(
        &(struct eng_mesh_counts){.vertices = vertex_count, .triangles = triangle_count},
        mesh);
}

struct eng_mesh *eng_mesh_acquire(struct eng_mesh *mesh)
{
    assert(mesh);
    /* Relaxed: the caller holds a reference already. */
    atomic_fetch_add_explicit(&mesh->references, 1, memory_order_relaxed);
    return mesh;
}

void eng_mesh_release(struct eng_mesh *mesh)
{
    /* acq_rel: whoever frees must see every other holder's last use. */
    if (!mesh ||
        atomic_fetch_sub_explicit(&mesh->references, 1, memory_order_acq_rel) != 1) {
        return;
    }
    eng_free(mesh->x);
    eng_free(mesh->corners);
    eng_free(mesh->leaves);
    eng_free(mesh->edges);
    eng_free(mesh->free[PCCD_TREE_VERTICES]);
    eng_free(mesh->free[PCCD_TREE_EDGES]);
    eng_free(mesh->own[PCCD_TREE_VERTICES]);
    eng_free(mesh->own[PCCD_TREE_EDGES]);
    eng_free(mesh->radii);
    eng_free(mesh->reach);
    eng_free(mesh->order);
    eng_free(atomic_load_explicit(&mesh->body_tree, memory_order_acquire));
    eng_free(mesh->body_build.builder);
    eng_free(mesh->body_build.tree);
    eng_rings_deinit(mesh);
    eng_stars_deinit(mesh);
    eng_free(mesh->clearance.search);
    for (int tree = 0; tree <= PCCD_TREE_FACES; tree++) {
        eng_free(mesh->clearance.crowded[tree]);
    }
    eng_free(mesh);
}

/* Check that first .. first+count-1 is inside `total` and contiguous with what has
 * arrived. */
static int check_chunk(const struct eng_mesh *mesh, uint32_t first, uint32_t count,
                       uint32_t total, uint32_t received)
{
    if (mesh->committed) {
        return PCCD_E_STATE;
    }
    if (count == 0 || first > total || count > total - first) {
        return PCCD_E_INVAL;
    }
    return first > received ? PCCD_E_STATE : PCCD_OK;
}

static void drop_radii(struct eng_mesh *mesh)
{
    eng_free(mesh->radii);
    eng_free(mesh->reach);
    mesh->radii = NULL;
    mesh->reach = NULL;
}

int eng_mesh_check_radius(double radius)
{
    if (!(radius >= 0 && radius < INFINITY)) {
        return PCCD_E_INVAL;
    }
    return radius <= RADIUS_MAX ? PCCD_OK : PCCD_E_LIMIT;
}

int eng_mesh_write_vertices(struct eng_mesh *mesh, enum pccd_format format,
                            uint32_t first, uint32_t count, const void *source)
{
    int status =
        check_chunk(mesh, first, count, mesh->counts.vertices, mesh->received.vertices);
    if (status == PCCD_OK) {
        status = eng_ingest_positions(mesh->x + first, format, count, source, NULL);
    }
    if (status == PCCD_OK && first + count > mesh->received.vertices) {
        mesh->received.vertices = first + count;
    } else if (status == PCCD_E_NOTFINITE && mesh->received.vertices > first) {
        mesh->received.vertices = first; /* the chunk may have spoilt what stood there */
    }
    return status;
}

/* A chunk of what is named has been copied, or is bad. */
static int received(uint32_t *received, uint32_t first, uint32_t count, int status,
                    uint32_t *bad)
{
    if (status == PCCD_OK && first + count > *received) {
        *received = first + count;
    } else if (status == PCCD_E_INDEX) {
        *bad += first;
        *received = *received > first ? first : *received;
    }
    return status;
}

int eng_mesh_write_triangles(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                             const void *source, uint32_t *bad_triangle)
{
    int status =
        check_chunk(mesh, first, count, mesh->counts.triangles, mesh->received.triangles);
    if (status == PCCD_OK) {
        status = eng_ingest_triangles(mesh->corners + first, count, mesh->counts.vertices,
                                      source, bad_triangle);
    }
    return received(&mesh->received.triangles, first, count, status, bad_triangle);
}

int eng_mesh_write_edges(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                         const void *source, uint32_t *bad_edge)
{
    int status =
        check_chunk(mesh, first, count, mesh->counts.edges, mesh->received.edges);
    if (status == PCCD_OK) {
        status = eng_ingest_corners(mesh->corners + mesh->counts.triangles + first, 2,
                                    count, mesh->counts.vertices, source, bad_edge);
    }
    return received(&mesh->received.edges, first, count, status, bad_edge);
}

int eng_mesh_write_points(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                          const void *source, uint32_t *bad_point)
{
    uint32_t before = mesh->counts.triangles + mesh->counts.edges;
    int status =
        check_chunk(mesh, first, count, mesh->counts.points, mesh->received.points);
    if (status == PCCD_OK) {
        status = eng_ingest_corners(mesh->corners + before + first, 1, count,
                                    mesh->counts.vertices, source, bad_point);
    }
    return received(&mesh->received.points, first, count, status, bad_point);
}

int eng_mesh_write_radii(struct eng_mesh *mesh, uint32_t first, uint32_t count,
                         const double *source)
{
    uint32_t total = mesh->info.vertex_count;
    int status = check_chunk(mesh, first, count, total, total);
    if (status != PCCD_OK) {
        return status;
    }
    if (!mesh->radii) {
        mesh->radii = eng_alloc(total, sizeof *mesh->radii);
        mesh->reach = eng_alloc(total, sizeof *mesh->reach);
        if (!mesh->radii || !mesh->reach) {
            drop_radii(mesh);
            return PCCD_E_NOMEM;
        }
        memset(mesh->radii, 0, total * sizeof *mesh->radii);
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        double radius;
        memcpy(&radius, source + i, sizeof radius);
        status = eng_mesh_check_radius(radius);
        mesh->radii[first + i] = status == PCCD_OK ? radius : 0;
    }
    return status;
}

/* Measure how far the radii reach; nothing stays of radii that are all 0. */
static void measure_radii(struct eng_mesh *mesh)
{
    for (uint32_t i = 0; mesh->radii && i < mesh->info.vertex_count; i++) {
        mesh->reach[i] = mesh->radii[i];
        mesh->radius_max = fmax(mesh->radius_max, mesh->radii[i]);
    }
    if (mesh->radius_max == 0) {
        drop_radii(mesh);
        return;
    }
    for (uint32_t i = 0; i < mesh->leaf_count; i++) {
        const uint32_t *v = mesh->leaves[i].v;
        double most = fmax(fmax(mesh->radii[v[0]], mesh->radii[v[1]]), mesh->radii[v[2]]);
        for (int k = 0; k < 3; k++) {
            mesh->reach[v[k]] = fmax(mesh->reach[v[k]], most);
        }
    }
}

void eng_mesh_received(const struct eng_mesh *mesh, struct eng_mesh_counts *received)
{
    *received = mesh->received;
}

struct eng_bounds eng_mesh_measure(const struct eng_mesh *mesh, const double (*x)[3])
{
    assert(mesh->leaves && x);
    const struct eng_kernels *kernels = eng_kernels();
    struct eng_bounds bounds = ENG_NO_BOUNDS;
    if (mesh->info.isolated_count == 0) {
        kernels->bound_positions(x, mesh->info.vertex_count, &bounds);
        return bounds;
    }
    for (uint32_t i = 0; i < mesh->leaf_count; i++) {
        for (int k = 0; k < 3; k++) {
            kernels->bound_positions(x + mesh->leaves[i].v[k], 1, &bounds);
        }
    }
    return bounds;
}

static double square_of(const double *x, const double *middle)
{
    double way[3];
    eng_sub(way, x, middle);
    return eng_dot(way, way);
}

/* Return at least how far corners of leaves are from the middle of their bounds. */
static double radius_of(const struct eng_mesh *mesh)
{
    double middle[3];
    double most = 0;
    bool is_all = mesh->info.isolated_count == 0;
    eng_mesh_middle(mesh, middle);
    for (uint32_t i = 0; is_all && i < mesh->info.vertex_count; i++) {
        most = eng_most(most, square_of(mesh->x[i], middle));
    }
    for (uint32_t i = 0; !is_all && i < mesh->leaf_count; i++) {
        for (int k = 0; k < 3; k++) {
            most = eng_most(most, square_of(mesh->x[mesh->leaves[i].v[k]], middle));
        }
    }
    return sqrt(most) * (1 + 8 * ENG_U) + LOST;
}

static int compare_sizes(const void *a, const void *b)
{
    const double *x = a;
    const double *y = b;
    return *x < *y ? -1 : *x > *y;
}

/* The median size of some leaves beside that of the mesh. */
static double fineness_of(const struct eng_mesh *mesh)
{
    double sizes[FINENESS_SAMPLES];
    uint32_t count = mesh->leaf_count;
    uint32_t samples = count < FINENESS_SAMPLES ? count : FINENESS_SAMPLES;
    for (uint32_t i = 0; i < samples; i++) {
        const uint32_t *v = mesh->leaves[(uint64_t)count * i / samples].v;
        struct eng_bounds bounds = ENG_NO_BOUNDS;
        for (int k = 0; k < 3; k++) {
            eng_kernels()->bound_positions((const double(*)[3])mesh->x + v[k], 1,
                                           &bounds);
        }
        sizes[i] = eng_bounds_size(&bounds);
    }
    qsort(sizes, samples, sizeof *sizes, compare_sizes);
    double median = sizes[samples / 2];
    return median > 0 ? median / eng_bounds_size(&mesh->bounds) : 1 / sqrt(count);
}

int eng_mesh_commit(struct eng_mesh *mesh, uint32_t threads)
{
    if (mesh->committed ||
        memcmp(&mesh->received, &mesh->counts, sizeof mesh->counts) != 0) {
        return PCCD_E_STATE;
    }
    int status = eng_feature_derive(mesh, threads);
    if (status != PCCD_OK) {
        return status;
    }
    eng_free(mesh->corners);
    mesh->corners = NULL;
    mesh->bounds = eng_mesh_measure(mesh, (const double(*)[3])mesh->x);
    mesh->radius = radius_of(mesh);
    mesh->fineness = fineness_of(mesh);
    measure_radii(mesh);
    mesh->committed = true;
    return PCCD_OK;
}

bool eng_mesh_is_committed(const struct eng_mesh *mesh)
{
    return mesh->committed;
}

void eng_mesh_get_info(const struct eng_mesh *mesh, struct eng_mesh_info *info)
{
    assert(mesh->committed);
    *info = mesh->info;
}

const uint32_t (*eng_mesh_edges(const struct eng_mesh *mesh))[2]
{
    return (const uint32_t(*)[2])mesh->edges;
}

const double (*eng_mesh_vertices(const struct eng_mesh *mesh))[3]
{
    return (const double(*)[3])mesh->x;
}

const double *eng_mesh_radii(const struct eng_mesh *mesh)
{
    return mesh->radii;
}

void eng_mesh_get_corners(const struct eng_mesh *mesh, uint32_t (*corners)[3])
{
    assert(mesh->committed && corners);
    for (uint32_t i = 0; i < mesh->info.triangle_count; i++) {
        memcpy(corners[i], mesh->leaves[i].v, sizeof *corners);
    }
}

void eng_mesh_get_free(const struct eng_mesh *mesh, uint32_t (*ends)[2], uint32_t *points)
{
    assert(mesh->committed);
    const struct eng_face *leaf = mesh->leaves + mesh->info.triangle_count;
    for (uint32_t i = 0; i < mesh->info.free_edge_count; i++) {
        memcpy(ends[i], (leaf++)->v, sizeof *ends);
    }
    for (uint32_t i = 0; i < mesh->info.free_point_count; i++) {
        points[i] = (leaf++)->v[0];
    }
}

static uint64_t words_for(uint64_t bits)
{
    return bits / 64 + 1;
}

static uint64_t *copy_bits(const uint64_t *bits, uint32_t count)
{
    uint64_t *copy = eng_alloc(words_for(count) + 1, sizeof *copy);
    if (copy) {
        memcpy(copy, bits, words_for(count) * sizeof *copy);
    }
    return copy;
}

int eng_mesh_set_own(struct eng_mesh *mesh, const uint64_t *vertices,
                     const uint64_t *edges)
{
    if (!mesh->committed || eng_mesh_has_foreign(mesh)) {
        return PCCD_E_STATE;
    }
    uint64_t *of_vertices = copy_bits(vertices, mesh->info.vertex_count);
    uint64_t *of_edges = copy_bits(edges, mesh->info.edge_count);
    if (!of_vertices || !of_edges) {
        eng_free(of_vertices);
        eng_free(of_edges);
        return PCCD_E_NOMEM;
    }
    mesh->own[PCCD_TREE_VERTICES] = of_vertices;
    mesh->own[PCCD_TREE_EDGES] = of_edges;
    return PCCD_OK;
}

uint64_t eng_mesh_bytes(const struct eng_mesh *mesh)
{
    const struct eng_mesh_info *info = &mesh->info;
    return sizeof *mesh + (uint64_t)info->vertex_count * sizeof *mesh->x +
           (mesh->committed ? (uint64_t)mesh->leaf_count * sizeof *mesh->leaves
                            : ((uint64_t)mesh->counts.triangles + mesh->counts.edges +
                               mesh->counts.points) *
                                  sizeof *mesh->corners) +
           (uint64_t)info->edge_count * sizeof *mesh->edges +
           (mesh->free[PCCD_TREE_VERTICES] ? words_for(info->vertex_count) * 8 : 0) +
           (mesh->free[PCCD_TREE_EDGES] ? words_for(info->edge_count) * 8 : 0) +
           (mesh->own[PCCD_TREE_VERTICES]
                ? (words_for(info->vertex_count) + words_for(info->edge_count)) * 8
                : 0) +
           (mesh->radii ? (uint64_t)info->vertex_count * 2 * sizeof *mesh->radii : 0) +
           eng_rings_bytes(mesh) + eng_stars_bytes(mesh) + mesh->order_bytes +
           atomic_load_explicit(&mesh->body_tree_bytes, memory_order_relaxed);
}
