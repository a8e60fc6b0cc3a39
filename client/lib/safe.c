/* safe.c - go as far as nothing meets. */
#include <stdlib.h>
#include <string.h>

#include "client.h"
#include "coordinates.h"
#include "rounding.h"
#include "step.h"

/* Rounding moves a position by an ulp, so that the second step is free nearly always. The
 * later ones go half as far as the one before. */
#define TRIES 48u

/* The part that is tried next of a step that was not free. */
#define SHORTER (1 - 0x1p-20)

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

static int check(struct pccd_client *client, const struct pccd_motion *motions,
                 uint32_t motion_count, void *const *x, const double *part)
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

        if (ends.from == NULL || ends.to == NULL || x[i] == NULL) {
            return cli_fail(client, PCCD_E_INVAL,
                            "motion %u: it needs x0 and x1, or m0 and m1, and where to "
                            "put x",
                            i);
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
        double a = ends.is_double ? ((const double *)ends.from)[i]
                                  : (double)((const float *)ends.from)[i];
        double b = ends.is_double ? ((const double *)ends.to)[i]
                                  : (double)((const float *)ends.to)[i];
        double at = a + part * (b - a);

        if (ends.is_double) {
            ((double *)x)[i] = at;
        } else {
            ((float *)x)[i] = (float)at;
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
    return part * (safe > 0.5 && tried < 4 ? safe * SHORTER : 0.5);
}

int pccd_step_safe(struct pccd_client *client, uint32_t scene,
                   const struct pccd_motion *motions, uint32_t motion_count,
                   const struct pccd_step_settings *settings, void *const *x,
                   double *part, struct pccd_answer *answer)
{
    struct pccd_step_settings quick = PCCD_STEP_SETTINGS_INIT;
    struct pccd_motion *shorter = NULL;
    double at = 1;
    double safe;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = check(client, motions, motion_count, x, part);
    if (status == 0 && settings != NULL) {
        status = cli_struct_read(client, "settings of the step", settings, &quick,
                                 sizeof quick);
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
    quick.mode = PCCD_MODE_FIRST;
    shorter = malloc(((size_t)motion_count + 1) * sizeof *shorter);
    if (shorter == NULL) {
        pccd_answer_release(client, answer);
        return cli_fail(client, PCCD_E_NOMEM, "no memory for the motions");
    }
    safe = answer->safe_step;
    for (uint32_t tried = 0; status == 0 && safe < 1 && at > 0; tried++) {
        struct pccd_answer again = PCCD_ANSWER_INIT;

        at = shorten(at, safe, tried);
        for (uint32_t i = 0; i < motion_count; i++) {
            shorter[i] = motions[i];
            go(&motions[i], at, x[i]);
            if (motions[i].m0 != NULL) {
                shorter[i].m1 = x[i];
            } else {
                shorter[i].x1 = x[i];
            }
        }
        status = pccd_step(client, scene, shorter, motion_count, &quick, &again);
        safe = again.safe_step;
        pccd_answer_release(client, &again);
    }
    if (at == 1) {
        for (uint32_t i = 0; i < motion_count; i++) {
            go(&motions[i], 1, x[i]);
        }
    }
    free(shorter);
    if (status != 0) {
        pccd_answer_release(client, answer);
        return status;
    }
    *part = at;
    return 0;
}
