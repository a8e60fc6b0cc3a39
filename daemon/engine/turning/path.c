/* path.c - where the points of a path are, and how fast they go. */
#include "path.h"

#include <math.h>
#include <string.h>

#include "rotation.h"
#include "sine.h"
#include "two.h"
#include "vec.h"

/* More than what rounding takes off: sums and products of positive numbers; places, of
 * their magnitudes. */
#define SLOP (1 + 0x1p-40)

bool eng_path_is_still(const struct eng_path *path)
{
    return path->count == 0;
}

static struct eng_pair_number value_at(const struct eng_path_joint *joint, int i,
                                       double t)
{
    double product_rest, sum_rest;
    double product = eng_two_product(t, joint->by[i], &product_rest);
    double sum = eng_two_sum(joint->from[i], product, &sum_rest);
    double rest =
        ((sum_rest + product_rest) + t * joint->by_rest[i]) + joint->from_rest[i];
    struct eng_pair_number value;
    value.hi = eng_two_sum(sum, rest, &value.lo);
    return value;
}

/* Set m to m times what the joint does at time t. */
static void move(double m[12], const struct eng_path_joint *joint, double t)
{
    if (joint->kind == PCCD_JOINT_TURN) {
        struct eng_pair_number angle = value_at(joint, 0, t);
        double sine, cosine;
        eng_sine(angle.hi, angle.lo, &sine, &cosine);
        eng_rotation_turn(m, sine, cosine);
    } else if (joint->kind == PCCD_JOINT_SHIFT) {
        const double d[3] = {t * joint->by[0], t * joint->by[1], t * joint->by[2]};
        eng_rotation_shift(m, d);
    } else {
        const struct eng_pair_number w[3] = {value_at(joint, 0, t), value_at(joint, 1, t),
                                             value_at(joint, 2, t)};
        double r[12];
        eng_rotation_of_vector(w, r);
        eng_rotation_multiply(m, r);
    }
}

void eng_path_pose(const struct eng_path *path, double t, struct eng_path_pose *pose)
{
    const double *first = path->count > 0 ? path->joints[0].before : path->last;
    memcpy(pose->m, first, sizeof pose->m);
    memcpy(pose->error, path->error, sizeof pose->error);
    for (uint32_t i = 0; i < path->count; i++) {
        if (i > 0) {
            eng_rotation_multiply(pose->m, path->joints[i].before);
        }
        move(pose->m, &path->joints[i], t);
    }
    if (path->count > 0) {
        eng_rotation_multiply(pose->m, path->last);
    }
}

/* Largest distances of points: from a z axis, and from the origin. */
struct distances {
    double axis;
    double origin;
};

/* Return those of the corners of a box in the frame of the last joint. */
static struct distances measure_box(const struct eng_path *path,
                                    const struct eng_path_box *box)
{
    const double *m = path->last;
    struct distances most = {0, 0};
    double size = 0;
    for (int i = 0; i < 8; i++) {
        double b[3], y[3];
        for (int k = 0; k < 3; k++) {
            b[k] = i >> k & 1 ? box->hi[k] : box->lo[k];
        }
        for (int k = 0; k < 3; k++) {
            y[k] = eng_dot(m + 4 * k, b) + m[4 * k + 3];
        }
        double flat = y[0] * y[0] + y[1] * y[1];
        most.axis = eng_most(most.axis, flat);
        most.origin = eng_most(most.origin, flat + y[2] * y[2]);
        size = eng_most(size, eng_size(b));
    }
    double error = path->error[0] + path->error[1] * size;
    most.axis = sqrt(most.axis) * SLOP + error;
    most.origin = sqrt(most.origin) * SLOP + error;
    return most;
}

/* Bounds of a point's velocity and acceleration. */
struct pace {
    double speed;
    double bend;
};

/* From the last joint to the first: what a joint adds to what those behind it do. */
static struct pace bound_pace(const struct eng_path *path, const struct eng_path_box *box,
                              double t1)
{
    struct pace pace = {0, 0};
    struct distances far = measure_box(path, box);
    for (uint32_t i = path->count; i-- > 0;) {
        const struct eng_path_joint *joint = &path->joints[i];
        const double *g = joint->before;
        double rate = joint->rate;
        if (joint->kind == PCCD_JOINT_SHIFT) {
            pace.speed += rate;
            far.origin += rate * t1;
        } else {
            bool is_turn = joint->kind == PCCD_JOINT_TURN;
            double arm = is_turn ? far.axis : far.origin;
            double square = is_turn ? rate * rate : 1.5 * rate * rate;
            pace.bend += square * arm + 2 * rate * pace.speed;
            pace.speed += rate * arm;
        }
        double flat = g[3] * g[3] + g[7] * g[7];
        far.axis = far.origin + sqrt(flat) + path->error[0];
        far.origin = far.origin + sqrt(flat + g[11] * g[11]) + path->error[0];
    }
    pace.speed *= SLOP;
    pace.bend *= SLOP;
    return pace;
}

double eng_path_speed(const struct eng_path *path, const struct eng_path_box *box,
                      double t0, double t1)
{
    (void)t0;
    return bound_pace(path, box, t1).speed;
}

double eng_path_bend(const struct eng_path *path, const struct eng_path_box *box,
                     double t0, double t1)
{
    (void)t0;
    return bound_pace(path, box, t1).bend;
}
