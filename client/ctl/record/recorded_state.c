/* recorded_state.c - a recording, as what its client had told the daemon. */
#include "recorded_state.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "joints.h"
#include "kinds.h"
#include "oracle_scene.h"
#include "payload.h"
#include "rounding.h"

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what was recorded");
}

static int unknown(struct ctl_error *error, const char *what, uint32_t handle)
{
    return ctl_error_set(error, PCCD_E_FORMAT,
                         "the recording names %s 0x%" PRIx32 ", which there is not", what,
                         handle);
}

static int twice(struct ctl_error *error, const char *what, uint32_t handle)
{
    return ctl_error_set(error, PCCD_E_FORMAT, "the recording %s 0x%" PRIx32 " twice",
                         what, handle);
}

static int find_scene(const struct registry *state, uint32_t handle,
                      struct registry_scene **scene, struct ctl_error *error)
{
    *scene = registry_scene(state, handle);
    return *scene != NULL ? PCCD_OK : unknown(error, "scene", handle);
}

static int find_object(const struct registry *state, uint32_t in, uint32_t handle,
                       struct registry_scene **scene, struct registry_object **object,
                       struct ctl_error *error)
{
    int status = find_scene(state, in, scene, error);
    if (status != PCCD_OK) {
        return status;
    }
    *object = registry_object(*scene, handle);
    return *object != NULL ? PCCD_OK : unknown(error, "object", handle);
}

/* ---- meshes, scenes, objects ------------------------------------------------------- */

/* Copy the mesh of a MESH or GUEST; its head goes to *head. NULL: no memory. */
static struct registry_mesh *copy_mesh(const struct record_view *view,
                                       struct record_mesh *head)
{
    const uint8_t *payload = view->payload;
    memcpy(head, payload, sizeof *head);
    const struct record_shape at = record_shape_of(head);
    const struct registry_shape shape = {
        .format = head->format,
        .vertex_count = head->vertex_count,
        .triangle_count = head->triangle_count,
        .edge_count = head->edge_count,
        .point_count = head->point_count,
        .x = payload + at.x,
        .radii = head->has_radii != 0 ? payload + at.radii : NULL,
        .triangles = payload + at.triangles,
        .edges = payload + at.edges,
        .points = payload + at.points};
    return registry_mesh_copy(&shape);
}

static int follow_mesh(struct registry *state, const struct record_view *view,
                       struct ctl_error *error)
{
    struct record_mesh head;
    struct registry_mesh *copy = copy_mesh(view, &head);
    return copy != NULL && registry_put_mesh(state, head.mesh, copy, 0) == 0
               ? PCCD_OK
               : no_memory(error);
}

static void mark_free(struct registry_mesh *mesh, const uint32_t (*sides)[2],
                      uint32_t side_count)
{
    uint32_t side = 0; /* sides are some of the edges, in the same order */
    memset(mesh->is_free_vertex, 0, mesh->vertex_count);
    for (uint32_t i = 0; i < mesh->named_point_count; i++) {
        mesh->is_free_vertex[mesh->named_points[i]] = 1;
    }
    for (uint32_t i = 0; i < mesh->named_edge_count; i++) {
        const uint32_t *edge = mesh->named_edges[i];
        mesh->is_free_vertex[edge[0]] |= edge[0] == edge[1]; /* it names a point */
    }
    for (uint64_t i = 0; i < 3 * (uint64_t)mesh->triangle_count; i++) {
        mesh->is_free_vertex[mesh->triangles[i / 3][i % 3]] = 0;
    }
    for (uint32_t i = 0; i < mesh->edge_count; i++) {
        const uint32_t *edge = mesh->edges[i];
        bool is_side =
            side < side_count && sides[side][0] == edge[0] && sides[side][1] == edge[1];
        mesh->is_free_edge[i] = !is_side;
        side += is_side;
        mesh->is_free_vertex[edge[0]] = 0;
        mesh->is_free_vertex[edge[1]] = 0;
    }
}

int recorded_edges(struct registry_mesh *mesh, struct ctl_error *error)
{
    struct oracle_object object = {.vertex_count = mesh->vertex_count,
                                   .triangle_count = mesh->triangle_count,
                                   .triangles = (const uint32_t(*)[3])mesh->triangles,
                                   .edges = (const uint32_t(*)[2])mesh->named_edges};
    if (mesh->edges != NULL) {
        return PCCD_OK;
    }
    uint32_t side_count = 0;
    uint32_t(*sides)[2] = oracle_edges(&object, &side_count);
    object.edge_count = mesh->named_edge_count;
    uint32_t(*edges)[2] = oracle_edges(&object, &mesh->edge_count);
    mesh->is_free_edge = malloc((size_t)mesh->edge_count + 1);
    mesh->is_free_vertex = malloc(mesh->vertex_count);
    if (mesh->is_free_edge == NULL || mesh->is_free_vertex == NULL) {
        free(sides);
        free(edges);
        free(mesh->is_free_edge);
        free(mesh->is_free_vertex);
        mesh->is_free_edge = NULL;
        mesh->is_free_vertex = NULL;
        return no_memory(error);
    }
    mesh->edges = edges;
    mark_free(mesh, (const uint32_t(*)[2])sides, side_count);
    free(sides);
    return PCCD_OK;
}

uint32_t recorded_feature_count(const struct registry_mesh *mesh, uint32_t points)
{
    return points == 1   ? mesh->vertex_count
           : points == 2 ? mesh->edge_count
                         : mesh->triangle_count;
}

const uint32_t *recorded_feature(const struct registry_mesh *mesh, uint32_t points,
                                 const uint32_t *feature)
{
    if (*feature >= recorded_feature_count(mesh, points)) {
        return NULL;
    }
    return points == 1   ? feature
           : points == 2 ? mesh->edges[*feature]
                         : mesh->triangles[*feature];
}

const uint32_t *recorded_place(const struct registry_object *object, uint32_t points,
                               const uint32_t *feature, struct place_feature *ends)
{
    const uint32_t *corners =
        object != NULL ? recorded_feature(object->mesh, points, feature) : NULL;
    for (uint32_t i = 0; i < points && corners != NULL; i++) {
        ends->corners[i] = corners[i];
        memcpy(ends->from[i], object->x0[corners[i]], sizeof ends->from[i]);
        memcpy(ends->to[i], object->x1[corners[i]], sizeof ends->to[i]);
    }
    return corners;
}

bool recorded_is_free(const struct registry_mesh *mesh, uint32_t points, uint32_t feature)
{
    return points == 1 ? mesh->is_free_vertex[feature] : mesh->is_free_edge[feature];
}

bool recorded_share_vertex(const uint32_t *a, uint32_t count_a, const uint32_t *b,
                           uint32_t count_b)
{
    for (uint32_t i = 0; i < count_a * count_b; i++) {
        if (a[i / count_b] == b[i % count_b]) {
            return true;
        }
    }
    return false;
}

double recorded_radius(const struct registry_object *object, const uint32_t *v,
                       uint32_t count)
{
    double most = 0;
    if (object->attributes.radius > 0 || object->mesh->radii == NULL) {
        return object->attributes.radius;
    }
    for (uint32_t i = 0; i < count; i++) {
        most = fmax(most, object->mesh->radii[v[i]]);
    }
    return most;
}

static int follow_scene(struct registry *state, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_scene head;
    memcpy(&head, view->payload, sizeof head);
    const struct registry_settings settings = {.name = ""};
    if (registry_scene(state, head.scene) != NULL) {
        return twice(error, "makes scene", head.scene);
    }
    return registry_add_scene(state, head.scene, &settings) != NULL ? PCCD_OK
                                                                    : no_memory(error);
}

/* From here on both ends of its steps are wanted; it goes again where there is no memory
 * for them. */
static int follow_ends(struct registry *state, struct registry_scene *scene,
                       struct registry_object *object, struct ctl_error *error)
{
    scene->is_told = false;
    if (registry_follow(object) == 0) {
        return PCCD_OK;
    }
    registry_remove_object(state, scene, object);
    return no_memory(error);
}

static int follow_object(struct registry *state, const struct record_view *view,
                         struct ctl_error *error)
{
    struct record_object head;
    struct registry_scene *scene;
    memcpy(&head, view->payload, sizeof head);
    int status = find_scene(state, head.scene, &scene, error);
    if (status != PCCD_OK) {
        return status;
    }
    struct registry_mesh *mesh = registry_mesh(state, head.mesh);
    if (mesh == NULL) {
        return unknown(error, "mesh", head.mesh);
    }
    if (registry_object(scene, head.object) != NULL) {
        return twice(error, "adds object", head.object);
    }
    struct registry_object *object = registry_add_object(scene, mesh, head.object, 0);
    return object != NULL ? follow_ends(state, scene, object, error) : no_memory(error);
}

/* An object with a mesh that nobody else has. */
static int follow_guest(struct registry *state, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_mesh head;
    struct registry_scene *scene;
    memcpy(&head, view->payload, sizeof head);
    int status = find_scene(state, head.scene, &scene, error);
    if (status != PCCD_OK) {
        return status;
    }
    struct registry_mesh *copy = copy_mesh(view, &head);
    struct registry_object *object =
        copy != NULL ? registry_put_guest(state, scene, head.object, copy) : NULL;
    if (object == NULL) {
        registry_mesh_free(copy);
        return no_memory(error);
    }
    return follow_ends(state, scene, object, error);
}

static int judge_motion(const struct registry_object *object,
                        const struct registry_motion *motion, struct ctl_error *error)
{
    uint32_t stray = registry_first_stray(object, motion);
    return stray == motion->first + motion->count
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_FORMAT,
                               "vertex %" PRIu32 " of object 0x%" PRIx32
                               " is not finite or beyond 1e18",
                               stray, object->handle);
}

static int follow_place(struct registry *state, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_place place;
    memcpy(&place, view->payload, sizeof place);
    const void *at = (const uint8_t *)view->payload + sizeof place;
    struct registry_scene *scene;
    struct registry_object *object;
    int status = find_object(state, place.scene, place.object, &scene, &object, error);
    if (status != PCCD_OK) {
        return status;
    }
    const uint32_t vertex_count = object->mesh->vertex_count;
    const struct registry_motion motion = {.is_rigid =
                                               place.placing == RECORD_PLACED_RIGID,
                                           .format = place.format,
                                           .count = vertex_count,
                                           .start = at,
                                           .end = at};
    if (!motion.is_rigid &&
        view->bytes - sizeof place != vertex_count * common_vertex_bytes(place.format)) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "the recording places object 0x%" PRIx32
                             " with another number of vertices",
                             place.object);
    }
    status = judge_motion(object, &motion, error);
    if (status == PCCD_OK) {
        registry_move(object, &motion);
        scene->is_placed = false;
    }
    return status;
}

/* ---- what may meet --------------------------------------------------------------- */

static int follow_filter(struct registry *state, const struct record_view *view,
                         struct ctl_error *error)
{
    struct record_filter filter;
    struct common_attributes given;
    record_filter_read(view->payload, view->bytes, &filter, &given);
    struct registry_scene *scene;
    struct registry_object *object;
    int status = find_object(state, filter.scene, filter.object, &scene, &object, error);
    if (status == PCCD_OK) {
        registry_set_object(object, filter.what, &given);
        scene->is_told = false;
    }
    return status;
}

static int follow_name(struct registry *state, const struct record_view *view,
                       struct ctl_error *error)
{
    const char *text = (const char *)view->payload + sizeof(struct record_name);
    struct record_name name;
    struct registry_scene *scene;
    struct registry_object *object;
    memcpy(&name, view->payload, sizeof name);
    int status = find_object(state, name.scene, name.object, &scene, &object, error);
    return status != PCCD_OK || registry_name_object(object, text, name.bytes) == PCCD_OK
               ? status
               : no_memory(error);
}

struct registry_pair recorded_pair(const struct record_view *view, uint32_t i)
{
    struct record_pair pair;
    memcpy(&pair,
           (const uint8_t *)view->payload + sizeof(struct record_pairs) + i * sizeof pair,
           sizeof pair);
    return (struct registry_pair){.a = pair.a,
                                  .b = pair.b,
                                  .ignored = pair.said == RECORD_IGNORED,
                                  .has_clearance = pair.said == RECORD_CLEARANCE,
                                  .clearance = pair.clearance};
}

static int follow_pairs(struct registry *state, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_pairs head;
    struct registry_scene *scene;
    memcpy(&head, view->payload, sizeof head);
    int status = find_scene(state, head.scene, &scene, error);
    for (uint32_t i = 0; status == PCCD_OK && i < head.count; i++) {
        const struct registry_pair said = recorded_pair(view, i);
        uint32_t stray = registry_object(scene, said.a) == NULL   ? said.a
                         : registry_object(scene, said.b) == NULL ? said.b
                                                                  : 0;
        status = stray != 0 ? unknown(error, "object", stray)
                 : registry_pairs_note(&scene->pairs, &said) == 0 ? PCCD_OK
                                                                  : no_memory(error);
    }
    return status;
}

/* ---- what goes --------------------------------------------------------------------- */

static int follow_mesh_gone(struct registry *state, uint32_t handle,
                            struct ctl_error *error)
{
    struct registry_mesh *mesh = registry_mesh(state, handle);
    if (mesh == NULL) {
        return unknown(error, "mesh", handle);
    }
    registry_destroy_mesh(state, mesh);
    return PCCD_OK;
}

static int follow_gone(struct registry *state, const struct record_view *view,
                       struct ctl_error *error)
{
    struct record_gone gone;
    struct registry_scene *scene;
    struct registry_object *object;
    memcpy(&gone, view->payload, sizeof gone);
    if (view->kind == RECORD_MESH_GONE) {
        return follow_mesh_gone(state, gone.mesh, error);
    }
    if (view->kind == RECORD_SCENE_GONE) {
        int status = find_scene(state, gone.scene, &scene, error);
        if (status == PCCD_OK) {
            registry_remove_scene(state, scene);
        }
        return status;
    }
    int status = find_object(state, gone.scene, gone.object, &scene, &object, error);
    if (status == PCCD_OK) {
        registry_remove_object(state, scene, object);
    }
    return status;
}

int recorded_state_follow(struct registry *state, const struct record_view *view,
                          struct ctl_error *error)
{
    switch (view->kind) {
    case RECORD_MESH:
        return follow_mesh(state, view, error);
    case RECORD_SCENE:
        return follow_scene(state, view, error);
    case RECORD_OBJECT:
        return follow_object(state, view, error);
    case RECORD_GUEST:
        return follow_guest(state, view, error);
    case RECORD_PLACE:
        return follow_place(state, view, error);
    case RECORD_FILTER:
        return follow_filter(state, view, error);
    case RECORD_NAME:
        return follow_name(state, view, error);
    case RECORD_PAIRS:
        return follow_pairs(state, view, error);
    case RECORD_SCENE_GONE:
    case RECORD_MESH_GONE:
    case RECORD_OBJECT_GONE:
        return follow_gone(state, view, error);
    default:
        return PCCD_OK;
    }
}

/* ---- steps ------------------------------------------------------------------------- */

bool recorded_item_take(struct recorded_item *item, const struct record_view *view)
{
    if (view->kind != RECORD_FRAME && view->kind != RECORD_MOVE &&
        view->kind != RECORD_NEAR) {
        return false;
    }
    memcpy(&item->frame, view->payload, sizeof item->frame);
    item->is_near = view->kind == RECORD_NEAR;
    item->slot = (const uint8_t *)view->payload + sizeof item->frame;
    return true;
}

bool recorded_joints_take(struct recorded_joints *joints, const uint8_t *slot,
                          const struct record_segment *segment, uint32_t *index)
{
    struct record_joints head;
    const uint8_t *from = slot + segment->offset0 + sizeof head;
    if (joints->count > 0 && joints->at == segment->offset0) {
        *index = joints->base + segment->first;
        return true;
    }
    memcpy(&head, slot + segment->offset0, sizeof head);
    struct pccd_joint *items =
        realloc(joints->items, (joints->count + (size_t)head.count) * sizeof *items);
    if (items == NULL) {
        return false;
    }
    memcpy(items + joints->count, from, head.count * sizeof *items);
    for (uint32_t i = joints->count; i < joints->count + head.count; i++) {
        items[i].parent += items[i].parent != PCCD_NO_JOINT ? joints->count : 0;
    }
    *joints = (struct recorded_joints){.items = items,
                                       .base = joints->count,
                                       .count = joints->count + head.count,
                                       .at = segment->offset0};
    *index = joints->base + segment->first;
    return true;
}

bool recorded_joints_of(const struct recorded_item *item, struct recorded_joints *joints)
{
    bool fits = true;
    recorded_joints_deinit(joints);
    for (uint32_t i = 0; i < item->frame.segment_count && fits; i++) {
        struct record_segment segment;
        uint32_t index = 0;
        memcpy(&segment, item->slot + i * sizeof segment, sizeof segment);
        fits = segment.kind != RECORD_ON_JOINT ||
               recorded_joints_take(joints, item->slot, &segment, &index);
    }
    return fits;
}

void recorded_joints_deinit(struct recorded_joints *joints)
{
    free(joints->items);
    *joints = (struct recorded_joints){.items = NULL};
}

/* Return what a segment moves. Where a body turns, transforms take it to both ends, which
 * `ends` gets. */
static struct registry_motion motion_of(const struct record_segment *segment,
                                        const uint8_t *slot, double ends[2][12])
{
    struct registry_motion motion = {
        .is_rigid = segment->kind >= RECORD_RIGID,
        .format = segment->format,
        .first = segment->first,
        .count = segment->count,
        .start = segment->kind == RECORD_X1 ? NULL : slot + segment->offset0,
        .end = slot + segment->offset1};
    if (segment->kind == RECORD_ON_JOINT) {
        const uint8_t *joints = slot + segment->offset0 + sizeof(struct record_joints);
        COMMON_ROUNDING_HERE;
        common_joint_transform(joints, segment->first, 0, ends[0]);
        common_joint_transform(joints, segment->first, 1, ends[1]);
        motion.first = 0;
        motion.start = ends[0];
        motion.end = ends[1];
    }
    return motion;
}

static int judge_segment(const struct registry *state, const struct recorded_item *item,
                         const struct record_segment *segment, struct ctl_error *error)
{
    struct registry_scene *scene;
    struct registry_object *object;
    int status =
        find_object(state, item->frame.scene, segment->object, &scene, &object, error);
    if (status != PCCD_OK) {
        return status;
    }
    double ends[2][12];
    const struct registry_motion motion = motion_of(segment, item->slot, ends);
    if (motion.first > object->mesh->vertex_count ||
        motion.count > object->mesh->vertex_count - motion.first) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "step %" PRIu64 " moves vertices that object 0x%" PRIx32
                             " has not",
                             item->frame.step, segment->object);
    }
    return judge_motion(object, &motion, error);
}

int recorded_state_move(struct registry *state, const struct recorded_item *item,
                        struct ctl_error *error)
{
    struct registry_scene *scene;
    struct record_segment segment;
    int status = find_scene(state, item->frame.scene, &scene, error);
    for (uint32_t i = 0; status == PCCD_OK && i < item->frame.segment_count; i++) {
        memcpy(&segment, item->slot + i * sizeof segment, sizeof segment);
        status = judge_segment(state, item, &segment, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    registry_begin_step(scene);
    struct record_joints head = {.count = 0};
    uint64_t table = 0;
    uint32_t base = 0; /* index of its first among those of all tables */
    for (uint32_t i = 0; i < item->frame.segment_count; i++) {
        memcpy(&segment, item->slot + i * sizeof segment, sizeof segment);
        if (segment.kind == RECORD_ON_JOINT && segment.offset0 != table) {
            base += head.count;
            table = segment.offset0;
            memcpy(&head, item->slot + table, sizeof head);
        }
        double ends[2][12];
        const struct registry_motion motion = motion_of(&segment, item->slot, ends);
        struct registry_object *object = registry_object(scene, segment.object);
        registry_move(object, &motion);
        object->turned = segment.kind == RECORD_ON_JOINT;
        object->joint = base + segment.first;
    }
    return PCCD_OK;
}

void recorded_bounds(const struct registry_scene *scene, double t, double low[3],
                     double high[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (uint32_t o = 0; o < scene->object_count; o++) {
        const struct registry_object *object = &scene->objects[o];
        for (uint64_t i = 0; i < 3 * (uint64_t)object->mesh->vertex_count; i++) {
            double a = object->x0[i / 3][i % 3], b = object->x1[i / 3][i % 3];
            low[i % 3] = fmin(low[i % 3], a + t * (b - a));
            high[i % 3] = fmax(high[i % 3], a + t * (b - a));
        }
    }
}

/* ---- where a record of what is near lies -------------------------------------- */

bool recorded_near_line(const struct registry_scene *scene, const struct pccd_near *near,
                        uint32_t end, double ends[2][3])
{
    const uint32_t handles[2] = {near->object_a, near->object_b};
    const uint32_t features[2] = {near->feature_a, near->feature_b};
    struct place_feature of[2];
    if (near->kind >= COMMON_KIND_COUNT) {
        return false;
    }
    for (uint32_t side = 0; side < 2; side++) {
        if (recorded_place(registry_object(scene, handles[side]),
                           common_kinds[near->kind].points[side], &features[side],
                           &of[side]) == NULL) {
            return false;
        }
    }
    if (near->kind == PCCD_EF) {
        memcpy(ends, end == 0 ? of[0].from : of[0].to, 6 * sizeof(double));
    } else {
        place_find(near->kind, near->param, of, end, ends);
    }
    return true;
}
