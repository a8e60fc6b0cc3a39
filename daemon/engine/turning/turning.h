/* turning.h - the contacts of two objects of which one turns.
 *
 *     sweep.c     pairs of features that may meet, and when
 *     straight.c  or, where it turns a little: pairs whose chords come near
 *     -> decide_turning.c     each of them
 *     -> team/worker.c    records, as the mode wants them
 *
 * Threads: [team]; what a thread has for it belongs to it alone. Two threads may be at
 * different tasks of the same two objects.
 *
 * How a step uses it. [compute], before the team starts: eng_body_tree_prepare of the
 * mesh of each object that takes part, and a struct eng_body for each: eng_body_set for
 * one that turns, eng_body_fit for any other (those of different objects may be made by
 * different threads). [team]: of each two objects that may meet (eng_masks_allows),
 * of which one turns at least, eng_turning_begin, and eng_turning_perform with
 * ENG_TURNING_ALL; or, where one pair is work for several threads, eng_turning_split once
 * and each of its tasks once, by any thread that has begun with the same pair. Each pair
 * of features is found by one task alone, so there is nothing to unite.
 */
#ifndef ENG_TURNING_H
#define ENG_TURNING_H

#include "straight.h"

/* Which of two ways to find pairs of features is taken: spans of the step, or the chords
 * of all of it. Either finds all that meet. */
enum eng_turning_way { ENG_TURNING_BY_SPANS, ENG_TURNING_BY_BEND, ENG_TURNING_BY_CHORDS };

/* The most that points of a body that turns leave their chords in the step, and go. */
struct eng_turning_bend {
    double bow;
    double way;
};

/* The default of `resolution`, as a part of the size of the larger of two objects. */
#define ENG_TURNING_RESOLUTION 0x1p-20

/* Two objects, as they are tested against each other. */
struct eng_turning_objects {
    struct eng_turning_side side[2]; /* at least one turns; their order does not matter */
    const struct pccd_joint *joints; /* of the step */
    double separation;               /* of the step */
    double clearance; /* in the place of the radii of the two; negative: there is none */
    /* What is not decided at this length is possible (delta of decide.h): that of the
     * question, 0 .. 1e18; 0: the default. Less than rounding leaves a meaning is raised
     * to that. */
    double resolution;
    uint64_t tests_most; /* of boxes, by a task; 0: the default. Fewer are for tests */
    bool finds_all;      /* mode all */
    /* Chords: nothing is thick. BY_BEND: these, if eng_turning_bends_little; both turn,
     * or stand. */
    enum eng_turning_way way;
};

/* A task: the nodes of both sides whose leaves are tested against each other. */
#define ENG_TURNING_ALL 0u

/* The state of a thread. */
struct eng_turning;

/* Make one. PCCD_E_NOMEM. */
int eng_turning_make(struct eng_turning **turning);
void eng_turning_free(struct eng_turning *turning); /* NULL is allowed */
uint64_t eng_turning_bytes(const struct eng_turning *turning);

/* Return how an object with such a mesh bends its way, as the path takes it. */
struct eng_turning_bend eng_turning_bend_of(const struct eng_path *path,
                                            const struct eng_mesh *mesh);

/* Return whether two objects move so little beside each other, as the way of one of them
 * is seen from the other, that chords of the whole step take less time than spans.
 * `finds_all`: in mode all they do however far one goes, as nothing ends the search. */
bool eng_turning_bends_little(const struct eng_turning_bend *bend, bool finds_all,
                              const struct eng_mesh *a, const struct eng_mesh *b);

/* Get ready for two objects, which must stay until the next. PCCD_E_LIMIT: too many
 * joints between the two. Costs about as much as a few tests of boxes. */
int eng_turning_begin(struct eng_turning *turning,
                      const struct eng_turning_objects *objects);

/* Divide the work into *count tasks, at most `most`, >= 1: 0 if the two stay apart. A
 * function of the pair and of `most`, unless the worker is to stop. PCCD_E_LIMIT,
 * PCCD_E_NOMEM: these are not all. */
int eng_turning_split(struct eng_turning *turning, struct eng_worker *worker,
                      uint32_t most, uint64_t *tasks, uint32_t *count);

/* Perform a task of the two that have begun: what meets goes to the worker by
 * eng_record_contact, as the mode of its question wants it (all, first or any): each pair
 * of features once, in any order; first and any leave out what does not matter any more.
 * Normals are those of the world. Counts candidates, tests and box tests of the worker.
 * Looks whether the worker should stop at least every 0.2 ms, and ends if so.
 * PCCD_E_LIMIT: some pairs took too many looks (decide.h), or the task too many tests of
 * boxes or spans, and some are not known; PCCD_E_NOMEM. What was found stays then.
 *
 * What is found and whether a limit is met is a function of the two objects, of the task
 * and, in mode first, of the bound of time alone, whatever the thread did before. So a
 * step must divide a pair of objects in the same way by any number of threads. A smaller
 * bound leaves out work, and changes no record that it lets through: no limit is met with
 * it that is not met with a larger one. */
int eng_turning_perform(struct eng_turning *turning, struct eng_worker *worker,
                        uint64_t task);

/* Look for what is proved to meet with so many tests of boxes and leaves, and record it.
 * Returns whether there is nothing else to be known; if not, nothing that is only
 * possible was recorded, and the two have to begin anew. For mode any, which ends at the
 * first proof; by spans. */
bool eng_turning_try(struct eng_turning *turning, struct eng_worker *worker,
                     uint64_t tests);

#endif
