/* oracle.h - the exact answer to one elementary test: does a vertex meet a triangle, or
 * an edge an edge, and when?
 *
 * Threads: [any]; no global state.
 */
#ifndef ORACLE_ORACLE_H
#define ORACLE_ORACLE_H

#include <gmp.h>
#include <stdbool.h>

enum oracle_kind { ORACLE_VF = 0, ORACLE_EE = 1 };

/* Everywhere p[0..3] are the points at t = 0 and p[4..7] the same points at t = 1,
 * finite. VF: the vertex, then the triangle's corners. EE: both ends of one edge, then of
 * the other. */

bool oracle_vf(const double p[8][3]);
bool oracle_ee(const double p[8][3]);
bool oracle_hits(enum oracle_kind kind, const double p[8][3]);

/* Return whether they touch at t = 0 or at t = 1. */
bool oracle_touching_at(enum oracle_kind kind, const double p[8][3], int t);

/* Return whether there is a contact at some t with lo <= t <= hi. Any rational lo <= hi:
 * outside [0, 1] the motion goes on. Decided on the motion between the positions at lo
 * and hi, not through the first contact. */
bool oracle_contact_in(enum oracle_kind kind, const double p[8][3], const mpq_t lo,
                       const mpq_t hi);

struct oracle_first;
/* Find the time of the first contact, an algebraic number. NULL: there is none. Freed by
 * the caller. */
struct oracle_first *oracle_first_new(enum oracle_kind kind, const double p[8][3]);
void oracle_first_free(struct oracle_first *first); /* NULL is allowed */

/* Return the sign of the first contact time minus t. */
int oracle_first_compare(struct oracle_first *first, double t);

/* Find lo <= first contact time <= hi, hi - lo <= 2^-bits. */
void oracle_first_bracket(struct oracle_first *first, unsigned bits, mpq_t lo, mpq_t hi);

/* Find such lo and hi, hi - lo <= width, in one call; width is above 0. False: there is
 * no contact. */
bool oracle_first_contact(enum oracle_kind kind, const double p[8][3], double width,
                          mpq_t lo, mpq_t hi);

#endif
