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
    uint32_t steps;    /* between the frames; the paper goes in five (section 7) */
    bool only_by_name; /* it takes gigabytes */
} catalogue[] = {
    {"cloth-20k", bench_make_cloth_20k, {NULL, NULL}, 0, false},
    {"cloth", bench_make_cloth, {NULL, NULL}, 0, false},
    {"crumpled", bench_make_crumpled, {NULL, NULL}, 0, false},
    {"fast-sheet", bench_make_fast, {NULL, NULL}, 0, false},
    {"all-overlap", bench_make_all_overlap, {NULL, NULL}, 0, false},
    {"nothing-moves", bench_make_still, {NULL, NULL}, 0, false},
    {"teleport", bench_make_teleport, {NULL, NULL}, 0, false},
    {"one-triangle", bench_make_one_triangle, {NULL, NULL}, 0, false},
    {"layers-10m", bench_make_layers_10m, {NULL, NULL}, 0, true},
    {"breaking", bench_make_breaking, {NULL, NULL}, 0, false},
    {"bodies", bench_make_bodies, {NULL, NULL}, 0, false},
    {"exploding", bench_make_exploding, {NULL, NULL}, 0, false},
    {"cloth-ball", NULL, CLOTH_BALL, 1, false},
    {"cloth-ball-fifth", NULL, CLOTH_BALL, 5, false},
    {"cloth-funnel",
     NULL,
     {"cloth-funnel/frames/227.ply", "cloth-funnel/frames/228.ply"},
     1,
     false},
    {"n-body", NULL, N_BODY, 1, false},
    {"n-body-fifth", NULL, N_BODY, 5, false},
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
        if (!bench_is_wanted(options, name) || (names && !is_listed(names, name)) ||
            (catalogue[i].only_by_name && !options->wanted && !options->smoke)) {
            continue;
        }
        if (bench_scene_make(i, options->smoke, scene)) {
            return true;
        }
        bench_skip(name, options->smoke ? "too large" : "no frames in $PCCD_DATA");
    }
    return false;
}
