/* bench/workload.c - the scenes that are measured.
 *
 * Room:     bench.
 * Does:     list them; scenes/ makes them.
 * Threads:  one.
 */
#include "workload.h"

#include <string.h>

#include "families.h"

static const struct {
    const char *name;
    void (*make)(struct bench_scene *scene, bool small); /* NULL: recorded */
    const char *frames[2];
} catalogue[] = {
    {"cloth-20k", bench_make_cloth_20k, {NULL, NULL}},
    {"cloth-100k", bench_make_cloth_100k, {NULL, NULL}},
    {"crumpled", bench_make_crumpled, {NULL, NULL}},
    {"fast-sheet", bench_make_fast, {NULL, NULL}},
    {"all-overlap", bench_make_all_overlap, {NULL, NULL}},
    {"nothing-moves", bench_make_still, {NULL, NULL}},
    {"teleport", bench_make_teleport, {NULL, NULL}},
    {"breaking", bench_make_breaking, {NULL, NULL}},
    {"bodies", bench_make_bodies, {NULL, NULL}},
    {"exploding", bench_make_exploding, {NULL, NULL}},
    {"cloth-ball",
     NULL,
     {"cloth-ball/frames/cloth_ball92.ply", "cloth-ball/frames/cloth_ball93.ply"}},
    {"cloth-funnel",
     NULL,
     {"cloth-funnel/frames/227.ply", "cloth-funnel/frames/228.ply"}},
    {"n-body",
     NULL,
     {"n-body-simulation/frames/balls16_18.ply",
      "n-body-simulation/frames/balls16_19.ply"}},
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
    return !small && bench_read_recorded(scene, catalogue[index].frames);
}
