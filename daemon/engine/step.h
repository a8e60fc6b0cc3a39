/* daemon/engine/step.h - one step of a scene: the only computation the server asks for.
 *
 * Room:     engine. May include: scene.h.
 * Does:     refit, traverse, filter, solve, sort, hash; counts and times each phase.
 * Threads:  [compute].
 * Source:   paper sections 4-6; the contract of an answer is in README.md.
 */
#ifndef ENG_STEP_H
#define ENG_STEP_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "scene.h"

struct eng_kernels;
struct eng_places;
struct eng_trace;

enum eng_mode {
    ENG_MODE_ALL = 0,
    ENG_MODE_FIRST = 1,
    ENG_MODE_ANY = 2,
    ENG_MODE_PAIRS = 3
};
/* How candidates are found. The answer does not depend on it. */
enum eng_method {
    ENG_METHOD_DEFAULT = 0, /* wide; paper with ENG_SCHEDULER_PAPER, which is its own */
    ENG_METHOD_PAPER = 1,   /* binary tree over triangles, rebuilt in part on the way */
    ENG_METHOD_WIDE = 2     /* wide trees over vertices, edges and faces */
};
/* Who performs which task unit. The answer does not depend on it. */
enum eng_scheduler {
    ENG_SCHEDULER_STEAL = 0, /* work stealing over task units and pairs */
    ENG_SCHEDULER_PAPER = 1  /* dynamic assignment and high-level nodes (sections 4, 5) */
};
/* How threads share a high-level task unit of the paper's scheduler (section 5.1). */
enum eng_high_level {
    ENG_HIGH_ROUND_ROBIN = 0, /* its pairs dealt out; a lock where a node is rebuilt */
    ENG_HIGH_DISJOINT = 1     /* pairs without a common node at a time; no lock */
};
/* How threads share the refit. */
enum eng_refit_scheme {
    ENG_REFIT_EVEN = 0, /* many small subtrees, taken on demand */
    ENG_REFIT_PAPER = 1 /* 2k subtrees, the first k dealt out (section 6.1) */
};
enum eng_kind { ENG_VF = 0, ENG_EE = 1 };
#define ENG_KINDS 2
enum eng_verdict {
    ENG_VERDICT_NO = 0,
    ENG_VERDICT_POSSIBLE = 1,
    ENG_VERDICT_YES = 2,
    ENG_VERDICT_NONE = 3
};
enum eng_incomplete {
    ENG_COMPLETE = 0,
    ENG_INCOMPLETE_DEADLINE = 2,
    ENG_INCOMPLETE_CANCELLED = 3,
    ENG_INCOMPLETE_CONTACT_LIMIT = 4
};
enum eng_contact_flag { ENG_PROVED = 1u, ENG_INITIAL = 2u };

/* Record layouts: the same bytes as struct pccd_contact and struct pccd_pair of the wire;
 * their meaning is written there. The server asserts the layouts against each other. */
struct eng_contact {
    uint32_t kind;
    uint32_t flags;
    uint32_t object_a;
    uint32_t feature_a;
    uint32_t object_b;
    uint32_t feature_b;
    double toi;
    double toi_hi;
    float param[2];
    float normal[3];
    uint32_t reserved;
};

struct eng_pair {
    uint32_t kind;
    uint32_t object_a;
    uint32_t feature_a;
    uint32_t object_b;
    uint32_t feature_b;
};

struct eng_step_settings {
    enum eng_mode mode;
    enum eng_method method;
    uint32_t threads;     /* at most this many, >= 1; the answer does not depend on it */
    double tolerance;     /* of toi_hi - toi, 1e-12 .. 1; default 1e-6 */
    uint64_t deadline_ns; /* CLOCK_MONOTONIC; 0 = none */
    const atomic_bool *cancel; /* set by any thread to stop the step; may be NULL */
    /* Records kept at most: of more, the first in canonical order (mode first: of those
     * that may have been the earliest then), and the answer is incomplete. */
    uint64_t contact_max;
    enum eng_scheduler scheduler; /* of steps by more than one thread, as the next two */
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
    const struct eng_places *places; /* where threads belong (place.h); NULL: anywhere */
    struct eng_trace *trace;         /* what is recorded to (trace.h); NULL: nothing */
    /* Instruction set of refit, traversal and tests (kernel.h); NULL: eng_kernels(). */
    const struct eng_kernels *kernels;
    bool team_always; /* by `threads` threads however small the work: for tests */
    bool brief;       /* end soon or not at all (brief.h) */
};

#define ENG_STEP_SETTINGS_DEFAULT                                                        \
    {                                                                                    \
        ENG_MODE_ALL, ENG_METHOD_DEFAULT, 1, 1e-6, 0, NULL, 16u << 20,                   \
            ENG_SCHEDULER_STEAL, ENG_HIGH_ROUND_ROBIN, ENG_REFIT_EVEN, NULL, NULL, NULL, \
            false, false                                                                 \
    }

/* What one thread of a step did. Times in nanoseconds of that thread. */
struct eng_thread_record {
    uint64_t task_units; /* self-CD task units */
    uint64_t pairs;      /* pairs of nodes refined */
    uint64_t box_tests;  /* pairs of nodes tested */
    uint64_t tests;      /* elementary tests: candidates it sent to the filter */
    uint64_t steals;     /* tasks taken from others; nodes received from others */
    uint64_t requests;   /* rounds over the victims; requests placed */
    uint64_t given;      /* nodes handed to others (the paper's scheduler) */
    uint64_t sleeps;     /* times it slept, or offered its processor, without work */
    uint64_t rebuilds;   /* subtrees reconstructed during traversal */
    uint64_t lock_waits; /* times it waited for another's reconstruction */
    uint64_t refit_ns;
    uint64_t low_ns; /* traversal and tests; of high-level nodes: high_ns */
    uint64_t high_ns;
    uint64_t tests_ns;   /* of the two above: filters and solver */
    uint64_t rebuild_ns; /* of the two above: reconstruction */
    uint64_t wait_ns;    /* without work, between the step's barriers */
    uint64_t merge_ns;   /* sort and gather */
};

struct eng_step_counters {
    uint64_t task_units; /* self-CD task units processed */
    uint64_t box_tests;  /* node pairs tested */
    uint64_t leaf_pairs; /* overlapping leaf pairs */
    /* VF pairs whose feature boxes overlap. But for mode pairs method wide may count
     * fewer, those below nodes that no time brings together being left out, and a few
     * more, whose boxes in whole numbers overlap. */
    uint64_t candidates_vf;
    uint64_t candidates_ee;
    uint64_t survivors;         /* of these, not rejected by the filter */
    uint64_t exact;             /* queries that needed exact arithmetic */
    uint64_t rebuilds;          /* subtrees reconstructed during traversal (6.2) */
    uint64_t rebuilt_triangles; /* what they hold; above the objects: objects */
    uint64_t swaps; /* made aside and put in place: large subtrees, orders of features */
    uint64_t swapped_triangles;
    uint64_t builds; /* hierarchies built during the step */
    uint64_t allocs; /* allocations made during the step */
};

struct eng_step_times { /* nanoseconds */
    uint64_t ingest;    /* staging writes since eng_stage_begin, with the commit */
    uint64_t refit;
    uint64_t traversal;
    uint64_t tests;
    uint64_t merge;
    uint64_t step;    /* the sum and what lies between */
    uint64_t low;     /* wall time of low-level nodes; by stealing: of all nodes */
    uint64_t high;    /* of high-level nodes; low + high = traversal + tests */
    uint64_t rebuild; /* sum over the threads: reconstruction, subtrees built aside */
};

struct eng_step_result {
    enum eng_mode mode;
    enum eng_method method;
    enum eng_incomplete incomplete;
    enum eng_verdict verdict; /* mode ANY, else ENG_VERDICT_NONE */
    const void *records;   /* eng_contact[] or (mode PAIRS) eng_pair[]; valid until the */
    uint32_t record_bytes; /* scene's next step, removal or free */
    uint64_t count;
    uint64_t vf;
    uint64_t ee;
    uint64_t possible;
    uint64_t initial;
    double toi_first; /* smallest toi; 2 without any record */
    uint64_t hash_hi; /* XXH3-128 of the records; mode ANY: of the verdict as uint32_t */
    uint64_t hash_lo;
    uint32_t threads;
    const struct eng_thread_record *thread_records; /* [threads]; valid as records */
    struct eng_step_counters counters;
    struct eng_step_times times;
};

/* Run the step that was staged on `scene` (without staging: everything stands still).
 * Returns ENG_OK with *result, also when incomplete; or ENG_E_LONG (brief.h): positions
 * have moved on. Settings out of range (ENG_E_INVAL), ENG_E_NOMEM: as before. */
int eng_step(struct eng_scene *scene, const struct eng_step_settings *settings,
             struct eng_step_result *result);

/* What it would say of a step that has to end before it begins: nothing was found. Of the
 * settings, mode, method and scheduler matter. [any] */
void eng_step_nothing(const struct eng_step_settings *settings,
                      struct eng_step_result *result);

#endif
