/* isolate.h - finds the roots of a polynomial in [0, 1], each alone in an interval, and
 * makes such an interval shorter.
 *
 * An interval [num, num + 1] / 2^k is named by num and k. Roots are found by bisection
 * and Descartes' rule of signs; but roots that are 2^-1000 from each other or from 0
 * would take a thousand steps. So a leap goes down many bits at a time, to the part of an
 * interval in which the roots seem to be. It is right if that part has as many sign
 * variations as the whole: variations of the parts, and roots where they meet, add up to
 * no more than those of the whole, so all other parts have none. Bisection would come to
 * the same interval.
 *
 * Threads: one thread for one isolator. Nothing is allocated.
 * Source: Collins and Akritas 1976; Abbott: Quadratic interval refinement for real roots,
 * 2006.
 */
#ifndef ENG_ISOLATE_H
#define ENG_ISOLATE_H

#include "poly.h"

/* A leap goes down by at most so many bits. */
#define ENG_ISOLATE_STRIDE_MAX 1024ul

/* Intervals with roots, and roots, that wait: together they have no more variations than
 * the degree, and a root between two of them. */
#define ENG_ISOLATE_PENDING (2 * ENG_POLY_TERMS)

struct eng_isolate_pending {
    mpz_t num;
    unsigned long k;
    int variations;
    unsigned alone; /* halvings since the last that had roots in both halves */
    unsigned long stride;
};

struct eng_isolator {
    struct eng_poly root; /* the polynomial: of degree 1 or more, without double roots */
    struct eng_poly zoomed; /* over the interval at hand, if that has variations */
    mpz_t num;              /* the interval at hand */
    unsigned long k;
    int variations; /* in it; 0: num / 2^k is a root itself */

    /* What follows is of isolate.c. */
    unsigned alone;
    unsigned long stride;
    bool is_zoomed;       /* `zoomed` is of the earliest that waits */
    struct eng_poly base; /* over the interval that is refined */
    mpz_t at, part;
    struct eng_isolate_pending pending[ENG_ISOLATE_PENDING]; /* the earliest is last */
    int pending_count;
    unsigned long depth_max;
};

/* Reserve the numbers. root_size: of `root`. zoomed_bits: of coefficients over an
 * interval of k <= depth_max, which is the shortest that is ever gone to. */
void eng_isolate_allocate(struct eng_isolator *isolator, struct eng_limbs *limbs,
                          const struct eng_poly_size *root_size, size_t zoomed_bits,
                          unsigned long depth_max);

/* Begin with the roots of isolator->root in [0, 1]. Nothing is at hand yet. */
void eng_isolate_begin(struct eng_isolator *isolator);

/* Go to the earliest interval that waits. False: there is none. With more than one
 * variation it is to be split, or none of its roots is ever come to. */
bool eng_isolate_next(struct eng_isolator *isolator);

/* Cut the interval at hand, of more than one variation, into parts. */
void eng_isolate_split(struct eng_isolator *isolator);

/* Go from the interval at hand, of one variation, to one around the same root, by 1 to
 * `most` bits shorter. False: the root is its left end. */
bool eng_isolate_narrow(struct eng_isolator *isolator, unsigned long most);

/* Go back to interval `num`, k, of one variation, that was at hand before. */
void eng_isolate_return(struct eng_isolator *isolator, mpz_srcptr num, unsigned long k);

#endif
