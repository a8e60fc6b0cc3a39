/* question.h - what is asked of a scene, and how it is to be computed.
 *
 * One struct from the caller to the tests of a pair.
 *
 * Threads: [any]; but for `bounds` and `meets`, nothing changes while a team is at work.
 */
#ifndef ENG_QUESTION_H
#define ENG_QUESTION_H

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"
#include "step_result.h"

struct eng_kernels;
struct eng_affinity;
struct eng_scene;
struct eng_trace;

#define ENG_THREADS_MAX 256u /* of one step */

/* Beside enum pccd_near_what: which features meet in the step. */
#define ENG_CONTACTS ((uint32_t)PCCD_NEAR_COUNT)

/* The ways in which the threads of a step share its work (paper, sections 4 to 6). */
enum eng_scheduler {
    ENG_SCHEDULER_STEAL, /* they steal task units and pairs from each other */
    ENG_SCHEDULER_PAPER, /* dynamic assignment, then high-level nodes */
    ENG_SCHEDULER_COUNT
};

/* The paper's scheduler: how all threads perform one high-level node together. */
enum eng_high_level {
    ENG_HIGH_LEVEL_ROUND_ROBIN, /* pairs dealt out; a lock where a node is rebuilt */
    ENG_HIGH_LEVEL_DISJOINT,    /* pairs without a common node at a time, no lock */
    ENG_HIGH_LEVEL_COUNT
};

/* The ways in which the threads share the refit. */
enum eng_refit_scheme {
    ENG_REFIT_EVEN,  /* many small subtrees, taken on demand */
    ENG_REFIT_PAPER, /* two subtrees a thread, the first dealt out */
    ENG_REFIT_COUNT
};

/* The fate of the boxes and records of what stands still (scene/moving.h). */
enum eng_still {
    ENG_STILL_KEPT, /* they are those of the last step */
    ENG_STILL_ANEW, /* they are made anew, as if everything moved: to compare with */
    ENG_STILL_COUNT
};

/* All of it; zeros are the defaults. Its text: below. */
struct eng_tuning {
    enum eng_scheduler scheduler;
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
    enum eng_still still; /* of steps by one thread, too */
};

/* The features that threads look for in a question about what is near. eng_near makes it;
 * callers leave zeros. */
struct eng_sought {
    uint32_t kinds; /* bit k: pairs of enum pccd_kind or pccd_near_kind k are tested */
    /* Radii or rest of objects enter: pairs within `reach`, the distance and the largest
     * radii, rounded up, are looked at one by one (narrow.h, near_best.h). */
    bool is_thick;
    double reach;
    float growth;       /* the distance as boxes know it, in their frame, rounded up */
    float reach_growth; /* the reach so, where boxes have no radii in them */
    /* VERTICES: by the scene's vertices, the least bound so far: bits of a double,
     * whose order is that of the numbers; first those of INFINITY. */
    _Atomic uint64_t *bounds;
    /* CROSSINGS: some features are known to cross or to touch. Of those that touch no
     * more is asked for, so that they are not looked for any more. */
    atomic_bool *meets;
};

struct eng_question {
    /* ---- what is asked ---- */
    uint32_t verb; /* ENG_CONTACTS, by eng_step; enum pccd_near_what, by eng_near */
    /* ENG_CONTACTS: the part of the step that is asked about, 0 <= span[0] < span[1] <=
     * 1. Its answer is that of the step in which every vertex goes straight from where it
     * is at span[0] to where it is at span[1] (eng_part_enter); its times are the whole
     * step's. */
    double span[2];
    uint32_t end;        /* of what is near: the end of the step, 0 or 1 */
    enum pccd_mode mode; /* ENG_CONTACTS */
    /* Two features meet, or are near, where they come within r of each other, the exact
     * sum of their radii (scene.h) and of this. 0 .. 1e18; NEAREST: also INFINITY.
     * CROSSINGS and DEPTH do not look at it. */
    double distance;
    /* ENG_CONTACTS, of pairs that begin within r: 0 reports each, at t = 0; between 0 and
     * 1: those that come within so large a part of their first distance. */
    double approach;
    /* ENG_CONTACTS: what becomes of pairs that touch at t = 0, or are within r then. */
    enum pccd_touching touching;
    /* ENG_CONTACTS, of bodies that turn: what comes within so much more than the distance
     * at which it meets may be possible. 0 .. 1e18; 0: 2^-20 of the size of the two. */
    double resolution;
    double tolerance;     /* of toi_hi - toi, 1e-12 .. 1; default 1e-6 */
    double gap;           /* NEAREST: 0 .. 1e18 */
    uint32_t objects[2];  /* ids; 0: any. pccd_near.h says when they are looked at */
    bool tells_start;     /* ENG_CONTACTS, not brief: say how it begins, too (struct
                           * eng_step_result: crossings, start_inside) */
    bool tells_crossings; /* PAIRS, FEATURES, VERTICES: count what crosses, too */
    /* PAIRS, CROSSINGS: make no records, so that those of the last answer stay; of
     * CROSSINGS what only touches is not looked for. */
    bool counts_only;
    bool no_hash; /* nobody reads it: of records none is made */
    /* Records kept at most: of more, the first in canonical order (mode first: of those
     * that may have been the earliest then), and the answer is incomplete. */
    uint64_t contact_max;

    /* ---- how: the answer does not depend on it ---- */
    enum pccd_method method;
    uint32_t threads;          /* at most this many, >= 1 */
    uint64_t deadline_ns;      /* CLOCK_MONOTONIC; 0 = none */
    const atomic_bool *cancel; /* set by any thread to stop the step; may be NULL */
    /* Asked where `cancel` is looked at, by the calling thread alone: true stops the step
     * as cancelled. So the caller may look where no other thread may. Some microseconds
     * lie between two questions, as a rule. NULL: nobody is asked. */
    bool (*is_stopped)(void *asked);
    void *asked;
    /* ENG_CONTACTS: told of all pairs that the lanes do not reject, those of how the step
     * begins, too, by any thread of the team; the step makes no records then. NULL: it
     * makes them. */
    void (*weigh)(void *weigher, const struct pccd_pair *pairs, uint32_t count);
    void *weigher;
    struct eng_tuning tuning; /* of steps by more than one thread */
    const struct eng_affinity
        *affinity;           /* where threads belong (affinity.h); NULL: anywhere */
    struct eng_trace *trace; /* what is recorded to (trace.h); NULL: nothing */
    uint32_t track;          /* of it, for the first thread */
    /* Instruction set of refit, traversal and tests (kernel.h); NULL: eng_kernels(). */
    const struct eng_kernels *kernels;
    bool team_always; /* by `threads` threads, in body space, however small: for tests */
    uint64_t turning_tests; /* tests_most of turning.h; 0: the default */
    bool brief;       /* end soon or not at all (step.h) */
    bool alone;       /* of a brief one: nobody but who asks is held up meanwhile */
    /* Whose worker a step by one thread uses in the place of its own: so that of many
     * scenes few have workers. No step of that scene is computed meanwhile. NULL, or the
     * scene itself: its own. Only of eng_step, and not of brief ones. */
    struct eng_scene *scratch_from;
    /* Memory, aligned to 64 bytes, that nobody else uses until the step returns, as where
     * the caller will write the answer to: for what the step finds, before that is in
     * order. NULL: it has its own for all of that. Of eng_step alone. */
    void *scratch_memory;
    uint64_t scratch_bytes;
    struct eng_sought sought;
};

/* All contacts of a step. */
#define ENG_QUESTION_DEFAULT                                                             \
    {                                                                                    \
        .verb = ENG_CONTACTS, .span = {0, 1}, .tolerance = 1e-6, .threads = 1,           \
        .contact_max = 16u << 20                                                         \
    }

/* Return the method that the question leads to: PCCD_METHOD_PAPER or PCCD_METHOD_WIDE. */
static inline enum pccd_method eng_method_of(const struct eng_question *question)
{
    if (question->method != PCCD_METHOD_DEFAULT) {
        return question->method;
    }
    return question->tuning.scheduler == ENG_SCHEDULER_PAPER ? PCCD_METHOD_PAPER
                                                             : PCCD_METHOD_WIDE;
}

/* Return whether the question is about a part of the step. */
static inline bool eng_asks_part(const struct eng_question *question)
{
    return question->span[0] != 0 || question->span[1] != 1;
}

/* Return whether it is told what becomes of what touches at t = 0. */
static inline bool eng_asks_touching(const struct eng_question *question)
{
    return question->verb == ENG_CONTACTS && question->mode != PCCD_MODE_PAIRS &&
           question->touching != PCCD_TOUCHING_KEPT;
}

/* More than what rounding adds to a time that goes from the part to the step or back. */
#define ENG_PART_SLACK 0x1p-51

/* Return a time of the step that is not after time t, 0 .. 1, of the part. */
static inline double eng_part_toi(const struct eng_question *question, double t)
{
    const double *span = question->span;
    double time = span[0] + t * (span[1] - span[0]) - ENG_PART_SLACK;
    return t >= 1 ? span[1] : fmax(span[0], time);
}

/* Return a time of the step that is not before time t, 0 .. 1, of the part. */
static inline double eng_part_toi_hi(const struct eng_question *question, double t)
{
    const double *span = question->span;
    double time = span[0] + t * (span[1] - span[0]) + ENG_PART_SLACK;
    return t <= 0 ? span[0] : fmin(span[1], time);
}

/* Return a time of the part, at most 1, that is not before any whose eng_part_toi is at
 * most `time`. */
static inline double eng_part_time(const struct eng_question *question, double time)
{
    double length = question->span[1] - question->span[0];
    return fmin((time - question->span[0] + 4 * ENG_PART_SLACK) / length, 1);
}

/* Return the tolerance in the part, at most 1: how long toi_hi - toi may be there, so
 * that the step's is not longer than the question's. */
static inline double eng_part_tolerance(const struct eng_question *question)
{
    double length = question->span[1] - question->span[0];
    return fmin((question->tolerance - 4 * ENG_PART_SLACK) / length, 1);
}

/* Return whether the question is about what is near at one moment. */
static inline bool eng_asks_near(const struct eng_question *question)
{
    return question->verb != ENG_CONTACTS;
}

/* Return whether pairs of that kind need not be looked for. Relaxed: it is a hint. */
static inline bool eng_near_leaves_out(const struct eng_question *question, uint32_t kind)
{
    return question->verb == PCCD_NEAR_CROSSINGS && kind != PCCD_EF &&
           atomic_load_explicit(question->sought.meets, memory_order_relaxed);
}

/* Return the distance within which pairs of boxes of a kind are looked at: what crosses
 * has boxes that meet. */
static inline float eng_near_growth_of(const struct eng_question *question, uint32_t kind)
{
    return kind == PCCD_EF ? 0 : question->sought.growth;
}

/* Return whether a pair does not matter that is farther apart than something else is from
 * each of its points. */
static inline bool eng_near_prunes(const struct eng_question *question)
{
    return question->verb == PCCD_NEAR_VERTICES;
}

/* Boxes are not within 2^80 of nowhere (boxes.h), and hold coordinates below that. */
#define ENG_GROWTH_MOST 0x1p80f

/* Return `distance` in a frame of this scale, a power of two, rounded up; at most
 * ENG_GROWTH_MOST. */
static inline float eng_near_growth(double distance, double scale)
{
    double scaled = distance * scale; /* exact, or infinite */
    float growth = scaled < (double)ENG_GROWTH_MOST ? (float)scaled : ENG_GROWTH_MOST;
    return (double)growth < scaled && growth < ENG_GROWTH_MOST
               ? nextafterf(growth, ENG_GROWTH_MOST)
               : growth;
}

/* ---- the text of a tuning: "scheduler=paper,refit=paper" --------------------------- */

#define ENG_TUNING_WHY_BYTES 128

/* Set what `text` names, and leave the rest of `tuning` as it is; "" names nothing. Any
 * of the four may stand, in any order, once each. PCCD_E_INVAL: `tuning` is as before
 * and `why` says what is wrong, in printable ASCII whatever `text` holds. What is
 * accepted is shorter than PCCD_TUNING_BYTES. */
int eng_tuning_read(const char *text, struct eng_tuning *tuning,
                    char why[ENG_TUNING_WHY_BYTES]);

/* Write what a step has used, as eng_tuning_read takes it: "" where a thread was alone,
 * and so shared nothing. The method wide always steals, refits in one way, and has no
 * high-level nodes. */
void eng_tuning_used(const struct eng_question *question,
                     const struct eng_step_result *result, char text[PCCD_TUNING_BYTES]);

#endif
