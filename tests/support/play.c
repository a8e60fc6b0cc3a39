/* play.c - fixed sequences of what a client does.
 *
 * Room:     tests/support.
 * Does:     keep the actors of a play and write down what they do.
 * Threads:  [any].
 */
#include "play.h"

#include <stdlib.h>
#include <string.h>

#define UNIT    0x1p-10 /* of every coordinate; below 2^13 a float holds them all */
#define ONE     1024    /* UNITs in a length of 1 */
#define ACTS    512u
#define ACTORS  32u
#define PATCH   3u /* squares along a side of what a sheet bursts into */
#define CORNERS ((PATCH + 1) * (PATCH + 1))

/* An object as the play knows it. */
struct actor {
    uint32_t id;
    uint32_t vertex_count;
    uint32_t triangle_count;
    double (*x)[3];
    uint32_t (*triangles)[3];
    double m[12]; /* of rigid ones: where they are */
};

const char *play_name(enum play_kind kind)
{
    static const char *const names[PLAY_KINDS] = {"soup", "tear", "crowd", "break",
                                                  "traffic"};
    return names[kind];
}

static void *get(size_t count, size_t bytes)
{
    void *block = calloc(count + 1, bytes);
    if (!block) {
        abort();
    }
    return block;
}

static void *copy_of(const void *block, size_t count, size_t bytes)
{
    void *copy = get(count, bytes);
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

static struct play_act *push(struct play *play, enum play_what what, uint32_t object_id)
{
    if (play->act_count == ACTS) {
        abort();
    }
    struct play_act *act = &play->acts[play->act_count++];
    act->what = what;
    act->object_id = object_id;
    play->step_count += what == PLAY_STEP;
    return act;
}

/* It comes, or takes another shape. */
static void push_mesh(struct play *play, enum play_what what, const struct actor *actor)
{
    struct play_act *act = push(play, what, actor->id);
    act->vertex_count = actor->vertex_count;
    act->triangle_count = actor->triangle_count;
    act->x0 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
    act->triangles =
        copy_of(actor->triangles, actor->triangle_count, sizeof *actor->triangles);
}

/* It has come to actor->x. */
static void push_x1(struct play *play, const struct actor *actor, bool is_f32)
{
    struct play_act *act = push(play, PLAY_X1, actor->id);
    act->is_f32 = is_f32;
    act->vertex_count = actor->vertex_count;
    act->x1 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
}

static void push_rigid(struct play *play, struct actor *actor, const double m1[12])
{
    struct play_act *act = push(play, PLAY_RIGID, actor->id);
    act->vertex_count = actor->vertex_count;
    memcpy(act->m[0], actor->m, sizeof act->m[0]);
    memcpy(act->m[1], m1, sizeof act->m[1]);
    memcpy(actor->m, m1, sizeof actor->m);
}

static void actor_init(struct actor *actor, uint32_t id, uint32_t vertex_count,
                       uint32_t triangle_count)
{
    memset(actor, 0, sizeof *actor);
    actor->id = id;
    actor->vertex_count = vertex_count;
    actor->triangle_count = triangle_count;
    actor->x = get(vertex_count, sizeof *actor->x);
    actor->triangles = get(triangle_count, sizeof *actor->triangles);
}

static void actor_deinit(struct actor *actor)
{
    free(actor->x);
    free(actor->triangles);
    memset(actor, 0, sizeof *actor);
}

/* A multiple of UNIT in -reach .. reach, which is in UNITs. */
static double some(struct prng *prng, uint32_t reach)
{
    return ((double)prng_below(prng, 2 * (uint64_t)reach + 1) - (double)reach) * UNIT;
}

/* The least n with n^power >= count. */
static uint32_t root_of(uint32_t count, uint32_t power)
{
    uint32_t n = 1;
    while (n * n * (power == 3 ? n : 1) < count) {
        n++;
    }
    return n;
}

/* Move every vertex by up to `reach` UNITs along each axis, and all of them by `way`. */
static void shake(struct actor *actor, const double way[3], uint32_t reach,
                  struct prng *prng)
{
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            actor->x[i][k] += way[k] + some(prng, reach);
        }
    }
}

static const double nowhere[3] = {0, 0, 0};

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

/* A bumpy sheet of about `count` triangles around `centre`; squares of `cell` UNITs, a
 * multiple of 4. It rises by a quarter along x, so that sheets cross in lines. */
static void make_sheet(struct actor *actor, uint32_t id, uint32_t count, uint32_t cell,
                       const double centre[3], struct prng *prng)
{
    bool falls = prng_below(prng, 2) == 1;
    uint32_t side = root_of((count + 1) / 2, 2);
    actor_init(actor, id, (side + 1) * (side + 1), 2 * side * side);
    join_grid(actor->triangles, 0, side);
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        actor->x[i][0] = (double)(i % (side + 1) * cell) * UNIT;
        actor->x[i][1] = (double)(i / (side + 1) * cell) * UNIT;
        actor->x[i][2] = actor->x[i][0] / (falls ? -4 : 4);
        for (int k = 0; k < 3; k++) {
            double middle = k < 2 ? (double)(side * cell / 2) * UNIT : 0;
            actor->x[i][k] += centre[k] - middle + some(prng, cell / 8);
        }
    }
}

/* ---- soup -------------------- */

/* One triangle in fifty repeats another's vertices; as many repeat its positions, repeat
 * a vertex, or are a point. */
static void spoil(struct actor *actor, uint32_t t, struct prng *prng)
{
    uint32_t *v = actor->triangles[t];
    uint32_t other = (uint32_t)prng_below(prng, t + 1);
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

static void make_soup(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor soup;
    uint32_t reach = root_of(count, 3) * (ONE / 2 + ONE / 8);
    actor_init(&soup, 5, 3 * count, count);
    for (uint32_t t = 0; t < count; t++) {
        double centre[3];
        for (int k = 0; k < 3; k++) {
            centre[k] = some(prng, reach);
        }
        for (uint32_t i = 3 * t; i < 3 * t + 3; i++) {
            soup.triangles[t][i % 3] = i;
            for (int k = 0; k < 3; k++) {
                soup.x[i][k] = centre[k] + some(prng, ONE / 2);
            }
        }
        spoil(&soup, t, prng);
    }
    push_mesh(play, PLAY_ADD, &soup);
    for (uint32_t step = 0; step < 4; step++) {
        shake(&soup, nowhere, ONE / 4, prng);
        push_x1(play, &soup, step % 2 == 1);
        push(play, PLAY_STEP, 0);
    }
    actor_deinit(&soup);
}

/* ---- a sheet that bursts -------------------- */

/* A quarter turn about z or x around the patch's first corner. */
static void turn(double (*x)[3], uint32_t spin)
{
    int from = spin == 1 ? 0 : 1;
    for (uint32_t i = 1; i < CORNERS && spin > 0; i++) {
        double a = x[i][from] - x[0][from];
        double b = x[i][from + 1] - x[0][from + 1];
        x[i][from] = x[0][from] - b;
        x[i][from + 1] = x[0][from + 1] + a;
    }
}

static void place_patches(struct actor *sheet, uint32_t side, struct prng *prng)
{
    const uint32_t cell = ONE / 4;
    for (uint32_t p = 0; p < side * side; p++) {
        join_grid(sheet->triangles + (size_t)p * 2 * PATCH * PATCH, p * CORNERS, PATCH);
        for (uint32_t i = 0; i < CORNERS; i++) {
            double *x = sheet->x[p * CORNERS + i];
            x[0] = (double)(p % side * (PATCH * cell + 16) + i % (PATCH + 1) * cell);
            x[1] = (double)(p / side * (PATCH * cell + 16) + i / (PATCH + 1) * cell);
            x[0] *= UNIT;
            x[1] *= UNIT;
            x[2] = some(prng, cell / 4);
        }
    }
}

static void make_tear(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor sheet;
    uint32_t side = root_of((count + 2 * PATCH * PATCH - 1) / (2 * PATCH * PATCH), 2);
    uint32_t patches = side * side;
    double(*way)[3] = get(patches, sizeof *way);
    actor_init(&sheet, 8, patches * CORNERS, patches * 2 * PATCH * PATCH);
    place_patches(&sheet, side, prng);
    push_mesh(play, PLAY_ADD, &sheet);
    for (uint32_t p = 0; p < patches; p++) {
        for (int k = 0; k < 3; k++) {
            way[p][k] = some(prng, ONE / 8);
        }
    }
    for (uint32_t step = 0; step < 6; step++) {
        shake(&sheet, nowhere, ONE / 32, prng);
        for (uint32_t i = 0; i < sheet.vertex_count && step > 0; i++) {
            for (int k = 0; k < 3; k++) {
                sheet.x[i][k] += way[i / CORNERS][k];
            }
        }
        for (uint32_t p = 0; p < patches && step > 0; p++) {
            turn(sheet.x + (size_t)p * CORNERS, p % 3);
        }
        push_x1(play, &sheet, step % 2 == 0);
        push(play, PLAY_STEP, 0);
    }
    free(way);
    actor_deinit(&sheet);
}

/* ---- crowd -------------------- */

/* A quarter turn about any axis or none, then to `to`. */
static void some_matrix(double m[12], const double to[3], struct prng *prng)
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

/* Where the i-th of a crowd is at home: a lattice of 3 x 3 x 3 places. */
static void home_of(uint32_t i, uint32_t spacing, double home[3])
{
    home[0] = (double)(i % 3 * spacing) * UNIT;
    home[1] = (double)(i / 3 % 3 * spacing) * UNIT;
    home[2] = (double)(i / 9 * spacing) * UNIT;
}

/* About its home, so that it stays in the crowd, and sheared by sixteenths: products of
 * so few bits that a double holds them. */
static void move_rigid(struct play *play, struct actor *actor, const double home[3],
                       struct prng *prng)
{
    double m1[12];
    memcpy(m1, actor->m, sizeof m1);
    for (int k = 0; k < 3; k++) {
        m1[4 * k + 3] = home[k] + some(prng, ONE / 8);
        m1[4 * k + (k + 1) % 3] += ((double)prng_below(prng, 3) - 1) / 16;
    }
    push_rigid(play, actor, m1);
}

/* It starts somewhere else than where it was. */
static void jump(struct play *play, struct actor *actor, struct prng *prng)
{
    struct play_act *act = push(play, PLAY_X0X1, actor->id);
    act->vertex_count = actor->vertex_count;
    shake(actor, nowhere, ONE / 32, prng);
    act->x0 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
    shake(actor, nowhere, ONE / 32, prng);
    act->x1 = copy_of(actor->x, actor->vertex_count, sizeof *actor->x);
}

static void make_crowd(struct play *play, uint32_t count, struct prng *prng)
{
    const uint32_t crowd = 24;
    uint32_t spacing = 152 * root_of((count / crowd + 1) / 2, 2); /* they just touch */
    struct actor actors[ACTORS];
    double home[ACTORS][3];
    for (uint32_t i = 0; i < crowd; i++) {
        home_of(i, spacing, home[i]);
        make_sheet(&actors[i], 100 - i, count / crowd, 168, i % 4 < 2 ? nowhere : home[i],
                   prng);
        some_matrix(actors[i].m, home[i], prng);
        push_mesh(play, PLAY_ADD, &actors[i]);
    }
    for (uint32_t step = 0; step < 4; step++) {
        const double way[3] = {0, 0, step % 2 ? 0.125 : -0.125};
        for (uint32_t i = 0; i < crowd; i++) {
            if (i % 4 < 2) {
                move_rigid(play, &actors[i], home[i], prng);
            } else if (i % 4 == 2) {
                shake(&actors[i], way, ONE / 64, prng);
                push_x1(play, &actors[i], i % 8 == 2);
            } else if (step == 2) {
                jump(play, &actors[i], prng);
            }
        }
        push(play, PLAY_STEP, 0);
    }
    for (uint32_t i = 0; i < crowd; i++) {
        actor_deinit(&actors[i]);
    }
}

/* ---- an object that breaks -------------------- */

/* The same positions, but `share` of 8 triangles get vertices of their own, a little off
 * where they were. */
static void crack(struct actor *actor, uint32_t share, struct prng *prng)
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
                broken.x[at][k] = actor->x[v][k] + some(prng, 32);
            }
            at += is_loose;
        }
    }
    broken.vertex_count = at;
    actor_deinit(actor);
    *actor = broken;
}

/* Every second triangle is lost; its vertices stay, some of them in no triangle. */
static void crumble(struct actor *actor)
{
    for (uint32_t t = 0; 2 * t < actor->triangle_count; t++) {
        memmove(actor->triangles[t], actor->triangles[(size_t)2 * t],
                sizeof *actor->triangles);
    }
    actor->triangle_count = (actor->triangle_count + 1) / 2;
}

static void make_break(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor actors[3];
    const double over[3] = {0.25, 0.25, 0.25};
    const double down[3] = {0.0625, 0, -0.0625};
    make_sheet(&actors[0], 3, count / 2, ONE / 8, nowhere, prng);
    make_sheet(&actors[1], 1, count / 4, ONE / 8, over, prng);
    make_sheet(&actors[2], 2, count / 4, ONE / 8, nowhere, prng);
    some_matrix(actors[2].m, over, prng);
    for (int i = 0; i < 3; i++) {
        push_mesh(play, PLAY_ADD, &actors[i]);
    }
    for (uint32_t step = 0; step < 8; step++) {
        if (step == 2 || step == 4) {
            crack(&actors[0], step, prng);
            push_mesh(play, PLAY_REPLACE, &actors[0]);
        } else if (step == 6) {
            crumble(&actors[0]);
            push_mesh(play, PLAY_REPLACE, &actors[0]);
        }
        if (step != 4) { /* the broken one stands still once */
            shake(&actors[0], nowhere, ONE / 64, prng);
            push_x1(play, &actors[0], step % 2 == 1);
        }
        shake(&actors[1], down, ONE / 64, prng);
        push_x1(play, &actors[1], false);
        move_rigid(play, &actors[2], nowhere, prng);
        push(play, PLAY_STEP, 0);
    }
    for (int i = 0; i < 3; i++) {
        actor_deinit(&actors[i]);
    }
}

/* ---- objects that come and go -------------------- */

static void make_traffic(struct play *play, uint32_t count, struct prng *prng)
{
    struct actor actors[10]; /* two residents, then one guest a step */
    make_sheet(&actors[0], 50, count / 2, ONE / 8, nowhere, prng);
    make_sheet(&actors[1], 40, count / 4, ONE / 8, nowhere, prng);
    some_matrix(actors[1].m, nowhere, prng);
    push_mesh(play, PLAY_ADD, &actors[0]);
    push_mesh(play, PLAY_ADD, &actors[1]);
    uint32_t oldest = 2; /* guest that is there */
    for (uint32_t step = 0; step < 8; step++) {
        struct actor *guest = &actors[2 + step];
        const double place[3] = {some(prng, ONE), some(prng, ONE), some(prng, ONE / 4)};
        make_sheet(guest, step % 2 ? 60 + step : 30 - step, count / 8, ONE / 8, place,
                   prng);
        if (step >= 3) {
            push(play, PLAY_REMOVE, actors[oldest++].id);
        }
        push_mesh(play, PLAY_ADD, guest);
        if (step == 5) { /* one more leaves, after the newest has come */
            push(play, PLAY_REMOVE, actors[oldest++].id);
        }
        for (uint32_t i = oldest; i <= 2 + step; i++) {
            const double way[3] = {some(prng, ONE / 16), some(prng, ONE / 16),
                                   some(prng, ONE / 16)};
            shake(&actors[i], way, ONE / 64, prng);
            push_x1(play, &actors[i], i % 2 == 0);
        }
        shake(&actors[0], nowhere, ONE / 64, prng);
        push_x1(play, &actors[0], true);
        move_rigid(play, &actors[1], nowhere, prng);
        push(play, PLAY_STEP, 0);
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
    memset(play, 0, sizeof *play);
    play->acts = get(ACTS, sizeof *play->acts);
    makers[kind](play, triangle_count, &prng);
}
