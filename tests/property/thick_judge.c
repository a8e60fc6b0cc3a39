/* tests/property/thick_judge.c - all pairs of two small thick objects.
 *
 * Room:     tests/property; engine (scene.h), client/oracle.
 * Does:     see thick_judge.h.
 * Threads:  one.
 */
#include "thick_judge.h"

#include <gmp.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "oracle_within.h"

struct feature {
    uint32_t object;
    uint32_t index;
    uint32_t count; /* of vertices */
    uint32_t v[3];
};

static struct feature feature_of(const struct thick_play *play, uint32_t points,
                                 uint32_t object, uint32_t index)
{
    struct feature feature = {object, index, points, {index, 0, 0}};
    const struct thick_body *body = &play->bodies[object];
    if (points == 2) {
        memcpy(feature.v, body->edges[index], 2 * sizeof feature.v[0]);
    } else if (points == 3) {
        memcpy(feature.v, body->shape.triangles[index], sizeof feature.v);
    }
    return feature;
}

/* ---- shapes ------------------------------------------------------------------------ */

/* Its place among the edges, by (higher, lower) vertex. A named one is free as long as no
 * triangle has it. */
static void add_edge(struct thick_body *body, uint32_t a, uint32_t b, bool is_named)
{
    uint32_t low = a < b ? a : b;
    uint32_t high = a < b ? b : a;
    uint32_t at = 0;
    while (at < body->edge_count &&
           (body->edges[at][1] < high ||
            (body->edges[at][1] == high && body->edges[at][0] < low))) {
        at++;
    }
    if (a == b || (at < body->edge_count && body->edges[at][0] == low &&
                   body->edges[at][1] == high)) {
        return; /* triangles come first: one that is there stays what it is */
    }
    memmove(body->edges[at + 1], body->edges[at],
            (body->edge_count - at) * sizeof body->edges[0]);
    memmove(&body->is_free_edge[at + 1], &body->is_free_edge[at],
            (body->edge_count - at) * sizeof body->is_free_edge[0]);
    body->edges[at][0] = low;
    body->edges[at][1] = high;
    body->is_free_edge[at] = is_named;
    assert_true(++body->edge_count <= THICK_EDGES_MAX);
    body->is_vertex[a] = true;
    body->is_vertex[b] = true;
}

void thick_judge_shape(struct thick_body *body)
{
    const struct thick_shape *shape = &body->shape;
    body->edge_count = 0;
    memset(body->is_vertex, 0, sizeof body->is_vertex);
    memset(body->is_free_point, 0, sizeof body->is_free_point);
    for (uint32_t i = 0; i < 3 * shape->triangle_count; i++) {
        const uint32_t *v = shape->triangles[i / 3];
        add_edge(body, v[i % 3], v[(i % 3 + 1) % 3], false);
        body->is_vertex[v[i % 3]] = true;
    }
    for (uint32_t i = 0; i < shape->edge_count; i++) {
        add_edge(body, shape->edges[i][0], shape->edges[i][1], true);
    }
    for (uint32_t i = 0; i < shape->edge_count + shape->point_count; i++) {
        bool is_point = i >= shape->edge_count;
        uint32_t v = is_point ? shape->points[i - shape->edge_count] : shape->edges[i][0];
        if ((is_point || v == shape->edges[i][1]) && !body->is_vertex[v]) {
            body->is_free_point[v] = true;
        }
    }
    for (uint32_t v = 0; v < THICK_VERTICES; v++) {
        body->is_vertex[v] |= body->is_free_point[v];
    }
}

/* Is it a feature that pairs of a kind are made of? */
static bool is_of_kind(const struct thick_play *play, uint32_t kind,
                       const struct feature *feature)
{
    const struct thick_body *body = &play->bodies[feature->object];
    bool is_of_free = kind == PCCD_VE || kind == PCCD_VV;
    if (feature->count == 1) {
        return is_of_free ? body->is_free_point[feature->index]
                          : body->is_vertex[feature->index];
    }
    return feature->count == 3 || !is_of_free || body->is_free_edge[feature->index];
}

/* ---- pairs ------------------------------------------------------------------------- */

static double radius_of(const struct thick_play *play, const struct feature *feature)
{
    const struct thick_body *body = &play->bodies[feature->object];
    double most = 0;
    for (uint32_t i = 0; i < feature->count; i++) {
        most = fmax(most, body->radii[feature->v[i]]);
    }
    return body->thickness.has_radius ? body->thickness.radius : most;
}

/* Vertex i, 0 .. 3, of a pair; the last one stands for all behind it. */
static uint32_t vertex_of(const struct feature *a, const struct feature *b, uint32_t i)
{
    uint32_t last = b->count - 1;
    return i < a->count ? a->v[i] : b->v[i - a->count < last ? i - a->count : last];
}

/* Is the pair left thin? */
static bool rests(const struct thick_play *play, const struct feature *a,
                  const struct feature *b)
{
    const struct thick_body *body = &play->bodies[a->object];
    double x[4][3];
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(x[i], body->rest[vertex_of(a, b, i)], sizeof x[i]);
    }
    return a->object == b->object &&
           (oracle_are_joined(body->edges, body->edge_count, THICK_VERTICES, a->v,
                              a->count, b->v, b->count, body->thickness.rest_rings) ||
            oracle_is_nearer(a->count, (const double(*)[3])x,
                             body->thickness.rest_distance));
}

static bool have_common(const struct feature *a, const struct feature *b)
{
    for (uint32_t i = 0; i < a->count; i++) {
        for (uint32_t k = 0; k < b->count; k++) {
            if (a->object == b->object && a->v[i] == b->v[k]) {
                return true;
            }
        }
    }
    return false;
}

/* The sign of high - low less the radii, exactly. */
static int sign_beyond(double high, double low, const double radius[3])
{
    const double terms[5] = {high, -low, -radius[0], -radius[1], -radius[2]};
    mpq_t sum;
    mpq_t term;
    mpq_inits(sum, term, NULL);
    for (int i = 0; i < 5; i++) {
        mpq_set_d(term, terms[i]);
        mpq_add(sum, sum, term);
    }
    int sign = mpq_sgn(sum);
    mpq_clears(sum, term, NULL);
    return sign;
}

/* By the definition of mode pairs. p: as the oracle has them. */
static bool is_candidate(const double p[8][3], uint32_t points_a, const double radius[3])
{
    for (int k = 0; k < 3; k++) {
        for (int turn = 0; turn < 2; turn++) {
            bool apart = true;
            for (uint32_t i = 0; i < points_a; i++) {
                for (uint32_t j = points_a; j < 4; j++) {
                    for (uint32_t end = 0; end < 8; end += 4) {
                        double a = p[end + i][k];
                        double b = p[end + j][k];
                        apart &= sign_beyond(turn ? a : b, turn ? b : a, radius) > 0;
                    }
                }
            }
            if (apart) {
                return false;
            }
        }
    }
    return true;
}

static void decide(struct thick_play *play, uint32_t kind, const struct feature *a,
                   const struct feature *b)
{
    double p[8][3];
    for (uint32_t i = 0; i < 8; i++) {
        const struct feature *of = i % 4 < a->count ? a : b;
        memcpy(p[i], play->bodies[of->object].x[i / 4][vertex_of(a, b, i % 4)],
               sizeof p[i]);
    }
    struct oracle_thick thick = {
        .points_a = (int)a->count,
        .points_b = (int)b->count,
        .p = (const double(*)[3])p,
        .radius = {radius_of(play, a), radius_of(play, b), play->separation},
        .approach = play->approach};
    if (rests(play, a, b)) {
        memset(thick.radius, 0, sizeof thick.radius);
    }
    struct thick_truth *truth = &play->truths[play->truth_count];
    truth->name = (struct pccd_pair){(enum pccd_kind)kind, a->object + 1, a->index,
                                     b->object + 1, b->index};
    truth->is_thick = thick.radius[0] + thick.radius[1] + thick.radius[2] > 0;
    bool is_tested = truth->is_thick || kind == PCCD_VF || kind == PCCD_EE;
    truth->is_candidate =
        is_tested && is_candidate((const double(*)[3])p, a->count, thick.radius);
    truth->is_inside = is_tested && oracle_thick_is_inside(&thick);
    truth->first = is_tested ? oracle_thick_first_new(&thick) : NULL;
    assert_true(truth->is_candidate || (!truth->first && !truth->is_inside));
    assert_true(++play->truth_count < THICK_PAIRS_MAX);
}

void thick_judge_forget(struct thick_play *play)
{
    for (uint32_t i = 0; i < play->truth_count; i++) {
        oracle_first_free(play->truths[i].first);
    }
    play->truth_count = 0;
}

#define THICK_KINDS 4u

/* Points of the features of a kind. */
static const uint32_t sides[THICK_KINDS][2] = {
    [PCCD_VF] = {1, 3}, [PCCD_EE] = {2, 2}, [PCCD_VE] = {1, 2}, [PCCD_VV] = {1, 1}};

/* All features of so many points, by (object, index). */
static uint32_t list_features(const struct thick_play *play, uint32_t points,
                              struct feature *features)
{
    uint32_t count = 0;
    for (uint32_t object = 0; object < THICK_OBJECTS; object++) {
        const struct thick_body *body = &play->bodies[object];
        uint32_t all = points == 1   ? THICK_VERTICES
                       : points == 2 ? body->edge_count
                                     : body->shape.triangle_count;
        for (uint32_t i = 0; i < all; i++) {
            features[count++] = feature_of(play, points, object, i);
        }
    }
    return count;
}

void thick_judge_decide(struct thick_play *play)
{
    struct feature features[4][THICK_OBJECTS * THICK_EDGES_MAX];
    uint32_t counts[4];
    thick_judge_forget(play);
    for (uint32_t points = 1; points <= 3; points++) {
        counts[points] = list_features(play, points, features[points]);
    }
    for (uint32_t kind = 0; kind < THICK_KINDS; kind++) {
        const uint32_t *points = sides[kind];
        for (uint32_t i = 0; i < counts[points[0]]; i++) {
            const struct feature *a = &features[points[0]][i];
            for (uint32_t j = points[0] == points[1] ? i + 1 : 0; j < counts[points[1]];
                 j++) {
                const struct feature *b = &features[points[1]][j];
                if (!have_common(a, b) && is_of_kind(play, kind, a) &&
                    is_of_kind(play, kind, b)) {
                    decide(play, kind, a, b);
                }
            }
        }
    }
}

bool thick_judge_is_near(const struct thick_play *play, const struct thick_truth *truth,
                         double distance, uint32_t end)
{
    const uint32_t *points = sides[truth->name.kind];
    struct feature a =
        feature_of(play, points[0], truth->name.object_a - 1, truth->name.feature_a);
    struct feature b =
        feature_of(play, points[1], truth->name.object_b - 1, truth->name.feature_b);
    double p[8][3];
    for (uint32_t i = 0; i < 8; i++) {
        const struct feature *of = i % 4 < a.count ? &a : &b;
        memcpy(p[i], play->bodies[of->object].x[end][vertex_of(&a, &b, i % 4)],
               sizeof p[i]);
    }
    struct oracle_thick thick = {
        .points_a = (int)a.count,
        .points_b = (int)b.count,
        .p = (const double(*)[3])p,
        .radius = {radius_of(play, &a), radius_of(play, &b), distance}};
    return !rests(play, &a, &b) && oracle_thick_is_inside(&thick);
}
