/* recordings.c - steps of recordings, dealt. */
#include "recordings.h"

#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "answers.h"
#include "ctl.h"
#include "names.h"
#include "pccd_mpi.h"
#include "shown.h"
#include "together.h"

/* ---- options ----------------------------------------------------------------------- */

const struct option_table recordings_table = {
    .rows =
        (const struct option_row[]){
            CTL_OUTPUT,
            {"results", 0, "FILE",
             "Write what comes of each step as a line of JSON to FILE when it is done, "
             "and go on with what is there already",
             OPTION_TEXT, .at = offsetof(struct recordings_options, results)},
            {0}},
    .parts = (const struct option_part[]){
        {&play_files_table, offsetof(struct recordings_options, play)},
        {&ctl_common_table, 0},
        {0}}};

void recordings_options_init(struct recordings_options *options)
{
    *options = (struct recordings_options){.results = NULL};
    play_options_init(&options->play, NULL);
    options->play.takes_files = true;
    options->play.link.url = strdup("direct:"); /* NULL: out of memory, told later */
}

/* ---- computing --------------------------------------------------------------------- */

static void put(struct recordings *all, const void *result)
{
    deal_put(all->deal, all->number, result);
    all->held = DEAL_NONE;
    all->is_begun = false;
}

/* Return the place of the item to do next of the file that is being played; 0: it is of a
 * later file, or there is none. An item that was begun and never shown was skipped. */
static uint64_t next_place(void *context)
{
    struct recordings *all = context;
    const struct recording *now = all->now;
    if (all->is_begun) {
        unsigned char result[DEAL_RESULT_BYTES] = {0};
        all->work->skip(all->work->context,
                        &play_answers(now->reader)->asked[all->held - now->first],
                        result);
        put(all, result);
    }
    if (all->held == DEAL_NONE) {
        all->number = deal_next(all->deal);
        all->held = all->number != DEAL_NONE ? all->todo[all->number] : DEAL_NONE;
    }
    if (all->held == DEAL_NONE || all->held - now->first >= now->count) {
        return 0;
    }
    all->is_begun = true;
    return all->held - now->first + 1;
}

static int show_step(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct recordings *all = context;
    unsigned char result[DEAL_RESULT_BYTES] = {0};
    int status = all->work->step(all->work->context, step, result, error);
    if (status == PCCD_OK) {
        put(all, result);
    }
    return status;
}

static int compute(void *context, struct deal *deal, struct ctl_error *error)
{
    struct recordings *all = context;
    int status = PCCD_OK;
    all->deal = deal;
    all->held = DEAL_NONE;
    for (uint32_t i = 0; i < all->file_count && status == PCCD_OK; i++) {
        all->now = &all->files[i];
        status = play_run(all->now->reader, show_step, all, error);
        if (status == PCCD_OK && all->is_begun) {
            status = ctl_error_set(error, PCCD_E_FORMAT, "%s: it has become shorter",
                                   all->now->path);
        }
    }
    return status;
}

/* ---- items ------------------------------------------------------------------------- */

static const struct recording *file_of(const struct recordings *all, uint64_t item)
{
    uint32_t i = 0;
    while (i + 1 < all->file_count && item >= all->files[i + 1].first) {
        i++;
    }
    return &all->files[i];
}

static const struct answers_asked *asked_of(const struct recordings *all, uint64_t item)
{
    const struct recording *file = file_of(all, item);
    return &play_answers(file->reader)->asked[item - file->first];
}

/* "step 7 of a.rec" */
static void describe(const struct recordings *all, uint64_t item, char *text,
                     size_t bytes)
{
    (void)snprintf(text, bytes, "step %" PRIu64 " of %.300s", asked_of(all, item)->step,
                   file_of(all, item)->path);
}

/* ---- opening ----------------------------------------------------------------------- */

static int open_files(struct recordings *all, struct ctl_error *error)
{
    const struct play_options *options = &all->options->play;
    struct play_settings settings = options->play;
    all->files = calloc(options->files.count, sizeof *all->files);
    if (all->files == NULL || options->link.url == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    settings.link = &options->link;
    settings.next = next_place;
    settings.shows_near = true;
    settings.threads = settings.threads > 0 ? settings.threads : all->threads;
    for (uint32_t i = 0; i < options->files.count; i++) {
        struct recording *file = &all->files[i];
        settings.path = file->path = options->files.list[i];
        all->file_count++;
        int status = play_open(&settings, &file->summary, &file->reader, error);
        if (status != PCCD_OK) {
            return status;
        }
        file->first = all->count;
        file->count = play_answers(file->reader)->asked_count;
        all->count += file->count;
    }
    return PCCD_OK;
}

/* Every rank has read the same. */
static int compare_files(const struct recordings *all, struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < all->file_count && status == PCCD_OK; i++) {
        const struct recording *file = &all->files[i];
        const uint64_t mine[2] = {play_answers(file->reader)->sum, file->count};
        status = together_compare(mine, sizeof mine, file->path,
                                  ": it is another recording", error);
    }
    return status;
}

/* A range that a file has nothing of is a mistake, not a success. */
static int judge_range(const struct recordings *all, struct ctl_error *error)
{
    const struct play_settings *settings = &all->options->play.play;
    bool is_range = settings->first > 1 || settings->last != 0;
    for (uint64_t i = 0; i < all->count && is_range; i++) {
        is_range = !play_is_within(settings, asked_of(all, i)->step);
    }
    return is_range ? ctl_error_set(error, PCCD_E_INVAL,
                                    "%s: it holds no such step; the last one is %" PRIu64,
                                    all->files[all->file_count - 1].path,
                                    all->files[all->file_count - 1].summary.last_step)
                    : PCCD_OK;
}

/* Recordings and options that results depend on. */
static json_t *depends(const struct recordings *all)
{
    const struct play_settings *play = &all->options->play.play;
    char sum[24];
    json_t *files = json_array();
    bool ok = files != NULL;
    for (uint32_t i = 0; i < all->file_count && ok; i++) {
        const struct recording *file = &all->files[i];
        (void)snprintf(sum, sizeof sum, "%016" PRIx64, play_answers(file->reader)->sum);
        ok = json_array_append_new(files,
                                   json_pack("{s:I, s:s}", "items",
                                             (json_int_t)file->count, "sum", sum)) == 0;
    }
    json_t *settings = ok ? all->work->settings(all->work->context) : NULL;
    if (settings == NULL) {
        json_decref(files);
        return NULL;
    }
    return json_pack("{s:s, s:o, s:o}", "method", common_method_name(play->method),
                     "settings", settings, "recordings", files);
}

/* ---- results ----------------------------------------------------------------------- */

static bool is_wanted(const struct recordings *all, uint64_t item)
{
    return play_is_within(&all->options->play.play, asked_of(all, item)->step);
}

static void keep(struct recordings *all, uint64_t item, const void *result)
{
    const struct recordings_work *work = all->work;
    memcpy(all->made + item * work->result_bytes, result, work->result_bytes);
    all->is_there[item] = true;
    if (work->is_last(work->context, result) && item < all->stop) {
        all->stop = item;
    }
}

static int take(void *context, uint64_t number, const void *result, bool *is_last,
                struct ctl_error *error)
{
    struct recordings *all = context;
    const uint64_t item = all->todo[number];
    if (all->results.fd >= 0) {
        json_t *line = all->work->line(result);
        int status = PCCD_E_NOMEM;
        if (line != NULL &&
            json_object_set_new(line, "item", json_integer((json_int_t)item)) == 0) {
            status = results_append(&all->results, line, error);
        } else {
            (void)ctl_error_set(error, status, "no memory for a result");
        }
        json_decref(line);
        if (status != PCCD_OK) {
            return status;
        }
    }
    keep(all, item, result);
    all->written++;
    all->last = item;
    *is_last = item == all->stop;
    return PCCD_OK;
}

/* A line that an earlier run has written. */
static int take_line(void *context, const json_t *line, struct ctl_error *error)
{
    struct recordings *all = context;
    unsigned char result[DEAL_RESULT_BYTES] = {0};
    const json_t *number = json_object_get(line, "item");
    uint64_t item = (uint64_t)json_integer_value(number);
    if (!json_is_integer(number) || item >= all->count ||
        !all->work->read(line, result)) {
        return ctl_error_set(error, PCCD_E_FORMAT, "it is no result of this command");
    }
    all->found += !all->is_there[item];
    keep(all, item, result);
    return PCCD_OK;
}

static uint64_t count_wanted(const struct recordings *all)
{
    uint64_t wanted = 0;
    for (uint64_t i = 0; i < all->count; i++) {
        wanted += is_wanted(all, i);
    }
    return wanted;
}

/* "step 7 of a.rec was the last one, 12 of 40 are written", to text[bytes]. */
static void tell_progress(const struct recordings *all, char *text, size_t bytes)
{
    char last[400] = "";
    if (all->written == 0) {
        (void)snprintf(text, bytes, "no step was done");
        return;
    }
    describe(all, all->last, last, sizeof last);
    (void)snprintf(text, bytes, "%s was the last one, %" PRIu64 " of %" PRIu64 " are %s",
                   last, all->found + all->written, count_wanted(all),
                   all->results.fd >= 0 ? "written" : "done");
}

static void interrupted(void *context)
{
    char text[512];
    tell_progress(context, text, sizeof text);
    (void)ctl_complain("ended by a signal; %s", text);
}

/* Return the head of a file of results: of which command, version and things they are. */
static json_t *head_of(const struct recordings *all)
{
    char version[32];
    (void)snprintf(version, sizeof version, "%d.%d.%d", PCCD_VERSION_MAJOR,
                   PCCD_VERSION_MINOR, PCCD_VERSION_PATCH);
    json_t *of = depends(all);
    return of == NULL ? NULL
                      : json_pack("{s:s, s:s, s:o}", "pccd-mpi", all->work->name,
                                  "version", version, "of", of);
}

static int begin(struct recordings *all, const char *path, struct ctl_error *error)
{
    all->made = calloc(all->count + 1, all->work->result_bytes);
    json_t *head = path != NULL ? head_of(all) : NULL;
    int status = all->made == NULL || (path != NULL && head == NULL)
                     ? ctl_error_set(error, PCCD_E_NOMEM, "no memory for the results")
                     : PCCD_OK;
    if (status == PCCD_OK && path != NULL) {
        status = results_open(&all->results, path, head, take_line, all, error);
    }
    json_decref(head);
    if (status == PCCD_OK && all->found > 0) {
        (void)ctl_complain("%s: %" PRIu64 " of %" PRIu64 " steps are there; going on",
                           path, all->found, count_wanted(all));
    }
    return status;
}

static int deal_all(struct recordings *all, struct ctl_error *error)
{
    all->is_there = calloc(all->count + 1, sizeof *all->is_there);
    all->todo = malloc((all->count + 1) * sizeof *all->todo);
    int status = all->is_there == NULL || all->todo == NULL
                     ? ctl_error_set(error, PCCD_E_NOMEM, "no memory for the results")
                     : PCCD_OK;
    if (status == PCCD_OK && together_is_root()) {
        status = begin(all, all->options->results, error);
    }
    status = together_agree(status, error);
    if (status != PCCD_OK) {
        return status;
    }
    together_tell(all->is_there, all->count * sizeof *all->is_there);
    together_tell(&all->stop, sizeof all->stop);
    for (uint64_t i = 0; i < all->count && i <= all->stop; i++) {
        if (!all->is_there[i] && is_wanted(all, i)) {
            all->todo[all->todo_count++] = i;
        }
    }
    const struct deal_work dealing = {.count = all->todo_count,
                                      .result_bytes = all->work->result_bytes,
                                      .context = all,
                                      .take = take,
                                      .compute = compute,
                                      .interrupted = interrupted};
    status = deal(&dealing, error);
    if (status != PCCD_OK && together_is_root()) {
        struct ctl_error why = *error;
        char text[512];
        tell_progress(all, text, sizeof text);
        (void)ctl_error_set(error, status, "%.500s; %s", why.text, text);
    }
    return status;
}

/* ---- all of it --------------------------------------------------------------------- */

/* Add up on the root what each rank has spent on answers. */
static void add_seconds(struct recordings *all)
{
    for (uint32_t i = 0; i < all->file_count; i++) {
        double mine = all->files[i].summary.seconds, sum = 0;
        MPI_Reduce(&mine, &sum, 1, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
        all->files[i].summary.seconds = sum;
    }
}

static int run(struct recordings *recordings, const struct recordings_options *options,
               const struct recordings_work *work, struct ctl_error *error)
{
    *recordings = (struct recordings){.options = options,
                                      .work = work,
                                      .results = {.fd = -1},
                                      .stop = UINT64_MAX,
                                      .threads = 1};
    int status = pccd_mpi_threads(MPI_COMM_WORLD, &recordings->threads);
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "MPI has failed");
    }
    status = together_agree(open_files(recordings, error), error);
    if (status == PCCD_OK) {
        status = compare_files(recordings, error);
    }
    if (status == PCCD_OK) {
        status = together_agree(judge_range(recordings, error), error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    status = deal_all(recordings, error);
    add_seconds(recordings);
    return status;
}

const void *recordings_result(const struct recordings *recordings,
                              const struct recording *file, uint64_t place)
{
    const uint64_t item = file->first + place;
    return recordings->is_there[item] && is_wanted(recordings, item)
               ? recordings->made + item * recordings->work->result_bytes
               : NULL;
}

static void close_all(struct recordings *recordings)
{
    for (uint32_t i = 0; i < recordings->file_count; i++) {
        play_close(recordings->files[i].reader);
    }
    results_close(&recordings->results);
    free(recordings->made);
    free(recordings->is_there);
    free(recordings->todo);
    free(recordings->files);
}

/* ---- the command ------------------------------------------------------------------- */

void recordings_separate(const struct recordings *recordings,
                         const struct recording *file)
{
    if (recordings->options->play.is_json && file != recordings->files) {
        fputs(", ", stdout);
    }
}

/* Print the report; of several recordings each has its name before it; as JSON they are
 * an array. */
static int report(const struct recordings *all, bool *is_right, struct ctl_error *error)
{
    const struct play_options *options = &all->options->play;
    bool is_array = options->is_json && all->file_count > 1;
    int status = PCCD_OK;
    fputs(is_array ? "[" : "", stdout);
    for (uint32_t i = 0; i < all->file_count && status == PCCD_OK; i++) {
        const struct recording *file = &all->files[i];
        struct play_settings settings = options->play;
        bool is_file_right = true;
        if (file->first > all->stop) {
            break;
        }
        if (all->file_count > 1 && !options->is_json) {
            printf("%s\n", tool_shown(file->path));
        }
        settings.path = file->path;
        if (play_damage(file->reader, &(struct ctl_error){.text = ""}) == PCCD_OK) {
            play_options_warn(&settings, &file->summary);
        }
        status = all->work->report(all->work->context, all, file, &is_file_right, error);
        *is_right = *is_right && is_file_right;
    }
    fputs(is_array ? "]\n" : "", stdout);
    return status;
}

int recordings_command(struct recordings_options *options,
                       const struct option_table *table, int argc, char **argv,
                       void *input, const struct recordings_work *work)
{
    struct recordings all = {.results = {.fd = -1}};
    struct ctl_error error = {.text = ""};
    bool is_right = true;
    int status = together_parse(table, argc, argv, input);
    if (status == CTL_DONE) {
        int result = run(&all, options, work, &error);
        if (result == PCCD_OK && together_is_root()) {
            result = report(&all, &is_right, &error);
        }
        together_complain(&error);
        status = (int)ctl_exit_of(result, is_right);
        together_tell(&status, sizeof status);
    }
    close_all(&all);
    play_options_deinit(&options->play);
    return status;
}
