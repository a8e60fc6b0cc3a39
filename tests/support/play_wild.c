/* play_wild.c - a play in which anything may happen. */

#include "play_actor.h"

#define TROUPE 8u /* actors at a time */

struct troupe {
    struct actor actors[TROUPE];
    uint32_t count;
    uint32_t next_id;
    uint32_t triangle_count; /* of an actor, at most about */
};

/* A new shape for an id; of any size from a single triangle. */
static void make_some(struct actor *actor, uint32_t id, uint32_t triangle_count,
                      struct prng *prng)
{
    uint32_t most = prng_below(prng, 4) == 0 ? 2 : triangle_count;
    uint32_t count = most / 2 + prng_u32(prng, most / 2 + 1);
    double place[3];
    play_somewhere(prng, 2 * PLAY_ONE, place);
    switch (prng_below(prng, 4)) {
    case 0:
        actor_soup(actor, id, 1 + count / 4, prng);
        actor_shake(actor, place, 0, prng);
        break;
    case 1:
        actor_patches(actor, id, count, prng);
        actor_shake(actor, place, 0, prng);
        break;
    default:
        actor_sheet(actor, id, count, PLAY_ONE / 8, place, prng);
        break;
    }
    play_some_matrix(actor->m, place, prng);
}

static void come(struct play *play, struct troupe *troupe, struct prng *prng)
{
    struct actor *actor = &troupe->actors[troupe->count++];
    /* Ids out of the order in which they come. */
    make_some(actor, troupe->next_id++ * 37 % 101, troupe->triangle_count, prng);
    play_push_mesh(play, PLAY_ADD, actor);
}

static void go(struct play *play, struct troupe *troupe, struct prng *prng)
{
    struct actor *actor = &troupe->actors[prng_below(prng, troupe->count)];
    play_push(play, PLAY_REMOVE, actor->id);
    actor_deinit(actor);
    *actor = troupe->actors[--troupe->count];
}

static void change(struct play *play, struct troupe *troupe, struct prng *prng)
{
    struct actor *actor = &troupe->actors[prng_below(prng, troupe->count)];
    uint32_t id = actor->id;
    switch (prng_below(prng, 4)) {
    case 0:
        actor_crumble(actor);
        break;
    case 1:
        actor_deinit(actor);
        make_some(actor, id, troupe->triangle_count, prng);
        break;
    default:
        actor_crack(actor, 1 + prng_u32(prng, 8), prng);
        break;
    }
    play_push_mesh(play, PLAY_REPLACE, actor);
}

/* Blocks of vertices fly apart, each its own way. */
static void burst(struct actor *actor, struct prng *prng)
{
    double way[3] = {0, 0, 0};
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        if (i % PATCH_CORNERS == 0) {
            play_somewhere(prng, PLAY_ONE / 8, way);
        }
        for (int k = 0; k < 3; k++) {
            actor->x[i][k] += way[k];
        }
    }
}

/* Return whether every coordinate is a float. */
static bool is_f32(const struct actor *actor)
{
    for (uint32_t i = 0; i < 3 * actor->vertex_count; i++) {
        volatile float nearest = (float)actor->x[i / 3][i % 3];
        if ((double)nearest != actor->x[i / 3][i % 3]) {
            return false;
        }
    }
    return true;
}

static void act(struct play *play, struct actor *actor, struct prng *prng)
{
    double way[3];
    play_somewhere(prng, PLAY_ONE / 8, way);
    switch (prng_below(prng, 8)) {
    case 0: /* stands */
        return;
    case 1:
        play_push_jump(play, actor, PLAY_ONE / 32, prng);
        return;
    case 2:
    case 3:
        play_move_rigid(play, actor, way, prng);
        return;
    case 4:
    case 5:
        burst(actor, prng);
        break;
    case 6: /* to anywhere, past many others */
        play_somewhere(prng, 2 * PLAY_ONE, way);
        for (int k = 0; k < 3; k++) {
            way[k] -= actor->x[0][k];
        }
        actor_shake(actor, way, 0, prng);
        break;
    default:
        actor_shake(actor, way, PLAY_ONE / 64, prng);
        break;
    }
    play_push_x1(play, actor, is_f32(actor) && prng_below(prng, 2) == 1);
}

void play_wild(struct play *play, uint32_t step_count, uint32_t triangle_count,
               uint64_t seed)
{
    struct prng prng = {seed};
    struct troupe troupe = {.triangle_count = triangle_count};
    play_begin(play);
    for (uint32_t step = 0; step < step_count; step++) {
        if (troupe.count > 0 && prng_below(&prng, 8) == 0) {
            go(play, &troupe, &prng);
        }
        while (troupe.count < TROUPE && prng_below(&prng, 1 + troupe.count) == 0) {
            come(play, &troupe, &prng);
        }
        if (troupe.count > 0 && prng_below(&prng, 5) == 0) {
            change(play, &troupe, &prng);
        }
        for (uint32_t i = 0; i < troupe.count; i++) {
            act(play, &troupe.actors[i], &prng);
        }
        play_push(play, PLAY_STEP, 0);
    }
    for (uint32_t i = 0; i < troupe.count; i++) {
        actor_deinit(&troupe.actors[i]);
    }
}
