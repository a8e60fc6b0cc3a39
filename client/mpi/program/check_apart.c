/* check_apart.c - the steps of a sequence, dealt. */
#include "check_apart.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "check_run.h"
#include "ctl.h"
#include "items.h"
#include "pccd_mpi.h"
#include "report.h"
#include "together.h"

struct apart {
    const struct check_options *options;
    struct check_run run;
    struct part *part;  /* all of each frame */
    struct scene scene; /* of one object, with its frames at the ends of a step */
    struct scene_object object;
    uint64_t end;               /* frame at the end of the last step; 0: there is none */
    struct judge_ends *ends; /* the caller's; NULL: the ends of steps are not looked at */
    uint64_t crossed;        /* frame that ends->end is of; DEAL_NONE: of none */
    uint64_t bytes, changed_ns; /* of all files, on the root */
};

/* ---- steps ------------------------------------------------------------------------- */

/* Read a frame; in doubles, because the next one may be, and floats are doubles. */
static int read_frame(struct apart *apart, uint64_t index, struct ctl_mesh *frame,
                      struct ctl_error *error)
{
    int status = part_read(apart->part, (uint32_t)index, frame, error);
    if (status == PCCD_OK && frame->format == PCCD_FORMAT_F32) {
        status = ctl_mesh_promote(frame, error);
    }
    return status;
}

/* Both ends of a step; the beginning is mostly the end of the one before. */
static int read_ends(struct apart *apart, uint64_t item, struct ctl_error *error)
{
    struct ctl_mesh *at = apart->object.at;
    int status = apart->end != 0 && apart->end == item
                     ? PCCD_OK
                     : read_frame(apart, item, &at[item % SCENE_FRAMES], error);
    apart->end = 0;
    if (status == PCCD_OK) {
        status = read_frame(apart, item + 1, &at[(item + 1) % SCENE_FRAMES], error);
    }
    apart->end = status == PCCD_OK ? item + 1 : 0;
    return status;
}

/* Ask what crosses where the step has ended. */
static int ask_crossings(void *context, struct crossings *to, struct ctl_error *error)
{
    const struct apart *apart = context;
    return crossings_ask(to, &apart->run, NULL, 0, error);
}

static void note_page(void *context, const struct pccd_answer *page)
{
    const struct apart *apart = context;
    if (apart->ends != NULL && apart->run.settings.mode == PCCD_MODE_ALL) {
        follow_note(&apart->ends->follow, page);
    }
}

/* Find what crosses in the first frame, where the objects are. */
static int look_at_first(struct apart *apart, struct ctl_error *error)
{
    struct judge_ends *ends = apart->ends;
    int status = follow_begin(&ends->follow, &apart->scene, error);
    if (status == PCCD_OK) {
        status = ask_crossings(apart, &ends->first, error);
    }
    ends->ask = ask_crossings;
    ends->context = apart;
    return status == PCCD_OK ? crossings_copy(&ends->end, &ends->first, error) : status;
}

/* Find what crosses where a step begins, unless that is known. */
static int look_at_begin(struct apart *apart, uint64_t item, struct ctl_error *error)
{
    struct pccd_motion motion;
    if (apart->ends == NULL) {
        return PCCD_OK;
    }
    apart->ends->follow.count = 0;
    apart->ends->follow.is_whole = true;
    return apart->crossed == item
               ? PCCD_OK
               : crossings_ask(
                     &apart->ends->end, &apart->run, &motion,
                     scene_motions(&apart->scene, (uint32_t)item, false, &motion), error);
}

static int compute(void *context, struct deal *deal, struct ctl_error *error)
{
    struct apart *apart = context;
    const struct contacts_csv no_csv = {.path = NULL};
    for (uint64_t item; (item = deal_next(deal)) != DEAL_NONE;) {
        struct report_step step;
        memset(&step, 0, sizeof step); /* all of it goes to the root */
        int status = read_ends(apart, item, error);
        status = status == PCCD_OK ? look_at_begin(apart, item, error) : status;
        apart->crossed = DEAL_NONE;
        if (status == PCCD_OK) {
            status = check_run_step(&apart->run, &apart->scene, (uint32_t)item + 1,
                                    &no_csv, &step, error);
        }
        if (status == PCCD_OK && apart->ends != NULL) {
            status = judge_ends_look(apart->ends, &apart->run, (uint32_t)item + 1, &step,
                                     error);
            apart->crossed = item + 1;
        }
        if (status != PCCD_OK) {
            return status;
        }
        deal_put(deal, item, &step);
    }
    return PCCD_OK;
}

/* ---- results ----------------------------------------------------------------------- */

static json_t *line(const void *result)
{
    return report_line(result);
}

static bool read_line(const json_t *object, void *result)
{
    return report_line_read(object, result);
}

static void describe(void *context, uint64_t item, char *text, size_t bytes)
{
    const struct apart *apart = context;
    (void)snprintf(text, bytes, "step %" PRIu64 ", to %.300s,", item + 1,
                   apart->part->files.names[item + 1]);
}

/* Files by size and time of change: to read all of them takes as long as the steps. */
static int look_at_files(struct apart *apart, struct ctl_error *error)
{
    const struct ctl_sequence *files = &apart->part->files.sequence;
    for (uint32_t i = 0; i < files->count; i++) {
        struct stat info;
        if (stat(files->paths[i], &info) != 0) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "%s: %s", files->paths[i],
                                 strerror(errno));
        }
        uint64_t changed =
            (uint64_t)info.st_mtim.tv_sec * 1000000000u + (uint64_t)info.st_mtim.tv_nsec;
        apart->bytes = apart->bytes * 31 + (uint64_t)info.st_size;
        apart->changed_ns = apart->changed_ns * 31 + changed;
    }
    return PCCD_OK;
}

static json_t *depends(void *context)
{
    const struct apart *apart = context;
    const struct pccd_step_settings *step = &apart->run.settings;
    const struct pccd_object_settings *object = &apart->options->ask.object;
    const struct ctl_frames_options *frames = &apart->options->ask.frames;
    char sum[40], numbers[300];
    (void)snprintf(sum, sizeof sum, "%016" PRIx64 "%016" PRIx64, apart->bytes,
                   apart->changed_ns);
    (void)snprintf(numbers, sizeof numbers, "%d %d %d %a %a %a %a %a %d %a %a",
                   step->mode, (int)step->method, (int)step->touching, step->tolerance,
                   step->separation, step->approach, object->radius,
                   object->rest_distance, (int)object->rest_rings, frames->weld,
                   frames->wish.rate);
    return json_pack("{s:I, s:s, s:s*, s:s, s:I, s:I, s:s}", "steps",
                     (json_int_t)apart->part->files.count - 1, "files", sum, "animation",
                     frames->wish.animation, "settings", numbers, "deadline",
                     (json_int_t)step->deadline_ns, "repeat",
                     (json_int_t)apart->run.repeats, "tuning",
                     step->tuning != NULL ? step->tuning : "");
}

/* ---- all of it --------------------------------------------------------------------- */

static int open_all(struct apart *apart, struct ctl_error *error)
{
    const struct check_options *options = apart->options;
    const struct ctl_link link = {.url = (char[]){"direct:"},
                                  .result_bytes = options->ask.link.result_bytes};
    struct check_run *run = &apart->run;
    char *const *paths = options->ask.files.list;
    int status = look_at_files(apart, error);
    if (status == PCCD_OK) {
        status = read_frame(apart, 0, &apart->object.at[0], error);
    }
    if (status == PCCD_OK && ctl_link_open(&link, &run->client) != CTL_DONE) {
        status = ctl_error_set(error, PCCD_E_NODAEMON, "%s", "no connection");
    }
    apart->object.paths = (char **)(uintptr_t)paths;
    apart->object.files = apart->part->files;
    apart->object.settings = options->ask.object;
    apart->scene = (struct scene){.objects = &apart->object, .object_count = 1};
    status =
        status == PCCD_OK ? check_run_begin(run, &apart->scene, false, error) : status;
    return status == PCCD_OK && apart->ends != NULL ? look_at_first(apart, error)
                                                    : status;
}

int check_apart(const struct check_options *options, struct part *part,
                struct check_run *run, const char *results, struct judge_ends *ends,
                struct report_step *steps, struct ctl_error *error)
{
    struct apart apart = {.options = options,
                          .part = part,
                          .ends = part->files.count > 2 || ends->leaves_out ? ends : NULL,
                          .run = {.settings = run->settings,
                                  .repeats = run->repeats,
                                  .is_apart = true,
                                  .note = note_page}};
    const struct items_work work = {.name = "check",
                                    .count = part->files.count - 1,
                                    .result_bytes = sizeof(struct report_step),
                                    .context = &apart,
                                    .compute = compute,
                                    .line = line,
                                    .read = read_line,
                                    .depends = depends,
                                    .describe = describe};
    struct items items = {.work = NULL};
    apart.run.owner = &apart;
    uint32_t threads = 1;
    int status = pccd_mpi_threads(MPI_COMM_WORLD, &threads);
    if (apart.run.settings.threads == 0) {
        apart.run.settings.threads = threads;
    }
    status = status == PCCD_OK ? open_all(&apart, error)
                               : ctl_error_set(error, status, "MPI has failed");
    status = together_agree(status, error);
    if (status == PCCD_OK) {
        status = together_compare(&apart.bytes, sizeof apart.bytes, part->files.names[0],
                                  " and what follows: other files", error);
    }
    if (status == PCCD_OK) {
        status = items_run(&items, &work, results, error);
    }
    for (uint64_t i = 0; i < work.count && status == PCCD_OK && together_is_root(); i++) {
        steps[i] = *(const struct report_step *)items_result(&items, i);
        steps[i].from = part->files.names[i];
        steps[i].to = part->files.names[i + 1];
    }
    run->told.objects->info = apart.object.info;
    run->told.build_ms = apart.scene.build_ms;
    items_deinit(&items);
    follow_deinit(&ends->follow); /* its scene ends here */
    check_run_deinit(&apart.run);
    pccd_close(apart.run.client);
    free(apart.object.edges);
    for (uint32_t i = 0; i < SCENE_FRAMES; i++) {
        ctl_mesh_deinit(&apart.object.at[i]);
    }
    return status;
}
