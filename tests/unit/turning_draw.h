/* turning_draw.h - random motions of pairs of features, of every kind, many of which come
 * very near or touch; and where a point is, by plain long doubles. */
#ifndef TESTS_TURNING_DRAW_H
#define TESTS_TURNING_DRAW_H

#include "pccd_types.h"
#include "prng.h"

#include <stdbool.h>

#define TURNING_JOINTS_MAX 24u

/* Families of pairs, by how near they come at a time that was drawn. */
enum turning_family {
    TURNING_ANY,    /* as it happens */
    TURNING_MEETS,  /* inside each other, by much */
    TURNING_NEAR,   /* past r by 10^-1 .. 10^-12 of the size, on this side or that */
    TURNING_TOUCHES /* r, as well as doubles can tell; begins, ends or turns there */
};

enum turning_way {
    TURNING_SCREW,
    TURNING_POSES,
    TURNING_VECTOR,
    TURNING_CHAIN,
    TURNING_WAY_COUNT
};

/* A pair. A feature that hangs on no joint goes straight. */
struct turning_drawn {
    struct pccd_joint joints[TURNING_JOINTS_MAX];
    uint32_t count;
    uint32_t link[2]; /* of feature a, of feature b; PCCD_NO_JOINT */
    enum pccd_kind kind;
    uint32_t points[2];
    double x[2][4][3]; /* [end][point]: those of a, then those of b */
    double radius[3];
    double size; /* the largest length of what takes part */
    enum turning_family family;
    enum turning_way way;
};

/* Draw a pair of which at least one side turns. */
void turning_draw(struct prng *prng, struct turning_drawn *drawn);

/* Add joints of one of the ways, on joint `parent`; return the last one's number. */
uint32_t turning_draw_joints(struct prng *prng, struct turning_drawn *drawn,
                             uint32_t parent);

/* Set `place` to where point number `point` is at time t, in the world. */
void turning_place(const struct turning_drawn *drawn, uint32_t point, long double t,
                   long double place[3]);

/* Return the distance of both features at time t, by long doubles and without a bound of
 * its error. */
long double turning_distance(const struct turning_drawn *drawn, long double t);

#endif
