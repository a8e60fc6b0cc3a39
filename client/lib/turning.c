/* turning.c - motions of bodies that turn, as chains of joints. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "client.h"
#include "joints.h"
#include "rounding.h"

#define AMBIGUOUS          1e-6 /* radians from half a turn */
#define ROTATION_TOLERANCE 1e-6
#define PI                 3.141592653589793

/* A chain that is being added to a table. */
struct chain {
    struct pccd_joint *joints;
    uint32_t first;  /* where it begins in the table */
    uint32_t count;  /* of its joints so far */
    uint32_t parent; /* of the next */
};

static int refuse(const char *what, const char *why)
{
    return cli_fail(NULL, PCCD_E_INVAL, "%s: %s", what, why);
}

static int begin(struct chain *chain, const char *what, uint32_t parent,
                 struct pccd_joint *joints, uint32_t room, const uint32_t *count)
{
    if (joints == NULL || count == NULL) {
        return refuse(what, joints == NULL ? "joints is NULL" : "count is NULL");
    }
    if (parent != PCCD_NO_JOINT && parent >= *count) {
        return refuse(what, "the parent is not in the table");
    }
    if (*count > room || room - *count < PCCD_JOINTS_MOST) {
        return cli_fail(NULL, PCCD_E_LIMIT,
                        "%s: the table has %u joints and room for %u, a call may add %u; "
                        "a new table begins with the count 0",
                        what, *count, room, PCCD_JOINTS_MOST);
    }
    *chain = (struct chain){.joints = joints, .first = *count, .parent = parent};
    return 0;
}

/* Add a joint that does nothing yet. */
static struct pccd_joint *add(struct chain *chain, enum pccd_joint_kind kind)
{
    uint32_t at = chain->first + chain->count++;

    chain->joints[at] = (struct pccd_joint){
        .kind = kind, .parent = chain->parent, .rotation = {0, 0, 0, 1}};
    chain->parent = at;
    return &chain->joints[at];
}

/* Judge joints from .. to - 1 of a table. */
static int judge(const struct pccd_joint *joints, uint32_t from, uint32_t to,
                 const char *what)
{
    for (uint32_t at = from; at < to; at++) {
        const char *fault = common_joint_fault(&joints[at], at);

        if (fault != NULL) {
            return cli_fail(NULL, PCCD_E_INVAL, "%s: of joint %u %s", what, at, fault);
        }
    }
    return 0;
}

/* Judge what was added, and count it. */
static int end(const struct chain *chain, const char *what, uint32_t *count)
{
    int status = judge(chain->joints, chain->first, chain->first + chain->count, what);

    *count = chain->first + (status == 0 ? chain->count : 0);
    return status;
}

int pccd_joints_screw(const double centre[3], const double axis[3], double angle,
                      double shift, uint32_t parent, struct pccd_joint *joints,
                      uint32_t room, uint32_t *count)
{
    static const char what[] = "joints_screw";
    struct chain chain;
    struct pccd_joint *turn;
    int status = begin(&chain, what, parent, joints, room, count);

    if (status != 0) {
        return status;
    }
    if (centre == NULL || axis == NULL) {
        return refuse(what, centre == NULL ? "centre is NULL" : "axis is NULL");
    }
    if (shift != 0) {
        struct pccd_joint *slide = add(&chain, PCCD_JOINT_SLIDE);

        memcpy(slide->axis, axis, sizeof slide->axis);
        slide->to[0] = shift;
    }
    turn = add(&chain, PCCD_JOINT_TURN);
    memcpy(turn->position, centre, sizeof turn->position);
    memcpy(turn->axis, axis, sizeof turn->axis);
    turn->to[0] = angle;
    struct pccd_joint *back = add(&chain, PCCD_JOINT_FIXED);
    for (size_t k = 0; k < 3; k++) {
        back->position[k] = -centre[k];
    }
    return end(&chain, what, count);
}

int pccd_joints_rotation_vector(const double origin0[3], const double origin1[3],
                                const double w0[3], const double w1[3], uint32_t parent,
                                struct pccd_joint *joints, uint32_t room, uint32_t *count)
{
    static const char what[] = "joints_rotation_vector";
    struct chain chain;
    int status = begin(&chain, what, parent, joints, room, count);

    if (status != 0) {
        return status;
    }
    if (origin0 == NULL || origin1 == NULL || w0 == NULL || w1 == NULL) {
        return refuse(what, "a vector is NULL");
    }
    struct pccd_joint *shift = add(&chain, PCCD_JOINT_SHIFT);
    memcpy(shift->from, origin0, sizeof shift->from);
    memcpy(shift->to, origin1, sizeof shift->to);
    struct pccd_joint *vector = add(&chain, PCCD_JOINT_VECTOR);
    memcpy(vector->from, w0, sizeof vector->from);
    memcpy(vector->to, w1, sizeof vector->to);
    return end(&chain, what, count);
}

/* ---- from pose to pose ------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* Set q to a rotation of length 1. False: it has no direction. */
static bool normalise(const double rotation[4], double q[4])
{
    double length = sqrt(dot(rotation, rotation) + rotation[3] * rotation[3]);

    for (size_t k = 0; k < 4; k++) {
        q[k] = rotation[k] / length;
    }
    return common_is_joint_length(length);
}

/* Set q to what turns by a first: b = q a, all of length 1. */
static void turn_between(const double a[4], const double b[4], double q[4])
{
    q[0] = (b[0] * a[3] - b[3] * a[0]) - (b[1] * a[2] - b[2] * a[1]);
    q[1] = (b[1] * a[3] - b[3] * a[1]) - (b[2] * a[0] - b[0] * a[2]);
    q[2] = (b[2] * a[3] - b[3] * a[2]) - (b[0] * a[1] - b[1] * a[0]);
    q[3] = (b[3] * a[3] + dot(a, b));
}

/* A turn: about u by `angle`, whole turns left out. */
struct way {
    double u[3];
    double angle;
};

/* Choose the way of a turn q of length 1. */
static int choose(const char *what, double q[4], const double axis[3], struct way *way)
{
    double sine = common_length(q), along = axis != NULL ? dot(q, axis) : 0;
    double side = axis != NULL ? along : q[3];

    *way = (struct way){.angle = 0};
    if (sine < DBL_MIN) { /* both are the same: about the caller's axis, if any */
        for (size_t k = 0; k < 3 && axis != NULL; k++) {
            way->u[k] = axis[k];
        }
        return 0;
    }
    if (axis == NULL && 2 * fabs(q[3]) < AMBIGUOUS) {
        return refuse(what, "they are half a turn apart, within 1e-6 radians: an axis "
                            "must say which way");
    }
    if (axis != NULL && !(fabs(along) > AMBIGUOUS * sine * common_length(axis))) {
        return refuse(what, "the axis is across that of the turn: it does not say which "
                            "way");
    }
    for (size_t k = 0; k < 3; k++) {
        way->u[k] = (side < 0 ? -q[k] : q[k]) / sine;
    }
    way->angle = 2 * atan2(sine, side < 0 ? -q[3] : q[3]);
    return 0;
}

int pccd_joints_poses(const struct pccd_pose *from, const struct pccd_pose *to,
                      int32_t turns, const double axis[3], uint32_t parent,
                      struct pccd_joint *joints, uint32_t room, uint32_t *count)
{
    static const char what[] = "joints_poses";
    struct chain chain;
    struct way way;
    double a[4], b[4], q[4];
    int status = begin(&chain, what, parent, joints, room, count);

    if (status != 0) {
        return status;
    }
    if (from == NULL || to == NULL) {
        return refuse(what, from == NULL ? "from is NULL" : "to is NULL");
    }
    COMMON_ROUNDING_HERE;
    if (!normalise(from->rotation, a) || !normalise(to->rotation, b)) {
        return refuse(what, "the length of a rotation is not in 1e-9 .. 1e9");
    }
    if (axis != NULL && !common_is_joint_length(common_length(axis))) {
        return refuse(what, "the length of the axis is not in 1e-9 .. 1e9");
    }
    turn_between(a, b, q);
    status = choose(what, q, axis, &way);
    if (status != 0) {
        return status;
    }
    if (turns != 0 && common_length(way.u) == 0) {
        return refuse(what, "both rotations are the same: whole turns need an axis");
    }
    struct pccd_joint *shift = add(&chain, PCCD_JOINT_SHIFT);
    memcpy(shift->from, from->position, sizeof shift->from);
    memcpy(shift->to, to->position, sizeof shift->to);
    if (way.angle != 0 || turns != 0) {
        struct pccd_joint *turn = add(&chain, PCCD_JOINT_TURN);

        memcpy(turn->axis, way.u, sizeof turn->axis);
        turn->to[0] = way.angle + turns * (2 * PI);
    }
    memcpy(add(&chain, PCCD_JOINT_FIXED)->rotation, a, sizeof a);
    return end(&chain, what, count);
}

/* ---- rotations --------------------------------------------------------------------- */

/* The most by which a number of R^T R differs from that of 1. */
static double difference_from_rotation(const double m[12])
{
    double most = 0;

    for (size_t i = 0; i < 9; i++) {
        size_t k = i / 3, l = i % 3;
        double sum = (m[k] * m[l] + m[4 + k] * m[4 + l]) + m[8 + k] * m[8 + l];
        double off = fabs(sum - (k == l ? 1 : 0));

        most = off > most || isnan(off) ? off : most;
    }
    return most;
}

int pccd_rotation_of_matrix(const double m[12], double rotation[4])
{
    static const char what[] = "rotation_of_matrix";
    double q[4], length, off;

    if (m == NULL || rotation == NULL) {
        return refuse(what, m == NULL ? "m is NULL" : "rotation is NULL");
    }
    COMMON_ROUNDING_HERE;
    off = difference_from_rotation(m);
    if (!(off <= ROTATION_TOLERANCE)) {
        return cli_fail(NULL, PCCD_E_INVAL,
                        "%s: R^T R differs from that of a rotation by %g, more than %g",
                        what, off, ROTATION_TOLERANCE);
    }
    if ((m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8])) +
            m[2] * (m[4] * m[9] - m[5] * m[8]) <
        0) {
        return refuse(what, "it mirrors");
    }
    /* The row of four times the products of q that has the largest square. */
    double squares[4] = {m[0] - m[5] - m[10], m[5] - m[0] - m[10], m[10] - m[0] - m[5],
                         m[0] + m[5] + m[10]};
    size_t largest = 0;
    for (size_t k = 1; k < 4; k++) {
        largest = squares[k] > squares[largest] ? k : largest;
    }
    const double sums[3] = {m[9] + m[6], m[2] + m[8], m[4] + m[1]};
    const double differences[3] = {m[9] - m[6], m[2] - m[8], m[4] - m[1]};
    for (size_t k = 0; k < 3; k++) {
        q[k] = largest == 3 ? differences[k] : k == largest ? 0 : sums[3 - k - largest];
    }
    q[3] = largest == 3 ? 0 : differences[largest];
    q[largest] = 1 + squares[largest];
    length = sqrt(dot(q, q) + q[3] * q[3]);
    for (size_t k = 0; k < 4; k++) {
        rotation[k] = (q[3] < 0 ? -q[k] : q[k]) / length;
    }
    return 0;
}

int pccd_joints_place(const struct pccd_joint *joints, uint32_t count, uint32_t joint,
                      double t, double m[12])
{
    static const char what[] = "joints_place";

    if (joints == NULL || m == NULL || joint >= count || !(t >= 0 && t <= 1)) {
        return refuse(what, joints == NULL   ? "joints is NULL"
                            : m == NULL      ? "m is NULL"
                            : joint >= count ? "there is no such joint"
                                             : "t is not in 0 .. 1");
    }
    int status = judge(joints, 0, count, what);
    if (status != 0) {
        return status;
    }
    COMMON_ROUNDING_HERE;
    common_joint_transform(joints, joint, t, m);
    return 0;
}
