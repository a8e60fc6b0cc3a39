/* test_eng_rounding.c - how much an object that two poses move shrinks between them, and
 * how far rounding takes its vertices.
 *
 * Source: daemon/engine/elementary/BOUNDS.md, "Objects that move by poses".
 */
#include "eng_kit.h"

#include <float.h>

#include "coordinates.h"
#include "rigid.h"

#define PI 3.14159265358979323846

static void unit(struct prng *random, double v[3])
{
    double length;
    do {
        for (int k = 0; k < 3; k++) {
            v[k] = prng_between(random, -1, 1);
        }
        length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    } while (length < 0.1 || length > 1);
    for (int k = 0; k < 3; k++) {
        v[k] /= length;
    }
}

/* A turn about an axis, after what m was. */
static void turn(double m[12], const double axis[3], double angle)
{
    double before[12];
    memcpy(before, m, sizeof before);
    for (int column = 0; column < 3; column++) {
        double v[3] = {before[column], before[4 + column], before[8 + column]};
        double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3;
            int b = (k + 2) % 3;
            double cross = axis[a] * v[b] - axis[b] * v[a];
            m[4 * k + column] = v[k] * cos(angle) + cross * sin(angle) +
                                axis[k] * along * (1 - cos(angle));
        }
    }
}

static void identity(double m[12])
{
    for (int i = 0; i < 12; i++) {
        m[i] = i % 5 == 0;
    }
}

enum family { TURNS, SCALES, SHEARS, ANYTHING, FLAT, FAMILIES };

static void some_poses(struct prng *random, enum family family, double m0[12],
                       double m1[12])
{
    double axis[3];
    identity(m0);
    unit(random, axis);
    turn(m0, axis, prng_between(random, -PI, PI));
    double all = exp2(prng_integer(random, 30));
    for (int i = 0; family == SCALES && i < 3; i++) {
        double scale = all * exp2(prng_integer(random, 1));
        for (int k = 0; k < 3; k++) {
            m0[4 * k + i] *= scale;
        }
    }
    for (int k = 0; family == SHEARS && k < 3; k++) {
        m0[4 * k + 1] += prng_between(random, -1, 1) * m0[4 * k];
    }
    memcpy(m1, m0, 12 * sizeof *m1);
    unit(random, axis);
    turn(m1, axis, PI / 180 * prng_between(random, 0, 179.9));
    for (int i = 0; family >= ANYTHING && i < 12; i++) {
        m0[i] = (i % 5 == 0) + prng_between(random, -0.5, 0.5);
        m1[i] = m0[i] + prng_between(random, -1, 1) * exp2(-(double)prng_u32(random, 20));
    }
    for (int k = 0; family == FLAT && k < 3; k++) {
        m1[4 * k + 2] = m1[4 * k]; /* two columns are one */
    }
    for (int k = 0; k < 3; k++) {
        m0[4 * k + 3] = prng_between(random, -1e3, 1e3);
        m1[4 * k + 3] = prng_between(random, -1e9, 1e9);
    }
}

/* Return what is left of a vector's length at a time. */
static long double left_of(const double m0[12], const double m1[12], const double v[3],
                           double t)
{
    long double square = 0;
    for (int k = 0; k < 3; k++) {
        long double sum = 0;
        for (int i = 0; i < 3; i++) {
            long double a = m0[4 * k + i];
            long double b = m1[4 * k + i];
            sum += (a + (b - a) * (long double)t) * (long double)v[i];
        }
        square += sum * sum;
    }
    return sqrtl(square);
}

/* Downhill from a random direction and time: near the least that is left. */
static long double least_left(struct prng *random, const double m0[12],
                              const double m1[12])
{
    double v[3];
    double t = prng_between(random, 0, 1);
    unit(random, v);
    long double least = left_of(m0, m1, v, t);
    for (double size = 1; size > 1e-5; size *= 0.9) {
        for (int i = 0; i < 6; i++) {
            double w[3];
            double s = t + prng_between(random, -size, size);
            double length = 0;
            for (int k = 0; k < 3; k++) {
                w[k] = v[k] + prng_between(random, -size, size);
                length += w[k] * w[k];
            }
            for (int k = 0; k < 3; k++) {
                w[k] /= sqrt(length);
            }
            s = s < 0 ? 0 : s > 1 ? 1 : s;
            long double left = left_of(m0, m1, w, s);
            if (left < least) {
                least = left;
                t = s;
                memcpy(v, w, sizeof v);
            }
        }
    }
    return least;
}

/* If this failed, an object that turns, or is pressed together, could meet itself and not
 * be tested. */
CASE(rounding__no_length_shrinks_more_than_is_said)
{
    struct prng random = {11};
    uint32_t certain[FAMILIES] = {0};
    for (uint32_t i = 0; i < 4000; i++) {
        enum family family = (enum family)(i % FAMILIES);
        double m0[12];
        double m1[12];
        some_poses(&random, family, m0, m1);
        double shrink = eng_pose_shrink(m0, m1);
        long double least = least_left(&random, m0, m1);
        assert_true(shrink >= 0);
        assert_true((long double)shrink <= least * (1 + 1e-15L));
        certain[family] += shrink > 0;
    }
    print_message("# certain of 800 each: %u turns, %u scales, %u shears, %u others\n",
                  certain[TURNS], certain[SCALES], certain[SHEARS], certain[ANYTHING]);
    assert_true(certain[TURNS] > 500 && certain[SCALES] > 200 && certain[SHEARS] > 50);
    assert_true(certain[ANYTHING] > 0 && certain[FLAT] == 0);
}

/* If this failed, more would be tested than need be: bodies turn in a step, about any
 * axis. */
CASE(rounding__turns_are_bounded_tightly)
{
    struct prng random = {12};
    for (uint32_t i = 0; i < 2000; i++) {
        double angle = PI / 180 * prng_between(&random, 0, 179.9);
        double axis[3];
        double m0[12];
        double m1[12];
        unit(&random, axis);
        identity(m0);
        turn(m0, axis, prng_between(&random, -PI, PI));
        memcpy(m1, m0, sizeof m1);
        unit(&random, axis);
        turn(m1, axis, angle);
        assert_true(eng_pose_shrink(m0, m1) > 0.6 * cos(angle / 2) - 0.003);
        axis[0] = axis[1] = 0; /* about an axis of the mesh: as it is */
        axis[2] = 1;
        identity(m0);
        identity(m1);
        turn(m1, axis, angle);
        assert_true(fabs(eng_pose_shrink(m0, m1) - cos(angle / 2)) < 1e-3);
    }
}

/* If this failed, an object that passes through itself could be taken for one that does
 * not: half a turn takes every point through the axis. */
CASE(rounding__says_nothing_of_half_a_turn_and_of_mirrors)
{
    struct prng random = {13};
    const struct eng_bounds bounds = {{0, 0, 0}, {1, 1, 1}};
    for (uint32_t i = 0; i < 1000; i++) {
        double axis[3] = {0, 0, 0};
        double m0[12];
        double m1[12];
        identity(m0);
        identity(m1);
        if (i % 2) {
            unit(&random, axis);
        } else {
            axis[i / 2 % 3] = 1;
        }
        turn(m1, axis, PI);
        assert_true(eng_pose_shrink(m0, m1) == 0);
        assert_true(isinf(eng_rounding_reach(m0, m1, &bounds)));
        for (int k = 0; k < 12; k++) { /* inside out */
            m1[k] = -m0[k];
        }
        assert_true(eng_pose_shrink(m0, m1) == 0);
        memset(m1, 0, sizeof m1);
        assert_true(eng_pose_shrink(m1, m1) == 0 && eng_pose_shrink(m0, m1) == 0);
    }
}

/* If this failed, rounding could bring together what is taken for apart; or, if it were
 * vacuous, bodies a kilometre away would be tested against themselves. */
CASE(rounding__vertices_are_no_farther_off_than_is_said)
{
    struct prng random = {14};
    long double worst = 0;
    assert_true(LDBL_MANT_DIG >= 64);
    for (uint32_t i = 0; i < 300000; i++) {
        double m[12];
        double x[3];
        double y[3];
        double size = exp2(prng_integer(&random, i % 50));
        struct eng_bounds bounds;
        for (int k = 0; k < 12; k++) {
            m[k] = prng_between(&random, -1, 1) * exp2(prng_integer(&random, i % 7));
        }
        for (int k = 0; k < 3; k++) {
            x[k] = prng_between(&random, -size, size);
            bounds.low[k] = fmin(x[k], 0.5 * x[k]);
            bounds.high[k] = fmax(x[k], 0.5 * x[k]);
        }
        double error = eng_rounding_error(m, &bounds);
        common_transform(m, x, y);
        long double square = 0;
        for (int row = 0; row < 3; row++) {
            const double *r = m + 4 * row;
            long double exact = (long double)r[0] * (long double)x[0] +
                                (long double)r[1] * (long double)x[1] +
                                (long double)r[2] * (long double)x[2] + (long double)r[3];
            square += ((long double)y[row] - exact) * ((long double)y[row] - exact);
        }
        /* Eleven bits more show an error of a hundredth of what is allowed. */
        assert_true(sqrtl(square) <= (long double)error);
        worst = fmaxl(worst, sqrtl(square) / (long double)error);
    }
    assert_true(worst > 0.05L);
}

/* If this failed, a mesh of a millimetre that is taken 1e9 m away would be trusted, all
 * of whose vertices may fall on one point there. */
CASE(rounding__grows_with_the_distance)
{
    const struct eng_bounds bounds = {{-1e-3, -1e-3, -1e-3}, {1e-3, 1e-3, 1e-3}};
    double near[12];
    double far[12];
    identity(near);
    identity(far);
    far[3] = 1e9;
    assert_true(eng_rounding_reach(near, near, &bounds) < 1e-17);
    assert_true(eng_rounding_reach(near, far, &bounds) > 1e-7);
    assert_true(eng_rounding_reach(far, far, &bounds) < 1e-5);
    far[3] = 0;
    far[5] = 0x1p-40; /* almost flat: what it does not shrink by rounding may close */
    assert_true(eng_rounding_reach(far, far, &bounds) >
                0x1p39 * eng_rounding_reach(near, near, &bounds));
}
