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

static int ask_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct asking *asking = context;
    const struct pccd_step_settings *step = &asking->run->settings;
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    (void)is_again;
    settings.what = PCCD_NEAR_CROSSINGS;
    settings.threads = step->threads;
    settings.method = step->method;
    settings.deadline_ns = step->deadline_ns;
    if (step->tuning != NULL) {
        strncpy(settings.tuning, step->tuning, sizeof settings.tuning - 1);
    }
    return pccd_ask_near(asking->run->client, asking->run->scene, asking->motions,
                         asking->motion_count, &settings, answer);
}

static void take_page(void *context, const struct pccd_answer *page)
{
    struct asking *asking = context;
    struct crossings *to = asking->to;
    for (uint64_t i = 0; i < page->count && page->near != NULL; i++) {
        const struct pccd_near *near = &page->near[i];
        void *of = to->of;
        if (near->kind != PCCD_EF) {
            continue; /* they touch */
        }
        if (!array_reserve(&of, to->count, &to->room, sizeof *to->of)) {
            asking->has_memory = false;
            return;
        }
        to->of = of;
        to->of[to->count++] = (struct crossing){near->object_a, near->feature_a,
                                                near->object_b, near->feature_b};
    }
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

static bool has(const struct crossings *crossings, const struct crossing *crossing)
{
    return crossings->count > 0 && bsearch(crossing, crossings->of, crossings->count,
                                           sizeof *crossing, compare) != NULL;
}

uint64_t crossings_beyond(const struct crossings *a, const struct crossings *b,
                          const struct crossings *c)
{
    uint64_t count = 0;
    for (size_t i = 0; i < a->count; i++) {
        count += !has(b, &a->of[i]) && !has(c, &a->of[i]);
    }
    return count;
}

void crossings_deinit(struct crossings *crossings)
{
    free(crossings->of);
    *crossings = (struct crossings){.of = NULL};
}
