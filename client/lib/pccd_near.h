/* pccd_near.h - how near things are at one moment: distances, closest features,
 * crossings, depth.
 *
 * Room:     client/lib; installed. May include: pccd_types.h. Compiles as C++.
 * Does:     ask of a scene at the beginning or at the end of its last step, or of where
 *           this very request moves it. Distances are decided exactly, on the resident
 *           hierarchies; a distance of exactly `distance` is within it.
 * Threads:  as pccd.h, which includes this header.
 *
 *     struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
 *     settings.what = PCCD_NEAR_PAIRS;
 *     settings.distance = 0.01;
 *     struct pccd_answer answer = PCCD_ANSWER_INIT;
 *     pccd_ask_near(client, scene, NULL, 0, &settings, &answer);
 *     use(answer.near, answer.count);
 *     pccd_answer_release(client, &answer);
 */
#ifndef PCCD_NEAR_H
#define PCCD_NEAR_H

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
                        apart than that have no record; INFINITY: all have. CROSSINGS,
                        DEPTH: not looked at */
    double gap;      /* NEAREST: the pair may be another one if it is farther by at most
                        that, and the answer has no hash; 0: it is the nearest */
    uint32_t end;    /* 1 (the default): where the last step ended; 0: where it began.
                        Before the first step both are the registered positions; below */
    uint32_t object_a, object_b; /* NEAREST, DEPTH: these two objects, or one with all
                        others; VERTICES: object_a alone; 0: all */
    uint32_t threads;
    uint64_t deadline_ns; /* as of steps */
    enum pccd_method method;
    char tuning[PCCD_TUNING_BYTES];
};

#define PCCD_NEAR_SETTINGS_INIT                                                          \
    {                                                                                    \
        .struct_bytes = sizeof(struct pccd_near_settings), .end = 1                      \
    }

/* Ask. With motions the scene moves first, as by a step whose contacts nobody looks for.
 * It waits for the steps that were submitted before it; held frames stay held. The answer
 * comes by pccd_poll or pccd_wait, in struct pccd_answer:
 *
 *     near      [count] records, but for VERTICES: vertex_bounds[count], doubles, those
 *               of all objects by increasing handle, each in the order of its mesh
 *     counts    by enum pccd_kind and enum pccd_near_kind
 *     distance_min, distance_max
 *               the least d_lo and the greatest d_hi of the records; of no records 2e18
 *               and 0. DEPTH: the greatest is how deep one mesh is in the other
 *     crossings DEPTH, CROSSINGS: edges that pass through faces
 *     verdict   CROSSINGS: NO: nothing crosses or touches: the state is free of
 *               intersections; YES: something does. Others: NONE
 *
 * Where the last step began (`end` 0) is not always known. A step or a question that
 * fails while its positions are read, as by E_NOTFINITE, moves nothing; but the objects
 * that it named count as if they had stood still: at both ends they are where they are.
 * After the daemon has crashed, and this client has told another one where everything
 * is, `end` 0 without motions is E_STATE until something moves again.
 *
 * Its pages are read by pccd_fetch, with its number, until the scene's next request about
 * what is near; the answer of the last step stays beside it. DEPTH of a mesh that is not
 * closed is E_INVAL, and pccd_error_text names an edge that shows it. */
int pccd_submit_near(struct pccd_client *client, uint32_t scene,
                     const struct pccd_motion *motions, uint32_t motion_count,
                     const struct pccd_near_settings *settings, uint64_t *step);
/* Publish a frame that was begun by pccd_frame_begin, and ask where it leads to. */
int pccd_frame_commit_near(struct pccd_frame *frame,
                           const struct pccd_near_settings *settings, uint64_t *step);
/* pccd_submit_near and wait in one; like pccd_step. */
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
