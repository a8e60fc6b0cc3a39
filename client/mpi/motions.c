/* motions.c - what the caller says that moves. */
#include "step.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "rounding.h"
#include "team.h"

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

/* Copy one end of vertices begin .. end - 1 of a motion. Return whether all coordinates
 * are finite, and none beyond 1e18. [team] */
static bool copy_end(const struct pccd_motion *motion, const struct ranks_object *object,
                     bool is_start, uint64_t begin, uint64_t end)
{
    const void *from = is_start ? motion->x0 : motion->x1;
    const double *m = is_start ? motion->m0 : motion->m1;
    double(*to)[3] = is_start ? object->start : object->next;
    bool is_good = true;
    for (uint32_t i = (uint32_t)begin; i < end; i++) {
        double *out = to[motion->first + i];
        if (m != NULL) {
            transform(m, object->mesh->x[motion->first + i], out);
        } else {
            copy_vertex(motion, from, i, out);
        }
        is_good &= fabs(out[0]) <= COORDINATE_MAX && fabs(out[1]) <= COORDINATE_MAX &&
                   fabs(out[2]) <= COORDINATE_MAX;
    }
    return is_good;
}

static bool has_start(const struct pccd_motion *motion)
{
    return motion->x0 != NULL || motion->m0 != NULL;
}

/* Copy the vertices begin .. end - 1 of all that motions move. Return the first motion
 * with a bad coordinate among them, else motion_count. [team] */
static uint32_t copy_part(const struct pccd_mpi *world, const struct pccd_motion *motions,
                          uint32_t motion_count, uint64_t begin, uint64_t end)
{
    uint32_t bad = motion_count;
    uint64_t at = 0, first, last;
    for (uint32_t i = 0; i < motion_count && at < end; at += motions[i++].count) {
        const struct pccd_motion *motion = &motions[i];
        if (!ranks_part_of_run(at, motion->count, begin, end, &first, &last)) {
            continue;
        }
        const struct ranks_object *object = ranks_find_object(world, motion->object);
        bool is_good = copy_end(motion, object, false, first, last);
        if (has_start(motion)) {
            is_good &= copy_end(motion, object, true, first, last);
        }
        bad = is_good || bad < i ? bad : i;
    }
    return bad;
}

/* Both ends of all motions. Returns as copy_part. */
static uint32_t copy_motions(const struct pccd_mpi *world,
                             const struct pccd_motion *motions, uint32_t motion_count)
{
    uint64_t count = 0;
    uint32_t bad = motion_count;
    for (uint32_t i = 0; i < motion_count; i++) {
        count += motions[i].count;
    }
    const int team = ranks_team(world, count);
#pragma omp parallel for num_threads(team) schedule(static, 1) reduction(min : bad)
    for (int t = 0; t < team; t++) {
        COMMON_ROUNDING_HERE;
        uint32_t bad_here =
            copy_part(world, motions, motion_count, ranks_part(count, t, team),
                      ranks_part(count, t + 1, team));
        bad = bad_here < bad ? bad_here : bad;
    }
    return bad;
}

/* Copy all positions: what a motion does not say stays where it was. */
static void copy_all(const struct pccd_mpi *world, double (*to)[3],
                     const double (*from)[3], uint32_t count)
{
    const int team = ranks_team(world, count);
#pragma omp parallel for num_threads(team) schedule(static, 1)
    for (int t = 0; t < team; t++) {
        uint64_t begin = ranks_part(count, t, team);
        memcpy(to[begin], from[begin],
               (ranks_part(count, t + 1, team) - begin) * sizeof *to);
    }
}

/* Return whether a motion says where every given vertex is; then nothing of the last step
 * stays. */
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

/* Note the vertices of a motion, which has some; false: one of them is in another motion,
 * too. */
static bool note_written(struct ranks_object *object, const struct pccd_motion *motion)
{
    bool is_free = true;
    const uint32_t first = motion->first, last = motion->first + motion->count - 1;
    for (uint32_t word = first / 64; word <= last / 64; word++) {
        uint64_t bits = UINT64_MAX;
        bits &= word == first / 64 ? UINT64_MAX << first % 64 : UINT64_MAX;
        bits &= word == last / 64 ? UINT64_MAX >> (63 - last % 64) : UINT64_MAX;
        is_free = is_free && (object->written[word] & bits) == 0;
        object->written[word] |= bits;
    }
    return is_free;
}

/* Make room for the ends of a motion: object->next, and object->start if it says where it
 * starts. */
static int make_room(struct pccd_mpi *world, const struct pccd_motion *motion,
                     struct ranks_object *object)
{
    const uint32_t count = object->mesh->vertex_count;
    size_t words = count / 64 + 1;
    if (object->written == NULL) {
        object->written = ranks_array(words, sizeof *object->written);
    }
    if (has_start(motion) && object->start == NULL) {
        object->start = ranks_array(count, sizeof *object->start);
    }
    if (object->written == NULL || (has_start(motion) && object->start == NULL)) {
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
            copy_all(world, object->next, (const double(*)[3])object->x, count);
        }
        object->to = (const double(*)[3])object->next;
    }
    if (has_start(motion) && object->from == (const double(*)[3])object->x) {
        if (!is_of_all(motion, object)) {
            copy_all(world, object->start, (const double(*)[3])object->x, count);
        }
        object->from = (const double(*)[3])object->start;
    }
    return PCCD_OK;
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
            status = make_room(world, &motions[i],
                               ranks_find_object(world, motions[i].object));
        }
    }
    uint32_t bad =
        status == PCCD_OK ? copy_motions(world, motions, motion_count) : motion_count;
    if (bad < motion_count) {
        status = ranks_fail(&world->link, PCCD_E_NOTFINITE,
                            "rank %d: a position of object %" PRIu32
                            " is not finite or beyond 1e18",
                            world->link.rank, motions[bad].object);
    }
    return status;
}
