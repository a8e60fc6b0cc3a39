/* bench/workload.c - the scenes that are measured.
 *
 * Room:     bench.
 * Does:     list them; scenes/ makes them.
 * Threads:  one.
 */
#include "workload.h"

#include <string.h>

#include "families.h"

#define CLOTH_BALL                                                                       \
    {                                                                                    \
        "cloth-ball/frames/cloth_ball92.ply", "cloth-ball/frames/cloth_ball93.ply"       \
    }
#define N_BODY                                                                           \
    {                                                                                    \
        "n-body-simulation/frames/balls16_18.ply",                                       \
            "n-body-simulation/frames/balls16_19.ply"                                    \
    }

static const struct {
    const char *name;
    void (*make)(struct bench_scene *scene, bool small); /* NULL: recorded */
    const char *frames[2];
    uint32_t steps; /* between the frames; the paper goes in five (section 7) */
} catalogue[] = {
    {"cloth-20k", bench_make_cloth_20k, {NULL, NULL}, 0},
    {"cloth-100k", bench_make_cloth_100k, {NULL, NULL}, 0},
    {"crumpled", bench_make_crumpled, {NULL, NULL}, 0},
    {"fast-sheet", bench_make_fast, {NULL, NULL}, 0},
    {"all-overlap", bench_make_all_overlap, {NULL, NULL}, 0},
    {"nothing-moves", bench_make_still, {NULL, NULL}, 0},
    {"teleport", bench_make_teleport, {NULL, NULL}, 0},
    {"breaking", bench_make_breaking, {NULL, NULL}, 0},
    {"bodies", bench_make_bodies, {NULL, NULL}, 0},
    {"exploding", bench_make_exploding, {NULL, NULL}, 0},
    {"cloth-ball", NULL, CLOTH_BALL, 1},
    {"cloth-ball-fifth", NULL, CLOTH_BALL, 5},
    {"cloth-funnel",
     NULL,
     {"cloth-funnel/frames/227.ply", "cloth-funnel/frames/228.ply"},
     1},
    {"n-body", NULL, N_BODY, 1},
    {"n-body-fifth", NULL, N_BODY, 5},
};

unsigned bench_scene_total(void)
{
    return sizeof catalogue / sizeof catalogue[0];
}

const char *bench_scene_name(unsigned index)
{
    return catalogue[index].name;
}

bool bench_scene_make(unsigned index, bool small, struct bench_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->name = catalogue[index].name;
    if (catalogue[index].make) {
        catalogue[index].make(scene, small);
        return true;
    }
    return !small &&
           bench_read_recorded(scene, catalogue[index].frames, catalogue[index].steps);
}

static bool is_listed(const char *const *names, const char *name)
{
    while (*names && strcmp(*names, name) != 0) {
        names++;
    }
    return *names != NULL;
}

bool bench_next_scene(const struct bench_options *options, const char *const *names,
                      unsigned *index, struct bench_scene *scene)
{
    while (*index < bench_scene_total()) {
        unsigned i = (*index)++;
        const char *name = bench_scene_name(i);
        if (!bench_is_wanted(options, name) || (names && !is_listed(names, name))) {
            continue;
        }
        if (bench_scene_make(i, options->smoke, scene)) {
            return true;
        }
        bench_skip(name, options->smoke ? "too large" : "no frames in $PCCD_DATA");
    }
    return false;
}
