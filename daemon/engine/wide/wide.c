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
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        eng_free(tree->blocks);
        eng_free(tree->quantised);
        eng_free(tree->quantised_boxes);
        eng_free(tree->floats);
        eng_free(tree->float_boxes);
        eng_free(tree->boxes);
        eng_free(tree->keys);
        eng_free(tree->moving);
        eng_free(tree->free);
        eng_free(tree->own);
        eng_free(tree->chunks);
        for (int k = 0; k < 3; k++) {
            eng_free(tree->corner[k]);
        }
    }
    eng_free(wide->points);
    eng_free(wide->point_boxes);
    eng_free(wide->marks);
    eng_free(wide->point_numbers);
    eng_free(wide->slot_of);
    eng_free(wide->items);
}

static uint32_t corner_count(enum pccd_tree kind)
{
    return kind == PCCD_TREE_FACES ? 3 : kind == PCCD_TREE_EDGES ? 2 : 0;
}

uint64_t eng_wide_bytes(const struct eng_wide *wide)
{
    uint64_t bytes =
        (uint64_t)wide->slot_of_capacity * sizeof *wide->slot_of +
        (uint64_t)wide->item_capacity * sizeof *wide->items +
        (uint64_t)wide->trees[PCCD_TREE_VERTICES].slot_capacity *
            (sizeof *wide->points + sizeof *wide->marks + sizeof *wide->point_numbers) +
        (uint64_t)wide->point_box_capacity * sizeof *wide->point_boxes;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        const struct eng_wide_tree *tree = &wide->trees[kind];
        bytes += (uint64_t)tree->above_capacity *
                     (sizeof *tree->blocks + sizeof *tree->boxes) +
                 (uint64_t)tree->float_capacity *
                     (sizeof *tree->floats + sizeof *tree->float_boxes) +
                 (uint64_t)tree->leaf_capacity *
                     (sizeof *tree->quantised + sizeof *tree->quantised_boxes) +
                 (uint64_t)tree->moving_capacity * sizeof *tree->moving +
                 (uint64_t)tree->free_capacity * sizeof *tree->free +
                 (uint64_t)tree->own_capacity * sizeof *tree->own +
                 (uint64_t)tree->chunk_capacity * sizeof *tree->chunks;
        if (kind != PCCD_TREE_VERTICES) {
            bytes += (uint64_t)tree->slot_capacity *
                     (corner_count(kind) * sizeof *tree->corner[0] + sizeof *tree->keys);
        }
    }
    return bytes;
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

/* Return whether an array of that capacity has room, and not by far too much. Large ones
 * are not kept for what went away: a rank whose part of a scene shrinks needs its memory
 * elsewhere. */
#define SLOTS_KEPT (1u << 15)
static bool fits(uint32_t count, uint32_t capacity, uint32_t kept_anyway)
{
    return count <= capacity && (capacity <= kept_anyway || count >= capacity / 2);
}

/* Instead of one that does not fit. Of less, no array has less from now on, whichever of
 * them can be made smaller. */
static uint32_t other_capacity(uint32_t *capacity, uint32_t count, uint32_t multiple)
{
    if (count > *capacity) {
        return round_up(eng_array_grown(*capacity, count), multiple);
    }
    *capacity = round_up(count, multiple);
    return *capacity;
}

static int reserve_slots(struct eng_wide *wide, enum pccd_tree kind, uint32_t count)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    if (fits(count, tree->slot_capacity, SLOTS_KEPT)) {
        return PCCD_OK;
    }
    uint32_t capacity = other_capacity(&tree->slot_capacity, count, ENG_WIDE);
    int status = PCCD_OK;
    if (kind == PCCD_TREE_VERTICES) {
        status = eng_array_grow(&wide->points, capacity, sizeof *wide->points);
        if (status == PCCD_OK) {
            status = eng_array_grow(&wide->marks, capacity, sizeof *wide->marks);
        }
        if (status == PCCD_OK) {
            status = eng_array_grow(&wide->point_numbers, capacity,
                                    sizeof *wide->point_numbers);
        }
    } else {
        status = eng_array_grow(&tree->keys, capacity, sizeof *tree->keys);
    }
    for (uint32_t k = 0; k < corner_count(kind) && status == PCCD_OK; k++) {
        status = eng_array_grow(&tree->corner[k], capacity, sizeof *tree->corner[k]);
    }
    tree->slot_capacity = status == PCCD_OK ? capacity : tree->slot_capacity;
    return status;
}

#define BLOCKS_KEPT (SLOTS_KEPT / ENG_WIDE)

static int reserve_leaves(struct eng_wide_tree *tree, uint32_t count)
{
    if (fits(count, tree->leaf_capacity, BLOCKS_KEPT)) {
        return PCCD_OK;
    }
    uint32_t capacity = other_capacity(&tree->leaf_capacity, count, 1);
    int status = eng_array_grow(&tree->quantised, capacity, sizeof *tree->quantised);
    if (status == PCCD_OK) {
        status = eng_array_grow(&tree->quantised_boxes, capacity,
                                sizeof *tree->quantised_boxes);
    }
    tree->leaf_capacity = status == PCCD_OK ? capacity : tree->leaf_capacity;
    return status;
}

static int reserve_above(struct eng_wide_tree *tree, uint32_t count)
{
    if (fits(count, tree->above_capacity, BLOCKS_KEPT)) {
        return PCCD_OK;
    }
    uint32_t capacity = other_capacity(&tree->above_capacity, count, 1);
    int status = eng_array_grow(&tree->blocks, capacity, sizeof *tree->blocks);
    if (status == PCCD_OK) {
        status = eng_array_grow(&tree->boxes, capacity, sizeof *tree->boxes);
    }
    tree->above_capacity = status == PCCD_OK ? capacity : tree->above_capacity;
    return status;
}

static void set_nowhere(struct eng_extents *boxes, uint32_t count)
{
    float *bound = &boxes[0].side[0][0];
    for (size_t i = 0; i < (size_t)count * sizeof *boxes / sizeof *bound; i++) {
        bound[i] = ENG_NOWHERE;
    }
}

/* Floats are made anew, so they are lost where there is no room for them. */
static void drop_floats(struct eng_wide *wide)
{
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        eng_free(tree->floats);
        eng_free(tree->float_boxes);
        tree->floats = NULL;
        tree->float_boxes = NULL;
        tree->float_capacity = 0;
    }
    eng_free(wide->point_boxes);
    wide->point_boxes = NULL;
    wide->point_box_capacity = 0;
}

static bool has_room(const struct eng_wide *wide)
{
    bool has = wide->trees[PCCD_TREE_VERTICES].slot_count <= wide->point_box_capacity;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        const struct eng_wide_tree *tree = &wide->trees[kind];
        has &= round_up(tree->block_count[0], ENG_WIDE) <= tree->float_capacity;
    }
    return has;
}

static bool make_room(struct eng_wide *wide)
{
    uint32_t slots = wide->trees[PCCD_TREE_VERTICES].slot_count;
    wide->point_boxes = eng_alloc(slots, sizeof *wide->point_boxes);
    wide->point_box_capacity = wide->point_boxes ? slots : 0;
    bool has_all = wide->point_boxes != NULL;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES && has_all; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t blocks = round_up(tree->block_count[0], ENG_WIDE);
        tree->floats = eng_alloc(blocks, sizeof *tree->floats);
        tree->float_boxes = eng_alloc(blocks, sizeof *tree->float_boxes);
        has_all = tree->floats && tree->float_boxes;
        tree->float_capacity = blocks;
    }
    return has_all;
}

int eng_wide_reserve_floats(struct eng_wide *wide)
{
    if (!has_room(wide)) {
        drop_floats(wide);
        if (!make_room(wide)) {
            drop_floats(wide);
            return PCCD_E_NOMEM;
        }
    }
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        const struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t blocks = tree->block_count[0]; /* a node of level 1 has sixteen */
        set_nowhere(tree->float_boxes + blocks, round_up(blocks, ENG_WIDE) - blocks);
    }
    return PCCD_OK;
}

/* Room to mark what moves (wide.h), and whatever else, of `count` blocks. */
static int reserve_moving(struct eng_wide_tree *tree, uint32_t count)
{
    if (!fits(count, tree->block_capacity, BLOCKS_KEPT)) {
        tree->block_capacity = other_capacity(&tree->block_capacity, count, 1);
    }
    int status = eng_array_fit(&tree->moving, &tree->moving_capacity,
                               tree->block_capacity, sizeof *tree->moving);
    return status == PCCD_OK
               ? eng_array_fit(&tree->chunks, &tree->chunk_capacity,
                               eng_wide_chunks(tree->slot_capacity), sizeof *tree->chunks)
               : status;
}

static uint32_t free_count(const struct eng_mesh *mesh, enum pccd_tree kind)
{
    return kind == PCCD_TREE_VERTICES ? mesh->info.free_point_count
           : kind == PCCD_TREE_EDGES  ? mesh->info.free_edge_count
                                      : 0;
}

/* Room to mark what is free, if anything is. */
static int reserve_free(struct eng_wide_tree *tree, const struct eng_scene *scene,
                        enum pccd_tree kind)
{
    bool has_free = false;
    for (uint32_t i = 0; i < scene->object_capacity && !has_free; i++) {
        has_free = scene->objects[i].mesh && free_count(scene->objects[i].mesh, kind) > 0;
    }
    int status = has_free ? eng_array_fit(&tree->free, &tree->free_capacity,
                                          tree->block_capacity, sizeof *tree->free)
                          : PCCD_OK;
    tree->has_free = status == PCCD_OK ? has_free : tree->has_free;
    return status;
}

/* Room to mark what is not foreign, if anything is. Faces are first in no pair. */
static int reserve_own(struct eng_wide *wide, const struct eng_scene *scene)
{
    bool has_foreign = false;
    for (uint32_t i = 0; i < scene->object_capacity && !has_foreign; i++) {
        has_foreign =
            scene->objects[i].mesh && eng_mesh_has_foreign(scene->objects[i].mesh);
    }
    for (enum pccd_tree kind = 0; kind < PCCD_TREE_FACES && has_foreign; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        int status = eng_array_fit(&tree->own, &tree->own_capacity, tree->block_capacity,
                                   sizeof *tree->own);
        if (status != PCCD_OK) {
            return status;
        }
    }
    for (enum pccd_tree kind = 0; kind < PCCD_TREE_FACES; kind++) {
        wide->trees[kind].has_own = has_foreign;
    }
    return PCCD_OK;
}

/* Room for everything. */
static int reserve(struct eng_wide *wide, const struct eng_scene *scene,
                   const uint32_t slots[ENG_WIDE_TREES], uint32_t level_count)
{
    int status = eng_array_fit(&wide->slot_of, &wide->slot_of_capacity,
                               scene->vertex_capacity, sizeof *wide->slot_of);
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES && status == PCCD_OK; kind++) {
        status = reserve_slots(wide, kind, slots[kind]);
        uint32_t leaves = slots[kind] / ENG_WIDE;
        uint32_t blocks = count_blocks(slots[kind], level_count, NULL);
        if (status == PCCD_OK) {
            status = reserve_leaves(&wide->trees[kind], leaves);
        }
        if (status == PCCD_OK) {
            uint32_t above = level_count > 1 ? blocks - round_up(leaves, ENG_WIDE) : 0;
            status = reserve_above(&wide->trees[kind], above);
        }
        if (status == PCCD_OK) {
            status = reserve_moving(&wide->trees[kind], blocks);
        }
        if (status == PCCD_OK) {
            status = reserve_free(&wide->trees[kind], scene, kind);
        }
    }
    return status == PCCD_OK ? reserve_own(wide, scene) : status;
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
        tree->keys[slot] = ENG_WIDE_NOBODY;
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
    const eng_wide_key key = (uint64_t)object->id << 32;
    eng_wide_key *keys = tree->keys + first;
    uint32_t *corner[3] = {tree->corner[0] + first, tree->corner[1] + first,
                           kind == PCCD_TREE_FACES ? tree->corner[2] + first : NULL};
    for (uint32_t i = 0; i < count; i++) {
        if (feature[i] == ENG_WIDE_NO_FEATURE) {
            clear(wide, kind, first + i, first + i + 1);
            continue;
        }
        const uint32_t *of = corners + (size_t)stride * feature[i];
        keys[i] = key | feature[i];
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
        uint32_t blocks = count_blocks(tree->slot_count, wide->level_count, tree);
        if (wide->level_count > 1) {
            set_nowhere(tree->boxes, blocks - tree->first[1]);
        }
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
    const struct eng_wide_tree *vertices = &wide->trees[PCCD_TREE_VERTICES];
    if (!fits(vertices->slot_count, wide->point_box_capacity, SLOTS_KEPT)) {
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
    status = reserve(wide, scene, slots, level_count);
    if (status == PCCD_OK) {
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
