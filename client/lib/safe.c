/* safe.c - go as far as nothing meets. */
#include <stdlib.h>
#include <string.h>

#include "client.h"
#include "coordinates.h"
#include "joints.h"
#include "rounding.h"

/* Rounding moves a position by an ulp, so that the second step is free nearly always; of
 * bodies that turn what is possible, so near the end of it, may take some more. The later
 * ones go half as far as the one before. */
#define TRIES     48u
#define TRIES_FEW 9u

/* The part that is left out of what was free, of the try after the first. It grows by
 * four each time. */
#define SHORTER 0x1p-20

/* Return whether two arrays of so many bytes have any in common. */
static bool do_overlap(const void *a, const void *b, size_t bytes)
{
    uintptr_t from = (uintptr_t)a;
    uintptr_t other = (uintptr_t)b;

    return (from < other ? other - from : from - other) < bytes;
}

/* Where a motion begins and ends: numbers, of vertices or of transforms. */
struct ends {
    const void *from, *to;
    size_t bytes;
    bool is_double;
};

static struct ends ends_of(const struct pccd_motion *motion)
{
    if (motion->m0 != NULL || motion->m1 != NULL) {
        return (struct ends){motion->m0, motion->m1, 12 * sizeof(double), true};
    }
    return (struct ends){motion->x0, motion->x1,
                         motion->count * common_vertex_bytes((uint32_t)motion->format),
                         motion->format == PCCD_FORMAT_F64};
}

/* Return whether a motion hangs on a joint, if there are any. */
static bool turns(const struct pccd_motion *motion)
{
    return motion->x0 == NULL && motion->x1 == NULL && motion->m0 == NULL &&
           motion->m1 == NULL;
}

static int check(struct pccd_client *client, const struct pccd_motion *motions,
                 uint32_t motion_count, uint32_t joint_count, void *const *x,
                 const double *part)
{
    if (part == NULL || (motion_count > 0 && (motions == NULL || x == NULL))) {
        return cli_fail(client, PCCD_E_INVAL, "%s is NULL",
                        part == NULL      ? "part"
                        : motions == NULL ? "motions"
                                          : "x");
    }
    for (uint32_t i = 0; i < motion_count; i++) {
        const struct pccd_motion *motion = &motions[i];
        const struct ends ends = ends_of(motion);
        bool is_turning = turns(motion) && joint_count > 0;

        if (x[i] == NULL || (!is_turning && (ends.from == NULL || ends.to == NULL))) {
            return cli_fail(
                client, PCCD_E_INVAL,
                "motion %u: it needs x0 and x1, or m0 and m1, or a joint, and "
                "where to put x",
                i);
        }
        if (is_turning) {
            continue;
        }
        if (motion->format != PCCD_FORMAT_F32 && motion->format != PCCD_FORMAT_F64) {
            return cli_fail(client, PCCD_E_INVAL, "motion %u: unknown format %d", i,
                            (int)motion->format);
        }
        if (do_overlap(x[i], ends.from, ends.bytes) ||
            do_overlap(x[i], ends.to, ends.bytes)) {
            return cli_fail(client, PCCD_E_INVAL, "motion %u: x lies in %s", i,
                            motion->m0 != NULL ? "m0 or m1" : "x0 or x1");
        }
    }
    return 0;
}

static double between(double from, double to, double part)
{
    return part == 1 ? to : from + part * (to - from);
}

/* x = from + part (to - from), rounded to the motion's format; both ends are exact. Of
 * transforms, too: each vertex is then on its straight way, up to rounding. */
static void go(const struct pccd_motion *motion, double part, void *x)
{
    const struct ends ends = ends_of(motion);
    size_t count = ends.bytes / (ends.is_double ? sizeof(double) : sizeof(float));

    if (part == 0 || part == 1) {
        memcpy(x, part == 0 ? ends.from : ends.to, ends.bytes);
        return;
    }
    COMMON_ROUNDING_HERE;
    for (size_t i = 0; i < count; i++) {
        if (ends.is_double) {
            ((double *)x)[i] = between(((const double *)ends.from)[i],
                                       ((const double *)ends.to)[i], part);
        } else {
            ((float *)x)[i] = (float)between((double)((const float *)ends.from)[i],
                                             (double)((const float *)ends.to)[i], part);
        }
    }
}

/* A step and its shorter tries. */
struct way {
    const struct pccd_motion *motions; /* the caller's */
    uint32_t count;
    const struct pccd_joint *joints; /* the caller's: [joint_count] */
    uint32_t joint_count;
    void *const *x;
    struct pccd_motion *shorter;       /* [count] */
    struct pccd_joint *shorter_joints; /* [joint_count] */
};

static int begin_way(struct pccd_client *client, struct way *way)
{
    way->shorter = malloc(((size_t)way->count + 1) * sizeof *way->shorter);
    way->shorter_joints =
        malloc(((size_t)way->joint_count + 1) * sizeof *way->shorter_joints);
    return way->shorter != NULL && way->shorter_joints != NULL
               ? 0
               : cli_fail(client, PCCD_E_NOMEM, "no memory for the motions");
}

static void end_way(struct way *way)
{
    free(way->shorter);
    free(way->shorter_joints);
}

/* Have all go that part of their way: joints by their values. */
static void go_all(struct way *way, double part)
{
    COMMON_ROUNDING_HERE;
    for (uint32_t i = 0; i < way->joint_count; i++) {
        struct pccd_joint *joint = &way->shorter_joints[i];

        *joint = way->joints[i];
        for (int k = 0; k < 3; k++) {
            joint->to[k] = between(joint->from[k], joint->to[k], part);
        }
    }
    for (uint32_t i = 0; i < way->count; i++) {
        struct pccd_motion *shorter = &way->shorter[i];

        *shorter = way->motions[i];
        if (turns(shorter)) {
            common_joint_transform(way->shorter_joints, shorter->first, 1, way->x[i]);
            continue;
        }
        go(shorter, part, way->x[i]);
        if (shorter->m0 != NULL) {
            shorter->m1 = way->x[i];
        } else {
            shorter->x1 = way->x[i];
        }
    }
}

/* Return how far one more try goes when the last one, to `part`, was free up to `safe` of
 * it. */
static double shorten(double part, double safe, uint32_t tried)
{
    if (tried + 1 == TRIES) {
        return 0;
    }
    if (tried == 0) {
        return part * safe; /* of the step as it was asked for */
    }
    return part * (safe > 0.5 && tried < TRIES_FEW
                       ? safe * (1 - SHORTER * (double)(1u << 2 * (tried - 1)))
                       : 0.5);
}

int pccd_step_safe(struct pccd_client *client, uint32_t scene,
                   const struct pccd_motion *motions, uint32_t motion_count,
                   const struct pccd_step_settings *settings, void *const *x,
                   double *part, struct pccd_answer *answer)
{
    struct pccd_step_settings quick = PCCD_STEP_SETTINGS_INIT;
    struct way way = {.motions = motions, .count = motion_count, .x = x};
    double at = 1;
    double safe;
    int status = 0;

    CLI_ENTER_OR_RETURN(client);
    if (settings != NULL) {
        status = cli_struct_read(client, "settings of the step", settings, &quick,
                                 sizeof quick);
    }
    if (status == 0) {
        status = check(client, motions, motion_count, quick.joint_count, x, part);
    }
    if (status == 0 && quick.hold) {
        status = cli_fail(client, PCCD_E_INVAL,
                          "step_safe: a step that waits for another client's cannot be "
                          "tried again");
    }
    if (status == 0) {
        status = pccd_step(client, scene, motions, motion_count, settings, answer);
    }
    if (status != 0) {
        return status;
    }
    way.joints = quick.joints; /* the step has them: there are so many */
    way.joint_count = quick.joint_count;
    status = begin_way(client, &way);
    quick.mode = PCCD_MODE_FIRST;
    quick.joints = way.shorter_joints;
    safe = answer->safe_step;
    for (uint32_t tried = 0; status == 0 && safe < 1 && at > 0; tried++) {
        struct pccd_answer again = PCCD_ANSWER_INIT;

        at = shorten(at, safe, tried);
        go_all(&way, at);
        status = pccd_step(client, scene, way.shorter, motion_count, &quick, &again);
        safe = again.safe_step;
        pccd_answer_release(client, &again);
    }
    if (status == 0 && at == 1) {
        go_all(&way, 1);
    }
    end_way(&way);
    if (status != 0) {
        pccd_answer_release(client, answer);
        return status;
    }
    *part = at;
    return 0;
}
