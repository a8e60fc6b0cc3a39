/* crossings.c - which edges pass through which faces, frame by frame. */
#include "judge.h"

#include <stdlib.h>
#include <string.h>

#include "array.h"

struct asking {
    const struct check_run *run;
    const struct pccd_motion *motions;
    uint32_t motion_count;
    struct crossings *to;
    bool has_memory;
};

struct pccd_near_settings crossings_question(const struct pccd_step_settings *step)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = PCCD_NEAR_CROSSINGS;
    settings.threads = step->threads;
    settings.method = step->method;
    settings.deadline_ns = step->deadline_ns;
    if (step->tuning != NULL) {
        strncpy(settings.tuning, step->tuning, sizeof settings.tuning - 1);
    }
    return settings;
}

static int ask_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct asking *asking = context;
    const struct pccd_near_settings settings = crossings_question(&asking->run->settings);
    (void)is_again;
    return pccd_ask_near(asking->run->client, asking->run->scene, asking->motions,
                         asking->motion_count, &settings, answer);
}

bool crossings_take(struct crossings *to, const struct pccd_answer *page)
{
    for (uint64_t i = 0; i < page->count && page->near != NULL; i++) {
        const struct pccd_near *near = &page->near[i];
        void *of = to->of;
        if (near->kind != PCCD_EF) {
            continue; /* they touch */
        }
        if (!array_reserve(&of, to->count, &to->room, sizeof *to->of)) {
            return false;
        }
        to->of = of;
        to->of[to->count++] = (struct crossing){near->object_a, near->feature_a,
                                                near->object_b, near->feature_b};
    }
    return true;
}

static void take_page(void *context, const struct pccd_answer *page)
{
    struct asking *asking = context;
    asking->has_memory = asking->has_memory && crossings_take(asking->to, page);
}

static int compare(const void *a, const void *b)
{
    const struct crossing *left = a, *right = b;
    return left->object_a != right->object_a ? (left->object_a < right->object_a ? -1 : 1)
           : left->edge != right->edge       ? (left->edge < right->edge ? -1 : 1)
           : left->object_b != right->object_b
               ? (left->object_b < right->object_b ? -1 : 1)
           : left->face != right->face ? (left->face < right->face ? -1 : 1)
                                       : 0;
}

void crossings_sort(struct crossings *crossings)
{
    size_t kept = 0;
    if (crossings->count > 0) {
        qsort(crossings->of, crossings->count, sizeof *crossings->of, compare);
    }
    for (size_t i = 0; i < crossings->count; i++) {
        if (kept == 0 || compare(&crossings->of[kept - 1], &crossings->of[i]) != 0) {
            crossings->of[kept++] = crossings->of[i];
        }
    }
    crossings->count = kept;
}

int crossings_ask(struct crossings *crossings, const struct check_run *run,
                  const struct pccd_motion *motions, uint32_t motion_count,
                  struct ctl_error *error)
{
    struct check_run once = *run;
    struct report_step step = {.repeats = 0};
    struct asking asking = {run, motions, motion_count, crossings, true};
    const struct check_ask ask = {.once = ask_once,
                                  .page = take_page,
                                  .failed = "what crosses was not told",
                                  .context = &asking};
    once.repeats = 0;
    once.progress = NULL;
    crossings->count = 0;
    int status = check_run_repeat(&once, &ask, 1, &step, error);
    if (status == PCCD_OK && !asking.has_memory) {
        status = ctl_error_set(error, PCCD_E_NOMEM, "no memory for what crosses");
    }
    crossings_sort(crossings);
    crossings->is_complete = status == PCCD_OK && step.is_complete;
    crossings->ms = step.ms[REPORT_step];
    return status;
}

int crossings_copy(struct crossings *to, const struct crossings *from,
                   struct ctl_error *error)
{
    struct crossing *of = malloc((from->count + 1) * sizeof *of);
    if (of == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what crosses");
    }
    if (from->count > 0) {
        memcpy(of, from->of, from->count * sizeof *of);
    }
    free(to->of);
    *to = *from;
    to->of = of;
    to->room = from->count;
    return PCCD_OK;
}

/* Return whether there is such a crossing from *at on, where those that are less end. */
static bool has(const struct crossings *crossings, const struct crossing *crossing,
                size_t *at)
{
    int order = -1;
    while (*at < crossings->count &&
           (order = compare(&crossings->of[*at], crossing)) < 0) {
        (*at)++;
    }
    return order == 0;
}

uint64_t crossings_beyond(const struct crossings *a, const struct crossings *b,
                          const struct crossings *c)
{
    uint64_t count = 0;
    size_t in_b = 0, in_c = 0;
    for (size_t i = 0; i < a->count; i++) {
        count += !has(b, &a->of[i], &in_b) && !has(c, &a->of[i], &in_c);
    }
    return count;
}

void crossings_deinit(struct crossings *crossings)
{
    free(crossings->of);
    *crossings = (struct crossings){.of = NULL};
}

/* ---- where steps begin and end ----------------------------------------------------- */

/* Say how the step begins, which is known from the frame before. */
static void set_begin(const struct crossings *begin, struct pccd_answer *answer)
{
    answer->crossings = begin->count;
    if (answer->crossings > 0) {
        answer->safe_step = 0;
        if (answer->verdict == PCCD_VERDICT_NO) {
            answer->verdict = PCCD_VERDICT_YES;
        }
    }
}

/* All that meets in the step is known: what crosses at its end is beside that, or crossed
 * at its begin. What slides may go on to cross, and was left out. */
bool judge_ends_follow(const struct judge_ends *ends, enum pccd_mode mode,
                       const struct report_step *step)
{
    return !ends->leaves_out && step->is_complete && ends->end.is_complete &&
           ((!report_meets(step) && ends->end.count == 0) ||
            (ends->follow.scene != NULL && mode == PCCD_MODE_ALL &&
             ends->follow.is_whole && step->answer.total <= FOLLOW_CONTACTS_MAX));
}

int judge_ends_look(struct judge_ends *ends, const struct check_run *run, uint32_t number,
                    struct report_step *step, struct ctl_error *error)
{
    static const struct crossings none;
    const bool follows = judge_ends_follow(ends, run->settings.mode, step);
    const struct crossings spare = ends->begin;
    int status;
    ends->begin = ends->end;
    ends->end = spare;
    set_begin(&ends->begin, &step->answer);
    if (follows) {
        status =
            follow_crossings(&ends->follow, run, number, &ends->begin, &ends->end, error);
    } else {
        status = ends->ask(ends->context, &ends->end, error);
        step->ms[REPORT_step] += ends->end.ms;
    }
    step->is_complete =
        step->is_complete && ends->begin.is_complete && ends->end.is_complete;
    step->ends = (struct report_ends){
        .is_known = true,
        .crossings = ends->end.count,
        .standing = ends->end.count - crossings_beyond(&ends->end, &ends->first, &none),
        .fresh = crossings_beyond(&ends->end, &ends->first, &ends->begin),
        .gone = crossings_beyond(&ends->begin, &ends->end, &none)};
    return status;
}

void judge_ends_deinit(struct judge_ends *ends)
{
    crossings_deinit(&ends->first);
    crossings_deinit(&ends->begin);
    crossings_deinit(&ends->end);
    follow_deinit(&ends->follow);
}
