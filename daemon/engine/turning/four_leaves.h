/* four_leaves.h - four leaves beside one, each in a lane: which an axis keeps apart.
 *
 * All is in floats, from the origins of bodies (body_tree.h); where leaves are at two
 * times, and how far apart is enough, the caller says.
 *
 * Threads: [any].
 * Source: elementary/BOUNDS.md, "Bodies that turn".
 */
#ifndef ENG_FOUR_LEAVES_H
#define ENG_FOUR_LEAVES_H

#include <math.h>

#include "body_tree.h"

typedef eng_f4 f4;

static inline f4 all4(float x)
{
    return (f4){x, x, x, x};
}

static inline f4 abs4(f4 x)
{
    return eng_max4(x, -x);
}

static inline unsigned bits_of(eng_i4 x)
{
#ifdef __SSE__
    return (unsigned)__builtin_ia32_movmskps((f4)x);
#else
    return (x[0] & 1u) | (x[1] & 2u) | (x[2] & 4u) | (x[3] & 8u);
#endif
}

/* ---- vectors ----------------------------------------------------------------------- */

/* Squares of vectors that are less are not divided by. */
#define SQUARE_LEAST 0x1p-80f

/* Vectors, one in each of three lanes: of the corners of a leaf, or of edges that begin
 * there. The last lane has what is of no use. */
struct vectors {
    f4 x[3]; /* by axis */
};

static inline f4 dot4(const struct vectors *u, const struct vectors *v)
{
    return u->x[0] * v->x[0] + u->x[1] * v->x[1] + u->x[2] * v->x[2];
}

static inline f4 sqrt4(f4 x)
{
#ifdef __SSE__
    return __builtin_ia32_sqrtps(x);
#else
    return (f4){sqrtf(x[0]), sqrtf(x[1]), sqrtf(x[2]), sqrtf(x[3])};
#endif
}

/* Return vectors of unit length; zeros of those that are almost that. */
static inline struct vectors unit4(const struct vectors *v)
{
    struct vectors n;
    f4 square = dot4(v, v);
    eng_i4 is_known = square > all4(SQUARE_LEAST);
    f4 inverse = all4(1) / sqrt4(eng_max4(square, all4(SQUARE_LEAST)));
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        n.x[k] = (f4)((eng_i4)(v->x[k] * inverse) & is_known);
    }
    return n;
}

/* Return unit vectors across two of unit size, about; zeros where these are almost
 * parallel. */
static inline struct vectors across4(const struct vectors *u, const struct vectors *v)
{
    struct vectors n;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        n.x[k] = u->x[i] * v->x[j] - u->x[j] * v->x[i];
    }
    return unit4(&n);
}

/* ---- a leaf and four --------------------------------------------------------------- */

/* Positions of a body in its frame, and its leaves. */
struct leaf_corners {
    const double (*x)[3];
    const double *origin;
    const struct eng_face *leaves;
};

/* Load corners of a leaf into all lanes. */
static inline void load_one(const struct leaf_corners *own, uint32_t child,
                            struct vectors to[3])
{
    const uint32_t *v = own->leaves[child & ~ENG_BODY_LEAF].v;
    for (int i = 0; i < 3; i++) {
        f4 x = eng_body_place(own->x[v[i]], own->origin);
        to[i] = (struct vectors){{all4(x[0]), all4(x[1]), all4(x[2])}};
    }
}

/* Load those of the children that are leaves. */
static inline void load_four(const struct leaf_corners *own, const uint32_t children[4],
                             struct vectors to[3])
{
    f4 x[4][3] = {{{0}}};
    for (int n = 0; n < 4; n++) {
        if (children[n] != ENG_BODY_NONE && children[n] & ENG_BODY_LEAF) {
            const uint32_t *v = own->leaves[children[n] & ~ENG_BODY_LEAF].v;
            for (int i = 0; i < 3; i++) {
                x[n][i] = eng_body_place(own->x[v[i]], own->origin);
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        eng_body_transpose(x[0][i], x[1][i], x[2][i], x[3][i], to[i].x);
    }
}

/* Return unit vectors across leaves, or zeros. */
static inline struct vectors normals_of(const struct vectors x[2][3], f4 scale)
{
    struct vectors edge[2];
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            f4 from = x[0][0].x[k] + x[1][0].x[k];
            edge[i].x[k] = (x[0][i + 1].x[k] + x[1][i + 1].x[k] - from) * scale;
        }
    }
    return across4(&edge[0], &edge[1]);
}

/* Return unit vectors from the middles of some leaves to those of others, or zeros. */
static inline struct vectors ways_between(const struct vectors a[2][3],
                                          const struct vectors b[2][3], f4 scale)
{
    struct vectors way;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        f4 from = all4(0);
        f4 to = all4(0);
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) {
                from += a[end][i].x[k];
                to += b[end][i].x[k];
            }
        }
        way.x[k] = (to - from) * scale;
    }
    return unit4(&way);
}

static inline unsigned are_four_apart(const struct vectors a[2][3],
                                      const struct vectors b[2][3],
                                      const struct vectors *n, f4 margin)
{
    f4 above = all4(INFINITY);
    f4 below = all4(INFINITY);
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        f4 of_a[3];
        f4 of_b[3];
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            of_a[i] = dot4(n, &a[end][i]);
            of_b[i] = dot4(n, &b[end][i]);
        }
        above = eng_min4(above, eng_min4(eng_min4(of_b[0], of_b[1]), of_b[2]) -
                                    eng_max4(eng_max4(of_a[0], of_a[1]), of_a[2]));
        below = eng_min4(below, eng_min4(eng_min4(of_a[0], of_a[1]), of_a[2]) -
                                    eng_max4(eng_max4(of_b[0], of_b[1]), of_b[2]));
    }
    return bits_of(eng_max4(above, below) > margin);
}

#endif
