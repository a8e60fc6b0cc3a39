/* exact.h - decides an elementary test by exact integer arithmetic, for the cases in
 * which rounding hides the answer.
 *
 * Decide, from the binary inputs, whether two features touch at t = 0 or t = 1, which
 * side of each other they are on, and whether they meet within a span of time.
 *
 * Threads: one thread for one scratch. Decisions allocate nothing.
 */
#ifndef ENG_EXACT_H
#define ENG_EXACT_H

#include "isolate.h"
#include "query.h"
#include "root_sign.h"

#define ENG_EXACT_WORDS      40
#define ENG_EXACT_CONDITIONS 5
#define ENG_EXACT_EVENTS     4
#define ENG_EXACT_PRODUCTS   5
#define ENG_EXACT_VALUES     3

/* Coordinates are integers below 2^ENG_EXACT_BITS: doubles below 2^60, times 2^1126, as
 * if denormal ones had 53 bits, too. */
#define ENG_EXACT_BITS 1186

/* No interval [num, num + 1] / 2^k is shorter than 2^-ENG_EXACT_DEPTH of its span: roots
 * are alone in theirs before (BOUNDS.md), and nobody asks for more. */
#define ENG_EXACT_DEPTH 7296ul

/* Asks whether anybody still waits for the decision at hand. Set by eng_batch_test. */
struct eng_exact_interrupt {
    bool (*should_stop)(void *owner); /* NULL: never. Asked every few intervals */
    void *owner;
    uint32_t looked_at; /* intervals */
    bool has_stopped;   /* the decision is given up: what is answered means nothing */
};

/* The cubic and the conditions of query.h as polynomials in time, see exact_span.c. */
struct eng_exact_form {
    struct eng_poly det;
    struct eng_poly n[3];
    struct eng_poly side[ENG_EXACT_CONDITIONS][3]; /* see exact_roots.h */
};

/* "This point lies on that segment", over the step. */
struct eng_exact_event {
    bool is_loaded;
    bool never;              /* it is not even on the segment's line */
    struct eng_poly common;  /* 0 where it is on the line; degree -1: all the time */
    struct eng_poly between; /* >= 0 where it is between the ends, if on the line */
};

/* Facts that have been found about roots of det over a span, the first ones in it, in the
 * order in which every search comes to them: whether the conditions hold there, and which
 * of the sides are 0. */
struct eng_exact_known {
    double l, r;
    int count;
    bool holds[ENG_POLY_TERMS];
    bool is_zero[ENG_POLY_TERMS][ENG_EXACT_CONDITIONS];
};

/* A query and what is asked about it, see exact_span.c. */
struct eng_exact_span {
    struct eng_exact_interrupt interrupt;
    struct eng_query query;             /* that `whole` is of */
    bool is_loaded;                     /* it is of any */
    mpz_t x[2][4][3];                   /* points at t = 0 and 1, scaled to integers */
    struct eng_residue_points residues; /* of x */
    struct eng_exact_form whole;        /* over the step */
    bool has_sides;                     /* whole.side is set */
    struct eng_poly products[ENG_EXACT_PRODUCTS]; /* of p, b and c, over the step */
    bool has_products;
    struct eng_poly values[ENG_EXACT_VALUES]; /* p x c, b x p and n, each . n */
    bool has_values[ENG_EXACT_VALUES];
    struct eng_exact_event events[ENG_EXACT_EVENTS];
    struct eng_exact_form part;  /* over the span, if that is shorter */
    struct eng_exact_form *form; /* one of these: over the span */
    struct eng_exact_known known;
    mpz_t l, width; /* the span, times 2^time_k */
    unsigned long time_k;
    struct eng_isolator roots; /* of det, or of an event, over the span */
    mpz_t end;                 /* scratch */
    mpz_t before;              /* num where a search for another interval began */
    bool wants_first;
    unsigned long depth_min; /* k of the interval around a first root, at least */
    double found[2];         /* the earliest begin and end, of the span */
    struct eng_poly p[3], b[3], c[3];
    struct eng_poly to_j[3], to_k[3], line[3], common; /* of the event at hand */
    struct eng_poly
        condition[ENG_EXACT_CONDITIONS];  /* over interval value_num, value_k */
    bool has_value[ENG_EXACT_CONDITIONS]; /* `condition` is set */
    unsigned long value_k;
    mpz_t value_num;
    struct eng_poly sign, scratch;
    struct eng_root_sign root_sign;
};

/* Integers, in one block that suffices for every query. */
struct eng_exact {
    mpz_t z[ENG_EXACT_WORDS];
    struct eng_exact_span span;
    uint64_t queries; /* answered so far by this arithmetic */
    mp_limb_t *block;
};

/* Allocate the block. PCCD_E_NOMEM: there is nothing to deinit. What follows never fails
 * for memory. */
int eng_exact_init(struct eng_exact *exact);
void eng_exact_deinit(struct eng_exact *exact);

/* Return the bytes of the block. Pages of it are taken when numbers become as long as
 * that. */
size_t eng_exact_bytes(void);

struct eng_moment {
    bool touching; /* the closed features share a point */
    int side;      /* sign of det[p, b, c]: -1, 0, 1 */
};

/* Return whether a corner of the one feature is a corner of the other at t = `end`, as
 * where one mesh continues another: most of what touches at all touches there, and it
 * takes no arithmetic to know. */
bool eng_exact_share_corner(const struct eng_query *query, int end);

/* Return the configuration at t = `end` (0 or 1), by the definition: degenerate triangles
 * are the segments they collapse to, degenerate edges are points. */
struct eng_moment eng_exact_moment(struct eng_exact *exact, const struct eng_query *query,
                                   int end);

/* Return whether there is a contact at some t in [l, r], 0 <= l < r <= 1. By the
 * definition, without error. Typically 5 to 50 us; bench/README.md has how long at most.
 */
bool eng_exact_meets(struct eng_exact *exact, const struct eng_query *query, double l,
                     double r);

/* Return whether there is a contact in [*l, *r], as eng_exact_meets, and set *l, *r to
 * the ends of a shorter span that holds the first one, longer than `tolerance` (at least
 * 2^-44) only by rounding. False: they are unchanged. Takes up to twice the time. */
bool eng_exact_first(struct eng_exact *exact, const struct eng_query *query,
                     double tolerance, double *l, double *r);

/* Features that touch at t = 0, and what comes after that. */
enum eng_again {
    ENG_AGAIN_NEVER,
    ENG_AGAIN_MEETS,
    ENG_AGAIN_UNKNOWN /* it would have to be told from 0: sooner than 2^-996 */
};

/* Find the next contact of features that touch at t = 0, after they have parted: *l, *r
 * become a span that holds it, as those of eng_exact_first. Features whose points stay in
 * one plane also meet again where, touching still, a point of one comes to an edge of the
 * other. *side becomes the sign of det[p, b, c] just after t = 0; 0: it stays 0. */
enum eng_again eng_exact_again(struct eng_exact *exact, const struct eng_query *query,
                               double tolerance, double *l, double *r, int *side);

#endif
