/* pace.c - bounds of velocity and acceleration, and of the way off a chord. */
#include "pace.h"

#include <math.h>
#include <string.h>

#include "vec.h"

/* More than sqrt(3) / 216: what is off the parabola through three places, in |x'''| times
 * the cube of the span. */
#define OFF_PARABOLA 0.00802

/* From the last joint to the first: what each adds to what those behind it do. */
struct eng_pace eng_pace_bound(const struct eng_path *path, double arm, double far,
                               double t1)
{
    struct eng_pace pace = {0, 0, 0};
    for (uint32_t i = path->count; i-- > 0;) {
        const struct eng_path_joint *joint = &path->joints[i];
        double w = joint->rate;
        if (joint->kind == PCCD_JOINT_SHIFT) {
            pace.speed += w;
            far += w * t1;
        } else {
            double turned = joint->kind == PCCD_JOINT_TURN ? arm : far;
            double swept = w * turned;
            pace.jerk += w * (w * (swept + 3 * pace.speed) + 3 * pace.bend);
            pace.bend += w * (swept + 2 * pace.speed);
            pace.speed += swept;
        }
        arm = far + joint->arm;
        far += joint->far;
    }
    pace.speed *= ENG_PACE_SLOP;
    pace.bend *= ENG_PACE_SLOP;
    pace.jerk *= ENG_PACE_SLOP;
    return pace;
}

/* Return the largest length of what m makes of the corners of a box, that along x and y
 * alone in *flat, and the largest coordinate of the corners in *size. */
static double measure_corners(const double m[12], const struct eng_path_box *box,
                              double *flat, double *size)
{
    double far_square = 0, flat_square = 0;
    *size = eng_most(eng_size(box->lo), eng_size(box->hi));
    for (int i = 0; i < 8; i++) {
        double x = i & 1 ? box->hi[0] : box->lo[0];
        double y = i & 2 ? box->hi[1] : box->lo[1];
        double z = i & 4 ? box->hi[2] : box->lo[2];
        double a = ((m[0] * x + m[1] * y) + m[2] * z) + m[3];
        double b = ((m[4] * x + m[5] * y) + m[6] * z) + m[7];
        double c = ((m[8] * x + m[9] * y) + m[10] * z) + m[11];
        flat_square = eng_most(flat_square, a * a + b * b);
        far_square = eng_most(far_square, (a * a + b * b) + c * c);
    }
    *flat = sqrt(flat_square) * ENG_PACE_SLOP + ENG_PACE_LOST;
    return sqrt(far_square) * ENG_PACE_SLOP + ENG_PACE_LOST;
}

static struct eng_pace pace_of(const struct eng_path *path,
                               const struct eng_path_box *box, double t1)
{
    double flat, size;
    double far = measure_corners(path->last, box, &flat, &size);
    double error = path->error[0] + path->error[1] * size;
    return eng_pace_bound(path, flat + error, far + error, t1);
}

double eng_path_speed(const struct eng_path *path, const struct eng_path_box *box,
                      double t0, double t1)
{
    (void)t0; /* a joint's rate is the same at all times */
    return pace_of(path, box, t1).speed;
}

double eng_path_bend(const struct eng_path *path, const struct eng_path_box *box,
                     double t0, double t1)
{
    (void)t0;
    return pace_of(path, box, t1).bend;
}

/* Set way[0] + way[1] |b| to at least how far a point b of the link goes within a time h:
 * a turn takes none farther than twice its distance from the axis. */
static void bound_way(const struct eng_path *path, double h, double way[2])
{
    double far = path->far;
    double arm = far;
    way[0] = 0;
    way[1] = 0;
    for (uint32_t i = path->count; i-- > 0;) {
        const struct eng_path_joint *joint = &path->joints[i];
        double w = joint->rate;
        if (joint->kind == PCCD_JOINT_SHIFT) {
            way[0] += w * h;
            far += w;
        } else {
            double part = eng_least(w * h, 2);
            way[0] += part * (joint->kind == PCCD_JOINT_TURN ? arm : far);
            way[1] += part;
        }
        arm = far + joint->arm;
        far += joint->far;
    }
}

void eng_path_span(const struct eng_path *path, double t0, double t1,
                   const struct eng_path_pose poses[3], struct eng_path_span *span)
{
    double h = t1 - t0;
    double cube = OFF_PARABOLA * h * h * h;
    for (int i = 0; i < 12; i++) {
        span->m[i] = poses[1].m[i] - 0.5 * (poses[0].m[i] + poses[2].m[i]);
    }
    for (int i = 0; i < 2; i++) {
        span->error[i] = (4 * path->error[i] + cube * path->jerk[i]) * ENG_PACE_SLOP;
    }
    if (cube * path->jerk[1] > 1) {
        double way[2];
        bound_way(path, h, way);
        way[0] *= ENG_PACE_SLOP;
        way[1] *= 1.75 * ENG_PACE_SLOP;
        if (way[0] <= span->error[0] && way[1] <= span->error[1]) {
            memset(span->m, 0, sizeof span->m);
            memcpy(span->error, way, sizeof way);
        }
    }
}
