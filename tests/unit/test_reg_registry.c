/* test_reg_registry.c - what a client has told a daemon. */
#include "cases.h"
#include "pccd_types.h"
#include "registry.h"

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
    assert_false(registry_is_filtered(scene));

    set(a, PCCD_OBJECT_MASK, 0, 2, false);
    assert_true(registry_is_filtered(scene));
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
