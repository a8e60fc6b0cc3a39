/* sweep.h - which features of two bodies may meet while one of them turns, and when.
 *
 * Go down the trees of both, with the spans of the step in which their nodes may meet: a
 * span of time is dropped for a pair of nodes where an axis keeps their boxes apart at
 * both of its ends, by more than what the motion leaves its chords in between. What is
 * widest is divided: a node of either side, or the span.
 *
 * Threads: [team]; one thread for one struct eng_sweep.
 * Source: elementary/BOUNDS.md, "Candidates of bodies that turn".
 */
#ifndef ENG_SWEEP_H
#define ENG_SWEEP_H

#include "body_tree.h"
#include "isa.h"
#include "poses.h"

/* A pair of features that may come within `keep` of each other, in `span` at most. */
struct eng_sweep_pair {
    enum pccd_kind kind;
    uint32_t side_a;   /* the side that the first feature of the kind is of */
    uint32_t leaf[2];  /* of feature a, of feature b: the leaves that own them .. */
    uint32_t place[2]; /* .. and which vertex, or edge, of the leaf it is */
    double span[2];
};

/* A span of time, from index 2^-depth on, 2^-depth long. */
struct eng_sweep_span {
    uint32_t index;
    uint16_t depth;
    uint16_t children; /* bit i: child i may meet in it */
};

struct eng_sweep_frames; /* how side 1 lies in some spans */

struct eng_sweep {
    /* Set by the caller. Side 1 is moved by the path, and is seen from side 0. */
    const struct eng_body *body[2];
    struct eng_poses *poses;
    double keep;     /* what is farther apart all the time may be left out */
    double fineness; /* spans are not divided for less */
    bool wants_free; /* also pairs of free points, and of these with free edges */
    double t_end;    /* what may meet later may be left out; can be made less meanwhile */
    double t_last;   /* the same, but it stays, whatever is found: not less than t_end */
    uint64_t tests_most; /* a run that needs more tests of boxes ends */
    /* Take a pair. False: no more is wanted. */
    bool (*take)(void *owner, const struct eng_sweep_pair *pair);
    /* Asked every 0.1 ms or so. */
    bool (*should_stop)(void *owner);
    void *owner;
    uint64_t box_tests; /* of a run */
    uint64_t leaf_tests;

    /* ---- its own ---- */
    bool stops;
    int status;
    uint32_t looks_left; /* until should_stop is asked */
    double size;         /* of coordinates of side 1 */
    float slack;         /* what rounding adds to a gap, but for where the two are */
    float margin;        /* keep and errors of poses, rounded up */
    struct eng_sweep_frames *frames;
    struct eng_sweep_span *spans; /* a stack, of which .. */
    uint32_t span_count, span_capacity;
    uint32_t root_count; /* .. so many stay: those in which the roots may meet */
    uint64_t root_tests; /* of boxes, that these took */
    bool has_roots;      /* they are there */
};

#define ENG_SWEEP_ALL 0u /* a task: both trees */

/* Calls, as an instruction set does them. */
struct eng_sweep_calls {
    /* Make and free what is kept from one pair of bodies to the next. PCCD_E_NOMEM. */
    int (*init)(struct eng_sweep *sweep);
    void (*deinit)(struct eng_sweep *sweep);
    uint64_t (*bytes)(const struct eng_sweep *sweep);

    /* Get ready for two bodies, when what the caller sets is set. */
    void (*begin)(struct eng_sweep *sweep);

    /* Divide the work into at most `limit` >= 1 tasks, each a child of a node of either
     * side; returns how many. */
    uint32_t (*split)(struct eng_sweep *sweep, uint32_t limit, uint64_t *tasks);

    /* Find the pairs of a task: each once, whichever spans it may meet in. PCCD_E_LIMIT:
     * it took too many tests; PCCD_E_NOMEM. */
    int (*run)(struct eng_sweep *sweep, uint64_t task);
};

#define ENG_SWEEP2(isa) eng_##isa##_sweep
#define ENG_SWEEP(isa)  ENG_SWEEP2(isa)

/* Those of each set; of one that was not built there are none. */
extern const struct eng_sweep_calls eng_scalar_sweep, eng_sse2_sweep, eng_sse4_sweep,
    eng_avx2_sweep, eng_avx512_sweep, eng_neon_sweep;

/* Return those of a set that this processor and build have, those of the one in use. All
 * of them find the same. */
const struct eng_sweep_calls *eng_sweep_of(enum eng_isa isa);
const struct eng_sweep_calls *eng_sweep(void);

#endif
