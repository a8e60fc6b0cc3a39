/* client/ctl/record/play.c - the steps of a recording, one after the other.
 *
 * Room:     client/ctl.
 * Does:     two passes: the answers, because what to do with a step depends on what came
 *           of it; then the log, with a daemon beside it from the first step that is
 *           wanted on.
 * Does not: repeat what was before that step: the daemon is told where things are.
 * Threads:  one.
 * Source:   play.h.
 */
#include "play.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "answer_hash.h"
#include "answers.h"
#include "clock.h"
#include "ctl.h"
#include "drive.h"
#include "former_tuning.h"
#include "progress.h"

struct player {
    struct play_settings settings;
    struct play_summary *summary;
    play_fn show;
    void *context;
    struct record_reader reader;
    struct record_reader pages; /* the same file, at the records of answers */
    struct answers answers;
    struct registry world;
    struct drive drive;
    struct progress progress;
    struct step_trace trace;
    void *records; /* recorded ones */
    size_t record_room;
    uint64_t begun_ns; /* now, and then, of the first step that is repeated */
    uint64_t begun_then_ns;
    uint64_t wanted;    /* steps of the range that the file has */
    uint64_t last_step; /* read of the log */
};

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
static void keep_pace(struct player *player, uint64_t then_ns)
{
    if (player->begun_ns == 0) {
        player->begun_ns = common_now_ns();
        player->begun_then_ns = then_ns;
        return;
    }
    uint64_t at_ns = player->begun_ns + (then_ns - player->begun_then_ns);
    uint64_t now = common_now_ns();
    if (then_ns > player->begun_then_ns && at_ns > now) {
        const struct timespec pause = {(time_t)((at_ns - now) / 1000000000u),
                                       (long)((at_ns - now) % 1000000000u)};
        nanosleep(&pause, NULL);
    }
}

static bool is_shown(const struct player *player, uint64_t step)
{
    return step >= player->settings.first &&
           (player->settings.last == 0 || step <= player->settings.last);
}

/* A daemon that stands where the world stands, when the first step needs one. */
static int begin_drive(struct player *player, struct ctl_error *error)
{
    if (player->drive.is_begun) {
        return PCCD_OK;
    }
    if (ctl_link_open(player->settings.link, &player->drive.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", ""); /* it has been told */
    }
    player->summary->daemon_pid = pccd_daemon_pid(player->drive.client);
    return drive_begin(&player->drive, &player->world, error);
}

/* ---- asking again ------------------------------------------------------------------ */

/* Records of an answer: a daemon's, or those that were recorded. */
struct found {
    const void *records; /* NULL: none */
    uint64_t count;
    bool is_whole; /* all of them */
};

/* How it is asked again: as then, but for what the caller wants otherwise. */
static void choose_how(struct player *player, uint32_t *method, uint32_t *threads,
                       uint64_t *deadline_ns)
{
    *deadline_ns = 0; /* would end it anywhere */
    if (player->settings.method != PCCD_METHOD_DEFAULT) {
        *method = player->settings.method;
        player->drive.tuning[0] = '\0';
    }
    if (player->settings.threads != 0) {
        *threads = player->settings.threads;
    }
}

/* What was asked then of a daemon now, when its time has come. The one of frame and near
 * that is not NULL. */
static int ask_again(struct player *player, const struct record_view *view,
                     const struct record_frame *frame, const struct record_near *near,
                     const uint8_t *slot, bool collects, struct found *found,
                     struct ctl_error *error)
{
    const struct drive *drive = &player->drive;
    if (player->settings.at_recorded_pace) {
        keep_pace(player, view->time_ns);
    }
    if (player->settings.is_traced && frame != NULL) {
        step_trace_begin(&player->trace, drive->client);
    }
    uint64_t begin_ns = common_now_ns();
    int status = frame != NULL ? drive_step(&player->drive, frame, slot, collects, error)
                               : drive_near(&player->drive, near, slot, collects, error);
    player->summary->seconds += (double)(common_now_ns() - begin_ns) * 1e-9;
    *found = (struct found){.records = NULL};
    if (status == PCCD_OK && collects && drive->answer.status == PCCD_OK) {
        *found = (struct found){drive->records, drive->record_count,
                                drive->record_count == drive->answer.total};
    }
    return status;
}

/* The records that were recorded. */
static int recall(struct player *player, uint64_t number, bool is_answered,
                  struct found *found, struct ctl_error *error)
{
    *found = (struct found){.records = NULL};
    int status =
        answers_records(&player->answers, &player->pages, number, &player->records,
                        &player->record_room, &found->count, &found->is_whole, error);
    if (status == PCCD_OK && is_answered && found->count > 0) {
        found->records = player->records;
    }
    return status;
}

static void show_records(struct play_step *step, uint32_t mode, const struct found *found)
{
    step->count = found->count;
    step->is_whole = found->is_whole;
    step->contacts = mode == PCCD_MODE_PAIRS ? NULL : found->records;
    step->pairs = mode == PCCD_MODE_PAIRS ? found->records : NULL;
}

static void show_near_records(struct play_near *near, uint32_t what,
                              const struct found *found)
{
    near->count = found->count;
    near->is_whole = found->is_whole;
    near->records = what == PCCD_NEAR_VERTICES ? NULL : found->records;
    near->bounds = what == PCCD_NEAR_VERTICES ? found->records : NULL;
}

/* ---- steps ------------------------------------------------------------------------- */

/* The daemon's answer to a step. */
static int repeat_step(struct player *player, const struct record_view *view,
                       const uint8_t *slot, struct play_step *step,
                       struct ctl_error *error)
{
    struct record_frame asked = *step->frame;
    struct found found;
    /* A hash of another version is computed from the records. */
    bool collects =
        player->settings.needs_records || step->hash_version != PCCD_HASH_VERSION;
    choose_how(player, &asked.method, &asked.threads, &asked.deadline_ns);
    int status = ask_again(player, view, &asked, NULL, slot, collects, &found, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (player->settings.is_traced) {
        step_trace_end(&player->trace, player->drive.client);
        step->trace = &player->trace;
    }
    step->client = player->drive.client;
    step->answer = &player->drive.answer;
    show_records(step, (uint32_t)step->answer->mode, &found);
    return PCCD_OK;
}

static int recall_step(struct player *player, struct play_step *step,
                       struct ctl_error *error)
{
    struct found found;
    int status = recall(player, step->number, step->recorded != NULL, &found, error);
    show_records(step, step->recorded != NULL ? step->recorded->mode : 0, &found);
    return status;
}

static int show_step(struct player *player, const struct record_view *view,
                     const struct record_frame *frame, const uint8_t *slot,
                     bool asks_daemon, struct ctl_error *error)
{
    struct play_step step = {.number = frame->step,
                             .time_ns = view->time_ns,
                             .frame = frame,
                             .separation = player->drive.separation,
                             .recorded = answers_find(&player->answers, frame->step),
                             .hash_version = record_reader_hash_version(&player->reader)};
    step.has_other_pairs = asks_daemon && frame->mode == PCCD_MODE_PAIRS &&
                           (player->answers.begin.flags & RECORD_EXACT_PAIRS) == 0;
    int status = asks_daemon ? repeat_step(player, view, slot, &step, error)
                             : recall_step(player, &step, error);
    int result = step.answer != NULL     ? step.answer->status
                 : step.recorded != NULL ? step.recorded->status
                                         : PCCD_OK;
    if (status == PCCD_OK && result == PCCD_OK) {
        status = world_step(&player->world, frame, slot, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    step.scene = registry_scene(&player->world, frame->scene);
    return player->show(player->context, &step, error);
}

static int follow_frame(struct player *player, const struct record_view *view,
                        const struct record_frame *frame, struct ctl_error *error)
{
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof(struct record_frame);
    const struct record_answer *recorded = answers_find(&player->answers, frame->step);
    bool asks_daemon = player->settings.source == PLAY_DAEMON ||
                       (player->answers.begin.flags & RECORD_HAS_RECORDS) == 0;
    int status = PCCD_OK;
    progress_update(&player->progress, frame->step);
    player->wanted += is_shown(player, frame->step);
    player->last_step = frame->step;
    if (recorded != NULL && !play_is_repeatable(recorded->status)) {
        player->summary->skipped++;
        return PCCD_OK;
    }
    if (!is_shown(player, frame->step)) {
        return recorded == NULL || recorded->status == PCCD_OK
                   ? world_step(&player->world, frame, slot, error)
                   : PCCD_OK;
    }
    if (asks_daemon) {
        status = begin_drive(player, error);
    }
    return status == PCCD_OK ? show_step(player, view, frame, slot, asks_daemon, error)
                             : status;
}

/* A step of another client in a shared scene. */
static int follow_move(struct player *player, const struct record_view *view,
                       const struct record_frame *frame, struct ctl_error *error)
{
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof(struct record_frame);
    int status =
        player->drive.is_begun ? drive_move(&player->drive, frame, slot, error) : PCCD_OK;
    return status == PCCD_OK ? world_step(&player->world, frame, slot, error) : status;
}

/* ---- what is near ------------------------------------------------------------------ */

/* The daemon's answer. */
static int repeat_near(struct player *player, const struct record_view *view,
                       const uint8_t *slot, struct play_near *near,
                       struct ctl_error *error)
{
    struct record_near asked = *near->asked;
    struct found found;
    bool collects = player->settings.needs_records && player->settings.show_near != NULL;
    choose_how(player, &asked.method, &asked.threads, &asked.deadline_ns);
    int status = ask_again(player, view, NULL, &asked, slot, collects, &found, error);
    if (status == PCCD_OK) {
        near->answer = &player->drive.answer;
        show_near_records(near, (uint32_t)near->answer->what, &found);
    }
    return status;
}

static int recall_near(struct player *player, struct play_near *near,
                       struct ctl_error *error)
{
    struct found found;
    int status = recall(player, near->number, near->recorded != NULL, &found, error);
    show_near_records(near, near->recorded != NULL ? near->recorded->what : 0, &found);
    return status;
}

/* The world goes where the question has moved it to. */
static int move_near(struct player *player, const struct play_near *near,
                     const uint8_t *slot, struct ctl_error *error)
{
    const struct record_near *asked = near->asked;
    const struct record_frame frame = {.step = asked->step,
                                       .scene = asked->scene,
                                       .segment_count = asked->segment_count};
    int result = near->answer != NULL     ? near->answer->status
                 : near->recorded != NULL ? near->recorded->status
                                          : PCCD_OK;
    return result == PCCD_OK && asked->segment_count > 0
               ? world_step(&player->world, &frame, slot, error)
               : PCCD_OK;
}

/* A question about what is near. One that is not shown, and moves nothing, is not asked
 * again. */
static int follow_near(struct player *player, const struct record_view *view,
                       const struct record_near *asked, struct ctl_error *error)
{
    const uint8_t *slot = (const uint8_t *)view->payload + sizeof *asked;
    struct play_near near = {.number = asked->step,
                             .asked = asked,
                             .recorded =
                                 answers_find_near(&player->answers, asked->step)};
    bool shows = player->settings.show_near != NULL && is_shown(player, asked->step);
    bool asks_daemon = player->settings.source == PLAY_DAEMON ||
                       (player->answers.begin.flags & RECORD_HAS_RECORDS) == 0;
    int status = PCCD_OK;
    player->wanted += shows;
    player->last_step = asked->step;
    if (near.recorded != NULL && !play_is_repeatable(near.recorded->status)) {
        player->summary->skipped++;
        return PCCD_OK;
    }
    if (shows && asks_daemon) {
        status = begin_drive(player, error);
    }
    if (status == PCCD_OK && player->drive.is_begun &&
        (shows || asked->segment_count > 0)) {
        status = repeat_near(player, view, slot, &near, error);
    } else if (status == PCCD_OK && shows) {
        status = recall_near(player, &near, error);
    }
    if (status == PCCD_OK) {
        status = move_near(player, &near, slot, error);
    }
    if (status != PCCD_OK || !shows) {
        return status;
    }
    struct registry_scene *scene = registry_scene(&player->world, asked->scene);
    if (scene != NULL) {
        registry_pairs_settle(&scene->ignored); /* who may meet is asked for */
    }
    near.scene = scene;
    return player->settings.show_near(player->context, &near, error);
}

/* What to do about it is to stop before; a range ends where the next step is read. */
static int damaged(const struct player *player, int status, struct ctl_error *error)
{
    const char *path = player->settings.path, *text = player->reader.text;
    return player->last_step <= 1
               ? ctl_error_set(error, status, "%s: %s", path, text)
               : ctl_error_set(error, status,
                               "%s: %s; --steps ..%" PRIu64 " is what comes before", path,
                               text, player->last_step - 1);
}

/* What was said of a step that has gone. */
static void forget_settings(struct player *player)
{
    player->drive.tuning[0] = '\0';
    player->drive.separation = (struct record_separation){0, 0};
}

/* A FRAME or a MOVE. How its threads shared the work, the chunk before has told; in
 * earlier recordings its head does. */
static int follow_motion(struct player *player, const struct record_view *view,
                         const struct record_frame *frame, struct ctl_error *error)
{
    if (player->drive.tuning[0] == '\0') {
        record_former_tuning(frame, player->drive.tuning);
    }
    int status = view->kind == RECORD_FRAME ? follow_frame(player, view, frame, error)
                                            : follow_move(player, view, frame, error);
    forget_settings(player);
    return status;
}

static int follow(struct player *player, struct ctl_error *error)
{
    struct record_view view;
    int got, status = PCCD_OK;
    while (status == PCCD_OK && (got = record_reader_next(&player->reader, &view)) != 0) {
        if (got < 0) {
            return damaged(player, got, error);
        }
        if (view.kind == RECORD_TUNING) {
            memcpy(player->drive.tuning, view.payload, sizeof player->drive.tuning);
            continue;
        }
        if (view.kind == RECORD_SEPARATION) {
            memcpy(&player->drive.separation, view.payload,
                   sizeof player->drive.separation);
            continue;
        }
        if (view.kind == RECORD_FRAME || view.kind == RECORD_MOVE) {
            struct record_frame frame;
            memcpy(&frame, view.payload, sizeof frame);
            if (player->settings.last != 0 && frame.step > player->settings.last) {
                return PCCD_OK; /* a MOVE has no number */
            }
            status = follow_motion(player, &view, &frame, error);
            continue;
        }
        if (view.kind == RECORD_NEAR) {
            struct record_near near;
            memcpy(&near, view.payload, sizeof near);
            if (player->settings.last != 0 && near.step > player->settings.last) {
                return PCCD_OK;
            }
            status = follow_near(player, &view, &near, error);
            forget_settings(player);
            continue;
        }
        if (player->drive.is_begun) {
            status = drive_follow(&player->drive, &player->world, &view, error);
        }
        if (status == PCCD_OK) {
            status = world_follow(&player->world, &view, error);
        }
    }
    return status == PCCD_E_CANCELLED ? PCCD_OK : status;
}

/* A range that the file has nothing of is a mistake, not a success. */
static int judge_range(const struct player *player, struct ctl_error *error)
{
    const struct play_settings *settings = &player->settings;
    bool is_range = settings->first > 1 || settings->last != 0;
    return player->wanted > 0 || !is_range
               ? PCCD_OK
               : ctl_error_set(
                     error, PCCD_E_INVAL,
                     "%s holds no such step; it has %" PRIu64 ", the last %" PRIu64,
                     settings->path, player->summary->frames + player->summary->questions,
                     player->summary->last_step);
}

static bool is_last_choice(const struct play_settings *settings, int32_t status,
                           uint64_t step)
{
    return status == PCCD_OK && step >= settings->first &&
           (settings->last == 0 || step <= settings->last);
}

/* The range becomes its last step, or its last question about what is near if these are
 * shown, that was answered with success. */
static void choose_last(struct player *player)
{
    struct play_settings *settings = &player->settings;
    const struct answers *answers = &player->answers;
    bool is_near = settings->show_near != NULL;
    for (size_t i = is_near ? answers->near_count : answers->count; i > 0; i--) {
        uint64_t step = is_near ? answers->nears[i - 1].step : answers->items[i - 1].step;
        int32_t status =
            is_near ? answers->nears[i - 1].status : answers->items[i - 1].status;
        if (is_last_choice(settings, status, step)) {
            settings->first = settings->last = step;
            return;
        }
    }
}

/* Both readers, and all answers. A damaged file is played up to the damage. */
static int open_all(struct player *player, struct ctl_error *error)
{
    const char *path = player->settings.path;
    struct ctl_error damage = {.text = ""};
    int status = record_reader_open(&player->reader, path);
    if (status == PCCD_OK) {
        status = record_reader_open(&player->pages, path);
    }
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "%s: %s", path, player->reader.text);
    }
    status = answers_read(&player->answers, &player->reader, &damage);
    player->summary->begin = player->answers.begin;
    player->summary->frames = player->answers.frames;
    player->summary->questions = player->answers.questions;
    player->summary->answers = player->answers.count;
    player->summary->last_step = player->answers.last_step;
    player->summary->ending = player->reader.ending;
    player->summary->end_reason = player->reader.end_reason;
    player->summary->ending_offset = player->reader.offset;
    record_reader_seek(&player->reader, RECORD_HEAD_BYTES);
    if (player->settings.only_last) {
        choose_last(player);
    }
    return status == PCCD_E_NOMEM ? ctl_error_set(error, status, "%s", damage.text)
                                  : PCCD_OK;
}

int play(const struct play_settings *settings, play_fn show, void *context,
         struct play_summary *summary, struct ctl_error *error)
{
    struct player player = {.settings = *settings,
                            .summary = summary,
                            .show = show,
                            .context = context,
                            .reader = {.fd = -1},
                            .pages = {.fd = -1}};
    memset(summary, 0, sizeof *summary);
    int status = open_all(&player, error);
    if (status == PCCD_OK) {
        progress_begin(&player.progress, settings->label,
                       player.settings.last != 0 ? player.settings.last
                                                 : summary->last_step);
        status = follow(&player, error);
        status = status == PCCD_OK ? judge_range(&player, error) : status;
        progress_clear(&player.progress);
    }
    drive_deinit(&player.drive);
    pccd_close(player.drive.client);
    registry_deinit(&player.world);
    answers_deinit(&player.answers);
    record_reader_deinit(&player.reader);
    record_reader_deinit(&player.pages);
    step_trace_deinit(&player.trace);
    free(player.records);
    return status;
}
