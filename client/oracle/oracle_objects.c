/* oracle_objects.c - what is near of objects two by two, by brute force. */
#include "oracle_near.h"

#include <math.h>
#include <string.h>

#include "kinds.h"
#include "oracle_thick.h"

/* More than rounding takes off a difference, a square or a sum of three, or than squares
 * lose that are too small for doubles. */
#define A_LITTLE      (1 + 0x1p-40)
#define A_LITTLE_MORE 1e-100

/* ---- two objects ------------------------------------------------------------------- */

struct two {
    uint32_t at[2]; /* indices into the scene's objects */
    struct oracle_object objects[2];
    struct oracle_moment moment;         /* of these two alone */
    struct oracle_features of_points[3]; /* [points - 1] */
    struct oracle_features free[2];      /* [points - 1] those that are free */
};

static bool are_different(const void *context, uint32_t a, uint32_t b)
{
    (void)context;
    return a != b;
}

static void two_init(struct two *two, const struct oracle_moment *moment, uint32_t a,
                     uint32_t b)
{
    two->at[0] = a;
    two->at[1] = b;
    two->objects[0] = moment->objects[a];
    two->objects[1] = moment->objects[b];
    two->moment = *moment;
    two->moment.objects = two->objects;
    two->moment.object_count = 2;
    two->moment.may_meet = are_different;
    for (uint32_t i = 0; i < 3; i++) {
        oracle_features_list(two->objects, 2, i + 1, &two->of_points[i]);
    }
    for (uint32_t i = 0; i < 2; i++) {
        oracle_features_list(two->objects, 2, i + 1, &two->free[i]);
        oracle_features_keep_free(&two->free[i]);
    }
}

static void two_deinit(struct two *two)
{
    for (uint32_t i = 0; i < 3; i++) {
        oracle_features_deinit(&two->of_points[i]);
    }
    oracle_features_deinit(&two->free[0]);
    oracle_features_deinit(&two->free[1]);
}

static bool is_asked(const struct oracle_moment *moment, const uint32_t asked[2],
                     uint32_t a, uint32_t b)
{
    uint32_t id_a = moment->objects[a].object_id;
    uint32_t id_b = moment->objects[b].object_id;
    for (int side = 0; side < 2; side++) {
        if (asked[side] != 0 && id_a != asked[side] && id_b != asked[side]) {
            return false;
        }
    }
    return !moment->may_meet || moment->may_meet(moment->context, id_a, id_b);
}

static double square_of(const double x[3], const double y[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        sum += (x[k] - y[k]) * (x[k] - y[k]);
    }
    return sum;
}

/* The least distance of vertices of the two, or more; the features that they belong to
 * are not farther apart, nor are their surfaces. */
static double reach_of(const struct two *two)
{
    const struct oracle_features *all = &two->of_points[0];
    double least = INFINITY;
    for (size_t i = 0; i < all->count; i++) {
        for (size_t j = 0; j < i; j++) {
            if (all->items[i].object != all->items[j].object) {
                least = fmin(least, square_of(all->items[i].lo, all->items[j].lo));
            }
        }
    }
    return sqrt(least) * A_LITTLE + A_LITTLE_MORE;
}

/* The same of a point and the vertices of an object's faces. */
static double reach_to(const double x[3], const struct oracle_object *object)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < 3 * object->triangle_count; i++) {
        least = fmin(least, square_of(x, object->x1[object->triangles[i / 3][i % 3]]));
    }
    return sqrt(least) * A_LITTLE + A_LITTLE_MORE;
}

/* ---- the nearest of pairs ---------------------------------------------------------- */

struct best {
    bool is_made;
    enum oracle_kind kind; /* an edge through a face has no distance: EE of one point */
    double p[5][3];
    uint8_t rank[5];
    struct oracle_near near;
};

/* False: it is an edge that does not pass through its face. */
static bool load(const struct two *two, uint32_t kind,
                 const struct oracle_candidate *candidate, struct best *best)
{
    *best =
        (struct best){.is_made = true,
                      .kind = kind == PCCD_EE || kind == PCCD_EF ? ORACLE_EE : ORACLE_VF};
    oracle_candidate_fill(&two->moment, candidate, best->p, best->rank);
    oracle_candidate_name(&two->moment, kind, candidate, &best->near);
    if (kind != PCCD_EF) {
        return true;
    }
    if (!oracle_crosses((const double(*)[3])best->p)) {
        return false;
    }
    best->near.record.param[0] = (float)oracle_crossing((const double(*)[3])best->p);
    for (int i = 1; i < 4; i++) {
        memcpy(best->p[i], best->p[0], sizeof best->p[i]);
    }
    return true;
}

/* Below, equal or above zero as the candidate is to the best so far, which it becomes if
 * it is nearer, or as near and before in canonical order. */
static int look(const struct two *two, uint32_t kind,
                const struct oracle_candidate *candidate, struct best *best)
{
    struct best other;
    if (!load(two, kind, candidate, &other)) {
        return 1;
    }
    int sign = best->is_made
                   ? oracle_distance_compare(
                         other.kind, (const double(*)[3])other.p, other.near.radius,
                         best->kind, (const double(*)[3])best->p, best->near.radius)
                   : -1;
    if (sign < 0 || (sign == 0 && oracle_near_compare(&other.near, &best->near) < 0)) {
        *best = other;
    }
    return sign;
}

/* Find the best of vertices and faces, and, unless they are not all vertices of the two,
 * of all other kinds. false: that is too much. */
static bool look_at_all(struct two *two, const struct oracle_features *vertices,
                        double reach, uint64_t queries_max, struct oracle_nears *nears,
                        struct best *best)
{
    static const uint32_t kinds[] = {PCCD_VF, PCCD_EE, PCCD_EF, PCCD_VE, PCCD_VV};
    enum { KINDS = sizeof kinds / sizeof kinds[0] };
    struct oracle_candidates candidates[KINDS] = {{NULL, 0, 0}};
    memset(best, 0, sizeof *best);
    oracle_candidates_find(&two->moment, vertices, &two->of_points[2], reach,
                           &candidates[0]);
    if (vertices == &two->of_points[0]) {
        oracle_candidates_find(&two->moment, &two->of_points[1], &two->of_points[1],
                               reach, &candidates[1]);
        oracle_candidates_find(&two->moment, &two->of_points[1], &two->of_points[2], 0,
                               &candidates[2]);
        oracle_candidates_find(&two->moment, &two->free[0], &two->free[1], reach,
                               &candidates[3]);
        oracle_candidates_find(&two->moment, &two->free[0], &two->free[0], reach,
                               &candidates[4]);
    }
    for (int k = 0; k < KINDS; k++) {
        nears->queries += candidates[k].count;
    }
    bool is_little = nears->queries <= queries_max;
    for (int k = 0; k < KINDS; k++) {
        for (size_t i = 0; is_little && i < candidates[k].count; i++) {
            nears->ties += look(two, kinds[k], &candidates[k].items[i], best) == 0;
        }
        oracle_candidates_deinit(&candidates[k]);
    }
    return is_little;
}

static void write_best(const struct two *two, struct best *best)
{
    if (best->near.record.kind != PCCD_EF) {
        struct oracle_distance found;
        oracle_distance_find(best->kind, (const double(*)[3])best->p, best->rank, &found);
        oracle_distance_place(best->near.record.kind, &found);
        oracle_near_write(&found, &best->near);
    }
    for (int i = 0; i < 2; i++) {
        best->near.object[i] = two->at[best->near.object[i]];
    }
}

static void add_best(const struct two *two, struct best *best, struct oracle_nears *nears)
{
    write_best(two, best);
    *oracle_nears_add(nears) = best->near;
}

/* ---- nearest ----------------------------------------------------------------------- */

static bool add_nearest(struct two *two, double distance, uint64_t queries_max,
                        struct oracle_nears *nears)
{
    const struct oracle_features *vertices = &two->of_points[0];
    double reach = fmin(distance, reach_of(two));
    struct best best;
    if (!look_at_all(two, vertices, reach, queries_max, nears, &best)) {
        return false;
    }
    if (best.is_made &&
        (isinf(distance) ||
         oracle_is_within(best.kind == ORACLE_EE ? 2 : 1, (const double(*)[3])best.p,
                          best.near.radius, distance))) {
        add_best(two, &best, nears);
    }
    return true;
}

bool oracle_objects_nearest(const struct oracle_moment *moment, const uint32_t asked[2],
                            double distance, uint64_t queries_max,
                            struct oracle_nears *nears)
{
    bool is_little = true;
    memset(nears, 0, sizeof *nears);
    for (uint32_t a = 0; a < moment->object_count; a++) {
        for (uint32_t b = a + 1; is_little && b < moment->object_count; b++) {
            struct two two;
            if (is_asked(moment, asked, a, b)) {
                two_init(&two, moment, a, b);
                is_little = add_nearest(&two, distance, queries_max, nears);
                two_deinit(&two);
            }
        }
    }
    oracle_nears_sort(nears);
    if (!is_little) {
        oracle_nears_deinit(nears);
    }
    return is_little;
}

/* ---- depth ------------------------------------------------------------------------- */

static bool is_in_box(const struct oracle_object *object, const double x[3])
{
    double lo[3] = {INFINITY, INFINITY, INFINITY};
    double hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t v = 0; v < object->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            lo[k] = fmin(lo[k], object->x1[v][k]);
            hi[k] = fmax(hi[k], object->x1[v][k]);
        }
    }
    return x[0] >= lo[0] && x[0] <= hi[0] && x[1] >= lo[1] && x[1] <= hi[1] &&
           x[2] >= lo[2] && x[2] <= hi[2];
}

/* A vertex of one of the two, if it is inside the other. */
static bool add_depth(struct two *two, struct oracle_feature *vertex,
                      uint64_t queries_max, struct oracle_nears *nears)
{
    const struct oracle_object *other = &two->objects[1 - vertex->object];
    const struct oracle_features one = {vertex, 1, 1};
    struct best best;
    int64_t winding;
    if (!is_in_box(other, vertex->lo)) {
        return true;
    }
    nears->queries += other->triangle_count;
    if (nears->queries > queries_max) {
        return false;
    }
    if (!oracle_winding(vertex->lo, other->x1, other->triangles, other->triangle_count,
                        &winding) ||
        winding == 0) {
        return true;
    }
    if (!look_at_all(two, &one, reach_to(vertex->lo, other), queries_max, nears, &best)) {
        return false;
    }
    add_best(two, &best, nears);
    return true;
}

bool oracle_objects_depth(const struct oracle_moment *moment, const uint32_t asked[2],
                          uint64_t queries_max, struct oracle_nears *nears,
                          uint64_t *crossings)
{
    bool is_little = true;
    memset(nears, 0, sizeof *nears);
    *crossings = 0;
    for (uint32_t a = 0; a < moment->object_count; a++) {
        for (uint32_t b = a + 1; is_little && b < moment->object_count; b++) {
            struct oracle_nears through;
            struct two two;
            if (!is_asked(moment, asked, a, b)) {
                continue;
            }
            two_init(&two, moment, a, b);
            is_little = oracle_near_crossings(&two.moment, queries_max, &through);
            *crossings += through.count;
            oracle_nears_deinit(&through);
            for (size_t i = 0; is_little && i < two.of_points[0].count; i++) {
                is_little =
                    add_depth(&two, &two.of_points[0].items[i], queries_max, nears);
            }
            two_deinit(&two);
        }
    }
    oracle_nears_sort(nears);
    if (!is_little) {
        oracle_nears_deinit(nears);
    }
    return is_little;
}

/* ---- one pair ---------------------------------------------------------------------- */

static uint32_t place_of(const struct oracle_moment *moment, uint32_t id)
{
    uint32_t i = 0;
    while (i < moment->object_count && moment->objects[i].object_id != id) {
        i++;
    }
    return i;
}

static const struct oracle_feature *feature_of(const struct oracle_features *features,
                                               uint32_t object, uint32_t index)
{
    for (size_t i = 0; i < features->count; i++) {
        if (features->items[i].object == object && features->items[i].index == index) {
            return &features->items[i];
        }
    }
    return NULL;
}

bool oracle_objects_measure(const struct oracle_moment *moment,
                            const struct pccd_near *named, struct oracle_near *near)
{
    uint32_t a = place_of(moment, named->object_a);
    uint32_t b = place_of(moment, named->object_b);
    struct two two;
    if (a == moment->object_count || b == moment->object_count || a == b ||
        named->kind >= COMMON_KIND_COUNT ||
        (common_kinds[named->kind].points[0] == common_kinds[named->kind].points[1] &&
         named->object_a > named->object_b)) {
        return false;
    }
    two_init(&two, moment, a, b);
    const struct oracle_candidate candidate = {
        feature_of(&two.of_points[common_kinds[named->kind].points[0] - 1], 0,
                   named->feature_a),
        feature_of(&two.of_points[common_kinds[named->kind].points[1] - 1], 1,
                   named->feature_b),
        !moment->is_thick};
    struct best best = {.is_made = false};
    if (candidate.a && candidate.b) {
        (void)look(&two, named->kind, &candidate, &best);
    }
    if (best.is_made) {
        write_best(&two, &best);
        *near = best.near;
    }
    two_deinit(&two);
    return best.is_made;
}
