/* background.h - rebuilds a large subtree bit by bit over several steps, so that no
 * single step pays for it.
 *
 * Find what is poor above the regions (rebuild.h), rebuild it over several steps, a
 * bounded share in each, and put it in place at the start of the next step. Without this
 * the frame rate drops whenever a large subtree is rebuilt, as in the paper.
 *
 * Source: paper sections 6.2 and 7.1; Ize et al. 2007 (asynchronous construction).
 *
 * A subtree is built from the positions that its triangles had when the build began, as
 * an order of its triangles that no traversal reads. They are still its triangles when
 * they are swapped in: regions change only inside, and there is one swap for each
 * subtree. Positions that are a few steps old cost a little quality and nothing else.
 *
 *   examined -> listed -> built -> swapped in        each subtree; one at a time is built
 */
#ifndef ENG_BACKGROUND_H
#define ENG_BACKGROUND_H

#include "grow.h"
#include "worker.h"

/* Subtrees found poor at a time; more are found when these are done. */
#define ENG_BACKGROUND_PARTS_MAX 64u

enum eng_background_state {
    ENG_BACKGROUND_FOUND,
    ENG_BACKGROUND_LISTED, /* all of its triangles are in `items` */
    ENG_BACKGROUND_BUILT,
    ENG_BACKGROUND_FRESH, /* in place; its metric is noted after the refit */
    ENG_BACKGROUND_GONE   /* done, or its object went away */
};

struct eng_background_part {
    enum eng_background_state state;
    uint32_t root;
    uint32_t count; /* triangles */
    uint32_t first; /* its place in `items` */
};

struct eng_background {
    struct eng_background_part parts[ENG_BACKGROUND_PARTS_MAX];
    uint32_t part_count; /* 0: nothing is being built */
    uint32_t listing;    /* the part whose triangles are being listed, .. */
    uint32_t next_node;  /* .. from this node on, .. */
    uint32_t next_item;  /* .. into this place of its own */
    uint32_t building;   /* the part being built */
    bool has_begun;      /* the grower is at work on it */
    struct eng_grower grower;
    struct eng_split_item *items; /* [capacity] */
    uint32_t capacity;            /* triangles */
    uint64_t budget_ns;           /* of a step's share */
    uint64_t swaps;               /* of this step, with their triangles */
    uint64_t swapped_triangles;
};

void eng_background_init(struct eng_background *background);
void eng_background_deinit(struct eng_background *background);
uint64_t eng_background_bytes(const struct eng_background *background);

/* Forget an object that goes away, whose nodes these are. [compute] */
void eng_background_forget(struct eng_background *background, struct eng_range nodes);

/* Put what is built in place. Before the refit. [compute] */
void eng_background_swap(struct eng_background *background, struct eng_scene *scene);

/* Note the metric of what was swapped in, look for poor subtrees, list their triangles:
 * after the refit, while nobody traverses, by one thread. Without memory nothing is
 * built. [team] */
void eng_background_examine(struct eng_background *background, struct eng_worker *worker);

/* Build for a while; others may traverse meanwhile. By one thread. [team] */
void eng_background_share(struct eng_background *background, struct eng_worker *worker);

/* Note how long the step took: the next one's share depends on it. [compute] */
void eng_background_end_step(struct eng_background *background, uint64_t step_ns,
                             uint32_t threads);

#endif
