/* daemon/engine/elementary/exact.h - exact answers, for what rounding hides.
 *
 * Room:     engine. May include: poly.h, query.h, residue.h, GMP.
 * Does:     decide on the binary inputs whether two features touch at t = 0 or t = 1,
 *           which side of each other they are on, and whether they meet within a span of
 *           time.
 * Threads:  one thread for one scratch. Nothing is allocated once the numbers have grown
 *           to the size that the inputs need.
 */
#ifndef ENG_EXACT_H
#define ENG_EXACT_H

#include "poly.h"
#include "query.h"
#include "residue.h"

#define ENG_EXACT_WORDS      40
#define ENG_EXACT_CONDITIONS 5

/* Intervals num / 2^k of a span, see exact_span.c. */
struct eng_exact_chain {
    mpz_t top;
    mpz_t bottom;
    unsigned long top_k;
    unsigned long bottom_k;
    int variations;
};

/* Polynomials over a span, see exact_span.c. */
struct eng_exact_span {
    mpz_t x[2][4][3]; /* points at the ends of the span, scaled to integers */
    mpz_t l, r;       /* the ends, scaled by a power of two */
    mpz_t num;        /* interval at hand: [num, num + 1] / 2^k of the span */
    mpz_t end;        /* scratch */
    mpz_t before;     /* num where a search for an earlier interval began */
    mpz_t base_num;   /* the interval of `base`: the last one that was refined */
    unsigned long base_k;
    struct eng_exact_chain chains[ENG_POLY_TERMS]; /* [chain_count] */
    int chain_count;
    struct eng_residue_points residues; /* of x */
    bool wants_first;
    unsigned long depth_min; /* k of the interval around a first root, at least */
    double found[2];         /* the earliest begin and end, of the span */
    struct eng_poly p[3], b[3], c[3], n[3], m[3];
    struct eng_poly det, beta, gamma, nn;
    struct eng_poly condition[ENG_EXACT_CONDITIONS];
    struct eng_poly common[ENG_EXACT_CONDITIONS]; /* with the root's polynomial */
    struct eng_poly root, zoomed, base, sign, scratch[3];
};

/* Integers that keep their memory from query to query. */
struct eng_exact {
    mpz_t z[ENG_EXACT_WORDS];
    struct eng_exact_span span;
    uint64_t queries; /* answered so far by this arithmetic */
};

void eng_exact_init(struct eng_exact *exact);
void eng_exact_deinit(struct eng_exact *exact);

struct eng_moment {
    bool touching; /* the closed features share a point */
    int side;      /* sign of det[p, b, c]: -1, 0, 1 */
};

/* Is a corner of the one feature a corner of the other at t = `end`? As where one mesh
 * continues another: most of what touches at all touches there, and it takes no
 * arithmetic to know. */
bool eng_exact_share_corner(const struct eng_query *query, int end);

/* The configuration at t = `end` (0 or 1), by the definition: degenerate triangles are
 * the segments they collapse to, degenerate edges are points. */
struct eng_moment eng_exact_moment(struct eng_exact *exact, const struct eng_query *query,
                                   int end);

/* Is there a contact at some t in [l, r], 0 <= l < r <= 1? By the definition, without
 * error. Typically 10 to 100 us. */
bool eng_exact_meets(struct eng_exact *exact, const struct eng_query *query, double l,
                     double r);

/* The same, and where the first contact is: *l, *r become the ends of a shorter span that
 * holds it, longer than `tolerance` (at least 2^-44) only by rounding. False: unchanged.
 * Up to twice the time. */
bool eng_exact_first(struct eng_exact *exact, const struct eng_query *query,
                     double tolerance, double *l, double *r);

#endif
