/* test_oracle_turning.c - the oracle of features that turn: against times worked out by
 * hand, exact roots of straight motions, and plain sampling of random ones. */
#include "cases.h"
#include "oracle.h"
#include "oracle_thick.h"
#include "oracle_turning.h"
#include "oracle_turning_balls.h"
#include "turning_truth.h"

#include <float.h>

#define PI 3.14159265358979323846

static struct turning_truth find(const struct turning_drawn *drawn, double width,
                                 uint32_t fine)
{
    return turning_truth(drawn, 0, 1, 0, width, fine);
}

/* A vertex that hangs on the last joint, and a face, an edge or a vertex that stands. */
static struct turning_drawn vertex_and(enum pccd_kind kind)
{
    struct turning_drawn drawn = {.kind = kind, .link = {0, PCCD_NO_JOINT}};
    drawn.points[0] = kind == PCCD_EE ? 2 : 1;
    drawn.points[1] = kind == PCCD_VF ? 3 : kind == PCCD_VV ? 1 : 2;
    return drawn;
}

static void put(struct turning_drawn *drawn, uint32_t point, double x, double y, double z)
{
    for (int end = 0; end < 2; end++) {
        drawn->x[end][point][0] = x;
        drawn->x[end][point][1] = y;
        drawn->x[end][point][2] = z;
    }
}

static struct pccd_joint *add(struct turning_drawn *drawn, enum pccd_joint_kind kind)
{
    struct pccd_joint *joint = &drawn->joints[drawn->count];
    *joint =
        (struct pccd_joint){.kind = kind,
                            .parent = drawn->count > 0 ? drawn->count - 1 : PCCD_NO_JOINT,
                            .rotation = {0, 0, 0, 1},
                            .axis = {0, 0, 2}};
    drawn->link[0] = drawn->count++;
    return joint;
}

/* A triangle at height y = h around the y axis, large. */
static void put_wall(struct turning_drawn *drawn, double h)
{
    put(drawn, 1, -9, h, -9);
    put(drawn, 2, 9, h, -9);
    put(drawn, 3, 0, h, 9);
}

static void assert_first(const struct turning_drawn *drawn, double due)
{
    for (uint32_t fine = 0; fine < 2; fine++) {
        double width = fine ? 1e-13 : 1e-9;
        struct turning_truth answer = find(drawn, width, 400 * fine);
        if (!(answer.free_until <= due + 4e-16 && due <= answer.met_by + 4e-16 &&
              answer.met_by - answer.free_until <= width)) {
            fail_msg("%.17g is not in %.17g .. %.17g", due, answer.free_until,
                     answer.met_by);
        }
    }
}

/* If it failed, an enclosure of a sine would not hold it, or be much wider than it has
 * to be. */
CASE(turning__sines_are_enclosed)
{
    struct prng prng = {prng_seed()};
    for (int i = 0; i < 100000; i++) {
        double size = ldexp(1, (int)prng_below(&prng, 50) - 25);
        struct ball angle = {prng_between(&prng, -size, size), 0};
        struct ball sine, cosine;
        angle.m = fmin(fmax(angle.m, -6588397), 6588397);
        ball_turn(angle, &sine, &cosine);
        /* What long doubles round off, where they are longer. */
        long double slack = 0x1p-62L + (LDBL_EPSILON < 1e-18L ? 0 : 1);
        assert_true(fabsl(sine.m - sinl(angle.m)) <= sine.r + slack);
        assert_true(fabsl(cosine.m - cosl(angle.m)) <= cosine.r + slack);
        assert_true(sine.r < 4e-15 && cosine.r < 4e-15);
        angle.r = prng_between(&prng, 0, 1.5);
        double other = angle.m + angle.r * prng_between(&prng, -1, 1);
        ball_turn(angle, &sine, &cosine);
        assert_true(fabs(sine.m - sin(other)) <= sine.r + 1e-15);
        assert_true(fabs(cosine.m - cos(other)) <= cosine.r + 1e-15);
    }
}

/* If it failed, functions of the square of an angle, or their derivatives, would be out
 * of their enclosures, at 4, too, where one way to compute them ends. */
CASE(turning__functions_of_the_square_are_enclosed)
{
    struct prng prng = {prng_seed()};
    for (int i = 0; i < 20000; i++) {
        double m = i % 2 ? prng_between(&prng, 0, 9) : prng_between(&prng, 0, 1e6);
        struct ball y = {m, i % 3 ? 0 : prng_between(&prng, 0, m)};
        struct ball f[3], g[3], fh[3], gh[3];
        const double h = 1e-4 * (1 + m);
        double at = y.m + y.r * prng_between(&prng, -1, 1);
        ball_turn_of_square(y, f, g);
        ball_turn_of_square(ball_exact(at), fh, gh);
        long double z = sqrtl(at);
        long double of = z > 0 ? sinl(z) / z : 1;
        long double slack = 0x1p-51L;
        assert_true(fabsl(f[0].m - of) <= f[0].r + slack);
        of = z > 1e-6L ? 2 * sinl(z / 2) * sinl(z / 2) / at : 0.5L;
        assert_true(fabsl(g[0].m - of) <= g[0].r + 1e-12L);
        for (int k = 0; k < 3; k++) { /* the wide one holds the narrow one */
            assert_true(fabs(f[k].m - fh[k].m) <= f[k].r + fh[k].r + 1e-15);
            assert_true(fabs(g[k].m - gh[k].m) <= g[k].r + gh[k].r + 1e-15);
        }
        /* Central differences. */
        struct ball fp[3], gp[3], fm[3], gm[3];
        ball_turn_of_square(ball_exact(m + h), fp, gp);
        ball_turn_of_square(ball_exact(fmax(m - h, 0)), fm, gm);
        double by = m + h - fmax(m - h, 0);
        for (int k = 0; k < 2 && m > h; k++) {
            assert_true(fabs((fp[k].m - fm[k].m) / by - f[k + 1].m) <= f[k + 1].r + 1e-6);
            assert_true(fabs((gp[k].m - gm[k].m) / by - g[k + 1].m) <= g[k + 1].r + 1e-6);
        }
    }
}

/* sin(angle) = 1/2 at angle = pi / 6, and so on. If one failed, the joint of that kind
 * would be taken for something else. */
CASE(turning__first_times_are_those_worked_out_by_hand)
{
    struct turning_drawn drawn = vertex_and(PCCD_VF);
    struct pccd_joint *joint = add(&drawn, PCCD_JOINT_TURN);
    joint->to[0] = 2;
    put(&drawn, 0, 1, 0, 0);
    put_wall(&drawn, 0.5);
    assert_first(&drawn, PI / 12); /* a circle through a wall */

    joint->position[1] = 0.25; /* the centre is higher */
    assert_first(&drawn, asin(0.25) / 2);
    joint->position[1] = 0;
    drawn.radius[0] = 0.1; /* the first to be 0.25 from the wall */
    drawn.radius[2] = 0.15;
    assert_first(&drawn, asin(0.25) / 2);
    drawn.radius[0] = drawn.radius[2] = 0;

    joint->from[0] = -1; /* begins before */
    assert_first(&drawn, (1 + PI / 6) / 3);
    joint->from[0] = 0;
    joint->rotation[2] = joint->rotation[3] = 3; /* a quarter turn about z */
    put_wall(&drawn, -0.5); /* (cos(t + pi/2), sin(t + pi/2)): sin = -1/2 at 7 pi/6 */
    joint->to[0] = 4;
    assert_first(&drawn, (7 * PI / 6 - PI / 2) / 4);

    drawn.count = 0; /* a pendulum of two: the second turns back */
    add(&drawn, PCCD_JOINT_TURN)->to[0] = 2;
    joint = add(&drawn, PCCD_JOINT_TURN);
    joint->to[0] = -2;
    joint->position[0] = 1;
    put(&drawn, 0, 5, 0.25, 0); /* is (cos q + 5, sin q + 0.25) */
    put_wall(&drawn, 0.75);
    for (uint32_t i = 1; i <= 3; i++) {
        drawn.x[0][i][0] += 5;
    }
    assert_first(&drawn, PI / 12);

    drawn = vertex_and(PCCD_VF); /* a screw: z = 3 t, and very many turns */
    joint = add(&drawn, PCCD_JOINT_SLIDE);
    joint->to[0] = 3;
    joint = add(&drawn, PCCD_JOINT_TURN);
    joint->to[0] = 0x1p20 * 2 * PI;
    put(&drawn, 0, 1, 0, 0);
    put(&drawn, 1, -9, -9, 0.75);
    put(&drawn, 2, 9, -9, 0.75);
    put(&drawn, 3, 0, 9, 0.75);
    assert_first(&drawn, 0.25);
}

/* The same of edges, points, and rotation vectors. */
CASE(turning__first_times_of_other_kinds_are_those_worked_out_by_hand)
{
    struct turning_drawn drawn =
        vertex_and(PCCD_EE); /* an edge along z goes round, into one along x */
    add(&drawn, PCCD_JOINT_TURN)->to[0] = 2;
    put(&drawn, 0, 1, 0, -1);
    put(&drawn, 1, 1, 0, 1);
    put(&drawn, 2, -2, 0.5, 0);
    put(&drawn, 3, 2, 0.5, 0);
    assert_first(&drawn, PI / 12);

    drawn = vertex_and(PCCD_VV); /* a chord of 2 sin(q / 2) */
    add(&drawn, PCCD_JOINT_TURN)->to[0] = -2;
    drawn.joints[0].from[0] = 2;
    put(&drawn, 0, 1, 0, 0);
    put(&drawn, 1, 1, 0, 0);
    drawn.radius[1] = 1;
    assert_first(&drawn, (2 - PI / 3) / 4);

    drawn = vertex_and(PCCD_VF); /* a rotation vector along z, and its place */
    struct pccd_joint *joint = add(&drawn, PCCD_JOINT_SHIFT);
    joint->from[1] = -0.25;
    joint->to[1] = -0.25;
    joint = add(&drawn, PCCD_JOINT_VECTOR);
    joint->from[2] = -0.5;
    joint->to[2] = 2;
    put(&drawn, 0, 1, 0, 0);
    put_wall(&drawn, 0.25);
    assert_first(&drawn, (0.5 + PI / 6) / 2.5);
}

/* If it failed, what is free, meets at once, or only touches, would be told wrongly. */
CASE(turning__tells_free_and_touching)
{
    struct turning_drawn drawn = vertex_and(PCCD_VF);
    add(&drawn, PCCD_JOINT_TURN)->to[0] = 2 * PI;
    put(&drawn, 0, 1, 0, 0);
    put_wall(&drawn, 1 + 1e-9);
    assert_true(find(&drawn, 1e-6, 0).is_free);
    put_wall(&drawn, 1 + 1e-14);
    assert_true(find(&drawn, 1e-6, 400).is_free);
    put_wall(&drawn, 1 - 1e-9);
    struct turning_truth answer = find(&drawn, 1e-6, 400);
    assert_true(!answer.is_free && answer.met_by < 0.25 && answer.free_until > 0.24999);
    put_wall(&drawn, 1); /* touches at a quarter turn: nobody knows */
    answer = find(&drawn, 1e-6, 400);
    assert_true(!answer.is_free && answer.met_by == ORACLE_TURNING_NEVER);
    assert_true(answer.free_until < 0.25 && answer.free_until > 0.2499);
    put_wall(&drawn, 0.25);
    drawn.radius[0] = 0.5;
    answer = find(&drawn, 1e-6, 0);
    assert_true(answer.met_by == 0 && answer.free_until == 0);

    /* What both hang on moves neither. */
    drawn = vertex_and(PCCD_VV);
    add(&drawn, PCCD_JOINT_TURN)->to[0] = 1e6;
    drawn.link[1] = 0;
    put(&drawn, 0, 1, 0, 0);
    put(&drawn, 1, 1 + 0x1p-40, 0, 0);
    answer = find(&drawn, 1e-6, 0);
    assert_true(answer.is_free && answer.spans <= 2);
}

/* If it failed, straight motions would not be what exact roots say, whether a joint moves
 * them or the points themselves go. */
CASE(turning__of_straight_motions_is_what_roots_say)
{
    struct prng prng = {prng_seed()};
    int hits = 0, unknown = 0;
    for (int i = 0; i < 3000; i++) {
        struct turning_drawn drawn;
        double p[8][3];
        double shift[3];
        turning_draw(&prng, &drawn);
        drawn.count = 1;
        drawn.joints[0] = (struct pccd_joint){
            .kind = PCCD_JOINT_SHIFT, .parent = PCCD_NO_JOINT, .rotation = {0, 0, 0, 1}};
        drawn.link[0] = drawn.link[1] = PCCD_NO_JOINT;
        for (int k = 0; k < 24; k++) {
            drawn.x[k / 12][k % 12 / 3][k % 3] = prng_integer(&prng, 8);
        }
        for (int k = 0; k < 3; k++) {
            shift[k] = drawn.joints[0].to[k] = prng_integer(&prng, 8);
            drawn.radius[k] = drawn.radius[k] > 0 ? 0.5 : 0;
        }
        memcpy(p, drawn.x, sizeof p);
        if (i % 2) { /* the first feature does not deform, and is moved by the joint */
            drawn.link[0] = 0;
            memcpy(drawn.x[1], drawn.x[0], drawn.points[0] * sizeof drawn.x[0][0]);
            for (uint32_t k = 0; k < 3 * drawn.points[0]; k++) {
                p[4 + k / 3][k % 3] = p[k / 3][k % 3] + shift[k % 3];
            }
        }
        const struct oracle_thick thick = {
            .points_a = (int)drawn.points[0],
            .points_b = (int)drawn.points[1],
            .p = (const double(*)[3])p,
            .radius = {drawn.radius[0], drawn.radius[1], drawn.radius[2]}};
        struct oracle_first *first = oracle_thick_first_new(&thick);
        struct turning_truth answer = find(&drawn, 1e-6, 100);
        hits += first != NULL;
        unknown += !answer.is_free && answer.met_by == ORACLE_TURNING_NEVER;
        if (first == NULL) {
            assert_true(answer.met_by == ORACLE_TURNING_NEVER);
        } else {
            assert_false(answer.is_free);
            assert_true(oracle_first_compare(first, answer.free_until) >= 0);
            assert_true(oracle_first_compare(first, answer.met_by) <= 0);
        }
        oracle_first_free(first);
    }
    print_message("%d of 3000 meet, of %d it could not tell\n", hits, unknown);
    assert_in_range(hits, 300, 2700);
    assert_in_range(unknown, 0, 300); /* small whole numbers touch often */
}

/* If it failed, the oracle would contradict where points plainly are. */
CASE(turning__of_random_motions_is_what_samples_say)
{
    struct prng prng = {prng_seed() + 5};
    int hits[2] = {0}, unknown = 0;
    for (int i = 0; i < 2000; i++) {
        struct turning_drawn drawn;
        turning_draw(&prng, &drawn);
        struct turning_truth answer = find(&drawn, 1e-6, 100);
        double r = drawn.radius[0] + drawn.radius[1] + drawn.radius[2];
        double slack = 1e-8 * drawn.size;
        bool meets = answer.met_by <= 1;
        for (int k = 0; k <= 32 && (answer.is_free || answer.free_until > 0); k++) {
            double t = (answer.is_free ? 1 : answer.free_until) * k / 32;
            assert_true(turning_distance(&drawn, t) > r - slack);
        }
        if (meets && r > 0) { /* else it has met before, and may be far by now */
            assert_true(turning_distance(&drawn, answer.met_by) <= r + slack);
        }
        hits[drawn.family == TURNING_MEETS] += meets;
        unknown += !meets && !answer.is_free;
    }
    print_message("meet: %d and %d of those that are brought together; of %d it could "
                  "not tell\n",
                  hits[0], hits[1], unknown);
    assert_in_range(hits[1], 500, 2000);
    assert_in_range(unknown, 0, 20);
}
