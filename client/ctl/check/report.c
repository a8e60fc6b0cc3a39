/* client/ctl/check/report.c - what `pccdctl check` says.
 *
 * Room:     client/ctl.
 * Does:     the text form; see report_json.c for the other.
 * Does not: compute anything but shares and sums.
 * Threads:  one.
 * Source:   report.h.
 */
#include "report.h"

#include <inttypes.h>

#include "plural.h"
#include "shown.h"

#define NO_TOI 1.5 /* above any time; the daemon says 2 when there is no record */

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

const char *report_mode_name(enum pccd_mode mode)
{
    static const char *const names[PCCD_MODE_COUNT] = {"all", "first", "any", "pairs"};
    return (uint32_t)mode < PCCD_MODE_COUNT ? names[mode] : NULL;
}

const char *report_method_name(enum pccd_method method)
{
    static const char *const names[PCCD_METHOD_COUNT] = {"default", "paper", "wide"};
    return (uint32_t)method < PCCD_METHOD_COUNT ? names[method] : NULL;
}

const char *report_scheduler_name(enum pccd_scheduler scheduler)
{
    static const char *const names[PCCD_SCHEDULER_COUNT] = {"default", "steal", "paper"};
    return (uint32_t)scheduler < PCCD_SCHEDULER_COUNT ? names[scheduler] : NULL;
}

const char *report_high_level_name(enum pccd_high_level high_level)
{
    static const char *const names[PCCD_HIGH_LEVEL_COUNT] = {"default", "round-robin",
                                                             "disjoint"};
    return (uint32_t)high_level < PCCD_HIGH_LEVEL_COUNT ? names[high_level] : NULL;
}

const char *report_refit_name(enum pccd_refit refit)
{
    static const char *const names[PCCD_REFIT_COUNT] = {"default", "even", "paper"};
    return (uint32_t)refit < PCCD_REFIT_COUNT ? names[refit] : NULL;
}

const char *report_quality_name(enum pccd_quality quality)
{
    static const char *const names[PCCD_QUALITY_COUNT] = {"default", "median", "sah"};
    return (uint32_t)quality < PCCD_QUALITY_COUNT ? names[quality] : NULL;
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
    }
    return "records are missing";
}

static void print_trees(FILE *to, const struct pccd_scene_settings *settings)
{
    fprintf(to, "trees      quality %s, ",
            or_unknown(report_quality_name(settings->quality)));
    if (settings->rebuild_ratio < 0) {
        fputs("never rebuilt\n", to);
    } else if (settings->rebuild_ratio > 0) {
        fprintf(to, "rebuild ratio %g\n", settings->rebuild_ratio);
    } else {
        fputs("rebuild ratio default\n", to);
    }
}

void report_print_mesh(FILE *to, const struct report_mesh *mesh)
{
    const struct pccd_mesh_info *info = &mesh->info;
    fputs("mesh       ", to);
    print_count(to, info->vertex_count, "vertex", "vertices");
    fputs(", ", to);
    print_count(to, info->edge_count, "edge", "edges");
    fputs(", ", to);
    print_count(to, info->triangle_count, "triangle", "triangles");
    fputc('\n', to);
    if (info->duplicate_count + info->degenerate_count + info->isolated_count == 0) {
        print_trees(to, &mesh->settings);
        return;
    }
    fputs("           of these ", to);
    print_count(to, info->duplicate_count, "duplicate triangle", "duplicate triangles");
    fputs(", ", to);
    print_count(to, info->degenerate_count, "of zero area", "of zero area");
    fputs(", ", to);
    print_count(to, info->isolated_count, "unused vertex", "unused vertices");
    fputc('\n', to);
    print_trees(to, &mesh->settings);
}

static void print_records(FILE *to, const struct pccd_answer *answer)
{
    static const char *const verdicts[] = {"no", "possible", "yes", "undecided"};
    if (answer->mode == PCCD_MODE_ANY) {
        uint32_t verdict = (uint32_t)answer->verdict;
        fprintf(to, "contact    %s\n", verdict < 4 ? verdicts[verdict] : "unknown");
        return;
    }
    if (answer->mode == PCCD_MODE_PAIRS) {
        fprintf(to,
                "pairs      %" PRIu64 ": %" PRIu64 " vertex-face, %" PRIu64
                " edge-edge\n",
                answer->total, answer->vf, answer->ee);
        return;
    }
    fprintf(to,
            "contacts   %" PRIu64 ": %" PRIu64 " vertex-face, %" PRIu64 " edge-edge\n",
            answer->total, answer->vf, answer->ee);
    fprintf(to,
            "           %" PRIu64 " proved, %" PRIu64 " possible; %" PRIu64
            " touch at the start\n",
            answer->total - answer->possible, answer->possible, answer->initial);
    if (answer->toi_first < NO_TOI) {
        fprintf(to, "first at   t = %.17g\n", answer->toi_first);
    } else {
        fputs("first at   never\n", to);
    }
}

/* How the threads shared the work. */
static void print_sharing(FILE *to, const struct pccd_answer *answer)
{
    fprintf(to, "; method %s, %" PRIu32 " %s",
            or_unknown(report_method_name(answer->method)), answer->threads,
            proto_plural(answer->threads, "thread", "threads"));
    if (answer->scheduler != PCCD_SCHEDULER_DEFAULT) {
        fprintf(to, ", scheduler %s",
                or_unknown(report_scheduler_name(answer->scheduler)));
    }
    if (answer->high_level != PCCD_HIGH_LEVEL_DEFAULT) {
        fprintf(to, ", high level %s",
                or_unknown(report_high_level_name(answer->high_level)));
    }
    if (answer->refit != PCCD_REFIT_DEFAULT) {
        fprintf(to, ", refit %s", or_unknown(report_refit_name(answer->refit)));
    }
    fputc('\n', to);
}

/* The last phases only where there is something to tell. */
static bool is_told(uint32_t phase, const struct report_step *step)
{
    const struct pccd_step_counters *counters = &step->answer.counters;
    if (phase == REPORT_low || phase == REPORT_high) {
        return step->answer.scheduler == PCCD_SCHEDULER_PAPER;
    }
    return phase != REPORT_rebuild || counters->rebuilds + counters->swaps > 0 ||
           step->ms[phase] > 0;
}

static void print_times(FILE *to, const struct report_mesh *mesh,
                        const struct report_step *step)
{
    if (step->repeats > 0) {
        fprintf(to, "time       median of %" PRIu32 " after one to warm up (%.3f ms)",
                step->repeats, step->first_ms);
    } else {
        fputs("time       first run", to);
    }
    print_sharing(to, &step->answer);
    fprintf(to, "  %-10s %12.3f ms   once\n", "build", mesh->build_ms);
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

void report_print_step(FILE *to, const struct report_mesh *mesh,
                       const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    const struct pccd_step_counters *counters = &answer->counters;
    fprintf(to, "step       %s -> %s, mode %s\n", tool_shown(step->from),
            tool_shown(step->to), or_unknown(report_mode_name(answer->mode)));
    print_records(to, answer);
    if (step->is_complete) {
        fputs("answer     complete\n", to);
    } else {
        fprintf(to, "answer     INCOMPLETE: %s\n", why_incomplete(answer->incomplete));
    }
    fprintf(to, "hash       %016" PRIx64 "%016" PRIx64 "\n", answer->hash[0],
            answer->hash[1]);
    fprintf(to,
            "work       %" PRIu64 " box %s, %" PRIu64 " %s (%" PRIu64 " vf, %" PRIu64
            " ee), %" PRIu64 " past the filter, %" PRIu64 " exact\n",
            counters->box_tests, proto_plural(counters->box_tests, "test", "tests"),
            counters->candidates_vf + counters->candidates_ee,
            proto_plural(counters->candidates_vf + counters->candidates_ee, "candidate",
                         "candidates"),
            counters->candidates_vf, counters->candidates_ee, counters->survivors,
            counters->exact);
    if (counters->rebuilds + counters->swaps > 0) {
        fprintf(to,
                "rebuilt    %" PRIu64 " %s (%" PRIu64 " %s), %" PRIu64
                " built aside (%" PRIu64 ")\n",
                counters->rebuilds,
                proto_plural(counters->rebuilds, "subtree", "subtrees"),
                counters->rebuilt_triangles,
                proto_plural(counters->rebuilt_triangles, "triangle", "triangles"),
                counters->swaps, counters->swapped_triangles);
    }
    print_times(to, mesh, step);
}

void report_print_line(FILE *to, uint32_t number, const struct report_step *step)
{
    const struct pccd_answer *answer = &step->answer;
    fprintf(to,
            "%4" PRIu32 "  %s: %" PRIu64 " (%" PRIu64 " vf, %" PRIu64 " ee, %" PRIu64
            " possible)",
            number, tool_shown(step->to), answer->total, answer->vf, answer->ee,
            answer->possible);
    if (answer->toi_first < NO_TOI) {
        fprintf(to, ", first at %.9g", answer->toi_first);
    }
    if (!step->is_complete) {
        fprintf(to, ", INCOMPLETE: %s", why_incomplete(answer->incomplete));
    }
    fprintf(to, ", %.3f ms\n", step->ms[REPORT_step]);
}
