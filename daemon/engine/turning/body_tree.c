/* body_tree.c - the tree of a mesh, and its boxes.
 *
 * Split leaves in two where the surface area heuristic says, by bins of centres, until a
 * node has four children; make boxes from the last node to the first.
 */
#include "body_tree.h"

#include <assert.h>
#include <float.h>
#include <string.h>

#include "memory.h"
#include "vec.h"

/* ---- which leaves are below a node ------------------------------------------------- */

#define BINS 16u

/* From here on halves have equally many leaves: it bounds the depth to some 56. */
#define LEVEL_OF_HALVES 40u

/* Nodes whose boxes are made between two questions whether to stop. */
#define NODES_PER_LOOK 1024u

struct item {
    float low[3];
    float high[3];
    uint32_t leaf;
};

struct range {
    uint32_t first;
    uint32_t count;
    float area; /* of its box */
};

struct builder {
    struct item *items;
    uint32_t (*children)[4];
    uint32_t node_count;
    uint32_t capacity;
};

struct bounds {
    float low[3];
    float high[3];
};

static const struct bounds nothing = {{FLT_MAX, FLT_MAX, FLT_MAX},
                                      {-FLT_MAX, -FLT_MAX, -FLT_MAX}};

static void add(struct bounds *bounds, const float low[3], const float high[3])
{
    for (int k = 0; k < 3; k++) {
        bounds->low[k] = low[k] < bounds->low[k] ? low[k] : bounds->low[k];
        bounds->high[k] = high[k] > bounds->high[k] ? high[k] : bounds->high[k];
    }
}

static float area_of(const struct bounds *bounds)
{
    float x = bounds->high[0] - bounds->low[0];
    float y = bounds->high[1] - bounds->low[1];
    float z = bounds->high[2] - bounds->low[2];
    return x < 0 ? 0 : x * y + y * z + z * x;
}

static float middle_of(const struct item *item, int axis)
{
    return item->low[axis] + item->high[axis];
}

struct bin {
    struct bounds bounds;
    uint32_t count;
};

/* Where centres fall into bins along an axis. */
struct cut {
    int axis; /* -1: there is none */
    float low;
    float scale;
    uint32_t bin; /* the first on the far side */
    float cost;
};

static uint32_t bin_of(const struct cut *cut, const struct item *item)
{
    float at = (middle_of(item, cut->axis) - cut->low) * cut->scale;
    return at < BINS - 1 ? (uint32_t)at : BINS - 1;
}

/* So many nodes hold them at least. */
static float blocks_of(uint32_t count)
{
    return (float)((count + 3) / 4);
}

/* Find the best cut along an axis, if it is better than *best. */
static void look_along(const struct item *items, uint32_t count, struct cut cut,
                       struct cut *best)
{
    struct bin bins[BINS];
    float cost[BINS];
    for (uint32_t i = 0; i < BINS; i++) {
        bins[i] = (struct bin){nothing, 0};
    }
    for (uint32_t i = 0; i < count; i++) {
        struct bin *bin = &bins[bin_of(&cut, &items[i])];
        add(&bin->bounds, items[i].low, items[i].high);
        bin->count++;
    }
    struct bin all = {nothing, 0};
    for (uint32_t i = BINS - 1; i > 0; i--) {
        add(&all.bounds, bins[i].bounds.low, bins[i].bounds.high);
        all.count += bins[i].count;
        cost[i] = area_of(&all.bounds) * blocks_of(all.count);
    }
    all = (struct bin){nothing, 0};
    for (uint32_t i = 1; i < BINS; i++) {
        add(&all.bounds, bins[i - 1].bounds.low, bins[i - 1].bounds.high);
        all.count += bins[i - 1].count;
        cut.cost = cost[i] + area_of(&all.bounds) * blocks_of(all.count);
        cut.bin = i;
        if (all.count > 0 && all.count < count && cut.cost < best->cost) {
            *best = cut;
        }
    }
}

static struct cut best_cut(const struct item *items, uint32_t count)
{
    struct bounds middles = nothing;
    struct cut best = {.axis = -1, .cost = INFINITY};
    for (uint32_t i = 0; i < count; i++) {
        float at[3] = {middle_of(&items[i], 0), middle_of(&items[i], 1),
                       middle_of(&items[i], 2)};
        add(&middles, at, at);
    }
    for (int k = 0; k < 3; k++) {
        float length = middles.high[k] - middles.low[k];
        if (length > FLT_MIN && length < FLT_MAX) {
            look_along(items, count,
                       (struct cut){.axis = k,
                                    .low = middles.low[k],
                                    .scale = (float)BINS * (1 - 0x1p-20f) / length},
                       &best);
        }
    }
    return best;
}

/* Return how many of the items go to the first part, which they begin. */
static uint32_t divide(struct item *items, uint32_t count, uint32_t level)
{
    struct cut cut = {.axis = -1};
    if (level < LEVEL_OF_HALVES) {
        cut = best_cut(items, count);
    }
    if (cut.axis < 0) {
        return count / 2;
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (bin_of(&cut, &items[i]) < cut.bin) {
            struct item one = items[i];
            items[i] = items[kept];
            items[kept++] = one;
        }
    }
    return kept;
}

static void measure(const struct builder *builder, struct range *range)
{
    struct bounds bounds = nothing;
    for (uint32_t i = 0; i < range->count; i++) {
        const struct item *item = &builder->items[range->first + i];
        add(&bounds, item->low, item->high);
    }
    range->area = area_of(&bounds);
}

/* The range to be divided next, when there are `parts` of them: the largest that is more
 * than a node's; else one whose leaves all become children. -1: none. */
static int next_of(const struct range *ranges, uint32_t parts)
{
    int best = -1;
    for (uint32_t i = 0; i < parts; i++) {
        if (ranges[i].count > 4 && (best < 0 || ranges[i].area > ranges[best].area)) {
            best = (int)i;
        }
    }
    for (uint32_t i = 0; i < parts && best < 0; i++) {
        if (ranges[i].count > 1 && ranges[i].count + parts <= 5) {
            best = (int)i;
        }
    }
    return best;
}

/* Divide a range of >= 1 items into up to four. Returns how many. */
static uint32_t divide_in_four(struct builder *builder, struct range ranges[4],
                               uint32_t level)
{
    uint32_t parts = 1;
    for (int at = next_of(ranges, parts); at >= 0 && parts < 4;
         at = next_of(ranges, parts)) {
        struct range *whole = &ranges[at];
        uint32_t count = whole->count <= 4
                             ? 1
                             : divide(builder->items + whole->first, whole->count, level);
        ranges[parts] = (struct range){whole->first + count, whole->count - count, 0};
        whole->count = count;
        measure(builder, whole);
        measure(builder, &ranges[parts++]);
    }
    return parts;
}

static int build(struct builder *builder, uint32_t first, uint32_t count, uint32_t level)
{
    struct range ranges[4] = {{first, count, 0}};
    uint32_t parts = divide_in_four(builder, ranges, level);
    uint32_t node = builder->node_count++;
    int status = eng_array_extend(&builder->children, &builder->capacity,
                                  builder->node_count, sizeof *builder->children);
    for (uint32_t i = 0; i < 4 && status == PCCD_OK; i++) {
        uint32_t child = ENG_BODY_NONE;
        if (i < parts && ranges[i].count == 1) {
            child = ENG_BODY_LEAF | builder->items[ranges[i].first].leaf;
        } else if (i < parts) {
            child = builder->node_count;
            status = build(builder, ranges[i].first, ranges[i].count, level + 1);
        }
        if (status == PCCD_OK) {
            builder->children[node][i] = child;
        }
    }
    return status;
}

/* ---- boxes ------------------------------------------------------------------------- */

/* Bounds in doubles, measured from the origin; off by some 2^-52 of the coordinates. */
static void bound_leaf(const struct eng_face *leaf, const double (*x)[3],
                       const double origin[3], double low[3], double high[3])
{
    const double *a = x[leaf->v[0]];
    const double *b = x[leaf->v[1]];
    const double *c = x[leaf->v[2]];
    for (int k = 0; k < 3; k++) {
        low[k] = eng_least(eng_least(a[k], b[k]), c[k]) - origin[k];
        high[k] = eng_most(eng_most(a[k], b[k]), c[k]) - origin[k];
    }
}

static void bound_node(const struct eng_body_boxes *boxes, const uint32_t children[4],
                       double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (int i = 0; i < 4 && children[i] != ENG_BODY_NONE; i++) {
            double centre = (double)boxes->centre[k][i];
            double half = (double)boxes->half[k][i];
            low[k] = eng_least(low[k], centre - half);
            high[k] = eng_most(high[k], centre + half);
        }
    }
}

/* Rounded outward: what is added is more than the roundings of bounds, of the centre and
 * of the half take off, however small it is. */
static void put_box(struct eng_body_boxes *boxes, int which, const double low[3],
                    const double high[3])
{
    for (int k = 0; k < 3; k++) {
        float centre = (float)(0.5 * (low[k] + high[k]));
        double half = eng_most(high[k] - (double)centre, (double)centre - low[k]);
        boxes->centre[k][which] = centre;
        boxes->half[k][which] =
            (float)(half * (1 + 0x1p-22) + 0x1p-50 * fabs((double)centre) + 0x1p-120);
    }
}

static void put_nothing(struct eng_body_boxes *boxes, int which)
{
    for (int k = 0; k < 3; k++) {
        boxes->centre[k][which] = 0;
        boxes->half[k][which] = -0x1p120f;
    }
}

/* Returns false if whoever has asked for it wants no more. */
static bool make_boxes(const struct eng_body *body, const struct eng_body_tree *tree,
                       const double (*x)[3], struct eng_body_boxes *boxes)
{
    const struct eng_mesh *mesh = body->mesh;
    const double *origin = body->origin;
    for (uint32_t node = tree->node_count; node-- > 0;) {
        if (node % NODES_PER_LOOK == 0 && body->should_stop &&
            body->should_stop(body->owner)) {
            return false;
        }
        for (int i = 0; i < 4; i++) {
            uint32_t child = tree->children[node][i];
            double low[3];
            double high[3];
            if (child == ENG_BODY_NONE) {
                put_nothing(&boxes[node], i);
                continue;
            }
            if (child & ENG_BODY_LEAF) {
                bound_leaf(&mesh->leaves[child & ~ENG_BODY_LEAF], x, origin, low, high);
            } else {
                bound_node(&boxes[child], tree->children[child], low, high);
            }
            put_box(&boxes[node], i, low, high);
        }
    }
    return true;
}

/* Around the leaves at both ends, and the middle of that. */
static void measure_box(const struct eng_mesh *mesh, const double (*x0)[3],
                        const double (*x1)[3], struct eng_path_box *box, double origin[3])
{
    struct eng_bounds bounds = eng_mesh_measure(mesh, x0);
    if (x1 != x0) {
        struct eng_bounds other = eng_mesh_measure(mesh, x1);
        eng_bounds_unite(&bounds, &other);
    }
    for (int k = 0; k < 3; k++) {
        box->lo[k] = bounds.low[k];
        box->hi[k] = bounds.high[k];
        origin[k] = 0.5 * bounds.low[k] + 0.5 * bounds.high[k];
    }
}

/* ---- the tree of a mesh ------------------------------------------------------------ */

static struct item *make_items(const struct eng_mesh *mesh, const double origin[3])
{
    struct item *items = eng_alloc(mesh->leaf_count, sizeof *items);
    for (uint32_t i = 0; items && i < mesh->leaf_count; i++) {
        double low[3];
        double high[3];
        bound_leaf(&mesh->leaves[i], (const double(*)[3])mesh->x, origin, low, high);
        for (int k = 0; k < 3; k++) {
            items[i].low[k] = (float)low[k];
            items[i].high[k] = (float)high[k];
        }
        items[i].leaf = i;
    }
    return items;
}

static size_t bytes_of(uint32_t node_count)
{
    return sizeof(struct eng_body_tree) + sizeof(struct eng_body_boxes) +
           node_count * (sizeof(struct eng_body_boxes) + 4 * sizeof(uint32_t));
}

/* One block: the tree, its boxes, its children. */
static struct eng_body_tree *finish(const struct eng_mesh *mesh,
                                    const struct builder *builder)
{
    size_t head = sizeof(struct eng_body_tree);
    head += sizeof(struct eng_body_boxes) - head % sizeof(struct eng_body_boxes);
    struct eng_body_tree *tree = eng_alloc(1, bytes_of(builder->node_count));
    if (tree) {
        unsigned char *block = (unsigned char *)tree;
        size_t boxes = builder->node_count * sizeof *tree->boxes;
        tree->node_count = builder->node_count;
        tree->boxes = (void *)(block + head);
        tree->children = (void *)(block + head + boxes);
        memcpy(tree->children, builder->children,
               builder->node_count * sizeof *tree->children);
        measure_box(mesh, (const double(*)[3])mesh->x, (const double(*)[3])mesh->x,
                    &tree->box, tree->origin);
        struct eng_body registered = {.mesh = mesh};
        memcpy(registered.origin, tree->origin, sizeof registered.origin);
        (void)make_boxes(&registered, tree, (const double(*)[3])mesh->x, tree->boxes);
    }
    return tree;
}

static struct eng_body_tree *make(const struct eng_mesh *mesh)
{
    struct eng_body_tree *tree = NULL;
    struct eng_path_box box;
    double origin[3];
    measure_box(mesh, (const double(*)[3])mesh->x, (const double(*)[3])mesh->x, &box,
                origin);
    struct builder builder = {.items = make_items(mesh, origin)};
    if (builder.items && build(&builder, 0, mesh->leaf_count, 0) == PCCD_OK) {
        tree = finish(mesh, &builder);
    }
    eng_free(builder.children);
    eng_free(builder.items);
    return tree;
}

int eng_body_tree_prepare(struct eng_mesh *mesh)
{
    assert(mesh->committed);
    if (atomic_load_explicit(&mesh->body_tree, memory_order_acquire)) {
        return PCCD_OK;
    }
    struct eng_account *before = eng_charge_to(mesh->account);
    struct eng_body_tree *made = make(mesh);
    struct eng_body_tree *none = NULL;
    int status = made ? PCCD_OK : PCCD_E_NOMEM;
    /* Release: whoever sees the tree sees what is in it. */
    if (made && !atomic_compare_exchange_strong_explicit(&mesh->body_tree, &none, made,
                                                         memory_order_acq_rel,
                                                         memory_order_acquire)) {
        eng_free(made); /* another thread was first */
    } else if (made) {
        atomic_store_explicit(&mesh->body_tree_bytes, bytes_of(made->node_count),
                              memory_order_relaxed);
    }
    (void)eng_charge_to(before);
    return status;
}

const struct eng_body_tree *eng_body_tree_of(const struct eng_mesh *mesh)
{
    return atomic_load_explicit(&mesh->body_tree, memory_order_acquire);
}

/* ---- an object in a step ----------------------------------------------------------- */

void eng_body_set(struct eng_body *body, const struct eng_mesh *mesh)
{
    const struct eng_body_tree *tree = eng_body_tree_of(mesh);
    body->mesh = mesh;
    body->x[0] = body->x[1] = (const double(*)[3])mesh->x;
    body->boxes[0] = body->boxes[1] = tree->boxes;
    body->box = tree->box;
    memcpy(body->origin, tree->origin, sizeof body->origin);
}

int eng_body_fit(struct eng_body *body, const struct eng_mesh *mesh,
                 const double (*x0)[3], const double (*x1)[3])
{
    const struct eng_body_tree *tree = eng_body_tree_of(mesh);
    size_t bytes = mesh->info.vertex_count * sizeof *x0;
    bool stands = x0 == x1 || memcmp(x0, x1, bytes) == 0;
    if (stands && memcmp(x0, mesh->x, bytes) == 0) {
        eng_body_set(body, mesh);
        return PCCD_OK;
    }
    uint32_t ends = stands ? 1 : 2;
    if (tree->node_count > UINT32_MAX / 2) {
        return PCCD_E_LIMIT;
    }
    int status = eng_array_fit(&body->fit, &body->fit_capacity, ends * tree->node_count,
                               sizeof *body->fit);
    if (status != PCCD_OK) {
        return status;
    }
    body->mesh = mesh;
    body->x[0] = x0;
    body->x[1] = x1;
    measure_box(mesh, x0, stands ? x0 : x1, &body->box, body->origin);
    bool is_made = make_boxes(body, tree, x0, body->fit);
    body->boxes[0] = body->boxes[1] = body->fit;
    if (!stands) {
        is_made = is_made && make_boxes(body, tree, x1, body->fit + tree->node_count);
        body->boxes[1] = body->fit + tree->node_count;
    }
    return is_made ? PCCD_OK : PCCD_E_AGAIN;
}

void eng_body_deinit(struct eng_body *body)
{
    eng_free(body->fit);
    *body = (struct eng_body){0};
}

uint64_t eng_body_bytes(const struct eng_body *body)
{
    return (uint64_t)body->fit_capacity * sizeof *body->fit;
}
