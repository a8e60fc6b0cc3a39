/* test_proto_joints.c - which joints can be joints, and where a link is at either end. */
#include "cases.h"

#include <math.h>

#include "coordinates.h"
#include "joints.h"

/* Half of a turn, as a double. */
#define HALF 3.141592653589793

static const struct pccd_joint still = {.parent = PCCD_NO_JOINT,
                                        .rotation = {0, 0, 0, 1}};

static uint64_t next(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state >> 33;
}

/* If this failed, a daemon and its client on another machine would put a body elsewhere:
 * long doubles of the C library are nearer to the truth by eleven bits, or more. */
CASE(sine__is_within_its_error_of_the_true_one_up_to_2_to_the_20_turns)
{
    static const double most[] = {1e-300, 1e-6, 1, 10, 1000, COMMON_ANGLE_MAX};
    uint64_t seed = 1;
    for (int i = 0; i < 300000; i++) {
        long double part = (long double)next(&seed) / 0x1p31L, angle = most[i % 6] * part;
        angle = i % 7 == 0 ? floorl(part * 4194304) * (HALF / 2) : angle;
        angle = i % 2 == 0 ? -angle : angle;
        double hi = (double)angle, lo = (double)(angle - hi), sine, cosine;
        common_sine(hi, lo, &sine, &cosine);
        assert_true(fabsl(sinl(angle) - sine) < COMMON_SINE_ERROR);
        assert_true(fabsl(cosl(angle) - cosine) < COMMON_SINE_ERROR);
        assert_true(sine * hi >= 0 || fabs(hi) > 3);
    }
}

static void assert_takes(const double m[12], const double from[3], const double to[3])
{
    double x[3];
    common_transform(m, from, x);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(x[k] - to[k]) < 1e-14);
    }
}

/* If this failed, a body would be elsewhere than its joints say: a quarter about z
 * through (1, 0, 0), on a slide by 2 along y, on a joint that is turned by a quarter
 * about x and moved by 5 along z. */
CASE(transform__follows_the_joints_from_the_world_to_the_link)
{
    struct pccd_joint joints[5] = {still, still, still, still, still};
    double m[12];
    joints[0].position[2] = 5;
    joints[0].rotation[0] = joints[0].rotation[3] = 3; /* of any length */
    joints[1].kind = PCCD_JOINT_SLIDE;
    joints[1].parent = 0;
    joints[1].axis[1] = 4;
    joints[1].to[0] = 2;
    joints[2].kind = PCCD_JOINT_TURN;
    joints[2].parent = 1;
    joints[2].position[0] = 1;
    joints[2].axis[2] = 1;
    joints[2].to[0] = HALF / 2;
    common_joint_transform(joints, 2, 0, m);
    assert_takes(m, (double[3]){1, 0, 0}, (double[3]){2, 0, 5});
    common_joint_transform(joints, 2, 1, m);
    assert_takes(m, (double[3]){1, 0, 0}, (double[3]){1, 0, 8});
    assert_takes(m, (double[3]){0, 0, 1}, (double[3]){1, -1, 7});
    joints[3].kind = PCCD_JOINT_SHIFT;
    joints[3].from[0] = 1;
    joints[3].to[2] = -3;
    joints[4].kind = PCCD_JOINT_VECTOR;
    joints[4].parent = 3;
    joints[4].to[1] = -HALF / 2;
    common_joint_transform(joints, 4, 0, m);
    assert_takes(m, (double[3]){7, 8, 9}, (double[3]){8, 8, 9});
    common_joint_transform(joints, 4, 1, m);
    assert_takes(m, (double[3]){7, 8, 9}, (double[3]){-9, 8, 4});
}

/* If this failed, a link that does not move would differ from its mesh in a bit. */
CASE(transform__of_what_does_not_move_is_exactly_nothing)
{
    const double none[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    struct pccd_joint joint = still;
    double m[12];
    for (uint32_t kind = 0; kind < PCCD_JOINT_KIND_COUNT; kind++) {
        joint.kind = kind;
        joint.axis[0] = kind == PCCD_JOINT_TURN || kind == PCCD_JOINT_SLIDE;
        for (uint32_t end = 0; end < 2; end++) {
            common_joint_transform(&joint, 0, end, m);
            for (int i = 0; i < 12; i++) {
                assert_true(m[i] == none[i]);
            }
        }
    }
}

static const char *fault_with(uint32_t kind, const struct pccd_joint *given)
{
    struct pccd_joint joint = *given;
    joint.kind = kind;
    return common_joint_fault(&joint, 1);
}

/* If this failed, a daemon would compute with joints that say nothing, and so would who
 * reads a recording. */
CASE(joints__that_cannot_be_are_found)
{
    struct pccd_joint joint = still;
    assert_null(fault_with(PCCD_JOINT_FIXED, &joint));
    assert_null(fault_with(PCCD_JOINT_VECTOR, &joint));
    assert_string_equal(fault_with(PCCD_JOINT_TURN, &joint),
                        "the length of its axis is not in 1e-9 .. 1e9");
    assert_string_equal(fault_with(PCCD_JOINT_KIND_COUNT, &joint), "its kind is unknown");
    joint.parent = 1;
    assert_string_equal(fault_with(PCCD_JOINT_FIXED, &joint),
                        "its parent is not before it");
    joint.parent = 0;
    assert_null(fault_with(PCCD_JOINT_FIXED, &joint));
    joint.axis[1] = -1;
    assert_null(fault_with(PCCD_JOINT_TURN, &joint));
    assert_string_equal(fault_with(PCCD_JOINT_SHIFT, &joint),
                        "it has an axis, and its kind has none");
    joint.to[1] = 1;
    assert_string_equal(fault_with(PCCD_JOINT_SLIDE, &joint),
                        "it has more values than its kind");
    joint.to[1] = 0;
    joint.from[0] = 6588397.4;
    assert_null(fault_with(PCCD_JOINT_SLIDE, &joint));
    assert_string_equal(fault_with(PCCD_JOINT_TURN, &joint),
                        "its angle is beyond 2^20 turns");
    joint.from[0] = (double)NAN;
    assert_string_equal(fault_with(PCCD_JOINT_TURN, &joint),
                        "a number is not finite or beyond 1e18");
    joint.from[0] = 0;
    joint.rotation[3] = 0;
    assert_string_equal(fault_with(PCCD_JOINT_TURN, &joint),
                        "the length of its rotation is not in 1e-9 .. 1e9");
}
