/* path_make.c - make a path: what cancels left out, what does not move multiplied
 * together, axes turned to z.
 *
 * Errors grow along the path as BOUNDS.md says, all in units of what they are: of the
 * matrix by the root of the sum of the squares of its entries, of the place by length.
 */
#include "path.h"

#include <math.h>
#include <string.h>

#include "pace.h"
#include "rotation.h"
#include "sine.h"
#include "two.h"
#include "vec.h"

/* Rounding of one operation, and more than what rounding takes off sums of errors. */
#define ROUNDED 0x1.01p-53
#define SLOP    (1 + 0x1p-40)

/* Errors of rotations, in roundings. */
#define QUATERNION_ERROR (28 * ROUNDED)
#define AXIS_ERROR       (36 * ROUNDED)
#define TURN_ERROR       (5 * ROUNDED)
#define VECTOR_ERROR     (64 * ROUNDED)
#define PRODUCT_ERROR    (10 * ROUNDED)

/* More than all that is lost below the normal range. */
#define LOST 0x1p-900

/* Bounds of the errors of a product of rotations and shifts, and of the place. */
struct errors {
    double turn;
    double place;
    double reach; /* at least the length of [t] */
};

/* A path in the making. */
struct maker {
    struct eng_path *path;
    double fixed[12]; /* what does not move, behind the last joint */
    struct errors fixed_errors;
    struct errors errors; /* of all that is in front of it */
};

static const double nowhere[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* Return at least the length. */
static double length_of(const double d[3])
{
    return sqrt(eng_dot(d, d)) * SLOP + ENG_PACE_LOST;
}

static void grow_turn(struct errors *errors, double error)
{
    errors->turn = (errors->turn + error + errors->turn * error + PRODUCT_ERROR) * SLOP;
}

/* Add a shift by what is at most `length` long and off by `error`. */
static void grow_place(struct errors *errors, double length, double error)
{
    errors->reach = (errors->reach + length) * SLOP;
    errors->place = (errors->place + errors->turn * length + 2 * error +
                     6 * ROUNDED * length + 2 * ROUNDED * errors->reach) *
                    SLOP;
}

/* Multiply by a rotation; an error of 0: it takes axes to axes, and the product is
 * exact. */
static void turn_fixed(struct maker *maker, const double rotation[12], double error)
{
    eng_rotation_multiply(maker->fixed, rotation);
    if (error > 0) {
        grow_turn(&maker->fixed_errors, error);
    }
}

static void shift_fixed(struct maker *maker, const double d[3], double error)
{
    if (eng_size(d) > 0) {
        eng_rotation_shift(maker->fixed, d);
        grow_place(&maker->fixed_errors, length_of(d), error);
    }
}

static void transpose(double m[12])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double swap = m[4 * i + j];
        m[4 * i + j] = m[4 * j + i];
        m[4 * j + i] = swap;
    }
}

/* Take in the errors of what is fixed, as the product of what is in front and of it. */
static void join_fixed(struct maker *maker)
{
    const struct errors *fixed = &maker->fixed_errors;
    grow_place(&maker->errors, fixed->reach, fixed->place);
    grow_turn(&maker->errors, fixed->turn);
}

/* Add a joint that moves, whose values are there; kind, before and rate are set. */
static void add_joint(struct maker *maker, uint32_t kind, struct eng_path_joint *joint)
{
    joint->kind = kind;
    joint->rate = length_of(joint->by);
    memcpy(joint->before, maker->fixed, sizeof joint->before);
    const double origin[3] = {maker->fixed[3], maker->fixed[7], maker->fixed[11]};
    const double beside[3] = {origin[0], origin[1], 0};
    joint->arm = length_of(beside) + maker->fixed_errors.place;
    joint->far = length_of(origin) + maker->fixed_errors.place;
    maker->path->joints[maker->path->count++] = *joint;
    join_fixed(maker);
    if (kind == PCCD_JOINT_SHIFT) {
        grow_place(&maker->errors, joint->rate, 8 * ROUNDED * joint->rate);
    } else {
        grow_turn(&maker->errors, kind == PCCD_JOINT_TURN ? TURN_ERROR : VECTOR_ERROR);
    }
    memcpy(maker->fixed, nowhere, sizeof maker->fixed);
    memset(&maker->fixed_errors, 0, sizeof maker->fixed_errors);
}

static void place_joint(struct maker *maker, const struct pccd_joint *joint,
                        bool is_inverse)
{
    const double *q = joint->rotation;
    double x = q[0], y = q[1], z = q[2], w = q[3];
    double square = (x * x + y * y) + (z * z + w * w);
    double r[12] = {0};
    bool turns = x != 0 || y != 0 || z != 0;
    r[0] = ((w * w + x * x) - (y * y + z * z)) / square;
    r[5] = ((w * w + y * y) - (x * x + z * z)) / square;
    r[10] = ((w * w + z * z) - (x * x + y * y)) / square;
    const eng_d2 upper = (eng_d2){x * y, x * z} + (eng_d2){-(w * z), w * y};
    const eng_d2 lower = (eng_d2){x * z, y * z} + (eng_d2){-(w * y), w * x};
    eng_d2_store(r + 1, 2 * upper / square);
    eng_d2_store(r + 8, 2 * lower / square);
    r[4] = 2 * (x * y + w * z) / square;
    r[6] = 2 * (y * z - w * x) / square;
    if (is_inverse) {
        double back[3] = {-joint->position[0], -joint->position[1], -joint->position[2]};
        transpose(r);
        if (turns) {
            turn_fixed(maker, r, QUATERNION_ERROR);
        }
        shift_fixed(maker, back, 0);
    } else {
        shift_fixed(maker, joint->position, 0);
        if (turns) {
            turn_fixed(maker, r, QUATERNION_ERROR);
        }
    }
}

/* Set u to the unit vector along an axis. */
static void set_unit(double u[3], const double axis[3])
{
    double length = sqrt(eng_dot(axis, axis));
    for (int i = 0; i < 3; i++) {
        u[i] = axis[i] / length;
    }
}

/* Set r to a rotation that takes z to an axis, and return its error.
 * Source: Duff et al.: Building an orthonormal basis, revisited, 2017. */
static double set_frame(double r[12], const double axis[3])
{
    double u[3];
    set_unit(u, axis);
    double sign = u[2] < 0 ? -1.0 : 1.0;
    double a = -1 / (sign + u[2]);
    double b = u[0] * u[1] * a;
    const double rows[12] = {1 + sign * u[0] * u[0] * a,
                             b,
                             u[0],
                             0,
                             sign * b,
                             sign + u[1] * u[1] * a,
                             u[1],
                             0,
                             -sign * u[0],
                             -u[1],
                             u[2],
                             0};
    memcpy(r, rows, sizeof rows);
    bool is_straight = (u[0] != 0) + (u[1] != 0) + (u[2] != 0) == 1;
    return is_straight ? 0 : AXIS_ERROR;
}

static void add_turn(struct maker *maker, const double axis[3],
                     struct eng_path_joint *joint)
{
    double frame[12];
    double error = set_frame(frame, axis);
    turn_fixed(maker, frame, error);
    if (joint->by[0] != 0) {
        add_joint(maker, PCCD_JOINT_TURN, joint);
    } else {
        double sine, cosine;
        common_sine(joint->from[0], joint->from_rest[0], &sine, &cosine);
        eng_rotation_turn(maker->fixed, sine, cosine);
        grow_turn(&maker->fixed_errors, TURN_ERROR);
    }
    transpose(frame);
    turn_fixed(maker, frame, error);
}

static void add_shift(struct maker *maker, struct eng_path_joint *joint, double error)
{
    shift_fixed(maker, joint->from, error * length_of(joint->from));
    memset(joint->from, 0, sizeof joint->from);
    if (joint->by[0] != 0 || joint->by[1] != 0 || joint->by[2] != 0) {
        add_joint(maker, PCCD_JOINT_SHIFT, joint);
    }
}

static void add_slide(struct maker *maker, const double axis[3],
                      struct eng_path_joint *joint)
{
    double u[3];
    double from = joint->from[0], by = joint->by[0];
    set_unit(u, axis);
    for (int i = 0; i < 3; i++) {
        joint->from[i] = from * u[i];
        joint->by[i] = by * u[i];
        joint->by_rest[i] = 0;
    }
    add_shift(maker, joint, 8 * ROUNDED);
}

static bool are_parallel(const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double left_rest, right_rest;
        if (eng_two_product(a[i], b[j], &left_rest) !=
                eng_two_product(a[j], b[i], &right_rest) ||
            left_rest != right_rest) {
            return false;
        }
    }
    return true;
}

static struct eng_pair_number length_along(const double w[3], const double axis[3])
{
    const struct eng_pair_number pairs[3] = {{w[0], 0}, {w[1], 0}, {w[2], 0}};
    struct eng_pair_number length = eng_rotation_length(pairs);
    if (eng_dot(w, axis) < 0) {
        length = (struct eng_pair_number){-length.hi, -length.lo};
    }
    return length;
}

/* Add a rotation vector that goes from `from` to `to`: if both are along one axis, it
 * turns about that. */
static void add_vector(struct maker *maker, const double from[3], const double to[3],
                       struct eng_path_joint *joint)
{
    const double *axis = eng_size(from) > eng_size(to) ? from : to;
    bool moves = joint->by[0] != 0 || joint->by[1] != 0 || joint->by[2] != 0;
    if (eng_size(axis) >= 0x1p-60 && are_parallel(from, to)) {
        struct eng_pair_number begin = length_along(from, axis);
        struct eng_pair_number end = length_along(to, axis);
        struct eng_path_joint turn = {.from = {begin.hi}, .from_rest = {begin.lo}};
        turn.by[0] = eng_two_sum(end.hi, -begin.hi, &turn.by_rest[0]);
        turn.by[0] = eng_two_sum(turn.by[0], turn.by_rest[0] + (end.lo - begin.lo),
                                 &turn.by_rest[0]);
        add_turn(maker, axis, &turn);
    } else if (moves) {
        add_joint(maker, PCCD_JOINT_VECTOR, joint);
    } else {
        const struct eng_pair_number w[3] = {{from[0], 0}, {from[1], 0}, {from[2], 0}};
        double r[12];
        eng_rotation_of_vector(w, r);
        turn_fixed(maker, r, VECTOR_ERROR);
    }
}

static void move_joint(struct maker *maker, const struct pccd_joint *joint,
                       bool is_inverse)
{
    struct eng_path_joint moving;
    double from[3], to[3];
    memset(&moving, 0, sizeof moving);
    for (int i = 0; i < 3; i++) {
        from[i] = is_inverse ? -joint->from[i] : joint->from[i];
        to[i] = is_inverse ? -joint->to[i] : joint->to[i];
        moving.from[i] = from[i];
        moving.by[i] = eng_two_sum(to[i], -from[i], &moving.by_rest[i]);
    }
    switch (joint->kind) {
    case PCCD_JOINT_TURN:
        add_turn(maker, joint->axis, &moving);
        break;
    case PCCD_JOINT_SLIDE:
        add_slide(maker, joint->axis, &moving);
        break;
    case PCCD_JOINT_SHIFT:
        add_shift(maker, &moving, 0);
        break;
    case PCCD_JOINT_VECTOR:
        add_vector(maker, from, to, &moving);
        break;
    default: /* fixed */
        break;
    }
}

/* List the joints of the path, those of the first link, then those of the second, from
 * the first link on. Returns how many there are, *backwards of them the first link's, or
 * PCCD_E_LIMIT. */
static int list_joints(const struct pccd_joint *joints, uint32_t of, uint32_t to,
                       uint32_t list[ENG_PATH_JOINTS_MAX], int *backwards)
{
    uint32_t head = 0, tail = ENG_PATH_JOINTS_MAX;
    while (of != to) {
        if (head == tail) {
            return PCCD_E_LIMIT;
        }
        if (to == PCCD_NO_JOINT || (of != PCCD_NO_JOINT && of > to)) {
            list[head++] = of;
            of = joints[of].parent;
        } else {
            list[--tail] = to;
            to = joints[to].parent;
        }
    }
    *backwards = (int)head;
    memmove(list + head, list + tail, (ENG_PATH_JOINTS_MAX - tail) * sizeof *list);
    return (int)(head + ENG_PATH_JOINTS_MAX - tail);
}

/* Set what the origin of the link does, and the matrix to points by their distance. */
static void set_jerk(struct eng_path *path)
{
    const double origin[3] = {path->last[3], path->last[7], path->last[11]};
    double rate = 0;
    for (uint32_t i = 0; i < path->count; i++) {
        rate += path->joints[i].kind == PCCD_JOINT_SHIFT ? 0 : path->joints[i].rate;
    }
    path->far = length_of(origin) + path->error[0];
    path->jerk[0] = eng_pace_bound(path, path->far, path->far, 1).jerk;
    path->jerk[1] = 1.75 * rate * rate * rate * SLOP;
}

int eng_path_between(const struct pccd_joint *joints, uint32_t of, uint32_t to,
                     struct eng_path *path)
{
    uint32_t list[ENG_PATH_JOINTS_MAX];
    int backwards = 0;
    int count = list_joints(joints, of, to, list, &backwards);
    if (count < 0) {
        return count;
    }
    struct maker maker = {.path = path};
    path->count = 0;
    memcpy(maker.fixed, nowhere, sizeof maker.fixed);
    for (int i = 0; i < count; i++) {
        const struct pccd_joint *joint = &joints[list[i]];
        if (i < backwards) {
            move_joint(&maker, joint, true);
            place_joint(&maker, joint, true);
        } else {
            place_joint(&maker, joint, false);
            move_joint(&maker, joint, false);
        }
    }
    join_fixed(&maker);
    memcpy(path->last, maker.fixed, sizeof path->last);
    const struct errors *errors = &maker.errors;
    path->error[0] = (errors->place + 2 * ROUNDED * errors->reach) * SLOP + LOST;
    path->error[1] = (1.75 * errors->turn + 13 * ROUNDED) * SLOP;
    set_jerk(path);
    return PCCD_OK;
}
