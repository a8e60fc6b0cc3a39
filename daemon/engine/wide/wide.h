/* wide.h - the trees of the method `wide`: sixteen children a node, without pointers, one
 * tree each for vertices, edges and faces.
 *
 * Hold three trees over all objects of a scene. Slot i of a tree is one feature, in an
 * order in which neighbours are near. Block i of level 0 holds the boxes of slots 16 i ..
 * 16 i + 15; block i of level k those of blocks 16 i .. 16 i + 15 of level k - 1.
 *
 * Threads: [compute]; inside a step the team reads it, and writes boxes of its own.
 *
 * An object starts at a multiple of 16 slots, a large one at a multiple of 256 or more,
 * so that its groups stay together. Slots between objects are empty. All trees have the
 * same number of levels; the highest has one block.
 */
#ifndef ENG_WIDE_H
#define ENG_WIDE_H

#include <assert.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "kernel.h"
#include "kinds.h"
#include "wide_order.h"
#include "world.h"

/* 16^8 = 2^32 slots. */
#define ENG_WIDE_LEVELS_MAX 8u

#define ENG_WIDE_NOBODY  UINT64_MAX /* in eng_point.word0 */
#define ENG_WIDE_NO_SLOT UINT32_MAX /* of a vertex that no triangle has */

/* Return the tree of the features of a side, 0 or 1, of a kind of pair. */
static inline enum pccd_tree eng_wide_tree_of(enum pccd_kind kind, int side)
{
    static_assert(PCCD_TREE_VERTICES == 0 && PCCD_TREE_EDGES == 1 && PCCD_TREE_FACES == 2,
                  "a feature of one point more is of the next tree");
    return (enum pccd_tree)(common_kinds[kind].points[side] - 1);
}

/* The key of a feature: object id << 32 | local index. Records are in the order of the
 * keys. */
typedef uint64_t eng_wide_key;

/* Nodes of level 1 in a chunk of the refit, of 256 features each: 5 to 10 us of work
 * against 0.1 us to take it. */
#define ENG_WIDE_CHUNK_NODES  2u
#define ENG_WIDE_CHUNK_BLOCKS (ENG_WIDE_CHUNK_NODES * ENG_WIDE)
#define ENG_WIDE_CHUNK_SLOTS  (ENG_WIDE_CHUNK_BLOCKS * ENG_WIDE)

static inline uint32_t eng_wide_chunks(uint32_t slots)
{
    return (slots + ENG_WIDE_CHUNK_SLOTS - 1) / ENG_WIDE_CHUNK_SLOTS;
}

/* A chunk of slots that are refitted together: how far what moves in them is marked, and
 * in which chunks of vertices the corners of its features lie; more than the most that
 * are listed: in any. */
#define ENG_WIDE_CHUNK_VERTICES 6u

struct eng_wide_chunk_state {
    uint32_t state;
    uint32_t vertex_chunks;
    uint32_t vertices[ENG_WIDE_CHUNK_VERTICES];
};

struct eng_wide_tree {
    uint32_t slot_count; /* a multiple of 16, at least 16 */
    uint32_t block_count[ENG_WIDE_LEVELS_MAX];
    uint32_t first[ENG_WIDE_LEVELS_MAX]; /* block of each level */
    /* The blocks of all levels, one behind the other, and the boxes around them: in whole
     * numbers; and in floats, once a step has asked for these
     * (eng_wide_reserve_floats). */
    struct eng_quantised_block *quantised;
    struct eng_quantised_box *quantised_boxes;
    struct eng_wide_block *floats;
    struct eng_extents *float_boxes;
    uint32_t *corner[3];           /* edges 2, faces 3: [slot_count], vertex slots */
    /* Edges and faces: the two halves of their keys, that of the object by block; and
     * where has_own, so that joins may ask for them, the keys. */
    uint32_t *index;               /* [slot_count] */
    uint32_t *object_id;           /* [slot_count / 16] */
    eng_wide_key *keys;            /* [slot_count] */
    uint16_t *moving;              /* by block: bit k, child k moves */
    uint16_t *free, *own;          /* bits of what is free, of what is not foreign */
    bool has_free, has_own;        /* else these are not there; faces have none */
    struct eng_wide_chunk_state *chunks; /* [eng_wide_chunks(slot_count)] */
};

struct eng_wide {
    /* All arrays but `items`, one behind the other in a block: that is what large pages
     * are for. Those of floats are in a block of their own. */
    unsigned char *arrays, *float_arrays;
    uint64_t array_bytes, float_bytes;
    const struct eng_kernels *kernels; /* of refit and traversal; the step's */
    struct eng_wide_tree trees[ENG_WIDE_TREES];
    uint32_t level_count; /* of each tree */
    uint32_t assembled;   /* how often they were put together; goes round */
    /* Vertices, by slot: word0 is its object's index << 32 | its own in the scene's
     * arrays, or ENG_WIDE_NOBODY; word1 its key. */
    struct eng_point *points;
    struct eng_extents *point_boxes; /* with floats alone */
    struct eng_mark *marks;          /* of the vertices, on the grid */
    struct eng_grid grid; /* scale 0: there is none */
    /* A vertex is beyond the grid. Set by any thread of the refit, read after it: what
     * ends the refit orders the two. */
    atomic_bool left_grid;
    /* The boxes of features in whole numbers, instead of floats, in a step that this
     * fits. Its vertices are within their reach: that is known before. */
    struct eng_quantising quantising;
    bool has_quantised;
    atomic_uint farthest; /* the most that one of their numbers grows by; as left_grid */
    /* The refit makes each box around both ends, so that the same traversal finds the
     * pairs of plain swept boxes: to compare with other libraries. No step does so. */
    bool is_swept;
    bool boxes_are_old; /* not made since the trees were put together */
    bool lacks_apart; /* the last refit made none for what turns: it is nowhere */
    struct eng_extents around; /* all vertices: of the last refit */
    uint64_t boxes_of;  /* moving.number of the step that they are of; 0: of none */
    uint64_t refit_of;  /* .. that they will be of */
    bool keeps;         /* the refit leaves the boxes of what stands as they are */
    bool has_moving;    /* what moves is marked */
    uint64_t marks_of;  /* moving.number that the marks are of; 0: there are none */
    uint64_t feature_count;
    uint64_t frames;    /* of the last step: as in the scene */
    uint64_t thickness; /* its number in the last step */
    double frame_scale;
    uint32_t *slot_of; /* of vertices in the scene's arrays, or ENG_WIDE_NO_SLOT */
    struct eng_split_item *items; /* [item_capacity] the objects in their order */
    uint32_t item_capacity;
    /* Steps, by kind of pair, that do not look at the times of nodes: it did not pay. */
    uint32_t steps_without_times[PCCD_KIND_COUNT];
    bool is_stale; /* objects came or went, or have a new order, since it was made */
};

/* Pairs of nodes of one level that wait. */
struct eng_wide_list {
    uint32_t count;
    uint32_t a[ENG_JOIN_MAX];
    uint32_t b[ENG_JOIN_MAX];
};

/* Return the trees of a scene, which begin what is in its slot (wide_state.h). */
static inline struct eng_wide *eng_wide_of(const struct eng_scene *scene)
{
    return scene->slots[ENG_SLOT_WIDE];
}

static inline struct eng_wide_object *eng_wide_object_of(const struct eng_object *object)
{
    return object->slots[ENG_SLOT_WIDE];
}

static inline const struct eng_wide_order *
eng_wide_order_of(const struct eng_object *object)
{
    return eng_wide_object_of(object)->order;
}

void eng_wide_init(struct eng_wide *wide);
void eng_wide_deinit(struct eng_wide *wide);
uint64_t eng_wide_bytes(const struct eng_wide *wide);

/* Put the trees of all objects together, from their orders (eng_wide_order_of). Boxes are
 * not up to date afterwards. O(features); PCCD_E_NOMEM: as before, and still stale. */
int eng_wide_assemble(struct eng_wide *wide, const struct eng_scene *scene);

/* Make room for the features' boxes in floats, which are lost when the trees are put
 * together. PCCD_E_NOMEM: as before. [compute] */
int eng_wide_reserve_floats(struct eng_wide *wide);

/* Return where the slots of an object with `count` features begin, behind those up to
 * `end`. */
uint32_t eng_wide_first_slot(uint32_t end, uint32_t count);

/* Make boxes from x[1 - now] (t = 0) and x[now] (t = 1) of the scene, in parts that any
 * threads may do: all chunks 0 .. eng_wide_refit_chunks - 1 of vertices, then those of
 * edges and faces, then what is above. [team] */
uint32_t eng_wide_refit_chunks(const struct eng_wide *wide, enum pccd_tree kind);
void eng_wide_refit_chunk(struct eng_wide *wide, const struct eng_scene *scene,
                          enum pccd_tree kind, uint32_t chunk);
void eng_wide_refit_above(struct eng_wide *wide);

static inline eng_wide_key eng_wide_key_of(const struct eng_wide *wide,
                                           enum pccd_tree tree, uint32_t slot)
{
    if (tree == PCCD_TREE_VERTICES) {
        return wide->points[slot].word1;
    }
    return (uint64_t)wide->trees[tree].object_id[slot / ENG_WIDE] << 32 |
           wide->trees[tree].index[slot];
}

/* Have boxes around some blocks that are nowhere, in floats or in whole numbers. */
void eng_wide_put_nowhere(const struct eng_wide_tree *tree, uint32_t first, uint32_t end,
                          bool floats);

/* Return the blocks of a level in floats, which are there in a step that compares
 * these. */
static inline struct eng_wide_block *eng_wide_blocks(const struct eng_wide_tree *tree,
                                                     uint32_t level)
{
    return tree->floats + tree->first[level];
}

/* Return the boxes around them. */
static inline struct eng_extents *eng_wide_boxes(const struct eng_wide_tree *tree,
                                                 uint32_t level)
{
    return tree->float_boxes + tree->first[level];
}

/* ---- what is free ------------------------------------------------------------------ */

/* Points and edges that no triangle has (mesh.h) are in the trees of all others, so pairs
 * of kinds that ask for free ones alone are sifted by marks at each level. */

/* Return as bits which kinds of pairs are looked for: VF and EE; where features keep a
 * distance (`thick`) those of what is free, too, if there is any. */
uint32_t eng_wide_asked_kinds(const struct eng_wide *wide, bool thick);

/* Return whether a kind asks for free points and edges alone. */
static inline bool eng_wide_is_of_free(enum pccd_kind kind)
{
    return kind == PCCD_VE || kind == PCCD_VV;
}

/* Keep, in their order, those of the pairs a[count], b[count] of children of nodes of
 * `level`, or of slots if that is 0, of which both are free or have below them what is.
 * Returns how many. */
uint32_t eng_wide_free_keep(const struct eng_wide *wide, enum pccd_kind kind,
                            uint32_t level, uint32_t *a, uint32_t *b, uint32_t count);

/* ---- what moves -------------------------------------------------------------------- */

/* Block i of a level has a mask of 16 bits: bit k is set if something below its child
 * k moves (moving.h). So boxes of what stands are kept from the last step, and pairs
 * of nodes of which neither moves are left out. The marks of vertices are set before
 * the refit; those of edges and faces by whoever makes the boxes of a chunk, from the
 * vertices at their corners. A chunk of edges or faces knows which chunks of vertices
 * its corners lie in. Where none of these moves, nothing is looked at. */

/* Return, when the positions have moved on, whether what moves is spread so evenly that
 * too few blocks of vertices stand (eng_moves_much). [compute] */
bool eng_wide_still_is_spread(struct eng_wide *wide, const struct eng_scene *scene);

/* Get ready for the refit, when the positions have moved on: mark what moves if `keeps`
 * or `prunes`. `keeps`: boxes of the last step are those of what stands; `prunes`: marks
 * are wanted without that, too. [compute] */
void eng_wide_still_begin(struct eng_wide *wide, const struct eng_scene *scene,
                          bool keeps, bool prunes);

/* Mark which features of a chunk move, and then its nodes of level 1, before its boxes
 * are made. False: nothing in it moves. [team] */
bool eng_wide_still_mark_chunk(struct eng_wide *wide, enum pccd_tree kind,
                               uint32_t chunk);

/* Mark what moves in the levels from 2 on. [team], one thread */
void eng_wide_still_mark_above(struct eng_wide *wide);

/* Return how many features had their boxes kept. [compute] */
uint64_t eng_wide_still_count(const struct eng_wide *wide, const struct eng_scene *scene);

#endif
