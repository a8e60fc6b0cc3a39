/* spacing.c - near features of a mesh.
 *
 * Sort the triangles along a curve that fills space (Morton), make boxes around four of
 * them, four of these, and so on; look for each triangle at all behind it whose boxes are
 * within the spacing; and try to separate the features that the two own (feature.h), so
 * that each pair of features is seen once.
 */
#include "spacing.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "closest.h"
#include "feature.h"
#include "kinds.h"
#include "memory.h"
#include "radix.h"
#include "topology.h"
#include "vec.h"

/* The spacing beside the size of a typical triangle. A body may be 10^8 times farther
 * from the origin than its triangles are large before rounding reaches it, and what is
 * nearer than a millionth of a triangle touches, as a rule. */
#define SPACING_PART 0x1p-20

/* Of the features, those that may be near: with more, little is left out. */
#define NEAR_PART 16u

/* Tests a triangle, on average, before the search is given up: 30 to 60 are needed as a
 * rule, thousands where triangles lie in heaps. */
#define WORK_MAX 1024u

#define FAN        4u  /* children of a node */
#define LEVELS_MAX 16u /* 4^16 triangles are more than any mesh has */
#define STACK_MAX  (FAN * LEVELS_MAX)
#define KEY_BITS   21 /* of each coordinate */
#define LOOK_COST  4u /* of a triangle whose vertices are read, in tests of boxes */

enum phase { KEYS, BOXES, PAIRS };

struct eng_spacing_search {
    enum phase phase;
    uint32_t at; /* triangle, node or place in the order: what comes next */
    uint32_t level;
    struct eng_radix_key *keys;   /* [2 * triangle_count]; by place in the order .. */
    struct eng_radix_key *sorted; /* .. once sorted: which of the two halves */
    struct eng_bounds *nodes;     /* of all levels, the lowest first */
    uint32_t first[LEVELS_MAX];   /* of a level */
    uint32_t count[LEVELS_MAX];
    uint32_t level_count;
    uint32_t *edge_first; /* eng_feature_index */
    /* Looking for what is near the triangle in place `at`: nodes that wait. */
    struct eng_bounds bounds; /* of that triangle */
    uint32_t stack[STACK_MAX][2];
    uint32_t stack_count;
};

/* ---- memory ------------------------------------------------------------------------ */

static void search_free(struct eng_spacing_search *search)
{
    if (search) {
        eng_free(search->keys);
        eng_free(search->nodes);
        eng_free(search->edge_first);
        eng_free(search);
    }
}

void eng_spacing_deinit(struct eng_mesh *mesh)
{
    search_free(mesh->spacing.search);
    eng_free(mesh->spacing.near[0]);
}

static struct eng_spacing_search *search_new(const struct eng_mesh *mesh)
{
    struct eng_spacing_search *search = eng_alloc(1, sizeof *search);
    if (!search) {
        return NULL;
    }
    memset(search, 0, sizeof *search);
    size_t nodes = 0;
    uint32_t count = mesh->info.triangle_count;
    do {
        count = (count - 1) / FAN + 1;
        search->first[search->level_count] = (uint32_t)nodes;
        search->count[search->level_count++] = count;
        nodes += count;
    } while (count > 1);
    search->keys = eng_alloc(2 * (size_t)mesh->info.triangle_count, sizeof *search->keys);
    search->nodes = eng_alloc(nodes, sizeof *search->nodes);
    search->edge_first =
        eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *search->edge_first);
    if (!search->keys || !search->nodes || !search->edge_first) {
        search_free(search);
        return NULL;
    }
    eng_feature_index(mesh, search->edge_first);
    return search;
}

/* Bits for everything, none of them set. */
static bool make_bits(const struct eng_mesh *mesh, struct eng_spacing *spacing)
{
    const uint32_t counts[PCCD_TREE_FACES + 1] = {
        [PCCD_TREE_VERTICES] = mesh->info.vertex_count,
        [PCCD_TREE_EDGES] = mesh->info.edge_count,
        [PCCD_TREE_FACES] = mesh->info.triangle_count};
    size_t first[PCCD_TREE_FACES + 1];
    size_t words = 0;
    for (int tree = 0; tree <= PCCD_TREE_FACES; tree++) {
        first[tree] = words;
        words += counts[tree] / 64 + 1;
    }
    uint64_t *bits = eng_alloc(words, sizeof *bits);
    if (!bits) {
        return false;
    }
    memset(bits, 0, words * sizeof *bits);
    for (int tree = 0; tree <= PCCD_TREE_FACES; tree++) {
        spacing->near[tree] = bits + first[tree];
    }
    return true;
}

/* ---- two features ------------------------------------------------------------------ */

/* Is there certainly more than `length` between the boxes? */
static bool boxes_are_apart(const struct eng_bounds *a, const struct eng_bounds *b,
                            double length)
{
    double more = length * (1 + 0x1p-20);
    for (int k = 0; k < 3; k++) {
        if (a->low[k] - b->high[k] > more || b->low[k] - a->high[k] > more) {
            return true;
        }
    }
    return false;
}

static void bound_points(const double *const *points, uint32_t count,
                         struct eng_bounds *bounds)
{
    *bounds = (struct eng_bounds)ENG_NO_BOUNDS;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            bounds->low[k] = eng_least(bounds->low[k], points[i][k]);
            bounds->high[k] = eng_most(bounds->high[k], points[i][k]);
        }
    }
}

/* Is there certainly more than `length` between two features, of a_count and 4 - a_count
 * points? Along the line between their nearest points, or what seem to be those:
 * whatever direction it is, features that are so far apart along it are so far apart. */
static bool is_apart(enum pccd_kind kind, const double *const points[4], double length)
{
    uint32_t a_count = common_kinds[kind].points[0];
    struct eng_bounds a_bounds;
    struct eng_bounds b_bounds;
    struct eng_pose pose;
    struct eng_closest closest;
    bound_points(points, a_count, &a_bounds);
    bound_points(points + a_count, 4 - a_count, &b_bounds);
    if (boxes_are_apart(&a_bounds, &b_bounds, length)) {
        return true;
    }
    if (kind == PCCD_VF) {
        eng_sub(pose.p, points[0], points[1]);
        eng_sub(pose.b, points[2], points[1]);
        eng_sub(pose.c, points[3], points[1]);
    } else {
        eng_sub(pose.p, points[0], points[2]);
        eng_sub(pose.b, points[0], points[1]);
        eng_sub(pose.c, points[3], points[2]);
    }
    eng_closest_to_origin(kind, &pose, &closest);
    double gap_length = sqrt(eng_dot(closest.gap, closest.gap));
    double least = INFINITY;
    double size = 0;
    for (uint32_t a = 0; a < a_count; a++) {
        for (uint32_t b = a_count; b < 4; b++) {
            double difference[3];
            eng_sub(difference, points[a], points[b]);
            least = eng_least(least, eng_dot(closest.gap, difference));
            size = eng_most(size, eng_size(difference));
        }
    }
    double error = 32 * ENG_U * eng_size(closest.gap) * size + ENG_TINY;
    return least > length * gap_length * (1 + 0x1p-20) + error;
}

/* ---- two triangles ----------------------------------------------------------------- */

static bool has_vertex(const struct eng_face *face, uint32_t v)
{
    return face->v[0] == v || face->v[1] == v || face->v[2] == v;
}

static void mark(struct eng_spacing *spacing, enum pccd_tree tree, uint32_t feature)
{
    uint64_t bit = 1ull << feature % 64;
    uint64_t *word = &spacing->near[tree][feature / 64];
    spacing->near_count += (*word & bit) == 0;
    *word |= bit;
}

/* Two features are not apart. false: no memory to say so. */
static bool mark_pair(struct eng_mesh *mesh, enum pccd_tree tree_a, uint32_t a,
                      enum pccd_tree tree_b, uint32_t b)
{
    if (!mesh->spacing.near[0] && !make_bits(mesh, &mesh->spacing)) {
        return false;
    }
    mark(&mesh->spacing, tree_a, a);
    mark(&mesh->spacing, tree_b, b);
    return true;
}

/* The vertices that the one owns against the other, as a face. */
static bool look_at_vertices(struct eng_mesh *mesh, uint32_t owner, uint32_t face,
                             uint64_t *cost)
{
    const double(*x)[3] = (const double(*)[3])mesh->x;
    const struct eng_face *a = &mesh->leaves[owner];
    const struct eng_face *b = &mesh->leaves[face];
    for (unsigned k = 0; k < 3; k++) {
        if (!(a->owns & ENG_OWNS_VERTEX(k)) || has_vertex(b, a->v[k])) {
            continue;
        }
        const double *const points[4] = {x[a->v[k]], x[b->v[0]], x[b->v[1]], x[b->v[2]]};
        ++*cost;
        if (!is_apart(PCCD_VF, points, mesh->spacing.length) &&
            !mark_pair(mesh, PCCD_TREE_VERTICES, a->v[k], PCCD_TREE_FACES, face)) {
            return false;
        }
    }
    return true;
}

/* The edges that both own. */
static bool look_at_edges(struct eng_mesh *mesh, uint32_t one, uint32_t other,
                          uint64_t *cost)
{
    const double(*x)[3] = (const double(*)[3])mesh->x;
    const uint32_t *first = mesh->spacing.search->edge_first;
    const struct eng_face *a = &mesh->leaves[one];
    const struct eng_face *b = &mesh->leaves[other];
    for (unsigned i = 0; i < 9; i++) {
        uint32_t a0 = a->v[i / 3];
        uint32_t a1 = a->v[(i / 3 + 1) % 3];
        uint32_t b0 = b->v[i % 3];
        uint32_t b1 = b->v[(i % 3 + 1) % 3];
        if (!(a->owns & ENG_OWNS_EDGE(i / 3)) || !(b->owns & ENG_OWNS_EDGE(i % 3)) ||
            a0 == b0 || a0 == b1 || a1 == b0 || a1 == b1) {
            continue;
        }
        const double *const points[4] = {x[a0], x[a1], x[b0], x[b1]};
        ++*cost;
        if (!is_apart(PCCD_EE, points, mesh->spacing.length) &&
            !mark_pair(mesh, PCCD_TREE_EDGES, eng_feature_edge(mesh, first, a0, a1),
                       PCCD_TREE_EDGES, eng_feature_edge(mesh, first, b0, b1))) {
            return false;
        }
    }
    return true;
}

/* ---- the search -------------------------------------------------------------------- */

static void bound_triangle(const struct eng_mesh *mesh, uint32_t triangle,
                           struct eng_bounds *bounds)
{
    const uint32_t *v = mesh->leaves[triangle].v;
    const double *const points[3] = {mesh->x[v[0]], mesh->x[v[1]], mesh->x[v[2]]};
    bound_points(points, 3, bounds);
}

/* Every third bit of the result is one of the low KEY_BITS of x. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffffull;
    x = (x | x << 16) & 0x001f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

/* Along the curve: of the middle of a triangle's box. */
static uint64_t key_of(const struct eng_mesh *mesh, uint32_t triangle)
{
    struct eng_bounds bounds;
    bound_triangle(mesh, triangle, &bounds);
    double size = eng_bounds_size(&mesh->bounds);
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double middle = bounds.low[k] / 2 + bounds.high[k] / 2;
        double part =
            (middle - mesh->bounds.low[k]) / size; /* 0 .. 1, but for rounding */
        double cell = part * (1 << KEY_BITS);
        cell = eng_least(eng_most(cell, 0), (1 << KEY_BITS) - 1);
        key |= spread((uint64_t)cell) << k;
    }
    return key;
}

static uint64_t advance_keys(const struct eng_mesh *mesh,
                             struct eng_spacing_search *search)
{
    uint32_t count = mesh->info.triangle_count;
    if (search->at < count) {
        search->keys[search->at].key = key_of(mesh, search->at);
        search->keys[search->at].index = search->at;
        search->at++;
        return LOOK_COST;
    }
    /* At once, at 20 ns a triangle: steps of a mesh that large take longer. */
    search->sorted = eng_radix_sort(search->keys, search->keys + count, count);
    search->phase = BOXES;
    search->at = 0;
    return count;
}

static uint64_t advance_boxes(const struct eng_mesh *mesh,
                              struct eng_spacing_search *search)
{
    uint32_t level = search->level;
    if (level == search->level_count) {
        search->phase = PAIRS;
        search->at = 0;
        return 1;
    }
    uint32_t below = level == 0 ? mesh->info.triangle_count : search->count[level - 1];
    struct eng_bounds *node = &search->nodes[search->first[level] + search->at];
    *node = (struct eng_bounds)ENG_NO_BOUNDS;
    for (uint32_t i = search->at * FAN; i < below && i / FAN == search->at; i++) {
        struct eng_bounds bounds;
        if (level == 0) {
            bound_triangle(mesh, (uint32_t)search->sorted[i].index, &bounds);
        } else {
            bounds = search->nodes[search->first[level - 1] + i];
        }
        eng_bounds_unite(node, &bounds);
    }
    if (++search->at == search->count[level]) {
        search->level++;
        search->at = 0;
    }
    return LOOK_COST;
}

static void push(struct eng_spacing_search *search, uint32_t level, uint32_t node)
{
    assert(search->stack_count < STACK_MAX);
    search->stack[search->stack_count][0] = level;
    search->stack[search->stack_count++][1] = node;
}

/* The triangle in place `place` against that in place `at`. */
static bool look_at_triangle(struct eng_mesh *mesh, uint32_t place, uint64_t *cost)
{
    const struct eng_spacing_search *search = mesh->spacing.search;
    uint32_t one = (uint32_t)search->sorted[search->at].index;
    uint32_t other = (uint32_t)search->sorted[place].index;
    struct eng_bounds bounds;
    bound_triangle(mesh, other, &bounds);
    ++*cost;
    return boxes_are_apart(&search->bounds, &bounds, mesh->spacing.length) ||
           (look_at_vertices(mesh, one, other, cost) &&
            look_at_vertices(mesh, other, one, cost) &&
            look_at_edges(mesh, one, other, cost));
}

/* The next node for the triangle at hand, or the next triangle. false: no memory. */
static bool advance_pairs(struct eng_mesh *mesh, struct eng_spacing_search *search,
                          uint64_t *cost)
{
    if (search->stack_count == 0) {
        bound_triangle(mesh, (uint32_t)search->sorted[search->at].index, &search->bounds);
        push(search, search->level_count - 1, 0);
    }
    uint32_t level = search->stack[--search->stack_count][0];
    uint32_t node = search->stack[search->stack_count][1];
    uint32_t below = level == 0 ? mesh->info.triangle_count : search->count[level - 1];
    bool has_memory = true;
    ++*cost;
    /* Places below the node end before FAN^(level + 1) (node + 1). */
    bool is_behind = ((uint64_t)node + 1) << 2 * (level + 1) > (uint64_t)search->at + 1;
    if (is_behind &&
        !boxes_are_apart(&search->bounds, &search->nodes[search->first[level] + node],
                         mesh->spacing.length)) {
        for (uint32_t i = node * FAN; i < below && i / FAN == node && has_memory; i++) {
            if (level > 0) {
                push(search, level - 1, i);
            } else if (i > search->at) {
                has_memory = look_at_triangle(mesh, i, cost);
            }
        }
    }
    search->at += search->stack_count == 0;
    return has_memory;
}

/* ---- a mesh ------------------------------------------------------------------------ */

static void begin(struct eng_mesh *mesh)
{
    double size = eng_bounds_size(&mesh->bounds) * mesh->fineness;
    int exponent;
    (void)frexp(size, &exponent);
    mesh->spacing.length = size > 0 ? ldexp(SPACING_PART, exponent - 1) : 0;
    mesh->spacing.search = mesh->spacing.length > 0 ? search_new(mesh) : NULL;
}

static void end(struct eng_spacing *spacing, bool is_of_use)
{
    search_free(spacing->search);
    spacing->search = NULL;
    if (!is_of_use) {
        eng_free(spacing->near[0]);
        memset(spacing->near, 0, sizeof spacing->near);
        spacing->near_count = 0;
        spacing->length = 0;
    }
}

/* More work; returns whether there is yet more. */
static bool search_on(struct eng_mesh *mesh, uint64_t budget, uint64_t *cost)
{
    struct eng_spacing *spacing = &mesh->spacing;
    const struct eng_mesh_info *info = &mesh->info;
    if (mesh->leaf_count > info->triangle_count) { /* it is looked for in triangles */
        return false;
    }
    uint64_t features =
        (uint64_t)info->vertex_count + info->edge_count + info->triangle_count;
    if (!spacing->search) {
        begin(mesh);
    }
    struct eng_spacing_search *search = spacing->search;
    bool is_of_use = search != NULL;
    while (is_of_use && *cost < budget) {
        if (search->phase == PAIRS && search->at == info->triangle_count) {
            end(spacing, true);
            return false;
        }
        if (search->phase == KEYS) {
            *cost += advance_keys(mesh, search);
        } else if (search->phase == BOXES) {
            *cost += advance_boxes(mesh, search);
        } else {
            is_of_use = advance_pairs(mesh, search, cost);
        }
        is_of_use = is_of_use && spacing->near_count <= features / NEAR_PART &&
                    (spacing->work + *cost) / WORK_MAX <= info->triangle_count;
    }
    if (!is_of_use) {
        end(spacing, false);
    }
    return is_of_use;
}

uint64_t eng_spacing_advance(struct eng_mesh *mesh, uint64_t budget)
{
    assert(mesh && eng_mesh_is_committed(mesh));
    struct eng_spacing *spacing = &mesh->spacing;
    int unknown = ENG_SPACING_UNKNOWN;
    if (!atomic_compare_exchange_strong_explicit(&spacing->state, &unknown,
                                                 ENG_SPACING_TAKEN, memory_order_acquire,
                                                 memory_order_relaxed)) {
        return 0;
    }
    uint64_t cost = 0;
    struct eng_account *before = eng_charge_to(mesh->account);
    bool has_more = search_on(mesh, budget, &cost);
    (void)eng_charge_to(before);
    spacing->work += cost;
    /* Release: whoever takes it next, or sees that it is known, sees all of it. */
    atomic_store_explicit(&spacing->state,
                          has_more ? ENG_SPACING_UNKNOWN : ENG_SPACING_KNOWN,
                          memory_order_release);
    return cost > 0 ? cost : 1;
}

bool eng_spacing_is_known(const struct eng_mesh *mesh)
{
    return atomic_load_explicit(&mesh->spacing.state, memory_order_acquire) ==
           ENG_SPACING_KNOWN;
}

double eng_spacing_of(const struct eng_mesh *mesh)
{
    return eng_spacing_is_known(mesh) ? mesh->spacing.length : 0;
}

bool eng_spacing_has_near(const struct eng_mesh *mesh)
{
    assert(eng_spacing_is_known(mesh));
    return mesh->spacing.near_count > 0;
}

bool eng_spacing_is_near(const struct eng_mesh *mesh, enum pccd_tree tree,
                         uint32_t feature)
{
    assert(eng_spacing_is_known(mesh));
    const uint64_t *bits = mesh->spacing.near[tree];
    return bits && (bits[feature / 64] >> feature % 64 & 1u);
}
