/* client/ctl/check/report_json.c - what `pccdctl check --json` says.
 *
 * Room:     client/ctl.
 * Does:     builds the JSON object with jansson.
 * Does not: print text; see report.c.
 * Threads:  one.
 * Source:   report.h.
 */
#include <inttypes.h>
#include <jansson.h>

#include "json_text.h"
#include "report.h"

/* jansson's *_set_new and *_append_new take the value also when they fail, and fail on a
 * NULL value, so `ok` is all that has to be looked at. */
static void set(json_t *object, const char *key, json_t *value, bool *ok)
{
    if (json_object_set_new(object, key, value) != 0) {
        *ok = false;
    }
}

static void set_count(json_t *object, const char *key, uint64_t value, bool *ok)
{
    set(object, key, json_integer((json_int_t)value), ok);
}

static void set_toi(json_t *object, double toi, bool *ok)
{
    set(object, "toi_first", toi <= 1.0 ? json_real(toi) : json_null(), ok);
}

static json_t *mode_text(const char *name)
{
    return name != NULL ? json_string(name) : json_null();
}

/* One of an enum of which 0 means that there was no choice. */
static json_t *choice_text(uint32_t value, const char *name)
{
    return mode_text(value != 0 ? name : NULL);
}

static void add_settings(json_t *object, const struct pccd_scene_settings *settings,
                         bool *ok)
{
    double ratio = settings->rebuild_ratio;
    set(object, "quality", mode_text(report_quality_name(settings->quality)), ok);
    set(object, "rebuild_ratio",
        ratio == 0 ? json_null() : json_real(ratio < 0 ? 0.0 : ratio), ok);
}

static void add_mesh(json_t *object, const struct report_mesh *mesh, bool *ok)
{
    const struct pccd_mesh_info *info = &mesh->info;
    set_count(object, "vertices", info->vertex_count, ok);
    set_count(object, "edges", info->edge_count, ok);
    set_count(object, "triangles", info->triangle_count, ok);
    set_count(object, "duplicate_triangles", info->duplicate_count, ok);
    set_count(object, "degenerate_triangles", info->degenerate_count, ok);
    set_count(object, "unused_vertices", info->isolated_count, ok);
    add_settings(object, &mesh->settings, ok);
}

static json_t *times_object(const struct report_mesh *mesh,
                            const struct report_step *step, bool *ok)
{
    json_t *object = json_object();
    set(object, "build", json_real(mesh->build_ms), ok);
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        set(object, report_phase_names[phase], json_real(step->ms[phase]), ok);
    }
    set(object, "first_step", json_real(step->first_ms), ok);
    set(object, "round_trip", json_real(step->round_trip_ms), ok);
    return object;
}

static json_t *counters_object(const struct pccd_step_counters *counters, bool *ok)
{
    json_t *object = json_object();
#define SET_COUNTER(name) set_count(object, #name, counters->name, ok);
    REPORT_COUNTERS(SET_COUNTER)
#undef SET_COUNTER
    return object;
}

static void add_step(json_t *object, const struct report_mesh *mesh,
                     const struct report_step *step, bool *ok)
{
    static const char *const verdicts[] = {"no", "possible", "yes", "none"};
    const struct pccd_answer *answer = &step->answer;
    uint32_t verdict = (uint32_t)answer->verdict;
    char hash[33];
    snprintf(hash, sizeof(hash), "%016" PRIx64 "%016" PRIx64, answer->hash[0],
             answer->hash[1]);
    set(object, "from", json_text(step->from), ok);
    set(object, "to", json_text(step->to), ok);
    set(object, "mode", mode_text(report_mode_name(answer->mode)), ok);
    set(object, "method", mode_text(report_method_name(answer->method)), ok);
    set_count(object, "threads", answer->threads, ok);
    set(object, "scheduler",
        choice_text(answer->scheduler, report_scheduler_name(answer->scheduler)), ok);
    set(object, "high_level",
        choice_text(answer->high_level, report_high_level_name(answer->high_level)), ok);
    set(object, "refit", choice_text(answer->refit, report_refit_name(answer->refit)),
        ok);
    set_count(object, "contacts", answer->total, ok);
    set_count(object, "vf", answer->vf, ok);
    set_count(object, "ee", answer->ee, ok);
    set_count(object, "possible", answer->possible, ok);
    set_count(object, "initial", answer->initial, ok);
    if (answer->mode == PCCD_MODE_ANY) {
        set(object, "verdict", mode_text(verdict < 4 ? verdicts[verdict] : NULL), ok);
    }
    set_toi(object, answer->toi_first, ok);
    set(object, "complete", json_boolean(step->is_complete), ok);
    set(object, "hash", json_string(hash), ok);
    set_count(object, "repeat", step->repeats, ok);
    set(object, "ms", times_object(mesh, step, ok), ok);
    set(object, "counters", counters_object(&answer->counters, ok), ok);
}

static void add_steps(json_t *object, const struct report_mesh *mesh,
                      const struct report_step *steps, uint32_t step_count, bool *ok)
{
    uint64_t contacts = 0, vf = 0, ee = 0, possible = 0;
    bool is_complete = true;
    json_t *array = json_array();
    for (uint32_t i = 0; i < step_count; i++) {
        json_t *element = json_object();
        add_step(element, mesh, &steps[i], ok);
        if (json_array_append_new(array, element) != 0) {
            *ok = false;
        }
        contacts += steps[i].answer.total;
        vf += steps[i].answer.vf;
        ee += steps[i].answer.ee;
        possible += steps[i].answer.possible;
        is_complete = is_complete && steps[i].is_complete;
    }
    set_count(object, "contacts", contacts, ok);
    set_count(object, "vf", vf, ok);
    set_count(object, "ee", ee, ok);
    set_count(object, "possible", possible, ok);
    set(object, "complete", json_boolean(is_complete), ok);
    set(object, "steps", array, ok);
}

bool report_json(FILE *to, const struct report_mesh *mesh,
                 const struct report_step *steps, uint32_t step_count)
{
    json_t *object = json_object();
    bool ok = object != NULL;
    add_mesh(object, mesh, &ok);
    if (step_count == 1) {
        add_step(object, mesh, &steps[0], &ok);
    } else {
        add_steps(object, mesh, steps, step_count, &ok);
    }
    ok = ok && json_dumpf(object, to, JSON_TEXT_FLAGS) == 0;
    ok = ok && fputc('\n', to) != EOF;
    json_decref(object);
    return ok;
}
