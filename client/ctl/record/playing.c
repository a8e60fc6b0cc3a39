/* playing.c - the steps of a recording, one after the other. */
#include "play.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "answer_hash.h"
#include "clock.h"
#include "ctl.h"
#include "names.h"
#include "payload.h"
#include "playing.h"
#include "proto_limits.h"

bool play_is_repeatable(int status)
{
    return status == PCCD_OK || status == PCCD_E_INVAL || status == PCCD_E_HANDLE ||
           status == PCCD_E_SEGMENT || status == PCCD_E_NOTFINITE ||
           status == PCCD_E_INDEX;
}

bool play_has_gap(const struct record_near *asked)
{
    return asked->what == PCCD_NEAR_NEAREST && asked->gap > 0;
}

void play_hash(const struct play_step *step, uint64_t hash[2])
{
    const struct pccd_answer *answer = step->answer;
    if (step->hash_version == PCCD_HASH_VERSION || answer->status != PCCD_OK ||
        answer->mode == PCCD_MODE_ANY) {
        memcpy(hash, answer->hash, sizeof answer->hash);
    } else if (answer->mode == PCCD_MODE_PAIRS) {
        record_answer_hash(step->hash_version, step->pairs, step->count,
                           sizeof *step->pairs, hash);
    } else {
        record_answer_hash(step->hash_version, step->contacts, step->count,
                           sizeof *step->contacts, hash);
    }
}

/* Wait until as much time has passed as then. */
static void keep_pace(struct playing *playing, uint64_t then_ns)
{
    if (playing->begun_ns == 0) {
        playing->begun_ns = common_now_ns();
        playing->begun_then_ns = then_ns;
        return;
    }
    uint64_t at_ns = playing->begun_ns + (then_ns - playing->begun_then_ns);
    uint64_t now = common_now_ns();
    if (then_ns > playing->begun_then_ns && at_ns > now) {
        const struct timespec pause = {(time_t)((at_ns - now) / 1000000000u),
                                       (long)((at_ns - now) % 1000000000u)};
        nanosleep(&pause, NULL);
    }
}

/* The step or question that is being read, of which `step` is the number. */
static bool is_shown(const struct playing *playing, uint64_t step)
{
    return playing->settings.next != NULL ? playing->place == playing->next_place
                                          : play_is_within(&playing->settings, step);
}

/* It had failed by chance. */
static void skip(struct playing *playing, uint64_t step, bool is_near)
{
    playing->summary->skipped++;
    if (playing->settings.show_skipped != NULL && is_shown(playing, step)) {
        playing->settings.show_skipped(playing->context, step, is_near);
    }
}

/* Somebody else computes what is passed by: the daemon, if one is there yet, does not see
 * it. */
static void note_missed(struct playing *playing)
{
    if (playing->drive.is_begun) {
        playing->drive.stands = &playing->world;
        playing->drive.knows_no_begin = true;
    }
}

/* The daemon has moved everything that has ever moved in a scene to where it is: if that
 * is the only scene, it needs to be told no more than what a step moves. */
static void note_told(struct playing *playing)
{
    const struct registry_scene *first = playing->world.scenes;
    if (first != NULL && first->next == NULL) {
        playing->drive.stands = NULL;
    }
}

/* A daemon that stands where the world stands, when the first step needs one. */
static int begin_drive(struct playing *playing, struct ctl_error *error)
{
    if (playing->drive.is_begun) {
        return PCCD_OK;
    }
    if (ctl_link_open(playing->settings.link, &playing->drive.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", ""); /* it has been told */
    }
    playing->summary->daemon_pid = pccd_daemon_pid(playing->drive.client);
    playing->drive.knows_no_begin = true; /* it is told where things are */
    return drive_begin(&playing->drive, &playing->world, error);
}

/* ---- what cannot have been --------------------------------------------------------- */

/* A chunk does not fit the others, as the error says: where it is, and what comes
 * before. */
static int misfit(const struct playing *playing, const struct record_view *view,
                  int status, struct ctl_error *error)
{
    char text[CTL_ERROR_TEXT_BYTES];
    if (status != PCCD_E_FORMAT) {
        return status;
    }
    (void)snprintf(text, sizeof text, "at byte %" PRIu64 ", %s: %.900s", view->offset,
                   record_kind_name(view->kind), error->text);
    return play_damaged(playing, status, text, playing->last_step, error);
}

static int step_world(struct playing *playing, const struct record_view *view,
                      const struct record_frame *frame, const uint8_t *slot,
                      struct ctl_error *error)
{
    return misfit(playing, view, world_step(&playing->world, frame, slot, error), error);
}

static bool is_length(double length, double most)
{
    return length >= 0 && length <= most;
}

/* Lengths that were asked for, of a step or question that was answered so. */
static int judge_lengths(const struct playing *playing, const struct record_view *view,
                         bool are_right, bool is_taken, struct ctl_error *error)
{
    if (are_right || !is_taken) {
        return PCCD_OK;
    }
    return misfit(
        playing, view,
        ctl_error_set(error, PCCD_E_FORMAT, "a distance or tolerance that cannot be one"),
        error);
}

/* ---- asking again ------------------------------------------------------------------ */

/* Records of an answer: a daemon's, or those that were recorded. */
struct found {
    const void *records; /* NULL: none */
    uint64_t count, first_count;
    bool is_whole; /* all of them */
    bool is_torn;
};

/* How it is asked again: as then, but for what the caller wants otherwise. */
static void choose_how(struct playing *playing, uint32_t *method, uint32_t *threads,
                       uint64_t *deadline_ns)
{
    *deadline_ns = 0; /* would end it anywhere */
    if (playing->settings.method != PCCD_METHOD_DEFAULT) {
        *method = playing->settings.method;
        playing->drive.tuning[0] = '\0';
    }
    if (playing->settings.threads != 0) {
        *threads = playing->settings.threads;
    }
}

/* What was asked then of a daemon now, when its time has come. The one of frame and near
 * that is not NULL. */
static int ask_again(struct playing *playing, const struct record_view *view,
                     const struct record_frame *frame, const struct record_near *near,
                     const uint8_t *slot, bool collects, struct found *found,
                     struct ctl_error *error)
{
    const struct drive *drive = &playing->drive;
    if (playing->settings.at_recorded_pace) {
        keep_pace(playing, view->time_ns);
    }
    if (playing->settings.is_traced && frame != NULL) {
        step_trace_begin(&playing->trace, drive->client);
    }
    uint64_t begin_ns = common_now_ns();
    int status = frame != NULL ? drive_step(&playing->drive, frame, slot, collects, error)
                               : drive_near(&playing->drive, &playing->world, near, slot,
                                            collects, error);
    playing->summary->seconds += (double)(common_now_ns() - begin_ns) * 1e-9;
    *found = (struct found){.records = NULL};
    if (status == PCCD_OK && drive->answer.status == PCCD_OK) {
        note_told(playing);
    }
    if (status == PCCD_OK && collects && drive->answer.status == PCCD_OK) {
        *found = (struct found){.records = drive->records,
                                .count = drive->record_count,
                                .first_count = drive->answer.count,
                                .is_whole = drive->record_count == drive->answer.total};
    }
    return status;
}

/* The records that were recorded. */
static int recall(struct playing *playing, uint64_t number, bool is_answered,
                  struct found *found, struct ctl_error *error)
{
    struct answers_found *is = &playing->found;
    int status = answers_records(&playing->answers, &playing->pages, number, is, error);
    *found = (struct found){.records = is_answered && is->count > 0 ? is->records : NULL,
                            .count = is->count,
                            .first_count = is->first_count,
                            .is_whole = is->is_whole,
                            .is_torn = is->is_torn};
    return status;
}

static void show_records(struct play_step *step, uint32_t mode, const struct found *found)
{
    step->count = found->count;
    step->first_count = found->first_count;
    step->is_whole = found->is_whole;
    step->is_torn = found->is_torn;
    step->contacts = mode == PCCD_MODE_PAIRS ? NULL : found->records;
    step->pairs = mode == PCCD_MODE_PAIRS ? found->records : NULL;
}

static void show_near_records(struct play_near *near, uint32_t what,
                              const struct found *found)
{
    near->count = found->count;
    near->first_count = found->first_count;
    near->is_whole = found->is_whole;
    near->is_torn = found->is_torn;
    near->records = what == PCCD_NEAR_VERTICES ? NULL : found->records;
    near->bounds = what == PCCD_NEAR_VERTICES ? found->records : NULL;
}

/* ---- steps ------------------------------------------------------------------------- */

/* The daemon's answer to a step. */
static int repeat_step(struct playing *playing, const struct record_view *view,
                       const uint8_t *slot, struct play_step *step,
                       struct ctl_error *error)
{
    struct record_frame asked = *step->frame;
    struct found found;
    /* A hash of another version is computed from the records. */
    bool collects =
        playing->settings.needs_records || step->hash_version != PCCD_HASH_VERSION;
    choose_how(playing, &asked.method, &asked.threads, &asked.deadline_ns);
    int status = ask_again(playing, view, &asked, NULL, slot, collects, &found, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (playing->settings.is_traced) {
        step_trace_end(&playing->trace, playing->drive.client);
        step->trace = &playing->trace;
    }
    step->client = playing->drive.client;
    step->answer = &playing->drive.answer;
    show_records(step, (uint32_t)step->answer->mode, &found);
    return PCCD_OK;
}

static int recall_step(struct playing *playing, struct play_step *step,
                       struct ctl_error *error)
{
    struct found found;
    int status = recall(playing, step->number, step->recorded != NULL, &found, error);
    show_records(step, step->recorded != NULL ? step->recorded->mode : 0, &found);
    return status;
}

/* Whether it has moved anything: what the daemon says now, else what was recorded. Where
 * others compute other steps, all go by the recording, or they would go apart. */
static int what_came(struct playing *playing, const struct pccd_answer *answer,
                     bool is_recorded, int then)
{
    if (answer == NULL) {
        return then;
    }
    if (playing->settings.next == NULL || !is_recorded) {
        return answer->status;
    }
    if (answer->status != then) {
        note_missed(playing);
    }
    return then;
}

static int show_step(struct playing *playing, const struct record_view *view,
                     const struct record_frame *frame, const uint8_t *slot,
                     bool asks_daemon, struct ctl_error *error)
{
    struct play_step step = {.number = frame->step,
                             .time_ns = view->time_ns,
                             .frame = frame,
                             .separation = playing->drive.separation,
                             .tells_start = playing->drive.tells,
                             .recorded = answers_find(&playing->answers, frame->step),
                             .hash_version =
                                 record_reader_hash_version(&playing->reader)};
    step.has_old_pairs = frame->mode == PCCD_MODE_PAIRS &&
                         (playing->answers.begin.flags & RECORD_EXACT_PAIRS) == 0;
    step.has_other_pairs = asks_daemon && step.has_old_pairs;
    int status = asks_daemon ? repeat_step(playing, view, slot, &step, error)
                             : recall_step(playing, &step, error);
    int then = step.recorded != NULL ? step.recorded->status : PCCD_OK;
    int result = what_came(playing, step.answer, step.recorded != NULL, then);
    if (status == PCCD_OK && result == PCCD_OK) {
        status = step_world(playing, view, frame, slot, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    step.scene = registry_scene(&playing->world, frame->scene);
    return playing->show(playing->context, &step, error);
}

static int follow_frame(struct playing *playing, const struct record_view *view,
                        const struct record_frame *frame, struct ctl_error *error)
{
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof(struct record_frame);
    const struct record_answer *recorded = answers_find(&playing->answers, frame->step);
    bool asks_daemon = playing->settings.source == PLAY_DAEMON ||
                       (playing->answers.begin.flags & RECORD_HAS_RECORDS) == 0;
    int status = PCCD_OK;
    playing->place++;
    progress_update(&playing->progress, frame->step);
    playing->wanted += is_shown(playing, frame->step);
    playing->last_step = frame->step;
    if (recorded != NULL && !play_is_repeatable(recorded->status)) {
        skip(playing, frame->step, false);
        return PCCD_OK;
    }
    if (!is_shown(playing, frame->step)) {
        note_missed(playing);
        return recorded == NULL || recorded->status == PCCD_OK
                   ? step_world(playing, view, frame, slot, error)
                   : PCCD_OK;
    }
    const struct record_separation *apart = &playing->drive.separation;
    status = judge_lengths(
        playing, view,
        is_length(apart->separation, PROTO_COORDINATE_MAX) &&
            is_length(apart->approach, 1) && is_length(frame->tolerance, 1),
        recorded != NULL ? recorded->status == PCCD_OK : !asks_daemon, error);
    if (status == PCCD_OK && asks_daemon) {
        status = begin_drive(playing, error);
    }
    return status == PCCD_OK ? show_step(playing, view, frame, slot, asks_daemon, error)
                             : status;
}

/* A step of another client in a shared scene. */
static int follow_move(struct playing *playing, const struct record_view *view,
                       const struct record_frame *frame, struct ctl_error *error)
{
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof(struct record_frame);
    int status = PCCD_OK;
    if (playing->settings.next != NULL) {
        note_missed(playing);
    } else if (playing->drive.is_begun) {
        status = drive_move(&playing->drive, frame, slot, error);
    }
    return status == PCCD_OK ? step_world(playing, view, frame, slot, error) : status;
}

/* ---- what is near ------------------------------------------------------------------ */

/* The daemon's answer. */
static int repeat_near(struct playing *playing, const struct record_view *view,
                       const uint8_t *slot, struct play_near *near,
                       struct ctl_error *error)
{
    struct record_near asked = *near->asked;
    struct found found;
    bool collects =
        playing->settings.needs_records && playing->settings.show_near != NULL;
    choose_how(playing, &asked.method, &asked.threads, &asked.deadline_ns);
    int status = ask_again(playing, view, NULL, &asked, slot, collects, &found, error);
    if (status == PCCD_OK) {
        near->answer = &playing->drive.answer;
        show_near_records(near, (uint32_t)near->answer->what, &found);
    }
    return status;
}

static int recall_near(struct playing *playing, struct play_near *near,
                       struct ctl_error *error)
{
    struct found found;
    int status = recall(playing, near->number, near->recorded != NULL, &found, error);
    show_near_records(near, near->recorded != NULL ? near->recorded->what : 0, &found);
    return status;
}

/* The world goes where the question has moved it to. */
static int move_near(struct playing *playing, const struct record_view *view,
                     const struct play_near *near, const uint8_t *slot,
                     struct ctl_error *error)
{
    const struct record_near *asked = near->asked;
    const struct record_frame frame = {.step = asked->step,
                                       .scene = asked->scene,
                                       .segment_count = asked->segment_count};
    int then = near->recorded != NULL ? near->recorded->status : PCCD_OK;
    int result = what_came(playing, near->answer, near->recorded != NULL, then);
    return result == PCCD_OK && asked->segment_count > 0
               ? step_world(playing, view, &frame, slot, error)
               : PCCD_OK;
}

/* A question about what is near. One that is not shown, and moves nothing, is not asked
 * again. */
static int follow_near(struct playing *playing, const struct record_view *view,
                       const struct record_near *asked, struct ctl_error *error)
{
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof *asked;
    struct play_near near = {.number = asked->step,
                             .asked = asked,
                             .tells_crossings = playing->drive.tells,
                             .recorded =
                                 answers_find_near(&playing->answers, asked->step)};
    playing->place++;
    bool shows = playing->settings.show_near != NULL && is_shown(playing, asked->step);
    bool asks_daemon = playing->settings.source == PLAY_DAEMON ||
                       (playing->answers.begin.flags & RECORD_HAS_RECORDS) == 0;
    int status = PCCD_OK;
    playing->wanted += shows;
    playing->last_step = asked->step;
    if (near.recorded != NULL && !play_is_repeatable(near.recorded->status)) {
        skip(playing, asked->step, true);
        return PCCD_OK;
    }
    double most = asked->what == PCCD_NEAR_NEAREST ? INFINITY : PROTO_COORDINATE_MAX;
    status = judge_lengths(
        playing, view,
        (is_length(asked->distance, most) || !common_near_has_distance(asked->what)) &&
            (is_length(asked->gap, most) || asked->what != PCCD_NEAR_NEAREST),
        near.recorded != NULL ? near.recorded->status == PCCD_OK : !asks_daemon, error);
    if (status == PCCD_OK && shows && asks_daemon) {
        status = begin_drive(playing, error);
    }
    bool is_missed = !shows && playing->settings.next != NULL;
    if (is_missed && asked->segment_count > 0) {
        note_missed(playing);
    } else if (!is_missed && status == PCCD_OK && playing->drive.is_begun &&
               (shows || asked->segment_count > 0)) {
        status = repeat_near(playing, view, slot, &near, error);
    } else if (status == PCCD_OK && shows) {
        status = recall_near(playing, &near, error);
    }
    if (status == PCCD_OK) {
        status = move_near(playing, view, &near, slot, error);
    }
    if (status != PCCD_OK || !shows) {
        return status;
    }
    struct registry_scene *scene = registry_scene(&playing->world, asked->scene);
    if (scene != NULL) {
        registry_pairs_settle(&scene->ignored); /* who may meet is asked for */
    }
    near.scene = scene;
    return playing->settings.show_near(playing->context, &near, error);
}

/* What was said of a step that has gone. */
static void forget_settings(struct playing *playing)
{
    playing->drive.tuning[0] = '\0';
    playing->drive.separation = (struct record_separation){0, 0};
    playing->drive.tells = false;
}

/* A FRAME or a MOVE. How its threads shared the work, the chunk before has told; in
 * earlier recordings its head does. */
static int follow_motion(struct playing *playing, const struct record_view *view,
                         const struct record_frame *frame, struct ctl_error *error)
{
    if (playing->drive.tuning[0] == '\0') {
        record_former_tuning(frame, playing->drive.tuning);
    }
    int status = view->kind == RECORD_FRAME ? follow_frame(playing, view, frame, error)
                                            : follow_move(playing, view, frame, error);
    forget_settings(playing);
    return status;
}

/* Once an item is done, ask for the next one. False: there is none. */
static bool goes_on(struct playing *playing)
{
    if (playing->settings.next == NULL || playing->place != playing->next_place) {
        return true;
    }
    playing->next_place = playing->settings.next(playing->context);
    return playing->next_place != 0;
}

/* Whether what an item has moved is there afterwards: if not it has failed. */
static bool has_moved(const struct playing *playing, const struct answers_asked *asked)
{
    const struct record_answer *answer = answers_find(&playing->answers, asked->step);
    const struct record_near_answer *near =
        answers_find_near(&playing->answers, asked->step);
    int32_t status = asked->is_near ? (near != NULL ? near->status : PCCD_OK)
                                    : (answer != NULL ? answer->status : PCCD_OK);
    return status == PCCD_OK;
}

/* Whether the item that comes need not be read: others compute it and the two that
 * follow, which move the same vertices. The last of these begins where the one before
 * ends. */
static bool is_passed(const struct playing *playing)
{
    const struct answers_asked *asked = playing->answers.asked + playing->place;
    return playing->place + 3 < playing->next_place && asked[0].moves != 0 &&
           asked[0].moves == asked[1].moves && asked[0].moves == asked[2].moves &&
           has_moved(playing, &asked[1]) && has_moved(playing, &asked[2]);
}

/* The next chunk, as record_reader_next gives it. Where others compute most items, these
 * are not read unless they are needed. */
static int next_chunk(struct playing *playing, struct record_view *view)
{
    const uint32_t items = 1u << RECORD_FRAME | 1u << RECORD_NEAR;
    struct record_reader *reader = &playing->reader;
    int got;
    if (playing->settings.next == NULL) {
        return record_reader_next(reader, view);
    }
    while ((got = record_reader_skim(reader, ~items, view)) == 1 &&
           (items >> view->kind & 1u) != 0) {
        if (!is_passed(playing)) {
            record_reader_seek(reader, view->offset);
            return record_reader_next(reader, view);
        }
        playing->place++;
        note_missed(playing);
        forget_settings(playing);
    }
    return got;
}

int play_follow(struct playing *playing, struct ctl_error *error)
{
    struct record_view view;
    int got, status = PCCD_OK;
    while (status == PCCD_OK && (got = next_chunk(playing, &view)) != 0) {
        if (got < 0) {
            return play_damaged(playing, got, playing->reader.text, playing->last_step,
                                error);
        }
        if (view.kind == RECORD_TUNING) {
            memcpy(playing->drive.tuning, view.payload, sizeof playing->drive.tuning);
            continue;
        }
        if (view.kind == RECORD_TELLS) {
            playing->drive.tells = true;
            continue;
        }
        if (view.kind == RECORD_SEPARATION) {
            memcpy(&playing->drive.separation, view.payload,
                   sizeof playing->drive.separation);
            continue;
        }
        if (view.kind == RECORD_FRAME || view.kind == RECORD_MOVE) {
            struct record_frame frame;
            memcpy(&frame, view.payload, sizeof frame);
            if (playing->settings.last != 0 && frame.step > playing->settings.last) {
                return PCCD_OK; /* a MOVE has no number */
            }
            status = follow_motion(playing, &view, &frame, error);
            if (status == PCCD_OK && !goes_on(playing)) {
                return PCCD_OK;
            }
            continue;
        }
        if (view.kind == RECORD_NEAR) {
            struct record_near near;
            memcpy(&near, view.payload, sizeof near);
            if (playing->settings.last != 0 && near.step > playing->settings.last) {
                return PCCD_OK;
            }
            status = follow_near(playing, &view, &near, error);
            forget_settings(playing);
            if (status == PCCD_OK && !goes_on(playing)) {
                return PCCD_OK;
            }
            continue;
        }
        status =
            misfit(playing, &view, world_follow(&playing->world, &view, error), error);
        if (status == PCCD_OK && playing->drive.is_begun) {
            status = drive_follow(&playing->drive, &playing->world, &view, error);
        }
    }
    return status == PCCD_E_CANCELLED ? PCCD_OK : status;
}
