/* play_actor.c - who acts in a play. */
#include "play_actor.h"

#include <stdlib.h>
#include <string.h>

const double play_nowhere[3] = {0, 0, 0};

void *play_get(size_t count, size_t bytes)
{
    void *block = calloc(count + 1, bytes);
    if (!block) {
        abort();
    }
    return block;
}

static void *copy_of(const void *block, size_t count, size_t bytes)
{
    void *copy = play_get(count, bytes);
    memcpy(copy, block, count * bytes);
    return copy;
}

void play_deinit(struct play *play)
{
    for (uint32_t i = 0; i < play->act_count; i++) {
        free(play->acts[i].x0);
        free(play->acts[i].x1);
        free(play->acts[i].triangles);
    }
    free(play->acts);
    memset(play, 0, sizeof *play);
}

void play_begin(struct play *play)
{
    memset(play, 0, sizeof *play);
    play->acts = play_get(PLAY_ACTS, sizeof *play->acts);
}

struct play_act *play_push(struct play *play, enum play_what what, uint32_t object_id)
{
    if (play->act_count == PLAY_ACTS) {
        abort();
    }
    struct play_act *act = &play->acts[play->act_count++];
    act->what = what;
    act->object_id = object_id;
    play->step_count += what == PLAY_STEP;
    return act;
}

void play_push_mesh(struct play *play, enum play_what what, const struct actor *actor)
{
    struct play_act *act = play_push(play, what, actor->id);
    act->vertex_count = actor->vertex_count;
    act->triangle_count = actor->triangle_count;
    act->x0 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
    act->triangles =
        copy_of(actor->triangles, actor->triangle_count, sizeof *actor->triangles);
}

void play_push_x1(struct play *play, const struct actor *actor, bool is_f32)
{
    struct play_act *act = play_push(play, PLAY_X1, actor->id);
    act->is_f32 = is_f32;
    act->vertex_count = actor->vertex_count;
    act->x1 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
}

void play_push_rigid(struct play *play, struct actor *actor, const double m1[12])
{
    struct play_act *act = play_push(play, PLAY_RIGID, actor->id);
    act->vertex_count = actor->vertex_count;
    memcpy(act->m[0], actor->m, sizeof act->m[0]);
    memcpy(act->m[1], m1, sizeof act->m[1]);
    memcpy(actor->m, m1, sizeof actor->m);
}

void actor_init(struct actor *actor, uint32_t id, uint32_t vertex_count,
                uint32_t triangle_count)
{
    memset(actor, 0, sizeof *actor);
    actor->id = id;
    actor->vertex_count = vertex_count;
    actor->triangle_count = triangle_count;
    actor->x = play_get(vertex_count, sizeof *actor->x);
    actor->triangles = play_get(triangle_count, sizeof *actor->triangles);
}

void actor_deinit(struct actor *actor)
{
    free(actor->x);
    free(actor->triangles);
    memset(actor, 0, sizeof *actor);
}

double play_some(struct prng *prng, uint32_t reach)
{
    return ((double)prng_below(prng, 2 * (uint64_t)reach + 1) - (double)reach) *
           PLAY_UNIT;
}

void play_somewhere(struct prng *prng, uint32_t reach, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = play_some(prng, reach);
    }
}

uint32_t play_root(uint32_t count, uint32_t power)
{
    uint32_t n = 1;
    while (n * n * (power == 3 ? n : 1) < count) {
        n++;
    }
    return n;
}

void actor_shake(struct actor *actor, const double way[3], uint32_t reach,
                 struct prng *prng)
{
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            actor->x[i][k] += way[k] + play_some(prng, reach);
        }
    }
}

/* Two triangles to each square of a grid, from vertex `first` on. */
static void join_grid(uint32_t (*triangles)[3], uint32_t first, uint32_t side)
{
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t corner = first + i / side * (side + 1) + i % side;
        uint32_t above = corner + side + 1;
        const uint32_t square[2][3] = {{corner, corner + 1, above},
                                       {corner + 1, above + 1, above}};
        memcpy(triangles[2 * (size_t)i], square, sizeof square);
    }
}

void actor_sheet(struct actor *actor, uint32_t id, uint32_t count, uint32_t cell,
                 const double centre[3], struct prng *prng)
{
    bool falls = prng_below(prng, 2) == 1;
    uint32_t side = play_root((count + 1) / 2, 2);
    actor_init(actor, id, (side + 1) * (side + 1), 2 * side * side);
    join_grid(actor->triangles, 0, side);
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        actor->x[i][0] = (double)(i % (side + 1) * cell) * PLAY_UNIT;
        actor->x[i][1] = (double)(i / (side + 1) * cell) * PLAY_UNIT;
        actor->x[i][2] = actor->x[i][0] / (falls ? -4 : 4);
        for (int k = 0; k < 3; k++) {
            double middle = k < 2 ? (double)(side * cell / 2) * PLAY_UNIT : 0;
            actor->x[i][k] += centre[k] - middle + play_some(prng, cell / 8);
        }
    }
}

/* One triangle in fifty repeats another's vertices; as many repeat its positions, repeat
 * a vertex, or are a point. */
static void spoil(struct actor *actor, uint32_t t, struct prng *prng)
{
    uint32_t *v = actor->triangles[t];
    uint32_t other = prng_u32(prng, t + 1);
    switch (prng_below(prng, 50)) {
    case 0:
        memmove(v, actor->triangles[other], sizeof actor->triangles[0]);
        break;
    case 1:
        memmove(actor->x[3 * t], actor->x[3 * other], 3 * sizeof actor->x[0]);
        break;
    case 2:
        v[2] = v[1];
        break;
    case 3:
        memcpy(actor->x[3 * t + 1], actor->x[3 * t], sizeof actor->x[0]);
        memcpy(actor->x[3 * t + 2], actor->x[3 * t], sizeof actor->x[0]);
        break;
    default:
        break;
    }
}

void actor_soup(struct actor *actor, uint32_t id, uint32_t count, struct prng *prng)
{
    uint32_t reach = play_root(count, 3) * (PLAY_ONE / 2 + PLAY_ONE / 8);
    actor_init(actor, id, 3 * count, count);
    for (uint32_t t = 0; t < count; t++) {
        double centre[3];
        play_somewhere(prng, reach, centre);
        for (uint32_t i = 3 * t; i < 3 * t + 3; i++) {
            actor->triangles[t][i % 3] = i;
            for (int k = 0; k < 3; k++) {
                actor->x[i][k] = centre[k] + play_some(prng, PLAY_ONE / 2);
            }
        }
        spoil(actor, t, prng);
    }
}

void actor_patches(struct actor *actor, uint32_t id, uint32_t count, struct prng *prng)
{
    const uint32_t cell = PLAY_ONE / 4;
    uint32_t side = play_root((count + PATCH_TRIANGLES - 1) / PATCH_TRIANGLES, 2);
    actor_init(actor, id, side * side * PATCH_CORNERS, side * side * PATCH_TRIANGLES);
    for (uint32_t p = 0; p < side * side; p++) {
        join_grid(actor->triangles + (size_t)p * PATCH_TRIANGLES, p * PATCH_CORNERS,
                  PATCH);
        for (uint32_t i = 0; i < PATCH_CORNERS; i++) {
            double *x = actor->x[p * PATCH_CORNERS + i];
            x[0] = (double)(p % side * (PATCH * cell + 16) + i % (PATCH + 1) * cell);
            x[1] = (double)(p / side * (PATCH * cell + 16) + i / (PATCH + 1) * cell);
            x[0] *= PLAY_UNIT;
            x[1] *= PLAY_UNIT;
            x[2] = play_some(prng, cell / 4);
        }
    }
}

void actor_turn_patch(struct actor *actor, uint32_t patch, uint32_t spin)
{
    double(*x)[3] = actor->x + (size_t)patch * PATCH_CORNERS;
    int from = spin == 1 ? 0 : 1;
    for (uint32_t i = 1; i < PATCH_CORNERS && spin > 0; i++) {
        double a = x[i][from] - x[0][from];
        double b = x[i][from + 1] - x[0][from + 1];
        x[i][from] = x[0][from] - b;
        x[i][from + 1] = x[0][from + 1] + a;
    }
}

void play_some_matrix(double m[12], const double to[3], struct prng *prng)
{
    static const double turns[4][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                       {0, -1, 0, 1, 0, 0, 0, 0, 1},
                                       {0, 0, 1, 0, 1, 0, -1, 0, 0},
                                       {1, 0, 0, 0, 0, -1, 0, 1, 0}};
    const double *r = turns[prng_below(prng, 4)];
    for (int row = 0; row < 3; row++) {
        for (int k = 0; k < 3; k++) {
            m[4 * row + k] = r[3 * row + k];
        }
        m[4 * row + 3] = to[row];
    }
}

void play_move_rigid(struct play *play, struct actor *actor, const double home[3],
                     struct prng *prng)
{
    double m1[12];
    memcpy(m1, actor->m, sizeof m1);
    for (int k = 0; k < 3; k++) {
        m1[4 * k + 3] = home[k] + play_some(prng, PLAY_ONE / 8);
        m1[4 * k + (k + 1) % 3] += ((double)prng_below(prng, 3) - 1) / 16;
    }
    play_push_rigid(play, actor, m1);
}

void play_push_jump(struct play *play, struct actor *actor, uint32_t reach,
                    struct prng *prng)
{
    struct play_act *act = play_push(play, PLAY_X0X1, actor->id);
    act->vertex_count = actor->vertex_count;
    actor_shake(actor, play_nowhere, reach, prng);
    act->x0 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
    actor_shake(actor, play_nowhere, reach, prng);
    act->x1 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
}

void actor_crack(struct actor *actor, uint32_t share, struct prng *prng)
{
    struct actor broken;
    uint32_t at = actor->vertex_count;
    actor_init(&broken, actor->id, at + 3 * actor->triangle_count, actor->triangle_count);
    memcpy(broken.x, actor->x, at * sizeof *broken.x);
    for (uint32_t t = 0; t < actor->triangle_count; t++) {
        bool is_loose = prng_below(prng, 8) < share;
        for (int i = 0; i < 3; i++) {
            uint32_t v = actor->triangles[t][i];
            broken.triangles[t][i] = is_loose ? at : v;
            for (int k = 0; k < 3 && is_loose; k++) {
                broken.x[at][k] = actor->x[v][k] + play_some(prng, 32);
            }
            at += is_loose;
        }
    }
    broken.vertex_count = at;
    actor_deinit(actor);
    *actor = broken;
}

void actor_crumble(struct actor *actor)
{
    for (uint32_t t = 0; 2 * t < actor->triangle_count; t++) {
        memmove(actor->triangles[t], actor->triangles[(size_t)2 * t],
                sizeof *actor->triangles);
    }
    actor->triangle_count = (actor->triangle_count + 1) / 2;
}
