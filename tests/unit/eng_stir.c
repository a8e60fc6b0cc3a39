/* eng_stir.c - scenes of which little moves. */
#include "eng_stir.h"

#include "play_actor.h"

#define CELL     (PLAY_ONE / 8) /* of a sheet */
#define FEW      60u            /* triangles that may all touch others at rest */
#define ACTS_MAX 16u            /* of one step */
#define CLOSED   5u             /* the kind of objects that are closed */
#define NO_IDX   1000000u       /* there is no such object */

static uint32_t draw(struct stir *stir, uint32_t bound)
{
    return prng_u32(&stir->prng, bound);
}

/* ---- scenes ------------------------------------------------------------------------ */

struct eng_scene_settings stir_draw_scene(struct prng *prng)
{
    static const double ratios[] = {0, 0.9, 0.9, 1};
    static const uint32_t regions[] = {1, 16, 40, 1024};
    struct eng_scene_settings made = ENG_SCENE_SETTINGS_DEFAULT;
    made.rebuild_ratio = ratios[prng_below(prng, 4)];
    made.region_triangles = regions[prng_below(prng, 4)];
    return made;
}

uint32_t stir_draw_size(struct prng *prng, uint32_t large_percent)
{
    uint32_t kind = prng_u32(prng, 100);
    if (kind < large_percent) {
        return 3000;
    }
    return kind < 60 ? STIR_TINY : kind < 95 ? 80 : 400;
}

/* ---- objects that come ------------------------------------------------------------- */

static bool is_used(const struct stir *stir, uint32_t id)
{
    for (uint32_t i = 0; i < stir->player.object_count; i++) {
        if (stir->player.objects[i].id == id) {
            return true;
        }
    }
    return false;
}

/* Few ids, so that they come again. */
static uint32_t some_id(struct stir *stir)
{
    uint32_t id = draw(stir, 3 * STIR_OBJECTS_MAX);
    while (is_used(stir, id)) {
        id = (id + 7) % (3 * STIR_OBJECTS_MAX);
    }
    return id;
}

/* A grid in the plane z = 0, which it shares with others like it: they touch at rest. A
 * large one is lifted off it but for an eighth of its vertices. */
static void make_flat(struct stir *stir, struct actor *actor, uint32_t id, uint32_t count)
{
    double centre[3] = {play_some(&stir->prng, 4) * (CELL / 2.0),
                        play_some(&stir->prng, 4) * (CELL / 2.0), 0};
    actor_sheet(actor, id, count, CELL, centre, &stir->prng);
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        bool is_flat = count <= FEW || draw(stir, 8) == 0;
        for (int k = 0; k < 2; k++) {
            actor->x[i][k] = rint(actor->x[i][k] * 16) / 16; /* half cells */
        }
        actor->x[i][2] = is_flat ? 0 : play_some(&stir->prng, CELL);
    }
}

/* A sheet that is folded about its middle, one half on the other. */
static void make_folded(struct stir *stir, struct actor *actor, uint32_t id,
                        uint32_t count)
{
    make_flat(stir, actor, id, count);
    double low = actor->x[0][0];
    double high = low;
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        low = fmin(low, actor->x[i][0]);
        high = fmax(high, actor->x[i][0]);
    }
    double middle = rint((low + high) * 8) / 16;
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        actor->x[i][0] = middle - fabs(actor->x[i][0] - middle);
    }
}

/* Octahedra with corners anywhere about a place of each, some of them inside out. */
static void make_closed(struct stir *stir, struct actor *actor, uint32_t id,
                        uint32_t count)
{
    static const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    uint32_t copies = 1 + count / 16;
    actor_init(actor, id, 6 * copies, 8 * copies);
    for (uint32_t copy = 0; copy < copies; copy++) {
        double centre[3];
        uint32_t turn = draw(stir, 4) == 0;
        play_somewhere(&stir->prng, PLAY_ONE / 8 * play_root(copies, 3), centre);
        for (uint32_t i = 0; i < 6; i++) {
            double *x = actor->x[6 * copy + i];
            memcpy(x, centre, sizeof centre);
            x[i / 2] += (i % 2 ? -1 : 1) * (PLAY_ONE / 4) * PLAY_UNIT;
            for (int k = 0; k < 3; k++) {
                x[k] += play_some(&stir->prng, draw(stir, 2) * CELL / 2);
            }
        }
        for (uint32_t i = 0; i < 24; i++) {
            uint32_t k = turn ? 2 - i % 3 : i % 3;
            actor->triangles[8 * copy + i / 3][k] = 6 * copy + faces[i / 3][i % 3];
        }
    }
}

static void make_some(struct stir *stir, struct actor *actor, uint32_t id)
{
    uint32_t most = draw(stir, 5) == 0 ? 2 : stir->triangle_count;
    uint32_t count = 1 + most / 2 + draw(stir, most / 2 + 1);
    const double *far = stir->far[draw(stir, 2)];
    double centre[3];
    play_somewhere(&stir->prng, PLAY_ONE / 4, centre);
    switch (stir->is_closed ? CLOSED : draw(stir, 5)) {
    case 0:
        actor_soup(actor, id, 1 + count / 4, &stir->prng);
        break;
    case 1:
        make_folded(stir, actor, id, count);
        break;
    case 2:
        make_flat(stir, actor, id, count);
        break;
    case CLOSED:
        make_closed(stir, actor, id, count);
        break;
    default:
        actor_sheet(actor, id, count, CELL, centre, &stir->prng);
        break;
    }
    actor_shake(actor, far, 0, &stir->prng);
}

static void push_mesh(struct stir *stir, enum play_what what, uint32_t id)
{
    struct actor actor;
    make_some(stir, &actor, id);
    const struct play_act act = {.what = what,
                                 .object_id = id,
                                 .vertex_count = actor.vertex_count,
                                 .triangle_count = actor.triangle_count,
                                 .x0 = actor.x,
                                 .triangles = actor.triangles};
    player_act(&stir->player, &act);
    actor_deinit(&actor);
}

void stir_add(struct stir *stir)
{
    push_mesh(stir, PLAY_ADD, some_id(stir));
}

void stir_remove(struct stir *stir, uint32_t at)
{
    const struct play_act act = {.what = PLAY_REMOVE,
                                 .object_id = stir->player.objects[at].id};
    player_act(&stir->player, &act);
}

void stir_replace(struct stir *stir, uint32_t at)
{
    push_mesh(stir, PLAY_REPLACE, stir->player.objects[at].id);
}

void stir_init(struct stir *stir, const struct eng_scene_settings *settings,
               uint32_t triangle_count, uint64_t seed)
{
    /* Beside what an object measures: too far for single precision, and farther. */
    static const double places[] = {0, 0, 0x1p20, -0x1p20, 0x1p33};
    memset(stir, 0, sizeof *stir);
    stir->prng.state = seed;
    stir->triangle_count = triangle_count;
    player_init(&stir->player, settings);
    for (int k = 0; k < 3; k++) {
        stir->far[0][k] = draw(stir, 3) > 0 ? 0 : places[draw(stir, 5)];
        stir->far[1][k] = draw(stir, 4) > 0 ? stir->far[0][k] : places[draw(stir, 5)];
    }
    for (uint32_t i = 2 + draw(stir, STIR_OBJECTS_MAX - 2); i > 0; i--) {
        stir_add(stir);
    }
}

void stir_deinit(struct stir *stir)
{
    player_deinit(&stir->player);
}

void stir_change(struct stir *stir)
{
    struct player *player = &stir->player;
    uint32_t count = player->object_count;
    uint32_t at = count > 0 ? draw(stir, count) : 0;
    uint32_t what = draw(stir, 24);
    if (what == 0 && count < STIR_OBJECTS_MAX) {
        stir_add(stir);
    } else if (what == 1 && count > 0) {
        stir_remove(stir, at);
    } else if (what == 2 && count > 0) {
        stir_replace(stir, at);
    } else if (what == 3 && count > 0) { /* the index goes to another */
        stir_remove(stir, at);
        stir_add(stir);
    } else if (what == 4 && count > 0) {
        uint32_t other = draw(stir, count);
        assert_ok(eng_scene_try_replace(player->scene, player->objects[at].idx,
                                        player->objects[other].mesh));
        eng_scene_take_back(player->scene);
    } else if (what <= 6) {
        player_draw_filters(player, &stir->prng);
    }
}

/* ---- what fails -------------------------------------------------------------------- */

/* A write that is good, to make the failure one of a step that has begun. */
static void write_elsewhere(struct stir *stir, const struct player_object *object,
                            uint32_t count)
{
    struct actor actor;
    actor_init(&actor, object->id, count, 1);
    actor_shake(&actor, stir->far[0], PLAY_ONE, &stir->prng);
    assert_ok(eng_stage_x1(stir->player.scene, object->idx, PCCD_FORMAT_F64, 0, count,
                           actor.x));
    actor_deinit(&actor);
}

static int write_badly(struct stir *stir, const struct player_object *object,
                       uint32_t what)
{
    struct eng_scene *scene = stir->player.scene;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    double bad[2][3] = {{0, 0, 0}, {0, NAN, 0}};
    switch (what) {
    case 0:
        return eng_stage_x1(scene, object->idx, PCCD_FORMAT_F64, object->vertex_count, 1,
                            bad);
    case 1:
        return eng_stage_x1(scene, NO_IDX, PCCD_FORMAT_F64, 0, 1, bad);
    case 2:
        return eng_stage_x0x1(scene, object->idx, PCCD_FORMAT_F64,
                              object->vertex_count - 2, 2, bad, bad);
    case 3: /* what was written is written again */
        write_elsewhere(stir, object, 1);
        return eng_step(scene, &settings, &result);
    default:
        settings.tolerance = 0;
        return eng_step(scene, &settings, &result);
    }
}

void stir_fail(struct stir *stir)
{
    struct player *player = &stir->player;
    if (player->object_count == 0) {
        return;
    }
    const struct player_object *object =
        &player->objects[draw(stir, player->object_count)];
    uint32_t idx;
    assert_false(player->is_staging);
    eng_stage_begin(player->scene);
    write_elsewhere(stir, object, 1);
    assert_int_not_equal(write_badly(stir, object, draw(stir, 5)), PCCD_OK);
    eng_stage_abort(player->scene);
    assert_int_not_equal(eng_scene_add(player->scene, object->mesh, object->id, &idx),
                         PCCD_OK);
    assert_int_not_equal(eng_scene_remove(player->scene, NO_IDX), PCCD_OK);
    stir->failures++;
}

/* ---- what moves -------------------------------------------------------------------- */

/* The acts of a step, from where everything is before it opens. */
struct acts {
    struct play_act items[ACTS_MAX];
    uint32_t count;
};

/* One more, of a range of an object; both ends where it is. NULL: there are enough. */
static struct play_act *push(struct acts *acts, enum play_what what,
                             const struct player_object *object, uint32_t first,
                             uint32_t count)
{
    if (acts->count == ACTS_MAX) {
        return NULL;
    }
    struct play_act *act = &acts->items[acts->count++];
    *act = (struct play_act){.what = what,
                             .object_id = object->id,
                             .first = first,
                             .vertex_count = count,
                             .x0 = play_get(count, sizeof *act->x0),
                             .x1 = play_get(count, sizeof *act->x1)};
    memcpy(act->x0, object->x1 + first, count * sizeof *act->x0);
    memcpy(act->x1, object->x1 + first, count * sizeof *act->x1);
    return act;
}

static void perform(struct stir *stir, struct acts *acts)
{
    for (uint32_t i = 0; i < acts->count; i++) {
        player_act(&stir->player, &acts->items[i]);
        free(acts->items[i].x0);
        free(acts->items[i].x1);
    }
    acts->count = 0;
}

static void shift(double (*x)[3], uint32_t count, const double way[3], uint32_t reach,
                  struct prng *prng)
{
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            x[i][k] += way[k] + play_some(prng, reach);
        }
    }
}

/* A pose of few: what is registered, as it was or turned where that is near. */
static void some_pose(struct stir *stir, double m[12])
{
    bool is_near = true;
    double to[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        is_near = is_near && stir->far[0][k] == 0 && stir->far[1][k] == 0;
        to[k] = ((double)draw(stir, 3) - 1) * PLAY_ONE * PLAY_UNIT / 4;
    }
    memset(m, 0, 12 * sizeof *m);
    if (is_near && draw(stir, 2) == 0) {
        play_some_matrix(m, to, &stir->prng);
        return;
    }
    for (int k = 0; k < 3; k++) {
        m[5 * k] = 1;
        m[4 * k + 3] = draw(stir, 2) == 0 ? 0 : to[k];
    }
}

static void push_rigid(struct stir *stir, struct acts *acts,
                       const struct player_object *object, uint32_t first, uint32_t count)
{
    struct play_act *act = push(acts, PLAY_RIGID, object, first, count);
    if (act) {
        some_pose(stir, act->m[0]);
        some_pose(stir, act->m[1]);
        if (draw(stir, 3) == 0) { /* stands there */
            memcpy(act->m[1], act->m[0], sizeof act->m[1]);
        }
    }
}

/* Some motion of a range. */
static void push_motion(struct stir *stir, struct acts *acts,
                        const struct player_object *object, uint32_t first,
                        uint32_t count)
{
    struct prng *prng = &stir->prng;
    uint32_t what = draw(stir, 12);
    double way[3];
    play_somewhere(prng, PLAY_ONE / 8, way);
    if (what < 2) {
        push_rigid(stir, acts, object, first, count);
        return;
    }
    struct play_act *act =
        push(acts, what < 6 ? PLAY_X0X1 : PLAY_X1, object, first, count);
    if (!act) {
        return;
    }
    if (what == 2) { /* from elsewhere to where it is */
        shift(act->x0, count, way, 0, prng);
    } else if (what == 3) { /* jumps, and stands there */
        shift(act->x0, count, way, 0, prng);
        memcpy(act->x1, act->x0, count * sizeof *act->x1);
    } else if (what < 6) {
        shift(act->x0, count, play_nowhere, CELL / 8, prng);
        shift(act->x1, count, way, CELL / 8, prng);
    } else if (what == 6) { /* a leap to the other place */
        for (int k = 0; k < 3; k++) {
            way[k] = stir->far[1][k] - stir->far[0][k];
        }
        shift(act->x1, count, way, 0, prng);
    } else if (what < 10) {
        shift(act->x1, count, way, 0, prng);
    } else {
        shift(act->x1, count, play_nowhere, CELL / 4, prng);
    }
}

/* Ranges of a few vertices, apart from each other. */
static void push_patch(struct stir *stir, struct acts *acts,
                       const struct player_object *object, uint32_t reach)
{
    uint32_t ranges = 1 + draw(stir, 3);
    uint32_t share = object->vertex_count / ranges;
    for (uint32_t i = 0; i < ranges && share > 0; i++) {
        uint32_t most = share < 12 ? share : 12;
        uint32_t count = 1 + draw(stir, most);
        uint32_t first = i * share + draw(stir, share - count + 1);
        if (reach == 0) {
            push_motion(stir, acts, object, first, count);
            continue;
        }
        struct play_act *act = push(acts, PLAY_X1, object, first, count);
        if (act) {
            shift(act->x1, count, play_nowhere, reach, &stir->prng);
        }
    }
}

/* The last motion of an object once more. */
static void push_again(struct acts *acts, const struct player_object *object)
{
    struct play_act *act = push(acts, PLAY_X0X1, object, 0, object->vertex_count);
    if (act) {
        memcpy(act->x0, object->x0, object->vertex_count * sizeof *act->x0);
    }
}

/* Bytes that are there already, in some form. */
static void push_same(struct stir *stir, struct acts *acts,
                      const struct player_object *object)
{
    uint32_t half = object->vertex_count / 2;
    uint32_t first = draw(stir, 2) * half;
    push(acts, draw(stir, 2) ? PLAY_X1 : PLAY_X0X1, object, first,
         object->vertex_count - half);
}

void stir_move(struct stir *stir)
{
    const struct player *player = &stir->player;
    struct acts acts = {.count = 0};
    uint32_t what = draw(stir, 12);
    uint32_t share = what == 11 ? 1 : 4; /* of the objects one in so many, on average */
    for (uint32_t i = 0; i < player->object_count; i++) {
        const struct player_object *object = &player->objects[i];
        bool is_chosen = draw(stir, share) == 0;
        if (what < 2) {
            continue; /* nothing is staged */
        }
        if (what < 4 && (what == 2 || is_chosen)) {
            push_again(&acts, object);
        } else if (what == 4 && is_chosen) {
            push_same(stir, &acts, object);
        } else if (what < 8 && is_chosen) {
            push_patch(stir, &acts, object, draw(stir, 2) * CELL / 4);
        } else if (is_chosen) {
            push_motion(stir, &acts, object, 0, object->vertex_count);
        }
    }
    perform(stir, &acts);
}
