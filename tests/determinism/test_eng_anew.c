/* test_eng_anew.c - whatever makes boxes or records old has them made anew. */
#include "cases.h"
#include "eng_answer.h"
#include "eng_way.h"
#include "play_actor.h"
#include "wide_state.h"

#define CELL        0x1p-3
#define SIDE        16u /* squares of the cloth: features of several blocks and nodes */
#define PATCH_FIRST (11 * (SIDE + 1) + 9) /* of the cloth, where it crosses the floor */
#define SOUP        6000u
#define TORN        900u
#define STEPS_MAX   10000u

/* Objects, in the order in which they are added. */
enum { FLOOR, TILE, CLOTH, BODY, OTHER };

struct world {
    struct player player;
    struct eng_question settings;
    struct eng_step_result result; /* of the last step */
    uint32_t moves;                /* of the patch, so far */
    bool asks_bounds;              /* of vertices, after each step, too */
};

/* A sheet of side x side squares with its corner at `at`; its third column of vertices
 * rises by `slope` a length along x. */
static void make_sheet(struct actor *actor, uint32_t id, uint32_t side,
                       const double at[3], double slope)
{
    struct prng prng = {1};
    actor_sheet(actor, id, 2 * side * side, PLAY_ONE / 8, play_nowhere, &prng);
    for (uint32_t i = 0; i < actor->vertex_count; i++) {
        actor->x[i][0] = at[0] + i % (side + 1) * CELL;
        actor->x[i][1] = at[1] + i / (side + 1) * CELL;
        actor->x[i][2] = at[2] + i % (side + 1) * CELL * slope;
    }
}

static void put(struct world *world, enum play_what what, const struct actor *actor)
{
    const struct play_act act = {.what = what,
                                 .object_id = actor->id,
                                 .vertex_count = actor->vertex_count,
                                 .triangle_count = actor->triangle_count,
                                 .x0 = actor->x,
                                 .triangles = actor->triangles};
    player_act(&world->player, &act);
}

static void put_sheet(struct world *world, enum play_what what, uint32_t id,
                      uint32_t side, const double at[3], double slope)
{
    struct actor actor;
    make_sheet(&actor, id, side, at, slope);
    put(world, what, &actor);
    actor_deinit(&actor);
}

static uint32_t place_of(const struct world *world, uint32_t id)
{
    uint32_t at = 0;
    while (at < world->player.object_count && world->player.objects[at].id != id) {
        at++;
    }
    assert_true(at < world->player.object_count);
    return at;
}

static struct player_object *object_of(struct world *world, uint32_t id)
{
    return &world->player.objects[place_of(world, id)];
}

/* The `count` vertices of an object from `first` on go up by `up`. */
static void lift(struct world *world, uint32_t id, uint32_t first, uint32_t count,
                 double up)
{
    struct player_object *object = object_of(world, id);
    double(*x1)[3] = play_get(count, sizeof *x1);
    player_open(&world->player);
    memcpy(x1, object->x1 + first, count * sizeof *x1);
    for (uint32_t i = 0; i < count; i++) {
        x1[i][2] += up;
    }
    const struct play_act act = {.what = PLAY_X1,
                                 .object_id = id,
                                 .first = first,
                                 .vertex_count = count,
                                 .x1 = x1};
    player_act(&world->player, &act);
    free(x1);
}

/* Ask what is near each vertex now: a fresh scene must answer it so, whatever pairs set
 * the bounds of the last answer. */
static void check_bounds(struct world *world)
{
    struct eng_question question = world->settings;
    struct eng_step_result result;
    struct answer fresh;
    question.verb = PCCD_NEAR_VERTICES;
    question.distance = 2 * CELL;
    question.end = 1;
    assert_ok(eng_near(world->player.scene, &question, &result));
    answer_find_fresh(&world->player, &question, &fresh);
    const char *difference = answer_difference(&fresh, &result);
    if (difference) {
        fail_msg("other bounds: %s", difference);
    }
    answer_free(&fresh);
}

/* The step that is staged must be answered as by a fresh scene. */
static void check_step(struct world *world)
{
    struct answer fresh;
    int status = player_step(&world->player, &world->settings, &world->result);
    assert_ok(status);
    answer_find_fresh(&world->player, &world->settings, &fresh);
    const char *difference = answer_difference(&fresh, &world->result);
    if (difference) {
        char way[WAY_TEXT_MAX];
        way_tell(&world->settings, way);
        fail_msg("not the same: %s (mode %d, %s)", difference, (int)world->settings.mode,
                 way);
    }
    assert_true(way_tree_is_sound(world->player.scene, &world->result));
    answer_free(&fresh);
    if (world->asks_bounds) {
        check_bounds(world);
    }
}

/* A few vertices of the cloth go up or down through the floor and the tile; all else
 * stands. */
static void move_patch(struct world *world)
{
    lift(world, CLOTH, PATCH_FIRST, 5, world->moves++ % 2 ? 0.25 : -0.25);
}

/* Steps in which little moves. */
static void go_on(struct world *world, uint32_t steps)
{
    for (uint32_t i = 0; i < steps; i++) {
        move_patch(world);
        check_step(world);
    }
    check_step(world); /* nothing moves */
}

/* A floor, a tile that lies on it, half on and half beside its squares; a cloth that
 * goes through both; a body that has just come through the cloth. */
static void begin(struct world *world, enum pccd_method method, uint32_t threads)
{
    struct eng_scene_settings made = ENG_SCENE_SETTINGS_DEFAULT;
    made.region_triangles = 64;
    memset(world, 0, sizeof *world);
    world->settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    world->settings.method = method;
    world->settings.threads = threads;
    world->settings.team_always = true;
    player_init(&world->player, &made);
    put_sheet(world, PLAY_ADD, FLOOR, 8, (const double[3]){0, 0, 0}, 0);
    put_sheet(world, PLAY_ADD, TILE, 3, (const double[3]){0.0625, 0.125, 0}, 0);
    put_sheet(world, PLAY_ADD, CLOTH, SIDE, (const double[3]){-1, -1, -0.25}, 0.1875);
    put_sheet(world, PLAY_ADD, BODY, 4, (const double[3]){-0.5, -0.5, 1}, -0.25);
    lift(world, BODY, 0, object_of(world, BODY)->vertex_count, -2);
    check_step(world);
    go_on(world, 2);
    /* By wide, what touches at rest was not found again, so the case can fail. */
    assert_true(world->result.initial > 0);
    assert_int_equal(world->result.counters.kept_records > 0, method == PCCD_METHOD_WIDE);
}

static void end(struct world *world)
{
    player_deinit(&world->player);
}

/* `happen` to a scene of each method and number of threads. */
static void for_each_way(void (*happen)(struct world *))
{
    for (uint32_t way = 0; way < 2 * WAY_METHODS; way++) {
        struct world world;
        begin(&world, way_methods[way / 2], 1 + way % 2);
        /* The other method keeps nothing of an answer about bounds; a fresh scene takes
         * long to find them. */
        world.asks_bounds = way_methods[way / 2] == PCCD_METHOD_WIDE && way % 2 == 1;
        go_on(&world, 1);
        happen(&world);
        go_on(&world, 2);
        end(&world);
    }
}

static struct filters_place filter_place(struct world *world, uint32_t id)
{
    return (struct filters_place){id, object_of(world, id)->idx};
}

static void change_masks(struct world *world)
{
    struct player *player = &world->player;
    struct eng_object_filter bits = ENG_OBJECT_FILTER_DEFAULT;
    uint64_t before = world->result.count;
    bits.mask = 0;
    filters_set(&player->filters, player->scene, filter_place(world, TILE), bits);
    check_step(world);
    assert_true(world->result.count < before);
    go_on(world, 2);
    bits.mask = UINT64_MAX;
    filters_set(&player->filters, player->scene, filter_place(world, TILE), bits);
    check_step(world);
    assert_int_equal(world->result.count, before);
}

/* If this failed, objects that stand would touch after they were told not to meet, or not
 * when they may meet again. */
CASE(masks__show_at_once_of_what_stands)
{
    for_each_way(change_masks);
}

static void change_self(struct world *world)
{
    struct player *player = &world->player;
    struct eng_object_filter bits = ENG_OBJECT_FILTER_DEFAULT;
    /* The cloth lies on itself: its last row of vertices on the one before. */
    struct player_object *cloth = object_of(world, CLOTH);
    uint32_t last = cloth->vertex_count - SIDE - 1;
    double(*x1)[3] = play_get(SIDE + 1, sizeof *x1);
    memcpy(x1, cloth->x1 + last - 2 * (SIDE + 1), (SIDE + 1) * sizeof *x1);
    const struct play_act act = {.what = PLAY_X1,
                                 .object_id = CLOTH,
                                 .first = last,
                                 .vertex_count = SIDE + 1,
                                 .x1 = x1};
    player_act(player, &act);
    free(x1);
    check_step(world);
    check_step(world);
    uint64_t before = world->result.count;
    bits.self = false;
    filters_set(&player->filters, player->scene, filter_place(world, CLOTH), bits);
    check_step(world);
    assert_true(world->result.count < before);
    bits.self = true;
    filters_set(&player->filters, player->scene, filter_place(world, CLOTH), bits);
    check_step(world);
    assert_int_equal(world->result.count, before);
}

/* If this failed, a cloth that lies on itself would go on touching itself after it was
 * told not to, or not begin again. */
CASE(self_collision__shows_at_once_of_what_stands)
{
    for_each_way(change_self);
}

static void change_ignored(struct world *world)
{
    struct player *player = &world->player;
    uint64_t before = world->result.count;
    for (int i = 0; i < 2; i++) {
        filters_ignore(&player->filters, player->scene, filter_place(world, FLOOR),
                       filter_place(world, TILE), i == 0);
        check_step(world);
        assert_true((world->result.count < before) == (i == 0));
    }
}

/* If this failed, two objects that stand would be told although they ignore each other,
 * or not when they do no more. */
CASE(ignored_pairs__show_at_once_of_what_stands)
{
    for_each_way(change_ignored);
}

static void add_one(struct world *world)
{
    uint64_t before = world->result.count;
    put_sheet(world, PLAY_ADD, OTHER, 3, (const double[3]){0.375, 0.125, 0}, 0);
    check_step(world);
    assert_true(world->result.count > before);
}

/* If this failed, an object that comes would be seen by what moves alone. */
CASE(added_object__meets_what_stands)
{
    for_each_way(add_one);
}

static void remove_one(struct world *world)
{
    const struct play_act act = {.what = PLAY_REMOVE, .object_id = TILE};
    uint64_t before = world->result.count;
    player_act(&world->player, &act);
    check_step(world);
    assert_true(world->result.count < before);
    /* Its index goes to an object of as many vertices elsewhere. */
    put_sheet(world, PLAY_ADD, OTHER, 3, (const double[3]){0.5, 0.5, 0.5}, 0);
    check_step(world);
}

/* If this failed, contacts with an object would outlive it. */
CASE(removed_object__takes_its_contacts_with_it)
{
    for_each_way(remove_one);
}

static void replace_one(struct world *world)
{
    struct player *player = &world->player;
    put_sheet(world, PLAY_REPLACE, TILE, 3, (const double[3]){0.0625, 0.125, 0.5}, 0);
    check_step(world);
    put_sheet(world, PLAY_REPLACE, TILE, 2, (const double[3]){0.0625, 0.125, 0}, 0);
    check_step(world);
    go_on(world, 1);
    /* Tried and taken back: nothing has changed. */
    assert_ok(eng_scene_try_replace(player->scene, object_of(world, CLOTH)->idx,
                                    object_of(world, FLOOR)->mesh));
    eng_scene_take_back(player->scene);
    check_step(world);
}

/* If this failed, what an object was before it was replaced would go on touching. */
CASE(replaced_mesh__is_what_stands_from_then_on)
{
    for_each_way(replace_one);
}

static void change_mode(struct world *world)
{
    for (int mode = PCCD_MODE_COUNT - 1; mode >= 0; mode--) {
        world->settings.mode = (enum pccd_mode)mode;
        check_step(world);
        move_patch(world);
        check_step(world);
    }
}

/* If this failed, records of one mode would stand in an answer of another. */
CASE(mode__is_that_of_each_step)
{
    for_each_way(change_mode);
}

static void change_tolerance(struct world *world)
{
    static const double tolerances[] = {1e-2, 1e-12, 1e-6};
    /* Times that a tolerance bounds: what moves goes on moving as it did. */
    for (int i = 0; i < 3; i++) {
        struct player_object *body = object_of(world, BODY);
        lift(world, BODY, 0, body->vertex_count, i % 2 ? 1.3 : -1.3);
        check_step(world);
        world->settings.tolerance = tolerances[i];
        player_stage_copies(&world->player);
        check_step(world);
    }
}

/* If this failed, times of contacts would be as coarse as an earlier step asked for. */
CASE(tolerance__is_that_of_each_step)
{
    for_each_way(change_tolerance);
}

static void change_hash(struct world *world)
{
    for (int i = 0; i < 3; i++) {
        world->settings.no_hash = true;
        move_patch(world);
        assert_ok(player_step(&world->player, &world->settings, &world->result));
        assert_true(world->result.count > 0 && world->result.hash[0] == 0);
        world->settings.no_hash = false;
        go_on(world, 1);
    }
}

/* If this failed, an answer after one without a hash would have that of a part of its
 * records. */
CASE(hash__is_made_where_it_was_not)
{
    for_each_way(change_hash);
}

/* The methods take turns, four steps each. The tile goes away in steps of the one and
 * comes back in steps of the other; a patch meets it, or not, while it stands. */
static void change_method(struct world *world)
{
    const uint32_t count = object_of(world, TILE)->vertex_count;
    for (uint32_t i = 0; i < 8; i++) {
        world->settings.method = way_methods[i % WAY_METHODS];
        if (i == 4) { /* the other one brings it back */
            lift(world, TILE, 0, count, -0.5);
            check_step(world);
        }
        move_patch(world);
        check_step(world);
        lift(world, TILE, 0, count, (i % 2 == 0) == (i < 4) ? -0.5 : 0.5);
        check_step(world);
        check_step(world);
        check_step(world);
    }
}

/* If this failed, a method would go by boxes of a step that another one has taken. */
CASE(method__has_no_boxes_of_steps_by_another)
{
    for_each_way(change_method);
}

static void change_team(struct world *world)
{
    for (uint32_t i = 0; i < 6; i++) {
        world->settings.threads = 1 + i % 3;
        world->settings.kernels = way_kernels(i % way_kernels_count());
        world->settings.tuning.scheduler = (enum eng_scheduler)(i / 2 % 2);
        world->settings.tuning.refit = (enum eng_refit_scheme)(i / 3);
        world->settings.tuning.high_level = (enum eng_high_level)(i % 2);
        move_patch(world);
        check_step(world);
        check_step(world);
    }
}

/* If this failed, what one team keeps would be of no use, or wrong, for another. */
CASE(team__may_be_another_one_in_each_step)
{
    for_each_way(change_team);
}

/* A step that ends early, in which the body goes away; the next one must not take
 * contacts from it. */
static void cut(struct world *world, const struct eng_question *settings)
{
    struct eng_step_result result;
    lift(world, BODY, 0, object_of(world, BODY)->vertex_count, 1.5);
    assert_ok(player_step(&world->player, settings, &result));
    assert_int_not_equal(result.incomplete, PCCD_COMPLETE);
    check_step(world); /* nothing moves; the answer before is none */
    lift(world, BODY, 0, object_of(world, BODY)->vertex_count, -1.5);
    assert_ok(player_step(&world->player, settings, &result));
    assert_int_not_equal(result.incomplete, PCCD_COMPLETE);
    player_stage_copies(&world->player); /* the same motion once more */
    check_step(world);
}

static void cut_short(struct world *world)
{
    struct eng_question settings = world->settings;
    atomic_bool cancel = true;
    settings.contact_max = 3;
    cut(world, &settings);
    settings = world->settings;
    settings.deadline_ns = 1;
    cut(world, &settings);
    settings = world->settings;
    settings.cancel = &cancel;
    cut(world, &settings);
}

/* If this failed, what an incomplete answer left out would be missing from the next. */
CASE(incomplete_step__is_not_gone_by)
{
    for_each_way(cut_short);
}

static void give_up(struct world *world)
{
    struct eng_question settings = world->settings;
    struct eng_step_result result;
    settings.brief = true;
    settings.threads = 1;
    lift(world, BODY, 0, object_of(world, BODY)->vertex_count, 1.5);
    if (player_step(&world->player, &settings, &result) != PCCD_E_AGAIN) {
        /* No step of that method is brief: it was refused, and nothing has moved. */
        player_stage_copies(&world->player);
        check_step(world);
        return;
    }
    check_step(world); /* the scene goes on from its end; nothing moves */
    lift(world, BODY, 0, object_of(world, BODY)->vertex_count, -1.5);
    assert_int_equal(player_step(&world->player, &settings, &result), PCCD_E_AGAIN);
    struct answer fresh;
    answer_find_fresh(&world->player, &world->settings, &fresh);
    result = kit_step(world->player.scene, &world->settings);
    assert_null(answer_difference(&fresh, &result)); /* what is owed */
    answer_free(&fresh);
}

/* If this failed, a step that was given up would count as one that was answered. */
CASE(given_up_step__is_not_gone_by)
{
    for_each_way(give_up);
}

static void fail_in_every_way(struct world *world)
{
    struct eng_scene *scene = world->player.scene;
    const struct player_object *cloth = object_of(world, CLOTH);
    struct eng_question settings = world->settings;
    struct eng_step_result result;
    double(*x)[3] = play_get(cloth->vertex_count, sizeof *x);
    for (int what = 0; what < 4; what++) {
        int status = PCCD_OK;
        eng_stage_begin(scene);
        assert_ok(
            eng_stage_x1(scene, cloth->idx, PCCD_FORMAT_F64, 0, cloth->vertex_count, x));
        if (what == 0) { /* too many */
            status = eng_stage_x1(scene, object_of(world, TILE)->idx, PCCD_FORMAT_F64, 0,
                                  cloth->vertex_count, x);
        } else if (what == 1) { /* no number */
            const double bad[1][3] = {{0, strtod("nan", NULL), 0}};
            status = eng_stage_x0x1(scene, object_of(world, TILE)->idx, PCCD_FORMAT_F64,
                                    1, 1, bad, bad);
        } else {
            if (what == 2) { /* written twice */
                (void)eng_stage_x1(scene, cloth->idx, PCCD_FORMAT_F64, 1, 1, x);
            } else {
                settings.tolerance = 2;
            }
            status = eng_step(scene, &settings, &result);
        }
        assert_int_not_equal(status, PCCD_OK);
        eng_stage_abort(scene);
        check_step(world);
        go_on(world, 1);
    }
    free(x);
}

/* If this failed, a step that was refused would have moved something after all. */
CASE(failed_step__has_moved_nothing)
{
    for_each_way(fail_in_every_way);
}

/* The tile lies on other squares of the floor, without a motion to there. */
static void jump_and_stand(struct world *world)
{
    struct player_object *tile = object_of(world, TILE);
    double(*x)[3] = play_get(tile->vertex_count, sizeof *x);
    const struct play_act act = {.what = PLAY_X0X1,
                                 .object_id = TILE,
                                 .vertex_count = tile->vertex_count,
                                 .x0 = x,
                                 .x1 = x};
    memcpy(x, tile->x1, tile->vertex_count * sizeof *x);
    for (uint32_t i = 0; i < tile->vertex_count; i++) {
        x[i][0] += 0.25;
    }
    player_act(&world->player, &act);
    check_step(world);
    free(x);
}

static void jump(struct world *world)
{
    struct player_object *body = object_of(world, BODY);
    double(*x0)[3] = play_get(body->vertex_count, sizeof *x0);
    double(*x1)[3] = play_get(body->vertex_count, sizeof *x1);
    const struct play_act act = {.what = PLAY_X0X1,
                                 .object_id = BODY,
                                 .vertex_count = body->vertex_count,
                                 .x0 = x0,
                                 .x1 = x1};
    memcpy(x1, body->x1, body->vertex_count * sizeof *x1);
    memcpy(x0, body->x1, body->vertex_count * sizeof *x0);
    for (uint32_t i = 0; i < body->vertex_count; i++) {
        x0[i][2] += 2;
    }
    player_act(&world->player, &act); /* it comes from elsewhere, to where it was */
    check_step(world);
    player_stage_copies(&world->player); /* and once more */
    check_step(world);
    check_step(world); /* stands */
    for (uint32_t i = 0; i < body->vertex_count; i++) {
        x0[i][0] += 0x1p30; /* far away: boxes are measured from elsewhere */
        x1[i][0] += 0x1p30;
    }
    player_act(&world->player, &act);
    move_patch(world); /* through what stands */
    check_step(world);
    free(x0);
    free(x1);
    jump_and_stand(world);
}

/* If this failed, an object that is set elsewhere would be taken to stand where it was;
 * or one that goes far away would leave the boxes of the others stale. */
CASE(jump__is_a_motion)
{
    for_each_way(jump);
}

static void put_soup(struct world *world, uint32_t triangle_count)
{
    struct actor soup;
    struct prng prng = {5};
    actor_soup(&soup, OTHER, triangle_count, &prng);
    put(world, PLAY_ADD, &soup);
    actor_deinit(&soup);
    check_step(world);
}

/* Every triangle of the soup goes to the place of another one. */
static void mix(struct world *world)
{
    struct player_object *soup = object_of(world, OTHER);
    uint32_t count = soup->triangle_count;
    player_open(&world->player);
    for (uint32_t v = 0; v < soup->vertex_count; v++) {
        uint32_t from = (uint32_t)((uint64_t)(v / 3) * 7919 % count);
        memcpy(soup->x1[v], soup->registered[3 * from + v % 3], sizeof *soup->x1);
    }
    memcpy(soup->x0, soup->x1, soup->vertex_count * sizeof *soup->x0);
    player_stage_copies(&world->player);
    check_step(world);
}

static void tear(struct world *world)
{
    uint64_t rebuilt = 0;
    put_soup(world, TORN);
    mix(world);
    for (int i = 0; i < 20; i++) {
        rebuilt += world->result.counters.rebuilds + world->result.counters.swaps;
        move_patch(world);
        check_step(world);
    }
    assert_true(world->settings.method != PCCD_METHOD_PAPER || rebuilt > 0);
}

/* If this failed, a subtree that is built anew would have boxes of another time. */
CASE(reconstruction__has_boxes_of_its_step)
{
    for_each_way(tear);
}

/* The features of a mixed soup get a new order while it stands and a patch moves. */
static void resort_by(uint32_t threads)
{
    struct world world;
    uint32_t steps;
    begin(&world, PCCD_METHOD_WIDE, threads);
    put_soup(&world, SOUP);
    mix(&world);
    const struct eng_wide_state *wide = eng_wide_state_of(world.player.scene);
    for (steps = 0; steps < STEPS_MAX && wide->resort.state == ENG_WIDE_IDLE; steps++) {
        lift(&world, OTHER, 0, object_of(&world, OTHER)->vertex_count,
             steps % 2 ? 0x1p-10 : -0x1p-10);
        assert_ok(player_step(&world.player, &world.settings, &world.result));
    }
    assert_int_not_equal(wide->resort.state, ENG_WIDE_IDLE);
    world.result.counters.swaps = 0;
    for (steps = 0; steps < STEPS_MAX && world.result.counters.swaps == 0; steps++) {
        move_patch(&world);
        assert_ok(player_step(&world.player, &world.settings, &world.result));
    }
    assert_true(world.result.counters.swaps > 0);
    go_on(&world, 2);
    end(&world);
}

/* If this failed, features would be taken for others once they are in a new order. */
CASE(new_order__has_boxes_and_records_of_its_own)
{
    resort_by(1);
    resort_by(2);
}
