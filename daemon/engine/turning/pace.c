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

/* Points, as they lie in the frame of the last joint: the largest squares of their
 * distances, and the largest coordinate before that. */
struct measured {
    double flat; /* along x and y alone */
    double far;
    double size;
};

static inline void measure(const double m[12], const double x[3],
                           struct measured *measured)
{
    double a = ((m[0] * x[0] + m[1] * x[1]) + m[2] * x[2]) + m[3];
    double b = ((m[4] * x[0] + m[5] * x[1]) + m[6] * x[2]) + m[7];
    double c = ((m[8] * x[0] + m[9] * x[1]) + m[10] * x[2]) + m[11];
    measured->flat = eng_most(measured->flat, a * a + b * b);
    measured->far = eng_most(measured->far, (a * a + b * b) + c * c);
    measured->size = eng_most(measured->size, eng_size(x));
}

/* Return the pace of all that is within `around` of what was measured. */
static struct eng_pace pace_of(const struct eng_path *path,
                               const struct measured *measured, double around, double t1)
{
    double error = path->error[0] + path->error[1] * (measured->size + around);
    double flat = sqrt(measured->flat) * ENG_PACE_SLOP + ENG_PACE_LOST;
    double far = sqrt(measured->far) * ENG_PACE_SLOP + ENG_PACE_LOST;
    return eng_pace_bound(path, flat + around + error, far + around + error, t1);
}

static struct eng_pace pace_of_box(const struct eng_path *path,
                                   const struct eng_path_box *box, double t1)
{
    struct measured measured = {0, 0, 0};
    for (int i = 0; i < 8; i++) {
        const double corner[3] = {i & 1 ? box->hi[0] : box->lo[0],
                                  i & 2 ? box->hi[1] : box->lo[1],
                                  i & 4 ? box->hi[2] : box->lo[2]};
        measure(path->last, corner, &measured);
    }
    return pace_of(path, &measured, 0, t1);
}

double eng_path_speed(const struct eng_path *path, const struct eng_path_box *box,
                      double t0, double t1)
{
    (void)t0; /* a joint's rate is the same at all times */
    return pace_of_box(path, box, t1).speed;
}

double eng_path_bend(const struct eng_path *path, const struct eng_path_box *box,
                     double t0, double t1)
{
    (void)t0;
    return pace_of_box(path, box, t1).bend;
}

double eng_path_bend_of(const struct eng_path *path, const double (*x)[3], uint32_t count,
                        double around)
{
    struct measured measured = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        measure(path->last, x[i], &measured);
    }
    return pace_of(path, &measured, around, 1).bend;
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
