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

#include "oracle_distance.h"

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
    const struct eng_mesh *mesh = play->bodies[object].mesh;
    if (points == 2) {
        memcpy(feature.v, eng_mesh_edges(mesh)[index], 2 * sizeof feature.v[0]);
    } else if (points == 3) {
        feature.v[1] = index + 1;
        feature.v[2] = index + 2;
    }
    return feature;
}

static double radius_of(const struct thick_play *play, const struct feature *feature)
{
    const struct thick_body *body = &play->bodies[feature->object];
    double most = 0;
    for (uint32_t i = 0; i < feature->count; i++) {
        most = fmax(most, body->radii[feature->v[i]]);
    }
    return body->thickness.has_radius ? body->thickness.radius : most;
}

/* Of a strip: from a vertex one edge leads to the next two. */
static bool are_within_rings(const struct feature *a, const struct feature *b, uint32_t n)
{
    for (uint32_t i = 0; i < a->count; i++) {
        for (uint32_t k = 0; k < b->count; k++) {
            uint32_t low = a->v[i] < b->v[k] ? a->v[i] : b->v[k];
            if (a->v[i] + b->v[k] - 2 * low <= 2 * n) {
                return true;
            }
        }
    }
    return false;
}

/* Is the pair left thin? */
static bool rests(const struct thick_play *play, const struct feature *a,
                  const struct feature *b)
{
    const struct thick_body *body = &play->bodies[a->object];
    const double far[4][3] = {{body->thickness.rest_distance}};
    double x[4][3];
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t v = i < a->count ? a->v[i] : b->v[i - a->count];
        memcpy(x[i], body->rest[v], sizeof x[i]);
    }
    return a->object == b->object &&
           (are_within_rings(a, b, body->thickness.rest_rings) ||
            oracle_distance_compare(a->count == 1 ? ORACLE_VF : ORACLE_EE,
                                    (const double(*)[3])x, ORACLE_VF, far) < 0);
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
        uint32_t v = of->v[i % 4 < a->count ? i % 4 : i % 4 - a->count];
        memcpy(p[i], play->bodies[of->object].x[i / 4][v], sizeof p[i]);
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
    truth->is_candidate = is_candidate((const double(*)[3])p, a->count, thick.radius);
    truth->is_inside = oracle_thick_is_inside(&thick);
    truth->first = oracle_thick_first_new(&thick);
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

void thick_judge_decide(struct thick_play *play)
{
    static const uint32_t counts[4] = {0, THICK_VERTICES, THICK_EDGES, THICK_TRIANGLES};
    static const uint32_t sides[2][2] = {{1, 3}, {2, 2}};
    thick_judge_forget(play);
    for (uint32_t kind = 0; kind < 2; kind++) {
        const uint32_t *points = sides[kind];
        for (uint32_t i = 0; i < THICK_OBJECTS * counts[points[0]]; i++) {
            struct feature a =
                feature_of(play, points[0], i / counts[points[0]], i % counts[points[0]]);
            uint32_t first = kind == PCCD_EE ? i + 1 : 0;
            for (uint32_t j = first; j < THICK_OBJECTS * counts[points[1]]; j++) {
                struct feature b = feature_of(play, points[1], j / counts[points[1]],
                                              j % counts[points[1]]);
                if (!have_common(&a, &b)) {
                    decide(play, kind, &a, &b);
                }
            }
        }
    }
}

bool thick_judge_is_near(const struct thick_play *play, const struct thick_truth *truth,
                         double distance, uint32_t end)
{
    static const uint32_t sides[2][2] = {{1, 3}, {2, 2}};
    const uint32_t *points = sides[truth->name.kind];
    struct feature a =
        feature_of(play, points[0], truth->name.object_a - 1, truth->name.feature_a);
    struct feature b =
        feature_of(play, points[1], truth->name.object_b - 1, truth->name.feature_b);
    double p[8][3];
    for (uint32_t i = 0; i < 8; i++) {
        const struct feature *of = i % 4 < a.count ? &a : &b;
        uint32_t v = of->v[i % 4 < a.count ? i % 4 : i % 4 - a.count];
        memcpy(p[i], play->bodies[of->object].x[end][v], sizeof p[i]);
    }
    struct oracle_thick thick = {
        .points_a = (int)a.count,
        .points_b = (int)b.count,
        .p = (const double(*)[3])p,
        .radius = {radius_of(play, &a), radius_of(play, &b), distance}};
    return !rests(play, &a, &b) && oracle_thick_is_inside(&thick);
}
