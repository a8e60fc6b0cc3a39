/* oracle_near.c - everything that is near, by brute force. */
#include "oracle_near.h"

#include <assert.h>
#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_thick.h"

void oracle_moment_thicken(struct oracle_moment *moment, enum pccd_near_what what)
{
    moment->keeps_thin = what == PCCD_NEAR_VERTICES;
    moment->is_thick = moment->keeps_thin || what == PCCD_NEAR_PAIRS ||
                       what == PCCD_NEAR_FEATURES || what == PCCD_NEAR_NEAREST;
}

void oracle_candidate_fill(const struct oracle_moment *moment,
                           const struct oracle_candidate *candidate, double p[5][3],
                           uint8_t rank[5])
{
    uint32_t count = candidate->a->points + candidate->b->points;
    oracle_candidate_load(moment, candidate, p, rank);
    assert(count >= 2 && count <= 5);
    for (uint32_t last = rank[count - 1]; count < 4; count++) {
        for (uint32_t i = 0; i < count; i++) {
            rank[i] = (uint8_t)(rank[i] + (rank[i] > last));
        }
        rank[count] = (uint8_t)++last;
        memcpy(p[count], p[count - 1], sizeof p[count]);
    }
}

void oracle_distance_place(uint32_t kind, struct oracle_distance *found)
{
    if (kind == PCCD_VE || kind == PCCD_VV) {
        found->param[1] = kind == PCCD_VE ? found->param[0] + found->param[1] : 0;
        found->param[0] = 0;
    }
}

static void decide_pairs(const struct oracle_moment *moment, uint32_t of_kind,
                         const struct oracle_candidates *candidates, double distance,
                         struct oracle_nears *pairs)
{
    enum oracle_kind kind = of_kind == PCCD_EE ? ORACLE_EE : ORACLE_VF;
    for (size_t i = 0; i < candidates->count; i++) {
        const struct oracle_candidate *candidate = &candidates->items[i];
        double p[5][3];
        uint8_t rank[5];
        struct oracle_distance found;
        struct oracle_near near = {.points = 0};
        oracle_candidate_fill(moment, candidate, p, rank);
        oracle_candidate_name(moment, of_kind, candidate, &near);
        pairs->queries++;
        if (oracle_is_within(kind == ORACLE_EE ? 2 : 1, (const double(*)[3])p,
                             near.radius, distance)) {
            oracle_distance_find(kind, (const double(*)[3])p, rank, &found);
            oracle_distance_place(of_kind, &found);
            oracle_near_write(&found, &near);
            *oracle_nears_add(pairs) = near;
        }
    }
}

bool oracle_near_pairs(const struct oracle_moment *moment, double distance,
                       uint64_t queries_max, struct oracle_nears *pairs)
{
    static const uint32_t sides[PCCD_KIND_COUNT][2] = {/* of the lists below */
                                                       [PCCD_VF] = {0, 2},
                                                       [PCCD_EE] = {1, 1},
                                                       [PCCD_VE] = {3, 4},
                                                       [PCCD_VV] = {3, 3}};
    struct oracle_features lists[5]; /* vertices, edges, faces; free vertices, edges */
    struct oracle_candidates candidates[PCCD_KIND_COUNT];
    uint64_t count = 0;
    memset(pairs, 0, sizeof *pairs);
    memset(candidates, 0, sizeof candidates);
    for (uint32_t i = 0; i < 5; i++) {
        oracle_features_list(moment->objects, moment->object_count, i % 3 + 1, &lists[i]);
    }
    oracle_features_keep_free(&lists[3]);
    oracle_features_keep_free(&lists[4]);
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        oracle_candidates_find(moment, &lists[sides[kind][0]], &lists[sides[kind][1]],
                               distance, &candidates[kind]);
        count += candidates[kind].count;
    }
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        if (count <= queries_max) {
            decide_pairs(moment, kind, &candidates[kind], distance, pairs);
        }
        oracle_candidates_deinit(&candidates[kind]);
    }
    oracle_nears_sort(pairs);
    for (uint32_t i = 0; i < 5; i++) {
        oracle_features_deinit(&lists[i]);
    }
    return count <= queries_max;
}

bool oracle_near_crossings(const struct oracle_moment *moment, uint64_t queries_max,
                           struct oracle_nears *crossings)
{
    struct oracle_features edges;
    struct oracle_features faces;
    struct oracle_candidates candidates = {NULL, 0, 0};
    memset(crossings, 0, sizeof *crossings);
    oracle_features_list(moment->objects, moment->object_count, 2, &edges);
    oracle_features_list(moment->objects, moment->object_count, 3, &faces);
    oracle_candidates_find(moment, &edges, &faces, 0, &candidates);
    bool is_little = candidates.count <= queries_max;
    for (size_t i = 0; is_little && i < candidates.count; i++) {
        double p[5][3];
        uint8_t rank[5];
        oracle_candidate_load(moment, &candidates.items[i], p, rank);
        crossings->queries++;
        if (oracle_crosses((const double(*)[3])p)) {
            struct oracle_near *near = oracle_nears_add(crossings);
            oracle_candidate_name(moment, PCCD_EF, &candidates.items[i], near);
            near->record.param[0] = (float)oracle_crossing((const double(*)[3])p);
        }
    }
    oracle_nears_sort(crossings);
    oracle_candidates_deinit(&candidates);
    oracle_features_deinit(&edges);
    oracle_features_deinit(&faces);
    return is_little;
}

/* ---- points of pairs --------------------------------------------------------------- */

/* A point of a pair. */
struct point {
    uint32_t side;   /* 0: of a, 1: of b */
    uint32_t object; /* index */
    uint32_t v;
};

struct edges {
    uint32_t (**of)[2]; /* [object] */
    uint32_t *counts;
};

static struct edges list_edges(const struct oracle_moment *moment)
{
    struct edges edges;
    edges.of = oracle_grow(NULL, (moment->object_count + 1) * sizeof *edges.of);
    edges.counts = oracle_grow(NULL, (moment->object_count + 1) * sizeof *edges.counts);
    for (uint32_t i = 0; i < moment->object_count; i++) {
        edges.of[i] = oracle_edges(&moment->objects[i], &edges.counts[i]);
    }
    return edges;
}

static void free_edges(const struct oracle_moment *moment, struct edges *edges)
{
    for (uint32_t i = 0; i < moment->object_count; i++) {
        free(edges->of[i]);
    }
    free(edges->of);
    free(edges->counts);
}

/* The points of a pair, the last repeated up to four. */
static void list_points(const struct oracle_moment *moment, const struct edges *edges,
                        const struct oracle_near *near, struct point points[4])
{
    const struct pccd_near *record = &near->record;
    const uint32_t *a = &record->feature_a;
    const uint32_t *b = &record->feature_b;
    uint32_t count_a = record->kind == PCCD_EE ? 2 : 1;
    uint32_t count_b = record->kind == PCCD_VF ? 3 : record->kind == PCCD_VV ? 1 : 2;
    if (record->kind == PCCD_VF) {
        b = moment->objects[near->object[1]].triangles[record->feature_b];
    } else if (record->kind != PCCD_VV) {
        b = edges->of[near->object[1]][record->feature_b];
    }
    if (record->kind == PCCD_EE) {
        a = edges->of[near->object[0]][record->feature_a];
    }
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t k = i - count_a < count_b ? i - count_a : count_b - 1;
        points[i] = i < count_a ? (struct point){0, near->object[0], a[i]}
                                : (struct point){1, near->object[1], b[k]};
    }
}

/* By how much the points of a pair may come nearer before its surfaces meet. */
static double bound_by(const struct oracle_near *near)
{
    mpq_t exact;
    mpq_t other;
    mpq_inits(exact, other, NULL);
    double radii = near->radius[0] + near->radius[1];
    mpq_set_d(exact, near->radius[0]);
    mpq_set_d(other, near->radius[1]);
    mpq_add(exact, exact, other);
    mpq_set_d(other, radii);
    radii = mpq_cmp(other, exact) < 0 ? nextafter(radii, INFINITY) : radii;
    mpq_set_d(exact, near->record.d_lo);
    mpq_set_d(other, radii);
    mpq_sub(exact, exact, other);
    double bound = mpq_sgn(exact) > 0 ? mpq_get_d(exact) : 0; /* cuts off */
    mpq_clears(exact, other, NULL);
    return bound;
}

void oracle_near_bounds(const struct oracle_moment *moment,
                        const struct oracle_nears *pairs, uint32_t at, double distance,
                        double *bounds)
{
    struct edges edges = list_edges(moment);
    for (uint32_t v = 0; v < moment->objects[at].vertex_count; v++) {
        bounds[v] = distance;
    }
    for (size_t i = 0; i < pairs->count; i++) {
        const struct oracle_near *near = &pairs->items[i];
        struct point points[4];
        double bound = bound_by(near);
        list_points(moment, &edges, near, points);
        for (int k = 0; k < 4; k++) {
            if (points[k].object == at && bound < bounds[points[k].v]) {
                bounds[points[k].v] = bound;
            }
        }
    }
    free_edges(moment, &edges);
}

/* ---- closest features -------------------------------------------------------------- */

static uint32_t edge_between(const struct edges *edges, const struct point *p,
                             const struct point *q)
{
    uint32_t low = p->v < q->v ? p->v : q->v;
    uint32_t high = p->v < q->v ? q->v : p->v;
    assert(p->object == q->object);
    for (uint32_t i = 0; i < edges->counts[p->object]; i++) {
        const uint32_t *edge = edges->of[p->object][i];
        if (edge[0] == low && edge[1] == high) {
            return i;
        }
    }
    abort();
}

/* A vertex and an edge, or two vertices, are two edges of which one or both have no
 * length. */
static void measure(const struct oracle_moment *moment, const struct edges *edges,
                    struct oracle_near *near)
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    const uint32_t feature[2] = {near->record.feature_a, near->record.feature_b};
    struct oracle_distance found;
    double p[4][3];
    for (int i = 0; i < 4; i++) {
        uint32_t object = near->object[i / 2];
        uint32_t v = i < 2 || near->record.kind == PCCD_VV
                         ? feature[i / 2]
                         : edges->of[object][feature[1]][i - 2];
        memcpy(p[i], moment->objects[object].x1[v], sizeof p[i]);
    }
    oracle_distance_find(ORACLE_EE, (const double(*)[3])p, rank, &found);
    assert((uint32_t)found.type == near->record.kind);
    found.param[0] = 0; /* of the edge without a length */
    oracle_near_write(&found, near);
}

static void name_closest(const struct oracle_moment *moment, const struct edges *edges,
                         const struct oracle_near *pair, struct oracle_near *near)
{
    struct point all[4];
    struct point points[4];
    uint32_t count = 0;
    *near = *pair;
    list_points(moment, edges, pair, all);
    for (uint32_t i = 0; i < 4; i++) {
        if (pair->points >> i & 1) {
            points[count++] = all[i];
        }
    }
    if (count == 4) {
        return;
    }
    const struct point *a = &points[0];
    const struct point *b = &points[count - 1];
    near->record.kind = count == 2 ? PCCD_VV : PCCD_VE;
    if (count == 3 && points[1].side == a->side) { /* the edge is of the first */
        a = &points[2];
        b = &points[0];
    }
    near->object[0] = a->object;
    near->object[1] = b->object;
    near->record.feature_a = a->v;
    near->record.feature_b = count == 2 ? b->v : edge_between(edges, b, &points[1]);
    near->record.object_a = moment->objects[a->object].object_id;
    near->record.object_b = moment->objects[b->object].object_id;
    if (count == 2 && (near->record.object_a != near->record.object_b
                           ? near->record.object_a > near->record.object_b
                           : a->v > b->v)) {
        struct oracle_near turned = *near;
        turned.object[0] = near->object[1];
        turned.object[1] = near->object[0];
        turned.record.object_a = near->record.object_b;
        turned.record.object_b = near->record.object_a;
        turned.record.feature_a = near->record.feature_b;
        turned.record.feature_b = near->record.feature_a;
        *near = turned;
    }
    measure(moment, edges, near);
}

void oracle_near_features(const struct oracle_moment *moment,
                          const struct oracle_nears *pairs, struct oracle_nears *features)
{
    struct edges edges = list_edges(moment);
    memset(features, 0, sizeof *features);
    for (size_t i = 0; i < pairs->count; i++) {
        name_closest(moment, &edges, &pairs->items[i], oracle_nears_add(features));
    }
    oracle_nears_sort(features);
    size_t kept = 0;
    for (size_t i = 0; i < features->count; i++) {
        struct oracle_near *near = &features->items[i];
        struct oracle_near *last = kept > 0 ? &features->items[kept - 1] : NULL;
        if (last && oracle_near_compare(last, near) == 0) {
            near->record.count = ++last->record.count;
            assert(memcmp(&last->record, &near->record, sizeof near->record) == 0);
        } else {
            features->items[kept++] = *near;
        }
    }
    features->count = kept;
    free_edges(moment, &edges);
}

void oracle_nears_deinit(struct oracle_nears *nears)
{
    free(nears->items);
    memset(nears, 0, sizeof *nears);
}
