/* wide.c - the trees of the method `wide`, put together. */
#include "wide.h"

#include <string.h>

#include "memory.h"
#include "world.h"

void eng_wide_init(struct eng_wide *wide)
{
    memset(wide, 0, sizeof *wide);
    wide->kernels = eng_kernels();
    atomic_init(&wide->left_grid, false);
    atomic_init(&wide->farthest, 0);
    wide->frame_scale = 1;
    wide->is_stale = true;
}

void eng_wide_deinit(struct eng_wide *wide)
{
    eng_free(wide->arrays);
    eng_free(wide->float_arrays);
    eng_free(wide->items);
}

static uint32_t corner_count(enum pccd_tree kind)
{
    return kind == PCCD_TREE_FACES ? 3 : kind == PCCD_TREE_EDGES ? 2 : 0;
}

uint64_t eng_wide_bytes(const struct eng_wide *wide)
{
    return wide->array_bytes + wide->float_bytes +
           (uint64_t)wide->item_capacity * sizeof *wide->items;
}

static uint32_t round_up(uint64_t count, uint32_t multiple)
{
    return (uint32_t)((count + multiple - 1) / multiple * multiple);
}

/* Where a list of `count` begins: at a multiple of this, so that its groups are groups of
 * the whole, for less than an eighth of its size in slots that nobody takes. */
static uint32_t alignment(uint32_t count)
{
    uint32_t multiple = ENG_WIDE;
    while (multiple < (1u << 24) && multiple * ENG_WIDE <= count / 8) {
        multiple *= ENG_WIDE;
    }
    return multiple;
}

uint32_t eng_wide_first_slot(uint32_t end, uint32_t count)
{
    return round_up(end, alignment(count));
}

/* Twice the centre of an object where it stands: only the order matters. */
static struct eng_split_item item_of(const struct eng_scene *scene, uint32_t object_idx)
{
    const struct eng_object *object = &scene->objects[object_idx];
    const struct eng_bounds *bounds = &object->bounds[scene->now];
    struct eng_split_item item = {.id = object_idx};
    for (int k = 0; k < 3; k++) {
        item.centroid[k] = (float)(eng_box_frame_at(&object->frame, bounds->low[k], k) +
                                   eng_box_frame_at(&object->frame, bounds->high[k], k));
    }
    return item;
}

/* The objects in their order. */
static int order_objects(struct eng_wide *wide, const struct eng_scene *scene)
{
    int status = eng_array_extend(&wide->items, &wide->item_capacity, scene->object_count,
                                  sizeof *wide->items);
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            wide->items[count++] = item_of(scene, i);
        }
    }
    if (count > 1) {
        eng_wide_sort(wide->items, count, 1);
    }
    return PCCD_OK;
}

/* Slots of a tree over all objects. The last vertex slot is nobody's: that of features
 * which are nowhere. */
static uint64_t count_slots(const struct eng_wide *wide, const struct eng_scene *scene,
                            enum pccd_tree kind)
{
    uint64_t end = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        uint32_t count =
            eng_wide_order_of(&scene->objects[wide->items[i].id])->count[kind];
        end = (end + alignment(count) - 1) / alignment(count) * alignment(count);
        end += count;
    }
    end += kind == PCCD_TREE_VERTICES;
    return end > ENG_WIDE ? end : ENG_WIDE;
}

/* Blocks of a tree of that many slots, with as many as a full block of the next level
 * needs; the highest has but one. */
static uint32_t count_blocks(uint32_t slot_count, uint32_t level_count,
                             struct eng_wide_tree *tree)
{
    uint32_t blocks = slot_count / ENG_WIDE;
    uint32_t first = 0;
    for (uint32_t level = 0; level < level_count; level++) {
        if (tree) {
            tree->first[level] = first;
            tree->block_count[level] = blocks;
        }
        first += level + 1 < level_count ? round_up(blocks, ENG_WIDE) : blocks;
        blocks = (blocks + ENG_WIDE - 1) / ENG_WIDE;
    }
    return first;
}

/* ---- memory ------------------------------------------------------------------------ */

/* Let `ARRAY` have `COUNT` items from `used` on in a block, from which on others come
 * then; without a block only count. */
#define ARRAY_ALIGNMENT 128u
#define LAY(ARRAY, COUNT)                                                                \
    do {                                                                                 \
        (ARRAY) = block ? (void *)(block + used) : (ARRAY);                              \
        used += (uint64_t)(COUNT) * sizeof *(ARRAY);                                     \
        used = (used + ARRAY_ALIGNMENT - 1) / ARRAY_ALIGNMENT * ARRAY_ALIGNMENT;         \
    } while (0)

static uint32_t free_count(const struct eng_mesh *mesh, enum pccd_tree kind)
{
    return kind == PCCD_TREE_VERTICES ? mesh->info.free_point_count
           : kind == PCCD_TREE_EDGES  ? mesh->info.free_edge_count
                                      : 0;
}

/* In which trees anything is free, or foreign. Faces are first in no pair. */
struct marked {
    bool free[ENG_WIDE_TREES], own[ENG_WIDE_TREES];
};

static struct marked marked_of(const struct eng_scene *scene)
{
    struct marked marked = {{false}, {false}};
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_mesh *mesh = scene->objects[i].mesh;
        for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES && mesh; kind++) {
            marked.free[kind] |= free_count(mesh, kind) > 0;
            marked.own[kind] |= kind != PCCD_TREE_FACES && eng_mesh_has_foreign(mesh);
        }
    }
    return marked;
}

/* Return how many bytes all arrays need that are not of floats. They are in `block`, if
 * it is not NULL, from now on. */
static uint64_t lay_out(struct eng_wide *wide, unsigned char *block,
                        const struct eng_scene *scene, const struct marked *marked,
                        const uint32_t slots[ENG_WIDE_TREES], uint32_t level_count)
{
    uint64_t used = 0;
    LAY(wide->points, slots[PCCD_TREE_VERTICES]);
    LAY(wide->marks, slots[PCCD_TREE_VERTICES]);
    LAY(wide->slot_of, scene->vertex_capacity);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t leaves = slots[kind] / ENG_WIDE;
        uint32_t blocks = count_blocks(slots[kind], level_count, NULL);
        for (uint32_t k = 0; k < corner_count(kind); k++) {
            LAY(tree->corner[k], slots[kind]);
        }
        bool is_of_vertices = kind == PCCD_TREE_VERTICES;
        LAY(tree->index, is_of_vertices ? 0 : slots[kind]);
        LAY(tree->object_id, is_of_vertices ? 0 : leaves);
        LAY(tree->keys, is_of_vertices || !marked->own[kind] ? 0 : slots[kind]);
        LAY(tree->quantised, blocks);
        LAY(tree->quantised_boxes, blocks);
        LAY(tree->chunks, eng_wide_chunks(slots[kind]));
        LAY(tree->moving, blocks);
        LAY(tree->free, marked->free[kind] ? blocks : 0);
        LAY(tree->own, marked->own[kind] ? blocks : 0);
        tree->has_free = block ? marked->free[kind] : tree->has_free;
        tree->has_own = block ? marked->own[kind] : tree->has_own;
    }
    return used;
}

/* The same of the arrays of floats, of trees that are put together. */
static uint64_t lay_out_floats(struct eng_wide *wide, unsigned char *block)
{
    uint64_t used = 0;
    LAY(wide->point_boxes, wide->trees[PCCD_TREE_VERTICES].slot_count);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t blocks = count_blocks(tree->slot_count, wide->level_count, NULL);
        LAY(tree->floats, blocks);
        LAY(tree->float_boxes, blocks);
    }
    return used;
}

/* Return whether a block has room, and not by far too much. A large one is not kept for
 * what went away: a rank whose part of a scene shrinks needs its memory elsewhere. */
#define BYTES_KEPT (2u << 20)
static bool fits(uint64_t wanted, uint64_t bytes)
{
    return wanted <= bytes && (bytes <= BYTES_KEPT || wanted >= bytes / 2);
}

/* Have a block that fits, whose content is lost. It grows by an eighth, as arrays do
 * (memory.h). */
static int reserve(unsigned char **block, uint64_t *bytes, uint64_t wanted)
{
    if (fits(wanted, *bytes)) {
        return PCCD_OK;
    }
    uint64_t grown = *bytes + *bytes / 8;
    uint64_t size = wanted > *bytes && wanted < grown ? grown : wanted;
    unsigned char *other = eng_alloc(size, 1);
    if (!other) {
        return PCCD_E_NOMEM;
    }
    eng_free(*block);
    *block = other;
    *bytes = size;
    return PCCD_OK;
}

void eng_wide_put_nowhere(const struct eng_wide_tree *tree, uint32_t first, uint32_t end,
                          bool floats)
{
    struct eng_extents box;
    struct eng_quantised_box quantised;
    for (uint32_t i = 0; i < 4 * ENG_SIDES; i++) {
        box.side[i / 4][i % 4] = ENG_NOWHERE;
    }
    for (uint32_t i = 0; i < 12; i++) {
        quantised.half[i / 6][i % 6] = INT16_MIN;
    }
    for (uint32_t block = first; block < end && floats; block++) {
        tree->float_boxes[block] = box;
    }
    for (uint32_t block = first; block < end && !floats; block++) {
        tree->quantised_boxes[block] = quantised;
    }
}

/* Boxes that fill the last node of a level up: it has sixteen. Of floats or of whole
 * numbers. */
static void fill_levels_up(const struct eng_wide *wide, const struct eng_wide_tree *tree,
                           bool floats)
{
    for (uint32_t level = 0; level + 1 < wide->level_count; level++) {
        eng_wide_put_nowhere(tree, tree->first[level] + tree->block_count[level],
                             tree->first[level + 1], floats);
    }
}

/* Floats are made anew: they are lost where the trees have become other ones. */
static void drop_floats(struct eng_wide *wide)
{
    eng_free(wide->float_arrays);
    wide->float_arrays = NULL;
    wide->float_bytes = 0;
}

int eng_wide_reserve_floats(struct eng_wide *wide)
{
    int status =
        reserve(&wide->float_arrays, &wide->float_bytes, lay_out_floats(wide, NULL));
    if (status != PCCD_OK) {
        return status;
    }
    lay_out_floats(wide, wide->float_arrays);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        fill_levels_up(wide, &wide->trees[kind], true);
    }
    return PCCD_OK;
}

/* Slots from `first` up to `end` belong to nobody. */
static void clear(struct eng_wide *wide, enum pccd_tree kind, uint32_t first,
                  uint32_t end)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    for (uint32_t slot = first; slot < end; slot++) {
        if (kind == PCCD_TREE_VERTICES) {
            memset(&wide->points[slot], 0, sizeof wide->points[slot]);
            wide->points[slot].word0 = ENG_WIDE_NOBODY;
            continue;
        }
        for (uint32_t k = 0; k < corner_count(kind); k++) {
            tree->corner[k][slot] = wide->trees[PCCD_TREE_VERTICES].slot_count - 1;
        }
    }
}

/* The vertices of one object into the slots from `first` on. */
static void fill_vertices(struct eng_wide *wide, const struct eng_scene *scene,
                          uint32_t object_idx, uint32_t first)
{
    const struct eng_object *object = &scene->objects[object_idx];
    const struct eng_wide_order *order = eng_wide_order_of(object);
    const uint32_t *feature = order->feature[PCCD_TREE_VERTICES];
    const uint32_t count = order->count[PCCD_TREE_VERTICES];
    uint32_t *slot_of = wide->slot_of + object->vertices.first;
    memset(slot_of, 0xff, object->vertices.count * sizeof *slot_of); /* NO_SLOT */
    for (uint32_t i = 0; i < count; i++) {
        if (feature[i] == ENG_WIDE_NO_FEATURE) {
            clear(wide, PCCD_TREE_VERTICES, first + i, first + i + 1);
            continue;
        }
        wide->points[first + i] = (struct eng_point){
            .word0 = (uint64_t)object_idx << 32 | (object->vertices.first + feature[i]),
            .word1 = (uint64_t)object->id << 32 | feature[i]};
        slot_of[feature[i]] = first + i;
    }
}

/* The edges or faces, after the vertices. corners[stride feature]: those of a feature. */
static inline __attribute__((always_inline)) void
fill_features(struct eng_wide *wide, const struct eng_object *object, enum pccd_tree kind,
              uint32_t first, const uint32_t *corners, uint32_t stride)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    const struct eng_wide_order *order = eng_wide_order_of(object);
    const uint32_t *feature = order->feature[kind];
    const uint32_t count = order->count[kind];
    const uint32_t *slot_of = wide->slot_of + object->vertices.first;
    uint32_t *corner[3] = {tree->corner[0] + first, tree->corner[1] + first,
                           kind == PCCD_TREE_FACES ? tree->corner[2] + first : NULL};
    for (uint32_t i = 0; i < count; i++) {
        if (feature[i] == ENG_WIDE_NO_FEATURE) {
            clear(wide, kind, first + i, first + i + 1);
            continue;
        }
        const uint32_t *of = corners + (size_t)stride * feature[i];
        tree->index[first + i] = feature[i];
        tree->object_id[(first + i) / ENG_WIDE] = object->id;
        if (tree->has_own) {
            tree->keys[first + i] = (uint64_t)object->id << 32 | feature[i];
        }
#pragma GCC unroll 3
        for (uint32_t k = 0; k < corner_count(kind); k++) {
            corner[k][i] = slot_of[of[k]];
        }
    }
}

/* The features of one object into its slots. */
static void fill(struct eng_wide *wide, const struct eng_scene *scene,
                 uint32_t object_idx, enum pccd_tree kind, uint32_t first)
{
    const struct eng_object *object = &scene->objects[object_idx];
    if (kind == PCCD_TREE_VERTICES) {
        fill_vertices(wide, scene, object_idx, first);
    } else if (kind == PCCD_TREE_EDGES) {
        fill_features(wide, object, PCCD_TREE_EDGES, first,
                      (const uint32_t *)object->mesh->edges, 2);
    } else {
        static_assert(offsetof(struct eng_face, v) == 0, "corners");
        fill_features(wide, object, PCCD_TREE_FACES, first,
                      (const uint32_t *)object->mesh->leaves,
                      sizeof(struct eng_face) / sizeof(uint32_t));
    }
}

/* Mark all nodes above marks that are set. */
static void mark_above(const struct eng_wide *wide, const struct eng_wide_tree *tree,
                       uint16_t *marks)
{
    for (uint32_t level = 1; level < wide->level_count; level++) {
        const uint16_t *below = marks + tree->first[level - 1];
        uint16_t *above = marks + tree->first[level];
        for (uint32_t i = 0; i < tree->block_count[level - 1]; i++) {
            above[i / ENG_WIDE] |= (uint16_t)((below[i] != 0) << i % ENG_WIDE);
        }
    }
}

/* Mark the features of a tree of which `is` says so, and the nodes above them. */
static void mark(const struct eng_wide *wide, const struct eng_scene *scene,
                 enum pccd_tree kind, uint16_t *marks,
                 bool (*is)(const struct eng_mesh *mesh, enum pccd_tree kind,
                            uint32_t feature))
{
    const struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t top = wide->level_count - 1;
    memset(marks, 0, (tree->first[top] + tree->block_count[top]) * sizeof *marks);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct eng_object *object = &scene->objects[wide->items[i].id];
        const struct eng_wide_order *order = eng_wide_order_of(object);
        uint32_t slot = eng_wide_object_of(object)->first[kind];
        for (uint32_t k = 0; k < order->count[kind]; k++, slot++) {
            uint32_t feature = order->feature[kind][k];
            bool is_marked =
                feature != ENG_WIDE_NO_FEATURE && is(object->mesh, kind, feature);
            marks[slot / ENG_WIDE] |= (uint16_t)(is_marked << slot % ENG_WIDE);
        }
    }
    mark_above(wide, tree, marks);
}

static bool is_own(const struct eng_mesh *mesh, enum pccd_tree kind, uint32_t feature)
{
    return !eng_mesh_is_foreign(mesh, kind, feature);
}

static void put_together(struct eng_wide *wide, const struct eng_scene *scene,
                         const uint32_t slots[ENG_WIDE_TREES])
{
    wide->feature_count = 0;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t end = 0;
        tree->slot_count = slots[kind];
        count_blocks(tree->slot_count, wide->level_count, tree);
        fill_levels_up(wide, tree, false);
        for (uint32_t i = 0; i < scene->object_count; i++) {
            const struct eng_object *object = &scene->objects[wide->items[i].id];
            uint32_t count = eng_wide_order_of(object)->count[kind];
            uint32_t first = eng_wide_first_slot(end, count);
            clear(wide, kind, end, first);
            fill(wide, scene, wide->items[i].id, kind, first);
            eng_wide_object_of(object)->first[kind] = first;
            wide->feature_count += count;
            end = first + count;
        }
        clear(wide, kind, end, tree->slot_count);
        if (tree->has_free) {
            mark(wide, scene, kind, tree->free, eng_mesh_is_free);
        }
        if (tree->has_own) {
            mark(wide, scene, kind, tree->own, is_own);
        }
    }
    if (!fits(lay_out_floats(wide, NULL), wide->float_bytes)) {
        drop_floats(wide);
    }
}

static void add_vertices(struct eng_wide_chunk_state *chunk, uint32_t vertices)
{
    if (chunk->vertex_chunks > ENG_WIDE_CHUNK_VERTICES) {
        return; /* more than are listed, already */
    }
    for (uint32_t i = 0; i < chunk->vertex_chunks; i++) {
        if (chunk->vertices[i] == vertices) {
            return;
        }
    }
    if (chunk->vertex_chunks < ENG_WIDE_CHUNK_VERTICES) {
        chunk->vertices[chunk->vertex_chunks] = vertices;
    }
    chunk->vertex_chunks++;
}

/* Find the chunks of vertices of a chunk of edges or faces. Neighbours are near, so that
 * most corners are in the same as those of the feature before. */
static inline __attribute__((always_inline)) void
list_chunks(const struct eng_wide_tree *tree, enum pccd_tree kind, uint32_t i)
{
    struct eng_wide_chunk_state *chunk = &tree->chunks[i];
    const uint32_t begin = i * ENG_WIDE_CHUNK_SLOTS;
    const uint32_t left = tree->slot_count - begin;
    const uint32_t end =
        begin + (left < ENG_WIDE_CHUNK_SLOTS ? left : ENG_WIDE_CHUNK_SLOTS);
    const uint32_t *corner[3] = {tree->corner[0], tree->corner[1], tree->corner[2]};
    uint32_t last[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
    chunk->vertex_chunks = 0;
    for (uint32_t slot = begin; slot < end; slot++) {
#pragma GCC unroll 3
        for (uint32_t k = 0; k < corner_count(kind); k++) {
            uint32_t vertices = corner[k][slot] / ENG_WIDE_CHUNK_SLOTS;
            if (vertices != last[k]) {
                add_vertices(chunk, vertices);
                last[k] = vertices;
            }
        }
    }
}

/* Clear the marks of what moves (wide.h). */
static void clear_marks(struct eng_wide *wide)
{
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t top = wide->level_count - 1;
        memset(tree->moving, 0,
               (tree->first[top] + tree->block_count[top]) * sizeof *tree->moving);
        for (uint32_t i = 0; i < eng_wide_chunks(tree->slot_count); i++) {
            tree->chunks[i].state = 0;
        }
    }
    wide->marks_of = 0;
}

int eng_wide_assemble(struct eng_wide *wide, const struct eng_scene *scene)
{
    int status = order_objects(wide, scene);
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t slots[ENG_WIDE_TREES];
    uint32_t level_count = 1;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint64_t count = count_slots(wide, scene, kind);
        if (count > UINT32_MAX - ENG_WIDE) {
            return PCCD_E_NOMEM;
        }
        slots[kind] = round_up(count, ENG_WIDE);
        while ((uint64_t)ENG_WIDE << (level_count - 1) * ENG_WIDE_BITS < slots[kind]) {
            level_count++;
        }
    }
    const struct marked marked = marked_of(scene);
    status = reserve(&wide->arrays, &wide->array_bytes,
                     lay_out(wide, NULL, scene, &marked, slots, level_count));
    if (status == PCCD_OK) {
        lay_out(wide, wide->arrays, scene, &marked, slots, level_count);
        wide->level_count = level_count;
        wide->assembled++;
        put_together(wide, scene, slots);
        const struct eng_wide_tree *edges = &wide->trees[PCCD_TREE_EDGES];
        for (uint32_t i = 0; i < eng_wide_chunks(edges->slot_count); i++) {
            list_chunks(edges, PCCD_TREE_EDGES, i);
        }
        const struct eng_wide_tree *faces = &wide->trees[PCCD_TREE_FACES];
        for (uint32_t i = 0; i < eng_wide_chunks(faces->slot_count); i++) {
            list_chunks(faces, PCCD_TREE_FACES, i);
        }
        clear_marks(wide);
        wide->is_stale = false;
        wide->boxes_are_old = true;
    }
    return status;
}

/* ---- what is free ------------------------------------------------------------------ */

uint32_t eng_wide_asked_kinds(const struct eng_wide *wide, bool thick)
{
    bool points = wide->trees[PCCD_TREE_VERTICES].has_free;
    bool edges = wide->trees[PCCD_TREE_EDGES].has_free;
    uint32_t kinds = 1u << PCCD_VF | 1u << PCCD_EE;
    kinds |= thick && points && edges ? 1u << PCCD_VE : 0;
    kinds |= thick && points ? 1u << PCCD_VV : 0;
    return kinds;
}

/* Return whether child (or slot) i of a tree's level is free, or has below it what is. */
static bool is_free(const struct eng_wide_tree *tree, uint32_t level, uint32_t i)
{
    return (uint32_t)tree->free[tree->first[level] + i / ENG_WIDE] >> i % ENG_WIDE & 1u;
}

uint32_t eng_wide_free_keep(const struct eng_wide *wide, enum pccd_kind kind,
                            uint32_t level, uint32_t *a, uint32_t *b, uint32_t count)
{
    const struct eng_wide_tree *tree_a = &wide->trees[eng_wide_tree_of(kind, 0)];
    const struct eng_wide_tree *tree_b = &wide->trees[eng_wide_tree_of(kind, 1)];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        a[kept] = a[i];
        b[kept] = b[i];
        kept += is_free(tree_a, level, a[i]) && is_free(tree_b, level, b[i]);
    }
    return kept;
}
