/* near_judge.c - who is right about what is near. */
#include "near_ours.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_distance.h"
#include "report.h"

#define TOLERANCE 1e-6 /* of a square */

/* Edge between two vertices. */
struct edge_of {
    uint32_t vertex[2]; /* the lower one first */
    uint32_t edge;
};

struct judge {
    const struct near_input *input;
    double d;
    struct edge_of *edges;         /* sorted */
    struct near_feature *features; /* of all pairs that are within d */
    uint64_t feature_count;
    struct near_bracket *bounds; /* by vertex: of its nearest pair */
    struct near_verdict ours, theirs;
};

static int compare_names(const void *left, const void *right)
{
    const struct near_name *a = left;
    const struct near_name *b = right;
    return a->kind != b->kind ? (a->kind < b->kind ? -1 : 1)
           : a->a != b->a     ? (a->a < b->a ? -1 : 1)
           : a->b != b->b     ? (a->b < b->b ? -1 : 1)
                              : 0;
}

static int compare_edges(const void *left, const void *right)
{
    return memcmp(left, right, sizeof((struct edge_of *)NULL)->vertex);
}

static void list_edges(struct judge *judge)
{
    const struct near_input *input = judge->input;
    judge->edges = bench_alloc(input->edge_count, sizeof *judge->edges);
    for (uint32_t i = 0; i < input->edge_count; i++) {
        uint32_t a = input->edges[i][0];
        uint32_t b = input->edges[i][1];
        judge->edges[i] = (struct edge_of){{a < b ? a : b, a < b ? b : a}, i};
    }
    qsort(judge->edges, input->edge_count, sizeof *judge->edges, compare_edges);
}

static uint32_t find_edge(const struct judge *judge, uint32_t a, uint32_t b)
{
    struct edge_of key = {{a < b ? a : b, a < b ? b : a}, 0};
    const struct edge_of *found = bsearch(&key, judge->edges, judge->input->edge_count,
                                          sizeof *judge->edges, compare_edges);
    return found ? found->edge : UINT32_MAX;
}

/* The four points of a pair, as the oracle wants them. */
struct points {
    uint32_t vertex[4];
    double x[4][3];
    uint8_t rank[4];
};

static void gather(const struct near_input *input, struct near_name name,
                   struct points *points)
{
    if (name.kind == NEAR_VF) {
        points->vertex[0] = name.a;
        memcpy(points->vertex + 1, input->faces[name.b], 3 * sizeof(uint32_t));
    } else {
        memcpy(points->vertex, input->edges[name.a], 2 * sizeof(uint32_t));
        memcpy(points->vertex + 2, input->edges[name.b], 2 * sizeof(uint32_t));
    }
    for (int i = 0; i < 4; i++) {
        points->rank[i] = 0;
        for (int j = 0; j < 4; j++) {
            points->rank[i] =
                (uint8_t)(points->rank[i] + (points->vertex[j] < points->vertex[i]));
        }
        memcpy(points->x[i], input->x[points->vertex[i]], sizeof points->x[i]);
    }
}

/* The features between which the oracle has found the distance. */
static struct near_name closest_of(const struct judge *judge, struct near_name name,
                                   const struct points *points,
                                   const struct oracle_distance *found)
{
    uint32_t side[2][2];
    uint32_t count[2] = {0, 0};
    uint32_t of_first = name.kind == NEAR_VF ? 1 : 2;
    if ((uint32_t)found->type == name.kind) {
        return name;
    }
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t at = i >= of_first;
        if ((found->points >> i & 1) && count[at] < 2) {
            side[at][count[at]++] = points->vertex[i];
        }
    }
    if (found->type == ORACLE_NEAREST_VV) {
        uint32_t a = side[0][0];
        uint32_t b = side[1][0];
        return (struct near_name){NEAR_VV, a < b ? a : b, a < b ? b : a};
    }
    uint32_t at = count[0] == 2 ? 0 : 1; /* whose edge */
    return (struct near_name){NEAR_VE, side[1 - at][0],
                              find_edge(judge, side[at][0], side[at][1])};
}

static void add_feature(struct judge *judge, struct near_name name)
{
    judge->features[judge->feature_count++] = (struct near_feature){name, 1};
}

static void bound(struct judge *judge, const struct points *points,
                  const struct oracle_distance *found)
{
    for (int i = 0; i < 4; i++) {
        struct near_bracket *bracket = &judge->bounds[points->vertex[i]];
        bracket->lo = fmin(bracket->lo, found->lo);
        bracket->hi = fmin(bracket->hi, found->hi);
    }
}

/* The oracle's answer for one pair against those of both sides, where they have it. */
static void judge_pair(struct judge *judge, struct near_name name,
                       const struct near_pair *of_us, const struct near_bracket *bracket,
                       const struct near_pair *of_them)
{
    struct near_verdict *ours = &judge->ours, *theirs = &judge->theirs;
    struct points points;
    struct oracle_distance found;
    gather(judge->input, name, &points);
    oracle_distance_find((enum oracle_kind)name.kind, points.x, points.rank, &found);
    struct near_name closest = closest_of(judge, name, &points, &found);
    bool within = oracle_distance_within((enum oracle_kind)name.kind, points.x, judge->d);
    if (within) {
        add_feature(judge, closest);
        bound(judge, &points, &found);
        bool at_bound = !oracle_distance_within((enum oracle_kind)name.kind, points.x,
                                                nextafter(judge->d, 0));
        ours->missing += of_us == NULL;
        theirs->missing += of_them == NULL;
        theirs->at_bound += of_them == NULL && at_bound;
    } else {
        ours->surplus += of_us != NULL;
        theirs->surplus += of_them != NULL;
    }
    if (of_us) {
        ours->distances += bracket->lo != found.lo || bracket->hi != found.hi;
        ours->closest += of_us->closest.kind != closest.kind;
    }
    if (of_them) {
        theirs->distances +=
            !(of_them->squared >= found.lo * found.lo * (1 - TOLERANCE) &&
              of_them->squared <= found.hi * found.hi * (1 + TOLERANCE));
        theirs->closest += compare_names(&of_them->closest, &closest) != 0;
    }
}

/* Both sides' pairs in one order. */
static void judge_pairs(struct judge *judge, const struct near_ours *of_ours,
                        const struct near_answers *theirs)
{
    const struct near_answers *ours = &of_ours->answers;
    uint64_t i = 0;
    uint64_t j = 0;
    while (i < ours->pair_count || j < theirs->pair_count) {
        int order = i == ours->pair_count ? 1
                    : j == theirs->pair_count
                        ? -1
                        : compare_names(&ours->pairs[i].name, &theirs->pairs[j].name);
        const struct near_pair *of_us = order <= 0 ? &ours->pairs[i] : NULL;
        const struct near_pair *of_them = order >= 0 ? &theirs->pairs[j] : NULL;
        judge_pair(judge, of_us ? of_us->name : of_them->name, of_us,
                   of_us ? &of_ours->brackets[i] : NULL, of_them);
        i += of_us != NULL;
        j += of_them != NULL;
    }
}

/* Sorts; each name once, counts added. */
static uint64_t merge(struct near_feature *features, uint64_t count)
{
    uint64_t kept = 0;
    qsort(features, count, sizeof *features, compare_names);
    for (uint64_t i = 0; i < count; i++) {
        if (kept > 0 && compare_names(&features[kept - 1], &features[i]) == 0) {
            features[kept - 1].count += features[i].count;
        } else {
            features[kept++] = features[i];
        }
    }
    return kept;
}

/* Merged features that only one side has, or with another count. */
static uint64_t differences(const struct judge *judge, const struct near_feature *others,
                            uint64_t count)
{
    uint64_t wrong = 0;
    uint64_t i = 0;
    uint64_t j = 0;
    while (i < judge->feature_count && j < count) {
        int order = compare_names(&judge->features[i], &others[j]);
        wrong += order != 0 || judge->features[i].count != others[j].count;
        i += order <= 0;
        j += order >= 0;
    }
    return wrong + (judge->feature_count - i) + (count - j);
}

static void judge_bounds(struct judge *judge, const double *ours, const double *theirs)
{
    for (uint32_t i = 0; i < judge->input->vertex_count; i++) {
        double hi = fmin(judge->bounds[i].hi, judge->d);
        judge->ours.bounds += ours[i] != fmin(judge->bounds[i].lo, judge->d);
        if (theirs && theirs[i] > hi) {
            judge->theirs.bounds++;
            judge->theirs.most = fmax(judge->theirs.most, theirs[i] / hi - 1);
        }
    }
}

static void bounds_init(struct judge *judge)
{
    judge->bounds = bench_alloc(judge->input->vertex_count, sizeof *judge->bounds);
    for (uint32_t i = 0; i < judge->input->vertex_count; i++) {
        judge->bounds[i] = (struct near_bracket){INFINITY, INFINITY};
    }
}

void near_judge(const struct near_input *input, double d, const struct near_ours *of_us,
                struct near_answers *theirs, struct near_verdict *of_ours,
                struct near_verdict *of_theirs)
{
    const struct near_answers *ours = &of_us->answers;
    struct near_answers nobody = {0};
    struct near_answers *others = theirs ? theirs : &nobody;
    struct judge judge = {.input = input, .d = d};
    judge.features =
        bench_alloc(ours->pair_count + others->pair_count + 1, sizeof *judge.features);
    list_edges(&judge);
    bounds_init(&judge);
    if (others->pair_count > 0) {
        qsort(others->pairs, others->pair_count, sizeof *others->pairs, compare_names);
    }
    judge_pairs(&judge, of_us, others);
    judge.ours.pairs = judge.theirs.pairs = judge.feature_count;
    judge.feature_count = merge(judge.features, judge.feature_count);
    judge.ours.features = judge.theirs.features = judge.feature_count;
    judge.ours.merged = differences(&judge, ours->features, ours->feature_count);
    if (theirs) {
        theirs->feature_count = merge(theirs->features, theirs->feature_count);
        judge.theirs.merged =
            differences(&judge, theirs->features, theirs->feature_count);
    }
    judge_bounds(&judge, ours->bounds, others->bounds);
    *of_ours = judge.ours;
    *of_theirs = judge.theirs;
    free(judge.edges);
    free(judge.features);
    free(judge.bounds);
}
