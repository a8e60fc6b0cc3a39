/* check_run.c - a mesh in a daemon, moved from frame to frame. */
#include "check_run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clock.h"
#include "printable.h"
#include "statistics.h"
#include "terminal.h"

#define ROUND_TRIP REPORT_PHASE_COUNT /* row of check_run.times behind the phases */

static double now_ms(void)
{
    return (double)common_now_ns() / 1e6;
}

int check_run_fail(const struct check_run *run, int status, const char *what,
                   struct ctl_error *error)
{
    const char *text = pccd_error_text(run->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

int check_run_times(struct check_run *run, struct ctl_error *error)
{
    size_t rows = REPORT_PHASE_COUNT + 1;
    run->times = malloc(rows * ((size_t)run->repeats + 1) * sizeof *run->times);
    return run->times != NULL
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_NOMEM,
                               "no memory for %" PRIu32 " repetitions", run->repeats);
}

int check_run_tell(struct check_run *run, const struct scene *files,
                   struct ctl_error *error)
{
    struct report_object *told = calloc(files->object_count, sizeof *told);
    if (told == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    for (uint32_t i = 0; i < files->object_count; i++) {
        const struct scene_object *object = &files->objects[i];
        told[i] =
            (struct report_object){.name = files->path != NULL ? object->name : NULL,
                                   .path = object->paths[0],
                                   .files = &object->files,
                                   .info = object->info,
                                   .welded = object->files.welded};
        run->told.object_what |= object->settings.what;
    }
    free(run->told.objects);
    run->told.objects = told;
    run->told.object_count = files->object_count;
    run->told.build_ms = files->build_ms;
    return PCCD_OK;
}

int check_run_begin(struct check_run *run, struct scene *files, bool with_edges,
                    struct ctl_error *error)
{
    int status = check_run_times(run, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = pccd_scene_create(run->client, NULL, &run->scene);
    if (status != PCCD_OK) {
        return check_run_fail(run, status, "no scene", error);
    }
    status = scene_place(files, run->client, run->scene, with_edges, error);
    return status == PCCD_OK ? check_run_tell(run, files, error) : status;
}

/* Walk over the pages of an answer; each is shown and given back. `answer` ends as it
 * began but for its pages. */
static int take_pages(struct check_run *run, const struct check_ask *ask, bool is_shown,
                      struct pccd_answer *answer, bool *is_complete,
                      struct ctl_error *error)
{
    struct pccd_answer page = *answer;
    int status = PCCD_OK;
    for (;;) {
        uint64_t cursor = page.cursor;
        bool is_last = cursor >= answer->total;
        if (is_shown) {
            ask->page(ask->context, &page);
        }
        pccd_answer_release(run->client, &page);
        if (is_last) {
            break;
        }
        status = pccd_fetch(run->client, run->scene, answer->step, cursor, &page);
        if (status != PCCD_OK) {
            return check_run_fail(run, status, "a page of the answer did not come",
                                  error);
        }
        if (page.first != cursor || page.count == 0) {
            pccd_answer_release(run->client, &page);
            return ctl_error_set(error, PCCD_E_BADMSG,
                                 "the page at record %" PRIu64 " does not go on", cursor);
        }
    }
    *is_complete =
        page.cursor >= answer->total && (page.incomplete == PCCD_COMPLETE ||
                                         page.incomplete == PCCD_INCOMPLETE_RESULT_FULL);
    answer->contacts = NULL;
    answer->pairs = NULL;
    answer->near = NULL;
    answer->vertex_bounds = NULL;
    return PCCD_OK;
}

static void take_medians(struct check_run *run, struct report_step *step)
{
    for (uint32_t row = 0; row <= ROUND_TRIP; row++) {
        double *values = run->times + (size_t)row * run->repeats;
        statistics_sort(values, run->repeats);
        double median = statistics_median(values, run->repeats);
        if (row == ROUND_TRIP) {
            step->round_trip_ms = median;
        } else {
            step->ms[row] = median;
        }
    }
}

int check_run_repeat(struct check_run *run, const struct check_ask *ask, uint32_t number,
                     struct report_step *step, struct ctl_error *error)
{
    struct pccd_answer *answer = &step->answer;
    uint64_t hash[2] = {0, 0};
    step->repeats = run->repeats;
    for (uint32_t i = 0; i <= run->repeats; i++) {
        double ms[REPORT_PHASE_COUNT];
        double start = i == 0 && run->begun == number ? run->begun_ms : now_ms();
        int status = ask->once(ask->context, i > 0, answer);
        double round_trip_ms = now_ms() - start;
        if (status != PCCD_OK) {
            return check_run_fail(run, status, ask->failed, error);
        }
        status = take_pages(run, ask, i == run->repeats && ask->page != NULL, answer,
                            &step->is_complete, error);
        if (status != PCCD_OK) {
            return status;
        }
        if (run->progress != NULL) {
            progress_update(run->progress,
                            (uint64_t)(number - 1) * (run->repeats + 1u) + i + 1);
        }
        report_phases(&answer->times, ms);
        if (i == 0) {
            memcpy(hash, answer->hash, sizeof hash);
            memcpy(step->ms, ms, sizeof ms);
            step->first_ms = ms[REPORT_step];
            step->round_trip_ms = round_trip_ms;
            continue;
        }
        if (memcmp(hash, answer->hash, sizeof hash) != 0 && step->is_complete) {
            return ctl_error_set(error, PCCD_E_INTERNAL,
                                 "repetition %" PRIu32 " of step %" PRIu32
                                 " gave another answer than the first run",
                                 i, number);
        }
        for (uint32_t row = 0; row < REPORT_PHASE_COUNT; row++) {
            run->times[(size_t)row * run->repeats + i - 1] = ms[row];
        }
        run->times[(size_t)ROUND_TRIP * run->repeats + i - 1] = round_trip_ms;
    }
    if (run->repeats > 0) {
        take_medians(run, step);
    }
    return PCCD_OK;
}

/* A step that is asked for again and again, and where its records go. */
struct motion {
    struct check_run *run;
    const struct scene *files;
    struct pccd_motion *motions;
    const struct contacts_csv *csv;
    uint32_t number;
    bool *is_counted;           /* false: there was no memory for it */
    struct pccd_contact *first; /* the earliest one so far; its toi is above 1 at first */
};

/* Submit the step to a frame, from where the objects stand, or from the frame before. */
static int submit(const struct motion *motion, uint32_t number, bool is_from_before,
                  uint64_t *step)
{
    const struct check_run *run = motion->run;
    uint32_t count =
        scene_motions(motion->files, number, is_from_before, motion->motions);
    return pccd_submit(run->client, run->scene, motion->motions, count, &run->settings,
                       step);
}

/* Begin the next step while this one is computed, so that the daemon has it when this one
 * is done. If it cannot be begun, it is tried again in its turn. */
static void begin_next(const struct motion *motion)
{
    struct check_run *run = motion->run;
    if (run->goes_on != NULL && run->goes_on(run->owner) && run->repeats == 0 &&
        run->settings.deadline_ns == 0 &&
        submit(motion, motion->number + 1, false, &run->begun_step) == PCCD_OK) {
        run->begun = motion->number + 1;
    }
}

/* Take back the step that was begun: its answer is dropped, and the objects stand where
 * this one ends, whose answer is `answer`. */
static int take_back(const struct motion *motion, struct pccd_answer *answer)
{
    struct check_run *run = motion->run;
    struct pccd_answer next = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    run->begun = 0;
    pccd_answer_release(run->client, answer);
    int status = pccd_wait(run->client, run->begun_step, -1, &next);
    pccd_answer_release(run->client, &next);
    status = status == PCCD_OK ? submit(motion, motion->number, true, &step) : status;
    return status == PCCD_OK ? pccd_wait(run->client, step, -1, answer) : status;
}

/* Move to the frame; the first time from where the objects stand, unless they stand
 * elsewhere. */
static int move_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct motion *motion = context;
    struct check_run *run = motion->run;
    uint64_t step = run->begun_step;
    int status = PCCD_OK;
    if (is_again || run->begun != motion->number) {
        status = submit(motion, motion->number, is_again, &step);
    }
    run->begun = 0;
    if (status == PCCD_OK && !is_again) {
        if (run->meanwhile != NULL) {
            run->meanwhile(run->owner);
        }
        begin_next(motion);
    }
    status = status == PCCD_OK ? pccd_wait(run->client, step, -1, answer) : status;
    if (status == PCCD_OK && run->begun > 0 && !run->may_stay(run->owner, answer)) {
        status = take_back(motion, answer);
    }
    run->begun_ms = now_ms();
    return status;
}

void check_run_find_first(const struct pccd_answer *page, struct pccd_contact *first)
{
    for (uint64_t i = 0; page->contacts != NULL && i < page->count; i++) {
        if (page->contacts[i].toi < first->toi) {
            *first = page->contacts[i];
        }
    }
}

void check_run_set_first(const struct objects *objects,
                         const struct pccd_contact *contact,
                         const struct place_feature ends[2], struct report_first *first)
{
    const uint32_t handles[2] = {contact->object_a, contact->object_b};
    const uint32_t features[2] = {contact->feature_a, contact->feature_b};
    double at[2][3];
    *first = (struct report_first){.is_known = true,
                                   .kind = contact->kind,
                                   .toi = contact->toi,
                                   .toi_hi = contact->toi_hi};
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t points = common_kinds[contact->kind].points[side];
        first->part[side] = objects != NULL
                                ? objects_part(objects_find(objects, handles[side]),
                                               points, features[side])
                                : REPORT_NO_PART;
        first->feature[side] = points == 2 ? ends[side].corners[0] : features[side];
        first->other[side] = points == 2 ? ends[side].corners[1] : 0;
    }
    place_find(contact->kind, contact->param, ends, place_time(contact), at);
    first->x = at[1][0];
    first->y = at[1][1];
    first->z = at[1][2];
}

int check_run_place(struct check_run *run, const struct scene *files, uint32_t number,
                    const struct pccd_contact *contact, struct report_first *first,
                    struct ctl_error *error)
{
    const uint32_t handles[2] = {contact->object_a, contact->object_b};
    const uint32_t features[2] = {contact->feature_a, contact->feature_b};
    struct place_feature ends[2];
    *first = (struct report_first){
        .kind = contact->kind, .toi = contact->toi, .toi_hi = contact->toi_hi};
    if (contact->kind >= COMMON_KIND_COUNT) {
        return PCCD_OK; /* of a newer daemon */
    }
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t points = common_kinds[contact->kind].points[side];
        uint32_t place = scene_place_of(files, handles[side]);
        int status = place == files->object_count
                         ? PCCD_E_FORMAT
                         : scene_feature(&files->objects[place], run->client, number,
                                         points, features[side], &ends[side]);
        if (status != PCCD_OK) {
            return check_run_fail(run, status, "no place", error);
        }
    }
    check_run_set_first(run->objects, contact, ends, first);
    return PCCD_OK;
}

static void show_page(void *context, const struct pccd_answer *page)
{
    const struct motion *motion = context;
    struct objects *objects = motion->run->objects;
    if (motion->csv->whole.to != NULL) {
        contacts_csv_page(motion->csv, motion->number, page);
    }
    check_run_find_first(page, motion->first);
    if (motion->run->note != NULL) {
        motion->run->note(motion->run->owner, page);
    }
    *motion->is_counted =
        *motion->is_counted && (objects == NULL || objects_count(objects, page));
}

int check_run_step(struct check_run *run, const struct scene *files, uint32_t number,
                   const struct contacts_csv *csv, struct report_step *step,
                   struct ctl_error *error)
{
    bool is_counted = true;
    struct pccd_contact first = {.toi = INFINITY};
    struct motion motion = {.run = run,
                            .files = files,
                            .motions =
                                calloc(files->object_count, sizeof *motion.motions),
                            .csv = csv,
                            .number = number,
                            .is_counted = &is_counted,
                            .first = &first};
    const struct check_ask ask = {.once = move_once,
                                  .page = show_page,
                                  .failed = "the step failed",
                                  .context = &motion};
    int status = motion.motions != NULL
                     ? check_run_repeat(run, &ask, number, step, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    free(motion.motions);
    if (status == PCCD_OK && first.toi <= 1) {
        status = check_run_place(run, files, number, &first, &step->first, error);
    }
    if (status != PCCD_OK || run->objects == NULL) {
        return status;
    }
    return is_counted ? objects_take(run->objects, step, error)
                      : ctl_error_set(error, PCCD_E_NOMEM, "no memory for objects");
}

int check_run_again(struct check_run *run, const struct scene *files, uint32_t number,
                    struct ctl_error *error)
{
    struct pccd_motion *motions = calloc(files->object_count, sizeof *motions);
    const struct motion motion = {
        .run = run, .files = files, .motions = motions, .number = number};
    const struct check_ask ask = {.page = NULL};
    struct pccd_answer answer = {.step = 0};
    bool is_complete = false;
    if (motions == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    int status = move_once((void *)&motion, true, &answer);
    status = status == PCCD_OK
                 ? take_pages(run, &ask, false, &answer, &is_complete, error)
                 : check_run_fail(run, status, "the step failed", error);
    free(motions);
    return status;
}

void check_run_deinit(struct check_run *run)
{
    free(run->told.objects);
    free(run->times);
    run->told.objects = NULL;
    run->times = NULL;
}
