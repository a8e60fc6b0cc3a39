/* thick_judge.c - all pairs of a small scene. */
#include "thick_judge.h"

#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_thick.h"

/* ---- pairs ------------------------------------------------------------------------- */

/* Vertex i, 0 .. 3, of a pair; the last one stands for all behind it. */
static uint32_t vertex_of(const struct oracle_feature *a, const struct oracle_feature *b,
                          uint32_t i)
{
    uint32_t last = b->points - 1;
    return i < a->points ? a->v[i] : b->v[i - a->points < last ? i - a->points : last];
}

/* Its points at both ends. */
static void load(const struct thick_step *step, const struct thick_truth *truth,
                 double p[8][3])
{
    for (uint32_t i = 0; i < 8; i++) {
        uint32_t of = i % 4 < truth->a.points ? truth->a.object : truth->b.object;
        const double(*x)[3] = i < 4 ? step->objects[of].x0 : step->objects[of].x1;
        memcpy(p[i], x[vertex_of(&truth->a, &truth->b, i % 4)], sizeof p[i]);
    }
}

/* Return whether the pair is left thin. */
static bool rests(const struct thick_step *step, const struct oracle_feature *a,
                  const struct oracle_feature *b)
{
    const struct oracle_object *object = &step->objects[a->object];
    uint32_t edge_count;
    double x[4][3];
    if (a->object != b->object ||
        (object->rest_rings == 0 && object->rest_distance == 0)) {
        return false;
    }
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(x[i], object->registered[vertex_of(a, b, i)], sizeof x[i]);
    }
    uint32_t(*edges)[2] = oracle_edges(object, &edge_count);
    bool are_joined =
        oracle_are_joined((const uint32_t(*)[2])edges, edge_count, object->vertex_count,
                          (const uint32_t *const[2]){a->v, b->v},
                          (const uint32_t[2]){a->points, b->points}, object->rest_rings);
    free(edges);
    return are_joined ||
           oracle_is_nearer(a->points, (const double(*)[3])x, object->rest_distance);
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
            for (uint32_t i = 0; apart && i < points_a; i++) {
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

/* Return whether the boxes of their motions keep the two apart by more than `reach`,
 * whatever rounding hides. */
static bool are_far(const struct oracle_feature *a, const struct oracle_feature *b,
                    double reach)
{
    for (int k = 0; k < 3; k++) {
        double gap = fmax(a->lo[k] - b->hi[k], b->lo[k] - a->hi[k]);
        if (gap > reach * (1 + 0x1p-40)) {
            return true;
        }
    }
    return false;
}

static double radius_of(const struct thick_step *step,
                        const struct oracle_feature *feature)
{
    return oracle_radius(&step->objects[feature->object], feature->v, feature->points);
}

static void decide(const struct thick_step *step, struct thick_truth *truth)
{
    double p[8][3];
    load(step, truth, p);
    struct oracle_thick thick = {.points_a = (int)truth->a.points,
                                 .points_b = (int)truth->b.points,
                                 .p = (const double(*)[3])p,
                                 .radius = {radius_of(step, &truth->a),
                                            radius_of(step, &truth->b), step->separation},
                                 .approach = step->approach};
    if (rests(step, &truth->a, &truth->b)) {
        memset(thick.radius, 0, sizeof thick.radius);
    }
    truth->is_thick = thick.radius[0] + thick.radius[1] + thick.radius[2] > 0;
    bool is_tested =
        truth->is_thick || truth->name.kind == PCCD_VF || truth->name.kind == PCCD_EE;
    truth->is_candidate =
        is_tested && is_candidate((const double(*)[3])p, truth->a.points, thick.radius);
    if (truth->is_candidate) {
        truth->is_inside = oracle_thick_is_inside(&thick);
        truth->first = oracle_thick_first_new(&thick);
    }
}

void thick_judge_forget(struct thick_truths *truths)
{
    for (size_t i = 0; i < truths->count; i++) {
        oracle_first_free(truths->items[i].first);
    }
    free(truths->items);
    memset(truths, 0, sizeof *truths);
}

/* Note the pair unless it is far. */
static void look(const struct thick_step *step, uint32_t kind,
                 const struct oracle_feature *a, const struct oracle_feature *b,
                 double reach, struct thick_truths *truths)
{
    const struct oracle_object *of_a = &step->objects[a->object];
    const struct oracle_object *of_b = &step->objects[b->object];
    double keeps =
        radius_of(step, a) + radius_of(step, b) + fmax(step->separation, reach);
    if (oracle_features_share_vertex(a, b) || are_far(a, b, keeps) ||
        (step->may_meet &&
         !step->may_meet(step->context, of_a->object_id, of_b->object_id))) {
        return;
    }
    if (truths->count == truths->capacity) {
        truths->capacity = 2 * truths->capacity + 64;
        truths->items =
            oracle_grow(truths->items, truths->capacity * sizeof *truths->items);
    }
    truths->items[truths->count++] =
        (struct thick_truth){.name = {(enum pccd_kind)kind, of_a->object_id, a->index,
                                      of_b->object_id, b->index},
                             .a = *a,
                             .b = *b};
}

bool thick_judge_decide(const struct thick_step *step, double reach, size_t pairs_max,
                        struct thick_truths *truths)
{
    static const uint32_t sides[PCCD_KIND_COUNT][2] = {/* of the lists below */
                                                       [PCCD_VF] = {0, 2},
                                                       [PCCD_EE] = {1, 1},
                                                       [PCCD_VE] = {3, 4},
                                                       [PCCD_VV] = {3, 3}};
    struct oracle_features lists[5]; /* vertices, edges, faces; free vertices, edges */
    memset(truths, 0, sizeof *truths);
    for (uint32_t i = 0; i < 5; i++) {
        oracle_features_list(step->objects, step->object_count, i % 3 + 1, &lists[i]);
    }
    oracle_features_keep_free(&lists[3]);
    oracle_features_keep_free(&lists[4]);
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        const struct oracle_features *a = &lists[sides[kind][0]];
        const struct oracle_features *b = &lists[sides[kind][1]];
        for (size_t i = 0; i < a->count; i++) {
            for (size_t j = a == b ? i + 1 : 0; j < b->count; j++) {
                look(step, kind, &a->items[i], &b->items[j], reach, truths);
            }
        }
    }
    for (uint32_t i = 0; i < 5; i++) {
        oracle_features_deinit(&lists[i]);
    }
    if (truths->count > pairs_max) {
        thick_judge_forget(truths);
        return false;
    }
    for (size_t i = 0; i < truths->count; i++) {
        decide(step, &truths->items[i]);
    }
    return true;
}

bool thick_judge_is_near(const struct thick_step *step, const struct thick_truth *truth,
                         double distance, uint32_t end)
{
    double p[8][3];
    load(step, truth, p);
    memcpy(p[4 * (1 - end)], p[4 * end], 4 * sizeof p[0]);
    struct oracle_thick thick = {
        .points_a = (int)truth->a.points,
        .points_b = (int)truth->b.points,
        .p = (const double(*)[3])p,
        .radius = {radius_of(step, &truth->a), radius_of(step, &truth->b), distance}};
    return !rests(step, &truth->a, &truth->b) && oracle_thick_is_inside(&thick);
}

/* ---- answers ----------------------------------------------------------------------- */

static const char *check_pairs(const struct thick_truths *truths,
                               const struct eng_step_result *result)
{
    const struct pccd_pair *pairs = result->records;
    uint64_t seen = 0;
    for (size_t i = 0; i < truths->count; i++) {
        const struct thick_truth *truth = &truths->items[i];
        if (truth->is_candidate) {
            if (seen == result->count ||
                memcmp(&truth->name, &pairs[seen], sizeof truth->name) != 0) {
                return "a pair that no axis separates";
            }
            seen++;
        }
    }
    if (seen != result->count) {
        return "a pair that an axis separates";
    }
    return result->safe_step != (seen > 0 ? 0 : 1) ? "how far it is safe" : NULL;
}

/* The name of a contact has its flags in between. */
static bool names_contact(const struct pccd_pair *a, const struct pccd_contact *contact)
{
    return a->kind == contact->kind && a->object_a == contact->object_a &&
           a->feature_a == contact->feature_a && a->object_b == contact->object_b &&
           a->feature_b == contact->feature_b;
}

/* Check the contact of a pair that has one; one of thin features need not be proved. */
static const char *check_contact(const struct thick_step *step,
                                 const struct thick_truth *truth,
                                 const struct pccd_contact *contact)
{
    bool is_initial = oracle_first_compare(truth->first, 0) == 0;
    bool is_inside = truth->is_inside && truth->is_thick && step->approach > 0;
    bool is_proved = truth->is_thick || (contact->flags & PCCD_PROVED) != 0;
    uint32_t flags = (is_proved ? PCCD_PROVED : 0u) | (is_initial ? PCCD_INITIAL : 0u) |
                     (is_inside ? PCCD_INSIDE : 0u);
    if (contact->flags != flags) {
        return "the flags of a contact";
    }
    if (oracle_first_compare(truth->first, contact->toi) < 0) {
        return "a contact is told too late";
    }
    return is_proved && (oracle_first_compare(truth->first, contact->toi_hi) > 0 ||
                         contact->toi_hi - contact->toi > step->tolerance)
               ? "a contact is not as late as told"
               : NULL;
}

/* Check what is summed up of the records. */
static const char *check_sums(const struct eng_step_result *result)
{
    const struct pccd_contact *contacts = result->records;
    uint64_t initial = 0;
    uint64_t inside = 0;
    uint64_t possible = 0;
    double toi = 2;
    for (uint64_t i = 0; i < result->count; i++) {
        uint32_t flags = contacts[i].flags;
        possible += (flags & PCCD_PROVED) == 0;
        initial += (flags & PCCD_INITIAL) != 0;
        inside += (flags & (PCCD_INITIAL | PCCD_INSIDE)) == PCCD_INSIDE;
        toi = fmin(toi, contacts[i].toi);
    }
    if (result->toi_first != toi || result->initial != initial ||
        result->possible != possible || result->inside != inside) {
        return "what is counted of the records";
    }
    double safe = result->count == 0 ? 1 : toi == 0 ? 0 : nextafter(toi, 0);
    return result->safe_step != safe ? "how far it is safe" : NULL;
}

/* Return the contact of the same two objects, behind `from`, or NULL. */
static const struct pccd_contact *find_of_two(const struct eng_step_result *result,
                                              uint64_t from, uint32_t a, uint32_t b)
{
    const struct pccd_contact *contacts = result->records;
    for (uint64_t i = from; i < result->count; i++) {
        if ((contacts[i].object_a == a && contacts[i].object_b == b) ||
            (contacts[i].object_a == b && contacts[i].object_b == a)) {
            return &contacts[i];
        }
    }
    return NULL;
}

/* Return whether the mode leaves a contact out that the answer has not. */
static bool is_left_out(const struct thick_truth *truth,
                        const struct eng_step_result *result)
{
    const struct pccd_contact *told =
        find_of_two(result, 0, truth->name.object_a, truth->name.object_b);
    switch (result->mode) {
    case PCCD_MODE_FIRST:
        return oracle_first_compare(truth->first, result->toi_first) > 0;
    case PCCD_MODE_FIRST_PER_PAIR:
        return told && oracle_first_compare(truth->first, told->toi) >= 0;
    default:
        return false;
    }
}

static const char *check_contacts(const struct thick_step *step,
                                  const struct thick_truths *truths,
                                  const struct eng_step_result *result,
                                  uint64_t counts[PCCD_KIND_COUNT])
{
    const struct pccd_contact *contacts = result->records;
    for (uint64_t i = 0;
         result->mode == PCCD_MODE_FIRST_PER_PAIR && i < result->count; i++) {
        if (find_of_two(result, i + 1, contacts[i].object_a, contacts[i].object_b)) {
            return "two contacts of two objects";
        }
    }
    uint64_t at = 0;
    for (size_t i = 0; i < truths->count; i++) {
        const struct thick_truth *truth = &truths->items[i];
        bool is_there = at < result->count && names_contact(&truth->name, &contacts[at]);
        const char *wrong = NULL;
        if (truth->first && is_there) {
            wrong = check_contact(step, truth, &contacts[at]);
            counts[truth->name.kind]++;
        } else if (truth->first) {
            wrong = is_left_out(truth, result) ? NULL : "a contact is missing";
        } else if (is_there) {
            wrong =
                truth->is_thick || contacts[at].flags != 0 ? "an invented contact" : NULL;
        }
        if (!wrong && truth->first && result->safe_step > 0 &&
            oracle_first_compare(truth->first, result->safe_step) <= 0) {
            wrong = "it is not safe so far";
        }
        if (wrong) {
            return wrong;
        }
        at += is_there;
    }
    return at != result->count ? "a contact too many, or in no order"
                               : check_sums(result);
}

static const char *check_verdict(const struct thick_truths *truths,
                                 const struct eng_step_result *result)
{
    bool any = false;
    for (size_t i = 0; i < truths->count; i++) {
        any |= truths->items[i].first != NULL;
    }
    if (result->verdict != (any ? PCCD_VERDICT_YES : PCCD_VERDICT_NO)) {
        return "the verdict";
    }
    return result->safe_step != (any ? 0 : 1) ? "how far it is safe" : NULL;
}

const char *thick_judge(const struct thick_step *step, const struct thick_truths *truths,
                        const struct eng_step_result *result,
                        uint64_t contacts[PCCD_KIND_COUNT])
{
    if (result->incomplete != PCCD_COMPLETE) {
        return "it is not complete";
    }
    switch (result->mode) {
    case PCCD_MODE_PAIRS:
        return check_pairs(truths, result);
    case PCCD_MODE_ANY:
        return check_verdict(truths, result);
    default:
        return check_contacts(step, truths, result, contacts);
    }
}
