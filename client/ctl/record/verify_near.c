/* verify_near.c - pairs near each other that are not in an answer.
 *
 * Draw vertices and edges, find all faces and edges whose motion comes near theirs by
 * trying every one, and put those that the answer leaves out to exact arithmetic.
 */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "oracle.h"
#include "verify.h"

#define NEAR      0.1  /* of the feature's own extent */
#define DRAWS_MAX 400u /* of features, for one step */

struct box {
    double lo[3], hi[3];
};

/* A draw of a step's sample. */
struct draw {
    const struct play_step *step;
    const struct verify_settings *settings;
    struct verify_result *result;
    const struct verify_path *paths; /* of each object that turns; NULL: none does */
    uint64_t state;                  /* of the random numbers */
    uint64_t left;                   /* pairs */
};

static uint64_t next(struct draw *draw)
{
    uint64_t drawn = verify_mix(draw->state);
    draw->state += VERIFY_MIX_STEP;
    return drawn;
}

static void enlarge(struct box *box, const double x[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        box->lo[k] = x[k] < box->lo[k] ? x[k] : box->lo[k];
        box->hi[k] = x[k] > box->hi[k] ? x[k] : box->hi[k];
    }
}

/* Return the box of the motion of `count` vertices; it is exact, for it is only
 * compared. That of a body that turns is of some times. */
static struct box box_of(const struct draw *draw, const struct registry_object *object,
                         const uint32_t *v, uint32_t count)
{
    struct box box;
    if (object->turned && draw->paths != NULL) {
        const struct verify_path *path =
            &draw->paths[object - draw->step->scene->objects];
        for (uint32_t i = 0; i < count * VERIFY_TIMES; i++) {
            double x[3], place[3];
            registry_registered(object->mesh, v[i / VERIFY_TIMES], x);
            verify_path_place(path, x, i % VERIFY_TIMES, place);
            if (i == 0) {
                memcpy(box.lo, place, sizeof box.lo);
                memcpy(box.hi, place, sizeof box.hi);
            }
            enlarge(&box, place);
        }
        return box;
    }
    for (uint32_t k = 0; k < 3; k++) {
        box.lo[k] = box.hi[k] = object->x0[v[0]][k];
        for (uint32_t i = 0; i < count; i++) {
            double a = object->x0[v[i]][k], b = object->x1[v[i]][k];
            box.lo[k] = a < box.lo[k] ? a : box.lo[k];
            box.lo[k] = b < box.lo[k] ? b : box.lo[k];
            box.hi[k] = a > box.hi[k] ? a : box.hi[k];
            box.hi[k] = b > box.hi[k] ? b : box.hi[k];
        }
    }
    return box;
}

/* By a part of its extent, and what a pair meets at: then pairs are found that nearly
 * meet, and those that do. */
static void widen(struct box *box, double distance)
{
    double extent = 0;
    for (uint32_t k = 0; k < 3; k++) {
        double here = box->hi[k] - box->lo[k];
        extent = here > extent ? here : extent;
    }
    for (uint32_t k = 0; k < 3; k++) {
        box->lo[k] -= NEAR * extent + (1 + NEAR) * distance;
        box->hi[k] += NEAR * extent + (1 + NEAR) * distance;
    }
}

static bool meet(const struct box *a, const struct box *b)
{
    for (uint32_t k = 0; k < 3; k++) {
        if (a->lo[k] > b->hi[k] || b->lo[k] > a->hi[k]) {
            return false;
        }
    }
    return true;
}

/* Return the time from which on an answer of its mode may leave out a pair; 2: at no
 * time. */
static double may_lack_from(const struct play_step *step, const struct pccd_pair *pair)
{
    const struct pccd_contact *kept;
    switch (verify_mode(step)) {
    case PCCD_MODE_FIRST_PER_PAIR:
        kept = verify_of_objects(step, pair->object_a, pair->object_b);
        return kept != NULL ? kept->toi : 2;
    case PCCD_MODE_FIRST:
        return step->found.count > 0 ? verify_toi_first(step) : 2;
    case PCCD_MODE_ANY:
        return verify_verdict(step) != PCCD_VERDICT_NO ? 0 : 2;
    default:
        return 2;
    }
}

/* A pair that is near and may not be in the answer. */
static bool judge(struct draw *draw, const struct pccd_pair *pair)
{
    struct verify_meeting meeting;
    if (draw->left == 0 || verify_has(draw->step, pair)) {
        return true;
    }
    draw->left--;
    double from = may_lack_from(draw->step, pair);
    if (verify_turns(draw->step, pair)) {
        return verify_mode(draw->step) == PCCD_MODE_PAIRS ||
               verify_turning_missing(draw->step, pair, from, draw->result);
    }
    if (verify_mode(draw->step) == PCCD_MODE_PAIRS) {
        draw->result->counts.non_contacts++;
        return !verify_is_beside(draw->step, pair) ||
               verify_wrong(draw->result, draw->step, pair,
                            "a pair that no axis separates is missing in the answer");
    }
    verify_meet(draw->step, pair, &meeting);
    bool is_right =
        meeting.first == NULL || oracle_first_compare(meeting.first, from) >= 0 ||
        verify_is_left_out(draw->step, pair, &meeting, fmin(from, 1), draw->result);
    oracle_first_free(meeting.first);
    if (!is_right) {
        return verify_wrong(draw->result, draw->step, pair,
                            "a contact is missing in the answer");
    }
    draw->result->counts.non_contacts++;
    return true;
}

/* Return whether pairs of a kind are made of such a feature. */
static bool is_of_kind(enum pccd_kind kind, const struct registry_mesh *mesh,
                       uint32_t points, uint32_t feature)
{
    return (kind != PCCD_VE && kind != PCCD_VV) ||
           recorded_is_free(mesh, points, feature);
}

/* All pairs of a kind that a feature may make with features near it, as the first or,
 * where both sides are of one sort, as the second. */
static bool try_feature(struct draw *draw, enum pccd_kind kind,
                        const struct registry_object *object, uint32_t feature)
{
    const struct registry_scene *scene = draw->step->scene;
    const uint32_t *points = common_kinds[kind].points;
    const uint32_t *own = recorded_feature(object->mesh, points[0], &feature);
    const struct box tight = box_of(draw, object, own, points[0]);
    const double radius = recorded_radius(object, own, points[0]);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct registry_object *other = &scene->objects[i];
        uint32_t count = recorded_feature_count(other->mesh, points[1]);
        double clearance =
            registry_pairs_clearance(&scene->pairs, object->handle, other->handle);
        for (uint32_t f = 0; registry_may_meet(scene, object, other) && f < count; f++) {
            const uint32_t *v = recorded_feature(other->mesh, points[1], &f);
            struct box near = box_of(draw, other, v, points[1]);
            struct box box = tight;
            widen(&box,
                  draw->step->frame->separation +
                      (clearance >= 0 ? clearance
                                      : radius + recorded_radius(other, v, points[1])));
            if (!meet(&box, &near) || !is_of_kind(kind, other->mesh, points[1], f) ||
                (other == object &&
                 recorded_share_vertex(own, points[0], v, points[1]))) {
                continue;
            }
            bool is_first = points[0] != points[1] || object->handle < other->handle ||
                            (object == other && feature < f);
            const struct pccd_pair pair =
                is_first
                    ? (struct pccd_pair){kind, object->handle, feature, other->handle, f}
                    : (struct pccd_pair){kind, other->handle, f, object->handle, feature};
            if (!judge(draw, &pair)) {
                return false;
            }
        }
    }
    return true;
}

static uint64_t named_in(const struct registry_mesh *mesh)
{
    return (uint64_t)mesh->triangle_count + mesh->named_edge_count +
           mesh->named_point_count;
}

/* An object, by its share of all that is named: triangles, edges, points. */
static const struct registry_object *draw_object(struct draw *draw, uint64_t *named)
{
    const struct registry_scene *scene = draw->step->scene;
    uint64_t all = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        all += named_in(scene->objects[i].mesh);
    }
    *named = next(draw) % all;
    for (uint32_t i = 0;; i++) {
        uint64_t here = named_in(scene->objects[i].mesh);
        if (*named < here) {
            return &scene->objects[i];
        }
        *named -= here;
    }
}

/* A vertex of what is named. */
static uint32_t draw_vertex(struct draw *draw, const struct registry_mesh *mesh,
                            uint64_t named)
{
    if (named < mesh->triangle_count) {
        return mesh->triangles[named][next(draw) % 3];
    }
    named -= mesh->triangle_count;
    return named < mesh->named_edge_count
               ? mesh->named_edges[named][next(draw) % 2]
               : mesh->named_points[named - mesh->named_edge_count];
}

/* Return whether there are edges or points that may be free; else no pair is of VE or
 * VV. */
static bool has_named(const struct registry_scene *scene)
{
    bool has = false;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        has |= scene->objects[i].mesh->named_edge_count > 0 ||
               scene->objects[i].mesh->named_point_count > 0;
    }
    return has;
}

bool verify_near(const struct play_step *step, const struct verify_settings *settings,
                 struct verify_result *result)
{
    struct verify_path *paths = verify_paths(step);
    struct draw draw = {.step = step,
                        .paths = paths,
                        .settings = settings,
                        .result = result,
                        .state = settings->seed ^ step->number * 0x2545f4914f6cdd1du,
                        .left = settings->sample};
    uint32_t kinds = has_named(step->scene) ? PCCD_KIND_COUNT : PCCD_EE + 1;
    bool is_right = true;
    for (uint32_t i = 0;
         i < DRAWS_MAX && draw.left > 0 && is_right && step->scene->object_count > 0;
         i++) {
        uint64_t named;
        const struct registry_object *object = draw_object(&draw, &named);
        enum pccd_kind kind = i % kinds;
        if (common_kinds[kind].points[0] == 1) {
            uint32_t vertex = draw_vertex(&draw, object->mesh, named);
            is_right = !is_of_kind(kind, object->mesh, 1, vertex) ||
                       try_feature(&draw, kind, object, vertex);
        } else if (object->mesh->edge_count > 0) {
            uint32_t edge = (uint32_t)(next(&draw) % object->mesh->edge_count);
            is_right = try_feature(&draw, kind, object, edge);
        }
    }
    free(paths);
    return is_right;
}
