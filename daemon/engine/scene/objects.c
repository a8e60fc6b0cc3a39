/* objects.c - objects come and go. */
#include <assert.h>
#include <string.h>

#include "memory.h"
#include "thickness.h"
#include "topology.h"
#include "world.h"

/* An object as it was before a replacement that is not settled. */
struct eng_replaced {
    uint32_t object;
    struct eng_object before;
};

static bool settings_are_valid(const struct eng_scene_settings *settings)
{
    return settings->rebuild_ratio >= 0 && settings->rebuild_ratio <= 1 &&
           settings->region_triangles >= 1;
}

int eng_world_new(const struct eng_scene_settings *settings,
                  const struct eng_slot_calls *const owners[ENG_SLOTS],
                  struct eng_scene **scene)
{
    assert(owners && scene);
    const struct eng_scene_settings defaults = ENG_SCENE_SETTINGS_DEFAULT;
    settings = settings ? settings : &defaults;
    if (!settings_are_valid(settings)) {
        return PCCD_E_INVAL;
    }
    struct eng_scene *s = eng_alloc(1, sizeof *s);
    if (!s) {
        return PCCD_E_NOMEM;
    }
    memset(s, 0, sizeof *s);
    s->settings = *settings;
    s->owners = owners;
    eng_ranges_init(&s->vertex_ranges, PROTO_COUNT_MAX);
    s->framing.scale = 1;
    s->moving.number = 1;
    eng_masks_init(&s->masks);
    int status = PCCD_OK;
    for (int i = 0; i < ENG_SLOTS && status == PCCD_OK; i++) {
        status = owners[i]->create(s);
    }
    if (status != PCCD_OK) {
        eng_scene_free(s);
        return status;
    }
    *scene = s;
    return PCCD_OK;
}

static void drop_all(struct eng_scene *scene, struct eng_object *object)
{
    for (int i = 0; i < ENG_SLOTS; i++) {
        if (scene->owners[i]->drop) {
            scene->owners[i]->drop(scene, object);
        }
        assert(!object->slots[i]);
    }
}

static int add_all(struct eng_scene *scene, struct eng_object *object)
{
    int status = PCCD_OK;
    for (int i = 0; i < ENG_SLOTS && status == PCCD_OK; i++) {
        status = scene->owners[i]->add ? scene->owners[i]->add(scene, object) : PCCD_OK;
    }
    return status;
}

static void tell_changed(struct eng_scene *scene)
{
    for (int i = 0; i < ENG_SLOTS; i++) {
        if (scene->owners[i]->changed) {
            scene->owners[i]->changed(scene);
        }
    }
}

/* A scene of this many leaves, or less, keeps its memory for what will come. */
#define LEAVES_KEPT  (1u << 15)
#define EMPTIED_PART 16u

static void look_if_emptied(struct eng_scene *scene)
{
    if (scene->leaf_most <= LEAVES_KEPT ||
        scene->leaf_count >= scene->leaf_most / EMPTIED_PART) {
        return;
    }
    scene->leaf_most = scene->leaf_count;
    for (int i = 0; i < ENG_SLOTS; i++) {
        if (scene->owners[i]->emptied) {
            scene->owners[i]->emptied(scene);
        }
    }
}

void eng_scene_free(struct eng_scene *scene)
{
    if (!scene) {
        return;
    }
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            drop_all(scene, &scene->objects[i]);
            eng_free(scene->objects[i].poses);
            eng_mesh_release(scene->objects[i].mesh);
        }
    }
    for (int i = 0; i < ENG_SLOTS; i++) {
        scene->owners[i]->destroy(scene);
    }
    eng_masks_deinit(&scene->masks);
    eng_ranges_deinit(&scene->vertex_ranges);
    eng_ids_deinit(&scene->ids);
    eng_free(scene->objects);
    eng_free(scene->replaced);
    eng_free(scene->x[0]);
    eng_free(scene->x[1]);
    eng_free(scene->start);
    eng_free(scene->part.x[0]);
    eng_free(scene->part.x[1]);
    eng_free(scene->part.bounds);
    eng_free(scene->moving.moves);
    eng_free(scene->framing.items);
    eng_free(scene->writes);
    eng_free(scene->joints.items);
    eng_free(scene->staged_joints.items);
    eng_free(scene);
}

/* The lowest free object index, growing the tables if need be. PCCD_E_INVAL: `id` is in
 * use. */
static int find_place(struct eng_scene *scene, uint32_t id, uint32_t *object_idx)
{
    if (eng_ids_find(&scene->ids, id) != ENG_NO_OBJECT) {
        return PCCD_E_INVAL;
    }
    if (eng_ids_reserve(&scene->ids, scene->object_count + 1) != PCCD_OK) {
        return PCCD_E_NOMEM;
    }
    uint32_t place = scene->object_free;
    while (place < scene->object_capacity && scene->objects[place].mesh) {
        place++;
    }
    scene->object_free = place;
    if (place == scene->object_capacity) {
        uint32_t capacity =
            eng_array_grown(scene->object_capacity, scene->object_capacity + 8);
        if (eng_masks_reserve(&scene->masks, capacity) != PCCD_OK ||
            eng_array_grow(&scene->framing.items, capacity,
                           sizeof *scene->framing.items) != PCCD_OK ||
            eng_array_grow(&scene->objects, capacity, sizeof *scene->objects) !=
                PCCD_OK) {
            return PCCD_E_NOMEM;
        }
        memset(scene->objects + place, 0, (capacity - place) * sizeof *scene->objects);
        scene->object_capacity = capacity;
    }
    *object_idx = place;
    return PCCD_OK;
}

static void give_all(struct eng_scene *scene, struct eng_object *object)
{
    drop_all(scene, object);
    eng_free(object->poses);
    object->poses = NULL;
    eng_ranges_give(&scene->vertex_ranges, object->vertices.first,
                    object->vertices.count);
}

static int take_all(struct eng_scene *scene, struct eng_object *object)
{
    uint32_t first;
    uint32_t count = object->mesh->info.vertex_count;
    int status = eng_ranges_take(&scene->vertex_ranges, count, &first);
    if (status != PCCD_OK) {
        return status;
    }
    object->vertices = (struct eng_range){first, count};
    status = eng_world_reserve(scene);
    if (status == PCCD_OK) {
        status = add_all(scene, object);
    }
    if (status != PCCD_OK) {
        give_all(scene, object);
    }
    return status;
}

/* Make an object of `mesh` at a place of the table, at its registered positions. On
 * failure the place holds what it held. */
static int place(struct eng_scene *scene, uint32_t idx, struct eng_mesh *mesh,
                 uint32_t object_id)
{
    struct eng_object object = {.mesh = mesh,
                                .id = object_id,
                                .bounds = {mesh->bounds, mesh->bounds},
                                .frame = {.scale = 1},
                                .joint = PCCD_NO_JOINT,
                                .moved_number = scene->moving.number,
                                .ends_are_equal = true,
                                .is_new = true};
    int status = take_all(scene, &object);
    if (status != PCCD_OK) {
        return status;
    }
    size_t x_bytes = object.vertices.count * sizeof *mesh->x;
    memcpy(scene->x[0] + object.vertices.first, mesh->x, x_bytes);
    memcpy(scene->x[1] + object.vertices.first, mesh->x, x_bytes);
    eng_mesh_acquire(mesh);
    scene->objects[idx] = object;
    eng_thickness_look(scene, &object);
    scene->leaf_count += mesh->leaf_count;
    scene->leaf_most =
        scene->leaf_count > scene->leaf_most ? scene->leaf_count : scene->leaf_most;
    scene->builds++;
    tell_changed(scene);
    return PCCD_OK;
}

int eng_scene_add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t object_id,
                  uint32_t *object_idx)
{
    if (scene->staging || !eng_mesh_is_committed(mesh)) {
        return PCCD_E_STATE;
    }
    uint32_t idx;
    int status = find_place(scene, object_id, &idx);
    if (status == PCCD_OK) {
        status = place(scene, idx, mesh, object_id);
    }
    if (status != PCCD_OK) {
        return status;
    }
    eng_ids_add(&scene->ids, object_id, idx);
    scene->object_count++;
    *object_idx = idx;
    return PCCD_OK;
}

/* Room for one more entry of scene->replaced. */
static int reserve_replaced(struct eng_scene *scene)
{
    return eng_array_extend(&scene->replaced, &scene->replaced_capacity,
                            scene->replaced_count + 1, sizeof *scene->replaced);
}

int eng_scene_try_replace(struct eng_scene *scene, uint32_t object_idx,
                          struct eng_mesh *mesh)
{
    assert(mesh);
    struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!object) {
        return PCCD_E_INVAL;
    }
    if (scene->staging || !eng_mesh_is_committed(mesh)) {
        return PCCD_E_STATE;
    }
    int status = reserve_replaced(scene);
    if (status == PCCD_OK) {
        status = eng_rings_prepare(mesh, object->thickness.rest_rings, NULL);
    }
    if (status != PCCD_OK) {
        return status;
    }
    struct eng_object before = *object;
    status = place(scene, object_idx, mesh, before.id);
    if (status == PCCD_OK) {
        object->thickness = before.thickness;
        object->half_clearance = before.half_clearance;
        eng_thickness_look(scene, object);
        scene->leaf_count -= before.mesh->leaf_count;
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
    look_if_emptied(scene);
}

void eng_scene_take_back(struct eng_scene *scene)
{
    while (scene->replaced_count > 0) {
        struct eng_replaced *replaced = &scene->replaced[--scene->replaced_count];
        struct eng_object *object = &scene->objects[replaced->object];
        give_all(scene, object);
        scene->leaf_count -= object->mesh->leaf_count;
        eng_mesh_release(object->mesh);
        *object = replaced->before;
        if (scene->framing.number == 0) {
            object->frame = (struct eng_box_frame){.scale = 1}; /* it may have had one */
        }
        scene->leaf_count += object->mesh->leaf_count;
    }
}

int eng_scene_replace(struct eng_scene *scene, uint32_t object_idx, struct eng_mesh *mesh)
{
    assert(scene->replaced_count == 0);
    int status = eng_scene_try_replace(scene, object_idx, mesh);
    if (status == PCCD_OK) {
        eng_scene_settle(scene);
    }
    return status;
}

int eng_scene_remove(struct eng_scene *scene, uint32_t object_idx)
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!object) {
        return PCCD_E_INVAL;
    }
    if (scene->staging) {
        return PCCD_E_STATE;
    }
    give_all(scene, object);
    eng_masks_forget(&scene->masks, object_idx);
    scene->leaf_count -= object->mesh->leaf_count;
    eng_mesh_release(object->mesh);
    object->mesh = NULL;
    eng_ids_remove(&scene->ids, object->id);
    scene->object_count--;
    scene->object_free =
        object_idx < scene->object_free ? object_idx : scene->object_free;
    tell_changed(scene);
    look_if_emptied(scene);
    return PCCD_OK;
}

int eng_scene_set_filter(struct eng_scene *scene, uint32_t object_idx,
                         const struct eng_object_filter *filter)
{
    if (!eng_scene_object(scene, object_idx)) {
        return PCCD_E_INVAL;
    }
    eng_masks_set(&scene->masks, object_idx, filter);
    return PCCD_OK;
}

int eng_scene_get_filter(const struct eng_scene *scene, uint32_t object_idx,
                         struct eng_object_filter *filter)
{
    if (!eng_scene_object(scene, object_idx)) {
        return PCCD_E_INVAL;
    }
    const struct eng_masks_entry *entry = &scene->masks.entries[object_idx];
    *filter = (struct eng_object_filter){entry->group, entry->mask, entry->self};
    return PCCD_OK;
}

int eng_scene_exclude(struct eng_scene *scene, uint32_t object_idx)
{
    if (!eng_scene_object(scene, object_idx)) {
        return PCCD_E_INVAL;
    }
    eng_masks_exclude(&scene->masks, object_idx);
    return PCCD_OK;
}

void eng_scene_purge_excluded(struct eng_scene *scene)
{
    eng_masks_purge_excluded(&scene->masks);
}

static int set_pair(struct eng_scene *scene, uint32_t a_idx, uint32_t b_idx, double value)
{
    if (a_idx == b_idx || !eng_scene_object(scene, a_idx) ||
        !eng_scene_object(scene, b_idx)) {
        return PCCD_E_INVAL;
    }
    return eng_masks_set_pair(&scene->masks, a_idx, b_idx, value);
}

int eng_scene_ignore(struct eng_scene *scene, uint32_t a_idx, uint32_t b_idx,
                     bool ignored)
{
    return set_pair(scene, a_idx, b_idx, ignored ? ENG_PAIR_IGNORED : ENG_PAIR_PLAIN);
}

int eng_scene_set_pair_clearance(struct eng_scene *scene, uint32_t a_idx, uint32_t b_idx,
                                 double clearance)
{
    int status = eng_mesh_check_radius(clearance);
    return status == PCCD_OK ? set_pair(scene, a_idx, b_idx, clearance) : status;
}

uint32_t eng_scene_ignored_count(const struct eng_scene *scene)
{
    return scene->masks.ignored_count;
}

bool eng_scene_next_pair(const struct eng_scene *scene, uint32_t *from,
                         uint32_t pair_idx[2], bool *ignored, double *clearance)
{
    bool is_there = eng_pairset_next(&scene->masks.pairs, from, pair_idx, clearance);
    *ignored = is_there && *clearance == ENG_PAIR_IGNORED;
    return is_there;
}

uint32_t eng_scene_object_id(const struct eng_scene *scene, uint32_t object_idx)
{
    assert(eng_scene_object(scene, object_idx));
    return scene->objects[object_idx].id;
}

const struct eng_mesh *eng_scene_mesh(const struct eng_scene *scene, uint32_t object_idx)
{
    assert(eng_scene_object(scene, object_idx));
    return scene->objects[object_idx].mesh;
}

const double (*eng_scene_positions(const struct eng_scene *scene, uint32_t object_idx,
                                   unsigned end))[3]
{
    assert(eng_scene_object(scene, object_idx) && end <= 1);
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
    uint64_t bytes = 0;
    for (int i = 0; i < ENG_SLOTS; i++) {
        bytes += scene->owners[i]->bytes(scene);
    }
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        bytes += object->mesh && object->poses ? sizeof *object->poses : 0;
    }
    return bytes + eng_masks_bytes(&scene->masks) + eng_ids_bytes(&scene->ids) +
           sizeof *scene + (uint64_t)scene->object_capacity * sizeof *scene->objects +
           (uint64_t)scene->object_capacity * sizeof *scene->framing.items +
           (uint64_t)scene->replaced_capacity * sizeof *scene->replaced +
           ((uint64_t)scene->joints.capacity + scene->staged_joints.capacity) *
               sizeof *scene->joints.items +
           (uint64_t)scene->vertex_capacity *
               (2 * sizeof *scene->x[0] + sizeof *scene->moving.moves) +
           (uint64_t)scene->start_capacity * sizeof *scene->start +
           (uint64_t)scene->part.capacity * 2 * sizeof *scene->part.x[0] +
           (uint64_t)scene->part.bound_capacity * sizeof *scene->part.bounds +
           (uint64_t)scene->write_capacity * sizeof *scene->writes;
}
