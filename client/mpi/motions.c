/* motions.c - what the caller says that moves.
 *
 * Room:     client/mpi.
 * Does:     copy positions, and compute those that are given by matrices.
 * Threads:  one.
 * Source:   motions.h.
 */
#include "motions.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define COORDINATE_MAX 1e18

static void transform(const double m[12], const double x[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        const double *r = m + 4 * k;
        double sum = r[0] * x[0];
        sum = sum + r[1] * x[1];
        sum = sum + r[2] * x[2];
        out[k] = sum + r[3];
    }
}

/* One vertex of a motion. */
static void copy_vertex(const struct pccd_motion *motion, const void *from, uint32_t i,
                        double out[3])
{
    if (motion->format == PCCD_FORMAT_F64) {
        memcpy(out, (const double *)from + 3 * (size_t)i, 3 * sizeof *out);
    } else {
        const float *in = (const float *)from + 3 * (size_t)i;
        out[0] = (double)in[0];
        out[1] = (double)in[1];
        out[2] = (double)in[2];
    }
}

/* The vertices of a motion, by m or from `from`. Are all coordinates finite, and none
 * beyond 1e18? */
static bool copy_run(const struct pccd_motion *motion, const void *from,
                     const double m[12], const double (*registered)[3], double (*to)[3])
{
    bool is_good = true;
    for (uint32_t i = 0; i < motion->count; i++) {
        double *out = to[motion->first + i];
        if (m != NULL) {
            transform(m, registered[motion->first + i], out);
        } else {
            copy_vertex(motion, from, i, out);
        }
        is_good &= fabs(out[0]) <= COORDINATE_MAX && fabs(out[1]) <= COORDINATE_MAX &&
                   fabs(out[2]) <= COORDINATE_MAX;
    }
    return is_good;
}

/* Does it say where every given vertex is? Then nothing of the last step stays. */
static bool is_of_all(const struct pccd_motion *motion, const struct ranks_object *object)
{
    return motion->count == object->mesh->vertex_count;
}

static int check_motion(struct pccd_mpi *world, const struct pccd_motion *motion,
                        const struct ranks_object *object)
{
    struct ranks_link *link = &world->link;
    bool has_x = motion->x1 != NULL, has_m = motion->m0 != NULL || motion->m1 != NULL;
    if (object == NULL) {
        return ranks_fail(link, PCCD_E_HANDLE, "rank %d: there is no object %" PRIu32,
                          link->rank, motion->object);
    }
    if (motion->count == 0 && motion->first <= object->mesh->vertex_count) {
        return PCCD_OK;
    }
    if (has_x == has_m || (has_m && (motion->m0 == NULL || motion->m1 == NULL)) ||
        (motion->x0 != NULL && !has_x) || (unsigned)motion->format >= PCCD_FORMAT_COUNT) {
        return ranks_fail(link, PCCD_E_INVAL,
                          "rank %d: a motion of object %" PRIu32
                          " says no way to move, or two",
                          link->rank, motion->object);
    }
    if (motion->first > object->mesh->vertex_count ||
        motion->count > object->mesh->vertex_count - motion->first) {
        return ranks_fail(link, PCCD_E_SEGMENT,
                          "rank %d: a motion of vertices %" PRIu32 " up, %" PRIu32
                          " of them: this rank owns %" PRIu32 " of object %" PRIu32,
                          link->rank, motion->first, motion->count,
                          object->mesh->vertex_count, motion->object);
    }
    return PCCD_OK;
}

/* Note the vertices of a motion; false: one of them is in another motion, too. */
static bool note_written(struct ranks_object *object, const struct pccd_motion *motion)
{
    bool is_free = true;
    for (uint32_t i = motion->first; i < motion->first + motion->count; i++) {
        uint64_t bit = 1ull << i % 64;
        is_free = is_free && (object->written[i / 64] & bit) == 0;
        object->written[i / 64] |= bit;
    }
    return is_free;
}

static int take_motion(struct pccd_mpi *world, const struct pccd_motion *motion,
                       struct ranks_object *object)
{
    size_t bytes = object->mesh->vertex_count * sizeof *object->x;
    size_t words = object->mesh->vertex_count / 64 + 1;
    if (object->written == NULL) {
        object->written = ranks_array(words, sizeof *object->written);
    }
    if (object->written == NULL) {
        return ranks_no_memory(world);
    }
    if (object->to == (const double(*)[3])object->x) {
        memset(object->written, 0, words * sizeof *object->written);
    }
    if (!note_written(object, motion)) {
        return ranks_fail(&world->link, PCCD_E_SEGMENT,
                          "rank %d: a vertex of object %" PRIu32
                          " is written twice in this step",
                          world->link.rank, motion->object);
    }
    if (object->to == (const double(*)[3])object->x) {
        object->begun = (const double(*)[3])object->x; /* what it was is written over */
        if (!is_of_all(motion, object)) {
            memcpy(object->next, object->x, bytes);
        }
        object->to = (const double(*)[3])object->next;
    }
    bool is_good = copy_run(motion, motion->x1, motion->m1,
                            (const double(*)[3])object->mesh->x, object->next);
    if (motion->x0 != NULL || motion->m0 != NULL) {
        if (object->start == NULL) {
            object->start =
                ranks_array(object->mesh->vertex_count, sizeof *object->start);
        }
        if (object->start == NULL) {
            return ranks_no_memory(world);
        }
        if (object->from == (const double(*)[3])object->x) {
            if (!is_of_all(motion, object)) {
                memcpy(object->start, object->x, bytes);
            }
            object->from = (const double(*)[3])object->start;
        }
        is_good &= copy_run(motion, motion->x0, motion->m0,
                            (const double(*)[3])object->mesh->x, object->start);
    }
    return is_good ? PCCD_OK
                   : ranks_fail(&world->link, PCCD_E_NOTFINITE,
                                "rank %d: a position of object %" PRIu32
                                " is not finite or beyond 1e18",
                                world->link.rank, motion->object);
}

int ranks_motions_check(struct pccd_mpi *world, const struct pccd_motion *motions,
                        uint32_t motion_count)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < motion_count && status == PCCD_OK; i++) {
        status =
            check_motion(world, &motions[i], ranks_find_object(world, motions[i].object));
    }
    return status;
}

int ranks_motions_take(struct pccd_mpi *world, const struct pccd_motion *motions,
                       uint32_t motion_count)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        object->from = object->to = (const double(*)[3])object->x;
    }
    for (uint32_t i = 0; i < motion_count && status == PCCD_OK; i++) {
        if (motions[i].count > 0) {
            status = take_motion(world, &motions[i],
                                 ranks_find_object(world, motions[i].object));
        }
    }
    return status;
}
