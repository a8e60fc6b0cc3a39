/* daemon/engine/scene/scene.c - objects come and go.
 *
 * Room:     engine.
 * Does:     give every object its range of vertices, where it stands, and the order of
 *           its features.
 * Does not: make binary hierarchies (object.c of tree/: when a step asks for them), stage
 *           positions (stage.c) or step (step.c).
 * Threads:  [compute].
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "build.h"
#include "memory.h"
#include "stage.h"
#include "step_memory.h"
#include "world.h"

static bool settings_are_valid(const struct eng_scene_settings *settings)
{
    return settings->quality >= ENG_QUALITY_MEDIAN &&
           settings->quality <= ENG_QUALITY_SAH && settings->rebuild_ratio >= 0 &&
           settings->rebuild_ratio <= 1 && settings->rebuild_triangles_max >= 1;
}

int eng_scene_new(const struct eng_scene_settings *settings, struct eng_scene **scene)
{
    const struct eng_scene_settings defaults = ENG_SCENE_SETTINGS_DEFAULT;
    settings = settings ? settings : &defaults;
    if (!settings_are_valid(settings)) {
        return ENG_E_INVAL;
    }
    struct eng_scene *s = eng_alloc(1, sizeof *s);
    if (!s) {
        return ENG_E_NOMEM;
    }
    memset(s, 0, sizeof *s);
    s->settings = *settings;
    eng_ranges_init(&s->vertex_ranges, ENG_COUNT_MAX);
    eng_ranges_init(&s->edge_ranges, ENG_COUNT_MAX);
    eng_ranges_init(&s->triangle_ranges, ENG_COUNT_MAX);
    eng_ranges_init(&s->node_ranges, UINT32_MAX - 1);
    s->root = ENG_NO_NODE;
    s->framing.scale = 1;
    eng_wide_init(&s->wide);
    eng_masks_init(&s->masks);
    s->memory = eng_step_memory_new();
    if (!s->memory) {
        eng_free(s);
        return ENG_E_NOMEM;
    }
    *scene = s;
    return ENG_OK;
}

void eng_scene_free(struct eng_scene *scene)
{
    if (!scene) {
        return;
    }
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        eng_mesh_release(scene->objects[i].mesh);
        eng_free(scene->objects[i].order);
    }
    eng_wide_deinit(&scene->wide);
    eng_masks_deinit(&scene->masks);
    eng_step_memory_free(scene->memory);
    eng_ranges_deinit(&scene->vertex_ranges);
    eng_ranges_deinit(&scene->edge_ranges);
    eng_ranges_deinit(&scene->triangle_ranges);
    eng_ranges_deinit(&scene->node_ranges);
    eng_free(scene->objects);
    eng_free(scene->replaced);
    eng_free(scene->x[0]);
    eng_free(scene->x[1]);
    eng_free(scene->start);
    eng_free(scene->vertices);
    eng_free(scene->edges);
    eng_free(scene->triangles);
    eng_free(scene->nodes);
    eng_free(scene->upkeep);
    eng_free(scene->top_items);
    eng_free(scene->framing.items);
    eng_free(scene->writes);
    eng_free(scene);
}

/* A free object index, growing the table if need be. ENG_E_INVAL: `id` is in use. */
static int find_place(struct eng_scene *scene, uint32_t id, uint32_t *object_idx)
{
    uint32_t place = scene->object_capacity;
    for (uint32_t i = scene->object_capacity; i-- > 0;) {
        if (!scene->objects[i].mesh) {
            place = i;
        } else if (scene->objects[i].id == id) {
            return ENG_E_INVAL;
        }
    }
    if (place == scene->object_capacity) {
        uint32_t capacity =
            eng_world_grown(scene->object_capacity, scene->object_capacity + 8);
        if (eng_masks_reserve(&scene->masks, capacity) != ENG_OK ||
            eng_world_grow(&scene->framing.items, capacity,
                           sizeof *scene->framing.items) != ENG_OK ||
            eng_world_grow(&scene->objects, capacity, sizeof *scene->objects) != ENG_OK) {
            return ENG_E_NOMEM;
        }
        memset(scene->objects + place, 0, (capacity - place) * sizeof *scene->objects);
        scene->object_capacity = capacity;
    }
    *object_idx = place;
    return ENG_OK;
}

static void give_all(struct eng_scene *scene, struct eng_object *object)
{
    eng_object_fell(scene, object);
    eng_ranges_give(&scene->vertex_ranges, object->vertices.first,
                    object->vertices.count);
    eng_free(object->order);
    object->order = NULL;
}

static int take_all(struct eng_scene *scene, struct eng_object *object,
                    const struct eng_mesh *mesh)
{
    uint32_t first;
    int status = eng_ranges_take(&scene->vertex_ranges, mesh->info.vertex_count, &first);
    if (status != ENG_OK) {
        return status;
    }
    object->vertices = (struct eng_range){first, mesh->info.vertex_count};
    status = eng_world_reserve(scene);
    if (status == ENG_OK) {
        status = eng_wide_order_new(mesh, (const double(*)[3])mesh->x,
                                    scene->settings.threads, &object->order);
    }
    if (status != ENG_OK) {
        give_all(scene, object);
    }
    return status;
}

/* Make an object of `mesh` at a place of the table, at its registered positions. On
 * failure the place holds what it held. */
static int place(struct eng_scene *scene, uint32_t idx, struct eng_mesh *mesh,
                 uint32_t object_id)
{
    struct eng_object object = {.id = object_id,
                                .bounds = {mesh->bounds, mesh->bounds},
                                .frame = {.scale = 1},
                                .still = true};
    int status = take_all(scene, &object, mesh);
    if (status != ENG_OK) {
        return status;
    }
    size_t x_bytes = object.vertices.count * sizeof *mesh->x;
    memcpy(scene->x[0] + object.vertices.first, mesh->x, x_bytes);
    memcpy(scene->x[1] + object.vertices.first, mesh->x, x_bytes);
    object.mesh = eng_mesh_acquire(mesh);
    scene->objects[idx] = object;
    scene->triangle_count += mesh->info.triangle_count;
    scene->builds++;
    scene->top_is_stale = true;
    scene->wide.is_stale = true;
    eng_step_memory_forget(scene->memory);
    return ENG_OK;
}

int eng_scene_add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t object_id,
                  uint32_t *object_idx)
{
    if (scene->staging || !eng_mesh_is_committed(mesh)) {
        return ENG_E_STATE;
    }
    uint32_t idx;
    int status = find_place(scene, object_id, &idx);
    if (status == ENG_OK) {
        status = place(scene, idx, mesh, object_id);
    }
    if (status != ENG_OK) {
        return status;
    }
    scene->object_count++;
    *object_idx = idx;
    return ENG_OK;
}

/* Room for one more entry of scene->replaced. */
static int reserve_replaced(struct eng_scene *scene)
{
    if (scene->replaced_count < scene->replaced_capacity) {
        return ENG_OK;
    }
    uint32_t capacity =
        eng_world_grown(scene->replaced_capacity, scene->replaced_count + 1);
    int status = eng_world_grow(&scene->replaced, capacity, sizeof *scene->replaced);
    scene->replaced_capacity = status == ENG_OK ? capacity : scene->replaced_capacity;
    return status;
}

int eng_scene_try_replace(struct eng_scene *scene, uint32_t object_idx,
                          struct eng_mesh *mesh)
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!object) {
        return ENG_E_INVAL;
    }
    if (scene->staging || !eng_mesh_is_committed(mesh)) {
        return ENG_E_STATE;
    }
    int status = reserve_replaced(scene);
    if (status != ENG_OK) {
        return status;
    }
    struct eng_object before = *object;
    status = place(scene, object_idx, mesh, before.id);
    if (status == ENG_OK) {
        scene->triangle_count -= before.mesh->info.triangle_count;
        scene->replaced[scene->replaced_count++] =
            (struct eng_replaced){.object = object_idx, .before = before};
    }
    return status;
}

void eng_scene_settle(struct eng_scene *scene)
{
    while (scene->replaced_count > 0) {
        struct eng_object *before = &scene->replaced[--scene->replaced_count].before;
        give_all(scene, before);
        eng_mesh_release(before->mesh);
    }
}

void eng_scene_take_back(struct eng_scene *scene)
{
    while (scene->replaced_count > 0) {
        struct eng_replaced *replaced = &scene->replaced[--scene->replaced_count];
        struct eng_object *object = &scene->objects[replaced->object];
        give_all(scene, object);
        scene->triangle_count -= object->mesh->info.triangle_count;
        eng_mesh_release(object->mesh);
        *object = replaced->before;
        scene->triangle_count += object->mesh->info.triangle_count;
    }
}

int eng_scene_replace(struct eng_scene *scene, uint32_t object_idx, struct eng_mesh *mesh)
{
    assert(scene->replaced_count == 0);
    int status = eng_scene_try_replace(scene, object_idx, mesh);
    if (status == ENG_OK) {
        eng_scene_settle(scene);
    }
    return status;
}

int eng_scene_remove(struct eng_scene *scene, uint32_t object_idx)
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!object) {
        return ENG_E_INVAL;
    }
    if (scene->staging) {
        return ENG_E_STATE;
    }
    give_all(scene, object);
    eng_masks_forget(&scene->masks, object_idx);
    scene->triangle_count -= object->mesh->info.triangle_count;
    eng_mesh_release(object->mesh);
    object->mesh = NULL;
    scene->object_count--;
    scene->top_is_stale = true;
    scene->wide.is_stale = true;
    eng_step_memory_forget(scene->memory);
    return ENG_OK;
}

int eng_scene_set_filter(struct eng_scene *scene, uint32_t object_idx,
                         const struct eng_object_filter *filter)
{
    if (!eng_scene_object(scene, object_idx)) {
        return ENG_E_INVAL;
    }
    eng_masks_set(&scene->masks, object_idx, filter);
    return ENG_OK;
}

int eng_scene_get_filter(const struct eng_scene *scene, uint32_t object_idx,
                         struct eng_object_filter *filter)
{
    if (!eng_scene_object(scene, object_idx)) {
        return ENG_E_INVAL;
    }
    const struct eng_masks_entry *entry = &scene->masks.entries[object_idx];
    *filter = (struct eng_object_filter){entry->group, entry->mask, entry->self};
    return ENG_OK;
}

int eng_scene_hide(struct eng_scene *scene, uint32_t object_idx)
{
    if (!eng_scene_object(scene, object_idx)) {
        return ENG_E_INVAL;
    }
    eng_masks_hide(&scene->masks, object_idx);
    return ENG_OK;
}

void eng_scene_forget_hidden(struct eng_scene *scene)
{
    eng_masks_forget_hidden(&scene->masks);
}

int eng_scene_ignore(struct eng_scene *scene, uint32_t a_idx, uint32_t b_idx,
                     bool ignored)
{
    if (a_idx == b_idx || !eng_scene_object(scene, a_idx) ||
        !eng_scene_object(scene, b_idx)) {
        return ENG_E_INVAL;
    }
    return eng_masks_ignore(&scene->masks, a_idx, b_idx, ignored);
}

uint32_t eng_scene_ignored_count(const struct eng_scene *scene)
{
    return scene->masks.ignored.count;
}

bool eng_scene_next_ignored(const struct eng_scene *scene, uint32_t *from,
                            uint32_t pair_idx[2])
{
    return eng_pairset_next(&scene->masks.ignored, from, pair_idx);
}

uint32_t eng_scene_object_id(const struct eng_scene *scene, uint32_t object_idx)
{
    return scene->objects[object_idx].id;
}

const struct eng_mesh *eng_scene_mesh(const struct eng_scene *scene, uint32_t object_idx)
{
    return scene->objects[object_idx].mesh;
}

bool eng_scene_was_moved(const struct eng_scene *scene, uint32_t object_idx)
{
    return scene->objects[object_idx].staged == scene->stage;
}

const double (*eng_scene_positions(const struct eng_scene *scene, uint32_t object_idx,
                                   unsigned end))[3]
{
    const double(*x)[3] =
        (const double(*)[3])scene->x[end == 0 ? 1 - scene->now : scene->now];
    return x + scene->objects[object_idx].vertices.first;
}

uint32_t eng_scene_object_count(const struct eng_scene *scene)
{
    return scene->object_count;
}

uint32_t eng_scene_vertex_count(const struct eng_scene *scene, uint32_t object_idx)
{
    const struct eng_object *object = eng_scene_object(scene, object_idx);
    return object ? object->vertices.count : 0;
}

uint64_t eng_scene_bytes(const struct eng_scene *scene)
{
    uint64_t orders = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            orders += scene->objects[i].order->bytes;
        }
    }
    return orders + eng_wide_bytes(&scene->wide) + eng_masks_bytes(&scene->masks) +
           sizeof *scene + (uint64_t)scene->object_capacity * sizeof *scene->objects +
           (uint64_t)scene->object_capacity * sizeof *scene->framing.items +
           (uint64_t)scene->replaced_capacity * sizeof *scene->replaced +
           (uint64_t)scene->vertex_capacity * 2 * sizeof *scene->x[0] +
           (uint64_t)scene->box_capacity * sizeof *scene->vertices +
           (uint64_t)scene->start_capacity * sizeof *scene->start +
           (uint64_t)scene->edge_capacity * sizeof *scene->edges +
           (uint64_t)scene->triangle_capacity * sizeof *scene->triangles +
           (uint64_t)scene->node_capacity *
               (sizeof *scene->nodes + sizeof *scene->upkeep) +
           (uint64_t)scene->top_item_capacity * sizeof *scene->top_items +
           (uint64_t)scene->write_capacity * sizeof *scene->writes +
           eng_step_memory_bytes(scene->memory);
}
