/* verify_meeting.c - when two features meet first, exactly. */
#include "verify.h"

#include <string.h>

#include "oracle_distance.h"
#include "oracle_thick.h"
#include "registry.h"

/* Places of a pair's vertices: at the beginning and the end of the step, or, alone, where
 * they were registered. */
enum at { AT_BEGIN, AT_END, AT_REST };

/* Four points of the pair, in the order of oracle.h; a kind of fewer repeats the last. */
static void find_points(const struct registry_scene *scene, const struct pccd_pair *pair,
                        enum at at, double p[4][3])
{
    const uint32_t *points = common_kinds[pair->kind].points;
    const uint32_t handles[2] = {pair->object_a, pair->object_b};
    const uint32_t features[2] = {pair->feature_a, pair->feature_b};
    uint32_t count = 0;
    for (int side = 0; side < 2; side++) {
        const struct registry_object *object = registry_object(scene, handles[side]);
        const uint32_t *v = recorded_feature(object->mesh, points[side], &features[side]);
        for (uint32_t i = 0; i < points[side]; i++, count++) {
            if (at == AT_REST) {
                registry_registered(object->mesh, v[i], p[count]);
            } else {
                memcpy(p[count], at == AT_BEGIN ? object->x0[v[i]] : object->x1[v[i]],
                       sizeof p[count]);
            }
        }
    }
    for (; count < 4; count++) {
        memcpy(p[count], p[count - 1], sizeof p[count]);
    }
}

/* Find the eight points of a pair of features that exist, in the order of oracle.h; a
 * kind of fewer repeats the last. */
static void find_ends(const struct registry_scene *scene, const struct pccd_pair *pair,
                      double p[8][3])
{
    find_points(scene, pair, AT_BEGIN, p);
    find_points(scene, pair, AT_END, p + 4);
}

/* Return whether the distance of the pair was less than that where the mesh was
 * registered. */
static bool is_nearer(const struct registry_scene *scene, const struct pccd_pair *pair,
                      double distance)
{
    double p[4][3];
    find_points(scene, pair, AT_REST, p);
    return oracle_is_nearer(common_kinds[pair->kind].points[0], (const double(*)[3])p,
                            distance);
}

/* Return whether so many edges or fewer join a vertex of the one and a vertex of the
 * other. */
static bool are_joined(const struct registry_mesh *mesh, const struct pccd_pair *pair,
                       uint32_t rings)
{
    const uint32_t *points = common_kinds[pair->kind].points;
    const uint32_t *const v[2] = {recorded_feature(mesh, points[0], &pair->feature_a),
                                  recorded_feature(mesh, points[1], &pair->feature_b)};
    return oracle_are_joined((const uint32_t(*)[2])mesh->edges, mesh->edge_count,
                             mesh->vertex_count, v, points, rings);
}

static bool is_excluded(const struct registry_scene *scene,
                        const struct registry_object *object,
                        const struct pccd_pair *pair)
{
    const struct common_attributes *is = &object->attributes;
    return (is->rest_distance > 0 && is_nearer(scene, pair, is->rest_distance)) ||
           (is->rest_rings > 0 && are_joined(object->mesh, pair, is->rest_rings));
}

bool verify_radii(const struct play_step *step, const struct pccd_pair *pair,
                  double radius[3])
{
    const struct registry_object *a = registry_object(step->scene, pair->object_a);
    const struct registry_object *b = registry_object(step->scene, pair->object_b);
    const uint32_t *points = common_kinds[pair->kind].points;
    radius[0] = recorded_radius(a, recorded_feature(a->mesh, points[0], &pair->feature_a),
                                points[0]);
    radius[1] = recorded_radius(b, recorded_feature(b->mesh, points[1], &pair->feature_b),
                                points[1]);
    double clearance =
        registry_pairs_clearance(&step->scene->pairs, a->handle, b->handle);
    if (clearance >= 0) { /* in the place of both */
        radius[0] = clearance;
        radius[1] = 0;
    }
    radius[2] = step->frame->separation;
    bool is_thick = radius[0] + radius[1] + radius[2] > 0 &&
                    (a != b || !is_excluded(step->scene, a, pair));
    if (!is_thick) {
        memset(radius, 0, 3 * sizeof *radius);
    }
    return is_thick;
}

/* The part of its first distance at which a pair that did not approach is a contact. */
#define NEARER (1 - 0x1p-20)

/* Find what the distance of a thick pair does that begins within r, and if it is left out
 * for that, when it comes nearer than it began. */
static void look_at_distance(const struct play_step *step, enum oracle_kind kind,
                             struct oracle_thick *thick, struct verify_meeting *meeting)
{
    static const uint32_t flags[3] = {PCCD_ENTERS, PCCD_SLIDES, PCCD_LEAVES};
    int trend = oracle_distance_trend(kind, (const double(*)[3])meeting->p);
    meeting->fate = flags[1 + trend];
    if (step->frame->touching == PCCD_TOUCHING_LEFT_OUT && trend >= 0) {
        thick->approach = NEARER;
        oracle_first_free(meeting->first);
        meeting->first = oracle_thick_first_new(thick);
        meeting->flags = PCCD_INSIDE;
    }
}

void verify_meet(const struct play_step *step, const struct pccd_pair *pair,
                 struct verify_meeting *meeting)
{
    const uint32_t *points = common_kinds[pair->kind].points;
    struct oracle_thick thick = {.points_a = (int)points[0],
                                 .points_b = (int)points[1],
                                 .p = (const double(*)[3])meeting->p,
                                 .approach = step->frame->approach};
    bool is_thick = verify_radii(step, pair, thick.radius);
    meeting->r = thick.radius[0] + thick.radius[1] + thick.radius[2];
    find_ends(step->scene, pair, meeting->p);
    meeting->first = is_thick ? oracle_thick_first_new(&thick)
                     : pair->kind == PCCD_VF || pair->kind == PCCD_EE
                         ? oracle_first_new((enum oracle_kind)pair->kind, thick.p)
                         : NULL; /* points that keep no distance do not meet anything */
    bool at_once = meeting->first != NULL && oracle_first_compare(meeting->first, 0) == 0;
    bool is_inside = is_thick && thick.approach > 0 && oracle_thick_is_inside(&thick);
    meeting->touches =
        at_once &&
        (!is_thick || oracle_is_within(points[0], (const double(*)[3])meeting->p,
                                       (const double[2]){0, 0}, 0));
    meeting->flags =
        (at_once ? (uint32_t)PCCD_INITIAL : 0) | (is_inside ? (uint32_t)PCCD_INSIDE : 0);
    meeting->fate = 0;
    if (at_once && !meeting->touches && step->frame->touching != PCCD_TOUCHING_KEPT) {
        look_at_distance(step, points[0] == 1 ? ORACLE_VF : ORACLE_EE, &thick, meeting);
    }
}

/* Return whether high - low is above the exact sum of the radii. */
static bool is_beyond(double high, double low, const double radius[3])
{
    const double terms[5] = {high, -low, -radius[0], -radius[1], -radius[2]};
    mpq_t sum, term;
    if (high <= low || radius[0] + radius[1] + radius[2] == 0) {
        return high > low;
    }
    mpq_inits(sum, term, NULL);
    for (int i = 0; i < 5; i++) {
        mpq_set_d(term, terms[i]);
        mpq_add(sum, sum, term);
    }
    bool is = mpq_sgn(sum) > 0;
    mpq_clears(sum, term, NULL);
    return is;
}

bool verify_is_beside(const struct play_step *step, const struct pccd_pair *pair)
{
    const uint32_t *points = common_kinds[pair->kind].points;
    uint32_t all = points[0] + points[1];
    double p[8][3], radius[3];
    bool is_beside = verify_radii(step, pair, radius) || pair->kind == PCCD_VF ||
                     pair->kind == PCCD_EE;
    find_ends(step->scene, pair, p);
    for (uint32_t way = 0; way < 6 && is_beside; way++) {
        bool are_apart = true;
        for (uint32_t i = 0; i < points[0] && are_apart; i++) {
            for (uint32_t j = points[0]; j < all && are_apart; j++) {
                for (uint32_t end = 0; end < 8; end += 4) {
                    double a = p[end + i][way % 3], b = p[end + j][way % 3];
                    are_apart = are_apart && (way < 3 ? is_beyond(a, b, radius)
                                                      : is_beyond(b, a, radius));
                }
            }
        }
        is_beside = !are_apart;
    }
    return is_beside;
}
