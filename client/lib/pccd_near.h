/* pccd_near.h - how near things are at one moment: distances, closest features,
 * crossings, depth.
 *
 * Ask about a scene where its last step began or ended (at x1, also if something met), or
 * at positions that the same request brings. Exact arithmetic decides each distance; a
 * pair that is exactly `distance` apart is in the answer. Of thick objects it is that of
 * their surfaces: pccd(7), THICKNESS, says what that is for each question.
 *
 * Threads: as pccd.h, which includes this header.
 *
 * All pairs of features that are at most 0.01 apart:
 *
 *     struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
 *     settings.what = PCCD_NEAR_PAIRS;
 *     settings.distance = 0.01;
 *     struct pccd_answer answer = PCCD_ANSWER_INIT;
 *     pccd_ask_near(client, scene, NULL, 0, &settings, &answer);
 *     use(answer.near, answer.count);
 *     pccd_answer_release(client, &answer);
 *
 * Between two bodies alone: set self_collision of each to false (pccd_object_set); then
 * its pairs with itself are left out, as in steps.
 *
 * How far each vertex may move: with settings.what = PCCD_NEAR_VERTICES the answer has a
 * bound for each vertex, answer.vertex_bounds[i]. If every vertex then moves straight by
 * less than half its bound, nothing meets.
 */
#ifndef PCCD_NEAR_H
#define PCCD_NEAR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

struct pccd_answer;
struct pccd_client;
struct pccd_frame;
struct pccd_motion;

struct pccd_near_settings {
    size_t struct_bytes; /* sizeof(struct pccd_near_settings); 0 reads as that */
    enum pccd_near_what what;
    double distance; /* 0 .. 1e18 (E_INVAL below or NaN, E_LIMIT beyond). PAIRS, FEATURES,
                        VERTICES: within it. NEAREST: pairs of objects that are farther
                        apart than that have no record; INFINITY: all have, 0, where
                        nothing is said, only what touches. CROSSINGS, DEPTH: not looked
                        at */
    double gap;      /* NEAREST: the search may end early, with a pair that is farther
                        than the nearest by at most that; the answer then has no hash.
                        0: the pair is the nearest */
    bool at_begin;   /* false: where the last step ended; true: where it began (which is
                        not always known, see pccd_submit_near). Before the first step
                        both are the registered positions */
    uint32_t object_a, object_b; /* NEAREST, DEPTH: these two objects, or one with all
                        others; VERTICES: object_a alone; 0: all. E_INVAL for
                        what is asked of all: PAIRS, FEATURES, CROSSINGS */
    /* These four have the meaning that they have in struct pccd_step_settings. NEAREST
     * and DEPTH are always found by the method wide. */
    uint32_t threads;
    uint64_t deadline_ns;
    enum pccd_method method;
    char tuning[PCCD_TUNING_BYTES];
    uint32_t reserved;    /* 0 */
    bool tells_crossings; /* PAIRS, FEATURES, VERTICES: count the crossings, too. They are
                             looked for by themselves, which adds half to two thirds of
                             the work (bench/peers/NEAR.md) */
    /* On which motions turn that are given with these settings, as in struct
     * pccd_step_settings: what is near is asked of one of their ends. NULL: none */
    const struct pccd_joint *joints; /* [joint_count] */
    uint32_t joint_count;            /* 0 .. 65536 */
};

#define PCCD_NEAR_SETTINGS_INIT                                                          \
    {                                                                                    \
        .struct_bytes = sizeof(struct pccd_near_settings)                                \
    }

/* Ask, and do not wait. If there are motions, the objects move first, as in a step, but
 * nobody looks for contacts. The request is computed after the steps that were submitted
 * before it; held frames stay held. Take the answer by pccd_poll or pccd_wait; *step is
 * its number there. It is in struct pccd_answer:
 *
 *     near      [count] records, of two features whose kind says which is a: of VF the
 *               vertex, so object_a may be either of the two objects; for VERTICES
 *               instead vertex_bounds[count], doubles, those of all objects by increasing
 *               handle, each in the order of its mesh
 *     counts    by enum pccd_kind and enum pccd_near_kind
 *     distance_min, distance_max
 *               the least d_lo and the greatest d_hi of the records; without records 2e18
 *               and 0. DEPTH: the greatest is how deep one mesh is in the other
 *     crossings edges that pass through faces: DEPTH, CROSSINGS, and PAIRS, FEATURES and
 *               VERTICES with tells_crossings; of an answer that is not complete those
 *               that were found. Not counted by NEAREST: its record of objects that
 *               cross is at distance 0, of kind EF unless they also touch.
 *               One closed mesh inside another crosses nothing: DEPTH tells it
 *     verdict   CROSSINGS: NO: nothing crosses or touches: the state is free of
 *               intersections; YES: something does. Others: NONE
 *
 * Where the last step began (`at_begin`) is not always known:
 * - A step or a question that fails while its positions are read, as by E_NOTFINITE,
 *   moves nothing. The objects that it named then count as if they had stood still: they
 *   began where they are.
 * - After a crash the library brings all objects to their places in a new daemon. Until
 *   something moves again, `at_begin` without motions is E_STATE.
 *
 * Further pages come by pccd_fetch, with *step, until the scene's next request about what
 * is near. The answer of the last step stays valid beside it. DEPTH of a mesh whose
 * triangles are not closed is E_INVAL, and pccd_error_text names an edge that shows it.
 * Free edges and points count, too: for PAIRS, FEATURES and VERTICES also two points,
 * or a point and an edge, that have no radius, which steps leave out; for NEAREST against
 * all that the other object has; for DEPTH by the vertices that they have inside the
 * triangles of another object. */
int pccd_submit_near(struct pccd_client *client, uint32_t scene,
                     const struct pccd_motion *motions, uint32_t motion_count,
                     const struct pccd_near_settings *settings, uint64_t *step);
/* Publish a frame that was begun by pccd_frame_begin, and ask about the positions to
 * which it moves the objects (with `at_begin`: from which). */
int pccd_frame_commit_near(struct pccd_frame *frame,
                           const struct pccd_near_settings *settings, uint64_t *step);
/* Ask as pccd_submit_near does, and wait for the answer, like pccd_step. */
int pccd_ask_near(struct pccd_client *client, uint32_t scene,
                  const struct pccd_motion *motions, uint32_t motion_count,
                  const struct pccd_near_settings *settings, struct pccd_answer *answer);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
