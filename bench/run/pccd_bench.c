/* pccd_bench.c - pccd-bench: the steps of a scene in one or more ways, or a section. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"
#include "output.h"
#include "resident.h"
#include "sections.h"
#include "workload.h"

enum { EXIT_DIFFERENT = 1, EXIT_CANNOT = 2, EXIT_SKIPPED = 77 };

static int fail(const char *what, const char *name, const char *why)
{
    fprintf(stderr, "pccd-bench: %s: \"%s\" %s\n", what, name, why);
    return EXIT_CANNOT;
}

static int print_list(void)
{
    for (unsigned i = 0; i < bench_scene_total(); i++) {
        puts(bench_scene_name(i));
    }
    return 0;
}

/* The first side whose instruction set is none of this processor or build; NULL: all are
 * there. */
static const struct run_side *missing_cpu(const struct run_settings *settings)
{
    for (uint32_t i = 0; i < settings->side_count; i++) {
        if (settings->sides[i].cpu && !eng_kernels_named(settings->sides[i].cpu)) {
            return &settings->sides[i];
        }
    }
    return NULL;
}

/* Rods, points and radii are the engine's alone here. */
static bool is_of_triangles(const struct bench_scene *scene)
{
    bool good = true;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        good = good && scene->objects[i].radius == 0;
    }
    return good;
}

static int write_out(FILE *to, const struct run_play *play)
{
    static bool (*const writers[RUN_FORMATS])(FILE *, const struct run_play *) = {
        [RUN_TEXT] = run_write_text,
        [RUN_CSV] = run_write_csv,
        [RUN_JSON] = run_write_json,
    };
    const char *path = play->settings->path;
    bool is_written = writers[play->settings->format](to, play);
    is_written = fflush(to) == 0 && is_written;
    if (!is_written) {
        return fail("--output", path ? path : "-", "cannot be written");
    }
    return 0;
}

static int run(struct run_settings *settings, struct bench_scene *scene)
{
    struct run_play play;
    char steps[64];
    if (!run_settings_fit(settings, scene->frame_count - 1, scene->hard_frame)) {
        (void)snprintf(steps, sizeof steps, "%u-%u", settings->first, settings->last);
        fprintf(stderr, "pccd-bench: --frames: \"%s\": %s has steps 0-%u\n", steps,
                scene->name, scene->frame_count - 2);
        return EXIT_CANNOT;
    }
    for (uint32_t i = 0; i < settings->side_count; i++) {
        if (settings->sides[i].via != RUN_VIA_ENGINE && !is_of_triangles(scene)) {
            return fail("--via", run_via_name(settings->sides[i].via),
                        "does not play a scene of points or rods");
        }
    }
    FILE *to = settings->path ? fopen(settings->path, "w") : stdout;
    if (!to) {
        return fail("--output", settings->path, "cannot be opened");
    }
    bool is_good = run_play(&play, settings, scene);
    int status = is_good ? write_out(to, &play) : EXIT_DIFFERENT;
    run_play_deinit(&play);
    if (settings->path && fclose(to) != 0) {
        status = fail("--output", settings->path, "cannot be written");
    }
    return status;
}

/* ---- what is measured beside steps ------------------------------------------------- */

static const struct part {
    const char *section;
    const char *name;
    int (*measure)(const struct section_options *options);
    const struct option_row *options; /* of its own; NULL: none */
} parts[] = {
    {"kernel", "roofline", section_roofline, NULL},
    {"pair", "exact", section_exact, NULL},
    {"pair", "distances", section_distances, NULL},
    {"client", "batch", section_batch, NULL},
    {"client", "connect", section_connect, NULL},
    {"client", "death", section_death, section_death_rows},
    {"client", "ipc", section_ipc, NULL},
    {"client", "late", section_late, NULL},
};

static int measure_part(const struct part *part, int argc, char **argv)
{
    struct section_options options = {.clients = 0};
    bench_begin(part->name, part->options, argc, argv, &options.bench);
    int status = part->measure(&options);
    return bench_end() != 0 ? EXIT_DIFFERENT : status;
}

static const struct part *part_named(const char *section, const char *name)
{
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (strcmp(section, parts[i].section) == 0 && strcmp(name, parts[i].name) == 0) {
            return &parts[i];
        }
    }
    return NULL;
}

/* All parts of the section argv[1], or the one that argv[2] names, with the options that
 * follow. False: there is no such section. */
static bool measure_section(int argc, char **argv, int *status)
{
    const struct part *part = argc > 2 ? part_named(argv[1], argv[2]) : NULL;
    bool is_known = part != NULL;
    if (part) {
        *status = measure_part(part, argc - 2, argv + 2);
    }
    for (size_t i = 0; !part && argc > 1 && i < sizeof parts / sizeof parts[0]; i++) {
        if (strcmp(argv[1], parts[i].section) == 0) {
            int one = measure_part(&parts[i], argc - 1, argv + 1);
            *status = one == EXIT_SKIPPED || *status != 0 ? *status : one;
            is_known = true;
        }
    }
    return is_known;
}

int main(int argc, char **argv)
{
    static struct run_settings settings; /* for as long as the program runs */
    struct bench_scene scene;
    unsigned index = 0;
    int section_status = 0;
    bench_team_environment(argv);
    if (measure_section(argc, argv, &section_status)) {
        return section_status;
    }
    run_settings_read(&settings, argc, argv);
    if (settings.wants_list) {
        return print_list();
    }
    while (index < bench_scene_total() &&
           strcmp(bench_scene_name(index), settings.scene) != 0) {
        index++;
    }
    if (index == bench_scene_total()) {
        return fail("SCENE", settings.scene, "is not known; see --list");
    }
    const struct run_side *missing = missing_cpu(&settings);
    if (missing) {
        return fail("--cpu", missing->cpu, "is none of this processor, or of this build");
    }
    bench_name("pccd-bench");
    if (!bench_scene_make(index, settings.is_small, &scene)) {
        (void)fail("SCENE", settings.scene,
                   settings.is_small ? "is recorded: there is no small one"
                                     : "is recorded: its frames are not in $PCCD_DATA");
        return EXIT_SKIPPED;
    }
    int status = run(&settings, &scene);
    bench_scene_free(&scene);
    return status;
}
