/* near_report.c - what `pccdctl near` says. */
#include "near_run.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>

#include "ctl.h"
#include "kinds.h"
#include "names.h"
#include "output.h"
#include "printable.h"
#include "shown.h"

#define NO_DISTANCE 1e18 /* above any; the daemon says 2e18 when there is no record */

static const char *verdict_name(const struct pccd_answer *answer)
{
    const char *name = common_verdict_name(answer->verdict);
    return name != NULL ? name : "unknown";
}

static bool has_distance(const struct pccd_answer *answer)
{
    return answer->distance_min <= NO_DISTANCE;
}

/* ": 12 vertex-face, 3 edge-edge", of the kinds that there are. */
static void print_kinds(FILE *to, const struct pccd_answer *answer)
{
    const char *before = ": ";
    for (uint32_t kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        const uint32_t *points = common_kinds[kind].points;
        if (answer->counts[kind] > 0) {
            fprintf(to, "%s%" PRIu64 " %s-%s", before, answer->counts[kind],
                    common_feature_names[points[0]], common_feature_names[points[1]]);
            before = ", ";
        }
    }
    fputc('\n', to);
}

static void print_question(FILE *to, const struct near_run *near)
{
    static const char *const texts[PCCD_NEAR_COUNT][2] = {
        [PCCD_NEAR_PAIRS] = {"pair", "pairs"},
        [PCCD_NEAR_FEATURES] = {"pair of closest features", "pairs of closest features"},
        [PCCD_NEAR_VERTICES] = {"vertex with its bound", "vertices with their bounds"},
        [PCCD_NEAR_NEAREST] = {"nearest pair of two objects",
                               "nearest pairs of two objects"},
        [PCCD_NEAR_CROSSINGS] = {"crossing", "crossings"},
        [PCCD_NEAR_DEPTH] = {"vertex inside", "vertices inside"}};
    const struct pccd_near_settings *settings = &near->settings;
    const struct pccd_answer *answer = &near->step.answer;
    bool has_limit = common_near_has_all_pairs(settings->what) ||
                     (settings->what == PCCD_NEAR_NEAREST && !isinf(settings->distance));
    fprintf(
        to, "near       %" PRIu64 " %s", answer->total,
        proto_plural(answer->total, texts[settings->what][0], texts[settings->what][1]));
    if (has_limit) {
        fprintf(to, " within %s", tool_shown_number(settings->distance));
    }
    if (settings->what == PCCD_NEAR_NEAREST && settings->gap > 0) {
        fprintf(to, ", others may be nearer by %s", tool_shown_number(settings->gap));
    }
    print_kinds(to, answer);
}

/* A line, if it is known: "nearest    vertex 0 of "a" and face 3 of "b" at (...)". */
static void print_place(FILE *to, const struct near_run *near, const char *head,
                        const struct report_first *place)
{
    char text[16];
    if (place->is_known) {
        snprintf(text, sizeof text, "%-11s", head);
        report_print_place(to, text, " and ", &near->run.told, place);
        fputc('\n', to);
    }
}

static void print_found(FILE *to, const struct near_run *near)
{
    enum pccd_near_what what = near->settings.what;
    const struct pccd_answer *answer = &near->step.answer;
    if (what == PCCD_NEAR_CROSSINGS) {
        fprintf(to, "intersects %s\n", verdict_name(answer));
    }
    if (what != PCCD_NEAR_NEAREST) {
        fprintf(to, "crossings  %" PRIu64 "\n", answer->crossings);
    }
    if (what == PCCD_NEAR_CROSSINGS) {
        print_place(to, near, "where", &near->step.first);
    }
    if (near->has_touching) {
        const struct pccd_answer *touching = &near->touching.answer;
        fprintf(to, "touching   %" PRIu64 " %s at distance 0%s", touching->total,
                proto_plural(touching->total, "pair", "pairs"),
                near->touching.is_complete ? "" : ", INCOMPLETE");
        print_kinds(to, touching);
        print_place(to, near, "where", &near->touching.first);
    }
    if (what == PCCD_NEAR_DEPTH) {
        fprintf(to, "depth      %s\n", tool_shown_number(answer->distance_max));
        print_place(to, near, "deepest", &near->step.first);
    } else if (what != PCCD_NEAR_CROSSINGS && has_distance(answer)) {
        fprintf(to, "distance   %s\n",
                tool_shown_interval(answer->distance_min, answer->distance_max));
        print_place(to, near, "nearest", &near->step.first);
    }
}

void near_report_warn(const struct near_run *near)
{
    for (uint32_t i = 0; i < near->scene.object_count; i++) {
        const struct scene_object *object = &near->scene.objects[i];
        if (object->files.count > 1) {
            (void)ctl_complain("warning: %s has %" PRIu32
                               " frames, and the first is read",
                               object->paths[0], object->files.count);
        }
    }
    const enum pccd_near_what what = near->settings.what;
    const char *idle = scene_idle(&near->scene, !common_near_is_of_objects(what));
    if (idle != NULL) {
        (void)ctl_complain("warning: %s", idle);
    }
}

void near_report_print(FILE *to, const struct near_run *near)
{
    report_print_objects(to, &near->run.told);
    print_question(to, near);
    print_found(to, near);
    report_print_rest(to, near->run.told.build_ms, &near->step);
}

/* ---- JSON -------------------------------------------------------------------------- */

static json_t *real_or_null(double value, bool is_there)
{
    return is_there ? json_real(value) : json_null();
}

/* Return how many pairs at distance 0 there are of each kind; null: not asked. */
static json_t *touching_json(const struct near_run *near, bool *ok)
{
    if (!near->has_touching) {
        return json_null();
    }
    json_t *object = json_object();
    json_set_count(object, "total", near->touching.answer.total, ok);
    report_kinds(object, near->touching.answer.counts, ok);
    json_set(object, "place", report_place(&near->run.told, &near->touching.first, ok),
             ok);
    json_set(object, "complete", json_boolean(near->touching.is_complete), ok);
    return object;
}

bool near_report_json(FILE *to, const struct near_run *near)
{
    const struct pccd_near_settings *settings = &near->settings;
    const struct pccd_answer *answer = &near->step.answer;
    json_t *all = json_object();
    bool ok = all != NULL;
    json_set(all, "objects", report_objects(&near->run.told, &ok), &ok);
    json_set(all, "what", json_string(common_near_name(settings->what)), &ok);
    json_set(all, "distance",
             real_or_null(settings->distance, common_near_has_distance(settings->what) &&
                                                  !isinf(settings->distance)),
             &ok);
    json_set(all, "gap", real_or_null(settings->gap, settings->what == PCCD_NEAR_NEAREST),
             &ok);
    report_json_sharing(all, answer, &ok);
    json_set_count(all, "total", answer->total, &ok);
    for (uint32_t kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        json_set_count(all, common_kinds[kind].name, answer->counts[kind], &ok);
    }
    json_set(all, "distance_min",
             real_or_null(answer->distance_min, has_distance(answer)), &ok);
    json_set(all, "distance_max",
             real_or_null(answer->distance_max, has_distance(answer)), &ok);
    json_set(all, "crossings",
             settings->what == PCCD_NEAR_NEAREST
                 ? json_null()
                 : json_integer((json_int_t)answer->crossings),
             &ok);
    json_set(all, "place", report_place(&near->run.told, &near->step.first, &ok), &ok);
    json_set(all, "touching", touching_json(near, &ok), &ok);
    json_set(all, "verdict", json_string(verdict_name(answer)), &ok);
    report_json_rest(all, near->run.told.build_ms, &near->step, &ok);
    return output_json(all, ok, to);
}
