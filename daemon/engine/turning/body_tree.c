/* body_tree.c - the tree of a mesh, and its boxes.
 *
 * Split leaves in two where the surface area heuristic says, by bins of centres, until a
 * node has four children; make boxes from the last node to the first. All of it goes by
 * passes over items that may be left at any of them and gone on with, so the tree is the
 * same wherever that was.
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

/* Three that wait on each level, at most. */
#define WAITING_MAX 192u

/* Items, each some 10 ns, that are looked at before should_stop is asked. A pass looks at
 * so many at a time. The boxes of a node take as long as some items. */
#define ITEMS_PER_LOOK 8192u
#define ITEMS_AT_ONCE  1024u
#define ITEMS_OF_NODE  8u

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

struct bounds {
    float low[3];
    float high[3];
};

static const struct bounds nothing = {{FLT_MAX, FLT_MAX, FLT_MAX},
                                      {-FLT_MAX, -FLT_MAX, -FLT_MAX}};

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

/* The state of a range that is divided: the next thing to be done to it. */
enum phase {
    TO_BEGIN,
    TO_FIND_MIDDLES,
    TO_FILL_BINS,
    TO_SORT,
    TO_MEASURE,
    TO_MEASURE_REST
};

/* A range that will be a node. */
struct waiting {
    uint32_t first;
    uint32_t count;
    uint32_t level;
    uint32_t place; /* of its number among the children of all nodes */
};

/* A tree that is not made yet: all that it takes to go on. One block of memory. */
struct eng_body_builder {
    _Alignas(eng_f4) bool has_items; /* and what comes behind the struct */
    bool has_nodes;
    uint32_t at; /* items that the pass has seen, or nodes that have their boxes */

    /* The node that is divided, if any, and into what so far. */
    uint32_t node;
    uint32_t level;
    uint32_t parts; /* 0: none is */
    struct range ranges[4];

    /* The range that is. */
    enum phase phase;
    uint32_t kept;           /* items that go to its first part, which they begin */
    struct bounds bounds[2]; /* of both parts */
    struct bounds middles;
    struct bin bins[3][BINS];
    struct cut cuts[3]; /* by axis */
    struct cut best;

    struct waiting waiting[WAITING_MAX];
    uint32_t waiting_count;
    uint32_t node_count;
    uint32_t (*children)[4]; /* [leaf_count] */
    struct item *items;      /* [leaf_count] */
    eng_f4 *corners;          /* [vertex_count] from the origin */

    /* Of the thread that is at it. */
    const struct eng_mesh *mesh;
    uint32_t looked; /* items since it was asked: */
    bool (*should_stop)(void *owner);
    void *owner;
};

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

/* Count what was looked at. False: whoever has asked for the tree wants no more. */
static bool goes_on(struct eng_body_builder *builder, uint32_t items)
{
    builder->looked += items;
    if (builder->looked < ITEMS_PER_LOOK) {
        return true;
    }
    builder->looked = 0;
    return !builder->should_stop || !builder->should_stop(builder->owner);
}

/* Have all items of a range seen, a few at a time. False: not all; the next call goes
 * on. */
static bool pass(struct eng_body_builder *builder, uint32_t first, uint32_t count,
                 void (*see)(struct eng_body_builder *, uint32_t first, uint32_t count))
{
    while (builder->at < count) {
        uint32_t left = count - builder->at;
        uint32_t n = left < ITEMS_AT_ONCE ? left : ITEMS_AT_ONCE;
        see(builder, first + builder->at, n);
        builder->at += n;
        if (!goes_on(builder, n)) {
            return false;
        }
    }
    builder->at = 0;
    return true;
}

static void see_middles(struct eng_body_builder *builder, uint32_t first, uint32_t count)
{
    for (uint32_t i = first; i < first + count; i++) {
        const struct item *item = &builder->items[i];
        float at[3] = {middle_of(item, 0), middle_of(item, 1), middle_of(item, 2)};
        add(&builder->middles, at, at);
    }
}

static void see_bounds(struct eng_body_builder *builder, uint32_t first, uint32_t count)
{
    struct bounds *bounds = &builder->bounds[builder->phase == TO_MEASURE ? 0 : 1];
    for (uint32_t i = first; i < first + count; i++) {
        add(bounds, builder->items[i].low, builder->items[i].high);
    }
}

static uint32_t bin_of(const struct cut *cut, const struct item *item)
{
    float at = (middle_of(item, cut->axis) - cut->low) * cut->scale;
    return at < BINS - 1 ? (uint32_t)at : BINS - 1;
}

/* Along the axes that have a length. */
static void empty_bins(struct eng_body_builder *builder)
{
    for (int k = 0; k < 3; k++) {
        float low = builder->middles.low[k];
        float length = builder->middles.high[k] - low;
        bool has_length = length > FLT_MIN && length < FLT_MAX;
        builder->cuts[k] = (struct cut){.axis = has_length ? k : -1,
                                        .low = low,
                                        .scale = (float)BINS * (1 - 0x1p-20f) / length};
        for (uint32_t i = 0; i < BINS; i++) {
            builder->bins[k][i] = (struct bin){nothing, 0};
        }
    }
}

static void see_bins(struct eng_body_builder *builder, uint32_t first, uint32_t count)
{
    for (int k = 0; k < 3; k++) {
        const struct cut cut = builder->cuts[k];
        for (uint32_t i = first; i < first + count && cut.axis >= 0; i++) {
            const struct item *item = &builder->items[i];
            struct bin *bin = &builder->bins[k][bin_of(&cut, item)];
            add(&bin->bounds, item->low, item->high);
            bin->count++;
        }
    }
}

/* So many nodes hold them at least. */
static float blocks_of(uint32_t count)
{
    return (float)((count + 3) / 4);
}

static void unite(struct bin *all, const struct bin *bin)
{
    add(&all->bounds, bin->bounds.low, bin->bounds.high);
    all->count += bin->count;
}

/* Find the best cut along an axis, if it is better than *best. */
static void look_along(const struct bin bins[BINS], uint32_t count, struct cut cut,
                       struct cut *best)
{
    float cost[BINS];
    struct bin all = {nothing, 0};
    for (uint32_t i = BINS - 1; i > 0; i--) {
        unite(&all, &bins[i]);
        cost[i] = area_of(&all.bounds) * blocks_of(all.count);
    }
    all = (struct bin){nothing, 0};
    for (uint32_t i = 1; i < BINS; i++) {
        unite(&all, &bins[i - 1]);
        cut.cost = cost[i] + area_of(&all.bounds) * blocks_of(all.count);
        cut.bin = i;
        if (all.count > 0 && all.count < count && cut.cost < best->cost) {
            *best = cut;
        }
    }
}

/* Choose the cut, and bound what is on either side of it. */
static void choose_cut(struct eng_body_builder *builder, uint32_t count)
{
    struct cut *best = &builder->best;
    *best = (struct cut){.axis = -1, .cost = INFINITY};
    for (int k = 0; k < 3; k++) {
        if (builder->cuts[k].axis >= 0) {
            look_along(builder->bins[k], count, builder->cuts[k], best);
        }
    }
    for (uint32_t i = 0; i < BINS && best->axis >= 0; i++) {
        const struct bin *bin = &builder->bins[best->axis][i];
        add(&builder->bounds[i < best->bin ? 0 : 1], bin->bounds.low, bin->bounds.high);
    }
}

/* Bring those on the near side of the cut to the beginning of their range. */
static void see_sides(struct eng_body_builder *builder, uint32_t first, uint32_t count)
{
    struct item *items = builder->items;
    struct item *next = items + first - builder->at + builder->kept;
    for (uint32_t i = first; i < first + count; i++) {
        if (bin_of(&builder->best, &items[i]) < builder->best.bin) {
            struct item one = items[i];
            items[i] = *next;
            *next++ = one;
            builder->kept++;
        }
    }
}

/* Divide a range of more than one item: the rest of it becomes another. False: not yet;
 * the next call goes on. */
static bool divide(struct eng_body_builder *builder, struct range *whole,
                   struct range *rest)
{
    const uint32_t first = whole->first;
    const uint32_t count = whole->count;
    if (builder->phase == TO_BEGIN) {
        builder->bounds[0] = builder->bounds[1] = builder->middles = nothing;
        builder->kept = count <= 4 ? 1 : count / 2;
        builder->phase =
            count > 4 && builder->level < LEVEL_OF_HALVES ? TO_FIND_MIDDLES : TO_MEASURE;
    }
    if (builder->phase == TO_FIND_MIDDLES) {
        if (!pass(builder, first, count, see_middles)) {
            return false;
        }
        empty_bins(builder);
        builder->phase = TO_FILL_BINS;
    }
    if (builder->phase == TO_FILL_BINS) {
        if (!pass(builder, first, count, see_bins)) {
            return false;
        }
        choose_cut(builder, count);
        bool has_cut = builder->best.axis >= 0;
        builder->kept = has_cut ? 0 : builder->kept;
        builder->phase = has_cut ? TO_SORT : TO_MEASURE;
    }
    if (builder->phase == TO_SORT && !pass(builder, first, count, see_sides)) {
        return false;
    }
    if (builder->phase == TO_MEASURE) {
        if (!pass(builder, first, builder->kept, see_bounds)) {
            return false;
        }
        builder->phase = TO_MEASURE_REST;
    }
    if (builder->phase == TO_MEASURE_REST &&
        !pass(builder, first + builder->kept, count - builder->kept, see_bounds)) {
        return false;
    }
    *whole = (struct range){first, builder->kept, area_of(&builder->bounds[0])};
    *rest = (struct range){first + builder->kept, count - builder->kept,
                           area_of(&builder->bounds[1])};
    builder->phase = TO_BEGIN;
    return true;
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
    return parts < 4 ? best : -1;
}

static void begin_node(struct eng_body_builder *builder)
{
    const struct waiting *next = &builder->waiting[--builder->waiting_count];
    builder->node = builder->node_count++;
    if (builder->node > 0) {
        builder->children[next->place / 4][next->place % 4] = builder->node;
    }
    builder->level = next->level;
    builder->ranges[0] = (struct range){next->first, next->count, 0};
    builder->parts = 1;
}

/* Its parts are leaves, or wait: the first of them is the next node. */
static void end_node(struct eng_body_builder *builder)
{
    for (uint32_t i = 4; i-- > 0;) {
        const struct range *range = &builder->ranges[i];
        uint32_t *child = &builder->children[builder->node][i];
        if (i >= builder->parts) {
            *child = ENG_BODY_NONE;
        } else if (range->count == 1) {
            *child = ENG_BODY_LEAF | builder->items[range->first].leaf;
        } else {
            assert(builder->waiting_count < WAITING_MAX);
            builder->waiting[builder->waiting_count++] = (struct waiting){
                range->first, range->count, builder->level + 1, builder->node * 4 + i};
        }
    }
    builder->parts = 0;
}

/* False: not yet, as below. */
static bool make_nodes(struct eng_body_builder *builder)
{
    while (builder->parts > 0 || builder->waiting_count > 0) {
        if (builder->parts == 0) {
            begin_node(builder);
        }
        struct range *ranges = builder->ranges;
        for (int at = next_of(ranges, builder->parts); at >= 0;
             at = next_of(ranges, builder->parts)) {
            if (!divide(builder, &ranges[at], &ranges[builder->parts])) {
                return false;
            }
            builder->parts++;
        }
        end_node(builder);
    }
    return true;
}

/* ---- boxes ------------------------------------------------------------------------- */

/* The bounds of four children, by child: x, y, z, and one unused. */
struct four_bounds {
    eng_f4 low[4];
    eng_f4 high[4];
};

static void bound_leaf(const struct eng_face *leaf, const eng_f4 *corners, eng_f4 *low,
                       eng_f4 *high)
{
    eng_f4 a = corners[leaf->v[0]];
    eng_f4 b = corners[leaf->v[1]];
    eng_f4 c = corners[leaf->v[2]];
    *low = eng_min4(eng_min4(a, b), c);
    *high = eng_max4(eng_max4(a, b), c);
}

/* Return the least of four by axis. */
static eng_f4 least_of(const eng_f4 x[3])
{
    eng_f4 xy = eng_min4(__builtin_shufflevector(x[0], x[1], 0, 4, 1, 5),
                         __builtin_shufflevector(x[0], x[1], 2, 6, 3, 7));
    eng_f4 z = eng_min4(x[2], __builtin_shufflevector(x[2], x[2], 2, 3, 0, 1));
    xy = eng_min4(xy, __builtin_shufflevector(xy, xy, 2, 3, 0, 1));
    z = eng_min4(z, __builtin_shufflevector(z, z, 1, 0, 3, 2));
    return __builtin_shufflevector(xy, z, 0, 1, 4, 4);
}

/* The box of no child holds nothing, and so bounds nothing. */
static void bound_node(const struct eng_body_boxes *boxes, eng_f4 *low, eng_f4 *high)
{
    eng_f4 from[3];
    eng_f4 to[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        from[k] = boxes->centre[k] - boxes->half[k];
        to[k] = -boxes->centre[k] - boxes->half[k];
    }
    *low = least_of(from);
    *high = -least_of(to);
}

/* Rounded outward: what is added is more than roundings of bounds, each 2^-24 of what is
 * at most |centre| + half, and of the half take off, however small it is. */
static void put_boxes(const struct four_bounds *bounds, struct eng_body_boxes *boxes)
{
    eng_f4 low[3];
    eng_f4 high[3];
    const eng_f4 *from = bounds->low;
    const eng_f4 *to = bounds->high;
    eng_body_transpose(from[0], from[1], from[2], from[3], low);
    eng_body_transpose(to[0], to[1], to[2], to[3], high);
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        eng_f4 centre = 0.5f * (low[k] + high[k]);
        eng_f4 half = eng_max4(high[k] - centre, centre - low[k]);
        eng_f4 far = eng_max4(centre, -centre);
        boxes->centre[k] = centre;
        boxes->half[k] = half * (1 + 0x1p-21f) + far * 0x1p-22f + 0x1p-120f;
    }
}

/* Hold what boxes are made of. */
struct source {
    const struct eng_mesh *mesh;
    const struct eng_body_tree *tree;
    const eng_f4 *corners; /* from the origin of the boxes */
    bool no_lowest;        /* lowest nodes get none */
};

/* Return whether no child of a node is a node. */
static bool is_lowest(const uint32_t children[4])
{
    return (children[0] & children[1] & children[2] & children[3] & ENG_BODY_LEAF) != 0;
}

/* Bound the leaves of a lowest node, which has no boxes. */
static void bound_leaves(const struct eng_mesh *mesh, const uint32_t children[4],
                         const eng_f4 *corners, eng_f4 *low, eng_f4 *high)
{
    bound_leaf(&mesh->leaves[children[0] & ~ENG_BODY_LEAF], corners, low, high);
    for (int i = 1; i < 4 && children[i] != ENG_BODY_NONE; i++) {
        eng_f4 from;
        eng_f4 to;
        bound_leaf(&mesh->leaves[children[i] & ~ENG_BODY_LEAF], corners, &from, &to);
        *low = eng_min4(*low, from);
        *high = eng_max4(*high, to);
    }
}

/* Make the boxes of a node; those of the nodes after it are in `boxes`, but for those of
 * lowest ones that get none. */
static void make_boxes(const struct source *from, uint32_t node,
                       const struct eng_body_boxes *boxes, struct eng_body_boxes *made)
{
    const uint32_t(*nodes)[4] = (const uint32_t(*)[4])from->tree->children;
    const uint32_t *children = nodes[node];
    struct four_bounds bounds;
    for (int i = 0; i < 4; i++) {
        if (children[i] == ENG_BODY_NONE) {
            bounds.low[i] = bounds.high[i] = (eng_f4){0, 0, 0, 0};
        } else if (children[i] & ENG_BODY_LEAF) {
            bound_leaf(&from->mesh->leaves[children[i] & ~ENG_BODY_LEAF], from->corners,
                       &bounds.low[i], &bounds.high[i]);
        } else if (from->no_lowest && is_lowest(nodes[children[i]])) {
            bound_leaves(from->mesh, nodes[children[i]], from->corners, &bounds.low[i],
                         &bounds.high[i]);
        } else {
            bound_node(&boxes[children[i]], &bounds.low[i], &bounds.high[i]);
        }
    }
    put_boxes(&bounds, made);
    for (int i = 0; i < 4 && children[3] == ENG_BODY_NONE; i++) {
        for (int k = 0; k < 3 && children[i] == ENG_BODY_NONE; k++) {
            made->half[k][i] = -0x1p120f; /* holds nothing */
        }
    }
}

/* Set the box around bounds, and the middle of it. */
static void set_box(const struct eng_bounds *bounds, struct eng_path_box *box,
                    double origin[3])
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = bounds->low[k];
        box->hi[k] = bounds->high[k];
        origin[k] = 0.5 * bounds->low[k] + 0.5 * bounds->high[k];
    }
}

/* ---- the tree of a mesh ------------------------------------------------------------ */

static void see_leaves(struct eng_body_builder *builder, uint32_t first, uint32_t count)
{
    const struct eng_mesh *mesh = builder->mesh;
    struct eng_path_box box;
    double origin[3];
    set_box(&mesh->bounds, &box, origin);
    for (uint32_t i = first; i < first + count; i++) {
        struct item *item = &builder->items[i];
        const uint32_t *v = mesh->leaves[i].v;
        eng_f4 low;
        eng_f4 high;
        for (int k = 0; k < 3; k++) {
            builder->corners[v[k]] = eng_body_place(mesh->x[v[k]], origin);
        }
        bound_leaf(&mesh->leaves[i], builder->corners, &low, &high);
        memcpy(item->low, &low, sizeof item->low);
        memcpy(item->high, &high, sizeof item->high);
        item->leaf = i;
    }
}

static size_t builder_bytes(const struct eng_mesh *mesh)
{
    return sizeof(struct eng_body_builder) + mesh->info.vertex_count * sizeof(eng_f4) +
           mesh->leaf_count * (sizeof(struct item) + 4 * sizeof(uint32_t));
}

/* Each node has two children at least: there are no more nodes than leaves. */
static struct eng_body_builder *begin(const struct eng_mesh *mesh)
{
    struct eng_body_builder *builder = eng_alloc(1, builder_bytes(mesh));
    if (builder) {
        memset(builder, 0, sizeof *builder);
        builder->corners = (void *)(builder + 1);
        builder->children = (void *)(builder->corners + mesh->info.vertex_count);
        builder->items = (void *)(builder->children + mesh->leaf_count);
        builder->waiting[0] = (struct waiting){.count = mesh->leaf_count};
        builder->waiting_count = 1;
    }
    return builder;
}

static size_t bytes_of(uint32_t node_count)
{
    return sizeof(struct eng_body_tree) + sizeof(struct eng_body_boxes) +
           node_count * (sizeof(struct eng_body_boxes) + 4 * sizeof(uint32_t));
}

/* One block: the tree, its boxes, its children, neither of which are there yet. */
static struct eng_body_tree *begin_tree(const struct eng_body_builder *builder)
{
    size_t head = sizeof(struct eng_body_tree);
    head += sizeof(struct eng_body_boxes) - head % sizeof(struct eng_body_boxes);
    struct eng_body_tree *tree = eng_alloc(1, bytes_of(builder->node_count));
    if (tree) {
        unsigned char *block = (unsigned char *)tree;
        tree->node_count = builder->node_count;
        tree->boxes = (void *)(block + head);
        tree->children = (void *)(tree->boxes + builder->node_count);
        set_box(&builder->mesh->bounds, &tree->box, tree->origin);
    }
    return tree;
}

/* Give the nodes their children and boxes, from the last to the first. */
static bool fill_tree(struct eng_body_builder *builder, struct eng_body_tree *tree)
{
    const struct source from = {builder->mesh, tree, builder->corners, false};
    while (builder->at < tree->node_count) {
        uint32_t node = tree->node_count - ++builder->at;
        memcpy(tree->children[node], builder->children[node], sizeof *tree->children);
        make_boxes(&from, node, tree->boxes, &tree->boxes[node]);
        if (!goes_on(builder, ITEMS_OF_NODE)) {
            return false;
        }
    }
    return true;
}

/* Go on with the tree that nobody else is at. */
static int build(struct eng_mesh *mesh, bool (*should_stop)(void *owner), void *owner)
{
    struct eng_body_build *made = &mesh->body_build;
    made->builder = made->builder ? made->builder : begin(mesh);
    struct eng_body_builder *builder = made->builder;
    if (!builder) {
        return PCCD_E_NOMEM;
    }
    builder->mesh = mesh;
    builder->should_stop = should_stop;
    builder->owner = owner;
    builder->has_items =
        builder->has_items || pass(builder, 0, mesh->leaf_count, see_leaves);
    builder->has_nodes =
        builder->has_nodes || (builder->has_items && make_nodes(builder));
    if (builder->has_nodes && !made->tree) {
        made->tree = begin_tree(builder);
        if (!made->tree) {
            return PCCD_E_NOMEM;
        }
    }
    return builder->has_nodes && fill_tree(builder, made->tree) ? PCCD_OK : PCCD_E_AGAIN;
}

/* Whoever sees the tree sees what is in it. */
static void finish(struct eng_mesh *mesh)
{
    struct eng_body_build *made = &mesh->body_build;
    atomic_store_explicit(&mesh->body_tree, made->tree, memory_order_release);
    eng_free(made->builder);
    made->builder = NULL;
    made->tree = NULL;
}

static uint64_t bytes_held(const struct eng_mesh *mesh)
{
    const struct eng_body_build *made = &mesh->body_build;
    const struct eng_body_tree *tree = made->tree ? made->tree : eng_body_tree_of(mesh);
    return (made->builder ? builder_bytes(mesh) : 0) +
           (tree ? bytes_of(tree->node_count) : 0);
}

int eng_body_tree_prepare(struct eng_mesh *mesh, bool (*should_stop)(void *owner),
                          void *owner)
{
    assert(mesh->committed);
    if (eng_body_tree_of(mesh)) {
        return PCCD_OK;
    }
    if (atomic_exchange_explicit(&mesh->body_build.is_taken, true,
                                 memory_order_acquire)) {
        return PCCD_E_AGAIN; /* another thread is at it */
    }
    int status = PCCD_OK;
    if (!eng_body_tree_of(mesh)) { /* nor was while it was taken */
        struct eng_account *before = eng_charge_to(mesh->account);
        status = build(mesh, should_stop, owner);
        if (status == PCCD_OK) {
            finish(mesh);
        }
        (void)eng_charge_to(before);
        atomic_store_explicit(&mesh->body_tree_bytes, bytes_held(mesh),
                              memory_order_relaxed);
    }
    atomic_store_explicit(&mesh->body_build.is_taken, false, memory_order_release);
    return status;
}

const struct eng_body_tree *eng_body_tree_of(const struct eng_mesh *mesh)
{
    return atomic_load_explicit(&mesh->body_tree, memory_order_acquire);
}

/* ---- an object in a step ----------------------------------------------------------- */

/* Vertices that are compared, and nodes that get their boxes, between two questions
 * whether to stop. */
#define VERTICES_PER_LOOK 4096u
#define NODES_PER_LOOK    1024u

/* Nodes after which leaves are used that are fetched: they lie anywhere in the mesh. */
#define AHEAD 8u

void eng_body_set(struct eng_body *body, const struct eng_mesh *mesh)
{
    const struct eng_body_tree *tree = eng_body_tree_of(mesh);
    body->mesh = mesh;
    body->x[0] = body->x[1] = (const double(*)[3])mesh->x;
    body->boxes[0] = body->boxes[1] = tree->boxes;
    body->box = tree->box;
    memcpy(body->origin, tree->origin, sizeof body->origin);
}

static bool wants_no_more(const struct eng_body *body)
{
    return body->should_stop && body->should_stop(body->owner);
}

/* Find out whether positions of all vertices are equal. PCCD_E_AGAIN: it was stopped. */
static int compare(const struct eng_body *body, const double (*a)[3],
                   const double (*b)[3], bool *are_equal)
{
    const uint32_t count = body->mesh->info.vertex_count;
    *are_equal = true;
    for (uint32_t i = 0; i < count && a != b && *are_equal; i += VERTICES_PER_LOOK) {
        uint32_t n = count - i < VERTICES_PER_LOOK ? count - i : VERTICES_PER_LOOK;
        *are_equal = memcmp(a + i, b + i, n * sizeof *a) == 0;
        if (i > 0 && wants_no_more(body)) {
            return PCCD_E_AGAIN;
        }
    }
    return PCCD_OK;
}

/* Make boxes of an end; there is room for corners. False: it was stopped. */
static bool fit(const struct eng_body *body, int end, struct eng_body_boxes *boxes)
{
    const struct eng_body_tree *tree = eng_body_tree_of(body->mesh);
    const double(*x)[3] = body->x[end];
    eng_f4 *corners = body->corners[end];
    const struct source from = {body->mesh, tree, corners, body->lacks_lowest};
    for (uint32_t i = 0; i < body->mesh->info.vertex_count; i++) {
        if (i % VERTICES_PER_LOOK == 0 && i > 0 && wants_no_more(body)) {
            return false;
        }
        corners[i] = eng_body_place(x[i], body->origin);
    }
    for (uint32_t node = tree->node_count; node-- > 0;) {
        const uint32_t *ahead = tree->children[node >= AHEAD ? node - AHEAD : 0];
        for (int i = 0; i < 4 && ahead[i] != ENG_BODY_NONE; i++) {
            __builtin_prefetch(&body->mesh->leaves[ahead[i] & ~ENG_BODY_LEAF]);
        }
        if (node % NODES_PER_LOOK == 0 && wants_no_more(body)) {
            return false;
        }
        if (!from.no_lowest || !is_lowest(tree->children[node])) {
            make_boxes(&from, node, boxes, &boxes[node]);
        }
    }
    return true;
}

void eng_body_put(struct eng_body *body, const struct eng_mesh *mesh,
                  const double (*x0)[3], const double (*x1)[3],
                  const struct eng_bounds *bounds)
{
    body->mesh = mesh;
    body->x[0] = x0;
    body->x[1] = x1;
    body->boxes[0] = NULL;
    body->boxes[1] = x0 == x1 ? NULL : eng_body_tree_of(mesh)->boxes; /* it moves */
    set_box(bounds, &body->box, body->origin);
}

int eng_body_fit(struct eng_body *body, const struct eng_mesh *mesh,
                 const double (*x0)[3], const double (*x1)[3],
                 const struct eng_bounds *bounds)
{
    const struct eng_body_tree *tree = eng_body_tree_of(mesh);
    bool stands;
    bool is_registered = false;
    body->mesh = mesh;
    int status = compare(body, x0, x1, &stands);
    if (status == PCCD_OK && stands) {
        status = compare(body, x0, (const double(*)[3])mesh->x, &is_registered);
    }
    if (status == PCCD_OK && is_registered) {
        eng_body_set(body, mesh);
        return PCCD_OK;
    }
    const uint32_t ends = stands ? 1 : 2;
    const uint64_t corners =
        (mesh->info.vertex_count * sizeof(eng_f4) + sizeof *body->fit - 1) /
        sizeof *body->fit;
    const uint64_t all = ends * (tree->node_count + corners);
    if (status == PCCD_OK && all > UINT32_MAX) {
        status = PCCD_E_LIMIT;
    }
    if (status == PCCD_OK) {
        status = eng_array_fit(&body->fit, &body->fit_capacity, (uint32_t)all,
                               sizeof *body->fit);
    }
    if (status != PCCD_OK) {
        return status;
    }
    body->x[0] = x0;
    body->x[1] = x1;
    set_box(bounds, &body->box, body->origin);
    bool is_made = true;
    body->lacks_lowest = body->may_lack_lowest && !stands;
    for (uint32_t end = 0; end < ends && is_made; end++) {
        struct eng_body_boxes *boxes = body->fit + end * tree->node_count;
        body->corners[end] =
            (void *)(body->fit + ends * tree->node_count + end * corners);
        is_made = fit(body, (int)end, boxes);
        body->boxes[end] = boxes;
    }
    if (stands) {
        body->boxes[1] = body->boxes[0];
    }
    return is_made ? PCCD_OK : PCCD_E_AGAIN;
}

void eng_body_bound_lowest(const struct eng_body *body, int end, uint32_t node,
                           struct eng_body_boxes *boxes)
{
    const struct source from = {body->mesh, eng_body_tree_of(body->mesh),
                                body->corners[end], false};
    make_boxes(&from, node, NULL, boxes);
}

uint32_t eng_body_split(uint32_t most, uint64_t *tasks,
                        uint32_t (*part)(void *owner, uint64_t task, uint64_t parts[4]),
                        void *owner)
{
    uint32_t count = 1;
    uint32_t next = 0;
    uint32_t unchanged = 0; /* tasks in succession that stayed as they are */
    tasks[0] = 0;
    while (count > 0 && count + 3 <= most && unchanged < count) {
        uint64_t parts[4];
        uint64_t task = tasks[next];
        uint32_t n = part(owner, task, parts);
        tasks[next] = n > 0 ? parts[0] : tasks[count - 1];
        count -= n == 0;
        for (uint32_t i = 1; i < n; i++) {
            tasks[count++] = parts[i];
        }
        unchanged = n == 1 && parts[0] == task ? unchanged + 1 : 0;
        next = next + 1 < count ? next + 1 : 0;
    }
    return count;
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
