/* play_open.c - opens a recording, and ends what was played of it. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "play.h"
#include "playing.h"

int play_damaged(const struct playing *playing, int status, const char *text,
                 uint64_t last_step, struct ctl_error *error)
{
    const char *path = playing->settings.path;
    return last_step <= 1
               ? ctl_error_set(error, status, "%s: %s", path, text)
               : ctl_error_set(error, status,
                               "%s: %s; --steps ..%" PRIu64 " is what comes before", path,
                               text, last_step - 1);
}

bool play_is_within(const struct play_settings *settings, uint64_t step)
{
    return step >= settings->first && (settings->last == 0 || step <= settings->last);
}

/* The first answered question about what is near in the range; NULL: there is none. */
static const struct record_near_answer *find_question(const struct playing *playing)
{
    const struct answers *answers = &playing->answers;
    for (size_t i = 0; i < answers->near_count; i++) {
        if (play_is_within(&playing->settings, answers->nears[i].step)) {
            return &answers->nears[i];
        }
    }
    return NULL;
}

/* A range that the file has nothing of is a mistake, not a success. */
static int judge_range(const struct playing *playing, struct ctl_error *error)
{
    const struct play_settings *settings = &playing->settings;
    bool is_range = settings->first > 1 || settings->last != 0;
    if (playing->wanted > 0 || !is_range) {
        return PCCD_OK;
    }
    const struct record_near_answer *question = find_question(playing);
    return question != NULL
               ? ctl_error_set(error, PCCD_E_INVAL,
                               "%s: number %" PRIu64
                               " is a question about what is near, not a step; render "
                               "--near draws it",
                               settings->path, question->step)
               : ctl_error_set(error, PCCD_E_INVAL,
                               "%s holds no such step; it has %" PRIu64
                               ", the last %" PRIu64,
                               settings->path,
                               playing->summary->frames + playing->summary->questions,
                               playing->summary->last_step);
}

/* The range becomes its last step, or its last question about what is near if these are
 * shown, that was answered with success. */
static void choose_last(struct playing *playing)
{
    struct play_settings *settings = &playing->settings;
    const struct answers *answers = &playing->answers;
    bool is_near = settings->show_near != NULL;
    for (size_t i = is_near ? answers->near_count : answers->count; i > 0; i--) {
        uint64_t step = is_near ? answers->nears[i - 1].step : answers->items[i - 1].step;
        int32_t status =
            is_near ? answers->nears[i - 1].status : answers->items[i - 1].status;
        if (status == PCCD_OK && play_is_within(settings, step)) {
            settings->first = settings->last = step;
            return;
        }
    }
}

/* Both readers, and all answers. A damaged file is played up to the damage. */
static int open_all(struct playing *playing, struct ctl_error *error)
{
    const char *path = playing->settings.path;
    const char *from = playing->settings.from != NULL ? playing->settings.from : path;
    struct ctl_error damage = {.text = ""};
    int status = record_reader_open(&playing->reader, from);
    if (status == PCCD_OK) {
        status = record_reader_open(&playing->pages, from);
    }
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "%s: %s", path, playing->reader.text);
    }
    status = answers_read(&playing->answers, &playing->reader, &damage);
    playing->summary->begin = playing->answers.begin;
    playing->summary->frames = playing->answers.frames;
    playing->summary->questions = playing->answers.questions;
    playing->summary->answers = playing->answers.count;
    playing->summary->last_step = playing->answers.last_step;
    playing->summary->ending = playing->reader.ending;
    playing->summary->end_reason = playing->reader.end_reason;
    playing->summary->ending_offset = playing->reader.offset;
    if (status != PCCD_OK) {
        playing->damage = status;
        (void)snprintf(playing->damage_text, sizeof playing->damage_text, "%s",
                       playing->reader.text);
    }
    record_reader_seek(&playing->reader, RECORD_HEAD_BYTES);
    if (playing->settings.only_last) {
        choose_last(playing);
    }
    return status == PCCD_E_NOMEM ? ctl_error_set(error, status, "%s", damage.text)
                                  : PCCD_OK;
}

int play_open(const struct play_settings *settings, struct play_summary *summary,
              struct playing **playing, struct ctl_error *error)
{
    struct playing *made = calloc(1, sizeof *made);
    *playing = made;
    memset(summary, 0, sizeof *summary);
    if (made == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    made->settings = *settings;
    made->summary = summary;
    made->reader.fd = -1;
    made->pages.fd = -1;
    return open_all(made, error);
}

struct answers *play_answers(struct playing *playing)
{
    return &playing->answers;
}

int play_damage(const struct playing *playing, struct ctl_error *error)
{
    return playing->damage == PCCD_OK
               ? PCCD_OK
               : play_damaged(playing, playing->damage, playing->damage_text,
                              playing->summary->last_step, error);
}

/* All that is wanted of a file may be elsewhere. */
static int run(struct playing *playing, struct ctl_error *error)
{
    const struct play_settings *settings = &playing->settings;
    if (settings->next != NULL) {
        playing->next_place = settings->next(playing->context);
        return playing->next_place != 0 ? play_follow(playing, error) : PCCD_OK;
    }
    progress_begin(&playing->progress, settings->label,
                   settings->last != 0 ? settings->last : playing->summary->last_step);
    int status = play_follow(playing, error);
    progress_clear(&playing->progress);
    return status == PCCD_OK ? judge_range(playing, error) : status;
}

int play_run(struct playing *playing, play_fn show, void *context,
             struct ctl_error *error)
{
    playing->show = show;
    playing->context = context;
    return run(playing, error);
}

void play_close(struct playing *playing)
{
    if (playing == NULL) {
        return;
    }
    drive_deinit(&playing->drive);
    pccd_close(playing->drive.client);
    registry_deinit(&playing->world);
    answers_deinit(&playing->answers);
    record_reader_deinit(&playing->reader);
    record_reader_deinit(&playing->pages);
    step_trace_deinit(&playing->trace);
    free(playing->found.records);
    free(playing);
}

int play(const struct play_settings *settings, play_fn show, void *context,
         struct play_summary *summary, struct ctl_error *error)
{
    struct playing *playing = NULL;
    int status = play_open(settings, summary, &playing, error);
    if (status == PCCD_OK) {
        status = play_run(playing, show, context, error);
    }
    play_close(playing);
    return status;
}
