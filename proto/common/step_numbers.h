/* step_numbers.h - the list of the times and counters of a step, with their names in
 * an answer.
 */
#ifndef COMMON_STEP_NUMBERS_H
#define COMMON_STEP_NUMBERS_H

#include "pccd_types.h"

/* X(F, field of the message, need, member, meaning). `member` is of something that has
 * struct pccd_step_times times and struct pccd_step_counters counters; `need` is as in
 * messages.def. All are u64; times are in nanoseconds. F is handed through. */
#define COMMON_STEP_TIMES(X, F)                                                          \
    X(F, ns_queue, REQ, times.queue, "from arrival to the compute thread")               \
    X(F, ns_ingest, REQ, times.ingest, "copy and check of the slot")                     \
    X(F, ns_refit, REQ, times.refit, "refit of all boxes")                               \
    X(F, ns_traversal, REQ, times.traversal, "box tests")                                \
    X(F, ns_tests, REQ, times.tests, "filters and solver")                               \
    X(F, ns_merge, REQ, times.merge, "sort, hash, copy to the result region")            \
    X(F, ns_step, REQ, times.step, "the whole step, ingest to finished result")          \
    X(F, ns_low, OPT, times.low, "of traversal and tests: low-level nodes")              \
    X(F, ns_high, OPT, times.high, "of traversal and tests: high-level nodes")           \
    X(F, ns_rebuild, OPT, times.rebuild, "reconstruction, the sum over all threads")

/* The same of `counts`: records by kind. */
#define COMMON_STEP_KINDS(X, F)                                                          \
    X(F, vf, REQ, counts[PCCD_VF],                                                       \
      "VF records of the whole answer; mode pairs: pairs; any: 0")                       \
    X(F, ee, REQ, counts[PCCD_EE], "EE records, likewise")                               \
    X(F, ve, OPT, counts[PCCD_VE], "VE records, likewise")                               \
    X(F, vv, OPT, counts[PCCD_VV], "VV records, likewise")

/* The same of an answer about what is near. */
#define COMMON_NEAR_KINDS(X, F)                                                          \
    X(F, vf, REQ, counts[PCCD_VF], "VF records of the whole answer")                     \
    X(F, ee, REQ, counts[PCCD_EE], "EE records, likewise")                               \
    X(F, ve, REQ, counts[PCCD_VE], "VE records")                                         \
    X(F, vv, REQ, counts[PCCD_VV], "VV records, likewise")                               \
    X(F, ef, REQ, counts[PCCD_EF], "EF records; only what = 4 has them")

#define COMMON_STEP_COUNTERS(X, F)                                                       \
    X(F, task_units, REQ, counters.task_units, "self-CD task units processed")           \
    X(F, box_tests, REQ, counters.box_tests, "pairs of nodes tested")                    \
    X(F, leaf_pairs, REQ, counters.leaf_pairs, "pairs of leaves that overlap")           \
    X(F, candidates_vf, REQ, counters.candidates[PCCD_VF],                               \
      "VF pairs whose boxes overlap; wide may count a few others")                       \
    X(F, candidates_ee, REQ, counters.candidates[PCCD_EE],                               \
      "EE pairs whose boxes overlap; wide may count a few others")                       \
    X(F, survivors, REQ, counters.survivors, "pairs that the filter could not reject")   \
    X(F, exact, REQ, counters.exact, "queries that went to exact arithmetic")            \
    X(F, builds, REQ, counters.builds, "hierarchies built during the step")              \
    X(F, allocs, REQ, counters.allocs, "allocations the engine made during the step")    \
    X(F, rebuilds, OPT, counters.rebuilds, "subtrees reconstructed in the traversal")    \
    X(F, rebuilt_triangles, OPT, counters.rebuilt_triangles, "triangles of these")       \
    X(F, swaps, OPT, counters.swaps,                                                     \
      "large subtrees that were rebuilt in the background and put in place")             \
    X(F, swapped_triangles, OPT, counters.swapped_triangles, "triangles of these")       \
    X(F, still_features, OPT, counters.still_features,                                   \
      "features that stand still, whose boxes were kept")                                \
    X(F, still_pairs, OPT, counters.still_pairs,                                         \
      "pairs of nodes or features left out: neither moves")                              \
    X(F, kept_records, OPT, counters.kept_records,                                       \
      "records of what stands still, from the last answer")                              \
    X(F, rigid_objects, OPT, counters.rigid_objects,                                     \
      "objects whose rigid motion proves that they do not meet themselves")              \
    X(F, thick_candidates, OPT, counters.thick_candidates,                               \
      "candidates that meet at a distance above 0")                                      \
    X(F, thick_survivors, OPT, counters.thick_survivors, "of these, asked one by one")   \
    X(F, thick_exact, OPT, counters.thick_exact, "of these, by exact arithmetic")        \
    X(F, candidates_ve, OPT, counters.candidates[PCCD_VE],                               \
      "VE pairs whose boxes overlap; wide may count a few others")                       \
    X(F, candidates_vv, OPT, counters.candidates[PCCD_VV],                               \
      "VV pairs whose boxes overlap; wide may count a few others")

#endif
