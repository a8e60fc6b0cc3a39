/* step.c - a step of the whole scene.
 *
 * Room:     client/mpi.
 * Does:     let all ranks know what moves; choose ghosts where those at hand may not do;
 *           send positions; let libpccd compute; put the answer together.
 * Threads:  one.
 * Source:   pccd_mpi.h.
 */
#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "balance.h"
#include "clock.h"
#include "cut.h"
#include "ghosts.h"
#include "places.h"
#include "records.h"
#include "step_numbers.h"

#define COORDINATE_MAX 1e18

/* What all ranks know of an object's motion. */
enum {
    MOVES = 0,   /* rows of struct moment.bytes */
    STARTS = 1,  /* some vertex begins elsewhere than it ended */
    MISSES = 2,  /* some vertex is outside of the box that ghosts were chosen for */
    ROWS = 3
};

/* What a step needs for its time. */
struct moment {
    uint8_t *bytes; /* [ROWS][object_count] */
    const double (**given)[3];
    double (**local)[3];
    struct pccd_step_settings settings;
};

static uint8_t *row(const struct pccd_mpi *world, const struct moment *moment, int which)
{
    return moment->bytes + (size_t)which * world->object_count;
}

/* ---- motions ------------------------------------------------------------------------- */

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

static void copy_run(const struct pccd_motion *motion, const void *from,
                     const double m[12], const double (*registered)[3], double (*to)[3])
{
    for (uint32_t i = 0; i < motion->count; i++) {
        double *out = to[motion->first + i];
        if (m != NULL) {
            transform(m, registered[motion->first + i], out);
        } else if (motion->format == PCCD_FORMAT_F64) {
            memcpy(out, (const double *)from + 3 * (size_t)i, 3 * sizeof *out);
        } else {
            const float *in = (const float *)from + 3 * (size_t)i;
            out[0] = (double)in[0];
            out[1] = (double)in[1];
            out[2] = (double)in[2];
        }
    }
}

static bool is_finite(const double (*x)[3], uint32_t first, uint32_t count)
{
    for (uint64_t i = 3 * (uint64_t)first; i < 3 * ((uint64_t)first + count); i++) {
        if (!(fabs(((const double *)x)[i]) <= COORDINATE_MAX)) {
            return false;
        }
    }
    return true;
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
        memcpy(object->next, object->x, bytes);
        object->to = (const double(*)[3])object->next;
    }
    copy_run(motion, motion->x1, motion->m1, (const double(*)[3])object->mesh->x,
             object->next);
    bool is_good = is_finite(object->to, motion->first, motion->count);
    if (motion->x0 != NULL || motion->m0 != NULL) {
        if (object->start == NULL) {
            object->start = ranks_array(object->mesh->vertex_count, sizeof *object->start);
        }
        if (object->start == NULL) {
            return ranks_no_memory(world);
        }
        if (object->from == (const double(*)[3])object->x) {
            memcpy(object->start, object->x, bytes);
            object->from = (const double(*)[3])object->start;
        }
        copy_run(motion, motion->x0, motion->m0, (const double(*)[3])object->mesh->x,
                 object->start);
        is_good = is_good && is_finite(object->from, motion->first, motion->count);
    }
    return is_good ? PCCD_OK
                   : ranks_fail(&world->link, PCCD_E_NOTFINITE,
                                "rank %d: a position of object %" PRIu32
                                " is not finite or beyond 1e18",
                                world->link.rank, motion->object);
}

static int take_motions(struct pccd_mpi *world, const struct pccd_motion *motions,
                        uint32_t motion_count)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        object->from = object->to = (const double(*)[3])object->x;
    }
    for (uint32_t i = 0; i < motion_count && status == PCCD_OK; i++) {
        struct ranks_object *object = ranks_find_object(world, motions[i].object);
        status = check_motion(world, &motions[i], object);
        if (status == PCCD_OK && motions[i].count > 0) {
            status = take_motion(world, &motions[i], object);
        }
    }
    return status;
}

/* ---- settings ------------------------------------------------------------------------ */

static int read_settings(struct pccd_mpi *world, const struct pccd_step_settings *asked,
                         struct pccd_step_settings *settings, uint64_t *hash)
{
    *settings = (struct pccd_step_settings)PCCD_STEP_SETTINGS_INIT;
    if (asked != NULL) {
        size_t bytes = asked->struct_bytes;
        bytes = bytes == 0 ? offsetof(struct pccd_step_settings, separation) : bytes;
        memcpy(settings, asked, bytes > sizeof *settings ? sizeof *settings : bytes);
    }
    settings->struct_bytes = sizeof *settings;
    *hash = ranks_hash(1, &settings->mode, sizeof settings->mode);
    *hash = ranks_hash(*hash, &settings->method, sizeof settings->method);
    *hash = ranks_hash(*hash, &settings->threads, sizeof settings->threads);
    *hash = ranks_hash(*hash, &settings->tolerance, sizeof settings->tolerance);
    *hash = ranks_hash(*hash, &settings->separation, sizeof settings->separation);
    *hash = ranks_hash(*hash, &settings->approach, sizeof settings->approach);
    *hash = ranks_hash(*hash, &settings->deadline_ns, sizeof settings->deadline_ns);
    if (settings->tuning != NULL) {
        *hash = ranks_hash(*hash, settings->tuning, strlen(settings->tuning));
    }
    if (settings->threads == 0) {
        settings->threads = world->threads;
    }
    if (settings->hold || (unsigned)settings->mode >= PCCD_MODE_COUNT ||
        !(settings->separation >= 0)) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "a step with hold, an unknown mode or a negative separation");
    }
    return PCCD_OK;
}

/* ---- ghosts -------------------------------------------------------------------------- */

/* Each rank says of each object what it knows, and hears of all. */
static int look_at_motions(struct pccd_mpi *world, struct moment *moment)
{
    uint32_t objects = world->object_count;
    moment->bytes = calloc((size_t)objects * ROWS + 1, 1);
    moment->given = calloc((size_t)objects + 1, sizeof *moment->given);
    moment->local = calloc((size_t)objects + 1, sizeof *moment->local);
    int status = moment->bytes == NULL || moment->given == NULL || moment->local == NULL
                     ? ranks_no_memory(world)
                     : PCCD_OK;
    status = ranks_agree_on(&world->link, status);
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        row(world, moment, MOVES)[o] = object->to != (const double(*)[3])object->x;
        row(world, moment, STARTS)[o] = object->from != (const double(*)[3])object->x;
        row(world, moment, MISSES)[o] =
            (!world->is_covered || row(world, moment, MOVES)[o] ||
             row(world, moment, STARTS)[o]) &&
            ranks_ghosts_miss(object);
    }
    return status == PCCD_OK
               ? ranks_max_bytes(&world->link, moment->bytes, (int)(objects * ROWS))
               : status;
}

static int choose_ghosts(struct pccd_mpi *world, const struct moment *moment)
{
    bool misses = !world->is_covered || world->reach < moment->settings.separation;
    for (uint32_t o = 0; o < world->object_count; o++) {
        misses = misses || row(world, moment, MISSES)[o];
    }
    return misses ? ranks_ghosts_choose(world, moment->settings.separation) : PCCD_OK;
}

/* ---- computing ----------------------------------------------------------------------- */

/* A frame with a segment for each object that is sent and has leaves here: the places for
 * its positions. */
static int begin_frame(struct pccd_mpi *world, const struct moment *moment,
                       struct pccd_frame *frame, double (**x0)[3], double (**x1)[3])
{
    uint64_t bytes = 0;
    uint32_t segments = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        if (moment->given[o] != NULL && object->local.vertex_count > 0) {
            segments++;
            bytes += 48 * (uint64_t)object->local.vertex_count;
        }
    }
    int status = pccd_frame_begin(world->client, world->scene, segments, bytes, frame);
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        uint32_t count = object->local.vertex_count;
        bool starts = row(world, moment, STARTS)[o] || object->is_elsewhere;
        void *to[2] = {NULL, NULL};
        if (moment->given[o] == NULL || count == 0) {
            continue;
        }
        status = starts ? pccd_frame_x0x1(frame, object->handle, PCCD_FORMAT_F64, 0,
                                          count, &to[0], &to[1])
                        : pccd_frame_x1(frame, object->handle, PCCD_FORMAT_F64, 0, count,
                                        &to[1]);
        x0[o] = to[0];
        x1[o] = to[1];
        if (status != PCCD_OK) {
            pccd_frame_abort(frame);
        }
    }
    return status == PCCD_OK ? PCCD_OK
                             : ranks_fail_local(world, status, "no frame of libpccd");
}

/* Positions of all that moves, or that libpccd has elsewhere, to the frame. */
static int send_positions(struct pccd_mpi *world, struct moment *moment,
                          struct pccd_frame *frame)
{
    uint32_t objects = world->object_count;
    double(**x0)[3] = calloc((size_t)objects + 1, sizeof *x0);
    int status = x0 == NULL ? ranks_no_memory(world) : PCCD_OK;
    bool has_frame = false;
    for (uint32_t o = 0; o < objects; o++) {
        const struct ranks_object *object = world->objects[o];
        bool is_sent = row(world, moment, MOVES)[o] || row(world, moment, STARTS)[o] ||
                       object->is_elsewhere;
        moment->given[o] = is_sent ? object->to : NULL;
    }
    if (status == PCCD_OK) {
        status = begin_frame(world, moment, frame, x0, moment->local);
        has_frame = status == PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, moment->given, moment->local);
    }
    for (uint32_t o = 0; o < objects; o++) {
        const struct ranks_object *object = world->objects[o];
        bool starts = row(world, moment, STARTS)[o] || object->is_elsewhere;
        moment->given[o] = starts ? object->from : NULL;
    }
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, moment->given, x0);
    }
    if (status != PCCD_OK && has_frame) {
        pccd_frame_abort(frame);
    }
    free((void *)x0);
    return status;
}

/* All pages of libpccd's answer. */
static int take_pages(struct pccd_mpi *world, struct pccd_answer *answer)
{
    struct pccd_answer page = *answer;
    for (;;) {
        uint64_t cursor = page.cursor;
        bool is_last =
            page.incomplete != PCCD_INCOMPLETE_RESULT_FULL || cursor >= answer->total;
        int status = ranks_records_take(world, &page);
        pccd_answer_release(world->client, &page);
        if (status != PCCD_OK || is_last) {
            answer->incomplete = page.incomplete == PCCD_INCOMPLETE_RESULT_FULL
                                     ? PCCD_COMPLETE
                                     : page.incomplete;
            return status;
        }
        status =
            pccd_fetch(world->client, world->scene, answer->step, cursor, &page);
        if (status != PCCD_OK) {
            return ranks_fail_local(world, status, "a page of records did not come");
        }
    }
}

static int compute(struct pccd_mpi *world, const struct moment *moment,
                   struct pccd_frame *frame, struct pccd_answer *answer)
{
    uint64_t step = 0;
    world->record_count = 0;
    world->mode = moment->settings.mode;
    int status = pccd_frame_commit(frame, &moment->settings, &step);
    if (status == PCCD_OK) {
        status = pccd_wait(world->client, step, -1, answer);
    }
    return status == PCCD_OK ? take_pages(world, answer)
                             : ranks_fail_local(world, status, "the step failed");
}

/* ---- the answer of all --------------------------------------------------------------- */

/* Everything that is added up over the ranks. */
struct totals {
    struct ranks_sums sums; /* but for toi_first */
    uint64_t verdicts[PCCD_VERDICT_NONE + 1];
    uint64_t incomplete[PCCD_INCOMPLETE_CONTACT_LIMIT + 1];
    uint64_t threads;
    struct pccd_step_counters counters;
};

static bool is_thick(const struct pccd_mpi *world,
                     const struct pccd_step_settings *settings)
{
    bool is_on = settings->separation > 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        is_on = is_on || object->settings.radius > 0 || object->mesh->radius_max > 0;
    }
    return is_on;
}

static enum pccd_verdict verdict_of(const struct totals *totals, enum pccd_mode mode)
{
    const uint64_t *verdicts = totals->verdicts;
    return mode != PCCD_MODE_ANY                ? PCCD_VERDICT_NONE
           : verdicts[PCCD_VERDICT_YES] > 0      ? PCCD_VERDICT_YES
           : verdicts[PCCD_VERDICT_NONE] > 0     ? PCCD_VERDICT_NONE
           : verdicts[PCCD_VERDICT_POSSIBLE] > 0 ? PCCD_VERDICT_POSSIBLE
                                                 : PCCD_VERDICT_NO;
}

static enum pccd_incomplete why_incomplete(const struct totals *totals)
{
    for (uint32_t i = PCCD_INCOMPLETE_CONTACT_LIMIT; i > 0; i--) {
        if (totals->incomplete[i] > 0) {
            return (enum pccd_incomplete)i;
        }
    }
    return PCCD_COMPLETE;
}

/* As in one process: pccd.h, safe_step. */
static double safe_step(const struct pccd_answer *answer)
{
    bool is_empty = answer->mode == PCCD_MODE_ANY ? answer->verdict == PCCD_VERDICT_NO
                                                  : answer->total == 0;
    if (answer->incomplete != PCCD_COMPLETE) {
        return 0;
    }
    if (is_empty) {
        return 1;
    }
    return answer->toi_first > 0 && answer->toi_first <= 1
               ? nextafter(answer->toi_first, 0)
               : 0;
}

static void write_answer(const struct pccd_mpi *world, const struct moment *moment,
                         const struct totals *totals, struct pccd_answer *answer)
{
    const struct ranks_sums *sums = &totals->sums;
    memcpy(answer->counts, sums->counts, sizeof answer->counts);
    answer->total = sums->total;
    answer->possible = sums->possible;
    answer->initial = sums->initial;
    answer->inside = sums->inside;
    answer->toi_first = answer->mode == PCCD_MODE_PAIRS ? 2 : sums->toi_first;
    answer->verdict = verdict_of(totals, answer->mode);
    answer->incomplete = why_incomplete(totals);
    answer->crowded = is_thick(world, &moment->settings) &&
                      answer->mode != PCCD_MODE_ANY &&
                      sums->initial + sums->inside > sums->total / 2;
    answer->counters = totals->counters;
    answer->threads = (uint32_t)totals->threads;
    answer->safe_step = safe_step(answer);
    if (answer->mode == PCCD_MODE_ANY) {
        ranks_verdict_hash((uint32_t)answer->verdict, answer->hash);
    } else {
        ranks_records_hash(sums, answer->hash);
    }
    answer->first = 0;
    answer->count = world->record_count;
    answer->cursor = answer->total;
    answer->contacts = NULL;
    answer->pairs = NULL;
    if (world->record_count > 0 && answer->mode == PCCD_MODE_PAIRS) {
        answer->pairs = world->records;
    } else if (world->record_count > 0) {
        answer->contacts = world->records;
    }
}

/* The longest of each time, over all ranks; cut_ns: 0 if nothing was cut. */
static int slowest(struct pccd_mpi *world, uint64_t *cut_ns, struct pccd_answer *answer,
                   double *toi_first)
{
    double times[16] = {*toi_first, -(double)*cut_ns};
    int count = 2;
#define PUT(unused, name, need, member, meaning)                                         \
    times[count++] = -(double)answer->member;
    COMMON_STEP_TIMES(PUT, )
#undef PUT
    int status = ranks_min_doubles(&world->link, times, count);
    count = 2;
#define GET(unused, name, need, member, meaning)                                         \
    answer->member = (uint64_t)-times[count++];
    COMMON_STEP_TIMES(GET, )
#undef GET
    *toi_first = times[0];
    *cut_ns = (uint64_t)-times[1];
    return status;
}

static int put_together(struct pccd_mpi *world, const struct moment *moment,
                        uint64_t cut_ns, struct pccd_answer *answer)
{
    struct totals totals = {.threads = answer->threads, .counters = answer->counters};
    int status = PCCD_OK;
    if (answer->mode == PCCD_MODE_FIRST) {
        double limit = ranks_records_limit(world);
        status = ranks_min_doubles(&world->link, &limit, 1);
        ranks_records_drop_later(world, limit);
    }
    ranks_records_sum(world, &totals.sums);
    totals.verdicts[answer->verdict] = 1;
    totals.incomplete[answer->incomplete] = 1;
    double toi_first = totals.sums.toi_first;
    totals.sums.toi_first = 0;
    balance_note(world, &answer->counters);
    world->share.sent_bytes = world->link.sent_bytes;
    if (status == PCCD_OK) {
        status = slowest(world, &cut_ns, answer, &toi_first);
    }
    if (status == PCCD_OK) {
        static_assert(sizeof totals % sizeof(uint64_t) == 0, "only words");
        status = ranks_sum(&world->link, (uint64_t *)(void *)&totals,
                           (int)(sizeof totals / sizeof(uint64_t)));
    }
    if (status == PCCD_OK) {
        status = balance_tell(world);
    }
    if (status == PCCD_OK) {
        balance_note_times(world, answer->times.step, cut_ns);
    }
    totals.sums.toi_first = toi_first;
    write_answer(world, moment, &totals, answer);
    return status;
}

/* The step was made: what moved is there now. */
static void move_on(struct pccd_mpi *world)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        if (object->to == (const double(*)[3])object->next) {
            double(*before)[3] = object->x;
            object->x = object->next;
            object->next = before;
        }
        object->is_elsewhere = false;
    }
}

static int step(struct pccd_mpi *world, struct moment *moment, struct pccd_answer *answer)
{
    struct pccd_frame frame;
    int status = PCCD_OK;
    uint64_t begin_ns = common_now_ns(), cut_ns = 0;
    bool is_cut = !world->is_cut || balance_wants_cut(world);
    world->link.sent_bytes = 0;
    if (is_cut) {
        status = ranks_cut(world, balance_weight(world));
    }
    if (status == PCCD_OK) {
        status = look_at_motions(world, moment);
    }
    if (status == PCCD_OK) {
        status = choose_ghosts(world, moment);
    }
    if (is_cut) {
        cut_ns = common_now_ns() - begin_ns;
    }
    if (status == PCCD_OK) {
        status = send_positions(world, moment, &frame);
    }
    if (status != PCCD_OK) {
        return status;
    }
    status = ranks_agree_on(&world->link, compute(world, moment, &frame, answer));
    if (status == PCCD_OK) {
        status = put_together(world, moment, cut_ns, answer);
    }
    if (status != PCCD_OK) { /* some ranks may have moved on */
        world->record_count = 0;
        for (uint32_t o = 0; o < world->object_count; o++) {
            world->objects[o]->is_elsewhere = true;
        }
        return status;
    }
    move_on(world);
    return PCCD_OK;
}

int pccd_mpi_step(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_step_settings *settings,
                  struct pccd_answer *answer)
{
    struct moment moment = {.bytes = NULL};
    struct pccd_answer made = PCCD_ANSWER_INIT;
    uint64_t hash = 0;
    int status = read_settings(world, settings, &moment.settings, &hash);
    if (status == PCCD_OK) {
        status = take_motions(world, motions, motion_count);
    }
    status = ranks_agree(&world->link, RANKS_STEP, hash, status);
    if (status == PCCD_OK) {
        status = step(world, &moment, &made);
    }
    free(moment.bytes);
    free((void *)moment.given);
    free((void *)moment.local);
    if (status == PCCD_OK) {
        size_t bytes = answer->struct_bytes;
        memcpy(answer, &made, bytes == 0 || bytes > sizeof made ? sizeof made : bytes);
        answer->struct_bytes = bytes;
    }
    return status;
}
