/* snapshot.c - one step of a recording, to be looked at. */
#include "snapshot.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "joints.h"
#include "output.h"
#include "printable.h"
#include "recorded_state.h"
#include "rounding.h"
#include "shown.h"

#define ORIGIN_RATIO 1024.0 /* how much farther off than large a scene is */

struct taking {
    struct snapshot *snapshot;
    const struct snapshot_at *at;
    bool is_taken;
    snapshot_fn show; /* NULL: the last one is kept, for the caller */
    void *context;
};

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for a step");
}

/* A float has eight digits: where most of them say how far off the scene is, that is said
 * apart. */
static void choose_origin(const struct registry_scene *scene, double t,
                          struct snapshot *snapshot)
{
    double low[3], high[3], extent = 0, far = 0;
    recorded_bounds(scene, t, low, high);
    for (uint32_t k = 0; k < 3 && scene->object_count > 0; k++) {
        extent = fmax(extent, high[k] - low[k]);
        far = fmax(far, fmax(fabs(low[k]), fabs(high[k])));
    }
    snapshot->has_origin = far > ORIGIN_RATIO * extent;
    for (uint32_t k = 0; k < 3 && snapshot->has_origin; k++) {
        snapshot->origin[k] = low[k] + (high[k] - low[k]) / 2;
    }
}

/* Rods and points. */
static void take_free(const struct registry_mesh *mesh, struct snapshot_object *object)
{
    for (uint32_t i = 0; i < mesh->edge_count; i++) {
        if (recorded_is_free(mesh, 2, i)) {
            memcpy(object->edges[object->edge_count++], mesh->edges[i],
                   sizeof *object->edges);
        }
    }
    for (uint32_t i = 0; i < mesh->named_point_count; i++) {
        if (recorded_is_free(mesh, 1, mesh->named_points[i])) {
            object->points[object->point_count++] = mesh->named_points[i];
        }
    }
}

static void take_radii(const struct registry_object *from, struct snapshot_object *object)
{
    bool is_thick = false;
    for (uint32_t i = 0; i < object->vertex_count; i++) {
        double radius = recorded_radius(from, &i, 1);
        object->radii[i] = (float)radius;
        is_thick = is_thick || radius > 0;
    }
    if (!is_thick) {
        free(object->radii);
        object->radii = NULL;
    }
}

/* Set x to where a vertex is at a time of the step: by the pose of a body that turns;
 * NULL: it goes straight. */
static void find_vertex(const struct registry_object *object, const double pose[12],
                        uint32_t vertex, double t, double x[3])
{
    double registered[3];
    if (pose != NULL) {
        registry_registered(object->mesh, vertex, registered);
        common_transform(pose, registered, x);
        return;
    }
    for (uint32_t k = 0; k < 3; k++) {
        double a = object->x0[vertex][k], b = object->x1[vertex][k];
        x[k] = a + t * (b - a);
    }
}

/* Its mesh has its edges (recorded_edges). */
static bool take_object(const struct registry_object *from,
                        const struct recorded_joints *joints, double t,
                        const double origin[3], struct snapshot_object *object)
{
    const struct registry_mesh *mesh = from->mesh;
    double m[12];
    const double *pose = NULL;
    if (from->turned && joints != NULL) { /* NULL: t is an end, of a question */
        COMMON_ROUNDING_HERE;
        common_joint_transform(joints->items, from->joint, t, m);
        pose = m;
    }
    *object = (struct snapshot_object){
        .name = from->name != NULL ? strdup(from->name) : NULL,
        .handle = from->handle,
        .vertex_count = mesh->vertex_count,
        .triangle_count = mesh->triangle_count,
        .edges = malloc(((size_t)mesh->edge_count + 1) * sizeof *object->edges),
        .points = malloc(((size_t)mesh->named_point_count + 1) * sizeof *object->points),
        .radii = malloc(mesh->vertex_count * sizeof *object->radii),
        .x = malloc(mesh->vertex_count * sizeof *object->x),
        .motion = malloc(mesh->vertex_count * sizeof *object->motion),
        .triangles =
            malloc(((size_t)mesh->triangle_count + 1) * sizeof *object->triangles),
        .hits = calloc((size_t)mesh->triangle_count + 1, sizeof *object->hits)};
    if (object->x == NULL || object->motion == NULL || object->triangles == NULL ||
        object->hits == NULL || object->edges == NULL || object->points == NULL ||
        object->radii == NULL || (from->name != NULL && object->name == NULL)) {
        return false;
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        double x[3];
        find_vertex(from, pose, i, t, x);
        for (uint32_t k = 0; k < 3; k++) {
            object->x[i][k] = (float)(x[k] - origin[k]);
            object->motion[i][k] = (float)(from->x1[i][k] - from->x0[i][k]);
        }
    }
    if (mesh->triangle_count > 0) {
        memcpy(object->triangles, mesh->triangles,
               mesh->triangle_count * sizeof *object->triangles);
    }
    take_free(mesh, object);
    take_radii(from, object);
    return true;
}

static struct snapshot_object *find_object(const struct snapshot *snapshot,
                                           uint32_t handle)
{
    for (uint32_t i = 0; i < snapshot->object_count; i++) {
        if (snapshot->objects[i].handle == handle) {
            return &snapshot->objects[i];
        }
    }
    return NULL;
}

/* Make room around a contact for the corners of one of its features. */
static void widen(struct snapshot_contact *contact, const struct snapshot_object *object,
                  const uint32_t *corners, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const float *x = object->x[corners[i]];
        float away = hypotf(hypotf(x[0] - contact->at[0], x[1] - contact->at[1]),
                            x[2] - contact->at[2]);
        contact->radius = fmaxf(contact->radius, away);
    }
}

/* Find how far apart the points of two features are that meet, unless these keep no
 * distance: then what is between their points is rounding. */
static void find_reach(const struct play_step *step,
                       const struct registry_object *const objects[2],
                       const uint32_t *const corners[2], const uint32_t counts[2],
                       const double at[2][3], struct snapshot_contact *contact)
{
    double separation = step->frame->separation;
    double own = recorded_radius(objects[1], corners[1], counts[1]) + separation / 2;
    double both =
        own + recorded_radius(objects[0], corners[0], counts[0]) + separation / 2;
    double clearance = registry_pairs_clearance(&step->scene->pairs, objects[0]->handle,
                                                objects[1]->handle);
    if (clearance >= 0) { /* half of it around each */
        both = clearance + separation;
        own = both / 2;
    }
    if (!(both > 0)) {
        return;
    }
    contact->share = (float)(own / both);
    for (uint32_t k = 0; k < 3; k++) {
        contact->reach[k] = (float)(at[0][k] - at[1][k]);
    }
    contact->radius = fmaxf(contact->radius, (float)both);
}

/* Have a feature of a body that turns stand where it is at a time of the step. */
static void stand_at(const struct registry_object *object,
                     const struct recorded_joints *joints, uint32_t points, double t,
                     struct place_feature *ends)
{
    double pose[12];
    if (!object->turned) {
        return;
    }
    COMMON_ROUNDING_HERE;
    common_joint_transform(joints->items, object->joint, t, pose);
    for (uint32_t i = 0; i < points; i++) {
        find_vertex(object, pose, ends->corners[i], t, ends->from[i]);
        memcpy(ends->to[i], ends->from[i], sizeof ends->to[i]);
    }
}

/* Find where two features of a contact are touched at a time of the step. */
static void find_touch(const struct play_step *step, const struct pccd_contact *contact,
                       const struct registry_object *const objects[2],
                       struct place_feature ends[2], double t, double at[2][3])
{
    for (uint32_t side = 0; side < 2; side++) {
        stand_at(objects[side], &step->joints, common_kinds[contact->kind].points[side],
                 t, &ends[side]);
    }
    place_find(contact->kind, contact->param, ends, t, at);
}

/* Find where the second feature is touched. Return false for a record that makes no
 * sense. */
static bool place_contact(const struct snapshot *snapshot, const struct play_step *step,
                          const struct pccd_contact *from, struct snapshot_contact *to)
{
    const uint32_t handles[2] = {from->object_a, from->object_b};
    const uint32_t features[2] = {from->feature_a, from->feature_b};
    struct snapshot_object *shown[2];
    const struct registry_object *known[2];
    const uint32_t *corners[2];
    struct place_feature ends[2];
    double at[2][3];
    if (from->kind >= PCCD_KIND_COUNT) {
        return false;
    }
    const uint32_t *points = common_kinds[from->kind].points;
    for (uint32_t side = 0; side < 2; side++) {
        shown[side] = find_object(snapshot, handles[side]);
        known[side] = registry_object(step->scene, handles[side]);
        corners[side] =
            recorded_place(known[side], points[side], &features[side], &ends[side]);
        if (shown[side] == NULL || corners[side] == NULL) {
            return false;
        }
    }
    *to = (struct snapshot_contact){.toi = from->toi,
                                    .kind = from->kind,
                                    .flags = from->flags,
                                    .object_a = from->object_a,
                                    .feature_a = from->feature_a,
                                    .object_b = from->object_b,
                                    .feature_b = from->feature_b};
    memcpy(to->normal, from->normal, sizeof to->normal);
    find_touch(step, from, known, ends, snapshot->t, at);
    for (uint32_t k = 0; k < 3; k++) {
        to->at[k] = (float)(at[1][k] - snapshot->origin[k]);
    }
    if (points[1] == 3) {
        shown[1]->hits[from->feature_b]++;
    }
    for (uint32_t side = 0; side < 2; side++) {
        memcpy(to->corners[side], corners[side], points[side] * sizeof *corners[side]);
        widen(to, shown[side], corners[side], points[side]);
    }
    find_touch(step, from, known, ends, place_time(from), at);
    find_reach(step, known, corners, points, (const double(*)[3])at, to);
    return true;
}

static void find_extent(struct snapshot *snapshot)
{
    float low[3] = {INFINITY, INFINITY, INFINITY};
    float high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        for (uint32_t i = 0; i < snapshot->objects[o].vertex_count; i++) {
            for (uint32_t k = 0; k < 3; k++) {
                low[k] = fminf(low[k], snapshot->objects[o].x[i][k]);
                high[k] = fmaxf(high[k], snapshot->objects[o].x[i][k]);
            }
        }
    }
    snapshot->extent = 0;
    for (uint32_t k = 0; k < 3 && snapshot->object_count > 0; k++) {
        snapshot->extent = fmax(snapshot->extent, (double)high[k] - (double)low[k]);
    }
}

/* Return the number of the earliest contact, from 1: the first one in the order of the
 * answer where several are. 0: there is none. */
static uint64_t number_of_earliest(const struct play_step *step)
{
    uint64_t earliest = 0;
    for (uint64_t i = 0; step->contacts != NULL && i < step->found.count; i++) {
        if (earliest == 0 || step->contacts[i].toi < step->contacts[earliest - 1].toi) {
            earliest = i + 1;
        }
    }
    return earliest;
}

/* Find which contact is shown, from 1 (0: none in particular), and when. */
static int find_contact(const struct snapshot_at *at, const struct play_step *step,
                        uint64_t *number, double *t, struct ctl_error *error)
{
    uint64_t count = step->contacts != NULL ? step->found.count : 0;
    uint64_t earliest = number_of_earliest(step);
    bool is_first = at->contact == SNAPSHOT_FIRST;
    *number = at->contact == 0 || is_first ? earliest : at->contact;
    if (is_first && count == 0) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "step %" PRIu64 " has no contact, and so no first one",
                             step->number);
    }
    if (*number > count) {
        return ctl_error_set(
            error, PCCD_E_INVAL,
            "step %" PRIu64 " has %" PRIu64 " %s, and no contact %" PRIu64, step->number,
            count, proto_plural(count, "contact", "contacts"), at->contact);
    }
    bool is_then = at->contact > 0 || (count > 0 && count <= at->few);
    *t = !isnan(at->t) ? at->t : is_then ? place_time(&step->contacts[*number - 1]) : 1;
    return PCCD_OK;
}

/* The objects of a scene at snapshot->t. */
static int take_objects(const struct taking *taking, const struct registry_scene *scene,
                        const struct recorded_joints *joints, struct ctl_error *error)
{
    struct snapshot *snapshot = taking->snapshot;
    snapshot->objects = calloc(scene->object_count + 1, sizeof *snapshot->objects);
    if (snapshot->objects == NULL) {
        return no_memory(error);
    }
    choose_origin(scene, snapshot->t, snapshot);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        snapshot->object_count++;
        if (recorded_edges(scene->objects[i].mesh, error) != PCCD_OK ||
            !take_object(&scene->objects[i], joints, snapshot->t, snapshot->origin,
                         &snapshot->objects[i])) {
            return no_memory(error);
        }
    }
    return PCCD_OK;
}

/* Empty the snapshot, for the next step or question. */
static void begin_snapshot(const struct taking *taking, uint64_t number)
{
    struct snapshot *snapshot = taking->snapshot;
    snapshot_deinit(snapshot);
    snapshot->step = number;
}

static int take(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct taking *taking = context;
    struct snapshot *snapshot = taking->snapshot;
    uint64_t shown = 0;
    if (step->scene == NULL) {
        return PCCD_OK; /* it failed, in a scene that there was not */
    }
    begin_snapshot(taking, step->number);
    snapshot->separation = step->frame->separation;
    int status = find_contact(taking->at, step, &shown, &snapshot->t, error);
    if (status != PCCD_OK) {
        return status;
    }
    snapshot->contacts = calloc(step->found.count + 1, sizeof *snapshot->contacts);
    if (snapshot->contacts == NULL) {
        return no_memory(error);
    }
    status = take_objects(taking, step->scene, &step->joints, error);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint64_t i = 0; step->contacts != NULL && i < step->found.count; i++) {
        bool is_placed = place_contact(snapshot, step, &step->contacts[i],
                                       &snapshot->contacts[snapshot->contact_count]);
        if (i + 1 == shown && taking->at->contact > 0 && !is_placed) {
            return ctl_error_set(error, PCCD_E_FORMAT,
                                 "contact %" PRIu64 " of step %" PRIu64
                                 " names what there is not",
                                 i + 1, step->number);
        }
        snapshot->chosen = i + 1 == shown ? snapshot->contact_count : snapshot->chosen;
        snapshot->contact_count += is_placed;
    }
    find_extent(snapshot);
    taking->is_taken = true;
    return taking->show != NULL ? taking->show(taking->context, snapshot, error)
                                : PCCD_OK;
}

static int play_steps(const struct play_settings *settings, struct taking *taking,
                      struct play_summary *summary, struct ctl_error *error)
{
    int status = play(settings, take, taking, summary, error);
    if (status == PCCD_OK && !taking->is_taken && summary->frames == 0 &&
        summary->questions > 0) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s holds no step, but %" PRIu64
                               " %s about what is near, which --near shows",
                               settings->path, summary->questions,
                               proto_plural(summary->questions, "question", "questions"));
    } else if (status == PCCD_OK && !taking->is_taken) {
        status =
            ctl_error_set(error, PCCD_E_INVAL,
                          "%s holds no such step; it has %" PRIu64 ", the last %" PRIu64,
                          settings->path, summary->frames, summary->last_step);
    }
    return status;
}

int snapshot_take(const struct play_settings *settings, const struct snapshot_at *at,
                  struct snapshot *snapshot, struct play_summary *summary,
                  struct ctl_error *error)
{
    struct taking taking = {.snapshot = snapshot, .at = at};
    memset(snapshot, 0, sizeof *snapshot);
    int status = play_steps(settings, &taking, summary, error);
    if (status != PCCD_OK) {
        snapshot_deinit(snapshot);
    }
    return status;
}

int snapshot_each(const struct play_settings *settings, double t, snapshot_fn show,
                  void *context, struct play_summary *summary, struct ctl_error *error)
{
    const struct snapshot_at at = {.t = t};
    struct snapshot snapshot = {.object_count = 0};
    struct taking taking = {
        .snapshot = &snapshot, .at = &at, .show = show, .context = context};
    int status = play_steps(settings, &taking, summary, error);
    snapshot_deinit(&snapshot);
    return status;
}

/* ---- what is near ------------------------------------------------------------------ */

static bool place_line(const struct snapshot *snapshot,
                       const struct registry_scene *scene, const struct pccd_near *from,
                       uint32_t end, struct snapshot_line *to)
{
    double ends[2][3];
    if (!recorded_near_line(scene, from, end, ends)) {
        return false;
    }
    *to = (struct snapshot_line){.distance = from->d_lo, .kind = from->kind};
    for (uint32_t i = 0; i < 6; i++) {
        to->ends[i / 3][i % 3] = (float)(ends[i / 3][i % 3] - snapshot->origin[i % 3]);
    }
    return true;
}

/* Steps are passed by. */
static int take_near(void *context, const struct play_step *near, struct ctl_error *error)
{
    struct taking *taking = context;
    struct snapshot *snapshot = taking->snapshot;
    if (near->scene == NULL || near->asked == NULL) {
        return PCCD_OK;
    }
    begin_snapshot(taking, near->number);
    snapshot->t = near->asked->end;
    snapshot->lines = calloc(near->found.count + 1, sizeof *snapshot->lines);
    if (snapshot->lines == NULL) {
        return no_memory(error);
    }
    int status = take_objects(taking, near->scene, NULL, error);
    for (uint64_t i = 0;
         status == PCCD_OK && near->nears != NULL && i < near->found.count; i++) {
        snapshot->line_count +=
            place_line(snapshot, near->scene, &near->nears[i], near->asked->end,
                       &snapshot->lines[snapshot->line_count]);
    }
    find_extent(snapshot);
    taking->is_taken = status == PCCD_OK;
    return status;
}

int snapshot_take_near(const struct play_settings *settings, struct snapshot *snapshot,
                       struct play_summary *summary, struct ctl_error *error)
{
    struct play_settings asked = *settings;
    struct taking taking = {.snapshot = snapshot};
    memset(snapshot, 0, sizeof *snapshot);
    asked.shows_near = true;
    int status = play(&asked, take_near, &taking, summary, error);
    if (status == PCCD_OK && !taking.is_taken) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s: nobody asked what is near in that part of it",
                               settings->path);
    }
    if (status != PCCD_OK) {
        snapshot_deinit(snapshot);
    }
    return status;
}

double snapshot_greatest(const struct snapshot *snapshot)
{
    double greatest = 0;
    for (uint64_t i = 0; i < snapshot->line_count; i++) {
        greatest = fmax(greatest, snapshot->lines[i].distance);
    }
    return greatest;
}

void snapshot_report(const struct snapshot *snapshot, const char *path, bool is_json)
{
    bool is_near = snapshot->lines != NULL;
    uint64_t count = is_near ? snapshot->line_count : snapshot->contact_count;
    if (!is_json) {
        printf("%s: %s %" PRIu64 " at t = %s, %" PRIu32 " %s, %" PRIu64 " %s\n",
               tool_shown(path), is_near ? "question" : "step", snapshot->step,
               tool_shown_number(snapshot->t), snapshot->object_count,
               proto_plural(snapshot->object_count, "object", "objects"), count,
               is_near ? proto_plural(count, "record", "records")
                       : proto_plural(count, "contact", "contacts"));
        return;
    }
    json_t *object = json_pack("{s:o, s:I, s:f, s:I, s:I}", "file", json_text(path),
                               "step", (json_int_t)snapshot->step, "t", snapshot->t,
                               "objects", (json_int_t)snapshot->object_count, "contacts",
                               (json_int_t)snapshot->contact_count);
    if (is_near) {
        json_object_set_new(object, "near",
                            json_integer((json_int_t)snapshot->line_count));
    }
    (void)output_json(object, true, stdout);
}

void snapshot_report_steps(const char *path, uint64_t step_count, bool is_json)
{
    if (is_json) {
        json_t *object = json_pack("{s:o, s:I}", "file", json_text(path), "steps",
                                   (json_int_t)step_count);
        (void)output_json(object, true, stdout);
    } else {
        printf("%s: %" PRIu64 " %s\n", tool_shown(path), step_count,
               proto_plural(step_count, "step", "steps"));
    }
}

void snapshot_deinit(struct snapshot *snapshot)
{
    for (uint32_t i = 0; i < snapshot->object_count; i++) {
        free(snapshot->objects[i].name);
        free(snapshot->objects[i].x);
        free(snapshot->objects[i].motion);
        free(snapshot->objects[i].triangles);
        free(snapshot->objects[i].edges);
        free(snapshot->objects[i].points);
        free(snapshot->objects[i].radii);
        free(snapshot->objects[i].hits);
    }
    free(snapshot->objects);
    free(snapshot->contacts);
    free(snapshot->lines);
    memset(snapshot, 0, sizeof *snapshot);
}
