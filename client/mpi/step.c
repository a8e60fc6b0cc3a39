/* step.c - a step of the whole scene.
 *
 * Room:     client/mpi.
 * Does:     let all ranks know what moves; choose ghosts where those at hand may not do;
 *           send positions; let libpccd compute; put the answer together.
 * Threads:  one.
 * Source:   pccd_mpi.h.
 */
#include <stdlib.h>
#include <string.h>

#include "answer.h"
#include "balance.h"
#include "clock.h"
#include "cut.h"
#include "ghosts.h"
#include "motions.h"
#include "places.h"
#include "records.h"
#include "weigh.h"

/* What all ranks know of an object's motion. */
enum {
    MOVES = 0,  /* rows of struct moment.bytes */
    STARTS = 1, /* some vertex begins elsewhere than it ended */
    MISSES = 2, /* some vertex is outside of the box that ghosts were chosen for */
    ROWS = 3
};

/* What a step needs for its time. */
struct moment {
    uint8_t *bytes; /* [ROWS][object_count] */
    const double (**given)[3];
    double (**local)[3];
    struct pccd_step_settings settings;
    const struct pccd_near_settings *near; /* NULL: it is a step */
};

static uint8_t *row(const struct pccd_mpi *world, const struct moment *moment, int which)
{
    return moment->bytes + (size_t)which * world->object_count;
}

/* ---- settings --------------------------------------------------------------------- */

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

/* ---- ghosts ----------------------------------------------------------------------- */

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

/* ---- computing -------------------------------------------------------------------- */

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
        status = pccd_fetch(world->client, world->scene, answer->step, cursor, &page);
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
    int status = moment->near != NULL
                     ? pccd_frame_commit_near(frame, moment->near, &step)
                     : pccd_frame_commit(frame, &moment->settings, &step);
    if (status == PCCD_OK) {
        status = pccd_wait(world->client, step, -1, answer);
    }
    return status == PCCD_OK ? take_pages(world, answer)
                             : ranks_fail_local(world, status, "the step failed");
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
    if (is_cut && world->is_covered) {
        status = ranks_weigh(world, moment->settings.separation);
    }
    if (is_cut && status == PCCD_OK) {
        status = ranks_cut(world);
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
        status = moment->near != NULL
                     ? ranks_answer_make_near(world, answer)
                     : ranks_answer_make(world, &moment->settings, cut_ns, answer);
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

/* All ranks agree: make it, and let the caller have what it knows of the answer. */
static int make(struct pccd_mpi *world, struct moment *moment, struct pccd_answer *answer)
{
    struct pccd_answer made = PCCD_ANSWER_INIT;
    int status = step(world, moment, &made);
    free(moment->bytes);
    free((void *)moment->given);
    free((void *)moment->local);
    if (status == PCCD_OK) {
        size_t bytes = answer->struct_bytes;
        memcpy(answer, &made, bytes == 0 || bytes > sizeof made ? sizeof made : bytes);
        answer->struct_bytes = bytes;
    }
    return status;
}

int pccd_mpi_step(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_step_settings *settings,
                  struct pccd_answer *answer)
{
    struct moment moment = {.bytes = NULL};
    uint64_t hash = 0;
    int status = read_settings(world, settings, &moment.settings, &hash);
    if (status == PCCD_OK) {
        status = ranks_motions_take(world, motions, motion_count);
    }
    status = ranks_agree(&world->link, RANKS_STEP, hash, status);
    return status == PCCD_OK ? make(world, &moment, answer) : status;
}

static int read_near(struct pccd_mpi *world, const struct pccd_near_settings *asked,
                     struct pccd_near_settings *settings, uint64_t *hash)
{
    size_t bytes = asked->struct_bytes;
    *settings = (struct pccd_near_settings)PCCD_NEAR_SETTINGS_INIT;
    memcpy(settings, asked,
           bytes == 0 || bytes > sizeof *settings ? sizeof *settings : bytes);
    settings->struct_bytes = sizeof *settings;
    *hash = ranks_hash(2, &settings->what, sizeof settings->what);
    *hash = ranks_hash(*hash, &settings->distance, sizeof settings->distance);
    *hash = ranks_hash(*hash, &settings->end, sizeof settings->end);
    *hash = ranks_hash(*hash, &settings->threads, sizeof settings->threads);
    *hash = ranks_hash(*hash, &settings->deadline_ns, sizeof settings->deadline_ns);
    *hash = ranks_hash(*hash, &settings->method, sizeof settings->method);
    settings->threads = settings->threads > 0 ? settings->threads : world->threads;
    if (settings->what != PCCD_NEAR_PAIRS && settings->what != PCCD_NEAR_CROSSINGS) {
        return ranks_fail(
            &world->link, PCCD_E_INVAL,
            "over ranks only pairs and crossings are answered of what is near");
    }
    if (settings->what == PCCD_NEAR_PAIRS && !(settings->distance >= 0)) {
        return ranks_fail(&world->link, PCCD_E_INVAL, "a negative distance, or none");
    }
    return settings->distance <= 1e18
               ? PCCD_OK
               : ranks_fail(&world->link, PCCD_E_LIMIT, "a distance beyond 1e18");
}

int pccd_mpi_near(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_near_settings *settings,
                  struct pccd_answer *answer)
{
    struct pccd_near_settings near;
    struct moment moment = {.near = &near};
    uint64_t hash = 0;
    uint8_t moves = motion_count > 0;
    int status = read_near(world, settings, &near, &hash);
    if (status == PCCD_OK) {
        status = ranks_motions_take(world, motions, motion_count);
    }
    status = ranks_agree(&world->link, RANKS_NEAR, hash, status);
    if (status == PCCD_OK) {
        status = ranks_max_bytes(&world->link, &moves, 1);
    }
    if (status == PCCD_OK && near.end == 0 && !moves) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "over ranks it is not known where the last step began");
    }
    if (near.what == PCCD_NEAR_PAIRS) {
        moment.settings.separation = near.distance;
    }
    return status == PCCD_OK ? make(world, &moment, answer) : status;
}
