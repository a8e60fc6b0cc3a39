/* inspect.c - the steps of a recording become data of a page. */
#include "inspect.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "names.h"
#include "output.h"
#include "printable.h"
#include "recorded_state.h"
#include "report.h"

#define FORMAT 8 /* of the data; data.js is in the same file, and asks nevertheless */
/* Bytes for the JSON text beside steps and meshes; names are cut to fit. */
#define META_REST      4096u
#define NAME_MAX_BYTES 256u

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the page");
}

int inspect_has_page(struct ctl_error *error)
{
    size_t bytes = 0;
    return page_template(&bytes) != NULL
               ? PCCD_OK
               : ctl_error_set(
                     error, PCCD_E_SYSTEM,
                     "this pccdctl was built without the page of inspect: build it again "
                     "with ./bootstrap, or with configure --with-inspect=fetch, where "
                     "node (18 or later) and npm are installed; \"pccdctl render\" and "
                     "\"export\" need neither");
}

int inspect_begin_page(struct page_file *page, FILE *to, const char *path,
                       struct ctl_error *error)
{
    size_t bytes = 0;
    const char *template = page_template(&bytes);
    return page_file_begin(page, to, path, template, bytes, error);
}

int inspect_init(struct inspect *inspect, const struct inspect_settings *settings,
                 struct page_file *page, struct ctl_error *error)
{
    *inspect = (struct inspect){.settings = *settings,
                                .page = page,
                                .steps = json_array(),
                                .meshes = json_array(),
                                .left_out = json_array()};
    return inspect->steps != NULL && inspect->meshes != NULL && inspect->left_out != NULL
               ? PCCD_OK
               : no_memory(error);
}

void inspect_deinit(struct inspect *inspect)
{
    json_decref(inspect->steps);
    json_decref(inspect->meshes);
    json_decref(inspect->left_out);
    bytes_deinit(&inspect->data);
    bytes_deinit(&inspect->packed);
    free(inspect->boxes);
    free(inspect->places);
    free(inspect->known);
    memset(inspect, 0, sizeof *inspect);
}

/* ---- what is said of a step -------------------------------------------------------- */

/* jansson's *_set_new takes the value also when it fails, and fails on a NULL value. */
static void set(json_t *object, const char *key, json_t *value, bool *ok)
{
    *ok = json_object_set_new(object, key, value) == 0 && *ok;
}

static void set_count(json_t *object, const char *key, uint64_t value, bool *ok)
{
    set(object, key, json_integer((json_int_t)value), ok);
}

static void set_name(json_t *object, const char *key, const char *name, bool *ok)
{
    set(object, key, name != NULL ? json_string(name) : json_null(), ok);
}

static json_t *times_of(const struct pccd_step_times *times, bool *ok)
{
    json_t *object = json_object();
    set_count(object, "queue", times->queue, ok);
#define SET_TIME(name) set_count(object, #name, times->name, ok);
    REPORT_PHASES(SET_TIME)
#undef SET_TIME
    return object;
}

/* Return what is told of steps that are left out, too. */
static json_t *summary_of(const struct pccd_answer *answer, bool *ok)
{
    json_t *object = json_object();
    set_name(object, "status", pccd_status_name(answer->status), ok);
    if (answer->status != PCCD_OK) {
        set_name(object, "refusal", pccd_status_text(answer->status), ok);
    }
    set_name(object, "mode", common_mode_name(answer->mode), ok);
    set_count(object, "incomplete", answer->incomplete, ok);
    set_count(object, "verdict", answer->verdict, ok);
    set_count(object, "total", answer->total, ok);
    set_count(object, "possible", answer->possible, ok);
    set_count(object, "crossings", answer->crossings, ok);
    set_count(object, "start_inside", answer->start_inside, ok);
    set(object, "toi_first",
        answer->toi_first <= 1 ? json_real(answer->toi_first) : json_null(), ok);
    return object;
}

static json_t *answer_of(const struct pccd_answer *answer, bool *ok)
{
    json_t *object = summary_of(answer, ok);
    char hash[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, answer->hash, hash);
    set_name(object, "method", common_method_name(answer->method), ok);
    set_name(object, "tuning", answer->tuning[0] != '\0' ? answer->tuning : NULL, ok);
    set_count(object, "threads", answer->threads, ok);
    report_kinds(object, answer->counts, ok);
    set_count(object, "initial", answer->initial, ok);
    set_count(object, "inside", answer->inside, ok);
    set(object, "safe_step", json_real(answer->safe_step), ok);
    set(object, "crowded", json_boolean(answer->crowded), ok);
    set_name(object, "hash", hash, ok);
    set(object, "times", times_of(&answer->times, ok), ok);
    set(object, "counters", report_counters(answer, ok), ok);
    return object;
}

/* Return "same", "other", "incomplete": the recorded answer was, and the page shows all
 * of it; or "none": there is nothing to compare; with a gap any pair will do. */
static const char *compare_step(const struct play_step *step)
{
    const struct record_answer *then = step->recorded;
    const struct pccd_answer *now = step->answer;
    if (then == NULL || (step->asked != NULL && play_has_gap(step->asked)) ||
        (then->status == PCCD_OK && !play_is_complete((uint32_t)now->incomplete))) {
        return "none";
    }
    if (then->status == PCCD_OK && !play_is_complete(then->incomplete)) {
        return "incomplete";
    }
    bool is_same = then->status == now->status &&
                   (then->status != PCCD_OK ||
                    memcmp(then->hash, now->hash, sizeof then->hash) == 0);
    return is_same ? "same" : "other";
}

/* Say how an answer compares with the recorded one, and why that one was cut short. */
static void set_compared(json_t *object, const struct play_step *step,
                         const char *compared, bool *ok)
{
    set_name(object, "recorded", compared, ok);
    if (step->recorded != NULL && !play_is_complete(step->recorded->incomplete)) {
        set_count(object, "recorded_incomplete", step->recorded->incomplete, ok);
    }
}

/* ---- steps ------------------------------------------------------------------------- */

/* A picture squares lengths in single precision, and squares that: 1, or near `size`. */
static double unit_for(double size)
{
    int octave = 0;
    (void)frexp(size, &octave);
    return size > 0 && (octave < -16 || octave > 24) ? ldexp(1, octave) : 1;
}

/* The middle of the first step's objects: what is far from zero stays sharp as float. */
static void choose_origin(struct inspect *inspect, const struct registry_scene *scene)
{
    double low[3], high[3];
    recorded_bounds(scene, 0, low, high);
    double size = 0;
    for (uint32_t k = 0; k < 3 && scene->object_count > 0; k++) {
        inspect->origin[k] = low[k] + (high[k] - low[k]) / 2;
        size = fmax(size, high[k] - low[k]);
    }
    inspect->unit = unit_for(size);
    inspect->has_origin = scene->object_count > 0;
}

/* Everything of a step: its description, its data, and the meshes that it brings. */
static json_t *describe(struct inspect *inspect, const struct play_step *step,
                        const char *compared, json_t *meshes)
{
    bool ok = true;
    json_t *object = json_object();
    set_count(object, "number", step->number, &ok);
    set_count(object, "scene", step->scene->handle, &ok);
    set_compared(object, step, compared, &ok);
    set(object, "answer", answer_of(step->answer, &ok), &ok);
    set(object, "tells_start", json_boolean(step->frame->tells), &ok);
    set(object, "objects",
        inspect_pack_objects(inspect, step->scene, INSPECT_BOTH, meshes), &ok);
    set(object, "joints", inspect_pack_joints(inspect, &step->joints), &ok);
    set(object, "separation", json_real(step->frame->separation), &ok);
    set(object, "approach", json_real(step->frame->approach), &ok);
    set(object, "contacts", inspect_pack_contacts(inspect, step), &ok);
    set(object, "pairs", inspect_pack_pairs(inspect, step), &ok);
    set(object, "boxes", inspect_pack_boxes(inspect, step), &ok);
    set(object, "events", inspect_pack_events(inspect, step->trace), &ok);
    if (!ok || inspect->data.is_short) {
        json_decref(object);
        return NULL;
    }
    return object;
}

/* Write it if it fits. */
static int keep(struct inspect *inspect, uint64_t number, json_t *step, json_t *meshes,
                struct ctl_error *error)
{
    if (!bytes_pack(&inspect->data, &inspect->packed)) {
        return no_memory(error);
    }
    uint64_t meta = page_file_json_bytes(step) + 1 + page_file_json_bytes(meshes) + 1;
    uint64_t bytes = inspect->page->bytes + inspect->meta_bytes + META_REST + meta +
                     page_file_blob_bytes(inspect->packed.used);
    if (bytes > inspect->settings.bytes_max) {
        inspect->is_full = true;
        return inspect->kept > 0
                   ? PCCD_E_CANCELLED
                   : ctl_error_set(
                         error, PCCD_E_LIMIT,
                         "step %" PRIu64 " alone makes a page of %.1f MiB: "
                         "--max-size allows more, and --round of inspect halves "
                         "positions",
                         number, (double)bytes / (1 << 20));
    }
    int status =
        page_file_blob(inspect->page, inspect->packed.at, inspect->packed.used, error);
    if (status == PCCD_OK && (json_array_append(inspect->steps, step) != 0 ||
                              json_array_extend(inspect->meshes, meshes) != 0)) {
        status = no_memory(error);
    }
    inspect->meta_bytes += meta;
    inspect->first = inspect->kept++ == 0 ? number : inspect->first;
    inspect->last = number;
    return status;
}

/* Keep what was packed of a step or of a question, if the memory was enough for it. */
static int add(struct inspect *inspect, uint64_t number, json_t *object, json_t *meshes,
               struct ctl_error *error)
{
    int status =
        object != NULL ? keep(inspect, number, object, meshes, error) : no_memory(error);
    json_decref(object);
    json_decref(meshes);
    return status;
}

/* Keep what the page says of all steps, also of one whose drawing is left out. */
static int leave_out(struct inspect *inspect, const struct play_step *step,
                     const char *compared, struct ctl_error *error)
{
    bool ok = true;
    json_t *object = json_object();
    json_t *answer = summary_of(step->answer, &ok);
    set(answer, "times", json_pack("{s:I}", "step", (json_int_t)step->answer->times.step),
        &ok);
    set_count(object, "number", step->number, &ok);
    set_compared(object, step, compared, &ok);
    if (step->asked != NULL) {
        set_name(object, "near", common_near_name(step->answer->what), &ok);
    }
    set(object, "answer", answer, &ok);
    set(object, "first_pair", inspect_first_pair(step), &ok);
    set(object, "pairs", inspect_pack_pairs(inspect, step), &ok);
    if (!ok) {
        json_decref(object);
        return no_memory(error);
    }
    inspect->meta_bytes += page_file_json_bytes(object) + 1;
    inspect->is_full = inspect->page->bytes + inspect->meta_bytes + META_REST >
                       inspect->settings.bytes_max;
    return json_array_append_new(inspect->left_out, object) != 0 ? no_memory(error)
           : inspect->is_full                                    ? PCCD_E_CANCELLED
                                                                 : PCCD_OK;
}

static int find_edges(const struct registry_scene *scene, struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        status = recorded_edges(scene->objects[i].mesh, error);
    }
    return status;
}

/* As a step in which nothing moves, with lines in the place of contacts. */
static json_t *describe_near(struct inspect *inspect, const struct play_step *near,
                             const char *compared, json_t *meshes)
{
    bool ok = true;
    json_t *object = json_object();
    enum inspect_moment moment = near->asked->end == 0 ? INSPECT_BEGIN : INSPECT_END;
    json_t *answer = answer_of(near->answer, &ok);
    set(answer, "distance_min",
        near->answer->distance_min <= 1e18 ? json_real(near->answer->distance_min)
                                           : json_null(),
        &ok);
    set(answer, "distance_max", json_real(near->answer->distance_max), &ok);
    set_count(object, "number", near->number, &ok);
    set_count(object, "scene", near->scene->handle, &ok);
    set_compared(object, near, compared, &ok);
    set_name(object, "near", common_near_name(near->answer->what), &ok);
    set(object, "answer", answer, &ok);
    set(object, "objects", inspect_pack_objects(inspect, near->scene, moment, meshes),
        &ok);
    set(object, "separation", json_real(0), &ok);
    set(object, "contacts",
        json_pack("{s:o, s:i}", "at", inspect_section(inspect, 0), "count", 0), &ok);
    set(object, "lines", inspect_pack_lines(inspect, near), &ok);
    set(object, "pairs", inspect_pack_pairs(inspect, near), &ok);
    set(object, "asked",
        json_pack("{s:o, s:b}", "distance",
                  near->asked->distance <= 1e18 ? json_real(near->asked->distance)
                                                : json_null(),
                  "crossings",
                  near->asked->tells || !common_near_has_distance(near->asked->what)),
        &ok);
    set(object, "boxes", json_object(), &ok);
    set(object, "events", json_null(), &ok);
    if (!ok || inspect->data.is_short) {
        json_decref(object);
        return NULL;
    }
    return object;
}

int inspect_step(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct inspect *inspect = context;
    if (step->scene == NULL || step->answer == NULL) {
        return PCCD_OK; /* it failed, in a scene that there was not */
    }
    const char *compared = compare_step(step);
    inspect->differ += strcmp(compared, "other") == 0;
    int status = find_edges(step->scene, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (inspect->seen++ % inspect->settings.every != 0) {
        return leave_out(inspect, step, compared, error);
    }
    if (!inspect->has_origin) {
        choose_origin(inspect, step->scene);
    }
    bytes_empty(&inspect->data);
    if (step->trace != NULL && step->trace->status != PCCD_OK) {
        memcpy(inspect->no_lanes, step->trace->text, sizeof inspect->no_lanes);
    }
    json_t *meshes = json_array();
    json_t *object = step->asked != NULL ? describe_near(inspect, step, compared, meshes)
                                         : describe(inspect, step, compared, meshes);
    return add(inspect, step->number, object, meshes, error);
}

/* ---- the end ----------------------------------------------------------------------- */

/* Bytes as text that JSON can hold: see json_text; what is too long is
 * cut. */
static json_t *text_of(const char *bytes, size_t count)
{
    char text[NAME_MAX_BYTES + 1];
    size_t used = 0;
    while (used < count && used < NAME_MAX_BYTES && bytes[used] != '\0') {
        text[used] = bytes[used];
        used++;
    }
    text[used] = '\0';
    return json_text(text);
}

static json_t *recording_of(const char *name, const struct play_summary *summary,
                            bool *ok)
{
    const struct record_begin *begin = &summary->begin;
    json_t *object = json_object();
    set(object, "name", text_of(name, strlen(name)), ok);
    set(object, "library", text_of(begin->library, sizeof begin->library), ok);
    set(object, "cpu", text_of(begin->cpu, sizeof begin->cpu), ok);
    set(object, "unix_ms", json_real((double)begin->unix_ns / 1e6), ok);
    set_count(object, "pid", begin->pid, ok);
    set_count(object, "steps", summary->frames + summary->questions, ok);
    set(object, "is_whole", json_boolean(summary->ending == RECORD_ENDING_WHOLE), ok);
    return object;
}

/* Return the options that left out pairs, as a command line has them: the page must not
 * say of those that they do not meet. */
static json_t *asked_of(const struct inspect_settings *settings, bool *ok)
{
    json_t *asked = json_array();
    if (settings->has_no_self) {
        json_append(asked, json_string("--no-self"), ok);
    }
    for (size_t i = 0; i < settings->between.count; i++) {
        json_append(asked, json_string("--between"), ok);
        json_append(asked, json_text(settings->between.list[i]), ok);
    }
    return asked;
}

int inspect_finish(struct inspect *inspect, const char *name,
                   const struct play_summary *summary, struct ctl_error *error)
{
    const double *origin = inspect->origin;
    bool ok = true;
    json_t *meta = json_object();
    set_count(meta, "format", FORMAT, &ok);
    set_name(meta, "version", pccd_version(), &ok);
    set(meta, "recording", recording_of(name, summary, &ok), &ok);
    set(meta, "is_of_files", json_boolean(inspect->settings.is_of_files), &ok);
    set(meta, "asked", asked_of(&inspect->settings, &ok), &ok);
    set_count(meta, "every", inspect->settings.every, &ok);
    set(meta, "is_full", json_boolean(inspect->is_full), &ok);
    set(meta, "is_rounded", json_boolean(inspect->settings.is_rounded), &ok);
    set(meta, "no_lanes", text_of(inspect->no_lanes, sizeof inspect->no_lanes), &ok);
    set(meta, "origin", json_pack("[f, f, f]", origin[0], origin[1], origin[2]), &ok);
    set(meta, "unit", json_real(inspect->unit), &ok);
    set(meta, "up", json_stringn(&"xyz"[inspect->settings.up - 1], 1), &ok);
    set(meta, "meshes", json_incref(inspect->meshes), &ok);
    set(meta, "steps", json_incref(inspect->steps), &ok);
    set(meta, "left_out", json_incref(inspect->left_out), &ok);
    int status = ok ? page_file_finish(inspect->page, meta, error) : no_memory(error);
    json_decref(meta);
    return status;
}

/* ---- the whole page ---------------------------------------------------------------- */

/* Return one in how many of `all` steps the page has room for: it had for those that were
 * seen, but the last. */
static uint64_t every_with_room(const struct inspect *inspect, uint64_t all)
{
    uint64_t fitting = inspect->seen - 1; /* the last one did not */
    uint64_t times = all > fitting ? (all + fitting - 1) / fitting : 2;
    return inspect->settings.every * times;
}

int inspect_write(struct inspect *inspect, const struct inspect_settings *settings,
                  const struct inspect_source *source, struct whole_file *file,
                  struct play_summary *summary, struct ctl_error *error)
{
    struct inspect_settings thinned = *settings;
    for (;;) {
        struct page_file page;
        uint64_t all = 0;
        int status = output_open(file, source->path, false, error);
        if (status == PCCD_OK) {
            status = inspect_init(inspect, &thinned, &page, error);
        }
        if (status == PCCD_OK) {
            status = inspect_begin_page(&page, file->to, source->path, error);
        }
        if (status == PCCD_OK) {
            status = source->fill(source->context, inspect, summary, &all, error);
        }
        if (status == PCCD_OK && inspect->is_full && !file->is_direct &&
            thinned.every >= all) {
            status = ctl_error_set(error, PCCD_E_LIMIT,
                                   "what is said of %" PRIu64 " steps makes a page "
                                   "that is too large: --max-size allows more, --steps "
                                   "A..B of inspect shows fewer",
                                   all);
        }
        if (status == PCCD_OK && inspect->is_full && !file->is_direct) {
            thinned.every = every_with_room(inspect, all);
            whole_file_discard(file);
            inspect_deinit(inspect);
            continue;
        }
        if (status == PCCD_OK) {
            status = inspect_finish(inspect, source->name, summary, error);
        }
        inspect->page = NULL;
        return status;
    }
}
