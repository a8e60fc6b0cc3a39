/* method.h - what a method must provide so that a step can use it.
 *
 * Define the table of functions that differ between the methods: trees, boxes, tasks. A
 * task is a 64-bit word whose meaning belongs to the method, so that one scheduler steals
 * for both.
 */
#ifndef ENG_METHOD_H
#define ENG_METHOD_H

#include <stdbool.h>
#include <stdint.h>

#include "boxes.h"
#include "team.h"

struct eng_scene;

/* The leaves of one object in one tree, its faces, or its free edges or points, as a
 * search for what is near sees them: sixteen boxes at a time. Nodes are numbers. */
struct eng_leaves {
    const struct eng_scene *scene;
    uint32_t object; /* index */
    enum pccd_tree tree;
    uint32_t end;    /* of the step: 0 or 1 */
    uint32_t root;
    uint32_t first; /* slots of the object's features in the tree */
    uint32_t count;
};

/* The leaves below a node. */
struct eng_leaves_below {
    const float (*low)[ENG_WIDE]; /* [axis][child], outward distances (boxes.h) */
    const float (*high)[ENG_WIDE];
    uint32_t children; /* a bit for each that there is: at INFINITY is none, either */
    uint32_t leaves;   /* a bit for each of them that is a leaf */
    uint32_t child[ENG_WIDE];
    _Alignas(64) float own[2][3][ENG_WIDE]; /* room for low and high */
};

/* Below a node there are at most so many levels of opened nodes, itself included. */
#define ENG_LEAVES_LEVELS_MAX 8u

struct eng_method_calls {
    bool can_prune; /* it leaves out pairs that stand (team.h, prunes) */
    /* Return whether its trees are of other objects than the scene has now. [compute] */
    bool (*is_stale)(const struct eng_scene *scene);
    /* Do whatever can fail for want of memory: put trees together, reserve for
     * team->count threads, whose workers exist. Nothing moves. [compute] */
    int (*prepare)(struct eng_team *team, const struct eng_question *question);
    /* See how what moves is spread, when the positions have moved on, and tell the scene
     * (moving.is_spread). NULL: it does not matter. [compute] */
    void (*survey)(struct eng_scene *scene);
    /* Return whether the boxes at hand, all of them, are those of the motion by which the
     * scene has come to where it is. [compute] */
    bool (*has_boxes)(const struct eng_scene *scene);
    /* Get ready, with no thread at work yet, when the positions have moved on; or, if
     * team->has_boxes, when they have not, and boxes stay. It sets that itself where
     * nothing moves. [compute] */
    void (*start)(struct eng_team *team, const struct eng_question *question);
    /* Make all boxes, by one thread. A step that is stopped may leave some as they were:
     * then no task is done, and the next step makes them all. [compute] */
    void (*refit)(struct eng_worker *worker);
    /* Make them by all threads: true for the one that ended last, and sees every box.
     * [team] */
    bool (*refit_by_team)(struct eng_team *team, struct eng_worker *worker);
    /* Do what has to be done after the refit, while nobody traverses, by one thread.
     * [team] */
    void (*ready)(struct eng_worker *worker);
    /* Do what can be done while others traverse, by one thread. [team] */
    void (*beside)(struct eng_worker *worker);
    /* Get ready after the refit of all, before a thread's first task; and end, after its
     * last. [team] */
    void (*enter)(struct eng_worker *worker);
    void (*leave)(struct eng_worker *worker);

    /* Learn from the step, which took `step_ns` without staging, when it is over, and
     * write to its result what was swapped in. [compute] */
    void (*end)(struct eng_team *team, struct eng_step_result *result, uint64_t step_ns);

    /* Return, in test builds, whether everything is as it should be after a step. NULL:
     * it is not looked at. [compute] */
    bool (*validate)(const struct eng_scene *scene);

    /* Perform all tasks of a step by one thread. [compute] */
    void (*perform_all)(struct eng_worker *worker);
    /* Push the tasks that all others come from to the workers' deques, while the owners
     * of these wait. [team], one thread, `worker` */
    void (*deal)(struct eng_team *team, struct eng_worker *worker);
    /* Do a task, or push what it divides into to the worker's own deque. [team] */
    void (*perform)(struct eng_worker *worker, uint64_t task);

    /* The paper's dynamic assignment, in the place of deal and perform. NULL: there is
     * none, and threads steal whatever is asked for.
     *
     * Choose what each thread begins with. [team], one thread */
    void (*assign)(struct eng_team *team, struct eng_worker *worker);
    /* Perform a thread's part of all tasks, until none is left anywhere. [team] */
    void (*perform_assigned)(struct eng_team *team, struct eng_worker *worker);

    /* Describe the leaves that an object has in a tree, at an end of the step (false: it
     * has none), and what is below a node of them: after a refit, and until what the
     * scene has moves on. `wide` alone does, which all questions about two objects go to.
     * [any] */
    bool (*leaves_of)(const struct eng_scene *scene, uint32_t object_idx,
                      enum pccd_tree tree, uint32_t end, struct eng_leaves *leaves);
    void (*leaves_open)(const struct eng_leaves *leaves, uint32_t node,
                       struct eng_leaves_below *below);
    /* Return the index in its mesh of one that is a leaf: of a face, edge or vertex. */
    uint32_t (*leaves_index)(const struct eng_leaves *leaves, uint32_t node);

    /* Free, or count the bytes of, what the method keeps of a worker, in its slot of
     * worker->work. [compute] */
    void (*work_free)(struct eng_worker *worker);
    uint64_t (*work_bytes)(const struct eng_worker *worker);

    /* Test the candidates that wait in the worker's chunks, as it has no task. [team] */
    void (*flush)(struct eng_worker *worker);
};

/* The methods by number; NULL for PCCD_METHOD_DEFAULT, which is none of its own
 * (methods.c). */
extern const struct eng_method_calls *const eng_methods[PCCD_METHOD_COUNT];

/* ---- work stealing ----------------------------------------------------------------- */

/* Stealing: moments (wait.h) of a pause between two rounds over all victims, doubled from
 * 1: up to some 3 us. */
#define ENG_STEAL_RELAXES_MAX 64u

/* Do tasks of team->method, and steal them from others, until no task is left or the step
 * was stopped. `worker` is the calling thread's. [team] */
void eng_schedule_steal(struct eng_team *team, struct eng_worker *worker);

/* Hand out the first tasks: inside the region, by one thread, before any other works.
 * [team] */
void eng_schedule_steal_begin(struct eng_team *team, struct eng_worker *worker);

#endif
