/* verify_any.c - whether anything meets in a step at all. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "kinds.h"
#include "verify.h"

#define DECISIONS_MAX   1000000u    /* exact ones, for one step: a minute */
#define COMPARISONS_MAX 4000000000u /* of boxes: ten seconds */

/* A feature, with the box of its motion and of its radius around it. */
struct swept {
    double lo[3], hi[3];
    const struct registry_object *object;
    uint32_t feature;
};

struct sweep {
    const struct play_step *step;
    struct verify_result *result;
    enum pccd_kind kind;
    struct swept *sides[2];
    size_t counts[2];
    uint64_t decisions, comparisons;
    bool is_too_long;
    bool has_found;
    struct pccd_pair found;
};

static int compare_swept(const void *a, const void *b)
{
    const struct swept *x = a, *y = b;
    return (x->lo[0] > y->lo[0]) - (x->lo[0] < y->lo[0]);
}

/* Its motion, and half of what may lie between two that meet; a little more, as that is
 * rounded. */
static void sweep_feature(const struct sweep *sweep, const struct registry_object *object,
                          uint32_t points, uint32_t feature, struct swept *swept)
{
    const uint32_t *v = recorded_feature(object->mesh, points, &feature);
    double half =
        registry_pairs_half_clearance(&sweep->step->scene->pairs, object->handle);
    double reach = fmax(recorded_radius(object, v, points), half) +
                   sweep->step->frame->separation / 2;
    *swept = (struct swept){.object = object, .feature = feature};
    for (uint32_t k = 0; k < 3; k++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < points; i++) {
            lo = fmin(lo, fmin(object->x0[v[i]][k], object->x1[v[i]][k]));
            hi = fmax(hi, fmax(object->x0[v[i]][k], object->x1[v[i]][k]));
        }
        double more =
            reach == 0 ? 0 : 4 * DBL_EPSILON * (fabs(lo) + fabs(hi) + reach) + reach;
        swept->lo[k] = lo - more;
        swept->hi[k] = hi + more;
    }
}

/* Vertices that something names; others are not tested. */
static void mark_named(const struct registry_mesh *mesh, uint8_t *is_named)
{
    for (uint64_t i = 0; i < 3 * (uint64_t)mesh->triangle_count; i++) {
        is_named[mesh->triangles[i / 3][i % 3]] = 1;
    }
    for (uint32_t i = 0; i < mesh->named_edge_count; i++) {
        is_named[mesh->named_edges[i][0]] = is_named[mesh->named_edges[i][1]] = 1;
    }
    for (uint32_t i = 0; i < mesh->named_point_count; i++) {
        is_named[mesh->named_points[i]] = 1;
    }
}

static bool is_tested(const struct sweep *sweep, const struct registry_mesh *mesh,
                      uint32_t points, uint32_t feature, const uint8_t *is_named)
{
    bool is_of_free = sweep->kind == PCCD_VE || sweep->kind == PCCD_VV;
    return is_of_free    ? recorded_is_free(mesh, points, feature)
           : points == 1 ? is_named[feature] != 0
                         : true;
}

/* All features of one side of the kind. */
static bool list_side(struct sweep *sweep, int side)
{
    const struct registry_scene *scene = sweep->step->scene;
    uint32_t points = common_kinds[sweep->kind].points[side];
    size_t room = 1;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        room += recorded_feature_count(scene->objects[i].mesh, points);
    }
    sweep->sides[side] = malloc(room * sizeof *sweep->sides[side]);
    bool has_memory = sweep->sides[side] != NULL;
    for (uint32_t i = 0; i < scene->object_count && has_memory; i++) {
        const struct registry_object *object = &scene->objects[i];
        uint8_t *is_named = calloc(object->mesh->vertex_count, 1);
        has_memory = is_named != NULL;
        if (has_memory) {
            mark_named(object->mesh, is_named);
        }
        uint32_t count = recorded_feature_count(object->mesh, points);
        for (uint32_t f = 0; f < count && has_memory; f++) {
            if (is_tested(sweep, object->mesh, points, f, is_named)) {
                sweep_feature(sweep, object, points, f,
                              &sweep->sides[side][sweep->counts[side]++]);
            }
        }
        free(is_named);
    }
    if (has_memory) {
        qsort(sweep->sides[side], sweep->counts[side], sizeof *sweep->sides[side],
              compare_swept);
    }
    return has_memory;
}

static bool shares(const struct swept *a, uint32_t points_a, const struct swept *b,
                   uint32_t points_b)
{
    return a->object == b->object &&
           recorded_share_vertex(
               recorded_feature(a->object->mesh, points_a, &a->feature), points_a,
               recorded_feature(b->object->mesh, points_b, &b->feature), points_b);
}

/* Two whose boxes meet along x. Ends the sweep when they meet, or when it is too long. */
static void try_pair(struct sweep *sweep, const struct swept *a, const struct swept *b)
{
    const uint32_t *points = common_kinds[sweep->kind].points;
    struct verify_meeting meeting;
    sweep->is_too_long = ++sweep->comparisons > COMPARISONS_MAX;
    for (uint32_t k = 1; k < 3; k++) {
        if (a->lo[k] > b->hi[k] || b->lo[k] > a->hi[k]) {
            return;
        }
    }
    if (!registry_may_meet(sweep->step->scene, a->object, b->object) ||
        a->object->turned || b->object->turned || shares(a, points[0], b, points[1])) {
        return;
    }
    if (points[0] == points[1] &&
        (a->object->handle > b->object->handle ||
         (a->object == b->object && a->feature >= b->feature))) {
        return; /* it comes the other way round */
    }
    const struct pccd_pair pair = {sweep->kind, a->object->handle, a->feature,
                                   b->object->handle, b->feature};
    if (!verify_is_beside(sweep->step, &pair)) {
        return;
    }
    sweep->is_too_long = ++sweep->decisions > DECISIONS_MAX || sweep->is_too_long;
    verify_meet(sweep->step, &pair, &meeting);
    if (meeting.first != NULL &&
        !verify_is_left_out(sweep->step, &pair, &meeting, 1, sweep->result)) {
        sweep->has_found = true;
        sweep->found = pair;
    }
    oracle_first_free(meeting.first);
}

/* Each two whose boxes meet along x: of both, the one that begins later meets those that
 * have begun and not ended. */
static void sweep_kind(struct sweep *sweep)
{
    for (int turn = 0; turn < 2; turn++) {
        const struct swept *earlier = sweep->sides[turn], *later = sweep->sides[1 - turn];
        size_t first = 0;
        for (size_t i = 0; i < sweep->counts[turn]; i++) {
            while (first < sweep->counts[1 - turn] &&
                   (later[first].lo[0] < earlier[i].lo[0] ||
                    (turn == 1 && later[first].lo[0] <= earlier[i].lo[0]))) {
                first++; /* it is the earlier one, in the other turn */
            }
            for (size_t j = first;
                 j < sweep->counts[1 - turn] && later[j].lo[0] <= earlier[i].hi[0]; j++) {
                if (sweep->has_found || sweep->is_too_long) {
                    return;
                }
                try_pair(sweep, turn == 0 ? &earlier[i] : &later[j],
                         turn == 0 ? &later[j] : &earlier[i]);
            }
        }
    }
}

static int search(struct sweep *sweep, struct ctl_error *error)
{
    bool has_memory = true;
    for (uint32_t kind = 0;
         kind < PCCD_KIND_COUNT && has_memory && !sweep->has_found && !sweep->is_too_long;
         kind++) {
        sweep->kind = (enum pccd_kind)kind;
        sweep->counts[0] = sweep->counts[1] = 0;
        has_memory = list_side(sweep, 0) && list_side(sweep, 1);
        if (has_memory) {
            sweep_kind(sweep);
        }
        free(sweep->sides[0]);
        free(sweep->sides[1]);
        sweep->sides[0] = sweep->sides[1] = NULL;
    }
    return has_memory ? PCCD_OK
                      : ctl_error_set(error, PCCD_E_NOMEM, "no memory for all pairs");
}

bool verify_any(const struct play_step *step, const struct verify_start *start,
                struct verify_result *result, struct ctl_error *error, int *status)
{
    struct sweep sweep = {.step = step, .result = result};
    uint32_t verdict = verify_verdict(step);
    bool is_free = start->crossings + start->inside == 0;
    if (verdict == PCCD_VERDICT_NONE || (step->frame->tells && !start->is_known)) {
        return true;
    }
    if (!is_free && verdict != PCCD_VERDICT_YES &&
        !(verdict == PCCD_VERDICT_POSSIBLE && verify_has_turning(step))) {
        return verify_wrong(result, step, NULL,
                            "the verdict is that nothing meets, and it begins crossed or "
                            "inside");
    }
    *status = search(&sweep, error);
    if (*status != PCCD_OK) {
        return true;
    }
    if (sweep.has_found && verdict != PCCD_VERDICT_YES) {
        return verify_wrong(result, step, &sweep.found,
                            "the verdict is that nothing meets, and this does");
    }
    if (!sweep.has_found && !sweep.is_too_long && is_free && verdict != PCCD_VERDICT_NO &&
        !verify_has_turning(step)) {
        return verify_wrong(result, step, NULL,
                            "the verdict is that something meets, and nothing does");
    }
    if (!sweep.has_found && verify_has_turning(step)) {
        verify_leave(result, "bodies turn: the verdict is checked on a sample of their "
                             "pairs");
    }
    result->counts.contacts += sweep.has_found;
    result->counts.non_contacts += sweep.decisions - sweep.has_found;
    return sweep.has_found || !sweep.is_too_long ||
           verify_leave(result, "it has more pairs that are near than are decided: only "
                                "some of what its verdict says is checked");
}
