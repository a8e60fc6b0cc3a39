/* watch.c - what a daemon holds over time, and whether that grows. */
#include "watch.h"

#include <math.h>
#include <stdlib.h>

#include "target.h"

#define EVERY_NS 1000000000u
#define WARM_S   60.0
#define WINDOW_S 60.0

void load_watch_begin(struct load_watch *watch)
{
    *watch = (struct load_watch){.begin_ns = common_now_ns()};
    watch->next_ns = watch->begin_ns;
}

void load_watch_deinit(struct load_watch *watch)
{
    free(watch->samples);
}

static bool has_room(struct load_watch *watch)
{
    if (watch->count < watch->capacity) {
        return true;
    }
    size_t capacity = 2 * watch->capacity + 256;
    struct load_sample *samples =
        realloc(watch->samples, capacity * sizeof *watch->samples);
    if (samples) {
        watch->samples = samples;
        watch->capacity = capacity;
    }
    return samples;
}

void load_watch_turn(struct load_watch *watch, const struct load *load)
{
    uint64_t now_ns = common_now_ns();
    if (now_ns < watch->next_ns || !has_room(watch)) {
        return;
    }
    watch->next_ns = now_ns + EVERY_NS;
    pid_t pid = load_target_pid(load);
    struct load_sample sample = {.at_s = (double)(now_ns - watch->begin_ns) * 1e-9,
                                 .pid = pid};
    sample.value[LOAD_MEMORY] = (double)load_target_memory(pid);
    sample.value[LOAD_DESCRIPTORS] = (double)load_target_descriptors(pid);
    sample.value[LOAD_MAPPINGS] = (double)load_target_mappings(pid);
    if (sample.value[LOAD_MEMORY] >= 0 && sample.value[LOAD_DESCRIPTORS] >= 0 &&
        sample.value[LOAD_MAPPINGS] >= 0) { /* else it has been killed meanwhile */
        watch->samples[watch->count++] = sample;
    }
}

/* Sums over the samples of one worker, about their means. */
struct sums {
    size_t count;
    double value; /* the values' plain sum */
    double tt, tv, vv;
};

static struct sums sums_of(const struct load_sample *samples, size_t count,
                           enum load_gauge gauge, double warm_s)
{
    struct sums sums = {0};
    double t = 0;
    for (size_t i = 0; i < count; i++) {
        if (samples[i].at_s - samples[0].at_s >= warm_s) {
            sums.count++;
            sums.value += samples[i].value[gauge];
            t += samples[i].at_s;
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (samples[i].at_s - samples[0].at_s >= warm_s) {
            double dt = samples[i].at_s - t / (double)sums.count;
            double dv = samples[i].value[gauge] - sums.value / (double)sums.count;
            sums.tt += dt * dt;
            sums.tv += dt * dv;
            sums.vv += dv * dv;
        }
    }
    return sums;
}

struct load_slope load_slope_of(const struct load_sample *samples, size_t count,
                                enum load_gauge gauge, double warm_s)
{
    struct sums all = {0};
    size_t workers = 0;
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && samples[end].pid == samples[first].pid;) {
            end++;
        }
        struct sums sums = sums_of(samples + first, end - first, gauge, warm_s);
        workers += sums.count > 0;
        all.count += sums.count;
        all.value += sums.value;
        all.tt += sums.tt;
        all.tv += sums.tv;
        all.vv += sums.vv;
    }
    struct load_slope slope = {.count = all.count};
    if (all.count > workers + 2 && all.tt > 0) {
        double per_s = all.tv / all.tt;
        double rest = fmax(all.vv - per_s * all.tv, 0);
        slope.mean = all.value / (double)all.count;
        slope.per_min = 60 * per_s;
        slope.error = 60 * sqrt(rest / (double)(all.count - workers - 1) / all.tt);
    }
    return slope;
}

static void lower(struct load_sample *floor, const struct load_sample *sample)
{
    for (enum load_gauge gauge = 0; gauge < LOAD_GAUGES; gauge++) {
        floor->value[gauge] = fmin(floor->value[gauge], sample->value[gauge]);
    }
}

size_t load_floors_of(const struct load_sample *samples, size_t count, double window_s,
                      double warm_s, struct load_sample *floors)
{
    size_t floor_count = 0;
    double begin_s = 0; /* of the worker's windows */
    double window = -1; /* the one that floors[floor_count] is of; -1: none */
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || samples[i].pid != samples[i - 1].pid) {
            begin_s = samples[i].at_s + warm_s;
            window = -1;
        }
        double at = floor((samples[i].at_s - begin_s) / window_s);
        if (at == window && at >= 0) {
            lower(&floors[floor_count], &samples[i]);
        } else if (at >= 0) {
            floor_count += window >= 0; /* that one is over */
            floors[floor_count] = samples[i];
            floors[floor_count].at_s = begin_s + (at + 0.5) * window_s;
            window = at;
        }
    }
    return floor_count;
}

struct load_slope load_watch_slope(const struct load_watch *watch, enum load_gauge gauge)
{
    struct load_slope slope = {0};
    struct load_sample *floors = calloc(watch->count + 1, sizeof *floors);
    if (floors) {
        size_t count =
            load_floors_of(watch->samples, watch->count, WINDOW_S, WARM_S, floors);
        slope = load_slope_of(floors, count, gauge, 0);
    }
    free(floors);
    return slope;
}
