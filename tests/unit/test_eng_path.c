/* test_eng_path.c - paths of joints, beside long floats. */
#include "eng_kit.h"
#include "eng_turns.h"

#include <math.h>
#include <string.h>

#include "path.h"
#include "poses.h"
#include "sine.h"

#define CHAIN_MAX 16

/* PCCD_TURNS: how many chains, in the place of a few thousand. */
static long tries(long usual)
{
    const char *asked = getenv("PCCD_TURNS");
    return asked != NULL ? strtol(asked, NULL, 10) : usual;
}

static void apply(const struct eng_path_pose *pose, const double b[3], double x[3])
{
    for (int i = 0; i < 3; i++) {
        const double *m = pose->m + 4 * i;
        x[i] = ((m[0] * b[0] + m[1] * b[1]) + m[2] * b[2]) + m[3];
    }
}

static double size_of(const double b[3])
{
    return fmax(fabs(b[0]), fmax(fabs(b[1]), fabs(b[2])));
}

static double random_size(struct prng *random)
{
    uint32_t around = prng_u32(random, 40);
    return ldexp(1, prng_u32(random, 8) ? (int)around - 20
                                        : 59 - (int)prng_u32(random, 1100));
}

/* Random chains of all kinds, seen from any of their frames. */
CASE(path__poses_are_within_their_error)
{
    struct prng random = {prng_seed()};
    struct turns_place place;
    double worst = 0;
    turns_init(&place);
    for (long n = tries(2000); n > 0; n--) {
        struct pccd_joint joints[CHAIN_MAX];
        static struct eng_path path;
        struct eng_path_pose pose;
        uint32_t count = 1 + prng_u32(&random, CHAIN_MAX);
        double size = random_size(&random), b[3], x[3];
        uint32_t of = prng_u32(&random, count + 1) - 1, to = prng_u32(&random, count);
        uint32_t fault;
        const char *why;
        turns_random(&random, joints, count, size);
        assert_true(eng_joints_check(joints, count, &fault, &why));
        assert_int_equal(eng_path_between(joints, of, to, &path), PCCD_OK);
        for (int k = 0; k < 3; k++) {
            double t = k < 2 ? k : prng_between(&random, 0, 1);
            for (int i = 0; i < 3; i++) {
                b[i] = prng_between(&random, -size, size);
            }
            eng_path_pose(&path, t, &pose);
            apply(&pose, b, x);
            turns_go(joints, of, to, t, b, &place);
            double off = turns_distance(&place, x);
            double error = pose.error[0] + pose.error[1] * size_of(b);
            assert_true(off <= error);
            worst = fmax(worst, off / error);
        }
    }
    print_message("# at most %.2f of the error that is claimed\n", worst);
    assert_true(worst > 0.01);
    turns_deinit(&place);
}

/* Set *box to one of up to `size`, and b to one of its corners. */
static void random_box(struct prng *random, double size, struct eng_path_box *box,
                       double b[3])
{
    for (int i = 0; i < 3; i++) {
        double x = prng_between(random, -size, size),
               y = prng_between(random, -size, size);
        box->lo[i] = fmin(x, y);
        box->hi[i] = fmax(x, y);
        b[i] = prng_u32(random, 2) ? box->lo[i] : box->hi[i];
    }
}

/* Angles of a joint are at most a few turns. */
static void calm(struct pccd_joint *joint)
{
    bool turns = joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_VECTOR;
    for (int k = 0; k < 3 && turns; k++) {
        joint->from[k] = remainder(joint->from[k], 3);
        joint->to[k] = remainder(joint->to[k], 3);
    }
}

static double length_between(const double x[3], const double y[3])
{
    return sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
                (x[2] - y[2]) * (x[2] - y[2]));
}

static double bow_of(const struct eng_path_span *span, const double b[3])
{
    struct eng_path_pose bow;
    double d[3];
    memcpy(bow.m, span->m, sizeof bow.m);
    apply(&bow, b, d);
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) +
           (span->error[0] + span->error[1] * size_of(b)) * (1 + 0x1p-40);
}

#define SAMPLES 16

/* Part of what is claimed that points reach. */
struct reached {
    double speed;
    double bend;
    double bow;
};

/* Follow a point of a box over a span by samples, none of which may be beyond its bounds
 * and the errors of poses. */
static struct reached follow(const struct eng_path *path, const struct eng_path_box *box,
                             const double b[3], double t0, double t1)
{
    struct eng_path_pose pose[SAMPLES + 1];
    struct eng_path_span span;
    double x[SAMPLES + 1][3], h = t1 - t0, off = 0, step = 0;
    for (int k = 0; k <= SAMPLES; k++) {
        eng_path_pose(path, t0 + h * k / SAMPLES, &pose[k]);
        apply(&pose[k], b, x[k]);
    }
    const struct eng_path_pose ends[3] = {pose[0], pose[SAMPLES / 2], pose[SAMPLES]};
    eng_path_span(path, t0, t1, ends, &span);
    double error = 2 * (path->error[0] + path->error[1] * size_of(b));
    double speed = eng_path_speed(path, box, t0, t1) * h / SAMPLES;
    double bend = eng_path_bend(path, box, t0, t1) * h * h / 8;
    double bow = bow_of(&span, b);
    for (int k = 0; k < SAMPLES; k++) {
        double chord[3];
        for (int i = 0; i < 3; i++) {
            chord[i] = x[0][i] + (x[SAMPLES][i] - x[0][i]) * k / SAMPLES;
        }
        off = fmax(off, length_between(x[k], chord));
        step = fmax(step, length_between(x[k], x[k + 1]));
    }
    assert_true(step <= speed + error);
    assert_true(off <= bend + error);
    assert_true(off <= bow + error);
    return (struct reached){step / speed, off / bend, off / bow};
}

/* Samples of random chains, over spans down to 1/128. */
CASE(path__points_keep_to_their_bounds)
{
    struct prng random = {prng_seed()};
    for (long n = tries(20000); n > 0; n--) {
        struct pccd_joint joints[CHAIN_MAX];
        static struct eng_path path;
        struct eng_path_box box;
        uint32_t count = 1 + prng_u32(&random, CHAIN_MAX);
        double size = random_size(&random), b[3];
        double h = ldexp(1, -(int)prng_u32(&random, 8));
        double t0 = h * prng_u32(&random, (uint32_t)(1 / h));
        uint32_t of = prng_u32(&random, count + 1) - 1, to = prng_u32(&random, count);
        turns_random(&random, joints, count, size);
        for (uint32_t i = 0; i < count && prng_u32(&random, 4); i++) {
            calm(&joints[i]);
        }
        assert_int_equal(eng_path_between(joints, of, to, &path), PCCD_OK);
        random_box(&random, size, &box, b);
        follow(&path, &box, b, t0, t0 + h);
    }
}

/* The farthest corner reaches a third of each bound of one joint at least. */
CASE(path__bounds_of_one_joint_are_near)
{
    struct prng random = {prng_seed()};
    struct reached least = {1, 1, 1};
    for (long n = 0; n < 2000; n++) {
        struct pccd_joint joint;
        static struct eng_path path;
        struct eng_path_box box;
        struct reached most = {0, 0, 0};
        double b[3], h = ldexp(1, -1 - (int)prng_u32(&random, 4));
        do {
            turns_random(&random, &joint, 1, 1);
            calm(&joint);
        } while (joint.kind != PCCD_JOINT_TURN ||
                 fabs(joint.from[0] - joint.to[0]) < 0.01);
        assert_int_equal(eng_path_between(&joint, prng_u32(&random, 2) - 1, 0, &path),
                         PCCD_OK);
        if (path.count == 0) { /* seen from itself */
            continue;
        }
        random_box(&random, 1, &box, b);
        for (int i = 0; i < 8; i++) {
            for (int k = 0; k < 3; k++) {
                b[k] = i >> k & 1 ? box.hi[k] : box.lo[k];
            }
            struct reached reached = follow(&path, &box, b, 0, h);
            most.speed = fmax(most.speed, reached.speed);
            most.bend = fmax(most.bend, reached.bend);
            most.bow = fmax(most.bow, reached.bow);
        }
        least.speed = fmin(least.speed, most.speed);
        least.bend = fmin(least.bend, most.bend);
        least.bow = fmin(least.bow, most.bow);
    }
    print_message("# reached: %.2f of speed, %.2f of bend, %.2f of bow\n", least.speed,
                  least.bend, least.bow);
    assert_true(least.speed > 1.0 / 3 && least.bend > 1.0 / 3 && least.bow > 1.0 / 3);
}

/* An arm of six links that turn by up to 0.8, in eighths of its motion: the bow of the
 * last link is a part of what bend says. */
CASE(path__bows_of_arms_are_near)
{
    struct prng random = {prng_seed()};
    double bend_sum = 0, bow_sum = 0;
    for (long n = 0; n < 500; n++) {
        struct pccd_joint joints[6];
        static struct eng_path path;
        const struct eng_path_box box = {{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.3}};
        double bend = 0, bow = 0;
        memset(joints, 0, sizeof joints);
        for (uint32_t i = 0; i < 6; i++) {
            joints[i].kind = PCCD_JOINT_TURN;
            joints[i].parent = i - 1; /* of the first: none */
            joints[i].position[2] = 0.3;
            joints[i].rotation[3] = 1;
            joints[i].axis[i & 1 ? 2 : 1] = 1;
            joints[i].from[0] = prng_between(&random, -2, 2);
            joints[i].to[0] = joints[i].from[0] + prng_between(&random, -0.8, 0.8);
        }
        assert_int_equal(eng_path_between(joints, PCCD_NO_JOINT, 5, &path), PCCD_OK);
        for (int i = 0; i < 8; i++) {
            double b[3];
            for (int k = 0; k < 3; k++) {
                b[k] = i >> k & 1 ? box.hi[k] : box.lo[k];
            }
            struct reached reached = follow(&path, &box, b, 0.25, 0.375);
            bend = fmax(bend, reached.bend);
            bow = fmax(bow, reached.bow);
        }
        bend_sum += bend / 500;
        bow_sum += bow / 500;
    }
    print_message("# reached: %.2f of bend, %.2f of bow\n", bend_sum, bow_sum);
    assert_true(bow_sum > 0.5);
}

static void mix(uint64_t *hash, const double *x, int count)
{
    for (int i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &x[i], sizeof bits);
        *hash = (*hash ^ bits) * 0x9e3779b97f4a7c15u;
        *hash ^= *hash >> 29;
    }
}

/* If it failed, contacts of what turns would differ from those of another compiler or
 * machine, or of an earlier pccd. */
CASE(path__has_the_same_bytes_everywhere)
{
    struct prng random = {1};
    uint64_t hash = 0;
    for (int n = 0; n < 1000; n++) {
        struct pccd_joint joints[CHAIN_MAX];
        static struct eng_path path;
        struct eng_path_pose pose[3];
        struct eng_path_span span;
        turns_random(&random, joints, CHAIN_MAX, 1 + n);
        assert_int_equal(eng_path_between(joints, 5, 15, &path), PCCD_OK);
        for (int i = 0; i < 3; i++) {
            eng_path_pose(&path, i / 2.0, &pose[i]);
            mix(&hash, pose[i].m, 12);
            mix(&hash, pose[i].error, 2);
        }
        eng_path_span(&path, 0, 1, pose, &span);
        mix(&hash, span.m, 12);
        mix(&hash, span.error, 2);
        mix(&hash, path.jerk, 2);
    }
    assert_true(hash == 0xf98ad8eb89ecd76d);
}

/* A wheel that turns 2^20 times is nowhere farther off than its width. */
CASE(path__bows_of_wheels_end)
{
    struct pccd_joint joint = {.kind = PCCD_JOINT_TURN, .parent = PCCD_NO_JOINT};
    static struct eng_path path;
    struct eng_path_pose pose[3];
    struct eng_path_span span;
    const double b[3] = {1, 0, 0};
    joint.position[0] = 1000;
    joint.rotation[3] = 1;
    joint.axis[2] = 1;
    joint.to[0] = COMMON_ANGLE_MAX;
    assert_int_equal(eng_path_between(&joint, PCCD_NO_JOINT, 0, &path), PCCD_OK);
    for (int i = 0; i < 3; i++) {
        eng_path_pose(&path, 0, &pose[i]);
    }
    eng_path_span(&path, 0, 1, pose, &span);
    assert_true(bow_of(&span, b) <= 2 * sqrt(3.1));
}

/* A chain of 64 joints, seen from the world and from a second one. */
CASE(path__is_as_long_as_allowed)
{
    struct prng random = {prng_seed()};
    static struct pccd_joint joints[129];
    static struct eng_path path;
    struct turns_place place;
    turns_init(&place);
    for (uint32_t i = 0; i < 129; i++) {
        do {
            turns_random(&random, &joints[i], 1, 1);
        } while (joints[i].kind == PCCD_JOINT_FIXED);
        joints[i].parent = i == 64 ? PCCD_NO_JOINT : i - 1;
    }
    for (int n = 0; n < 20; n++) {
        struct eng_path_pose pose;
        double b[3] = {1, 2, 3}, x[3], t = n / 19.0;
        uint32_t of = n & 1 ? PCCD_NO_JOINT : 63;
        assert_int_equal(eng_path_between(joints, of, 64 + 63, &path), PCCD_OK);
        eng_path_pose(&path, t, &pose);
        apply(&pose, b, x);
        turns_go(joints, of, 64 + 63, t, b, &place);
        assert_true(turns_distance(&place, x) <= pose.error[0] + pose.error[1] * 3);
        assert_true(pose.error[0] + pose.error[1] * 3 < 1e-9);
    }
    assert_int_equal(eng_path_between(joints, 63, 128, &path), PCCD_E_LIMIT);
    turns_deinit(&place);
}

/* A body on the link that it is seen from, and two that a fixed joint holds together, do
 * not move, whatever they hang on. */
CASE(path__is_without_what_cancels)
{
    struct prng random = {prng_seed()};
    struct pccd_joint joints[12];
    static struct eng_path path;
    turns_random(&random, joints, 12, 1);
    memset(&joints[11], 0, sizeof joints[11]);
    joints[11].parent = 10;
    joints[11].position[0] = 3;
    joints[11].rotation[3] = 7;
    assert_int_equal(eng_path_between(joints, 10, 10, &path), PCCD_OK);
    assert_true(eng_path_is_still(&path) && path.last[3] == 0);
    assert_int_equal(eng_path_between(joints, 10, 11, &path), PCCD_OK);
    assert_true(eng_path_is_still(&path) && path.last[3] == 3 && path.last[0] == 1);
    assert_int_equal(eng_path_between(joints, 11, 10, &path), PCCD_OK);
    assert_true(eng_path_is_still(&path) && path.last[3] == -3);
}

/* A joint that is wrong in one way, at index 1, and a part of what must be said. */
CASE(joints__are_refused_by_name)
{
    static const struct {
        const char *says;
        size_t offset;
        uint32_t kind;
        double value;
    } wrong[] = {
#define AT(what) offsetof(struct pccd_joint, what)
        {"finite", AT(position[1]), PCCD_JOINT_FIXED, NAN},
        {"finite", AT(from[0]), PCCD_JOINT_SHIFT, INFINITY},
        {"1e18", AT(to[0]), PCCD_JOINT_SLIDE, 1.1e18},
        {"rotation", AT(rotation[3]), PCCD_JOINT_FIXED, 0},
        {"rotation", AT(rotation[3]), PCCD_JOINT_TURN, 1.1e9},
        {"axis", AT(axis[2]), PCCD_JOINT_TURN, 0},
        {"axis", AT(axis[2]), PCCD_JOINT_SLIDE, 1e-10},
        {"has none", AT(axis[2]), PCCD_JOINT_VECTOR, 1},
        {"more values", AT(from[0]), PCCD_JOINT_FIXED, 1},
        {"more values", AT(to[1]), PCCD_JOINT_TURN, 1},
        {"more values", AT(from[2]), PCCD_JOINT_SLIDE, -1},
        {"2^20 turns", AT(to[0]), PCCD_JOINT_TURN, -0x1.921fb54442d19p+22},
        {"2^20 turns", AT(from[2]), PCCD_JOINT_VECTOR, 6.6e6},
#undef AT
    };
    struct pccd_joint joints[2];
    uint32_t joint = 7;
    const char *why = NULL;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        bool has_axis =
            wrong[i].kind == PCCD_JOINT_TURN || wrong[i].kind == PCCD_JOINT_SLIDE;
        memset(joints, 0, sizeof joints);
        joints[0].parent = PCCD_NO_JOINT;
        joints[0].rotation[3] = 1;
        joints[1] = joints[0];
        joints[1].kind = wrong[i].kind;
        joints[1].parent = 0;
        joints[1].axis[2] = has_axis ? 1 : 0;
        assert_true(eng_joints_check(joints, 2, &joint, &why));
        memcpy((char *)&joints[1] + wrong[i].offset, &wrong[i].value, sizeof(double));
        assert_false(eng_joints_check(joints, 2, &joint, &why));
        assert_int_equal(joint, 1);
        assert_non_null(strstr(why, wrong[i].says));
    }
    joints[0].kind = PCCD_JOINT_KIND_COUNT;
    assert_false(eng_joints_check(joints, 2, &joint, &why));
    assert_true(joint == 0 && strstr(why, "kind") != NULL);
    joints[0].kind = PCCD_JOINT_FIXED;
    joints[0].parent = 0;
    assert_false(eng_joints_check(joints, 2, &joint, &why));
    assert_true(joint == 0 && strstr(why, "parent") != NULL);
}

/* If it failed, poses at halves of the step, which all pairs ask for, would push each
 * other out. */
CASE(poses__of_many_halves_are_kept)
{
    static struct eng_path path;
    static struct eng_poses poses;
    struct prng random = {1};
    struct pccd_joint joints[2];
    uint32_t kept = 0;
    turns_random(&random, joints, 2, 1);
    assert_int_equal(eng_path_between(joints, PCCD_NO_JOINT, 1, &path), PCCD_OK);
    eng_poses_begin(&poses, &path);
    for (int i = 0; i <= 64; i++) {
        eng_poses_at(&poses, i / 64.0);
    }
    for (uint32_t i = 0; i < ENG_POSES_KEPT; i++) {
        kept += poses.t[i] >= 0;
    }
    assert_true(kept > 48);
}
