/* test_cli_turning.c - motions of bodies that turn, as joints. */
#include "cases.h"

#include "coordinates.h"
#include "joints.h"
#include "pccd.h"

#define PI   3.141592653589793
#define ROOM (3 * PCCD_JOINTS_MOST)

static const struct pccd_pose origin = {.rotation = {0, 0, 0, 1}};

/* Where the last joint of a table takes a point at a time of the step. */
static void assert_goes(const struct pccd_joint *joints, uint32_t count, double t,
                        const double from[3], const double to[3])
{
    double m[12], x[3];
    assert_ok(pccd_joints_place(joints, count, count - 1, t, m));
    common_transform(m, from, x);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(x[k] - to[k]) < 1e-14);
    }
}

/* If this failed, a door would turn about another pin, or a screw go elsewhere. */
CASE(screw__turns_about_its_axis_and_goes_along_it)
{
    struct pccd_joint joints[ROOM];
    uint32_t count = 0;
    assert_ok(pccd_joints_screw((double[3]){1, 0, 0}, (double[3]){0, 0, 5}, PI / 2, 0,
                                PCCD_NO_JOINT, joints, ROOM, &count));
    assert_goes(joints, count, 0, (double[3]){3, 0, 7}, (double[3]){3, 0, 7});
    assert_goes(joints, count, 1, (double[3]){3, 0, 7}, (double[3]){1, 2, 7});
    const double way = 2 * sqrt(0.5);
    assert_goes(joints, count, 0.5, (double[3]){3, 0, 7}, (double[3]){1 + way, way, 7});
    uint32_t parent = count - 1;
    assert_ok(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, -1}, PI / 2, 4,
                                parent, joints, ROOM, &count));
    assert_int_equal(count, 5);
    assert_goes(joints, count, 1, (double[3]){3, 0, 7}, (double[3]){4, -1, 3});
    assert_int_equal(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 0}, 1, 0,
                                       PCCD_NO_JOINT, joints, ROOM, &count),
                     PCCD_E_INVAL);
    assert_string_equal(pccd_error_text(NULL),
                        "joints_screw: of joint 5 the length of its axis is not in 1e-9 "
                        ".. 1e9");
    double m[12];
    assert_int_equal(pccd_joints_place(joints, count, count, 0, m), PCCD_E_INVAL);
    assert_string_equal(pccd_error_text(NULL), "joints_place: there is no such joint");
    assert_int_equal(pccd_joints_place(joints, count, 0, 1.5, m), PCCD_E_INVAL);
    assert_int_equal(pccd_joints_place(joints, count, 0, (double)NAN, m), PCCD_E_INVAL);
    assert_int_equal(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 1}, 7e6, 0,
                                       PCCD_NO_JOINT, joints, ROOM, &count),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 1}, 1, 0,
                                       5, joints, ROOM, &count),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 1}, 1, 0,
                                       PCCD_NO_JOINT, joints, 7, &count),
                     PCCD_E_LIMIT); /* as of who forgets to begin a table anew */
    assert_non_null(strstr(pccd_error_text(NULL), "has 5 joints and room for 7"));
    assert_int_equal(count, 5);
}

static struct pccd_pose turned(double x, double y, double z, double angle)
{
    double length = sqrt(x * x + y * y + z * z), s = sin(angle / 2) / length;
    return (struct pccd_pose){.position = {x, y, z},
                              .rotation = {s * x, s * y, s * z, cos(angle / 2)}};
}

static void place(const struct pccd_pose *pose, const double x[3], double to[3])
{
    struct pccd_joint joint = {.parent = PCCD_NO_JOINT};
    double m[12];
    memcpy(joint.position, pose->position, sizeof joint.position);
    memcpy(joint.rotation, pose->rotation, sizeof joint.rotation);
    common_joint_transform(&joint, 0, 0, m);
    common_transform(m, x, to);
}

/* If this failed, a body would not begin and end at the poses that were given, or go a
 * longer way than it must, or fewer turns than it was told. */
CASE(poses__are_reached_the_shortest_way_or_with_the_turns_that_are_asked_for)
{
    const double x[3] = {1, -2, 3};
    struct pccd_joint joints[ROOM];
    for (int i = 1; i < 200; i++) {
        struct pccd_pose from = turned(i % 7 - 3, 1, i % 5 - 2, 0.37 * i);
        struct pccd_pose to = turned(2, i % 3 - 1, i % 11 - 5, 1.1 * i);
        int32_t turns = i % 4 == 0 ? i - 100 : 0;
        double at[2][3];
        uint32_t count = 0;
        for (int k = 0; k < 4; k++) {
            to.rotation[k] *= i % 2 == 0 ? -3 : 0.01;
        }
        assert_ok(pccd_joints_poses(&from, &to, turns, NULL, PCCD_NO_JOINT, joints, ROOM,
                                    &count));
        place(&from, x, at[0]);
        place(&to, x, at[1]);
        assert_goes(joints, count, 0, x, at[0]);
        double m[12], end[3];
        common_joint_transform(joints, count - 1, 1, m);
        common_transform(m, x, end);
        assert_true(fabs(end[0] - at[1][0]) + fabs(end[1] - at[1][1]) +
                        fabs(end[2] - at[1][2]) <
                    1e-11);
        assert_true(turns != 0 || fabs(joints[1].to[0]) <= PI);
        assert_true(turns == 0 || fabs(joints[1].to[0] - 2 * PI * turns) <= PI + 1e-9);
    }
}

/* If this failed, rounding would choose the way of half a turn. */
CASE(poses__half_a_turn_apart_need_an_axis)
{
    struct pccd_joint joints[ROOM];
    uint32_t count = 0;
    for (int i = -1; i <= 1; i++) {
        struct pccd_pose to = turned(0, 0, 2, PI + i * 4e-7);
        assert_int_equal(
            pccd_joints_poses(&origin, &to, 0, NULL, PCCD_NO_JOINT, joints, ROOM, &count),
            PCCD_E_INVAL);
        assert_string_equal(pccd_error_text(NULL),
                            "joints_poses: they are half a turn apart, within 1e-6 "
                            "radians: an axis must say which way");
        for (int way = -1; way <= 1; way += 2) {
            count = 0;
            assert_ok(pccd_joints_poses(&origin, &to, 0, (double[3]){0.1, 0, way},
                                        PCCD_NO_JOINT, joints, ROOM, &count));
            assert_true(joints[1].axis[2] * way > 0.99);
            assert_true(fabs(joints[1].to[0] - PI) < 1e-6);
            count = 0;
        }
        assert_int_equal(pccd_joints_poses(&origin, &to, 0, (double[3]){1, 0, 0},
                                           PCCD_NO_JOINT, joints, ROOM, &count),
                         PCCD_E_INVAL);
    }
    struct pccd_pose near_half = turned(0, 0, 2, PI - 1e-5);
    assert_ok(pccd_joints_poses(&origin, &near_half, 0, NULL, PCCD_NO_JOINT, joints, ROOM,
                                &count));
    count = 0;
    assert_int_equal(
        pccd_joints_poses(&origin, &origin, 3, NULL, PCCD_NO_JOINT, joints, ROOM, &count),
        PCCD_E_INVAL);
    assert_ok(pccd_joints_poses(&origin, &origin, -3, (double[3]){0, 1, 0}, PCCD_NO_JOINT,
                                joints, ROOM, &count));
    assert_true(fabs(joints[1].to[0] + 6 * PI) < 1e-12);
    count = 0;
    assert_ok(pccd_joints_poses(&origin, &origin, 0, NULL, PCCD_NO_JOINT, joints, ROOM,
                                &count));
    assert_int_equal(count, 2);
}

/* If this failed, what rigid-body codes interpolate would be another motion here. */
CASE(rotation_vector__goes_straight_from_one_to_the_other)
{
    struct pccd_joint joints[ROOM];
    uint32_t count = 0;
    assert_ok(pccd_joints_rotation_vector(
        (double[3]){1, 2, 3}, (double[3]){4, 5, 6}, (double[3]){0, 0, PI / 2},
        (double[3]){PI, 0, 0}, PCCD_NO_JOINT, joints, ROOM, &count));
    assert_goes(joints, count, 0, (double[3]){1, 0, 0}, (double[3]){1, 3, 3});
    assert_goes(joints, count, 1, (double[3]){0, 1, 0}, (double[3]){4, 4, 6});
    assert_int_equal(pccd_joints_rotation_vector(NULL, (double[3]){4, 5, 6},
                                                 (double[3]){0, 0, 0}, (double[3]){0},
                                                 PCCD_NO_JOINT, joints, ROOM, &count),
                     PCCD_E_INVAL);
}

/* If this failed, a matrix would become another rotation, or what is none would be taken
 * for one. */
CASE(matrix__that_is_a_rotation_becomes_its_quaternion)
{
    for (int i = 0; i < 300; i++) {
        struct pccd_pose pose = turned(i % 7 - 3, i % 5 - 2, 1, i * PI / 30);
        struct pccd_joint joint = {.parent = PCCD_NO_JOINT};
        double m[12], again[4], same = 0;
        memcpy(joint.rotation, pose.rotation, sizeof joint.rotation);
        common_joint_transform(&joint, 0, 0, m);
        assert_ok(pccd_rotation_of_matrix(m, again));
        for (int k = 0; k < 4; k++) {
            same += again[k] * pose.rotation[k];
        }
        assert_true(again[3] >= 0 && fabs(fabs(same) - 1) < 1e-14);
    }
    double q[4], m[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1.001, 0};
    assert_int_equal(pccd_rotation_of_matrix(m, q), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(NULL), "by 0.002001, more than 1e-06"));
    m[10] = -1;
    assert_int_equal(pccd_rotation_of_matrix(m, q), PCCD_E_INVAL);
    assert_string_equal(pccd_error_text(NULL), "rotation_of_matrix: it mirrors");
    m[10] = (double)NAN;
    assert_int_equal(pccd_rotation_of_matrix(m, q), PCCD_E_INVAL);
}
