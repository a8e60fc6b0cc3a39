/* setup.c - under what a measurement was made. */
#include "output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "names.h"
#include "report.h"

/* The first line of a file; "unknown" without one. */
static void read_line(const char *path, char *line, size_t bytes)
{
    FILE *file = fopen(path, "r");
    (void)snprintf(line, bytes, "unknown");
    if (file && fgets(line, (int)bytes, file)) {
        line[strcspn(line, "\n")] = '\0';
    }
    if (file) {
        fclose(file);
    }
}

static void each_of_build(run_item_fn each, void *context)
{
    each(context, "program", "pccd-bench", 0);
    each(context, "version", PACKAGE_VERSION, 0);
    each(context, "commit", run_commit, 0);
    each(context, "compiler", bench_compiler(), 0);
    each(context, "flags", BENCH_FLAGS, 0);
}

static void each_of_machine(run_item_fn each, void *context)
{
    char line[256];
    const char *spin = getenv("GOMP_SPINCOUNT");
    each(context, "cpu", bench_cpu(), 0);
    each(context, "processors", NULL, (uint64_t)sysconf(_SC_NPROCESSORS_ONLN));
    read_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", line, sizeof line);
    each(context, "governor", line, 0);
    read_line("/proc/sys/kernel/osrelease", line, sizeof line);
    each(context, "kernel", line, 0);
    each(context, "gomp_spincount", spin ? spin : "unset", 0);
}

static void each_of_scene(const struct run_play *play, run_item_fn each, void *context)
{
    const struct bench_scene *scene = play->source;
    each(context, "scene", scene->name, 0);
    each(context, "size", play->settings->is_small ? "small" : "full", 0);
    each(context, "objects", NULL, scene->object_count);
    each(context, "vertices", NULL, scene->vertex_count);
    each(context, "triangles", NULL, bench_scene_triangles(scene));
}

static void each_of_settings(const struct run_play *play, run_item_fn each, void *context)
{
    const struct run_settings *settings = play->settings;
    const struct run_side *side = &settings->sides[0];
    const struct pccd_step_settings *step = &side->step;
    each(context, "via", run_via_name(side->via), 0);
    each(context, "mode", common_mode_name(step->mode), 0);
    each(context, "method", play->sides[0].method, 0);
    each(context, "tuning", step->tuning != NULL ? step->tuning : "", 0);
    each(context, "simd", play->sides[0].cpu, 0);
    each(context, "threads", NULL, step->threads);
    each(context, "first", NULL, settings->first);
    each(context, "last", NULL, settings->last);
    each(context, "warm_up", NULL, settings->warm_up);
    each(context, "repeat", NULL, settings->repeat);
    each(context, "kept", "least", 0);
}

void run_setup_each(const struct run_play *play, run_item_fn each, void *context)
{
    each_of_build(each, context);
    each_of_machine(each, context);
    each_of_scene(play, each, context);
    each_of_settings(play, each, context);
    each(context, "input", play->input, 0);
    each(context, "hash", play->hash, 0);
}
