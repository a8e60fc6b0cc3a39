/* touching.h - how a few points lie just after t = 0, exactly.
 *
 * Everything here is the sign of a polynomial in time, at t = 0 or *just after*: that
 * which it has on (0, e] for some e > 0, the sign of its first coefficient that is not 0.
 * narrow_touching.c tells by these whether features that touch enter each other.
 *
 * Threads: one thread for one scratch. Nothing is allocated after init.
 * Source: BOUNDS.md, "Features that touch".
 */
#ifndef ENG_TOUCHING_H
#define ENG_TOUCHING_H

#include "kernel.h"
#include "poly.h"

#define ENG_TOUCHING_POINTS 6

struct eng_touching {
    mpz_t x[2][ENG_TOUCHING_POINTS][3];  /* at t = 0 and 1, scaled to integers */
    struct eng_poly p[3], b[3], c[3];    /* differences */
    struct eng_poly n[3], side[3], work; /* products of two */
    struct eng_poly det;
    mpz_t d[4], minor;
    mp_limb_t *block;
};

/* Allocate the block. PCCD_E_NOMEM: there is nothing to deinit. */
int eng_touching_init(struct eng_touching *touching);
void eng_touching_deinit(struct eng_touching *touching);
size_t eng_touching_bytes(void);

/* A sign: -1, 0 or 1; `next` is 0 where it is 0 all the time. */
struct eng_signs {
    int now; /* t = 0 */
    int next;
};

/* Return the side of the plane through f[3] that a point is on; 1: where the corners go
 * round anticlockwise, the front. */
struct eng_signs eng_touching_side(struct eng_touching *touching,
                                   const struct eng_point *const f[3],
                                   const struct eng_point *point);

/* Return the signs of det[e0[1] - e0[0], e1[1] - e1[0], to - from]: for edges e0 and e1
 * that cross, where `to` is, seen from `from`, along their common normal. */
struct eng_signs eng_touching_along(struct eng_touching *touching,
                                    const struct eng_point *const e0[2],
                                    const struct eng_point *const e1[2],
                                    const struct eng_point *from,
                                    const struct eng_point *to);

/* Return whether the edge e, on whose ends f's plane has the sides ends[2] just after,
 * passes strictly through the inside of f then. */
bool eng_touching_passes(struct eng_touching *touching,
                         const struct eng_point *const e[2],
                         const struct eng_point *const f[3], const int ends[2]);

/* The first axis along which a vector is not 0, and its sign there. */
struct eng_axis {
    int axis;
    int sign;
};
/* Find that of (e0[1] - e0[0]) x (e1[1] - e1[0]) at t = 0. False: it is 0. */
bool eng_touching_normal(struct eng_touching *touching,
                         const struct eng_point *const e0[2],
                         const struct eng_point *const e1[2], struct eng_axis *normal);

/* Return whether the insides of two triangles in one plane, of which these are normals,
 * have a point in common at t = 0. */
bool eng_touching_overlaps(struct eng_touching *touching,
                           const struct eng_point *const f[3],
                           const struct eng_point *const g[3], const struct eng_axis *nf,
                           const struct eng_axis *ng);

/* Return whether a vertex that stays in the plane of a face is on it just after t = 0;
 * then on_side[k]: on the side from corner k to corner k + 1. */
bool eng_touching_vf(struct eng_touching *touching,
                     const struct eng_point *const points[4], bool on_side[3]);

/* The way in which two edges touch then that stay in one plane. */
enum eng_touch {
    ENG_TOUCH_NOT,
    ENG_TOUCH_INSIDE, /* neither in an end */
    ENG_TOUCH_ENDS    /* in an end of one, or along a line */
};
enum eng_touch eng_touching_ee(struct eng_touching *touching,
                               const struct eng_point *const points[4]);

#endif
