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

enum eng_mode {
    ENG_MODE_ALL = 0,
    ENG_MODE_FIRST = 1,
    ENG_MODE_ANY = 2,
    ENG_MODE_PAIRS = 3
};
enum eng_method { ENG_METHOD_DEFAULT = 0, ENG_METHOD_PAPER = 1 };
/* Who performs which task unit. The answer does not depend on it. */
enum eng_scheduler {
    ENG_SCHEDULER_STEAL = 0, /* work stealing over task units and pairs */
    ENG_SCHEDULER_PAPER = 1  /* dynamic assignment and high-level nodes (sections 4, 5) */
};
enum eng_kind { ENG_VF = 0, ENG_EE = 1 };
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
    uint64_t contact_max; /* records kept at most; beyond it the answer is incomplete */
    enum eng_scheduler scheduler; /* of steps by more than one thread */
};

#define ENG_STEP_SETTINGS_DEFAULT                                                        \
    {                                                                                    \
        ENG_MODE_ALL, ENG_METHOD_DEFAULT, 1, 1e-6, 0, NULL, 16u << 20,                   \
            ENG_SCHEDULER_STEAL                                                          \
    }

struct eng_step_counters {
    uint64_t task_units;    /* self-CD task units processed */
    uint64_t box_tests;     /* node pairs tested */
    uint64_t leaf_pairs;    /* overlapping leaf pairs */
    uint64_t candidates_vf; /* VF pairs whose feature boxes overlap */
    uint64_t candidates_ee;
    uint64_t survivors; /* of these, not rejected by the filter */
    uint64_t exact;     /* queries that needed exact arithmetic */
    uint64_t builds;    /* hierarchies built during the step */
    uint64_t allocs;    /* allocations made during the step */
};

struct eng_step_times { /* nanoseconds */
    uint64_t ingest;    /* staging writes since eng_stage_begin, with the commit */
    uint64_t refit;
    uint64_t traversal;
    uint64_t tests;
    uint64_t merge;
    uint64_t step; /* the sum and what lies between */
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
    struct eng_step_counters counters;
    struct eng_step_times times;
};

/* Run the step that was staged on `scene` (without staging: everything stands still).
 * Returns ENG_OK with *result, also when incomplete: the positions have moved on either
 * way. ENG_E_INVAL for settings out of range and ENG_E_NOMEM: positions are as before. */
int eng_step(struct eng_scene *scene, const struct eng_step_settings *settings,
             struct eng_step_result *result);

#endif
