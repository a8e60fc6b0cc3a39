/* motion.h - the motion of two features over the step, as floating point with error
 * bounds.
 *
 * Give the difference vectors of a query at a time with bounds of their error, the cubic
 * in Bernstein form over a span, the region of (beta, gamma) over a short span, and the
 * description of a contact.
 *
 * Source: error bounds in BOUNDS.md.
 */
#ifndef ENG_MOTION_H
#define ENG_MOTION_H

#include <stdbool.h>

#include "query.h"

/* The difference vectors of query.h at one moment. */
struct eng_pose {
    double p[3];
    double b[3];
    double c[3];
};

struct eng_motion {
    enum pccd_kind kind;
    double p[2][3]; /* at t = 0 and 1; scaled by one power of two */
    double b[2][3];
    double c[2][3];
    double size_p; /* largest coordinate magnitude of p[0], p[1]; the same of b, c */
    double size_b;
    double size_c;
    double e_det; /* |computed - true| of det and of each Bernstein coefficient */
    double scale; /* the power of two */
};

/* The nearest points of two features at one moment: (beta, gamma) in the domain for which
 * p - beta b - gamma c is shortest. Approximate: it proposes directions and describes
 * contacts, and decides nothing. */
struct eng_closest {
    double beta, gamma; /* in the domain of the kind */
    double gap[3];      /* p - beta b - gamma c */
};

void eng_closest_to_origin(enum pccd_kind kind, const struct eng_pose *pose,
                           struct eng_closest *closest);

enum eng_domain { ENG_OUTSIDE, ENG_INSIDE, ENG_UNSURE };

void eng_motion_init(struct eng_motion *motion, const struct eng_query *query);

/* Compute the vectors at time t, 0 <= t <= 1: each coordinate within 5 u size of the true
 * one, and the differences themselves at t = 0 and 1. */
void eng_motion_pose(const struct eng_motion *motion, double t, struct eng_pose *pose);

double eng_pose_det(const struct eng_pose *pose);

/* Set f to the Bernstein coefficients of det over the span between two poses, each within
 * e_det. */
void eng_motion_bernstein(const struct eng_pose *l, const struct eng_pose *r,
                          double f[4]);

/* Return a root, 0 .. 1, of a cubic in Bernstein form with f[0], f[3] of opposite sign,
 * and set *slope to the slope there. Approximate; whoever uses it verifies. */
double eng_bernstein_root(const double f[4], double *slope);

/* Tell where (beta, gamma) lies, for every time of the span between two poses:
 * ENG_OUTSIDE means no contact at any of these times, ENG_INSIDE that b and c are
 * independent and the domain holds strictly at all of them. */
enum eng_domain eng_motion_domain(const struct eng_motion *motion,
                                  const struct eng_pose *l, const struct eng_pose *r);

/* Return whether the features certainly stay apart at all times of the span between two
 * poses, along the direction that is between them at `when`. */
bool eng_motion_separates(const struct eng_motion *motion, const struct eng_pose *l,
                          const struct eng_pose *r, const struct eng_pose *when);

/* Set (beta, gamma), inside the domain, and the normal of a contact at time t, as in
 * struct pccd_contact. f_start is det at t = 0. */
void eng_motion_describe(const struct eng_motion *motion, double t, double f_start,
                         double *beta, double *gamma, float normal[3]);

#endif
