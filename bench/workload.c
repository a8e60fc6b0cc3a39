/* workload.c - the scenes that are measured. */
#include "workload.h"

#include <string.h>

#include "families.h"

#define CLOTH_BALL "cloth-ball/frames/cloth_ball"
#define FUNNEL     "cloth-funnel/frames/"
#define N_BODY     "n-body-simulation/frames/balls16_"

static const struct {
    const char *name;
    void (*make)(struct bench_scene *scene, bool small); /* NULL: soup or recorded */
    uint32_t hard_frame; /* of what is made, by counted work: README.md, "Hard frames" */
    bool only_by_name;   /* it takes gigabytes, or says little */
    uint32_t soup;       /* of so many triangles */
    uint32_t steps;      /* of what is recorded; the paper goes in five (section 7), .. */
    const char *frames[2]; /* .. from the first of these to the second */
} catalogue[] = {
    {.name = "cloth-20k", .make = bench_make_cloth_20k, .hard_frame = 140},
    {.name = "cloth", .make = bench_make_cloth, .hard_frame = 150},
    {.name = "crumpled", .make = bench_make_crumpled},
    {.name = "fast-sheet", .make = bench_make_fast},
    {.name = "all-overlap", .make = bench_make_all_overlap},
    {.name = "nothing-moves", .make = bench_make_still},
    {.name = "teleport", .make = bench_make_teleport},
    {.name = "one-triangle", .make = bench_make_one_triangle},
    {.name = "layers-10m", .make = bench_make_layers_10m, .only_by_name = true},
    {.name = "breaking", .make = bench_make_breaking, .hard_frame = 240},
    {.name = "bodies", .make = bench_make_bodies, .hard_frame = 280},
    {.name = "game", .make = bench_make_game, .hard_frame = 100, .only_by_name = true},
    {.name = "exploding", .make = bench_make_exploding, .hard_frame = 10},
    {.name = "cloth-ball",
     .steps = 1,
     .frames = {CLOTH_BALL "92.ply", CLOTH_BALL "93.ply"}},
    {.name = "cloth-ball-fifth",
     .steps = 5,
     .frames = {CLOTH_BALL "92.ply", CLOTH_BALL "93.ply"}},
    {.name = "cloth-funnel", .steps = 1, .frames = {FUNNEL "227.ply", FUNNEL "228.ply"}},
    {.name = "n-body", .steps = 1, .frames = {N_BODY "18.ply", N_BODY "19.ply"}},
    {.name = "n-body-fifth", .steps = 5, .frames = {N_BODY "18.ply", N_BODY "19.ply"}},
    {.name = "points", .make = bench_make_points, .only_by_name = true},
    {.name = "points-self", .make = bench_make_points_self, .only_by_name = true},
    {.name = "hair", .make = bench_make_hair, .only_by_name = true},
    {.name = "soup-16", .soup = 16, .only_by_name = true},
    {.name = "soup-64", .soup = 64, .only_by_name = true},
    {.name = "soup-256", .soup = 256, .only_by_name = true},
    {.name = "soup-1024", .soup = 1024, .only_by_name = true},
    {.name = "soup-4096", .soup = 4096, .only_by_name = true},
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
    if (catalogue[index].soup > 0) {
        bench_make_soup(scene, catalogue[index].soup);
        return true;
    }
    if (catalogue[index].make) {
        catalogue[index].make(scene, small);
        scene->hard_frame = catalogue[index].hard_frame;
        /* A small one may be shorter. */
        while (scene->hard_frame + 1 >= scene->frame_count) {
            scene->hard_frame /= 2;
        }
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
            (catalogue[i].only_by_name && !options->wanted &&
             (!options->smoke || catalogue[i].soup > 0))) {
            continue;
        }
        if (bench_scene_make(i, options->smoke, scene)) {
            return true;
        }
        bench_skip(name, options->smoke ? "too large" : "no frames in $PCCD_DATA");
    }
    return false;
}
