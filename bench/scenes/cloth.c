/* cloth.c - a cloth that falls over a ball, which spins and winds it up.
 *
 * Source: the cloth of paper section 7: 92 000 triangles, 465 steps.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "families.h"
#include "surface.h"
#include "tumble.h"

#define STEPS       465u
#define STEPS_SMALL 24u
#define SMALL_TIMES 5u  /* a step of a small scene is as long as so many of a large one */
#define STILL_AT    70u /* it has fallen, the ball does not spin yet */
#define KEPT        3u  /* frames at hand: two for a step, and the one before */

struct cloth {
    struct drape drape;
    uint32_t rings;          /* of the ball */
    double (*kept[KEPT])[3]; /* frame f of the cloth is in kept[f % KEPT] */
    uint32_t still_at;       /* > 0: the frame that all of them show */
};

static void keep(struct cloth *cloth)
{
    const struct drape *drape = &cloth->drape;
    memcpy(cloth->kept[drape->frame % KEPT], drape->x, drape->count * sizeof *drape->x);
}

static void seek(struct cloth *cloth, uint32_t frame)
{
    if (frame + KEPT <= cloth->drape.frame) {
        drape_restart(&cloth->drape);
        keep(cloth);
    }
    while (cloth->drape.frame < frame) {
        drape_advance(&cloth->drape);
        keep(cloth);
    }
}

static void place_ball(const struct cloth *cloth, uint32_t frame, double (*x)[3])
{
    const struct drape_settings *settings = &cloth->drape.settings;
    uint32_t count = 2 * cloth->rings * (cloth->rings - 1) + 2;
    double turn = drape_turn(settings, frame);
    for (uint32_t v = 0; v < count; v++) {
        double polar;
        double azimuth;
        surface_ball_angles(cloth->rings, v, &polar, &azimuth);
        x[v][0] = settings->radius * sin(polar) * cos(azimuth + turn);
        x[v][1] = settings->radius * sin(polar) * sin(azimuth + turn);
        x[v][2] = settings->radius * cos(polar) + settings->height;
    }
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    struct cloth *cloth = scene->state;
    frame = cloth->still_at > 0 ? cloth->still_at : frame;
    seek(cloth, frame);
    memcpy(x, cloth->kept[frame % KEPT], cloth->drape.count * sizeof *x);
    place_ball(cloth, frame, x + scene->objects[1].first_vertex);
}

static void free_state(void *state)
{
    struct cloth *cloth = state;
    drape_deinit(&cloth->drape);
    for (uint32_t i = 0; i < KEPT; i++) {
        free(cloth->kept[i]);
    }
    free(cloth);
}

static void make(struct bench_scene *scene, uint32_t side, uint32_t rings, bool small,
                 bool still)
{
    const uint32_t times = small ? SMALL_TIMES : 1;
    const struct drape_settings settings = {.side = side,
                                            .substeps = 11 * times,
                                            .length = 2,
                                            .frame_s = times / 110.0,
                                            .radius = 0.35,
                                            .height = 0.36,
                                            .gap = 0.001,
                                            .distance = 0.7,
                                            .spin_from = 0.7,
                                            .spin_gain = 20,
                                            .spin_most = 5,
                                            .seed = 17};
    struct cloth *cloth = bench_scene_alloc(1, sizeof *cloth);
    struct surface surface;
    memset(cloth, 0, sizeof *cloth);
    cloth->rings = rings;
    cloth->still_at = still ? STILL_AT / times : 0;
    drape_init(&cloth->drape, &settings);
    for (uint32_t i = 0; i < KEPT; i++) {
        cloth->kept[i] = bench_scene_alloc(cloth->drape.count, sizeof *cloth->kept[i]);
    }
    keep(cloth);
    surface_sheet(&surface, side);
    surface_add(&surface, scene);
    surface_ball(&surface, rings);
    surface_add(&surface, scene);
    scene->frame_count = (small ? STEPS_SMALL : STEPS) + 1;
    scene->place = place;
    scene->state = cloth;
    scene->free_state = free_state;
}

static void make_coarse(struct bench_scene *scene, bool small, bool still)
{
    /* 2 x 90 x 90 + 4 x 30 x 29 = 19 680 triangles */
    make(scene, small ? 21 : 91, small ? 7 : 30, small, still);
}

void bench_make_cloth(struct bench_scene *scene, bool small)
{
    /* 2 x 208 x 208 + 4 x 38 x 37 = 92 152 triangles */
    make(scene, small ? 31 : 209, small ? 9 : 38, small, false);
}

void bench_make_cloth_20k(struct bench_scene *scene, bool small)
{
    make_coarse(scene, small, false);
}

void bench_make_still(struct bench_scene *scene, bool small)
{
    make_coarse(scene, small, true);
}
