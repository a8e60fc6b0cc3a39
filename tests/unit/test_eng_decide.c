/* test_eng_decide.c - pairs of features of which one turns: motions with answers known by
 * hand, and random ones beside where their points are at many times. */
#include "eng_kit.h"

#include <math.h>
#include <string.h>

#include "decide.h"
#include "kinds.h"
#include "path.h"

#define TOLERANCE 1e-6
#define DELTA     0x1p-20

/* The usual limits. */
static struct eng_turning_limits limits_of(double tolerance)
{
    return (struct eng_turning_limits){
        .delta = DELTA, .tolerance = tolerance, .t_end = 1, .looks_max = 65536};
}

/* A turn about z. */
static struct pccd_joint turn_of(double from, double to)
{
    return (struct pccd_joint){.kind = PCCD_JOINT_TURN,
                               .parent = PCCD_NO_JOINT,
                               .rotation = {0, 0, 0, 1},
                               .axis = {0, 0, 1},
                               .from = {from},
                               .to = {to}};
}

static struct eng_turning_answer answer;

static enum eng_turning_verdict decide_chain(const struct pccd_joint *joints,
                                             uint32_t count,
                                             const struct eng_turning_pair *pair,
                                             const struct eng_turning_limits *limits)
{
    static struct eng_path path;
    static struct eng_poses poses;
    uint32_t fault;
    const char *why;
    assert_true(eng_joints_check(joints, count, &fault, &why));
    assert_int_equal(eng_path_between(joints, PCCD_NO_JOINT, count - 1, &path), PCCD_OK);
    eng_poses_begin(&poses, &path);
    return eng_turning_decide(&poses, pair, limits, &answer);
}

static enum eng_turning_verdict
decide_turn(double from, double to, const struct eng_turning_pair *pair, double tolerance)
{
    const struct pccd_joint joint = turn_of(from, to);
    const struct eng_turning_limits limits = limits_of(tolerance);
    return decide_chain(&joint, 1, pair, &limits);
}

/* A pair by the points of a and of b, at rest; `turning` side turns. */
static struct eng_turning_pair pair_of(enum pccd_kind kind, uint32_t turning,
                                       const double (*a)[3], const double (*b)[3],
                                       double radius)
{
    struct eng_turning_pair pair = {
        .kind = kind, .turning = turning, .radius = {0, 0, radius}};
    const uint32_t *points = common_kinds[kind].points;
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t last = points[0] + points[1] - 1;
        uint32_t at = i < last ? i : last;
        memcpy(pair.x[0][i], at < points[0] ? a[at] : b[at - points[0]],
               sizeof pair.x[0][i]);
        memcpy(pair.x[1][i], pair.x[0][i], sizeof pair.x[1][i]);
    }
    return pair;
}

/* A face that stands on the z axis's side, at an angle about it. */
static void stand_wall(double angle, double (*face)[3])
{
    const double x = cos(angle), y = sin(angle);
    const double corners[3][3] = {
        {0.5 * x, 0.5 * y, -1}, {3 * x, 3 * y, -1}, {0.5 * x, 0.5 * y, 2}};
    memcpy(face, corners, sizeof corners);
}

static void expect_proved(double due, double tolerance)
{
    assert_int_equal(answer.hit.flags, PCCD_PROVED);
    if (!(answer.hit.toi <= due && due <= answer.hit.toi_hi &&
          answer.hit.toi_hi - answer.hit.toi <= tolerance)) {
        fail_msg("%.17g: %.17g .. %.17g", due, answer.hit.toi, answer.hit.toi_hi);
    }
}

static const double on_x[1][3] = {{1, 0, 0}};

/* If it failed: hits of turning bodies would be missed or told at other times. */
CASE(decide__vertex_on_a_circle_meets_a_wall_when_it_does)
{
    static const double angles[] = {0.5, 1, 1.5, 2.75, 0.015625};
    static const double tolerances[] = {1e-3, 1e-6, 1e-12};
    for (int n = 0; n < 15; n++) {
        double angle = angles[n / 3], end = 3, face[3][3];
        double tolerance = tolerances[n % 3];
        stand_wall(angle, face);
        struct eng_turning_pair pair =
            pair_of(PCCD_VF, 0, on_x, (const double(*)[3])face, 0);
        assert_int_equal(decide_turn(0, end, &pair, tolerance), ENG_TURNING_MEETS);
        double due = atan2(face[1][1], face[1][0]) / end;
        expect_proved(due, tolerance);
        /* No look is lost on the last digits of the time. */
        assert_true(answer.looks <= (angle < 1 ? 6 : 10));
        /* The face is left behind at its clockwise side. */
        assert_true(fabs((double)answer.hit.normal[0] - sin(angle)) < 1e-6);
        assert_true(fabs((double)answer.hit.normal[1] + cos(angle)) < 1e-6);
        assert_true(fabs((double)answer.hit.param[0] - 0.2) < 1e-2);
        assert_true(fabs((double)answer.hit.param[1] - 1.0 / 3) < 1e-2);
    }
}

/* If it failed: a motion of many turns would be taken for its first and last pose. */
CASE(decide__many_turns_meet_in_their_first_one)
{
    static const double turns[] = {1, 50, 1000, 0x1p20};
    double face[3][3];
    stand_wall(2, face);
    for (int n = 0; n < 4; n++) {
        double end = 6.28125 * turns[n];
        struct eng_turning_pair pair =
            pair_of(PCCD_VF, 0, on_x, (const double(*)[3])face, 0);
        double due = atan2(face[1][1], face[1][0]) / end;
        assert_int_equal(decide_turn(0, end, &pair, 1e-12), ENG_TURNING_MEETS);
        expect_proved(due, 1e-12);
        /* An edge, swung through another. */
        const double swung[2][3] = {{0.5, 0, 0.25}, {2, 0, 0.5}};
        const double standing[2][3] = {{face[1][0], face[1][1], -1},
                                       {face[1][0] / 2, face[1][1] / 2, 1}};
        pair = pair_of(PCCD_EE, 1, standing, swung, 0);
        assert_int_equal(decide_turn(0, end, &pair, 1e-12), ENG_TURNING_MEETS);
        expect_proved(due, 1e-12);
    }
}

/* If it failed: what passes by would be a hit, or what grazes free; or touching, which
 * nobody can decide, would be called proved, or take longer than is allowed. */
CASE(decide__grazing_is_free_proved_or_possible)
{
    static const double beyond[] = {0x1p-10, 0x1p-30, 0, -0x1p-10, -0x1p-30};
    for (int n = 0; n < 5; n++) {
        double x = 1 + beyond[n];
        const double face[3][3] = {{x, -3, -3}, {x, 3, -3}, {x, 0, 3}};
        struct eng_turning_pair pair = pair_of(PCCD_VF, 0, on_x, face, 0);
        enum eng_turning_verdict verdict = decide_turn(-0.5, 0.75, &pair, TOLERANCE);
        assert_true(answer.looks < 400);
        if (beyond[n] > 0) {
            assert_int_equal(verdict, ENG_TURNING_FREE);
            assert_true(answer.free_until == 1);
            continue;
        }
        assert_int_equal(verdict, ENG_TURNING_MEETS);
        if (beyond[n] < 0) {
            expect_proved((0.5 - acos(x)) / 1.25, TOLERANCE);
            continue;
        }
        assert_int_equal(answer.hit.flags, 0);
        assert_true(answer.hit.toi < 0.4 && answer.hit.toi_hi > 0.4 - 1e-5);
        assert_true(answer.hit.toi_hi - answer.hit.toi <= TOLERANCE);
    }
}

/* If it failed: a chord that passes through would be taken for its curve, which passes
 * beside. */
CASE(decide__curves_pass_beside_what_their_chords_pass_through)
{
    static const double borders[] = {0.93, 0.95, 0.97, 0.99, 1.01};
    for (int n = 0; n < 20; n++) {
        double border = borders[n % 5];
        const double face[3][3] = {{-3, 0, -3}, {border, 0, -3}, {border, 0, 5}};
        const double edge[2][3] = {{0, 0, 0}, {border, 0, 0}};
        const double upright[2][3] = {{1, 0, -1}, {1, 0, 1}};
        struct eng_turning_pair pair = n < 10 ? pair_of(PCCD_VF, 0, on_x, face, 0)
                                              : pair_of(PCCD_EE, 0, upright, edge, 0);
        double tolerance = n / 5 % 2 ? 1 : 0.1;
        enum eng_turning_verdict verdict = decide_turn(-0.5, 0.5, &pair, tolerance);
        if (border < 1) {
            assert_int_equal(verdict, ENG_TURNING_FREE);
        } else {
            assert_int_equal(verdict, ENG_TURNING_MEETS);
            expect_proved(0.5, tolerance);
        }
    }
}

/* If it failed: radii would count for nothing, or not all of them; a pair that begins
 * within them would be told late. */
CASE(decide__thick_features_meet_at_their_distance)
{
    static const double tolerances[] = {1e-3, 1e-12};
    for (int n = 0; n < 2; n++) {
        const double other[1][3] = {{cos(1), sin(1), 0}};
        struct eng_turning_pair pair = pair_of(PCCD_VV, 0, on_x, other, 0.125);
        pair.radius[0] = 0.25;
        pair.radius[1] = 0.0625;
        assert_int_equal(decide_turn(0, 2, &pair, tolerances[n]), ENG_TURNING_MEETS);
        expect_proved((1 - 2 * asin(0.4375 / 2)) / 2, tolerances[n]);
        double toi = answer.hit.toi;
        /* Not before it begins, and not at all with a little less. */
        struct eng_turning_limits limits = limits_of(tolerances[n]);
        const struct pccd_joint joint = turn_of(0, 2);
        limits.t_end = nextafter(toi, 0);
        assert_int_equal(decide_chain(&joint, 1, &pair, &limits), ENG_TURNING_FREE);
        assert_true(answer.free_until > limits.t_end);
        limits.t_end = toi;
        assert_int_equal(decide_chain(&joint, 1, &pair, &limits), ENG_TURNING_MEETS);
        assert_true(answer.hit.toi == toi);
        assert_int_equal(decide_turn(0, 0.5, &pair, tolerances[n]), ENG_TURNING_FREE);
        pair.radius[0] = 1;
        assert_int_equal(decide_turn(0, 2, &pair, tolerances[n]), ENG_TURNING_MEETS);
        assert_int_equal(answer.hit.flags, PCCD_PROVED | PCCD_INITIAL);
        assert_true(answer.hit.toi == 0 && answer.hit.toi_hi == 0);
    }
}

/* If it failed: a body that turns and begins within its distance would be stopped at
 * once, or come nearer than what it may; or nobody would be told that it began there. */
CASE(decide__what_begins_inside_comes_nearer_by_its_part)
{
    double face[3][3];
    stand_wall(0.5, face);
    for (int n = 0; n < 4; n++) {
        /* At the angle a the vertex is sin(0.5 - a) from the wall. */
        const double r = n == 1 ? 0.3 : n == 2 ? sin(0.5) : 0.6, s = 0.5;
        const struct pccd_joint joint = turn_of(0, n == 3 ? -1 : 1);
        const struct eng_turning_pair pair =
            pair_of(PCCD_VF, 0, on_x, (const double(*)[3])face, r);
        struct eng_turning_limits limits = limits_of(TOLERANCE);
        limits.approach = s;
        enum eng_turning_verdict verdict = decide_chain(&joint, 1, &pair, &limits);
        assert_int_equal(verdict, n == 3 ? ENG_TURNING_FREE : ENG_TURNING_MEETS);
        if (n < 2) { /* 2: it begins at r, as well as doubles can tell */
            const double due = 0.5 - asin(n == 0 ? s * sin(0.5) : r);
            answer.hit.flags ^= n == 0 ? PCCD_INSIDE : 0;
            expect_proved(due, TOLERANCE);
        }
        assert_true(n != 2 || (answer.hit.flags == 0 && answer.hit.toi == 0));
    }
}

/* If it failed: answers would depend on which of two bodies is taken for the one that
 * turns, on the order of edges, or on what goes straight meanwhile. */
CASE(decide__sides_and_orders_agree)
{
    double face[3][3], back[3][3];
    stand_wall(1, face);
    /* The face turns towards the vertex. */
    for (int i = 0; i < 3; i++) {
        back[i][0] = cos(1) * face[i][0] + sin(1) * face[i][1];
        back[i][1] = sin(1) * face[i][0] - cos(1) * face[i][1];
        back[i][2] = face[i][2];
    }
    const double ahead[1][3] = {{cos(0.5), sin(0.5), 0}};
    struct eng_turning_pair pair =
        pair_of(PCCD_VF, 1, ahead, (const double(*)[3])back, 0);
    assert_int_equal(decide_turn(0, 2, &pair, 1e-9), ENG_TURNING_MEETS);
    double due = (0.5 - atan2(back[1][1], back[1][0])) / 2;
    expect_proved(due, 1e-9);

    const double swung[2][3] = {{0.5, 0, 0.25}, {2, 0, 0.5}};
    const double standing[2][3] = {{face[1][0], face[1][1], -1},
                                   {face[1][0] / 2, face[1][1] / 2, 1}};
    struct eng_turning_answer first;
    pair = pair_of(PCCD_EE, 0, swung, standing, 0);
    assert_int_equal(decide_turn(0, 2, &pair, TOLERANCE), ENG_TURNING_MEETS);
    first = answer;
    pair = pair_of(PCCD_EE, 1, standing, swung, 0);
    assert_int_equal(decide_turn(0, 2, &pair, TOLERANCE), ENG_TURNING_MEETS);
    assert_true(answer.hit.toi == first.hit.toi && answer.hit.toi_hi == first.hit.toi_hi);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs((double)answer.hit.normal[k] + (double)first.hit.normal[k]) <
                    1e-6);
    }
    assert_true(fabs((double)answer.hit.param[0] - (double)first.hit.param[1]) < 1e-6);

    /* The wall comes: its plane y = 1 - t, the vertex is at sin 2 t. */
    pair = pair_of(PCCD_VF, 0, on_x,
                   (const double[3][3]){{-9, 1, -9}, {9, 1, -9}, {0, 1, 9}}, 0);
    for (int i = 1; i < 4; i++) {
        pair.x[1][i][1] = 0;
    }
    assert_int_equal(decide_turn(0, 2, &pair, 1e-12), ENG_TURNING_MEETS);
    double t = 0.3;
    for (int i = 0; i < 60; i++) {
        t -= (sin(2 * t) + t - 1) / (2 * cos(2 * t) + 1);
    }
    expect_proved(t, 1e-12);
}

static bool stop_at_once(void *owner)
{
    ++*(uint32_t *)owner;
    return true;
}

/* If it failed: nobody could stop a pair that is near all the time, or it would be told
 * free. */
CASE(decide__work_is_bounded)
{
    /* A vertex goes round a wheel's rim, at a distance that only many chords show. */
    const double spoke[2][3] = {{1 + 0x1p-19, 0, -1}, {1 + 0x1p-19, 0, 1}};
    struct eng_turning_pair pair = pair_of(PCCD_VE, 0, on_x, spoke, 0x1p-22);
    struct eng_turning_limits limits = limits_of(TOLERANCE);
    const struct pccd_joint joint = turn_of(1, 1 + 0x1p20);
    uint32_t asked = 0;
    limits.looks_max = 5000;
    assert_int_equal(decide_chain(&joint, 1, &pair, &limits), ENG_TURNING_LIMIT);
    assert_true(answer.looks == 5000 && answer.free_until > 0 && answer.free_until < 1);
    limits.should_stop = stop_at_once;
    limits.owner = &asked;
    assert_int_equal(decide_chain(&joint, 1, &pair, &limits), ENG_TURNING_STOPPED);
    assert_true(asked == 1 && answer.looks < 64);
    /* A face that turns in its own plane, on another one's vertex. */
    const double flat[3][3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    pair = pair_of(PCCD_VF, 1, (const double[1][3]){{0, 0, 0}}, flat, 0);
    assert_int_equal(decide_turn(0, 6, &pair, TOLERANCE), ENG_TURNING_MEETS);
    assert_true(answer.hit.flags == 0 && answer.hit.toi == 0 && answer.looks < 200);
}

/* ---- random pairs ------------------------------------------------------------------ */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The square of the distance of x - beta b - gamma c from the origin. */
static double square_at(const double x[3], const double b[3], double beta,
                        const double c[3], double gamma)
{
    double g[3];
    for (int k = 0; k < 3; k++) {
        g[k] = x[k] - beta * b[k] - gamma * c[k];
    }
    return dot(g, g);
}

static double to_unit(double part)
{
    return part > 0 ? part < 1 ? part : 1 : 0;
}

/* The same, of the nearest point of a segment. */
static double square_from(const double x[3], const double b[3], const double c[3],
                          double gamma)
{
    double w[3];
    for (int k = 0; k < 3; k++) {
        w[k] = x[k] - gamma * c[k];
    }
    double bb = dot(b, b);
    return square_at(x, b, bb > 0 ? to_unit(dot(w, b) / bb) : 0, c, gamma);
}

/* The state of a pair at a time. */
struct sample {
    double distance;
    double volume; /* det[p, b, c] */
    bool is_inside;
};

static void look_at(enum pccd_kind kind, const double x[4][3], struct sample *sample)
{
    double p[3], b[3], c[3], n[3], m[3], d[3];
    const bool is_ee = kind == PCCD_EE;
    for (int k = 0; k < 3; k++) {
        p[k] = is_ee ? x[2][k] - x[0][k] : x[0][k] - x[1][k];
        b[k] = is_ee ? x[1][k] - x[0][k] : x[2][k] - x[1][k];
        c[k] = is_ee ? x[2][k] - x[3][k] : x[3][k] - x[1][k];
        d[k] = c[k] - b[k];
        m[k] = p[k] - b[k];
    }
    double least = fmin(square_from(p, b, c, 0), square_from(p, c, b, 0));
    if (is_ee) {
        least = fmin(least, fmin(square_from(p, b, c, 1), square_from(p, c, b, 1)));
    } else {
        least = fmin(least, square_from(m, d, c, 0));
    }
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = b[i] * c[j] - b[j] * c[i];
    }
    double nn = dot(n, n), beta, gamma;
    for (int k = 0; k < 3; k++) {
        m[k] = p[(k + 1) % 3] * c[(k + 2) % 3] - p[(k + 2) % 3] * c[(k + 1) % 3];
        d[k] = b[(k + 1) % 3] * p[(k + 2) % 3] - b[(k + 2) % 3] * p[(k + 1) % 3];
    }
    beta = dot(m, n);
    gamma = dot(d, n);
    sample->is_inside = nn > 0 && beta > 0 && gamma > 0 &&
                        (is_ee ? beta < nn && gamma < nn : beta + gamma < nn);
    sample->volume = dot(p, n);
    if (sample->is_inside) {
        least = fmin(least, sample->volume * sample->volume / nn);
    }
    sample->distance = sqrt(least);
}

/* A random pair and its motion. */
struct play {
    struct pccd_joint joints[4];
    uint32_t count;
    struct eng_path path;
    struct eng_turning_pair pair;
    double r, approach;
};

static void sample_at(const struct play *play, double t, struct sample *sample)
{
    struct eng_path_pose pose;
    double x[4][3];
    uint32_t points_a = common_kinds[play->pair.kind].points[0];
    eng_path_pose(&play->path, t, &pose);
    for (uint32_t i = 0; i < 4; i++) {
        const double *at = play->pair.x[0][i];
        for (int k = 0; k < 3; k++) {
            const double *m = pose.m + 4 * k;
            x[i][k] = (i < points_a) == (play->pair.turning == 0)
                          ? m[0] * at[0] + m[1] * at[1] + m[2] * at[2] + m[3]
                          : (1 - t) * at[k] + t * play->pair.x[1][i][k];
        }
    }
    look_at(play->pair.kind, (const double(*)[3])x, sample);
}

static void make_play(struct prng *random, struct play *play)
{
    static const double angles[] = {0.01, 0.3, 2, 6, 100};
    struct pccd_joint *joint = play->joints;
    uint32_t fault;
    const char *why;
    memset(play, 0, sizeof *play);
    play->count = 1 + prng_u32(random, 3);
    for (uint32_t i = 0; i < play->count; i++, joint++) {
        static const uint32_t kinds[] = {PCCD_JOINT_TURN, PCCD_JOINT_TURN,
                                         PCCD_JOINT_VECTOR, PCCD_JOINT_SHIFT,
                                         PCCD_JOINT_SLIDE};
        double most = angles[prng_u32(random, 5)];
        joint->kind = kinds[prng_u32(random, 5)];
        joint->parent = i == 0 ? PCCD_NO_JOINT : i - 1;
        for (int k = 0; k < 4; k++) {
            joint->rotation[k] = prng_between(random, -1, 1);
        }
        bool has_axis = joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_SLIDE;
        most = joint->kind == PCCD_JOINT_SHIFT || joint->kind == PCCD_JOINT_SLIDE ? 0.7
                                                                                  : most;
        for (int k = 0; k < 3; k++) {
            joint->position[k] = prng_between(random, -0.5, 0.5);
            joint->axis[k] = has_axis ? prng_between(random, -1, 1) : 0;
            joint->from[k] = has_axis && k > 0 ? 0 : prng_between(random, -most, most);
            joint->to[k] = has_axis && k > 0 ? 0 : prng_between(random, -most, most);
        }
    }
    assert_true(eng_joints_check(play->joints, play->count, &fault, &why));
    assert_int_equal(
        eng_path_between(play->joints, PCCD_NO_JOINT, play->count - 1, &play->path),
        PCCD_OK);
    struct eng_turning_pair *pair = &play->pair;
    const uint32_t *points = common_kinds[pair->kind].points;
    static const enum pccd_kind kinds[] = {PCCD_VF, PCCD_EE, PCCD_VE, PCCD_VV};
    static const double radii[] = {0, 0, 0, 1e-3, 0.1, 0.4};
    pair->kind = kinds[prng_u32(random, 4)];
    points = common_kinds[pair->kind].points;
    pair->turning = prng_u32(random, 2);
    pair->radius[2] = radii[prng_u32(random, 6)];
    if (points[0] + points[1] < 4 && pair->radius[2] == 0) {
        pair->radius[prng_u32(random, 2)] = 0.05;
    }
    play->r = pair->radius[0] + pair->radius[1] + pair->radius[2];
    play->approach = prng_u32(random, 2) ? 0.75 : 0;
    bool moves = prng_u32(random, 2);
    double size = prng_u32(random, 4) ? 1 : 0.2;
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t from = i < points[0] + points[1] ? i : points[0] + points[1] - 1;
        for (int k = 0; k < 3; k++) {
            pair->x[0][i][k] =
                i > from ? pair->x[0][from][k] : prng_between(random, -size, size);
            pair->x[1][i][k] = i > from ? pair->x[1][from][k]
                               : moves  ? prng_between(random, -size, size)
                                        : pair->x[0][i][k];
        }
    }
}

struct tally {
    uint32_t free, proved, possible, limit, long_brackets, crossings, inside;
    uint64_t looks[4];
    uint64_t hinted;
    uint32_t most;
};

/* Return the distance and the time where samples are nearest before `end`; whether thin
 * features passed through each other between two of them. */
static bool sample_all(const struct play *play, double end, double *least)
{
    enum { SAMPLES = 400 };
    struct sample now, last = {0};
    bool crosses = false;
    bool is_solid = play->pair.kind == PCCD_VF || play->pair.kind == PCCD_EE;
    *least = INFINITY;
    for (int i = 0; i <= SAMPLES; i++) {
        double t = end * i / SAMPLES;
        sample_at(play, t, &now);
        *least = fmin(*least, now.distance);
        crosses |= i > 0 && is_solid && now.is_inside && last.is_inside &&
                   (now.volume < 0) != (last.volume < 0) && now.distance < 0.03 &&
                   last.distance < 0.03;
        last = now;
    }
    return crosses;
}

/* Set when the pair may be within r + 4 delta of each other, at the most. */
static void hint(struct play *play)
{
    enum { SAMPLES = 128 };
    struct eng_path_box box = {{-2, -2, -2}, {2, 2, 2}};
    struct sample now;
    double speed = eng_path_speed(&play->path, &box, 0, 1) + 4;
    struct eng_turning_pair *pair = &play->pair;
    pair->from = 2;
    pair->to = 0x1p-40;
    for (int i = 0; i < SAMPLES; i++) {
        sample_at(play, (i + 0.5) / SAMPLES, &now);
        if (now.distance <= play->r + 5 * DELTA + speed / SAMPLES) {
            pair->from = fmin(pair->from, (double)i / SAMPLES);
            pair->to = fmax(pair->to, (i + 1.0) / SAMPLES);
        }
    }
}

/* The bytes of all members; what lies between them is nobody's. */
static void expect_same(const struct eng_hit *a, const struct eng_hit *b)
{
    assert_int_equal(a->flags, b->flags);
    assert_memory_equal(&a->toi, &b->toi, sizeof a->toi);
    assert_memory_equal(&a->toi_hi, &b->toi_hi, sizeof a->toi_hi);
    assert_memory_equal(a->param, b->param, sizeof a->param);
    assert_memory_equal(a->normal, b->normal, sizeof a->normal);
}

static void check_play(struct play *play, struct tally *tally)
{
    static struct eng_poses poses;
    struct eng_turning_limits limits = limits_of(TOLERANCE);
    struct sample at[2];
    limits.approach = play->approach;
    double least;
    eng_poses_begin(&poses, &play->path);
    enum eng_turning_verdict verdict =
        eng_turning_decide(&poses, &play->pair, &limits, &answer);
    const struct eng_hit *hit = &answer.hit;
    struct eng_turning_answer first = answer;
    hint(play);
    sample_at(play, 0, &at[0]);
    bool is_inside = play->r > 0 && play->approach > 0 && at[0].distance <= play->r;
    play->r = is_inside ? play->approach * at[0].distance : play->r;
    assert_int_equal(eng_turning_decide(&poses, &play->pair, &limits, &answer), verdict);
    tally->hinted += answer.looks;
    if (verdict != ENG_TURNING_LIMIT) {
        assert_true(answer.looks <= first.looks && answer.free_until == first.free_until);
    }
    if (verdict == ENG_TURNING_MEETS) {
        expect_same(&answer.hit, &first.hit);
    }
    answer = first;
    tally->looks[verdict] += answer.looks;
    tally->most = answer.looks > tally->most ? answer.looks : tally->most;
    double end = verdict == ENG_TURNING_FREE ? 1 : answer.free_until;
    assert_true(end == 0 || !sample_all(play, end, &least));
    if (end > 0 && !(least > play->r - 1e-12)) {
        fail_msg("kind %u verdict %u: %.17g of %.17g before %.17g (%u)", play->pair.kind,
                 verdict, least, play->r, end, hit->flags);
    }
    tally->free += verdict == ENG_TURNING_FREE;
    tally->limit += verdict == ENG_TURNING_LIMIT;
    if (verdict != ENG_TURNING_MEETS) {
        return;
    }
    sample_at(play, hit->toi, &at[0]);
    sample_at(play, hit->toi_hi, &at[1]);
    assert_int_equal((hit->flags & PCCD_INSIDE) != 0, is_inside);
    tally->inside += is_inside;
    tally->crossings += sample_all(play, 1, &least);
    tally->long_brackets += hit->toi_hi - hit->toi > TOLERANCE;
    if ((hit->flags & PCCD_PROVED) == 0) {
        tally->possible++;
        assert_true(at[0].distance <= play->r + 2 * DELTA + 1e-12);
        return;
    }
    tally->proved++;
    bool has_passed = (at[0].volume < 0) != (at[1].volume < 0);
    if (hit->toi_hi - hit->toi <= TOLERANCE) {
        assert_true(has_passed || (play->r > 0 && at[1].distance <= play->r + 1e-12));
    }
}

/* If it failed: something would pass through unseen, or a contact be proved that is none;
 * or answers would depend on what trees know before. */
CASE(decide__random_pairs_agree_with_many_samples)
{
    struct prng random = {prng_seed()};
    const char *asked = getenv("PCCD_TURNS");
    static struct play play;
    struct tally tally = {0};
    for (long n = asked != NULL ? strtol(asked, NULL, 10) : 3000; n > 0; n--) {
        make_play(&random, &play);
        check_play(&play, &tally);
    }
    print_message("# %u free, %u proved, %u possible, %u not known; looks: %.1f, %.1f; "
                  "most %u, with hints all %.1f; long brackets %u; samples cross %u; "
                  "inside %u\n",
                  tally.free, tally.proved, tally.possible, tally.limit,
                  (double)tally.looks[ENG_TURNING_FREE] / tally.free,
                  (double)tally.looks[ENG_TURNING_MEETS] /
                      (tally.proved + tally.possible),
                  tally.most, (double)tally.hinted / (tally.free + tally.proved),
                  tally.long_brackets, tally.crossings, tally.inside);
}

/* A body on a shift and a turn, whose frame is tilted by so little that cosines of it are
 * 1, as files that programs write have it. */
static void tilt(struct eng_path *path)
{
    struct pccd_joint joints[2] = {{.kind = PCCD_JOINT_SHIFT,
                                    .parent = PCCD_NO_JOINT,
                                    .rotation = {0, 0, 0, 1},
                                    .to = {0.3, 0.2, 0.1}},
                                   turn_of(0, 1)};
    joints[1].parent = 0;
    joints[1].rotation[0] = 4e-9;
    assert_int_equal(eng_path_between(joints, PCCD_NO_JOINT, 1, path), PCCD_OK);
}

/* If it failed: what is told of a pair would depend on which others wait beside it, and
 * so on trees, threads and tasks. */
CASE(decide__pairs_are_decided_together_as_alone)
{
    struct prng random = {prng_seed()};
    static struct play plays[ENG_TURNING_BATCH];
    static struct eng_poses poses;
    static struct eng_path tilted;
    struct eng_turning_pair pairs[ENG_TURNING_BATCH];
    struct eng_turning_answer together[ENG_TURNING_BATCH];
    const struct eng_turning_limits limits = limits_of(TOLERANCE);
    uint32_t met[2] = {0, 0};
    tilt(&tilted);
    for (int round = 0; round < 40; round++) {
        for (uint32_t i = 0; i < ENG_TURNING_BATCH; i++) {
            make_play(&random, &plays[i]);
            pairs[i] = plays[i].pair;
        }
        eng_poses_begin(&poses, round % 2 == 0 ? &plays[0].path : &tilted);
        eng_turning_decide_all(&poses, pairs, ENG_TURNING_BATCH, &limits, together);
        for (uint32_t i = 0; i < ENG_TURNING_BATCH; i++) {
            assert_int_equal(eng_turning_decide(&poses, &pairs[i], &limits, &answer),
                             together[i].verdict);
            assert_true(answer.free_until == together[i].free_until);
            assert_int_equal(answer.looks, together[i].looks);
            if (answer.verdict == ENG_TURNING_MEETS) {
                expect_same(&answer.hit, &together[i].hit);
                met[round % 2]++;
            }
        }
    }
    assert_true(met[0] > 30 && met[1] > 30);
}
