/* straight.h - the contacts of two objects that go straight, each between two poses of
 * its whole mesh, or stand; or of which one turns, but hardly leaves the chords of its
 * way, and the other one may deform: found by trees that stay in the frames of the
 * meshes, but for those of what deforms.
 *
 * Go down both trees. What the two poses make of a box, along an axis, is an interval at
 * either end of the step, and whatever is within it goes straight; so an axis that keeps
 * two boxes apart at both ends keeps them apart all the time. Features of leaves that no
 * axis keeps apart go to the narrow phase with the positions that they have in the world,
 * as those do that a method has found: the records are the same. Where one turns, boxes
 * are wider by how far its points leave their chords, and features whose chords come near
 * are decided one by one.
 *
 *     straight.c     pairs of leaves that may meet, and their features
 *     -> narrow/narrow.c     each of them; or, if one turns, turning.c
 *
 * Threads: [team]; what a thread has for it belongs to it alone. Two threads may be at
 * different tasks of the same two objects.
 * Source: elementary/BOUNDS.md, "Candidates of bodies that go straight" and
 * "Candidates of bodies that turn a little".
 */
#ifndef ENG_STRAIGHT_H
#define ENG_STRAIGHT_H

#include "body_tree.h"
#include "sweep.h"
#include "worker.h"
#include "world.h"

/* An object of a pair. */
struct eng_turning_side {
    const struct eng_object *object;
    const struct eng_body *body;
    uint32_t joint; /* that it hangs on; PCCD_NO_JOINT: it does not turn */
    /* Where it goes straight by two poses: these, and the boxes of its mesh count. NULL:
     * those of the body do, where they are at either end. */
    const double (*poses)[12];
};

/* The ways of two objects of which the second turns: it is seen from the first one, and
 * `poses` of it are where it is at either end. */
struct eng_straight_chords {
    /* What stays farther apart, if it goes straight between the two poses, does not come
     * within what is looked for. */
    double reach;
    /* Take a pair that may come nearer, whose span is not known. False: no more is
     * wanted. */
    bool (*take)(void *owner, const struct eng_sweep_pair *pair);
    void *owner;
};

/* The state of a thread. */
struct eng_straight;

/* Calls, as an instruction set does them: all find the same, but a state belongs to the
 * one that made it. */
struct eng_straight_calls {
    /* Make and free a state; NULL is allowed. PCCD_E_NOMEM. */
    int (*make)(struct eng_straight **straight);
    void (*free)(struct eng_straight *straight);
    uint64_t (*bytes)(const struct eng_straight *straight);

    /* Get ready for two objects, which must stay until the end of the step. `chords`: one
     * of them turns; NULL: none does. Nothing is thick. Costs about as much as a few
     * tests. */
    void (*begin)(struct eng_straight *straight, const struct eng_turning_side side[2],
                  const struct eng_straight_chords *chords);

    /* Divide the work into at most `most` tasks, each a child of a node of either side;
     * returns how many. */
    uint32_t (*split)(struct eng_straight *straight, struct eng_worker *worker,
                      uint32_t most, uint64_t *tasks);

    /* Perform a task of the two: each pair of features is found by one task alone. Those
     * that are found wait, with others, until there are enough; of two of which one turns
     * until the end of the task. Ends when the worker is to stop, and looks whether it is
     * every 0.1 ms or so. */
    void (*perform)(struct eng_straight *straight, struct eng_worker *worker,
                    uint64_t task);

    /* Test what waits, when the thread has performed its last task of the step. */
    void (*end)(struct eng_straight *straight, struct eng_worker *worker);
};

#define ENG_STRAIGHT_ALL 0u /* a task: both trees */

#define ENG_STRAIGHT2(isa) eng_##isa##_straight
#define ENG_STRAIGHT(isa)  ENG_STRAIGHT2(isa)

/* Those of each set; of one that was not built there are none. */
extern const struct eng_straight_calls eng_scalar_straight, eng_sse2_straight,
    eng_sse4_straight, eng_avx2_straight, eng_avx512_straight, eng_neon_straight;

/* Return those of the set that is in use. */
const struct eng_straight_calls *eng_straight(void);

#endif
