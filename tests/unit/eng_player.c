/* eng_player.c - performs a play on a scene, and knows where everything is. */
#include "eng_player.h"

#include "coordinates.h"
#include "joints.h"
#include "play_actor.h"
#include "stage_turning.h"

void player_init(struct player *player, const struct eng_scene_settings *settings)
{
    memset(player, 0, sizeof *player);
    assert_ok(eng_scene_new(settings, &player->scene));
}

static void object_deinit(struct player_object *object)
{
    eng_mesh_release(object->mesh);
    free(object->registered);
    free(object->x0);
    free(object->x1);
    free(object->triangles);
    free(object->radii);
}

void player_deinit(struct player *player)
{
    for (uint32_t i = 0; i < player->object_count; i++) {
        object_deinit(&player->objects[i]);
    }
    eng_scene_free(player->scene);
    memset(player, 0, sizeof *player);
}

static struct player_object *find(struct player *player, uint32_t id)
{
    for (uint32_t i = 0; i < player->object_count; i++) {
        if (player->objects[i].id == id) {
            return &player->objects[i];
        }
    }
    fail_msg("no object %u", id);
    return NULL;
}

/* Lengths that many features of a play are apart. */
static double some_length(struct prng *prng)
{
    static const double lengths[8] = {
        0, 0, 1, 8, PLAY_ONE / 64, PLAY_ONE / 32, 100.5, PLAY_ONE / 16};
    return lengths[prng_below(prng, 8)] * PLAY_UNIT;
}

/* Draw radii for one mesh in three; half of its vertices have none. */
static void draw_radii(struct player_object *object, struct prng *prng)
{
    if (prng_below(prng, 3) > 0) {
        return;
    }
    for (uint32_t v = 0; v < object->vertex_count; v++) {
        object->radii[v] = prng_below(prng, 2) ? some_length(prng) : 0;
    }
    assert_ok(eng_mesh_write_radii(object->mesh, 0, object->vertex_count, object->radii));
}

/* All but the place in the scene. */
static void object_init(struct player_object *object, const struct play_act *act,
                        struct prng *radii_from)
{
    uint32_t bad;
    memset(object, 0, sizeof *object);
    object->id = act->object_id;
    object->joint = PCCD_NO_JOINT;
    object->vertex_count = act->vertex_count;
    object->triangle_count = act->triangle_count;
    object->registered = test_copy(act->x0, act->vertex_count * sizeof *act->x0);
    object->x0 = test_copy(act->x0, act->vertex_count * sizeof *act->x0);
    object->x1 = test_copy(act->x0, act->vertex_count * sizeof *act->x0);
    object->triangles =
        test_copy(act->triangles, act->triangle_count * sizeof *act->triangles);
    assert_ok(eng_mesh_new(object->vertex_count, object->triangle_count, &object->mesh));
    assert_ok(eng_mesh_write_vertices(object->mesh, PCCD_FORMAT_F64, 0,
                                      object->vertex_count, object->registered));
    assert_ok(eng_mesh_write_triangles(object->mesh, 0, object->triangle_count,
                                       object->triangles, &bad));
    object->radii = test_room(act->vertex_count * sizeof *object->radii);
    if (radii_from) {
        draw_radii(object, radii_from);
    }
    assert_ok(eng_mesh_commit(object->mesh, 1));
    assert_ok(eng_mesh_sort_features(object->mesh, 1));
}

/* The object has the radii of its mesh, or its own. */
static void set_thickness(struct player *player, struct player_object *object)
{
    const double *given = eng_mesh_radii(object->mesh);
    for (uint32_t v = 0; v < object->vertex_count; v++) {
        object->radii[v] = object->thickness.has_radius ? object->thickness.radius
                           : given                      ? given[v]
                                                        : 0;
    }
    assert_ok(eng_scene_set_thickness(player->scene, object->idx, &object->thickness));
}

void player_draw_thickness(struct player *player, struct prng *prng)
{
    if (player->object_count == 0) {
        return;
    }
    struct player_object *object =
        &player->objects[prng_below(prng, player->object_count)];
    struct eng_object_thickness *thickness = &object->thickness;
    *thickness = (struct eng_object_thickness){.has_radius = prng_below(prng, 2)};
    thickness->radius = thickness->has_radius ? some_length(prng) : 0;
    if (prng_below(prng, 3) == 0) {
        thickness->rest_distance = some_length(prng);
        thickness->rest_rings = prng_u32(prng, 3);
    }
    set_thickness(player, object);
}

static void add(struct player *player, const struct play_act *act)
{
    assert_true(player->object_count < PLAYER_OBJECTS_MAX);
    struct player_object *object = &player->objects[player->object_count++];
    object_init(object, act, player->radii_from);
    assert_ok(eng_scene_add(player->scene, object->mesh, object->id, &object->idx));
}

static void take_away(struct player *player, uint32_t id)
{
    struct player_object *object = find(player, id);
    assert_ok(eng_scene_remove(player->scene, object->idx));
    filters_forget(&player->filters, id);
    object_deinit(object);
    *object = player->objects[--player->object_count];
}

static void replace(struct player *player, const struct play_act *act)
{
    struct player_object *object = find(player, act->object_id);
    struct player_object other;
    object_init(&other, act, player->radii_from);
    other.idx = object->idx;
    other.thickness = object->thickness;
    assert_ok(eng_scene_replace(player->scene, other.idx, other.mesh));
    object_deinit(object);
    *object = other;
    if (player->radii_from) {
        set_thickness(player, object); /* the scene has it already */
    }
}

static uint32_t list_places(const struct player *player,
                            struct filters_place places[PLAYER_OBJECTS_MAX])
{
    for (uint32_t i = 0; i < player->object_count; i++) {
        places[i] = (struct filters_place){player->objects[i].id, player->objects[i].idx};
    }
    return player->object_count;
}

void player_draw_filters(struct player *player, struct prng *prng)
{
    struct filters_place places[PLAYER_OBJECTS_MAX];
    uint32_t count = list_places(player, places);
    filters_draw(&player->filters, player->scene, places, count, prng);
}

void player_open(struct player *player)
{
    if (player->is_staging) {
        return;
    }
    for (uint32_t i = 0; i < player->object_count; i++) {
        struct player_object *object = &player->objects[i];
        memcpy(object->x0, object->x1, object->vertex_count * sizeof *object->x0);
        object->joint = PCCD_NO_JOINT;
    }
    player->has_joints = false;
    eng_stage_begin(player->scene);
    player->is_staging = true;
}

static void stage_joints(struct player *player)
{
    struct eng_bad_joint bad;
    assert_ok(eng_stage_joints(player->scene, player->joints, PLAYER_JOINTS,
                               &player->joint_base, &bad));
}

/* Draw the joints of a step: around where objects are, turns of any size, and slides. */
static void draw_joints(struct player *player, struct prng *prng)
{
    for (uint32_t i = 0; i < PLAYER_JOINTS; i++) {
        struct pccd_joint *joint = &player->joints[i];
        *joint = (struct pccd_joint){.kind = PCCD_JOINT_TURN, .rotation = {0, 0, 0, 1}};
        joint->parent = prng_below(prng, 2) ? i - 1 : PCCD_NO_JOINT; /* 0 - 1: none */
        bool slides = prng_below(prng, 4) == 0;
        joint->kind = slides ? PCCD_JOINT_SLIDE : PCCD_JOINT_TURN;
        double most = slides ? 0.5 : prng_below(prng, 4) == 0 ? 7 : 0.5;
        play_somewhere(prng, PLAY_ONE, joint->position);
        play_somewhere(prng, PLAY_ONE, joint->axis);
        joint->axis[prng_below(prng, 3)] += 3; /* never of no length */
        joint->from[0] = prng_between(prng, -most, most);
        joint->to[0] = joint->from[0] + prng_between(prng, -most, most);
    }
    player->has_joints = true;
    stage_joints(player);
}

/* The object turns from one place of a joint to another. */
static int turn(struct player *player, struct player_object *object)
{
    double m[2][12];
    if (!player->has_joints) {
        draw_joints(player, player->turns_from);
    }
    object->joint = prng_u32(player->turns_from, PLAYER_JOINTS);
    for (int end = 0; end < 2; end++) {
        common_joint_transform(player->joints, object->joint, end, m[end]);
    }
    for (uint32_t i = 0; i < object->vertex_count; i++) {
        common_transform(m[0], object->registered[i], object->x0[i]);
        common_transform(m[1], object->registered[i], object->x1[i]);
    }
    return eng_stage_turning(player->scene, object->idx,
                             player->joint_base + object->joint);
}

/* The positions as the act wants them sent. Freed by the caller. */
static void *packed(const struct play_act *act, const double (*x)[3])
{
    if (!act->is_f32) {
        return test_copy(x, act->vertex_count * sizeof *x);
    }
    float(*floats)[3] = test_room(act->vertex_count * sizeof *floats);
    for (uint32_t i = 0; i < 3 * act->vertex_count; i++) {
        floats[i / 3][i % 3] = (float)x[i / 3][i % 3];
        assert_true((double)floats[i / 3][i % 3] == x[i / 3][i % 3]);
    }
    return floats;
}

/* As scene.h says: each operation rounded once. */
static void transform(const double m[12], const double from[3], double to[3])
{
    for (int k = 0; k < 3; k++) {
        const double *row = m + 4 * k;
        to[k] = ((row[0] * from[0] + row[1] * from[1]) + row[2] * from[2]) + row[3];
    }
}

static void move(struct player *player, const struct play_act *act)
{
    struct player_object *object = find(player, act->object_id);
    enum pccd_format format = act->is_f32 ? PCCD_FORMAT_F32 : PCCD_FORMAT_F64;
    uint32_t first = act->first;
    uint32_t count = act->vertex_count;
    int status;
    assert_true(first < object->vertex_count && count <= object->vertex_count - first);
    if (act->what == PLAY_RIGID && player->turns_from && count == object->vertex_count &&
        prng_below(player->turns_from, 4)) {
        status = turn(player, object);
    } else if (act->what == PLAY_RIGID) {
        for (uint32_t i = first; i < first + count; i++) {
            transform(act->m[0], object->registered[i], object->x0[i]);
            transform(act->m[1], object->registered[i], object->x1[i]);
        }
        status = eng_stage_rigid(player->scene, object->idx, first, count, act->m[0],
                                 act->m[1]);
    } else {
        void *x1 = packed(act, (const double(*)[3])act->x1);
        memcpy(object->x1 + first, act->x1, count * sizeof *object->x1);
        if (act->what == PLAY_X0X1) {
            void *x0 = packed(act, (const double(*)[3])act->x0);
            memcpy(object->x0 + first, act->x0, count * sizeof *object->x0);
            status =
                eng_stage_x0x1(player->scene, object->idx, format, first, count, x0, x1);
            free(x0);
        } else {
            status = eng_stage_x1(player->scene, object->idx, format, first, count, x1);
        }
        free(x1);
    }
    assert_ok(status);
}

void player_act(struct player *player, const struct play_act *act)
{
    switch (act->what) {
    case PLAY_ADD:
        add(player, act);
        break;
    case PLAY_REMOVE:
        take_away(player, act->object_id);
        break;
    case PLAY_REPLACE:
        replace(player, act);
        break;
    default:
        player_open(player);
        move(player, act);
        break;
    }
}

int player_step(struct player *player, const struct eng_question *settings,
                struct eng_step_result *result)
{
    player_open(player);
    player->is_staging = false;
    return eng_step(player->scene, settings, result);
}

void player_drop(struct player *player)
{
    if (player->is_staging) {
        eng_stage_abort(player->scene);
    }
    player->is_staging = false;
}

void player_stage_copies(struct player *player)
{
    player_drop(player);
    eng_stage_begin(player->scene);
    player->is_staging = true;
    if (player->has_joints) {
        stage_joints(player);
    }
    for (uint32_t i = 0; i < player->object_count; i++) {
        const struct player_object *object = &player->objects[i];
        if (object->joint != PCCD_NO_JOINT) {
            assert_ok(eng_stage_turning(player->scene, object->idx,
                                        player->joint_base + object->joint));
            continue;
        }
        assert_ok(eng_stage_x0x1(player->scene, object->idx, PCCD_FORMAT_F64, 0,
                                 object->vertex_count, object->x0, object->x1));
    }
}

void player_copy(const struct player *player, const struct eng_scene_settings *settings,
                 struct player *copy)
{
    player_init(copy, settings);
    for (uint32_t i = player->object_count; i-- > 0;) {
        const struct player_object *from = &player->objects[i];
        struct player_object *to = &copy->objects[copy->object_count++];
        size_t bytes = sizeof *from->x0;
        *to = *from;
        to->mesh = eng_mesh_acquire(from->mesh);
        to->registered = test_copy(from->registered, from->vertex_count * bytes);
        to->x0 = test_copy(from->x0, from->vertex_count * bytes);
        to->x1 = test_copy(from->x1, from->vertex_count * bytes);
        to->triangles =
            test_copy(from->triangles, from->triangle_count * sizeof *from->triangles);
        to->radii = test_copy(from->radii, from->vertex_count * sizeof *from->radii);
        assert_ok(eng_scene_add(copy->scene, to->mesh, to->id, &to->idx));
        set_thickness(copy, to);
    }
    struct filters_place places[PLAYER_OBJECTS_MAX];
    uint32_t count = list_places(copy, places);
    copy->filters = player->filters;
    memcpy(copy->joints, player->joints, sizeof copy->joints);
    copy->has_joints = player->has_joints;
    filters_apply(&copy->filters, copy->scene, places, count);
    player_stage_copies(copy);
}

/* A step of every object from x1 to `to` of it. */
static void take_detour(struct player *player, const struct eng_question *settings,
                        void (*to)(const struct player_object *, double (*)[3]))
{
    player_drop(player);
    eng_stage_begin(player->scene);
    for (uint32_t i = 0; i < player->object_count; i++) {
        const struct player_object *object = &player->objects[i];
        double(*x)[3] = test_copy(object->x1, object->vertex_count * sizeof *x);
        to(object, x);
        int status = eng_stage_x0x1(player->scene, object->idx, PCCD_FORMAT_F64, 0,
                                    object->vertex_count, object->x1, x);
        free(x);
        assert_ok(status);
    }
    kit_step(player->scene, settings);
}

static void to_start(const struct player_object *object, double (*x)[3])
{
    memcpy(x, object->x0, object->vertex_count * sizeof *x);
}

static void to_others(const struct player_object *object, double (*x)[3])
{
    for (uint32_t v = 0; v < object->vertex_count; v++) {
        memcpy(x[v], object->x1[(uint64_t)v * 7919 % object->vertex_count], sizeof *x);
    }
}

void player_go_back(struct player *player, const struct eng_question *settings)
{
    take_detour(player, settings, to_start);
}

void player_scramble(struct player *player, const struct eng_question *settings)
{
    take_detour(player, settings, to_others);
}
