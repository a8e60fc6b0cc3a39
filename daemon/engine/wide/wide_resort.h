/* wide_resort.h - finds a better order for the features of a scene after they have moved,
 * bit by bit over several steps.
 *
 * The parts of an order, one for each tree of each object, are sorted one after the
 * other, from where the features are in the step at hand (wide_order.h says how). Where
 * neighbours stay neighbours, it does not matter that these positions are some steps old.
 * Where layers slide along each other it does: in a cloth that turns, a new order asks
 * for half the box tests of the order at rest, and seven steps later, while the sort
 * still goes on, for as many. So the old order is kept until a step has shown what the
 * new one costs, and restored if that is more. After that no sort is wanted until steps
 * ask for twice as many tests.
 *
 *   idle -> wanted -> sorting -> sorted -> (taken) tried -> idle
 *                                                        -> refused -> (taken back) idle
 */
#ifndef ENG_WIDE_RESORT_H
#define ENG_WIDE_RESORT_H

#include <stddef.h>

#include "question.h"
#include "wide_order.h"

struct eng_scene;
struct eng_stop;

enum eng_wide_resort_state {
    ENG_WIDE_IDLE,
    ENG_WIDE_WANTED, /* the next step makes room for it */
    ENG_WIDE_SORTING,
    ENG_WIDE_SORTED, /* the next step takes it */
    ENG_WIDE_TRIED,  /* taken; `items` have the order before */
    ENG_WIDE_REFUSED /* the next step takes that back */
};

struct eng_wide_resort {
    enum eng_wide_resort_state state;
    /* Box tests of the cheapest step since the last sort, by mode; 0: none yet. */
    uint64_t least_tests[PCCD_MODE_COUNT];
    /* Of the last step in each mode, with the order before the one that is tried. */
    uint64_t last_tests[PCCD_MODE_COUNT];
    uint64_t refused_tests[PCCD_MODE_COUNT]; /* of the order that was taken back to */
    /* Of the last step that searched the whole scene; and how many box tests a moving
     * vertex took in the first step after it that left out what stands, or 0. */
    uint64_t whole_tests[PCCD_MODE_COUNT];
    double tests_each[PCCD_MODE_COUNT];
    uint64_t budget_ns; /* of a step's share */
    uint64_t sorts;     /* taken in this step, with their triangles */
    uint64_t sorted_triangles;
    /* While sorting: slots of all objects, object by object, tree by tree. */
    struct eng_split_item *items; /* [item_count] */
    size_t item_count;
    struct eng_split_item *pieces; /* [piece_capacity] of the object at hand, .. */
    uint32_t *next; /* [piece_capacity] .. and the slot of each one's next feature */
    uint32_t piece_capacity;
    struct eng_box_frame frame; /* of that object when it was begun */
    uint32_t object;            /* the part at hand: its object's index, .. */
    enum pccd_tree kind;
    size_t first;      /* .. and its first item */
    uint32_t summed;   /* vertices whose places are in those of the pieces, .. */
    bool is_sequenced; /* .. all, and the pieces are in order */
    uint32_t sources;  /* edges or triangles whose features are listed */
    uint32_t sorted;   /* pieces that are, or are with `sorter`: of all features listed */
    uint32_t slot;     /* behind them */
    struct eng_wide_sorter sorter;
};

void eng_wide_resort_init(struct eng_wide_resort *resort);
void eng_wide_resort_deinit(struct eng_wide_resort *resort);
uint64_t eng_wide_resort_bytes(const struct eng_wide_resort *resort);

/* Forget, before a step, what was begun if objects have come or gone since; else take
 * what is sorted, after which the trees are stale; make room for what is wanted. Without
 * memory nothing is sorted. [compute] */
void eng_wide_resort_prepare(struct eng_wide_resort *resort, struct eng_scene *scene);

/* Do a share of the work, after the refit; it ends early once the step is to stop. By one
 * thread; it writes nothing that others read. [team] */
void eng_wide_resort_share(struct eng_wide_resort *resort, const struct eng_scene *scene,
                           const struct eng_stop *stop);

/* Forget what steps took, as more, or less, may meet from now on: it says nothing of the
 * order any more. [compute] */
void eng_wide_resort_unlearn(struct eng_wide_resort *resort);

/* Return the box tests that a whole step would have done where one that leaves out what
 * stands did `box_tests`, with `moving` vertices, >= 1, of `all`: as many as the last
 * whole one, and more as far as what moves takes more. 0: there was none. [compute] */
uint64_t eng_wide_resort_whole(struct eng_wide_resort *resort, enum pccd_mode mode,
                               uint64_t box_tests, uint64_t moving, uint64_t all);

/* Learn what a whole step took, and whether that asks for a sort. [compute] */
void eng_wide_resort_learn(struct eng_wide_resort *resort, enum pccd_mode mode,
                           uint64_t box_tests, uint64_t step_ns);

#endif
