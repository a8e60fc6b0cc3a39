/* wide_still.c - marks of what moves in the wide trees. */
#include "wide.h"

#include <assert.h>
#include <string.h>

#include "moving.h"

/* Flags of a chunk. */
#define LOOK 1u /* marks of its features are still to be made */
#define SET  2u /* some are made */

/* ---- before the refit -------------------------------------------------------------- */

/* All slots first .. first + count - 1, which are an object's. */
static void mark_all(struct eng_wide_tree *tree, uint32_t first, uint32_t count)
{
    if (count == 0) {
        return;
    }
    uint32_t blocks = (count + ENG_WIDE - 1) / ENG_WIDE;
    assert(first % ENG_WIDE == 0);
    memset(tree->moving + first / ENG_WIDE, 0xff, blocks * sizeof *tree->moving);
    for (uint32_t i = first / ENG_WIDE_CHUNK_SLOTS;
         i <= (first + count - 1) / ENG_WIDE_CHUNK_SLOTS; i++) {
        tree->chunks[i].state |= SET;
    }
}

/* The vertices of an object of which some move. */
static void mark_some(struct eng_wide *wide, const struct eng_scene *scene,
                      const struct eng_object *object)
{
    struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_VERTICES];
    const unsigned char *moves = scene->moving.moves + object->vertices.first;
    const uint32_t *slot_of = wide->slot_of + object->vertices.first;
    uint32_t end = object->marked.end;
    for (uint32_t i = object->marked.first; i < end; i++) {
        uint64_t eight = 1;
        if (i + 8 <= end) {
            memcpy(&eight, moves + i, sizeof eight);
        }
        if (eight == 0) {
            i += 7;
        } else if (moves[i] != 0 && slot_of[i] != ENG_WIDE_NO_SLOT) {
            uint32_t slot = slot_of[i];
            tree->moving[slot / ENG_WIDE] |= (uint16_t)(1u << slot % ENG_WIDE);
            tree->chunks[slot / ENG_WIDE_CHUNK_SLOTS].state |= SET;
        }
    }
}

static bool has_moving_vertices(const struct eng_wide *wide,
                                const struct eng_wide_chunk_state *chunk)
{
    const struct eng_wide_chunk_state *vertices = wide->trees[PCCD_TREE_VERTICES].chunks;
    if (chunk->vertex_chunks > ENG_WIDE_CHUNK_VERTICES) {
        return true;
    }
    for (uint32_t i = 0; i < chunk->vertex_chunks; i++) {
        if (vertices[chunk->vertices[i]].state != 0) {
            return true;
        }
    }
    return false;
}

/* The chunks of edges or faces in slots first .. first + count - 1 that have corners
 * where some vertices move. */
static void look_for(struct eng_wide *wide, enum pccd_tree kind, uint32_t first,
                     uint32_t count)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    for (uint32_t i = first / ENG_WIDE_CHUNK_SLOTS;
         count > 0 && i <= (first + count - 1) / ENG_WIDE_CHUNK_SLOTS; i++) {
        if (!(tree->chunks[i].state & LOOK) &&
            has_moving_vertices(wide, &tree->chunks[i])) {
            tree->chunks[i].state |= LOOK;
        }
    }
}

static void mark_object(struct eng_wide *wide, const struct eng_scene *scene,
                        const struct eng_object *object)
{
    const struct eng_wide_order *order = eng_wide_order_of(object);
    bool moves_all = object->moves == ENG_MOVES_ALL;
    if (!moves_all) {
        mark_some(wide, scene, object);
    }
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        uint32_t first = eng_wide_object_of(object)->first[kind];
        if (moves_all) {
            mark_all(&wide->trees[kind], first, order->count[kind]);
        } else if (kind != PCCD_TREE_VERTICES) {
            look_for(wide, kind, first, order->count[kind]);
        }
    }
}

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Blocks of a chunk, but for those of its nodes. */
static uint32_t blocks_of_chunk(const struct eng_wide_tree *tree, uint32_t chunk)
{
    return smaller(ENG_WIDE_CHUNK_BLOCKS,
                   tree->block_count[0] - chunk * ENG_WIDE_CHUNK_BLOCKS);
}

/* Those of the last motion: few chunks have any. */
static void clear_marks(struct eng_wide *wide)
{
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t top = wide->level_count - 1;
        for (uint32_t i = 0; i < eng_wide_chunks(tree->slot_count); i++) {
            if (tree->chunks[i].state != 0) {
                memset(tree->moving + i * ENG_WIDE_CHUNK_BLOCKS, 0,
                       blocks_of_chunk(tree, i) * sizeof *tree->moving);
                tree->chunks[i].state = 0;
            }
        }
        if (top > 0) {
            memset(tree->moving + tree->first[1], 0,
                   (tree->first[top] + tree->block_count[top] - tree->first[1]) *
                       sizeof *tree->moving);
        }
    }
}

/* Once for each motion. */
static void mark_motion(struct eng_wide *wide, const struct eng_scene *scene)
{
    if (wide->marks_of == scene->moving.number) {
        return;
    }
    if (wide->marks_of != 0) {
        clear_marks(wide);
    }
    for (uint32_t i = 0; i < scene->object_capacity && scene->moving.objects > 0; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh && object->moves != ENG_STANDS) {
            mark_object(wide, scene, object);
        }
    }
    wide->marks_of = scene->moving.number;
}

bool eng_wide_still_is_spread(struct eng_wide *wide, const struct eng_scene *scene)
{
    const struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_VERTICES];
    uint64_t blocks = 0;
    mark_motion(wide, scene);
    for (uint32_t i = 0; i < tree->block_count[0]; i++) {
        blocks += tree->moving[i] != 0;
    }
    return eng_moves_much(blocks, tree->block_count[0]);
}

void eng_wide_still_begin(struct eng_wide *wide, const struct eng_scene *scene,
                          bool keeps, bool prunes)
{
    wide->refit_of = scene->moving.number;
    wide->lacks_apart = scene->rigid.apart > 0;
    wide->keeps = keeps;
    wide->has_moving = keeps || prunes;
    if (wide->has_moving) {
        mark_motion(wide, scene);
    }
}

/* ---- in the refit ------------------------------------------------------------------ */

/* Return whether a feature moves. */
static bool slot_moves(const struct eng_wide_tree *tree, uint32_t slot)
{
    return tree->moving[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
}

/* Features move with any of their corners. */
static void mark_features(const struct eng_wide *wide, enum pccd_tree kind,
                          uint32_t first, uint32_t end)
{
    const struct eng_wide_tree *vertices = &wide->trees[PCCD_TREE_VERTICES];
    const struct eng_wide_tree *tree = &wide->trees[kind];
    const uint32_t *a = tree->corner[0];
    const uint32_t *b = tree->corner[1];
    const uint32_t *c = kind == PCCD_TREE_FACES ? tree->corner[2] : b;
    for (uint32_t block = first / ENG_WIDE; block < end / ENG_WIDE; block++) {
        uint32_t mask = 0;
        for (uint32_t k = 0; k < ENG_WIDE; k++) {
            uint32_t slot = block * ENG_WIDE + k;
            mask |=
                (uint32_t)(slot_moves(vertices, a[slot]) ||
                           slot_moves(vertices, b[slot]) || slot_moves(vertices, c[slot]))
                << k;
        }
        tree->moving[block] |= (uint16_t)mask;
    }
}

/* Marks of blocks first .. end - 1 of a level, from those of the level below. */
static void fold(const struct eng_wide_tree *tree, uint32_t level, uint32_t first,
                 uint32_t end)
{
    const uint16_t *below = tree->moving + tree->first[level - 1];
    for (uint32_t block = first; block < end; block++) {
        uint32_t mask = 0;
        for (uint32_t k = 0; k < ENG_WIDE; k++) {
            uint32_t child = block * ENG_WIDE + k;
            mask |= (uint32_t)(child < tree->block_count[level - 1] && below[child] != 0)
                    << k;
        }
        tree->moving[tree->first[level] + block] = (uint16_t)mask;
    }
}

bool eng_wide_still_mark_chunk(struct eng_wide *wide, enum pccd_tree kind, uint32_t chunk)
{
    struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t state = tree->chunks[chunk].state;
    if (state & LOOK) {
        uint32_t first = chunk * ENG_WIDE_CHUNK_SLOTS;
        mark_features(wide, kind, first,
                      smaller(first + ENG_WIDE_CHUNK_SLOTS, tree->slot_count));
    }
    if (state != 0 && wide->level_count > 1) {
        uint32_t node = chunk * ENG_WIDE_CHUNK_NODES;
        fold(tree, 1, node, smaller(node + ENG_WIDE_CHUNK_NODES, tree->block_count[1]));
    }
    return state != 0;
}

void eng_wide_still_mark_above(struct eng_wide *wide)
{
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t level = 2; level < wide->level_count; level++) {
            fold(&wide->trees[kind], level, 0, wide->trees[kind].block_count[level]);
        }
    }
}

uint64_t eng_wide_still_count(const struct eng_wide *wide, const struct eng_scene *scene)
{
    uint64_t moving = 0;
    if (!wide->keeps || scene->moving.objects == 0) {
        return wide->keeps ? wide->feature_count : 0;
    }
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        const struct eng_wide_tree *tree = &wide->trees[kind];
        for (uint32_t i = 0; i < eng_wide_chunks(tree->slot_count); i++) {
            const uint16_t *masks = tree->moving + i * ENG_WIDE_CHUNK_BLOCKS;
            uint32_t count = tree->chunks[i].state != 0 ? blocks_of_chunk(tree, i) : 0;
            for (uint32_t k = 0; k < count; k++) {
                moving += (uint64_t)__builtin_popcount(masks[k]);
            }
        }
    }
    return moving < wide->feature_count ? wide->feature_count - moving : 0;
}
