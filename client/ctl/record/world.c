/* world.c - a recording, as what its client had told the daemon. */
#include "world.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "kinds.h"
#include "oracle_scene.h"
#include "payload.h"
#include "registry.h"

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

/* ---- meshes, scenes, objects ------------------------------------------------------- */

/* The mesh of a MESH or GUEST, whose positions are at x and its triangles behind them,
 * with what chunks before it have said of it: radii, edges, points. */
static struct registry_shape shape_of(const struct registry *world, uint32_t format,
                                      uint32_t vertex_count, uint32_t triangle_count,
                                      const uint8_t *x)
{
    size_t x_bytes = vertex_count * common_vertex_bytes(format);
    bool has_radii = world->next_radii_count == vertex_count;
    bool has_free = world->next_free != NULL && world->next_free_count == vertex_count;
    struct registry_shape shape = {.format = format,
                                   .vertex_count = vertex_count,
                                   .triangle_count = triangle_count,
                                   .x = x,
                                   .triangles = x + (x_bytes + 7) / 8 * 8,
                                   .radii = has_radii ? world->next_radii : NULL};
    if (has_free) {
        shape.edge_count = world->next_edge_count;
        shape.point_count = world->next_point_count;
        shape.edges = world->next_free;
        shape.points = world->next_free + 2 * (size_t)world->next_edge_count;
    }
    return shape;
}

static void forget_next(struct registry *world)
{
    free(world->next_radii);
    free(world->next_free);
    world->next_radii = NULL;
    world->next_radii_count = 0;
    world->next_free = NULL;
    world->next_free_count = 0;
}

static int follow_radii(struct registry *world, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_radii head;
    memcpy(&head, view->payload, sizeof head);
    free(world->next_radii);
    world->next_radii = malloc((head.vertex_count + 1) * sizeof *world->next_radii);
    if (world->next_radii == NULL) {
        return no_memory(error);
    }
    memcpy(world->next_radii, (const uint8_t *)view->payload + sizeof head,
           head.vertex_count * sizeof *world->next_radii);
    world->next_radii_count = head.vertex_count;
    return PCCD_OK;
}

static int follow_free(struct registry *world, const struct record_view *view,
                       struct ctl_error *error)
{
    struct record_free head;
    memcpy(&head, view->payload, sizeof head);
    size_t words = 2 * (size_t)head.edge_count + head.point_count;
    free(world->next_free);
    world->next_free = malloc((words + 1) * sizeof *world->next_free);
    if (world->next_free == NULL) {
        return no_memory(error);
    }
    memcpy(world->next_free, (const uint8_t *)view->payload + sizeof head,
           words * sizeof *world->next_free);
    world->next_free_count = head.vertex_count;
    world->next_edge_count = head.edge_count;
    world->next_point_count = head.point_count;
    return PCCD_OK;
}

static int follow_mesh(struct registry *world, const struct record_view *view,
                       struct ctl_error *error)
{
    const uint8_t *x = (const uint8_t *)view->payload + sizeof(struct record_mesh);
    struct record_mesh head;
    memcpy(&head, view->payload, sizeof head);
    const struct registry_shape shape =
        shape_of(world, head.format, head.vertex_count, head.triangle_count, x);
    struct registry_mesh *copy = registry_mesh_copy(&shape);
    forget_next(world);
    return copy != NULL && registry_put_mesh(world, head.mesh, copy, 0) == 0
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

int world_edges(struct registry_mesh *mesh, struct ctl_error *error)
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

uint32_t world_feature_count(const struct registry_mesh *mesh, uint32_t points)
{
    return points == 1   ? mesh->vertex_count
           : points == 2 ? mesh->edge_count
                         : mesh->triangle_count;
}

const uint32_t *world_feature(const struct registry_mesh *mesh, uint32_t points,
                              const uint32_t *feature)
{
    if (*feature >= world_feature_count(mesh, points)) {
        return NULL;
    }
    return points == 1   ? feature
           : points == 2 ? mesh->edges[*feature]
                         : mesh->triangles[*feature];
}

bool world_is_free(const struct registry_mesh *mesh, uint32_t points, uint32_t feature)
{
    return points == 1 ? mesh->is_free_vertex[feature] : mesh->is_free_edge[feature];
}

double world_radius(const struct registry_object *object, const uint32_t *v,
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

static int follow_scene(struct registry *world, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_scene head;
    memcpy(&head, view->payload, sizeof head);
    const struct registry_settings settings = {.name = ""};
    if (registry_scene(world, head.scene) != NULL) {
        return twice(error, "makes scene", head.scene);
    }
    return registry_add_scene(world, head.scene, &settings) != NULL ? PCCD_OK
                                                                    : no_memory(error);
}

/* From here on both ends of its steps are wanted; it goes again where there is no memory
 * for them. */
static int follow_ends(struct registry *world, struct registry_scene *scene,
                       struct registry_object *object, struct ctl_error *error)
{
    if (registry_follow(object) == 0) {
        return PCCD_OK;
    }
    registry_remove_object(world, scene, object);
    return no_memory(error);
}

static int follow_object(struct registry *world, const struct record_view *view,
                         struct ctl_error *error)
{
    struct record_object head;
    memcpy(&head, view->payload, sizeof head);
    struct registry_scene *scene = registry_scene(world, head.scene);
    struct registry_mesh *mesh = registry_mesh(world, head.mesh);
    if (scene == NULL) {
        return unknown(error, "scene", head.scene);
    }
    if (mesh == NULL) {
        return unknown(error, "mesh", head.mesh);
    }
    if (registry_object(scene, head.object) != NULL) {
        return twice(error, "adds object", head.object);
    }
    struct registry_object *object = registry_add_object(scene, mesh, head.object, 0);
    return object != NULL ? follow_ends(world, scene, object, error) : no_memory(error);
}

/* An object with a mesh that nobody else has. */
static int follow_guest(struct registry *world, const struct record_view *view,
                        struct ctl_error *error)
{
    const uint8_t *x = (const uint8_t *)view->payload + sizeof(struct record_guest);
    struct record_guest head;
    memcpy(&head, view->payload, sizeof head);
    struct registry_scene *scene = registry_scene(world, head.scene);
    if (scene == NULL) {
        return unknown(error, "scene", head.scene);
    }
    const struct registry_shape shape =
        shape_of(world, PCCD_FORMAT_F64, head.vertex_count, head.triangle_count, x);
    struct registry_mesh *copy = registry_mesh_copy(&shape);
    forget_next(world);
    struct registry_object *object =
        copy != NULL ? registry_put_guest(world, scene, head.object, copy) : NULL;
    if (object == NULL) {
        registry_mesh_free(copy);
        return no_memory(error);
    }
    return follow_ends(world, scene, object, error);
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

static int follow_place(struct registry *world, const struct record_view *view,
                        struct ctl_error *error)
{
    struct record_place place;
    memcpy(&place, view->payload, sizeof place);
    const void *at = (const uint8_t *)view->payload + sizeof place;
    struct registry_scene *scene = registry_scene(world, place.scene);
    struct registry_object *object =
        scene != NULL ? registry_object(scene, place.object) : NULL;
    int status = PCCD_OK;
    if (object == NULL) {
        return unknown(error, "object", place.object);
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
    }
    return status;
}

/* ---- what may meet --------------------------------------------------------------- */

static int follow_filter(struct registry *world, const struct record_view *view,
                         struct ctl_error *error)
{
    struct record_filter filter;
    struct common_attributes given;
    record_filter_read(view->payload, view->bytes, &filter, &given);
    struct registry_scene *scene = registry_scene(world, filter.scene);
    struct registry_object *object =
        scene != NULL ? registry_object(scene, filter.object) : NULL;
    if (object == NULL) {
        return unknown(error, "object", filter.object);
    }
    registry_set_object(object, filter.what, &given);
    return PCCD_OK;
}

static int follow_pairs(struct registry *world, const struct record_view *view,
                        struct ctl_error *error)
{
    const uint8_t *at = (const uint8_t *)view->payload + sizeof(struct record_pairs);
    struct record_pairs head;
    uint32_t pair[2];
    memcpy(&head, view->payload, sizeof head);
    struct registry_scene *scene = registry_scene(world, head.scene);
    if (scene == NULL) {
        return unknown(error, "scene", head.scene);
    }
    for (uint32_t i = 0; i < head.count; i++) {
        memcpy(pair, at + i * sizeof pair, sizeof pair);
        for (uint32_t k = 0; k < 2; k++) {
            if (registry_object(scene, pair[k]) == NULL) {
                return unknown(error, "object", pair[k]);
            }
        }
    }
    for (uint32_t i = 0; i < head.count; i++) {
        memcpy(pair, at + i * sizeof pair, sizeof pair);
        if (registry_pairs_note(&scene->ignored, pair[0], pair[1], head.ignored != 0) !=
            0) {
            return no_memory(error);
        }
    }
    return PCCD_OK;
}

/* ---- what goes --------------------------------------------------------------------- */

static int follow_gone(struct registry *world, const struct record_view *view,
                       struct ctl_error *error)
{
    struct record_gone gone;
    memcpy(&gone, view->payload, sizeof gone);
    if (view->kind == RECORD_MESH_GONE) {
        struct registry_mesh *mesh = registry_mesh(world, gone.mesh);
        if (mesh == NULL) {
            return unknown(error, "mesh", gone.mesh);
        }
        registry_destroy_mesh(world, mesh);
        return PCCD_OK;
    }
    struct registry_scene *scene = registry_scene(world, gone.scene);
    if (scene == NULL) {
        return unknown(error, "scene", gone.scene);
    }
    if (view->kind == RECORD_SCENE_GONE) {
        registry_remove_scene(world, scene);
        return PCCD_OK;
    }
    struct registry_object *object = registry_object(scene, gone.object);
    if (object == NULL) {
        return unknown(error, "object", gone.object);
    }
    registry_remove_object(world, scene, object);
    return PCCD_OK;
}

int world_follow(struct registry *world, const struct record_view *view,
                 struct ctl_error *error)
{
    switch (view->kind) {
    case RECORD_RADII:
        return follow_radii(world, view, error);
    case RECORD_FREE:
        return follow_free(world, view, error);
    case RECORD_MESH:
        return follow_mesh(world, view, error);
    case RECORD_SCENE:
        return follow_scene(world, view, error);
    case RECORD_OBJECT:
        return follow_object(world, view, error);
    case RECORD_GUEST:
        return follow_guest(world, view, error);
    case RECORD_PLACE:
        return follow_place(world, view, error);
    case RECORD_FILTER:
        return follow_filter(world, view, error);
    case RECORD_PAIRS:
        return follow_pairs(world, view, error);
    case RECORD_SCENE_GONE:
    case RECORD_MESH_GONE:
    case RECORD_OBJECT_GONE:
        return follow_gone(world, view, error);
    default:
        return PCCD_OK;
    }
}

/* ---- steps ------------------------------------------------------------------------- */

static struct registry_motion motion_of(const struct record_segment *segment,
                                        const uint8_t *slot)
{
    return (struct registry_motion){
        .is_rigid = segment->kind == RECORD_RIGID,
        .format = segment->format,
        .first = segment->first,
        .count = segment->count,
        .start = segment->kind == RECORD_X1 ? NULL : slot + segment->offset0,
        .end = slot + segment->offset1};
}

int world_step(struct registry *world, const struct record_frame *frame,
               const uint8_t *slot, struct ctl_error *error)
{
    struct registry_scene *scene = registry_scene(world, frame->scene);
    struct record_segment segment;
    if (scene == NULL) {
        return unknown(error, "scene", frame->scene);
    }
    for (uint32_t i = 0; i < frame->segment_count; i++) {
        memcpy(&segment, slot + i * sizeof segment, sizeof segment);
        const struct registry_object *object = registry_object(scene, segment.object);
        if (object == NULL) {
            return unknown(error, "object", segment.object);
        }
        if (segment.first > object->mesh->vertex_count ||
            segment.count > object->mesh->vertex_count - segment.first) {
            return ctl_error_set(error, PCCD_E_FORMAT,
                                 "step %" PRIu64 " moves vertices that object 0x%" PRIx32
                                 " has not",
                                 frame->step, segment.object);
        }
        const struct registry_motion motion = motion_of(&segment, slot);
        int status = judge_motion(object, &motion, error);
        if (status != PCCD_OK) {
            return status;
        }
    }
    registry_pairs_settle(&scene->ignored); /* whoever is shown the step asks for them */
    registry_begin_step(scene);
    for (uint32_t i = 0; i < frame->segment_count; i++) {
        memcpy(&segment, slot + i * sizeof segment, sizeof segment);
        const struct registry_motion motion = motion_of(&segment, slot);
        registry_move(registry_object(scene, segment.object), &motion);
    }
    return PCCD_OK;
}

/* ---- Where a record of what is near lies in a scene. */

/* The weights of a record's features. Those of EF are of a point of the edge, and nobody
 * asks for them. */
static void near_weights(const struct pccd_near *near, double w[2][3])
{
    if (near->kind != PCCD_EF) {
        common_contact_weights((enum pccd_kind)near->kind, near->param, w);
    }
}

bool near_line(const struct registry_scene *scene, const struct pccd_near *near,
               uint32_t end, double ends[2][3])
{
    const uint32_t handles[2] = {near->object_a, near->object_b};
    const uint32_t features[2] = {near->feature_a, near->feature_b};
    double w[2][3] = {{0}};
    if (near->kind >= COMMON_KIND_COUNT) {
        return false;
    }
    near_weights(near, w);
    memset(ends, 0, 6 * sizeof(double));
    for (uint32_t side = 0; side < 2; side++) {
        const struct registry_object *object = registry_object(scene, handles[side]);
        uint32_t points = common_kinds[near->kind].points[side];
        const uint32_t *corners =
            object != NULL ? world_feature(object->mesh, points, &features[side]) : NULL;
        if (corners == NULL) {
            return false;
        }
        double(*x)[3] = end == 0 ? object->x0 : object->x1;
        for (uint32_t i = 0; i < points; i++) {
            for (uint32_t k = 0; k < 3; k++) {
                if (near->kind != PCCD_EF) {
                    ends[side][k] += w[side][i] * x[corners[i]][k];
                } else if (side == 0) {
                    ends[i][k] = x[corners[i]][k];
                }
            }
        }
    }
    return true;
}
