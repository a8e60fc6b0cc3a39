/* play.c - fixed sequences of what a client does. */
#include "play.h"

#include <stdlib.h>

#include "play_actor.h"

const char *play_name(enum play_kind kind)
{
    static const char *const names[PLAY_KINDS] = {"soup", "tear", "crowd", "break",
                                                  "traffic"};
    return names[kind];
}

/* ---- soup -------------------- */

static void make_soup(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor soup;
    actor_soup(&soup, 5, count, prng);
    play_push_mesh(play, PLAY_ADD, &soup);
    for (uint32_t step = 0; step < 4; step++) {
        actor_shake(&soup, play_nowhere, PLAY_ONE / 4, prng);
        play_push_x1(play, &soup, step % 2 == 1);
        play_push(play, PLAY_STEP, 0);
    }
    actor_deinit(&soup);
}

/* ---- a sheet that bursts -------------------- */

static void make_tear(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor sheet;
    actor_patches(&sheet, 8, count, prng);
    uint32_t patches = sheet.triangle_count / PATCH_TRIANGLES;
    double(*way)[3] = play_get(patches, sizeof *way);
    play_push_mesh(play, PLAY_ADD, &sheet);
    for (uint32_t p = 0; p < patches; p++) {
        play_somewhere(prng, PLAY_ONE / 8, way[p]);
    }
    for (uint32_t step = 0; step < 6; step++) {
        actor_shake(&sheet, play_nowhere, PLAY_ONE / 32, prng);
        for (uint32_t i = 0; i < sheet.vertex_count && step > 0; i++) {
            for (int k = 0; k < 3; k++) {
                sheet.x[i][k] += way[i / PATCH_CORNERS][k];
            }
        }
        for (uint32_t p = 0; p < patches && step > 0; p++) {
            actor_turn_patch(&sheet, p, p % 3);
        }
        play_push_x1(play, &sheet, step % 2 == 0);
        play_push(play, PLAY_STEP, 0);
    }
    free(way);
    actor_deinit(&sheet);
}

/* ---- crowd -------------------- */

#define CROWD 24u

/* Find where the i-th of a crowd is at home: a lattice of 3 x 3 x 3 places. */
static void home_of(uint32_t i, uint32_t spacing, double home[3])
{
    home[0] = (double)(i % 3 * spacing) * PLAY_UNIT;
    home[1] = (double)(i / 3 % 3 * spacing) * PLAY_UNIT;
    home[2] = (double)(i / 9 * spacing) * PLAY_UNIT;
}

static void make_crowd(struct play *play, uint32_t count, struct prng *prng)
{
    uint32_t spacing = 152 * play_root((count / CROWD + 1) / 2, 2); /* they just touch */
    struct actor actors[CROWD];
    double home[CROWD][3];
    for (uint32_t i = 0; i < CROWD; i++) {
        home_of(i, spacing, home[i]);
        actor_sheet(&actors[i], 100 - i, count / CROWD, 168,
                    i % 4 < 2 ? play_nowhere : home[i], prng);
        play_some_matrix(actors[i].m, home[i], prng);
        play_push_mesh(play, PLAY_ADD, &actors[i]);
    }
    for (uint32_t step = 0; step < 4; step++) {
        const double way[3] = {0, 0, step % 2 ? 0.125 : -0.125};
        for (uint32_t i = 0; i < CROWD; i++) {
            if (i % 4 < 2) {
                play_move_rigid(play, &actors[i], home[i], prng);
            } else if (i % 4 == 2) {
                actor_shake(&actors[i], way, PLAY_ONE / 64, prng);
                play_push_x1(play, &actors[i], i % 8 == 2);
            } else if (step == 2) {
                play_push_jump(play, &actors[i], PLAY_ONE / 32, prng);
            }
        }
        play_push(play, PLAY_STEP, 0);
    }
    for (uint32_t i = 0; i < CROWD; i++) {
        actor_deinit(&actors[i]);
    }
}

/* ---- an object that breaks -------------------- */

static void make_break(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor actors[3];
    const double over[3] = {0.25, 0.25, 0.25};
    const double down[3] = {0.0625, 0, -0.0625};
    actor_sheet(&actors[0], 3, count / 2, PLAY_ONE / 8, play_nowhere, prng);
    actor_sheet(&actors[1], 1, count / 4, PLAY_ONE / 8, over, prng);
    actor_sheet(&actors[2], 2, count / 4, PLAY_ONE / 8, play_nowhere, prng);
    play_some_matrix(actors[2].m, over, prng);
    for (int i = 0; i < 3; i++) {
        play_push_mesh(play, PLAY_ADD, &actors[i]);
    }
    for (uint32_t step = 0; step < 8; step++) {
        if (step == 2 || step == 4) {
            actor_crack(&actors[0], step, prng);
            play_push_mesh(play, PLAY_REPLACE, &actors[0]);
        } else if (step == 6) {
            actor_crumble(&actors[0]);
            play_push_mesh(play, PLAY_REPLACE, &actors[0]);
        }
        if (step != 4) { /* the broken one stands still once */
            actor_shake(&actors[0], play_nowhere, PLAY_ONE / 64, prng);
            play_push_x1(play, &actors[0], step % 2 == 1);
        }
        actor_shake(&actors[1], down, PLAY_ONE / 64, prng);
        play_push_x1(play, &actors[1], false);
        play_move_rigid(play, &actors[2], play_nowhere, prng);
        play_push(play, PLAY_STEP, 0);
    }
    for (int i = 0; i < 3; i++) {
        actor_deinit(&actors[i]);
    }
}

/* ---- objects that come and go -------------------- */

static void make_traffic(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor actors[10]; /* two residents, then one guest a step */
    actor_sheet(&actors[0], 50, count / 2, PLAY_ONE / 8, play_nowhere, prng);
    actor_sheet(&actors[1], 40, count / 4, PLAY_ONE / 8, play_nowhere, prng);
    play_some_matrix(actors[1].m, play_nowhere, prng);
    play_push_mesh(play, PLAY_ADD, &actors[0]);
    play_push_mesh(play, PLAY_ADD, &actors[1]);
    uint32_t oldest = 2; /* guest that is there */
    for (uint32_t step = 0; step < 8; step++) {
        struct actor *guest = &actors[2 + step];
        double place[3];
        play_somewhere(prng, PLAY_ONE, place);
        place[2] /= 4;
        actor_sheet(guest, step % 2 ? 60 + step : 30 - step, count / 8, PLAY_ONE / 8,
                    place, prng);
        if (step >= 3) {
            play_push(play, PLAY_REMOVE, actors[oldest++].id);
        }
        play_push_mesh(play, PLAY_ADD, guest);
        if (step == 5) { /* one more leaves, after the newest has come */
            play_push(play, PLAY_REMOVE, actors[oldest++].id);
        }
        for (uint32_t i = oldest; i <= 2 + step; i++) {
            double way[3];
            play_somewhere(prng, PLAY_ONE / 16, way);
            actor_shake(&actors[i], way, PLAY_ONE / 64, prng);
            play_push_x1(play, &actors[i], i % 2 == 0);
        }
        actor_shake(&actors[0], play_nowhere, PLAY_ONE / 64, prng);
        play_push_x1(play, &actors[0], true);
        play_move_rigid(play, &actors[1], play_nowhere, prng);
        play_push(play, PLAY_STEP, 0);
    }
    for (int i = 0; i < 10; i++) {
        actor_deinit(&actors[i]);
    }
}

void play_make(struct play *play, enum play_kind kind, uint32_t triangle_count,
               uint64_t seed)
{
    static void (*const makers[PLAY_KINDS])(struct play *, uint32_t, struct prng *) = {
        make_soup, make_tear, make_crowd, make_break, make_traffic};
    struct prng prng = {seed};
    play_begin(play);
    makers[kind](play, triangle_count, &prng);
}
