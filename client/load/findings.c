/* findings.c - judges whether all is as it must be. */
#include <string.h>

#include "report.h"

/* A slope that is not noise, and that would add up to so much over the run, is growth. */
#define ERRORS_SURE   4.0
#define GROWTH_KIB    512.0
#define GROWTH_PIECES 8.0

/* The memory that a worker may hold more at its end for each client, without any, than
 * one that has served them one by one. A full house of fifty leaves 0.7 to 0.9 MiB; with
 * a leak of 27 KiB a minute it is 2.2 after 20 minutes: what leaks keeps pages that are
 * free else. */
#define IDLE_KIB 26

bool load_holdings_equal(const struct load_holdings *a, const struct load_holdings *b)
{
    bool equal = a->count == b->count;
    for (uint32_t i = 0; equal && i < a->count; i++) {
        equal = strcmp(a->name[i], b->name[i]) == 0 && a->value[i] == b->value[i];
    }
    return equal;
}

static void judge_counts(struct load_findings *f)
{
    const struct load_tally *crowd = &f->crowd;
    const struct load_tally *victims = &f->victims;
    f->adds_up = crowd->submitted == crowd->answered + crowd->refused + crowd->cancelled +
                                         crowd->failed + crowd->lost &&
                 crowd->measured == crowd->latency.count;
    f->is_right = crowd->failed + crowd->lost + crowd->doubled + crowd->crossed +
                          crowd->wrong + crowd->broken ==
                      0 &&
                  victims->doubled + victims->crossed + victims->wrong == 0;
}

static uint64_t checksum_of(const struct load *load)
{
    uint64_t sum = 0;
    for (uint64_t i = 0; i < load->settings.clients * LOAD_ORDERS * LOAD_FRAMES; i++) {
        const struct load_truth *truth = &load->shared->truth[i];
        sum = load_mix(load_mix(sum ^ truth->hash[0], truth->hash[1]), truth->sum);
    }
    return sum;
}

/* Judge the memory: what no client holds any more is free or leaked. */
static void judge_memory(struct load_findings *f, const struct load_watch *watch)
{
    const struct load_settings *settings = &f->load->settings;
    f->is_flat = true;
    for (enum load_gauge gauge = 0; gauge < LOAD_GAUGES; gauge++) {
        struct load_slope slope = load_watch_slope(watch, gauge);
        double growth = slope.per_min * f->outcome->seconds / 60;
        f->slopes[gauge] = slope;
        f->grows[gauge] = slope.per_min > ERRORS_SURE * slope.error &&
                          growth > (gauge == LOAD_MEMORY ? GROWTH_KIB : GROWTH_PIECES);
        f->is_flat =
            f->is_flat && !f->grows[gauge] && slope.count >= LOAD_WATCH_FLOORS_MIN;
    }
    int64_t before = f->outcome->idle_before_kib;
    int64_t after = f->outcome->idle_after_kib;
    f->idle_limit_kib = before + (int64_t)IDLE_KIB * settings->clients;
    f->is_little = before > 0 && after > 0 && after <= f->idle_limit_kib;
    f->is_flat = (f->is_flat && f->is_little) || !settings->flat;
}

/* Return whether answers were quick; what was never asked is later than any answer. */
static bool is_quick(const struct load_tally *crowd, double p99_ms)
{
    double due = (double)(crowd->measured + crowd->unsent);
    double share = crowd->measured > 0 ? 0.99 * due / (double)crowd->measured : 2;
    return share <= 1 &&
           (double)load_hist_quantile(&crowd->latency, share) <= 1e6 * p99_ms;
}

void load_find(struct load_findings *f, const struct load *load,
               const struct load_outcome *outcome, const struct load_assault *assault,
               const struct load_watch *watch)
{
    const struct load_settings *settings = &load->settings;
    memset(f, 0, sizeof *f);
    f->load = load;
    f->outcome = outcome;
    f->assault = assault;
    for (uint32_t i = 0; i < settings->processes; i++) {
        load_tally_add(&f->crowd, &load->shared->crowd[i]);
    }
    for (uint32_t i = 0; i < settings->victims; i++) {
        load_tally_add(&f->victims, &load->shared->victims[i]);
    }
    f->checksum = checksum_of(load);
    f->measured_s = outcome->seconds - settings->ramp_s - settings->warm_up_s;
    f->is_back = load_holdings_equal(&outcome->before, &outcome->after);
    f->is_quick = settings->p99_ms <= 0 || is_quick(&f->crowd, settings->p99_ms);
    judge_counts(f);
    judge_memory(f, watch);
    /* A round without contacts would prove little, where there should be some. */
    bool is_telling = atomic_load(&load->shared->truth_records) > settings->clients ||
                      settings->scene == LOAD_SCENE_apart || settings->mode >= 0;
    f->is_good = f->adds_up && f->is_right && f->is_back && f->is_flat && f->is_quick &&
                 is_telling && outcome->ended && outcome->bad_processes == 0 &&
                 assault->strays == 0 && !atomic_load(&load->shared->failed);
}
