/* oracle_candidates.c - pairs of features that may be near. */
#include "oracle_near.h"

#include <stdlib.h>
#include <string.h>

#include "oracle_thick.h"

/* Squares of lengths below that may lose their last bits. */
#define SQUARES_FROM 1e-100

/* More than rounding takes off a difference, a square or a sum of three. */
#define A_LITTLE (1 + 0x1p-40)

static bool anything(const void *context, uint32_t a, uint32_t b)
{
    (void)context;
    (void)a;
    (void)b;
    return true;
}

/* ---- pairs of boxes ---------------------------------------------------------------- */

static bool boxes_are_apart(const struct oracle_feature *a,
                            const struct oracle_feature *b, double distance)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double up = a->lo[k] - b->hi[k];
        double down = b->lo[k] - a->hi[k];
        double gap = up > down ? up : down;
        if (gap > 0 && gap > distance * A_LITTLE) {
            return true;
        }
        sum += gap > 0 ? gap * gap : 0;
    }
    return distance > SQUARES_FROM && sum > distance * distance * A_LITTLE;
}

static bool is_after(const struct oracle_moment *moment, const struct oracle_feature *a,
                     const struct oracle_feature *b)
{
    uint32_t id_a = moment->objects[a->object].object_id;
    uint32_t id_b = moment->objects[b->object].object_id;
    return id_a != id_b ? id_a > id_b : a->index > b->index;
}

static double radius_of(const struct oracle_moment *moment,
                        const struct oracle_feature *feature)
{
    return oracle_radius(&moment->objects[feature->object], feature->v, feature->points);
}

/* Return whether they are of one object, and left thin for where they are at rest. */
static bool rest(const struct oracle_moment *moment, const struct oracle_feature *a,
                 const struct oracle_feature *b)
{
    const struct oracle_object *object = &moment->objects[a->object];
    double x[4][3];
    if (!moment->is_thick || a->object != b->object || a->points + b->points > 4) {
        return false;
    }
    if (object->rest_rings > 0) {
        uint32_t count;
        uint32_t(*edges)[2] = oracle_edges(object, &count);
        bool are_joined = oracle_are_joined(
            (const uint32_t(*)[2])edges, count, object->vertex_count,
            (const uint32_t *const[2]){a->v, b->v},
            (const uint32_t[2]){a->points, b->points}, object->rest_rings);
        free(edges);
        if (are_joined) {
            return true;
        }
    }
    for (uint32_t i = 0; object->rest_distance > 0 && i < 4; i++) {
        uint32_t last = b->points - 1;
        uint32_t k = i - a->points < last ? i - a->points : last;
        memcpy(x[i], object->registered[i < a->points ? a->v[i] : b->v[k]], sizeof x[i]);
    }
    return object->rest_distance > 0 &&
           oracle_is_nearer(a->points, (const double(*)[3])x, object->rest_distance);
}

static void consider(const struct oracle_moment *moment, const struct oracle_feature *a,
                     const struct oracle_feature *b, double distance,
                     struct oracle_candidates *candidates)
{
    double radii = moment->is_thick ? radius_of(moment, a) + radius_of(moment, b) : 0;
    if (boxes_are_apart(a, b, distance + radii) || oracle_features_share_vertex(a, b)) {
        return;
    }
    bool is_thin = !moment->is_thick || rest(moment, a, b);
    if (moment->is_thick && is_thin && !moment->keeps_thin) {
        return;
    }
    if (candidates->count == candidates->capacity) {
        candidates->capacity = candidates->capacity ? 2 * candidates->capacity : 1024;
        candidates->items = oracle_grow(candidates->items,
                                        candidates->capacity * sizeof *candidates->items);
    }
    bool is_turned = a->points == b->points && is_after(moment, a, b);
    candidates->items[candidates->count++] =
        (struct oracle_candidate){is_turned ? b : a, is_turned ? a : b, is_thin};
}

void oracle_candidates_find(const struct oracle_moment *moment,
                            const struct oracle_features *left,
                            const struct oracle_features *right, double distance,
                            struct oracle_candidates *candidates)
{
    bool (*may_meet)(const void *, uint32_t, uint32_t) =
        moment->may_meet ? moment->may_meet : anything;
    bool is_one = left == right;
    uint32_t count = moment->object_count;
    bool *meets = oracle_grow(NULL, (size_t)count * count + 1);
    for (uint32_t i = 0; i < count * count; i++) {
        meets[i] = may_meet(moment->context, moment->objects[i / count].object_id,
                            moment->objects[i % count].object_id);
    }
    for (size_t i = 0; i < left->count; i++) {
        const struct oracle_feature *a = &left->items[i];
        for (size_t j = is_one ? i + 1 : 0; j < right->count; j++) {
            const struct oracle_feature *b = &right->items[j];
            if (meets[(size_t)a->object * count + b->object]) {
                consider(moment, a, b, distance, candidates);
            }
        }
    }
    free(meets);
}

/* ---- records ----------------------------------------------------------------------- */

int oracle_near_compare(const void *a, const void *b)
{
    const struct pccd_near *l = &((const struct oracle_near *)a)->record;
    const struct pccd_near *r = &((const struct oracle_near *)b)->record;
    const uint32_t left[5] = {l->kind, l->object_a, l->feature_a, l->object_b,
                              l->feature_b};
    const uint32_t right[5] = {r->kind, r->object_a, r->feature_a, r->object_b,
                               r->feature_b};
    for (int i = 0; i < 5; i++) {
        if (left[i] != right[i]) {
            return left[i] < right[i] ? -1 : 1;
        }
    }
    return 0;
}

struct oracle_near *oracle_nears_add(struct oracle_nears *nears)
{
    if ((nears->count & (nears->count - 1)) == 0) { /* grow at powers of two */
        nears->items =
            oracle_grow(nears->items, (2 * nears->count + 1) * sizeof *nears->items);
    }
    memset(&nears->items[nears->count], 0, sizeof *nears->items);
    return &nears->items[nears->count++];
}

void oracle_nears_sort(struct oracle_nears *nears)
{
    if (nears->count > 0) {
        qsort(nears->items, nears->count, sizeof *nears->items, oracle_near_compare);
    }
}

void oracle_candidate_name(const struct oracle_moment *moment, uint32_t kind,
                           const struct oracle_candidate *candidate,
                           struct oracle_near *near)
{
    near->object[0] = candidate->a->object;
    near->object[1] = candidate->b->object;
    near->record.kind = kind;
    near->record.object_a = moment->objects[near->object[0]].object_id;
    near->record.feature_a = candidate->a->index;
    near->record.object_b = moment->objects[near->object[1]].object_id;
    near->record.feature_b = candidate->b->index;
    near->record.count = 1;
    near->radius[0] = candidate->is_thin ? 0 : radius_of(moment, candidate->a);
    near->radius[1] = candidate->is_thin ? 0 : radius_of(moment, candidate->b);
}

void oracle_near_write(const struct oracle_distance *distance, struct oracle_near *near)
{
    near->points = distance->points;
    near->record.flags = (uint32_t)distance->type << 8;
    near->record.d_lo = distance->lo;
    near->record.d_hi = distance->hi;
    for (int i = 0; i < 2; i++) {
        near->record.param[i] = (float)distance->param[i];
    }
    for (int i = 0; i < 3; i++) {
        near->record.direction[i] = (float)distance->direction[i];
    }
}

/* Points of a candidate, and the order of (object, vertex); of one that is there twice,
 * the first comes first. */
void oracle_candidate_load(const struct oracle_moment *moment,
                           const struct oracle_candidate *candidate, double p[5][3],
                           uint8_t rank[5])
{
    uint64_t key[5];
    uint32_t count = 0;
    for (int side = 0; side < 2; side++) {
        const struct oracle_feature *feature = side == 0 ? candidate->a : candidate->b;
        const struct oracle_object *object = &moment->objects[feature->object];
        for (uint32_t i = 0; i < feature->points; i++) {
            memcpy(p[count], object->x1[feature->v[i]], sizeof p[count]);
            key[count++] = (uint64_t)object->object_id << 32 | feature->v[i];
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        rank[i] = 0;
        for (uint32_t k = 0; k < count; k++) {
            rank[i] =
                (uint8_t)(rank[i] + (key[k] < key[i] || (key[k] == key[i] && k < i)));
        }
    }
}

void oracle_candidates_deinit(struct oracle_candidates *candidates)
{
    free(candidates->items);
    memset(candidates, 0, sizeof *candidates);
}
