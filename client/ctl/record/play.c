/* play.c - the steps and questions of a recording, one after the other. */
#include "play.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "answers.h"
#include "clock.h"
#include "ctl.h"
#include "names.h"
#include "payload.h"
#include "proto_limits.h"
#include "replayer.h"
#include "terminal.h"

struct play_reader {
    struct play_settings settings;
    struct play_summary *summary;
    play_fn show;
    void *context;
    struct record_reader chunks;
    struct record_reader pages; /* the same file, at the records of answers */
    struct answers answers;
    struct registry state;
    struct replayer replayer;
    struct recorded_joints joints; /* of the item that is shown */
    struct recorded_item item;     /* the next one, as far as it is read */
    bool asks_daemon;              /* for the answers of what is shown */
    struct progress progress;
    struct step_trace trace;
    struct answers_found found; /* recorded ones */
    uint64_t begun_ns;          /* now, and then, of the first step that is repeated */
    uint64_t begun_then_ns;
    uint64_t wanted;            /* items of the range that the file has */
    uint64_t last_step;         /* read of the log */
    uint64_t place, next_place; /* items read, and the one that is to be shown next */
    int damage;                 /* where reading the answers ended; PCCD_OK: at the end */
    char damage_text[sizeof(((struct record_reader *)0)->text)];
};

/* Return whether a step that failed so fails again. */
static bool is_repeatable(int status)
{
    return status == PCCD_OK || status == PCCD_E_INVAL || status == PCCD_E_HANDLE ||
           status == PCCD_E_SEGMENT || status == PCCD_E_NOTFINITE ||
           status == PCCD_E_INDEX;
}

bool play_is_complete(uint32_t incomplete)
{
    return incomplete == PCCD_COMPLETE || incomplete == PCCD_INCOMPLETE_RESULT_FULL;
}

bool play_has_gap(const struct record_frame *asked)
{
    return asked->what == PCCD_NEAR_NEAREST && asked->gap > 0;
}

bool play_is_within(const struct play_settings *settings, uint64_t step)
{
    return step >= settings->first && (settings->last == 0 || step <= settings->last);
}

/* Say what is wrong with the file behind step `last_step`, and that a range may stop
 * before. Returns `status`. */
static int damaged(const struct play_reader *reader, int status, const char *text,
                   uint64_t last_step, struct ctl_error *error)
{
    const char *path = reader->settings.path;
    return last_step <= 1
               ? ctl_error_set(error, status, "%s: %s", path, text)
               : ctl_error_set(error, status,
                               "%s: %s; --steps ..%" PRIu64 " is what comes before", path,
                               text, last_step - 1);
}

/* ---- asking again ------------------------------------------------------------------ */

/* Wait until as much time has passed as then. */
static void keep_pace(struct play_reader *reader, uint64_t then_ns)
{
    if (reader->begun_ns == 0) {
        reader->begun_ns = common_now_ns();
        reader->begun_then_ns = then_ns;
        return;
    }
    uint64_t at_ns = reader->begun_ns + (then_ns - reader->begun_then_ns);
    uint64_t now = common_now_ns();
    if (then_ns > reader->begun_then_ns && at_ns > now) {
        const struct timespec pause = {(time_t)((at_ns - now) / 1000000000u),
                                       (long)((at_ns - now) % 1000000000u)};
        nanosleep(&pause, NULL);
    }
}

/* A daemon, when the first item needs one. */
static int open_daemon(struct play_reader *reader, struct ctl_error *error)
{
    if (reader->replayer.client != NULL) {
        return PCCD_OK;
    }
    if (ctl_link_open(reader->settings.link, &reader->replayer.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", ""); /* it has been told */
    }
    reader->summary->daemon_pid = pccd_daemon_pid(reader->replayer.client);
    return PCCD_OK;
}

/* Ask the item of a daemon now, when its time has come: as then, but for what the caller
 * wants otherwise. */
static int ask_again(struct play_reader *reader, uint64_t then_ns,
                     struct answers_found *found, struct ctl_error *error)
{
    const struct play_settings *settings = &reader->settings;
    struct replayer *replayer = &reader->replayer;
    struct recorded_item asked = reader->item;
    bool is_traced = settings->is_traced && !asked.is_near;
    int status = open_daemon(reader, error);
    if (status != PCCD_OK) {
        return status;
    }
    asked.frame.deadline_ns = 0; /* would end it anywhere */
    if (settings->method != PCCD_METHOD_DEFAULT) {
        asked.frame.method = settings->method;
        memset(asked.frame.tuning, 0, sizeof asked.frame.tuning);
    }
    if (settings->threads != 0) {
        asked.frame.threads = settings->threads;
    }
    if (settings->at_recorded_pace) {
        keep_pace(reader, then_ns);
    }
    if (is_traced) {
        step_trace_begin(&reader->trace, replayer->client);
    }
    uint64_t begin_ns = common_now_ns();
    status =
        replayer_ask(replayer, &reader->state, &asked, settings->needs_records, error);
    reader->summary->seconds += (double)(common_now_ns() - begin_ns) * 1e-9;
    if (status == PCCD_OK && is_traced) {
        step_trace_end(&reader->trace, replayer->client);
    }
    *found = (struct answers_found){.records = NULL};
    if (status == PCCD_OK && settings->needs_records &&
        replayer->answer.status == PCCD_OK) {
        *found = (struct answers_found){.records = replayer->records,
                                        .count = replayer->record_count,
                                        .first_count = replayer->answer.count,
                                        .is_whole = replayer->record_count ==
                                                    replayer->answer.total};
    }
    return status;
}

/* The records that were recorded. */
static int recall(struct play_reader *reader, bool is_answered,
                  struct answers_found *found, struct ctl_error *error)
{
    int status = answers_records(&reader->answers, &reader->pages,
                                 reader->item.frame.step, &reader->found, error);
    *found = reader->found;
    if (!is_answered || found->count == 0) {
        found->records = NULL;
    }
    return status;
}

/* ---- what cannot have been --------------------------------------------------------- */

/* A chunk does not fit the others, as the error says: where it is, and what comes
 * before. */
static int misfit(const struct play_reader *reader, const struct record_view *view,
                  int status, struct ctl_error *error)
{
    char text[CTL_ERROR_TEXT_BYTES];
    if (status != PCCD_E_FORMAT) {
        return status;
    }
    (void)snprintf(text, sizeof text, "at byte %" PRIu64 ", %s: %.900s", view->offset,
                   record_kind_name(view->kind), error->text);
    return damaged(reader, status, text, reader->last_step, error);
}

static bool is_length(double length, double most)
{
    return length >= 0 && length <= most;
}

/* Return whether the lengths that an item asks with can be lengths. */
static bool has_lengths(const struct recorded_item *item)
{
    const struct record_frame *asked = &item->frame;
    if (!item->is_near) {
        return is_length(asked->separation, PROTO_COORDINATE_MAX) &&
               is_length(asked->approach, 1) && is_length(asked->tolerance, 1);
    }
    double most = asked->what == PCCD_NEAR_NEAREST ? INFINITY : PROTO_COORDINATE_MAX;
    return (is_length(asked->distance, most) || !common_near_has_distance(asked->what)) &&
           (is_length(asked->gap, most) || asked->what != PCCD_NEAR_NEAREST);
}

/* ---- showing ----------------------------------------------------------------------- */

static void describe_step(const struct play_reader *reader, struct play_step *step)
{
    const struct record_answer *then = step->recorded;
    const struct pccd_answer *answer = step->answer;
    uint32_t mode = answer != NULL ? (uint32_t)answer->mode
                    : then != NULL ? then->mode
                                   : 0;
    step->joints = reader->joints;
    if (mode == PCCD_MODE_PAIRS) {
        step->pairs = step->found.records;
    } else {
        step->contacts = step->found.records;
    }
    if (answer != NULL) {
        step->client = reader->replayer.client;
        step->trace = reader->settings.is_traced ? &reader->trace : NULL;
    }
}

static void describe_near(const struct play_reader *reader, struct play_step *step)
{
    const struct record_answer *then = step->recorded;
    uint32_t what = step->answer != NULL ? (uint32_t)step->answer->what
                    : then != NULL       ? then->what
                                         : 0;
    step->asked = &reader->item.frame;
    if (what == PCCD_NEAR_VERTICES) {
        step->bounds = step->found.records;
    } else {
        step->nears = step->found.records;
    }
}

static int show_step(struct play_reader *reader, uint64_t then_ns,
                     const struct pccd_answer *answer, const struct registry_scene *scene,
                     const struct answers_found *found, struct ctl_error *error)
{
    const struct recorded_item *item = &reader->item;
    uint64_t told = item->is_near ? 0 : reader->settings.number;
    struct play_step step = {
        .number = told != 0 ? told : item->frame.step,
        .time_ns = then_ns,
        .scene = scene,
        .answer = answer,
        .found = *found,
        .frame = &item->frame,
        .recorded = answers_find(&reader->answers, item->is_near, item->frame.step)};
    if (item->is_near) {
        describe_near(reader, &step);
    } else if (recorded_joints_of(item, &reader->joints)) {
        describe_step(reader, &step);
    } else {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for joints");
    }
    return reader->show(reader->context, &step, error);
}

/* ---- items ------------------------------------------------------------------------- */

/* Return whether the item that is read is of the range, or the next that is asked for. */
static bool is_wanted(const struct play_reader *reader)
{
    return reader->settings.next != NULL
               ? reader->place == reader->next_place
               : play_is_within(&reader->settings, reader->item.frame.step);
}

/* The state goes where the item has moved it to. is_seen: and so has the daemon. */
static int move_state(struct play_reader *reader, const struct record_view *view,
                      bool is_seen, struct ctl_error *error)
{
    const struct recorded_item *item = &reader->item;
    if (item->is_near && item->frame.segment_count == 0) {
        return PCCD_OK;
    }
    int status = recorded_state_move(&reader->state, item, error);
    if (status == PCCD_OK && !is_seen) {
        struct registry_scene *scene = registry_scene(&reader->state, item->frame.scene);
        scene->is_placed = scene->has_begin = false;
    }
    return misfit(reader, view, status, error);
}

/* Show the item that is read. Whether it has moved anything, the daemon says now, else
 * what was recorded; but where others compute other items, all go by the recording, or
 * they would go apart. */
static int show_item(struct play_reader *reader, const struct record_view *view,
                     bool is_answered, int then, struct ctl_error *error)
{
    const struct pccd_answer *answer =
        reader->asks_daemon ? &reader->replayer.answer : NULL;
    struct answers_found found;
    int status = reader->asks_daemon ? ask_again(reader, view->time_ns, &found, error)
                                     : recall(reader, is_answered, &found, error);
    if (status != PCCD_OK) {
        return status;
    }
    int now = answer != NULL ? answer->status : then;
    bool goes_by_now = reader->settings.next == NULL || !is_answered;
    struct registry_scene *scene =
        registry_scene(&reader->state, reader->item.frame.scene);
    if (scene != NULL && !goes_by_now && now != then) {
        scene->is_placed = scene->has_begin = false;
    }
    if ((goes_by_now ? now : then) == PCCD_OK) {
        status = move_state(reader, view, answer != NULL && now == PCCD_OK, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    if (scene != NULL) {
        registry_pairs_settle(&scene->pairs); /* who may meet is asked for */
    }
    return show_step(reader, view->time_ns, answer, scene, &found, error);
}

/* The item that is read, which `view` has brought. */
static int follow_item(struct play_reader *reader, const struct record_view *view,
                       struct ctl_error *error)
{
    const struct recorded_item *item = &reader->item;
    if (view->kind == RECORD_MOVE) {
        return move_state(reader, view, false, error);
    }
    const struct record_answer *answer =
        answers_find(&reader->answers, item->is_near, item->frame.step);
    bool is_answered = answer != NULL;
    int32_t then = is_answered ? answer->status : PCCD_OK;
    reader->place++;
    reader->last_step = item->frame.step;
    progress_update(&reader->progress, item->frame.step);
    const struct play_settings *settings = &reader->settings;
    bool shows = is_wanted(reader) && (!item->is_near || settings->shows_near);
    reader->wanted += shows;
    if (!is_repeatable(then)) { /* it had failed by chance */
        reader->summary->skipped++;
        if (settings->show_skipped != NULL && is_wanted(reader)) {
            settings->show_skipped(reader->context, item->frame.step, item->is_near);
        }
        return PCCD_OK;
    }
    bool is_taken = is_answered ? then == PCCD_OK : !reader->asks_daemon;
    if ((shows || item->is_near) && is_taken && !has_lengths(item)) {
        (void)ctl_error_set(error, PCCD_E_FORMAT,
                            "a distance or tolerance that cannot be one");
        return misfit(reader, view, PCCD_E_FORMAT, error);
    }
    if (shows) {
        return show_item(reader, view, is_answered, then, error);
    }
    return then == PCCD_OK ? move_state(reader, view, false, error) : PCCD_OK;
}

/* Once an item is done, ask for the next one. False: there is none. */
static bool goes_on(struct play_reader *reader)
{
    if (reader->settings.next == NULL || reader->place != reader->next_place) {
        return true;
    }
    reader->next_place = reader->settings.next(reader->context);
    return reader->next_place != 0;
}

/* Return whether what an item has moved is where it put it: not if the item has
 * failed. */
static bool has_moved(const struct play_reader *reader, const struct answers_asked *asked)
{
    const struct record_answer *answer =
        answers_find(&reader->answers, asked->is_near, asked->step);
    return answer == NULL || answer->status == PCCD_OK;
}

/* Return whether the item that comes need not be read: others compute it and the two that
 * follow, which move the same vertices. The last of these begins where the one before
 * ends. */
static bool is_passed(const struct play_reader *reader)
{
    const struct answers_asked *asked = reader->answers.asked + reader->place;
    return reader->place + 3 < reader->next_place && asked[0].moves != 0 &&
           asked[0].moves == asked[1].moves && asked[0].moves == asked[2].moves &&
           has_moved(reader, &asked[1]) && has_moved(reader, &asked[2]);
}

/* The next chunk, as record_reader_next gives it. Where others compute most items, these
 * are not read unless they are needed. */
static int next_chunk(struct play_reader *reader, struct record_view *view)
{
    const uint32_t items = 1u << RECORD_FRAME | 1u << RECORD_NEAR;
    struct record_reader *chunks = &reader->chunks;
    int got;
    if (reader->settings.next == NULL) {
        return record_reader_next(chunks, view);
    }
    while ((got = record_reader_skim(chunks, ~items, view)) == 1 &&
           (items >> view->kind & 1u) != 0) {
        if (!is_passed(reader)) {
            record_reader_seek(chunks, view->offset);
            return record_reader_next(chunks, view);
        }
        reader->place++;
        reader->item = (struct recorded_item){.slot = NULL};
    }
    return got;
}

/* Go through the log. */
static int follow(struct play_reader *reader, struct ctl_error *error)
{
    const uint64_t last = reader->settings.last;
    struct record_view view;
    int got, status = PCCD_OK;
    while (status == PCCD_OK && (got = next_chunk(reader, &view)) != 0) {
        if (got < 0) {
            return damaged(reader, got, reader->chunks.text, reader->last_step, error);
        }
        if (!recorded_item_take(&reader->item, &view)) {
            status = misfit(
                reader, &view,
                replayer_follow(&reader->replayer, &reader->state, &view, error), error);
            continue;
        }
        if (last != 0 && reader->item.frame.step > last) {
            return PCCD_OK;
        }
        status = follow_item(reader, &view, error);
        reader->item = (struct recorded_item){.slot = NULL};
        if (status == PCCD_OK && !goes_on(reader)) {
            return PCCD_OK;
        }
    }
    return status == PCCD_E_CANCELLED ? PCCD_OK : status;
}

/* ---- from the beginning to the end ------------------------------------------------- */

/* The first answered question about what is near in the range; NULL: there is none. */
static const struct record_answer *find_question(const struct play_reader *reader)
{
    const struct answers *answers = &reader->answers;
    for (size_t i = 0; i < answers->count; i++) {
        const struct record_answer *answer = &answers->items[i];
        if (answer->is_near != 0 && play_is_within(&reader->settings, answer->step)) {
            return answer;
        }
    }
    return NULL;
}

/* A range that the file has nothing of is a mistake, not a success. */
static int judge_range(const struct play_reader *reader, struct ctl_error *error)
{
    const struct play_settings *settings = &reader->settings;
    bool is_range = settings->first > 1 || settings->last != 0;
    if (reader->wanted > 0 || !is_range) {
        return PCCD_OK;
    }
    const struct record_answer *question = find_question(reader);
    return question != NULL
               ? ctl_error_set(error, PCCD_E_INVAL,
                               "%s: number %" PRIu64
                               " is a question about what is near, not a step; render "
                               "--near draws it",
                               settings->path, question->step)
               : ctl_error_set(
                     error, PCCD_E_INVAL,
                     "%s holds no such step; it has %" PRIu64 ", the last %" PRIu64,
                     settings->path, reader->summary->frames + reader->summary->questions,
                     reader->summary->last_step);
}

/* The range becomes its last step, or its last question about what is near if these are
 * shown, that was answered with success. */
static void choose_last(struct play_reader *reader)
{
    struct play_settings *settings = &reader->settings;
    const struct answers *answers = &reader->answers;
    for (size_t i = answers->count; i > 0; i--) {
        const struct record_answer *answer = &answers->items[i - 1];
        if ((answer->is_near != 0) == settings->shows_near && answer->status == PCCD_OK &&
            play_is_within(settings, answer->step)) {
            settings->first = settings->last = answer->step;
            return;
        }
    }
}

/* Both readers, and all answers. A damaged file is played up to the damage. */
static int open_all(struct play_reader *reader, struct ctl_error *error)
{
    const char *path = reader->settings.path;
    const char *from = reader->settings.from != NULL ? reader->settings.from : path;
    struct ctl_error damage = {.text = ""};
    int status = record_reader_open(&reader->chunks, from);
    if (status == PCCD_OK) {
        status = record_reader_open(&reader->pages, from);
    }
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "%s: %s", path, reader->chunks.text);
    }
    status = answers_read(&reader->answers, &reader->chunks, &damage);
    reader->summary->begin = reader->answers.begin;
    reader->summary->frames = reader->answers.frames;
    reader->summary->questions = reader->answers.questions;
    reader->summary->answers = reader->answers.count;
    reader->summary->last_step = reader->answers.last_step;
    reader->summary->ending = reader->chunks.ending;
    reader->summary->end_reason = reader->chunks.end_reason;
    reader->summary->ending_offset = reader->chunks.offset;
    if (status != PCCD_OK) {
        reader->damage = status;
        (void)snprintf(reader->damage_text, sizeof reader->damage_text, "%s",
                       reader->chunks.text);
    }
    record_reader_seek(&reader->chunks, RECORD_HEAD_BYTES);
    reader->asks_daemon = reader->settings.source == PLAY_DAEMON ||
                          (reader->answers.begin.flags & RECORD_HAS_RECORDS) == 0;
    if (reader->settings.only_last) {
        choose_last(reader);
    }
    return status == PCCD_E_NOMEM ? ctl_error_set(error, status, "%s", damage.text)
                                  : PCCD_OK;
}

int play_open(const struct play_settings *settings, struct play_summary *summary,
              struct play_reader **reader, struct ctl_error *error)
{
    struct play_reader *made = calloc(1, sizeof *made);
    *reader = made;
    memset(summary, 0, sizeof *summary);
    if (made == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    made->settings = *settings;
    made->summary = summary;
    made->chunks.fd = -1;
    made->pages.fd = -1;
    return open_all(made, error);
}

struct answers *play_answers(struct play_reader *reader)
{
    return &reader->answers;
}

int play_damage(const struct play_reader *reader, struct ctl_error *error)
{
    return reader->damage == PCCD_OK
               ? PCCD_OK
               : damaged(reader, reader->damage, reader->damage_text,
                         reader->summary->last_step, error);
}

int play_run(struct play_reader *reader, play_fn show, void *context,
             struct ctl_error *error)
{
    const struct play_settings *settings = &reader->settings;
    reader->show = show;
    reader->context = context;
    if (settings->next != NULL) { /* all that is wanted of a file may be elsewhere */
        reader->next_place = settings->next(context);
        return reader->next_place != 0 ? follow(reader, error) : PCCD_OK;
    }
    progress_begin(&reader->progress, settings->label,
                   settings->last != 0 ? settings->last : reader->summary->last_step);
    int status = follow(reader, error);
    progress_clear(&reader->progress);
    return status == PCCD_OK ? judge_range(reader, error) : status;
}

void play_close(struct play_reader *reader)
{
    if (reader == NULL) {
        return;
    }
    pccd_close(reader->replayer.client);
    replayer_deinit(&reader->replayer);
    recorded_joints_deinit(&reader->joints);
    registry_deinit(&reader->state);
    answers_deinit(&reader->answers);
    record_reader_deinit(&reader->chunks);
    record_reader_deinit(&reader->pages);
    step_trace_deinit(&reader->trace);
    free(reader->found.records);
    free(reader);
}

int play(const struct play_settings *settings, play_fn show, void *context,
         struct play_summary *summary, struct ctl_error *error)
{
    struct play_reader *reader = NULL;
    int status = play_open(settings, summary, &reader, error);
    if (status == PCCD_OK) {
        status = play_run(reader, show, context, error);
    }
    play_close(reader);
    return status;
}
