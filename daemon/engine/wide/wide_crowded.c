/* wide_crowded.c - crowded features of a mesh.
 *
 * Take the features in the order that the mesh has for the trees of its objects. Make
 * boxes around blocks of sixteen of them, around sixteen of these, and so on; look for
 * each block at those within the clearance, no two twice, and try to separate the
 * features of both.
 */
#include "wide_crowded.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "kinds.h"
#include "memory.h"
#include "motion.h"
#include "topology.h"
#include "vec.h"
#include "wide.h"

/* The clearance beside the size of a typical triangle. A body may be 10^8 times farther
 * from the origin than its triangles are large before rounding reaches it, and what is
 * nearer than a millionth of a triangle touches, as a rule. */
#define CLEARANCE_PART 0x1p-20

/* The part of the features that may be crowded: with more, little is left out. */
#define CROWDED_PART 16u

/* Tests a triangle, on average, before the search is given up: 50 to 70 are needed as a
 * rule, thousands where triangles lie in heaps. */
#define WORK_MAX 1024u

/* Limits of a step's share of a search, in tests of 20 ns: some 0.1 ms, and for large
 * scenes a tenth of what a step takes. By number, not by time: so what is counted in a
 * step does not depend on how fast it was. */
#define SHARE_MIN           4096u
#define SHARE_PER_TRIANGLES 2u

/* The cost of a block whose vertices are read, in tests. */
#define LOAD_COST (3 * ENG_WIDE)

/* The kinds of pairs that triangles make, in their sequence here. */
#define KINDS 2u
static const enum pccd_kind kinds[KINDS] = {PCCD_VF, PCCD_EE};

/* Where the boxes of a tree are: those of level 0 around blocks of its features. */
struct tree {
    uint32_t level_count;
    size_t first[ENG_WIDE_LEVELS_MAX];
    uint32_t count[ENG_WIDE_LEVELS_MAX];
};

/* Features of a block. */
struct block {
    uint32_t count;
    uint32_t feature[ENG_WIDE];
    uint32_t v[ENG_WIDE][3]; /* their vertices */
    struct eng_bounds boxes[ENG_WIDE];
};

struct eng_wide_crowded {
    struct tree trees[ENG_WIDE_TREES];
    uint32_t boxed; /* trees that have their boxes */
    uint32_t kind;  /* of kinds[]; KINDS: all is done */
    uint32_t at;    /* the block whose box is next, or whose pairs are looked for: .. */
    struct block block;   /* .. its features, .. */
    uint32_t level, node; /* .. and what comes next in the tree of the other side */
    struct eng_bounds boxes[];
};

/* ---- memory ------------------------------------------------------------------------ */

/* The boxes of a tree of that many slots lie from `first` on; returns where they end. */
static size_t lay_out(struct tree *tree, uint32_t slots, size_t first)
{
    do {
        slots = (slots + ENG_WIDE - 1) / ENG_WIDE;
        tree->first[tree->level_count] = first;
        tree->count[tree->level_count++] = slots;
        first += slots;
    } while (slots > 1);
    return first;
}

static struct eng_wide_crowded *search_new(const struct eng_wide_order *order)
{
    struct eng_wide_crowded begun = {.boxed = 0};
    size_t boxes = 0;
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        boxes = lay_out(&begun.trees[kind], order->count[kind], boxes);
    }
    struct eng_wide_crowded *search =
        eng_alloc(1, sizeof *search + boxes * sizeof *search->boxes);
    if (search) {
        *search = begun;
    }
    return search;
}

/* The tree of a side, 0 or 1, of the pairs that are looked for, and a box of it. */
static const struct tree *tree_of(const struct eng_wide_crowded *search, int side)
{
    return &search->trees[eng_wide_tree_of(kinds[search->kind], side)];
}

static const struct eng_bounds *box_of(const struct eng_wide_crowded *search, int side,
                                       uint32_t level, uint32_t node)
{
    return &search->boxes[tree_of(search, side)->first[level] + node];
}

/* ---- two features ------------------------------------------------------------------ */

/* Return whether there is certainly more than `length` between the boxes. */
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

/* Return whether there is certainly more than `length` between two features. Along the
 * line between their nearest points, or what seem to be those: whatever direction it is,
 * features that are so far apart along it are so far apart. */
static bool is_apart(enum pccd_kind kind, const double *const points[4], double length)
{
    uint32_t a_count = common_kinds[kind].points[0];
    struct eng_pose pose;
    struct eng_closest closest;
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

/* false: no memory to say so. */
static bool mark(struct eng_mesh *mesh, enum pccd_tree tree, uint32_t feature)
{
    const uint32_t counts[ENG_WIDE_TREES] = {
        [PCCD_TREE_VERTICES] = mesh->info.vertex_count,
        [PCCD_TREE_EDGES] = mesh->info.edge_count,
        [PCCD_TREE_FACES] = mesh->info.triangle_count};
    uint64_t **bits = &mesh->clearance.crowded[tree];
    *bits = *bits ? *bits : eng_feature_new_bits(counts[tree]);
    if (!*bits) {
        return false;
    }
    mesh->clearance.crowded_count += !eng_mesh_has_bit(*bits, feature);
    eng_mesh_set_bit(*bits, feature);
    return true;
}

/* ---- two blocks -------------------------------------------------------------------- */

static struct eng_bounds bound(const struct eng_mesh *mesh, const uint32_t *v,
                               uint32_t count)
{
    struct eng_bounds box = ENG_NO_BOUNDS;
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            box.low[k] = eng_least(mesh->x[v[i]][k], box.low[k]);
            box.high[k] = eng_most(mesh->x[v[i]][k], box.high[k]);
        }
    }
    return box;
}

/* Those features of a block whose boxes are within the clearance of another box. */
static void load_block(const struct eng_mesh *mesh, enum pccd_tree kind, uint32_t at,
                       const struct eng_bounds *around, struct block *block)
{
    const struct eng_wide_order *order = mesh->order;
    block->count = 0;
    for (uint32_t slot = at * ENG_WIDE;
         slot < (at + 1) * ENG_WIDE && slot < order->count[kind]; slot++) {
        uint32_t feature = order->feature[kind][slot];
        if (feature == ENG_WIDE_NO_FEATURE) {
            continue;
        }
        const uint32_t *v = kind == PCCD_TREE_VERTICES ? &feature
                            : kind == PCCD_TREE_EDGES  ? mesh->edges[feature]
                                                       : mesh->leaves[feature].v;
        struct eng_bounds box = bound(mesh, v, (uint32_t)kind + 1);
        if (!boxes_are_apart(&box, around, mesh->clearance.length)) {
            memcpy(block->v[block->count], v, ((size_t)kind + 1) * sizeof *v);
            block->feature[block->count] = feature;
            block->boxes[block->count++] = box;
        }
    }
}

static bool have_common_vertex(const uint32_t *a, uint32_t a_count, const uint32_t *b,
                               uint32_t b_count)
{
    bool is_common = false;
    for (uint32_t i = 0; i < a_count; i++) {
        for (uint32_t k = 0; k < b_count; k++) {
            is_common |= a[i] == b[k];
        }
    }
    return is_common;
}

/* Feature i of the block at hand and k of another one, whose boxes are near. false: no
 * memory to say that they are crowded. */
static bool look_at_pair(struct eng_mesh *mesh, enum pccd_kind kind,
                         const struct block *a, uint32_t i, const struct block *b,
                         uint32_t k)
{
    const uint32_t *count = common_kinds[kind].points;
    const double *points[4];
    for (uint32_t p = 0; p < 4; p++) {
        uint32_t v = p < count[0] ? a->v[i][p] : b->v[k][p - count[0]];
        points[p] = mesh->x[v];
    }
    return have_common_vertex(a->v[i], count[0], b->v[k], count[1]) ||
           is_apart(kind, points, mesh->clearance.length) ||
           (mark(mesh, eng_wide_tree_of(kind, 0), a->feature[i]) &&
            mark(mesh, eng_wide_tree_of(kind, 1), b->feature[k]));
}

/* The block at hand and that at search->node. Returns the cost; 0: no memory. */
static uint64_t look_at_blocks(struct eng_mesh *mesh,
                               const struct eng_wide_crowded *search)
{
    enum pccd_kind kind = kinds[search->kind];
    const struct block *a = &search->block;
    const struct eng_bounds *around_b = box_of(search, 1, 0, search->node);
    double length = mesh->clearance.length;
    bool is_one = kind == PCCD_EE && search->at == search->node;
    uint64_t cost = LOAD_COST;
    struct block b;
    load_block(mesh, eng_wide_tree_of(kind, 1), search->node,
               box_of(search, 0, 0, search->at), &b);
    for (uint32_t i = 0; i < a->count; i++) {
        bool is_far = boxes_are_apart(&a->boxes[i], around_b, length);
        for (uint32_t k = is_one ? i + 1 : 0; k < b.count && !is_far; k++) {
            if (boxes_are_apart(&a->boxes[i], &b.boxes[k], length)) {
                continue;
            }
            cost++;
            if (!look_at_pair(mesh, kind, a, i, &b, k)) {
                return 0;
            }
        }
    }
    return cost;
}

/* ---- the search -------------------------------------------------------------------- */

/* The next block whose pairs are looked for. Of a tree with itself those with blocks
 * before it were. */
static void begin_block(const struct eng_mesh *mesh, struct eng_wide_crowded *search)
{
    bool is_one_tree = tree_of(search, 0) == tree_of(search, 1);
    load_block(mesh, eng_wide_tree_of(kinds[search->kind], 0), search->at, &mesh->bounds,
               &search->block);
    search->level = is_one_tree ? 0 : tree_of(search, 1)->level_count - 1;
    search->node = is_one_tree ? search->at : 0;
}

/* The box of the next block, and its part of those above. */
static void advance_boxes(const struct eng_mesh *mesh, struct eng_wide_crowded *search)
{
    const struct tree *tree = &search->trees[search->boxed];
    struct eng_bounds box = ENG_NO_BOUNDS;
    load_block(mesh, (enum pccd_tree)search->boxed, search->at, &mesh->bounds,
               &search->block);
    for (uint32_t i = 0; i < search->block.count; i++) {
        eng_bounds_unite(&box, &search->block.boxes[i]);
    }
    uint32_t node = search->at;
    bool is_first = true; /* below the node */
    for (uint32_t level = 0; level < tree->level_count; level++) {
        struct eng_bounds *above = &search->boxes[tree->first[level] + node];
        *above = is_first ? box : *above;
        eng_bounds_unite(above, &box);
        is_first &= node % ENG_WIDE == 0;
        node /= ENG_WIDE;
    }
    if (++search->at == tree->count[0]) {
        search->at = 0;
        search->boxed++;
    }
    if (search->boxed == ENG_WIDE_TREES) {
        begin_block(mesh, search);
    }
}

/* Behind all that is below the node at hand. */
static void go_on(const struct eng_mesh *mesh, struct eng_wide_crowded *search)
{
    const struct tree *b = tree_of(search, 1);
    search->node++;
    while (search->node % ENG_WIDE == 0 && search->level + 1 < b->level_count) {
        search->node /= ENG_WIDE;
        search->level++;
    }
    if (search->node < b->count[search->level]) {
        return;
    }
    if (++search->at == tree_of(search, 0)->count[0]) {
        search->at = 0;
        search->kind++;
    }
    if (search->kind < KINDS) {
        begin_block(mesh, search);
    }
}

/* The next node for the block at hand. Returns the cost; 0: no memory. */
static uint64_t advance_pairs(struct eng_mesh *mesh, struct eng_wide_crowded *search)
{
    uint64_t cost = 1;
    if (!boxes_are_apart(box_of(search, 0, 0, search->at),
                         box_of(search, 1, search->level, search->node),
                         mesh->clearance.length)) {
        if (search->level > 0) {
            search->level--;
            search->node *= ENG_WIDE;
            return cost;
        }
        cost = look_at_blocks(mesh, search);
    }
    go_on(mesh, search);
    return cost;
}

/* ---- a mesh ------------------------------------------------------------------------ */

/* False: there is nothing to find, or no memory. What is free has kinds of its own, which
 * are not looked for. */
static bool begin(struct eng_mesh *mesh)
{
    double size = eng_bounds_size(&mesh->bounds) * mesh->fineness;
    int exponent;
    (void)frexp(size, &exponent);
    mesh->clearance.length = size > 0 ? ldexp(CLEARANCE_PART, exponent - 1) : 0;
    if (mesh->clearance.length > 0 && mesh->order &&
        mesh->leaf_count == mesh->info.triangle_count) {
        mesh->clearance.search = search_new(mesh->order);
    }
    return mesh->clearance.search != NULL;
}

/* Nothing is known, and nothing will be. */
static void give_up(struct eng_clearance *clearance)
{
    for (int tree = 0; tree < ENG_WIDE_TREES; tree++) {
        eng_free(clearance->crowded[tree]);
        clearance->crowded[tree] = NULL;
    }
    clearance->crowded_count = 0;
    clearance->length = 0;
}

/* More work; returns whether there is yet more. */
static bool search_on(struct eng_mesh *mesh, uint64_t budget, uint64_t *cost)
{
    struct eng_clearance *clearance = &mesh->clearance;
    uint64_t features = (uint64_t)mesh->info.vertex_count + mesh->info.edge_count +
                        mesh->info.triangle_count;
    bool is_of_use = clearance->search || begin(mesh);
    struct eng_wide_crowded *search = clearance->search;
    while (is_of_use && search->kind < KINDS && *cost < budget) {
        uint64_t added = LOAD_COST;
        if (search->boxed < ENG_WIDE_TREES) {
            advance_boxes(mesh, search);
        } else {
            added = advance_pairs(mesh, search);
        }
        *cost += added;
        is_of_use = added > 0 && clearance->crowded_count <= features / CROWDED_PART &&
                    (clearance->work + *cost) / WORK_MAX <= mesh->info.triangle_count;
    }
    if (is_of_use && search->kind < KINDS) {
        return true;
    }
    if (!is_of_use) {
        give_up(clearance);
    }
    eng_free(search);
    clearance->search = NULL;
    return false;
}

uint64_t eng_wide_crowded_advance(struct eng_mesh *mesh, uint64_t budget)
{
    assert(mesh && eng_mesh_is_committed(mesh));
    struct eng_clearance *clearance = &mesh->clearance;
    int unknown = ENG_CLEARANCE_UNKNOWN;
    if (!atomic_compare_exchange_strong_explicit(
            &clearance->state, &unknown, ENG_CLEARANCE_TAKEN, memory_order_acquire,
            memory_order_relaxed)) {
        return 0;
    }
    uint64_t cost = 0;
    struct eng_account *before = eng_charge_to(mesh->account);
    bool has_more = search_on(mesh, budget, &cost);
    (void)eng_charge_to(before);
    clearance->work += cost;
    /* Release: whoever takes it next, or sees that it is known, sees all of it. */
    atomic_store_explicit(&clearance->state,
                          has_more ? ENG_CLEARANCE_UNKNOWN : ENG_CLEARANCE_KNOWN,
                          memory_order_release);
    return cost > 0 ? cost : 1;
}

void eng_wide_crowded_share(struct eng_scene *scene)
{
    uint64_t budget = SHARE_MIN + scene->leaf_count / SHARE_PER_TRIANGLES;
    uint64_t done = 0;
    /* From the one that is wanted on: those before are known, or not posed. */
    for (uint32_t i = scene->rigid.wanted; i < scene->object_capacity && done < budget;
         i++) {
        struct eng_object *object = &scene->objects[i];
        if (object->mesh && object->is_posed && scene->masks.entries[i].self) {
            done += eng_wide_crowded_advance(object->mesh, budget - done);
        }
    }
}
