/* numbers.h - the list of all numbers of an answer: of a step, or about what is near.
 *
 * The three forms of an answer follow it: struct eng_step_result as the engine has it,
 * the message as messages.def makes it, and struct pccd_answer of pccd.h. A number that
 * one of them lacks does not compile.
 */
#ifndef COMMON_NUMBERS_H
#define COMMON_NUMBERS_H

#include "pccd_types.h"

/* X(F, type and field of the message, its need in the answer of a step and in one about
 * what is near, member of the other two forms, meaning). Type and need are as in
 * messages.def; OPT where the other answer alone has it. Times are in nanoseconds. The
 * order is that of the message. F is handed through. */

/* The question, and how it ended. */
#define COMMON_OUTCOME(X, F)                                                             \
    X(F, u32, mode, REQ, OPT, mode, "enum pccd_mode; of a step")                         \
    X(F, u32, what, OPT, REQ, what, "enum pccd_near_what; of scene.near")                \
    X(F, u32, incomplete, REQ, REQ, incomplete, "enum pccd_incomplete; 0: complete")     \
    X(F, u32, verdict, REQ, REQ, verdict,                                                \
      "enum pccd_verdict of mode any and of what = 4; of all others: 3")

/* Records by kind, of the whole answer. */
#define COMMON_KINDS(X, F)                                                               \
    X(F, u64, vf, REQ, REQ, counts[PCCD_VF],                                             \
      "VF records of the whole answer; mode pairs: pairs; any: 0")                       \
    X(F, u64, ee, REQ, REQ, counts[PCCD_EE],                                             \
      "EE records, counted as vf")                                                       \
    X(F, u64, ve, OPT, REQ, counts[PCCD_VE],                                             \
      "VE records, counted as vf")                                                       \
    X(F, u64, vv, OPT, REQ, counts[PCCD_VV],                                             \
      "VV records, counted as vf")                                                       \
    X(F, u64, ef, OPT, REQ, counts[PCCD_EF], "EF records; only what = 3, 4 have them")

/* The numbers that the records say. */
#define COMMON_FOUND(X, F)                                                               \
    X(F, u64, possible, REQ, OPT, possible,                                              \
      "records that are not proved; modes any, pairs: 0")                                \
    X(F, u64, initial, REQ, OPT, initial,                                                \
      "records that touch at t = 0; modes any, pairs: 0")                                \
    X(F, f64, toi_first, REQ, OPT, toi_first,                                            \
      "smallest toi of the records; 2 without any, and in the "                          \
      "modes any and pairs")                                                             \
    X(F, f64, distance_min, OPT, REQ, distance_min,                                      \
      "scene.near: least d_lo of the records; 2e18 without any")                         \
    X(F, f64, distance_max, OPT, REQ, distance_max,                                      \
      "scene.near: greatest d_hi of the records; 0 without any")                         \
    X(F, u64, crossings, OPT, REQ, crossings,                                            \
      "edges that pass through faces: tells_start: at t = 0; what = 4, 5, or "           \
      "tells_crossings")                                                                 \
    X(F, u64, hash_hi, REQ, REQ, hash[0],                                                \
      "hash of all records of the answer, upper half")                                   \
    X(F, u64, hash_lo, REQ, REQ, hash[1],                                                \
      "lower half; both 0 with a gap: there is none")                                    \
    X(F, u32, threads, REQ, REQ, threads, "threads used")                                \
    X(F, u32, method, REQ, REQ, method, "enum pccd_method used")

#define COMMON_TIMES(X, F)                                                               \
    X(F, u64, ns_queue, REQ, REQ, times.queue, "from arrival to the compute thread")     \
    X(F, u64, ns_ingest, REQ, REQ, times.ingest, "copy and check of the slot")           \
    X(F, u64, ns_refit, REQ, REQ, times.refit, "refit of all boxes")                     \
    X(F, u64, ns_traversal, REQ, REQ, times.traversal, "box tests")                      \
    X(F, u64, ns_tests, REQ, REQ, times.tests, "filters and solver")                     \
    X(F, u64, ns_merge, REQ, REQ, times.merge, "sort, hash, copy to the result region")  \
    X(F, u64, ns_step, REQ, REQ, times.step,                                             \
      "the whole step, ingest to finished result")                                       \
    X(F, u64, ns_low, OPT, OPT, times.low, "of traversal and tests: low-level nodes")    \
    X(F, u64, ns_high, OPT, OPT, times.high, "of traversal and tests: high-level nodes") \
    X(F, u64, ns_rebuild, OPT, OPT, times.rebuild,                                       \
      "reconstruction, the sum over all threads")

#define COMMON_COUNTERS(X, F)                                                            \
    X(F, u64, task_units, REQ, REQ, counters.task_units, "self-CD task units processed") \
    X(F, u64, box_tests, REQ, REQ, counters.box_tests, "pairs of nodes tested")          \
    X(F, u64, leaf_pairs, REQ, REQ, counters.leaf_pairs, "pairs of leaves that overlap") \
    X(F, u64, candidates_vf, REQ, REQ, counters.candidates[PCCD_VF],                     \
      "VF pairs whose boxes overlap; wide may count a few others")                       \
    X(F, u64, candidates_ee, REQ, REQ, counters.candidates[PCCD_EE],                     \
      "EE pairs whose boxes overlap; wide may count a few others")                       \
    X(F, u64, survivors, REQ, REQ, counters.survivors,                                   \
      "pairs that the filter could not reject")                                          \
    X(F, u64, exact, REQ, REQ, counters.exact, "queries that went to exact arithmetic")  \
    X(F, u64, builds, REQ, REQ, counters.builds, "hierarchies built during the step")    \
    X(F, u64, allocs, REQ, REQ, counters.allocs,                                         \
      "allocations the engine made during the step")                                     \
    X(F, u64, rebuilds, OPT, OPT, counters.rebuilds,                                     \
      "subtrees reconstructed in the traversal")                                         \
    X(F, u64, rebuilt_triangles, OPT, OPT, counters.rebuilt_triangles,                   \
      "triangles of these")                                                              \
    X(F, u64, swaps, OPT, OPT, counters.swaps,                                           \
      "large subtrees that were rebuilt in the background and put in place")             \
    X(F, u64, swapped_triangles, OPT, OPT, counters.swapped_triangles,                   \
      "triangles of these")                                                              \
    X(F, u64, still_features, OPT, OPT, counters.still_features,                         \
      "features that stand still, whose boxes were kept")                                \
    X(F, u64, still_pairs, OPT, OPT, counters.still_pairs,                               \
      "pairs of nodes or features left out: neither moves")                              \
    X(F, u64, kept_records, OPT, OPT, counters.kept_records,                             \
      "records of what stands still, from the last answer")                              \
    X(F, u64, rigid_objects, OPT, OPT, counters.rigid_objects,                           \
      "objects whose rigid motion proves that they do not meet themselves")              \
    X(F, u64, thick_candidates, OPT, OPT, counters.thick_candidates,                     \
      "candidates that meet at a distance above 0")                                      \
    X(F, u64, thick_survivors, OPT, OPT, counters.thick_survivors,                       \
      "of these, asked one by one")                                                      \
    X(F, u64, thick_exact, OPT, OPT, counters.thick_exact,                               \
      "of these, by exact arithmetic")                                                   \
    X(F, u64, candidates_ve, OPT, OPT, counters.candidates[PCCD_VE],                     \
      "VE pairs whose boxes overlap; wide may count a few others")                       \
    X(F, u64, candidates_vv, OPT, OPT, counters.candidates[PCCD_VV],                     \
      "VV pairs whose boxes overlap; wide may count a few others")

/* The numbers of how the step may go on, and how it begins. New ones go to the end. */
#define COMMON_SAFETY(X, F)                                                              \
    X(F, f64, safe_step, OPT, OPT, safe_step,                                            \
      "from t = 0 to this t no pair meets; 0 .. 1, 1: none does. 0 if toi_first is 0, "  \
      "if there are crossings, and where it is not known")                               \
    X(F, u64, inside, OPT, OPT, inside,                                                  \
      "records with the flag 4 and not 2; modes any, pairs: 0")                          \
    X(F, bool, crowded, OPT, OPT, crowded,                                               \
      "more than half of the records begin at their distance or nearer, of a thick "     \
      "object or by the separation: mostly a radius above the length of the edges; or "  \
      "more than half are coincident")                                                   \
    X(F, u64, start_inside, OPT, OPT, start_inside,                                      \
      "tells_start, with an approach: pairs within their distance at t = 0")             \
    X(F, u64, coincident, OPT, OPT, coincident,                                          \
      "records that touch at t = 0 in a vertex of both features, as where a surface is " \
      "split; modes any, pairs, or if anything is thick: 0")                             \
    X(F, u64, entering, OPT, OPT, entering,                                              \
      "with touching: pairs that touch at t = 0 and enter; modes any, pairs: 0")         \
    X(F, u64, sliding, OPT, OPT, sliding, "of those that slide")                         \
    X(F, u64, leaving, OPT, OPT, leaving, "of those that leave")

#define COMMON_NUMBERS(X, F)                                                             \
    COMMON_OUTCOME(X, F)                                                                 \
    COMMON_KINDS(X, F)                                                                   \
    COMMON_FOUND(X, F)                                                                   \
    COMMON_TIMES(X, F)                                                                   \
    COMMON_COUNTERS(X, F)                                                                \
    COMMON_SAFETY(X, F)

#endif
