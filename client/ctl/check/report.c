/* report.c - what `pccdctl check` says. */
#include "report.h"

#include <inttypes.h>
#include <math.h>

#include "kinds.h"
#include "names.h"
#include "printable.h"
#include "shown.h"

#define PAIRS_TOLD 10u
#define NOTE_BYTES 512
#define NO_TOI     1.5 /* above any time; the daemon says 2 when there is no record */

const char *const report_phase_names[REPORT_PHASE_COUNT] = {
#define PHASE_NAME(name) #name,
    REPORT_PHASES(PHASE_NAME)
#undef PHASE_NAME
};

void report_phases(const struct pccd_step_times *times, double ms[REPORT_PHASE_COUNT])
{
#define PHASE_MS(name) ms[REPORT_##name] = (double)times->name / 1e6;
    REPORT_PHASES(PHASE_MS)
#undef PHASE_MS
}

static const char *or_unknown(const char *name)
{
    return name != NULL ? name : "unknown";
}

/* "1 vertex", "2 vertices". */
static void print_count(FILE *to, uint64_t count, const char *one, const char *many)
{
    fprintf(to, "%" PRIu64 " %s", count, proto_plural(count, one, many));
}

static const char *why_incomplete(enum pccd_incomplete incomplete)
{
    switch (incomplete) {
    case PCCD_COMPLETE:
    case PCCD_INCOMPLETE_RESULT_FULL:
        break;
    case PCCD_INCOMPLETE_DEADLINE:
        return "the deadline passed";
    case PCCD_INCOMPLETE_CANCELLED:
        return "cancelled";
    case PCCD_INCOMPLETE_CONTACT_LIMIT:
        return "more records than the daemon keeps";
    case PCCD_INCOMPLETE_UNDECIDED:
        return "some pairs of what turns are not known";
    }
    return "records are missing";
}

/* Print which files have several frames, and which ones these are. */
static void print_sources(FILE *to, const struct ctl_frames *files)
{
    for (uint32_t i = 0; files != NULL && i < files->source_count; i++) {
        const struct ctl_frames_source *source = &files->sources[i];
        char first[64] = "", last[64] = "";
        if (source->motion.read == NULL) {
            continue;
        }
        source->motion.name(&source->motion, 0, first, sizeof first);
        source->motion.name(&source->motion, source->frame_count - 1, last, sizeof last);
        fprintf(to, "frames     %" PRIu32 " of %s: %s to %s", source->frame_count,
                tool_shown(source->path), first, last);
        if (source->path != files->mesh.path) {
            fprintf(to, "; faces of %s", tool_shown(files->mesh.path));
        }
        fputc('\n', to);
    }
}

void report_print_notes(FILE *to, const struct ctl_frames *files)
{
    for (uint32_t i = 0; i < files->source_count; i++) {
        const struct ctl_frames_source *source = &files->sources[i];
        char text[NOTE_BYTES];
        if (source->motion.note != NULL &&
            source->motion.note(&source->motion, text, sizeof text)) {
            fprintf(to, "note       %s: %s\n", tool_shown(source->path),
                    tool_shown(text));
        }
    }
}

void report_print_welded(FILE *to, const struct ctl_welded *welded)
{
    if (welded->joined > 0) {
        fputs("welded     ", to);
        print_count(to, welded->joined, "vertex to one", "vertices to others");
        fprintf(to, welded->within > 0 ? " within %g" : " at the same place",
                welded->within);
        fputs(welded->frame_count > 1 ? " in every frame\n" : "\n", to);
    }
    if (welded->between > 0) {
        fputs("           of these ", to);
        print_count(to, welded->between, "joins", "join");
        fputs(" two objects, which touch there and do not meet: see --weld off\n", to);
    }
    if (welded->flat > 0) {
        fputs("           ", to);
        print_count(to, welded->flat, "triangle has", "triangles have");
        fputs(" a vertex twice because of that\n", to);
    }
    if (welded->apart > 0) {
        fputs("           ", to);
        print_count(to, welded->apart, "vertex is kept, as it moves",
                    "vertices are kept, as they move");
        fprintf(to,
                welded->within > 0 ? " farther away than %g\n"
                                   : " away from the same place\n",
                welded->within);
    }
    if (welded->more > 0) {
        fputs("           ", to);
        print_count(to, welded->more, "more is", "more are");
        fprintf(to, " nearly at one place: see --weld %.3g\n", welded->distance);
    }
}

/* "12 vertices, 30 edges, 20 triangles" and the end of the line. */
static void print_counts(FILE *to, const struct pccd_mesh_info *info)
{
    print_count(to, info->vertex_count, "vertex", "vertices");
    fputs(", ", to);
    print_count(to, info->edge_count, "edge", "edges");
    fputs(", ", to);
    print_count(to, info->triangle_count, "triangle", "triangles");
    fputc('\n', to);
}

static void print_mesh(FILE *to, const struct report_object *object)
{
    const struct pccd_mesh_info *info = &object->info;
    fputs("mesh       ", to);
    print_counts(to, info);
    if (info->free_edge_count + info->free_point_count > 0) {
        fputs("free       ", to);
        print_count(to, info->free_edge_count, "edge", "edges");
        fputs(", ", to);
        print_count(to, info->free_point_count, "point", "points");
        fputc('\n', to);
    }
    report_print_welded(to, &object->welded);
    if (info->duplicate_count + info->degenerate_count + info->isolated_count == 0) {
        return;
    }
    fputs("           of these ", to);
    print_count(to, info->duplicate_count, "duplicate triangle", "duplicate triangles");
    fputs(", ", to);
    print_count(to, info->degenerate_count, "of zero area", "of zero area");
    fputs(", ", to);
    print_count(to, info->isolated_count, "unused vertex", "unused vertices");
    fputc('\n', to);
}

void report_print_objects(FILE *to, const struct report_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct report_object *object = &scene->objects[i];
        fprintf(to, "object %-3" PRIu32 " ", i + 1);
        if (object->name != NULL) {
            fprintf(to, "\"%s\", ", tool_shown(object->name));
        }
        fprintf(to, "%s: ", tool_shown(object->path));
        print_counts(to, &object->info);
        report_print_welded(to, &object->welded);
    }
}

void report_print_scene(FILE *to, const struct report_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        print_sources(to, scene->objects[i].files);
    }
    if (scene->object_count == 1) {
        print_mesh(to, &scene->objects[0]);
    } else {
        report_print_objects(to, scene);
    }
}

/* Kinds of free points are told where there are any. */
static bool is_kind_told(uint32_t kind, const uint64_t counts[PCCD_KINDS_MAX])
{
    return kind == PCCD_VF || kind == PCCD_EE || counts[kind] > 0;
}

/* " 12 vertex-face, 3 edge-edge" and the end of the line. */
static void print_kinds(FILE *to, const uint64_t counts[PCCD_KINDS_MAX])
{
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        if (!is_kind_told(kind, counts)) {
            continue;
        }
        const uint32_t *points = common_kinds[kind].points;
        fprintf(to, "%s %" PRIu64 " %s-%s", kind > 0 ? "," : "", counts[kind],
                common_feature_names[points[0]], common_feature_names[points[1]]);
    }
    fputc('\n', to);
}

/* "12 vf, 3 ee" */
static void print_kinds_briefly(FILE *to, const uint64_t counts[PCCD_KINDS_MAX])
{
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        if (!is_kind_told(kind, counts)) {
            continue;
        }
        fprintf(to, "%s%" PRIu64 " %s", kind > 0 ? ", " : "", counts[kind],
                common_kinds[kind].name);
    }
}

/* Return what to do about neighbours where `what` was done already. */
static const char *advice_of_thin(uint32_t what)
{
    bool has_rings = (what & PCCD_OBJECT_REST_RINGS) != 0;
    bool has_distance = (what & PCCD_OBJECT_REST_DISTANCE) != 0;
    return has_rings && has_distance ? "Make it less, or --rest-exclusion more"
           : has_rings               ? "Give more --rings, or see --rest-exclusion"
           : has_distance            ? "Make --rest-exclusion more, or see --rings"
                                     : "See --rings and --rest-exclusion";
}

/* Print how the step begins, unless it begins free of crossings. */
static void print_start(FILE *to, const struct pccd_answer *answer)
{
    if (answer->crossings > 0) {
        fprintf(to,
                "begins     crossed %" PRIu64 " %s: edges pass through faces at t = 0\n",
                answer->crossings, proto_plural(answer->crossings, "time", "times"));
    }
    if (answer->start_inside > 0) {
        fprintf(to,
                "begins     inside %" PRIu64 " %s: pairs are within their distance at "
                "t = 0\n",
                answer->start_inside,
                proto_plural(answer->start_inside, "time", "times"));
    }
}

/* Print what becomes of what touches, if that was asked. */
static void print_touching(FILE *to, const struct pccd_answer *answer)
{
    uint64_t all = answer->entering + answer->sliding + answer->leaving;
    if (all > 0) {
        fprintf(to,
                "touching   %" PRIu64 " at t = 0: %" PRIu64 " %s, %" PRIu64
                " %s, %" PRIu64 " %s\n",
                all, answer->entering, proto_plural(answer->entering, "enters", "enter"),
                answer->sliding, proto_plural(answer->sliding, "slides", "slide"),
                answer->leaving, proto_plural(answer->leaving, "leaves", "leave"));
    }
}

void report_print_place(FILE *to, const char *head, const char *verb,
                        const struct report_scene *scene,
                        const struct report_first *first)
{
    for (int side = 0; side < (first->is_alone ? 1 : 2) && first->is_known; side++) {
        uint32_t points = common_kinds[first->kind].points[side];
        fprintf(to, "%s%s %" PRIu32, side == 0 ? head : verb,
                common_feature_names[points], first->feature[side]);
        if (points == 2) {
            fprintf(to, "-%" PRIu32, first->other[side]);
        }
        if (first->part[side] != REPORT_NO_PART) {
            fprintf(to, " of \"%s\"", tool_shown(scene->names[first->part[side]]));
        }
    }
    if (first->is_known) {
        fprintf(to, " at (%s, %s, %s)", tool_shown_number(first->x),
                tool_shown_number(first->y), tool_shown_number(first->z));
    }
}

static void print_first(FILE *to, const struct report_scene *scene,
                        const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    if (answer->toi_first < NO_TOI) {
        fprintf(to, "first at   t = %s", tool_shown_number(answer->toi_first));
        report_print_place(to, ": ", " meets ", scene, &step->first);
        fputc('\n', to);
    } else if (answer->crossings > 0) {
        fputs("first at   the start, where it is crossed\n", to);
    } else if (answer->start_inside > 0) {
        fputs("first at   the start, where it is inside; nothing comes nearer than it "
              "may\n",
              to);
    } else {
        fputs("first at   never\n", to);
    }
}

/* To four digits: whoever takes so much of a step meets nothing. */
static double round_down(double x)
{
    double scale = x > 0 ? pow(10, 3 - floor(log10(x))) : 1;
    return isfinite(scale) ? floor(x * scale) / scale : 0;
}

static void print_records(FILE *to, const struct report_scene *scene,
                          const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    static const char *const verdicts[] = {"no", "possible", "yes", "undecided"};
    print_start(to, answer);
    print_touching(to, answer);
    if (answer->mode == PCCD_MODE_ANY) {
        uint32_t verdict = (uint32_t)answer->verdict;
        fprintf(to, "contact    %s\n", verdict < 4 ? verdicts[verdict] : "unknown");
        return;
    }
    if (answer->mode == PCCD_MODE_PAIRS) {
        fprintf(to, "pairs      %" PRIu64 ":", answer->total);
        print_kinds(to, answer->counts);
        return;
    }
    fprintf(to, "contacts   %" PRIu64 ":", answer->total);
    print_kinds(to, answer->counts);
    fprintf(to,
            "           %" PRIu64 " proved, %" PRIu64 " possible; %" PRIu64
            " touch at the start\n",
            answer->total - answer->possible, answer->possible, answer->initial);
    if (answer->inside > 0) {
        fprintf(to, "           %" PRIu64 " nearer than their distance from the start\n",
                answer->inside);
    }
    print_first(to, scene, step);
    fprintf(to, "safe step  %s\n", tool_shown_number(round_down(answer->safe_step)));
    if (answer->coincident > answer->total / 2) {
        fputs(
            "warning    most contacts touch in vertices at the start. Is a surface split "
            "there?\n           --weld joins vertices at one place\n",
            to);
    } else if (answer->crowded) {
        fprintf(to,
                "warning    most pairs are within their distance at the start. Is the "
                "thickness above\n           the length of the edges? %s\n",
                advice_of_thin(scene->object_what));
    }
}

bool report_meets(const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    return answer->total > 0 || answer->verdict == PCCD_VERDICT_YES ||
           answer->verdict == PCCD_VERDICT_POSSIBLE ||
           answer->crossings + answer->start_inside > 0;
}

void report_print_pairs(FILE *to, const struct report_scene *scene,
                        const struct report_step *step)
{
    for (uint32_t i = 0; i < step->pair_count && i < PAIRS_TOLD; i++) {
        const struct report_pair *pair = &step->pairs[i];
        fprintf(to, "           \"%s\", \"%s\": %" PRIu64 "\n",
                tool_shown(scene->names[pair->a]), tool_shown(scene->names[pair->b]),
                pair->count);
    }
    if (step->pair_count > PAIRS_TOLD) {
        uint32_t more = step->pair_count - PAIRS_TOLD;
        fprintf(to, "           and %" PRIu32 " more %s of objects\n", more,
                proto_plural(more, "pair", "pairs"));
    }
}

/* Print how the threads shared the work. */
static void print_sharing(FILE *to, const struct pccd_answer *answer)
{
    fprintf(to, "; method %s, %" PRIu32 " %s",
            or_unknown(common_method_name(answer->method)), answer->threads,
            proto_plural(answer->threads, "thread", "threads"));
    if (answer->tuning[0] != '\0') {
        fprintf(to, ", tuning %s", tool_shown(answer->tuning));
    }
    fputc('\n', to);
}

/* The last phases only where there is something to tell. */
static bool is_told(uint32_t phase, const struct report_step *step)
{
    const struct pccd_step_counters *counters = &step->answer.counters;
    if (phase == REPORT_low || phase == REPORT_high) {
        return step->ms[REPORT_high] > 0;
    }
    return phase != REPORT_rebuild || counters->rebuilds + counters->swaps > 0 ||
           step->ms[phase] > 0;
}

static void print_times(FILE *to, double build_ms, const struct report_step *step)
{
    if (step->repeats > 0) {
        fprintf(to, "time       median of %" PRIu32 " after one to warm up (%.3f ms)",
                step->repeats, step->first_ms);
    } else {
        fputs("time       first run", to);
    }
    print_sharing(to, &step->answer);
    fprintf(to, "  %-10s %12.3f ms   once\n", "build", build_ms);
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        double whole = step->ms[REPORT_step];
        if (!is_told(phase, step)) {
            continue;
        }
        fprintf(to, "  %-10s %12.3f ms  %5.1f %%\n", report_phase_names[phase],
                step->ms[phase], whole > 0 ? 100.0 * step->ms[phase] / whole : 0.0);
    }
    fprintf(to, "  %-10s %12.3f ms   from submit to answer\n", "round trip",
            step->round_trip_ms);
}

void report_print_rest(FILE *to, double build_ms, const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    const struct pccd_step_counters *counters = &answer->counters;
    char hash[PROTO_HASH_BYTES];
    uint64_t candidates = 0;
    if (step->is_complete) {
        fputs("answer     complete\n", to);
    } else {
        fprintf(to, "answer     INCOMPLETE: %s\n", why_incomplete(answer->incomplete));
    }
    if ((answer->hash[0] | answer->hash[1]) != 0) {
        fprintf(to, "hash       %s\n",
                proto_hash_text(PCCD_HASH_VERSION, answer->hash, hash));
    } /* what is nearest within a gap has none */
    for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
        candidates += counters->candidates[kind];
    }
    fprintf(to, "work       %" PRIu64 " box %s, %" PRIu64 " %s (", counters->box_tests,
            proto_plural(counters->box_tests, "test", "tests"), candidates,
            proto_plural(candidates, "candidate", "candidates"));
    print_kinds_briefly(to, counters->candidates);
    fprintf(to, "), %" PRIu64 " past the filter, %" PRIu64 " exact\n",
            counters->survivors, counters->exact);
    if (counters->rebuilds + counters->swaps > 0) {
        fprintf(to,
                "rebuilt    %" PRIu64 " %s (%" PRIu64 " %s), %" PRIu64
                " built in the background (%" PRIu64 ")\n",
                counters->rebuilds,
                proto_plural(counters->rebuilds, "subtree", "subtrees"),
                counters->rebuilt_triangles,
                proto_plural(counters->rebuilt_triangles, "triangle", "triangles"),
                counters->swaps, counters->swapped_triangles);
    }
    if (counters->still_features + counters->rigid_objects > 0) {
        fprintf(to,
                "still      %" PRIu64 " %s, %" PRIu64 " %s kept, %" PRIu64
                " rigid %s that %s not meet %s\n",
                counters->still_features,
                proto_plural(counters->still_features, "feature", "features"),
                counters->kept_records,
                proto_plural(counters->kept_records, "record", "records"),
                counters->rigid_objects,
                proto_plural(counters->rigid_objects, "object", "objects"),
                proto_plural(counters->rigid_objects, "does", "do"),
                proto_plural(counters->rigid_objects, "itself", "themselves"));
    }
    print_times(to, build_ms, step);
}

void report_print_step(FILE *to, const struct report_scene *scene,
                       const struct report_step *step)
{
    fprintf(to, "step       %s -> %s, mode %s\n", tool_shown(step->from),
            tool_shown(step->to), or_unknown(common_mode_name(step->answer.mode)));
    print_records(to, scene, step);
    if (step->pair_count > 0) {
        fprintf(to, "between    %" PRIu32 " %s of objects\n", step->pair_count,
                proto_plural(step->pair_count, "pair", "pairs"));
        report_print_pairs(to, scene, step);
    }
    report_print_rest(to, scene->build_ms, step);
}

void report_print_line(FILE *to, const struct report_scene *scene, uint32_t number,
                       const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    fprintf(to, "%4" PRIu32 "  %s: %" PRIu64 " (", number, tool_shown(step->to),
            answer->total);
    print_kinds_briefly(to, answer->counts);
    fprintf(to, ", %" PRIu64 " possible)", answer->possible);
    if (answer->toi_first < NO_TOI) {
        fprintf(to, ", first at %s", tool_shown_number(answer->toi_first));
        report_print_place(to, ": ", " meets ", scene, &step->first);
    }
    if (answer->crossings > 0) {
        fprintf(to, ", begins crossed %" PRIu64 " %s", answer->crossings,
                proto_plural(answer->crossings, "time", "times"));
    }
    if (answer->start_inside > 0) {
        fprintf(to, ", begins inside %" PRIu64 " %s", answer->start_inside,
                proto_plural(answer->start_inside, "time", "times"));
    }
    if (answer->entering + answer->sliding + answer->leaving > 0) {
        fprintf(to, ", %" PRIu64 " %s, %" PRIu64 " %s, %" PRIu64 " %s", answer->entering,
                proto_plural(answer->entering, "enters", "enter"), answer->sliding,
                proto_plural(answer->sliding, "slides", "slide"), answer->leaving,
                proto_plural(answer->leaving, "leaves", "leave"));
    }
    if (!step->is_complete) {
        fprintf(to, ", INCOMPLETE: %s", why_incomplete(answer->incomplete));
    }
    if (step->ms[REPORT_step] > 0) { /* of a line that was read it is not known */
        fprintf(to, ", %.3f ms", step->ms[REPORT_step]);
    }
    fputc('\n', to);
}
