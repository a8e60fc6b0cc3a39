/* report_json.c - what `pccdctl check --json` says. */
#include <inttypes.h>
#include <jansson.h>

#include "kinds.h"
#include "names.h"
#include "numbers.h"
#include "output.h"
#include "printable.h"
#include "report.h"

static void set_toi(json_t *object, double toi, bool *ok)
{
    json_set(object, "toi_first", toi <= 1.0 ? json_real(toi) : json_null(), ok);
}

static json_t *mode_text(const char *name)
{
    return name != NULL ? json_string(name) : json_null();
}

/* Set what all objects have together. */
static void add_sums(json_t *object, const struct report_scene *scene, bool *ok)
{
    struct pccd_mesh_info sum = {.vertex_count = 0};
    struct ctl_welded welded = {.distance = 0};
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct pccd_mesh_info *info = &scene->objects[i].info;
        const struct ctl_welded *own = &scene->objects[i].welded;
        sum.vertex_count += info->vertex_count;
        sum.edge_count += info->edge_count;
        sum.triangle_count += info->triangle_count;
        sum.duplicate_count += info->duplicate_count;
        sum.degenerate_count += info->degenerate_count;
        sum.isolated_count += info->isolated_count;
        sum.free_edge_count += info->free_edge_count;
        sum.free_point_count += info->free_point_count;
        welded.joined += own->joined;
        welded.between += own->between;
        welded.apart += own->apart;
        welded.flat += own->flat;
        welded.more += own->more;
        welded.distance =
            own->distance > welded.distance ? own->distance : welded.distance;
    }
    json_set_count(object, "vertices", sum.vertex_count, ok);
    json_set_count(object, "edges", sum.edge_count, ok);
    json_set_count(object, "triangles", sum.triangle_count, ok);
    json_set_count(object, "duplicate_triangles", sum.duplicate_count, ok);
    json_set_count(object, "degenerate_triangles", sum.degenerate_count, ok);
    json_set_count(object, "unused_vertices", sum.isolated_count, ok);
    json_set_count(object, "free_edges", sum.free_edge_count, ok);
    json_set_count(object, "free_points", sum.free_point_count, ok);
    report_welded(object, &welded, ok);
}

/* Append, of each file that has several frames, how many, and which ones. */
static void add_sources(json_t *array, const struct ctl_frames *files, bool *ok)
{
    for (uint32_t i = 0; files != NULL && i < files->source_count; i++) {
        const struct ctl_frames_source *source = &files->sources[i];
        char first[64] = "", last[64] = "";
        if (source->motion.read == NULL) {
            continue;
        }
        json_t *element = json_object();
        source->motion.name(&source->motion, 0, first, sizeof first);
        source->motion.name(&source->motion, source->frame_count - 1, last, sizeof last);
        json_set(element, "file", json_text(source->path), ok);
        json_set_count(element, "frames", source->frame_count, ok);
        json_set(element, "first", json_text(first), ok);
        json_set(element, "last", json_text(last), ok);
        json_set(element, "faces", json_text(files->mesh.path), ok);
        json_append(array, element, ok);
    }
}

json_t *report_objects(const struct report_scene *scene, bool *ok)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct report_object *object = &scene->objects[i];
        json_t *element = json_object();
        if (object->name != NULL) {
            json_set(element, "name", json_text(object->name), ok);
        }
        json_set(element, "file", json_text(object->path), ok);
        json_set_count(element, "vertices", object->info.vertex_count, ok);
        json_set_count(element, "edges", object->info.edge_count, ok);
        json_set_count(element, "triangles", object->info.triangle_count, ok);
        report_welded(element, &object->welded, ok);
        json_append(array, element, ok);
    }
    return array;
}

/* Set the sums, files and warnings of a scene; of several objects each. */
static void add_scene(json_t *object, const struct report_scene *scene, bool *ok)
{
    json_t *sources = json_array();
    json_t *warnings = json_array();
    add_sums(object, scene, ok);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct ctl_frames *files = scene->objects[i].files;
        add_sources(sources, files, ok);
        if (files != NULL && files->sequence.warning != NULL) {
            json_append(warnings, json_text(files->sequence.warning), ok);
        }
    }
    if (scene->warning != NULL) {
        json_append(warnings, json_text(scene->warning), ok);
    }
    json_set(object, "sources", sources, ok);
    json_set(object, "warnings", warnings, ok);
    if (scene->object_count > 1) {
        json_set(object, "scene", report_objects(scene, ok), ok);
    }
}

void report_welded(json_t *object, const struct ctl_welded *welded, bool *ok)
{
    json_set_count(object, "welded", welded->joined, ok);
    json_set_count(object, "welded_between", welded->between, ok);
    json_set_count(object, "welded_apart", welded->apart, ok);
    json_set_count(object, "welded_flat", welded->flat, ok);
    json_set_count(object, "weldable", welded->more, ok);
    json_set(object, "weldable_distance",
             welded->more > 0 ? json_real(welded->distance) : json_null(), ok);
}

static json_t *times_object(double build_ms, const struct report_step *step, bool *ok)
{
    json_t *object = json_object();
    json_set(object, "build", json_real(build_ms), ok);
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        json_set(object, report_phase_names[phase], json_real(step->ms[phase]), ok);
    }
    json_set(object, "first_step", json_real(step->first_ms), ok);
    json_set(object, "round_trip", json_real(step->round_trip_ms), ok);
    return object;
}

void report_kinds(json_t *object, const uint64_t counts[PCCD_KINDS_MAX], bool *ok)
{
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        json_set_count(object, common_kinds[kind].name, counts[kind], ok);
    }
}

json_t *report_counters(const struct pccd_answer *answer, bool *ok)
{
    json_t *object = json_object();
#define SET(unused, type, name, of_step, of_near, member, meaning)                       \
    json_set_count(object, #name, answer->member, ok);
    COMMON_COUNTERS(SET, )
#undef SET
    return object;
}

void report_json_sharing(json_t *object, const struct pccd_answer *answer, bool *ok)
{
    json_set(object, "method", mode_text(common_method_name(answer->method)), ok);
    json_set_count(object, "threads", answer->threads, ok);
    json_set(object, "tuning",
             answer->tuning[0] != '\0' ? json_text(answer->tuning) : json_null(), ok);
}

void report_json_rest(json_t *object, double build_ms, const struct report_step *step,
                      bool *ok)
{
    const struct pccd_answer *answer = &step->answer;
    char hash[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, answer->hash, hash);
    json_set(object, "complete", json_boolean(step->is_complete), ok);
    json_set(object, "hash",
             (answer->hash[0] | answer->hash[1]) != 0 ? json_string(hash) : json_null(),
             ok);
    json_set_count(object, "repeat", step->repeats, ok);
    json_set(object, "ms", times_object(build_ms, step, ok), ok);
    json_set(object, "counters", report_counters(answer, ok), ok);
}

/* Return the objects that meet, two by two: both names, and how often. */
static json_t *pairs_array(const struct report_scene *scene,
                           const struct report_step *step, bool *ok)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < step->pair_count; i++) {
        const struct report_pair *pair = &step->pairs[i];
        json_t *element = json_object();
        json_set(element, "a", json_text(scene->names[pair->a]), ok);
        json_set(element, "b", json_text(scene->names[pair->b]), ok);
        json_set_count(element, "contacts", pair->count, ok);
        json_append(array, element, ok);
    }
    return array;
}

json_t *report_place(const struct report_scene *scene, const struct report_first *first,
                     bool *ok)
{
    static const char *const sides[] = {"a", "b"};
    if (!first->is_known) {
        return json_null();
    }
    json_t *object = json_object();
    for (int side = 0; side < (first->is_alone ? 1 : 2); side++) {
        uint32_t points = common_kinds[first->kind].points[side];
        json_t *element = json_object();
        if (first->part[side] != REPORT_NO_PART) {
            json_set(element, "object", json_text(scene->names[first->part[side]]), ok);
        }
        json_set(element, common_feature_names[points],
                 points == 2 ? json_pack("[I, I]", (json_int_t)first->feature[side],
                                         (json_int_t)first->other[side])
                             : json_integer((json_int_t)first->feature[side]),
                 ok);
        json_set(object, sides[side], element, ok);
    }
    json_set(object, "at", json_pack("[f, f, f]", first->x, first->y, first->z), ok);
    return object;
}

/* Set what crosses where a step ends, or null. */
static void add_ends(json_t *object, const struct report_step *step, bool *ok)
{
    const struct column *column = report_ends_columns;
    if (step->ends.is_known) {
        *ok = *ok && columns_add(object, column, step);
    }
    for (; !step->ends.is_known && column->json != NULL; column++) {
        json_set(object, column->json, json_null(), ok);
    }
}

static void add_step(json_t *object, const struct report_scene *scene,
                     const struct report_step *step, bool *ok)
{
    const struct pccd_answer *answer = &step->answer;
    json_set(object, "from", json_text(step->from), ok);
    json_set(object, "to", json_text(step->to), ok);
    json_set(object, "mode", mode_text(common_mode_name(answer->mode)), ok);
    report_json_sharing(object, answer, ok);
    json_set_count(object, "contacts", answer->total, ok);
    report_kinds(object, answer->counts, ok);
    json_set_count(object, "possible", answer->possible, ok);
    json_set_count(object, "initial", answer->initial, ok);
    if (answer->mode == PCCD_MODE_ANY) {
        json_set(object, "verdict", mode_text(common_verdict_name(answer->verdict)), ok);
    }
    set_toi(object, answer->toi_first, ok);
    json_set(object, "first", report_place(scene, &step->first, ok), ok);
    json_set(object, "safe_step", json_real(answer->safe_step), ok);
    json_set_count(object, "inside", answer->inside, ok);
    json_set(object, "crowded", json_boolean(answer->crowded), ok);
    json_set_count(object, "coincident", answer->coincident, ok);
    json_set_count(object, "crossings", answer->crossings, ok);
    json_set_count(object, "start_inside", answer->start_inside, ok);
    json_set_count(object, "entering", answer->entering, ok);
    json_set_count(object, "sliding", answer->sliding, ok);
    json_set_count(object, "leaving", answer->leaving, ok);
    json_set(object, "objects", pairs_array(scene, step, ok), ok);
    add_ends(object, step, ok);
    report_json_rest(object, scene->build_ms, step, ok);
}

static void add_steps(json_t *object, const struct report_scene *scene,
                      const struct report_step *steps, uint32_t step_count, bool *ok)
{
    uint64_t contacts = 0, counts[PCCD_KINDS_MAX] = {0}, possible = 0;
    uint64_t initial = 0, crossings = 0, start_inside = 0;
    bool is_complete = true;
    json_t *array = json_array();
    for (uint32_t i = 0; i < step_count; i++) {
        json_t *element = json_object();
        add_step(element, scene, &steps[i], ok);
        json_append(array, element, ok);
        contacts += steps[i].answer.total;
        for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
            counts[kind] += steps[i].answer.counts[kind];
        }
        possible += steps[i].answer.possible;
        initial += steps[i].answer.initial;
        crossings += steps[i].answer.crossings;
        start_inside += steps[i].answer.start_inside;
        is_complete = is_complete && steps[i].is_complete;
    }
    json_set_count(object, "contacts", contacts, ok);
    report_kinds(object, counts, ok);
    json_set_count(object, "possible", possible, ok);
    json_set_count(object, "initial", initial, ok);
    json_set_count(object, "crossings", crossings, ok);
    json_set_count(object, "start_inside", start_inside, ok);
    json_set(object, "complete", json_boolean(is_complete), ok);
    json_set(object, "steps", array, ok);
}

bool report_json(FILE *to, const struct report_scene *scene,
                 const struct report_step *steps, uint32_t step_count, json_t *verdict)
{
    json_t *object = json_object();
    bool ok = object != NULL;
    add_scene(object, scene, &ok);
    if (step_count == 1) {
        add_step(object, scene, &steps[0], &ok);
    } else {
        add_steps(object, scene, steps, step_count, &ok);
        json_set(object, "sequence", json_incref(verdict), &ok);
    }
    json_decref(verdict);
    return output_json(object, ok, to);
}
