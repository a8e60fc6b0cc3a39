/* path.c - where a path takes points. */
#include "path.h"

#include <string.h>

#include "rotation.h"
#include "sine.h"
#include "two.h"

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
        common_sine(angle.hi, angle.lo, &sine, &cosine);
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
