/* feature.c - unique edges and who owns which feature.
 *
 * Sort the sides of all that is named by (higher, lower) vertex; runs of equal sides are
 * one edge, owned by the first of the run. Sides are dealt out to their higher vertices,
 * each of which has a few: linear time, where sorting all of them takes a pass more for
 * each byte of a vertex's number.
 *
 * Source: paper section 3.1; Curtis 2008 (representative triangles).
 */
#include "topology.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "memory.h"
#include "parallel.h"
#include "sort.h"

/* ---- by vertices ------------------------------------------------------------------- */

/* Leaves of a mesh below which one thread derives it: half a millisecond. */
#define TEAM_LEAVES_MIN 16384u

/* Leaves, or entries, after which what is fetched is used: with numbers that are shuffled
 * each is far from the others. */
#define AHEAD 16u

/* Entries of a vertex that are sorted where they are. */
#define INSERTED_MAX 24u

/* The named features by vertex: triangles first, then edges and points, with their last
 * vertex repeated. What is named of its vertices: of v entry[first[v]] to entry[first[v +
 * 1]], ascending. */
struct by_vertex {
    size_t *first;              /* [vertex_count + 1] */
    uint64_t *entry;            /* [3 * all that is named + 1] */
    struct eng_radix_key *keys; /* for vertices with many; NULL: none has */
    size_t count;               /* of entries */
    size_t repeats;             /* of these, like the one before them of their vertex */
};

/* Entries that a leaf has of one of its vertices. */
struct said {
    uint32_t vertex;
    uint32_t count;
    uint64_t entry[2];
};

/* Tell what leaf `t` names, of how many vertices. */
typedef unsigned (*say_fn)(const uint32_t *corners, uint32_t t, struct said said[2]);

static inline void sort_corners(const uint32_t *corners, uint32_t sorted[3])
{
    uint32_t a = corners[0];
    uint32_t b = corners[1];
    uint32_t c = corners[2];
    sorted[0] = a < b ? (a < c ? a : c) : (b < c ? b : c);
    sorted[2] = a > b ? (a > c ? a : c) : (b > c ? b : c);
    sorted[1] = a ^ b ^ c ^ sorted[0] ^ sorted[2];
}

/* Each side that is an edge: of its higher vertex (lower, number). */
static inline unsigned say_sides(const uint32_t *corners, uint32_t t, struct said said[2])
{
    uint32_t v[3];
    sort_corners(corners, v);
    uint64_t lowest = (uint64_t)v[0] << 32 | t;
    said[0].vertex = v[2];
    said[0].count = (uint32_t)(v[0] != v[2]) + (uint32_t)(v[1] != v[2]);
    said[0].entry[0] = lowest;
    said[0].entry[1] = (uint64_t)v[1] << 32 | t;
    said[1].vertex = v[1];
    said[1].count = v[0] != v[1];
    said[1].entry[0] = lowest;
    return 2;
}

/* All corners: of the highest (middle, lowest). */
static inline unsigned say_corners(const uint32_t *corners, uint32_t t,
                                   struct said said[2])
{
    uint32_t v[3];
    (void)t;
    sort_corners(corners, v);
    said[0].vertex = v[2];
    said[0].count = 1;
    said[0].entry[0] = (uint64_t)v[1] << 32 | v[0];
    return 1;
}

/* Deal out what the first `named` say, in their order. Returns the most of a vertex. */
static inline size_t deal(const struct eng_mesh *mesh, uint32_t named, say_fn say,
                          struct by_vertex *by)
{
    size_t vertex_count = mesh->info.vertex_count;
    struct said said[2];
    size_t most = 0;
    memset(by->first, 0, (vertex_count + 1) * sizeof *by->first);
    by->count = 0;
    for (uint32_t t = 0; t < named; t++) {
        const uint32_t *ahead = mesh->corners[t + AHEAD < named ? t + AHEAD : t];
        for (unsigned k = 0; k < 3; k++) {
            __builtin_prefetch(&by->first[ahead[k]], 1);
        }
        for (unsigned i = say(mesh->corners[t], t, said); i-- > 0;) {
            by->first[said[i].vertex] += said[i].count;
        }
    }
    for (size_t v = 0; v <= vertex_count; v++) { /* its end; while dealing, its begin */
        most = by->first[v] > most ? by->first[v] : most;
        by->count += by->first[v];
        by->first[v] = by->count;
    }
    for (uint32_t t = named; t-- > 0;) {
        const uint32_t *ahead = mesh->corners[t >= AHEAD ? t - AHEAD : t];
        const uint32_t *next = mesh->corners[t >= AHEAD / 2 ? t - AHEAD / 2 : t];
        for (unsigned k = 0; k < 3; k++) {
            __builtin_prefetch(&by->first[ahead[k]], 1);
            __builtin_prefetch(&by->entry[by->first[next[k]]], 1);
        }
        for (unsigned i = say(mesh->corners[t], t, said); i-- > 0;) {
            size_t at = by->first[said[i].vertex] -= said[i].count;
            for (uint32_t e = 0; e < said[i].count; e++) {
                by->entry[at + e] = said[i].entry[e];
            }
        }
    }
    return most;
}

static void sort_entries(uint64_t *entry, size_t count, struct eng_radix_key *keys)
{
    if (count > INSERTED_MAX) {
        for (size_t i = 0; i < count; i++) {
            keys[i] = (struct eng_radix_key){.key = entry[i]};
        }
        keys = eng_radix_sort(keys, keys + count, count);
        for (size_t i = 0; i < count; i++) {
            entry[i] = keys[i].key;
        }
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint64_t one = entry[i];
        size_t at = i;
        while (at > 0 && entry[at - 1] > one) {
            entry[at] = entry[at - 1];
            at--;
        }
        entry[at] = one;
    }
}

/* Sort those of each vertex; the one with the most has `most`. Entries are alike that
 * differ in their `ignored` lowest bits alone. */
static int sort_all(const struct eng_mesh *mesh, size_t most, unsigned ignored,
                    struct by_vertex *by)
{
    if (most > INSERTED_MAX) {
        eng_free(by->keys);
        by->keys = eng_alloc(most, 2 * sizeof *by->keys);
        if (!by->keys) {
            return PCCD_E_NOMEM;
        }
    }
    by->repeats = 0;
    for (size_t v = 0; v < mesh->info.vertex_count; v++) {
        uint64_t *entry = by->entry + by->first[v];
        size_t count = by->first[v + 1] - by->first[v];
        sort_entries(entry, count, by->keys);
        for (size_t i = 1; i < count; i++) {
            by->repeats += entry[i] >> ignored == entry[i - 1] >> ignored;
        }
    }
    return PCCD_OK;
}

/* ---- leaves, edges, vertices ------------------------------------------------------- */

/* Zero area: all three 2x2 minors of the edge vectors vanish. Each minor is compared
 * through its two products, exactly (product and its rounding error); the edge vectors
 * themselves are rounded differences, exact whenever the corners are within a factor of
 * two or on a common grid. The count is a report to the user, not a predicate of the
 * engine. */
static bool has_zero_area(const double (*x)[3], const uint32_t *v)
{
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        return true;
    }
    double b[3];
    double c[3];
    for (int k = 0; k < 3; k++) {
        b[k] = x[v[1]][k] - x[v[0]][k];
        c[k] = x[v[2]][k] - x[v[0]][k];
    }
    for (int k = 0; k < 3; k++) {
        int j = (k + 1) % 3;
        double p = b[k] * c[j];
        double q = b[j] * c[k];
        if (p != q || fma(b[k], c[j], -p) != fma(b[j], c[k], -q)) {
            return false;
        }
    }
    return true;
}

/* The first side of a leaf between these two, which has one. */
static unsigned side_of(const uint32_t *v, uint32_t low, uint32_t high)
{
    unsigned k = 0;
    while (k < 2 &&
           !((v[k] == low && v[k + 1] == high) || (v[k] == high && v[k + 1] == low))) {
        k++;
    }
    return k;
}

/* Number the edges and let the lowest leaf with a side own its edge. Edges, (lower,
 * higher) vertex, take the places of entries. Returns whether two triangles may have the
 * same corners, as no two have that share a side with one more at most and have different
 * third corners. */
static bool assign_edges(const struct eng_mesh *mesh, struct by_vertex *by,
                         struct eng_face *leaves)
{
    size_t edge = 0;
    bool may_repeat = false;
    for (uint32_t v = 0; v < mesh->info.vertex_count; v++) {
        const struct eng_face *last = NULL; /* with the same side, alone as yet */
        uint64_t low = UINT64_MAX;
        for (size_t i = by->first[v]; i < by->first[v + 1]; i++) {
            uint64_t entry = by->entry[i];
            size_t ahead = i + AHEAD < by->count ? i + AHEAD : i;
            __builtin_prefetch(&leaves[(uint32_t)by->entry[ahead]], 1);
            struct eng_face *leaf = &leaves[(uint32_t)entry];
            if (entry >> 32 == low) {
                may_repeat |= !last || (leaf->v[0] ^ leaf->v[1] ^ leaf->v[2]) ==
                                           (last->v[0] ^ last->v[1] ^ last->v[2]);
                last = NULL;
                continue;
            }
            low = entry >> 32;
            last = leaf;
            leaf->owns |= ENG_OWNS_EDGE(side_of(leaf->v, (uint32_t)low, v));
            const uint32_t ends[2] = {(uint32_t)low, v};
            memcpy(&by->entry[edge++], ends, sizeof ends);
        }
    }
    return may_repeat;
}

/* Make a leaf, which owns its vertices that are not `seen` yet. Returns how many. */
static inline uint32_t make_leaf(const uint32_t *corners, uint32_t owns, uint8_t *seen,
                                 struct eng_face *leaf)
{
    uint32_t count = 0;
    memcpy(leaf->v, corners, sizeof leaf->v);
    for (unsigned k = 0; k < 3; k++) {
        uint32_t is_first = 1u ^ seen[corners[k]];
        seen[corners[k]] = 1;
        owns |= is_first * ENG_OWNS_VERTEX(k);
        count += is_first;
    }
    leaf->owns = owns;
    return count;
}

/* Triangles stay; behind them come the edges that own themselves, then the points that
 * do. Returns how many leaves there are. */
static uint32_t order_leaves(struct eng_mesh_info *info, struct eng_face *leaves,
                             uint32_t named)
{
    uint32_t count = info->triangle_count;
    for (uint32_t t = count; t < named; t++) {
        if (leaves[t].owns & ENG_OWNS_EDGE(0)) {
            struct eng_face edge = leaves[t];
            leaves[t] = leaves[count];
            leaves[count++] = edge;
        }
    }
    info->free_edge_count = count - info->triangle_count;
    for (uint32_t t = count; t < named; t++) {
        if (leaves[t].owns == ENG_OWNS_VERTEX(0)) {
            leaves[count++] = leaves[t];
        }
    }
    info->free_point_count = count - info->triangle_count - info->free_edge_count;
    return count;
}

/* A bit for each edge and each point that is free; `first`: eng_feature_index. */
static void mark_free(struct eng_mesh *mesh, const uint32_t *first)
{
    const struct eng_face *leaf = mesh->leaves + mesh->info.triangle_count;
    for (uint32_t i = 0; i < mesh->info.free_edge_count; i++, leaf++) {
        eng_mesh_set_bit(mesh->free[PCCD_TREE_EDGES],
                         eng_feature_edge(mesh, first, leaf->v[0], leaf->v[1]));
    }
    for (uint32_t i = 0; i < mesh->info.free_point_count; i++, leaf++) {
        eng_mesh_set_bit(mesh->free[PCCD_TREE_VERTICES], leaf->v[0]);
    }
}

uint32_t eng_mesh_edge(const struct eng_mesh *mesh, uint32_t a, uint32_t b)
{
    const uint32_t ends[2] = {a < b ? a : b, a < b ? b : a};
    uint32_t low = 0;
    uint32_t high = mesh->info.edge_count;
    while (high - low > 1) { /* by (higher, lower) vertex */
        uint32_t middle = low + (high - low) / 2;
        const uint32_t *edge = mesh->edges[middle];
        bool is_after = edge[1] > ends[1] || (edge[1] == ends[1] && edge[0] > ends[0]);
        low = is_after ? low : middle;
        high = is_after ? middle : high;
    }
    assert(mesh->edges[low][0] == ends[0] && mesh->edges[low][1] == ends[1]);
    return low;
}

uint64_t *eng_feature_new_bits(uint32_t count)
{
    size_t words = (size_t)count / 64 + 1;
    uint64_t *bits = eng_alloc(words, sizeof *bits);
    if (bits) {
        memset(bits, 0, words * sizeof *bits);
    }
    return bits;
}

/* Bits for `count` features of which some are free. */
static uint64_t *new_bits(uint32_t count, uint32_t free_count, int *status)
{
    uint64_t *bits = free_count > 0 ? eng_feature_new_bits(count) : NULL;
    *status = free_count > 0 && !bits ? PCCD_E_NOMEM : *status;
    return bits;
}

/* List the sides. */
static int list_sides(const struct eng_mesh *mesh, uint32_t named, struct by_vertex *by,
                      struct eng_mesh_info *info)
{
    int status = sort_all(mesh, deal(mesh, named, say_sides, by), 32, by);
    if (status == PCCD_OK && by->count - by->repeats > PROTO_COUNT_MAX) {
        status = PCCD_E_LIMIT;
    }
    info->edge_count = (uint32_t)(by->count - by->repeats);
    return status;
}

/* Count repetitions of triangles, whose corners are in any order. */
static int count_duplicates(const struct eng_mesh *mesh, struct by_vertex *by,
                            struct eng_mesh_info *info)
{
    eng_free(by->entry);
    by->entry = eng_alloc(info->triangle_count, sizeof *by->entry);
    if (!by->entry) {
        return PCCD_E_NOMEM;
    }
    int status = sort_all(mesh, deal(mesh, info->triangle_count, say_corners, by), 0, by);
    info->duplicate_count = (uint32_t)by->repeats;
    return status;
}

/* The parts of a mesh that are derived from what was named. */
struct derived {
    struct eng_mesh_info info;
    struct eng_face *leaves; /* at first all that is named */
    uint32_t leaf_count;
    uint32_t (*edges)[2];
    uint64_t *free[PCCD_TREE_EDGES + 1];
};

static void derived_free(struct derived *derived)
{
    eng_free(derived->leaves);
    eng_free(derived->edges);
    eng_free(derived->free[PCCD_TREE_VERTICES]);
    eng_free(derived->free[PCCD_TREE_EDGES]);
}

/* Derive what needs no edges: who comes first owns a vertex, points come last. Returns
 * whether a triangle is a point, which has no side. `seen`: a byte for each vertex. */
static bool derive_leaves(const struct eng_mesh *mesh, uint32_t named, uint8_t *seen,
                          struct derived *derived)
{
    struct eng_mesh_info *info = &derived->info;
    const double(*x)[3] = (const double(*)[3])mesh->x;
    const uint32_t(*corners)[3] = (const uint32_t(*)[3])mesh->corners;
    bool has_point = false;
    memset(seen, 0, info->vertex_count);
    info->isolated_count = info->vertex_count;
    for (uint32_t t = 0; t < info->triangle_count; t++) {
        const uint32_t *v = corners[t];
        const uint32_t *ahead = corners[t + AHEAD < named ? t + AHEAD : t];
        for (unsigned k = 0; k < 3; k++) {
            __builtin_prefetch(x[ahead[k]]);
        }
        info->isolated_count -= make_leaf(v, ENG_OWNS_FACE, seen, &derived->leaves[t]);
        if (has_zero_area(x, v)) {
            info->degenerate_count++;
            has_point |= v[0] == v[1] && v[1] == v[2];
        }
    }
    for (int points = 0; points < 2; points++) {
        for (uint32_t t = info->triangle_count; t < named; t++) {
            if ((corners[t][0] == corners[t][1]) == points) {
                info->isolated_count -=
                    make_leaf(corners[t], 0, seen, &derived->leaves[t]);
            }
        }
    }
    return has_point;
}

static int derive(const struct eng_mesh *mesh, uint32_t named, struct by_vertex *by,
                  uint8_t *seen, uint32_t threads, struct derived *derived)
{
    struct eng_mesh_info *info = &derived->info;
    int status = PCCD_OK;
    bool may_repeat = false;
    struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)threads) if (threads > 1)
    {
        ENG_PARALLEL_JOIN(region);
#pragma omp sections
        {
#pragma omp section
            status = list_sides(mesh, named, by, info);
#pragma omp section
            may_repeat = derive_leaves(mesh, named, seen, derived);
        }
    }
    eng_parallel_close();
    if (status != PCCD_OK) {
        return status;
    }
    may_repeat |= assign_edges(mesh, by, derived->leaves);
    derived->edges =
        eng_realloc(by->entry, (size_t)info->edge_count + 1, sizeof *derived->edges);
    if (!derived->edges) {
        return PCCD_E_NOMEM;
    }
    by->entry = NULL;
    status = may_repeat ? count_duplicates(mesh, by, info) : PCCD_OK;
    if (status != PCCD_OK) {
        return status;
    }
    derived->leaf_count = order_leaves(info, derived->leaves, named);
    derived->free[PCCD_TREE_VERTICES] =
        new_bits(info->vertex_count, info->free_point_count, &status);
    derived->free[PCCD_TREE_EDGES] =
        new_bits(info->edge_count, info->free_edge_count, &status);
    return status;
}

/* The mesh takes it; `first` has room for eng_feature_index. */
static void take(struct eng_mesh *mesh, struct derived *derived, size_t *first)
{
    mesh->info = derived->info;
    mesh->leaves = derived->leaves;
    mesh->leaf_count = derived->leaf_count;
    mesh->edges = derived->edges;
    memcpy(mesh->free, derived->free, sizeof mesh->free);
    derived->leaves = NULL;
    derived->edges = NULL;
    memset(derived->free, 0, sizeof derived->free);
    if (mesh->leaf_count > mesh->info.triangle_count) {
        uint32_t *index = (uint32_t *)(void *)first;
        eng_feature_index(mesh, index);
        mark_free(mesh, index);
    }
}

int eng_feature_derive(struct eng_mesh *mesh, uint32_t threads)
{
    assert(mesh->corners && mesh->x);
    const struct eng_mesh_counts *counts = &mesh->counts;
    uint32_t named = counts->triangles + counts->edges + counts->points;
    int status = PCCD_E_NOMEM;
    struct derived derived = {.info = mesh->info};
    struct by_vertex by = {.first =
                               eng_alloc((size_t)counts->vertices + 1, sizeof *by.first),
                           .entry = eng_alloc((size_t)named * 3 + 1, sizeof *by.entry)};
    uint8_t *seen = eng_alloc(counts->vertices, 1);
    derived.leaves = eng_alloc(named, sizeof *derived.leaves);
    threads = named < TEAM_LEAVES_MIN || threads == 0 ? 1 : eng_payer_threads(threads);
    if (by.first && by.entry && seen && derived.leaves) {
        status = derive(mesh, named, &by, seen, threads, &derived);
    }
    if (status == PCCD_OK) {
        take(mesh, &derived, by.first);
    }
    derived_free(&derived);
    eng_free(seen);
    eng_free(by.keys);
    eng_free(by.entry);
    eng_free(by.first);
    return status;
}

void eng_feature_index(const struct eng_mesh *mesh, uint32_t *first)
{
    assert(first);
    uint32_t v = 0;
    for (uint32_t e = 0; e < mesh->info.edge_count; e++) {
        for (; v <= mesh->edges[e][1]; v++) {
            first[v] = e;
        }
    }
    for (; v <= mesh->info.vertex_count; v++) {
        first[v] = mesh->info.edge_count;
    }
}

uint32_t eng_feature_edge(const struct eng_mesh *mesh, const uint32_t *first, uint32_t a,
                          uint32_t b)
{
    if (a == b) {
        return ENG_NO_EDGE;
    }
    uint32_t high = a > b ? a : b;
    uint32_t low = a > b ? b : a;
    uint32_t from = first[high];
    uint32_t end = first[high + 1];
    while (end - from > 1) {
        uint32_t middle = from + (end - from) / 2;
        if (mesh->edges[middle][0] <= low) {
            from = middle;
        } else {
            end = middle;
        }
    }
    return from;
}

bool eng_feature_validate(const struct eng_mesh *mesh)
{
    const struct eng_mesh_info *info = &mesh->info;
    size_t bytes = (size_t)info->vertex_count + info->edge_count;
    uint8_t *owners = eng_alloc(bytes, 1);
    uint32_t *first = eng_alloc((size_t)info->vertex_count + 1, sizeof *first);
    if (!owners || !first) {
        eng_free(owners);
        eng_free(first);
        return true;
    }
    memset(owners, 0, bytes);
    eng_feature_index(mesh, first);
    bool valid = true;
    uint64_t owned_vertices = 0;
    uint64_t owned_edges = 0;
    for (uint32_t t = 0; t < mesh->leaf_count; t++) {
        const struct eng_face *leaf = &mesh->leaves[t];
        for (unsigned k = 0; k < 3; k++) {
            if (leaf->owns & ENG_OWNS_VERTEX(k)) {
                valid &= owners[leaf->v[k]]++ == 0;
                owned_vertices++;
            }
            if (leaf->owns & ENG_OWNS_EDGE(k)) {
                uint32_t edge =
                    eng_feature_edge(mesh, first, leaf->v[k], leaf->v[(k + 1) % 3]);
                valid &= edge < info->edge_count;
                valid = valid && owners[info->vertex_count + edge]++ == 0;
                owned_edges++;
            }
        }
    }
    eng_free(owners);
    eng_free(first);
    return valid && owned_edges == info->edge_count &&
           owned_vertices == info->vertex_count - info->isolated_count;
}

/* ---- is a mesh closed? ------------------------------------------------------------- */

/* The values that a mesh keeps: one of these, or the number of its first open edge +
 * FIRST_OPEN. */
enum { NOT_KNOWN = 0, CLOSED = 1, FIRST_OPEN = 2 };

/* *balance: of each edge, runs up less runs down, modulo 2^32. */
static void count_runs(const struct eng_mesh *mesh, const uint32_t *first,
                       uint32_t *balance)
{
    for (uint32_t i = 0; i < mesh->info.triangle_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = mesh->leaves[i].v[k];
            uint32_t to = mesh->leaves[i].v[(k + 1) % 3];
            if (from != to) {
                balance[eng_feature_edge(mesh, first, from, to)] += from < to ? 1 : -1u;
            }
        }
    }
}

static int find_out(const struct eng_mesh *mesh, uint32_t *state)
{
    uint32_t *first = eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *first);
    uint32_t *balance = eng_alloc((size_t)mesh->info.edge_count + 1, sizeof *balance);
    int status = first && balance ? PCCD_OK : PCCD_E_NOMEM;
    if (status == PCCD_OK) {
        memset(balance, 0, ((size_t)mesh->info.edge_count + 1) * sizeof *balance);
        eng_feature_index(mesh, first);
        count_runs(mesh, first, balance);
        uint32_t edge = 0;
        while (edge < mesh->info.edge_count && balance[edge] == 0) {
            edge++;
        }
        *state = edge < mesh->info.edge_count ? FIRST_OPEN + edge : CLOSED;
    }
    eng_free(first);
    eng_free(balance);
    return status;
}

static void describe(const struct eng_mesh *mesh, uint32_t edge,
                     struct eng_open_edge *open)
{
    const uint32_t *ends = mesh->edges[edge];
    *open = (struct eng_open_edge){{ends[0], ends[1]}, {0, 0}};
    for (uint32_t i = 0; i < mesh->info.triangle_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = mesh->leaves[i].v[k];
            uint32_t to = mesh->leaves[i].v[(k + 1) % 3];
            open->runs[0] += from == ends[0] && to == ends[1];
            open->runs[1] += from == ends[1] && to == ends[0];
        }
    }
}

int eng_mesh_is_closed(struct eng_mesh *mesh, struct eng_open_edge *open)
{
    assert(mesh->committed);
    uint32_t state = atomic_load_explicit(&mesh->closed, memory_order_relaxed);
    if (state == NOT_KNOWN) {
        int status = find_out(mesh, &state);
        if (status != PCCD_OK) {
            return status;
        }
        atomic_store_explicit(&mesh->closed, state, memory_order_relaxed);
    }
    if (state == CLOSED) {
        return PCCD_OK;
    }
    describe(mesh, state - FIRST_OPEN, open);
    return PCCD_E_INVAL;
}
