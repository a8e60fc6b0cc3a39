/* test_reg_registry.c - what a client has told a daemon. */
#include "cases.h"

#include "pccd_types.h"
#include "prng.h"
#include "registry.h"

/* ---- what belongs to a handle ------------------------------------------------------ */

#define HANDLES 300u

/* Handles as a daemon gives them, and some that fall on the same place. */
static uint32_t handle_of(uint32_t i)
{
    return i % 3 == 0 ? (i + 1) << 20 : i % 3 == 1 ? 0x100000 + i : i + 1;
}

/* If it failed, a scene among many would not be found, or another one in its place: its
 * objects would not come back after a crash. */
CASE(map__has_what_was_put_last)
{
    struct prng prng = {prng_seed()};

    for (uint32_t round = 0; round < 50; round++) {
        struct registry_map map = {.entries = NULL};
        uint64_t told[HANDLES] = {0}; /* 0: not there */
        uint32_t count = 0;

        for (uint64_t step = 1; step <= 3000; step++) {
            uint32_t i = prng_u32(&prng, HANDLES);

            if (prng_below(&prng, 2) == 0) {
                assert_int_equal(registry_map_put(&map, handle_of(i), step), 0);
                count += told[i] == 0;
                told[i] = step;
            } else {
                registry_map_remove(&map, handle_of(i));
                count -= told[i] != 0;
                told[i] = 0;
            }
            assert_int_equal(map.count, count);
        }
        for (uint32_t i = 0; i < HANDLES; i++) {
            uint64_t value = 7;

            assert_int_equal(registry_map_get(&map, handle_of(i), &value), told[i] != 0);
            assert_int_equal(value, told[i] != 0 ? told[i] : 7);
        }
        registry_map_deinit(&map);
    }
}

/* ---- pairs that ignore each other -------------------------------------------------- */

#define OBJECTS 24u

/* Check what was told of pairs: 0 nothing, 1 they ignore each other, else a clearance. */
static void check_pairs(struct registry_pairs *pairs, int told[OBJECTS][OBJECTS])
{
    uint32_t count = 0;

    registry_pairs_settle(pairs);
    for (uint32_t i = 0; i < pairs->count; i++) {
        const struct registry_pair *pair = &pairs->said[i];

        assert_true(pair->a < pair->b && told[pair->a][pair->b]);
        assert_true(i == 0 || pairs->said[i - 1].a < pair->a ||
                    pairs->said[i - 1].b < pair->b); /* each once */
    }
    for (uint32_t a = 0; a < OBJECTS; a++) {
        for (uint32_t b = a + 1; b < OBJECTS; b++) {
            const struct registry_pair *pair = registry_pairs_find(pairs, b, a);
            assert_int_equal(pair != NULL, told[a][b] != 0);
            assert_true(pair == NULL || pair->ignored == (told[a][b] == 1));
            assert_true(registry_pairs_clearance(pairs, b, a) ==
                        (told[a][b] > 1 ? told[a][b] : -1));
            count += told[a][b] != 0;
        }
    }
    assert_int_equal(pairs->count, count);
}

/* If it failed, a daemon that was told anew would test pairs that the last one had been
 * told to ignore, or ignore those that it had not. */
CASE(pairs__are_the_last_word_on_each)
{
    struct prng prng = {prng_seed()};

    for (uint32_t round = 0; round < 100; round++) {
        struct registry_pairs pairs = {.count = 0};
        int told[OBJECTS][OBJECTS] = {{0}};

        for (uint32_t i = 0; i < 2000; i++) {
            uint32_t a = prng_u32(&prng, OBJECTS);
            uint32_t b = (a + 1 + prng_u32(&prng, OBJECTS - 1)) % OBJECTS;
            int word = (int)prng_below(&prng, 4);
            const struct registry_pair said = {.a = a,
                                               .b = b,
                                               .ignored = word == 1,
                                               .has_clearance = word > 1,
                                               .clearance = word};

            if (prng_below(&prng, 100) == 0) {
                registry_pairs_forget(&pairs, a);
                for (uint32_t k = 0; k < OBJECTS; k++) {
                    told[a][k] = told[k][a] = 0;
                }
            } else {
                assert_int_equal(registry_pairs_note(&pairs, &said), 0);
                told[a][b] = told[b][a] = word;
            }
            if (prng_below(&prng, 300) == 0) {
                check_pairs(&pairs, told);
            }
        }
        check_pairs(&pairs, told);
        assert_true(pairs.room <= 1024); /* it does not grow with what was said twice */
        registry_pairs_deinit(&pairs);
    }
}

/* ---- where objects are ------------------------------------------------------------- */

#define VERTICES 13u

static double draw(struct prng *prng)
{
    return (double)prng_below(prng, 1u << 20) / 1000.0 - 500.0;
}

/* Positions or matrices of a motion, in bytes that are not aligned. */
struct payload {
    uint8_t start[1 + sizeof(double[VERTICES][3])];
    uint8_t end[1 + sizeof(double[VERTICES][3])];
};

static void fill(struct prng *prng, const struct registry_motion *motion, uint8_t *to)
{
    size_t count = motion->is_rigid ? 12 : 3 * motion->count;

    for (size_t i = 0; i < count; i++) {
        double wide = draw(prng);
        float narrow = (float)wide;

        if (motion->is_rigid || motion->format == PCCD_FORMAT_F64) {
            memcpy(to + i * sizeof wide, &wide, sizeof wide);
        } else {
            memcpy(to + i * sizeof narrow, &narrow, sizeof narrow);
        }
    }
}

static struct registry_motion draw_motion(struct prng *prng, struct payload *payload)
{
    struct registry_motion motion = {.is_rigid = prng_below(prng, 3) == 0,
                                     .format = prng_u32(prng, 2),
                                     .count = VERTICES};

    if (prng_below(prng, 2) == 0) {
        motion.first = prng_u32(prng, VERTICES);
        motion.count = prng_u32(prng, VERTICES - motion.first + 1);
    }
    fill(prng, &motion, payload->start + 1);
    fill(prng, &motion, payload->end + 1);
    motion.start =
        prng_below(prng, 2) == 0 || motion.is_rigid ? payload->start + 1 : NULL;
    motion.end = payload->end + 1;
    return motion;
}

static struct registry_object *make(struct prng *prng, struct registry *registry,
                                    uint32_t format)
{
    const struct registry_settings plain = {.name = ""};
    static const uint32_t faces[1][3] = {{0, 1, 2}};
    const struct registry_motion whole = {.format = format, .count = VERTICES};
    uint8_t x[sizeof(double[VERTICES][3])];
    struct registry_scene *scene = registry_add_scene(registry, 1, &plain);
    struct registry_mesh *mesh;
    struct registry_object *object;

    fill(prng, &whole, x);
    mesh = registry_mesh_copy(&(struct registry_shape){.format = format,
                                                       .vertex_count = VERTICES,
                                                       .triangle_count = 1,
                                                       .x = x,
                                                       .triangles = faces});
    assert_true(scene != NULL && mesh != NULL);
    assert_int_equal(registry_put_mesh(registry, 2, mesh, 1), 0);
    object = registry_add_object(scene, mesh, 3, 1);
    assert_non_null(object);
    return object;
}

/* One vertex of an object whose end alone is followed. */
static void end_of(const struct registry_object *object, uint32_t vertex, double to[3])
{
    const struct registry_mesh *mesh = object->mesh;
    bool own = object->placing == REGISTRY_FREELY;
    const void *from = own ? object->x : mesh->x;
    double x[3];

    for (uint32_t k = 0; k < 3; k++) {
        x[k] = (own ? object->format : mesh->format) == PCCD_FORMAT_F64
                   ? ((const double *)from)[3 * vertex + k]
                   : (double)((const float *)from)[3 * vertex + k];
    }
    for (uint32_t k = 0; k < 3; k++) {
        const double *r = object->m + 4 * k;

        to[k] = object->placing == REGISTRY_RIGID
                    ? ((r[0] * x[0] + r[1] * x[1]) + r[2] * x[2]) + r[3]
                    : x[k];
    }
}

/* If it failed, another daemon would be told of other positions than a recording of the
 * same client is repeated with, or than the last daemon has computed with. */
CASE(ends__are_the_same_in_both_ways)
{
    struct prng prng = {prng_seed()};

    for (uint32_t round = 0; round < 400; round++) {
        struct registry compact = {.meshes = NULL};
        struct registry both = {.meshes = NULL};
        struct prng again = prng;
        struct registry_object *a = make(&prng, &compact, round % 2);
        struct registry_object *b = make(&again, &both, round % 2);
        double last[VERTICES][3];

        assert_int_equal(registry_follow(b), 0);
        for (uint32_t step = 0; step < 8; step++) {
            struct payload payload;
            const struct registry_motion motion = draw_motion(&prng, &payload);

            memcpy(last, b->x1, sizeof last);
            assert_int_equal(registry_place(a, &motion), 0);
            registry_begin_step(both.scenes);
            registry_move(b, &motion);
            for (uint32_t v = 0; v < VERTICES; v++) {
                bool moves = v >= motion.first && v - motion.first < motion.count;
                double end[3];

                end_of(a, v, end);
                assert_memory_equal(end, b->x1[v], sizeof end);
                if (motion.start == NULL || !moves) {
                    assert_memory_equal(last[v], b->x0[v], sizeof last[v]);
                }
            }
        }
        registry_deinit(&compact);
        registry_deinit(&both);
    }
}

/* If it failed, a rigid body would cost as much as its vertices do, for each client. */
CASE(rigid_bodies__are_kept_as_transforms)
{
    struct prng prng = {prng_seed()};
    struct registry registry = {.meshes = NULL};
    struct registry_object *object = make(&prng, &registry, PCCD_FORMAT_F32);
    struct payload payload;
    const struct registry_motion motion = {.is_rigid = true,
                                           .format = PCCD_FORMAT_F64,
                                           .count = VERTICES,
                                           .end = payload.end + 1};

    fill(&prng, &motion, payload.end + 1);
    assert_int_equal(registry_place(object, &motion), 0);
    assert_int_equal(object->placing, REGISTRY_RIGID);
    assert_null(object->x);
    registry_deinit(&registry);
}

/* ---- all of it --------------------------------------------------------------------- */

static const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const uint32_t faces[1][3] = {{0, 1, 2}};
static const struct registry_settings plain = {.rights = 0600, .name = ""};

static struct registry_mesh *triangle(void)
{
    struct registry_mesh *made =
        registry_mesh_copy(&(struct registry_shape){.format = PCCD_FORMAT_F32,
                                                    .vertex_count = 3,
                                                    .triangle_count = 1,
                                                    .x = corners,
                                                    .triangles = faces});

    assert_non_null(made);
    return made;
}

static void set(struct registry_object *object, uint32_t what, uint64_t group,
                uint64_t mask, bool self_collision)
{
    const struct common_attributes given = {
        .group = group, .mask = mask, .self_collision = self_collision};

    registry_set_object(object, what, &given);
}

/* If it failed, a daemon could not be told of an object whose mesh the client has
 * destroyed, or meshes would be kept for ever. */
CASE(mesh__stays_while_objects_are_made_of_it)
{
    struct registry registry = {.meshes = NULL};
    struct registry_scene *scene;
    struct registry_object *object;

    assert_int_equal(registry_put_mesh(&registry, 7, triangle(), 1), 0);
    scene = registry_add_scene(&registry, 1, &plain);
    assert_non_null(scene);
    object = registry_add_object(scene, registry_mesh(&registry, 7), 3, 1);
    assert_non_null(object);
    registry_destroy_mesh(&registry, registry_mesh(&registry, 7));
    assert_null(registry_mesh(&registry, 7));
    assert_ptr_equal(object->mesh, registry.meshes);
    assert_memory_equal(object->mesh->x, corners, sizeof corners);

    /* Another mesh may get its handle meanwhile. */
    assert_int_equal(registry_put_mesh(&registry, 7, triangle(), 1), 0);
    assert_ptr_not_equal(registry_mesh(&registry, 7), object->mesh);
    registry_remove_object(&registry, scene, object);
    assert_ptr_equal(registry.meshes, registry_mesh(&registry, 7));
    assert_null(registry.meshes->next);
    registry_destroy_mesh(&registry, registry_mesh(&registry, 7));
    assert_null(registry.meshes);
    registry_deinit(&registry);
    assert_null(registry.scenes);
}

/* If it failed, objects would be told to another daemon under wrong handles, or in an
 * order other than the handles', in which answers list them. */
CASE(objects__lie_in_the_order_of_their_handles)
{
    static const uint32_t handles[] = {40, 10, 30, 20, 50};
    struct registry registry = {.meshes = NULL};
    struct registry_scene *scene = registry_add_scene(&registry, 1, &plain);
    struct registry_mesh *mesh;

    assert_non_null(scene);
    assert_int_equal(registry_put_mesh(&registry, 7, triangle(), 1), 0);
    mesh = registry_mesh(&registry, 7);
    for (uint32_t i = 0; i < 5; i++) {
        assert_non_null(registry_add_object(scene, mesh, handles[i], 1));
    }
    assert_int_equal(mesh->object_count, 5);
    for (uint32_t i = 0; i < 5; i++) {
        assert_int_equal(scene->objects[i].handle, 10 * (i + 1));
        assert_ptr_equal(registry_object(scene, 10 * (i + 1)), &scene->objects[i]);
    }
    assert_null(registry_object(scene, 15));
    registry_remove_object(&registry, scene, registry_object(scene, 30));
    assert_null(registry_object(scene, 30));
    assert_int_equal(registry_object(scene, 40)->handle, 40);
    assert_int_equal(scene->object_count, 4);
    registry_deinit(&registry);
}

/* If it failed, a step that came before a mesh was replaced would move the new one. */
CASE(replacement__puts_objects_where_it_was_registered)
{
    static const double moved[12] = {1, 0, 0, 5, 0, 1, 0, 5, 0, 0, 1, 5};
    const struct registry_motion motion = {.is_rigid = true, .count = 3, .end = moved};
    struct registry registry = {.meshes = NULL};
    struct registry_scene *scene = registry_add_scene(&registry, 1, &plain);
    struct registry_object *object;

    assert_non_null(scene);
    assert_int_equal(registry_put_mesh(&registry, 7, triangle(), 1), 0);
    object = registry_add_object(scene, registry_mesh(&registry, 7), 3, 1);
    assert_non_null(object);
    assert_int_equal(registry_place(object, &motion), 0);
    assert_int_equal(object->placing, REGISTRY_RIGID);
    assert_int_equal(registry_put_mesh(&registry, 7, triangle(), 9), 0);
    assert_ptr_equal(object->mesh, registry_mesh(&registry, 7));
    assert_int_equal(object->placing, REGISTRY_AS_REGISTERED);
    assert_int_equal(object->since, 9);
    registry_deinit(&registry);
}

/* If it failed, what others have put into a shared scene would be repeated with masks
 * that nobody has set, or with none. */
CASE(guest__gets_a_shape_and_keeps_what_it_may_meet)
{
    struct registry registry = {.meshes = NULL};
    struct registry_scene *scene = registry_add_scene(&registry, 1, &plain);
    struct registry_object *object;

    assert_non_null(scene);
    object = registry_put_guest(&registry, scene, 3, triangle());
    assert_non_null(object);
    set(object, PCCD_OBJECT_GROUP | PCCD_OBJECT_SELF, 4, 0, false);
    object = registry_put_guest(&registry, scene, 3, triangle());
    assert_non_null(object);
    assert_int_equal(scene->object_count, 1);
    assert_int_equal(object->attributes.group, 4);
    assert_true(object->attributes.mask == UINT64_MAX);
    assert_false(object->attributes.self_collision);
    assert_ptr_equal(registry.meshes, object->mesh); /* the first is gone */
    assert_null(registry.meshes->next);
    registry_remove_object(&registry, scene, object);
    assert_null(registry.meshes);
    registry_deinit(&registry);
}

/* If it failed, contacts of objects that were masked would be held against the daemon, or
 * those that are missing would not. */
CASE(objects__meet_as_groups_masks_and_pairs_say)
{
    struct registry registry = {.meshes = NULL};
    struct registry_scene *scene = registry_add_scene(&registry, 1, &plain);
    struct registry_object *a;
    struct registry_object *b;

    assert_non_null(scene);
    assert_int_equal(registry_put_mesh(&registry, 7, triangle(), 1), 0);
    assert_non_null(registry_add_object(scene, registry_mesh(&registry, 7), 3, 1));
    assert_non_null(registry_add_object(scene, registry_mesh(&registry, 7), 4, 1));
    a = registry_object(scene, 3);
    b = registry_object(scene, 4);
    assert_true(registry_may_meet(scene, a, b) && registry_may_meet(scene, a, a));

    set(a, PCCD_OBJECT_MASK, 0, 2, false);
    assert_false(registry_may_meet(scene, a, b));
    set(b, PCCD_OBJECT_GROUP, 2, 0, false);
    assert_true(registry_may_meet(scene, b, a));
    set(a, PCCD_OBJECT_SELF, 0, 0, false);
    assert_false(registry_may_meet(scene, a, a));
    const struct registry_pair said = {.a = 4, .b = 3, .ignored = true};
    assert_int_equal(registry_pairs_note(&scene->pairs, &said), 0);
    registry_pairs_settle(&scene->pairs);
    assert_false(registry_may_meet(scene, a, b));
    registry_remove_object(&registry, scene, b);
    assert_int_equal(scene->pairs.count, 0);
    registry_deinit(&registry);
}
