/* passage.h - thin features, VF or EE, of which one turns, in a span of time: by the
 * planes across both. Several pairs at once, each in a lane.
 *
 * Tell whether the features stay apart in a span, up to when, and where their planes
 * cross; whether they certainly meet around that; and where their points are at a time.
 * decide_turning.c cuts spans and keeps what is known of a pair.
 *
 * Threads: one thread for one struct eng_poses. What is told of a pair is a function of
 * what is asked of it, the same by every instruction set and whatever else is asked.
 * Source: elementary/BOUNDS.md, "Features that turn".
 */
#ifndef ENG_PASSAGE_H
#define ENG_PASSAGE_H

#include "decide.h"
#include "kernel.h"

enum eng_seen {
    ENG_SEEN_FREE,   /* more than 0 apart in all of the span */
    ENG_SEEN_NEAR,   /* up to `until`; then the planes cross, and nobody knows */
    ENG_SEEN_UNSURE, /* so near that doubles cannot tell */
    ENG_SEEN_CUT,    /* nothing is known before it is cut */
    ENG_SEEN_OPEN    /* up to `until`; ask by other means */
};

struct eng_passage {
    /* The pair: of one kind and with one side that turns, in all that are asked at
     * once. */
    const double (*x)[4][3]; /* of struct eng_turning_pair */
    bool stands;             /* the feature that does not turn */
    double still_error;      /* of its places between both ends */
    double still_size;
    double turning_size; /* largest coordinate of the turning feature in its frame */
    double bend;         /* of its points, in the whole step */
    double delta;        /* of struct eng_turning_limits */
    double tolerance;

    /* Asked of `look`. */
    double l, r;      /* the span */
    bool is_possible; /* it is known already that the pair may meet */

    /* Told by `look`. */
    enum eng_seen seen;
    double until;     /* they are free up to this time */
    double precision; /* delta, or more, if rounding leaves that no meaning */
    bool is_leaf;     /* shorter spans would tell no more */
    bool is_beyond;   /* a place is beyond the numbers that tests know; stays so */
    bool is_inside;   /* the planes cross within both features, it seems */
    double middle;    /* part of the span after which they cross; -1: nobody knows */
    double f[4];      /* Bernstein coefficients of det[p, b, c], in a unit of .. */
    double scale;     /* .. 1 / scale */

    /* Asked of `prove` and told by `cross`: a window of time. */
    double from, to;

    /* Told by `cross` and `prove`. */
    bool is_met; /* the features certainly meet in the window */
    double side; /* where they ever did, its sign is that of det[p, b, c] before that; set
                  * to 0 by the caller at first */

    double at;       /* asked of `place`, and .. */
    float normal[3]; /* .. told: of such a contact, as in struct pccd_contact */
};

struct eng_passage_calls {
    /* Tell of spans. */
    void (*look)(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                 struct eng_passage *const *some, uint32_t count);
    /* Of spans that `look` has told of, with middle >= 0: find where the planes cross,
     * better than it did, and try a window of half the tolerance there, and whether they
     * are free up to it; then `until` becomes `from`. */
    void (*cross)(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                  struct eng_passage *const *some, uint32_t count);
    /* Tell of windows. */
    void (*prove)(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                  struct eng_passage *const *some, uint32_t count);
    /* Set points[i][..] to where those of some[i] are at the time `at`, at both ends; of
     * other kinds, too. */
    void (*place)(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                  struct eng_passage *const *some, uint32_t count,
                  struct eng_point (*points)[4]);
};

#define ENG_PASSAGE2(isa) eng_##isa##_passage
#define ENG_PASSAGE(isa)  ENG_PASSAGE2(isa)

/* Those of each set; of one that was not built there are none. */
extern const struct eng_passage_calls eng_scalar_passage, eng_sse2_passage,
    eng_sse4_passage, eng_avx2_passage, eng_avx512_passage, eng_neon_passage;

/* Return those of the set that is in use. */
const struct eng_passage_calls *eng_passage(void);

/* Spans that turn by more than their chords show are cut without a closer look: where
 * points are off their chords by more than this part of their way. */
#define ENG_PASSAGE_BENT 0x1p-4

#define ENG_PASSAGE_SIZE 1e18

#endif
