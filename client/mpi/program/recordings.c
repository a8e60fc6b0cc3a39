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
    .parts = (const struct option_part[]){
        {&play_files_table, offsetof(struct recordings_options, play)},
        {&items_table, offsetof(struct recordings_options, results)},
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
    deal_put(all->deal, all->held, result);
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
        all->held = deal_next(all->deal);
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

static bool is_wanted(void *context, uint64_t item)
{
    const struct recordings *all = context;
    return play_is_within(&all->options->play.play, asked_of(all, item)->step);
}

static bool is_last(void *context, const void *result)
{
    const struct recordings *all = context;
    return all->work->is_last(all->work->context, result);
}

static void describe(void *context, uint64_t item, char *text, size_t bytes)
{
    const struct recordings *all = context;
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
static json_t *depends(void *context)
{
    const struct recordings *all = context;
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
    *recordings = (struct recordings){.options = options, .work = work, .threads = 1};
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
    recordings->dealt_work = (struct items_work){.name = work->name,
                                                 .count = recordings->count,
                                                 .result_bytes = work->result_bytes,
                                                 .context = recordings,
                                                 .compute = compute,
                                                 .is_wanted = is_wanted,
                                                 .is_last = is_last,
                                                 .line = work->line,
                                                 .read = work->read,
                                                 .depends = depends,
                                                 .describe = describe};
    status =
        items_run(&recordings->items, &recordings->dealt_work, options->results, error);
    add_seconds(recordings);
    return status;
}

const void *recordings_result(const struct recordings *recordings,
                              const struct recording *file, uint64_t place)
{
    return items_result(&recordings->items, file->first + place);
}

static void close_all(struct recordings *recordings)
{
    for (uint32_t i = 0; i < recordings->file_count; i++) {
        play_close(recordings->files[i].reader);
    }
    items_deinit(&recordings->items);
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
        if (file->first > all->items.stop) {
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
    struct recordings all = {.file_count = 0};
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
