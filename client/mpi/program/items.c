/* items.c - dealt items and their results. */
#include "items.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "pccd.h"
#include "together.h"

const struct option_table items_table = {
    .rows = (const struct option_row[]){
        CTL_OUTPUT,
        {"results", 0, "FILE",
         "Write what comes of each step as a line of JSON to FILE when it is done, and "
         "go on with what is there already",
         OPTION_TEXT, .at = 0},
        {0}}};

/* ---- results ----------------------------------------------------------------------- */

static bool is_wanted(const struct items *items, uint64_t item)
{
    const struct items_work *work = items->work;
    return work->is_wanted == NULL || work->is_wanted(work->context, item);
}

static bool is_done(void *context, uint64_t item)
{
    const struct items *items = context;
    return items->is_there[item] || item > items->stop || !is_wanted(items, item);
}

static void keep(struct items *items, uint64_t item, const void *result)
{
    const struct items_work *work = items->work;
    memcpy(items->all + item * work->result_bytes, result, work->result_bytes);
    items->is_there[item] = true;
    if (work->is_last != NULL && work->is_last(work->context, result) &&
        item < items->stop) {
        items->stop = item;
    }
}

static int take(void *context, uint64_t item, const void *result, bool *is_last,
                struct ctl_error *error)
{
    struct items *items = context;
    if (items->results.fd >= 0) {
        json_t *line = items->work->line(result);
        int status = PCCD_E_NOMEM;
        if (line != NULL &&
            json_object_set_new(line, "item", json_integer((json_int_t)item)) == 0) {
            status = results_append(&items->results, line, error);
        } else {
            (void)ctl_error_set(error, status, "no memory for a result");
        }
        json_decref(line);
        if (status != PCCD_OK) {
            return status;
        }
    }
    keep(items, item, result);
    items->written++;
    items->last = item;
    *is_last = item == items->stop;
    return PCCD_OK;
}

/* A line that an earlier run has written. */
static int take_line(void *context, const json_t *line, struct ctl_error *error)
{
    struct items *items = context;
    unsigned char result[DEAL_RESULT_BYTES] = {0};
    const json_t *number = json_object_get(line, "item");
    uint64_t item = (uint64_t)json_integer_value(number);
    if (!json_is_integer(number) || item >= items->work->count ||
        !items->work->read(line, result)) {
        return ctl_error_set(error, PCCD_E_FORMAT, "it is no result of this command");
    }
    items->found += !items->is_there[item];
    keep(items, item, result);
    return PCCD_OK;
}

static uint64_t count_wanted(const struct items *items)
{
    uint64_t wanted = 0;
    for (uint64_t i = 0; i < items->work->count; i++) {
        wanted += is_wanted(items, i);
    }
    return wanted;
}

/* "step 7 of a.rec was the last one, 12 of 40 are written", to text[bytes]. */
static void tell_progress(const struct items *items, char *text, size_t bytes)
{
    char last[400] = "";
    if (items->written == 0) {
        (void)snprintf(text, bytes, "no step was done");
        return;
    }
    items->work->describe(items->work->context, items->last, last, sizeof last);
    (void)snprintf(text, bytes, "%s was the last one, %" PRIu64 " of %" PRIu64 " are %s",
                   last, items->found + items->written, count_wanted(items),
                   items->results.fd >= 0 ? "written" : "done");
}

static void interrupted(void *context)
{
    char text[512];
    tell_progress(context, text, sizeof text);
    (void)ctl_complain("ended by a signal; %s", text);
}

/* ---- all of it --------------------------------------------------------------------- */

/* Return the head of a file of results: of which command, version and things they are. */
static json_t *head_of(const struct items *items)
{
    char version[32];
    (void)snprintf(version, sizeof version, "%d.%d.%d", PCCD_VERSION_MAJOR,
                   PCCD_VERSION_MINOR, PCCD_VERSION_PATCH);
    json_t *depends = items->work->depends(items->work->context);
    return depends == NULL ? NULL
                           : json_pack("{s:s, s:s, s:o}", "pccd-mpi", items->work->name,
                                       "version", version, "of", depends);
}

static int begin(struct items *items, const char *path, struct ctl_error *error)
{
    items->all = calloc(items->work->count + 1, items->work->result_bytes);
    items->is_there = calloc(items->work->count + 1, sizeof *items->is_there);
    json_t *head = path != NULL ? head_of(items) : NULL;
    int status =
        items->all == NULL || items->is_there == NULL || (path != NULL && head == NULL)
            ? ctl_error_set(error, PCCD_E_NOMEM, "no memory for the results")
            : PCCD_OK;
    if (status == PCCD_OK && path != NULL) {
        status = results_open(&items->results, path, head, take_line, items, error);
    }
    json_decref(head);
    if (status == PCCD_OK && items->found > 0) {
        (void)ctl_complain("%s: %" PRIu64 " of %" PRIu64 " steps are there; going on",
                           path, items->found, count_wanted(items));
    }
    return status;
}

int items_run(struct items *items, const struct items_work *work, const char *path,
              struct ctl_error *error)
{
    const struct deal_work dealing = {.count = work->count,
                                      .result_bytes = work->result_bytes,
                                      .context = items,
                                      .is_done = is_done,
                                      .take = take,
                                      .compute_context = work->context,
                                      .compute = work->compute,
                                      .interrupted = interrupted};
    *items = (struct items){.work = work, .results = {.fd = -1}, .stop = UINT64_MAX};
    int status =
        together_agree(together_is_root() ? begin(items, path, error) : PCCD_OK, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = deal(&dealing, error);
    if (status != PCCD_OK && together_is_root()) {
        struct ctl_error why = *error;
        char text[512];
        tell_progress(items, text, sizeof text);
        (void)ctl_error_set(error, status, "%.500s; %s", why.text, text);
    }
    return status;
}

const void *items_result(const struct items *items, uint64_t item)
{
    return items->is_there[item] && is_wanted(items, item)
               ? items->all + item * items->work->result_bytes
               : NULL;
}

void items_deinit(struct items *items)
{
    if (items->work != NULL) {
        results_close(&items->results);
    }
    free(items->all);
    free(items->is_there);
}
