/* test_eng_part.c - a part of a step is the step between where its ends are.
 *
 * Threads: one; the engine's steps by one to four, by every method and instruction set.
 */
#include "cases.h"
#include "judge.h"

#define SPANS_MAX 8

static struct judge_sums sums;
static uint64_t contacts; /* of parts */
static uint64_t thick_contacts;

/* A motion, and the parts of it that are asked about, one behind the other. */
struct motion {
    enum scenes_kind kind;
    struct scenes_mesh mesh;
    double times[SPANS_MAX + 1];
    uint32_t span_count;
    double tolerance;
    double thickness;
    uint64_t seed;
};

static void draw_times(struct motion *motion, struct prng *prng)
{
    static const double some[][4] = {{0, 0.25, 0.5, 1},
                                     {0, 1.0 / 3, 2.0 / 3, 1},
                                     {0, 0x1p-30, 0.5, 1},
                                     {0, 0.7, 0.7 + 0x1p-12, 1}};
    motion->span_count = 3;
    memcpy(motion->times, some[prng_below(prng, 4)], sizeof some[0]);
    if (prng_below(prng, 3) == 0) {
        motion->times[1] = prng_between(prng, 0.01, 0.5);
        motion->times[2] = prng_between(prng, 0.51, 0.99);
    }
}

static double between(double x0, double x1, double t)
{
    double x = t == 1 ? x1 : x0 + t * (x1 - x0);
    double low = x0 < x1 ? x0 : x1;
    double high = x0 < x1 ? x1 : x0;
    return x < low ? low : x > high ? high : x;
}

/* Objects 1 .. of the pieces of a mesh: of the whole motion, or of a part. */
static void add(struct judge *judge, const struct motion *motion, const double span[2])
{
    struct scenes_mesh pieces[4];
    uint32_t count = scenes_split(&motion->mesh, 4, pieces);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t v = 0; v < 3 * pieces[i].vertex_count; v++) {
            double *x0 = &pieces[i].x0[v / 3][v % 3];
            double *x1 = &pieces[i].x1[v / 3][v % 3];
            double begin = between(*x0, *x1, span[0]);
            *x1 = between(*x0, *x1, span[1]);
            *x0 = begin;
        }
        pieces[i].is_f32 = false;
        judge_add(judge, &pieces[i], 1 + i);
        scenes_deinit(&pieces[i]);
    }
}

static void begin(struct judge *judge, const struct motion *motion, const double span[2],
                  double tolerance)
{
    judge_init(judge, &sums, tolerance);
    snprintf(judge->context, sizeof judge->context, "%s, seed %llu, %g to %g",
             scenes_name(motion->kind), (unsigned long long)motion->seed, span[0],
             span[1]);
    add(judge, motion, span);
    judge_stage_whole(judge);
}

/* Distance at which features meet, and how much nearer they may come. */
struct thickness {
    double distance;
    double approach;
};

static const struct thickness thin = {0, 0};

/* Ask about a part. */
static void ask(struct judge *whole, const double span[2], enum pccd_mode mode,
                struct thickness thickness, struct eng_step_result *result)
{
    struct eng_question question = ENG_QUESTION_DEFAULT;
    way_draw(&whole->ways, 4, &question);
    question.mode = mode;
    question.distance = thickness.distance;
    question.approach = thickness.approach;
    question.tolerance = whole->tolerance;
    memcpy(question.span, span, sizeof question.span);
    assert_ok(eng_step(whole->scene, &question, result));
    assert_int_equal(result->incomplete, PCCD_COMPLETE);
    assert_int_equal(result->mode, mode);
}

/* A contact of the part, and the same of the step between its ends. */
static bool is_of(const struct pccd_contact *part, const struct pccd_contact *step,
                  const double span[2], double tolerance)
{
    struct pccd_contact same = *part;
    long double length = (long double)span[1] - span[0];
    same.toi = step->toi;
    same.toi_hi = step->toi_hi;
    return memcmp(&same, step, sizeof same) == 0 && span[0] <= part->toi &&
           part->toi <= part->toi_hi && part->toi_hi <= span[1] &&
           part->toi_hi - part->toi <= tolerance &&
           part->toi <= span[0] + step->toi * length &&
           part->toi_hi >= span[0] + step->toi_hi * length &&
           (step->toi_hi > 0 || part->toi_hi == span[0]);
}

static void check_all(const struct judge *whole, const double span[2],
                      const struct eng_step_result *part,
                      const struct eng_step_result *step)
{
    const struct pccd_contact *left = part->records;
    const struct pccd_contact *right = step->records;
    assert_int_equal(part->count, step->count);
    for (uint64_t i = 0; i < part->count; i++) {
        if (!is_of(&left[i], &right[i], span, whole->tolerance)) {
            judge_fail(whole, "not the contact of the step between the ends", &left[i]);
        }
    }
    assert_int_equal(part->initial, step->initial);
    assert_int_equal(part->possible, step->possible);
    assert_true(part->count > 0
                    ? part->safe_step < part->toi_first || part->toi_first == span[0]
                    : part->safe_step == span[1]);
    assert_true(part->safe_step >= span[0]);
}

/* The same of what meets at a distance. */
static void check_thick(struct judge *whole, struct judge *judge, const double span[2],
                        struct thickness thickness)
{
    static const double all_of_it[2] = {0, 1};
    struct eng_step_result part;
    struct eng_step_result step;
    judge_stage_whole(judge);
    ask(judge, all_of_it, PCCD_MODE_ALL, thickness, &step);
    ask(whole, span, PCCD_MODE_ALL, thickness, &part);
    check_all(whole, span, &part, &step);
    assert_int_equal(part.inside, step.inside);
    thick_contacts += part.count;
    judge_stage_whole(judge);
    ask(judge, all_of_it, PCCD_MODE_PAIRS, thickness, &step);
    ask(whole, span, PCCD_MODE_PAIRS, thickness, &part);
    assert_memory_equal(part.hash, step.hash, sizeof part.hash);
}

/* The oracle judges the step between the ends; that has the answer of the part. */
static void check_part(struct judge *whole, const struct motion *motion,
                       const double span[2], struct judge_records *all)
{
    struct eng_question question = ENG_QUESTION_DEFAULT;
    struct eng_step_result part;
    struct eng_step_result step;
    struct judge judge;
    question.tolerance = motion->tolerance;
    memcpy(question.span, span, sizeof question.span);
    begin(&judge, motion, span, eng_part_tolerance(&question));
    judge_everything(&judge);
    judge_stage_whole(&judge);
    judge_step(&judge, PCCD_MODE_ALL, &step);
    ask(whole, span, PCCD_MODE_ALL, thin, &part);
    check_all(whole, span, &part, &step);
    *all = judge_copy(&part);
    contacts += part.count;
    ask(whole, span, PCCD_MODE_FIRST, thin, &part);
    judge_check_first(whole, &part, all);
    ask(whole, span, PCCD_MODE_ANY, thin, &part);
    judge_check_any(whole, &part, all);
    judge_stage_whole(&judge);
    judge_step(&judge, PCCD_MODE_PAIRS, &step);
    ask(whole, span, PCCD_MODE_PAIRS, thin, &part);
    assert_int_equal(part.count, step.count);
    assert_memory_equal(part.hash, step.hash, sizeof part.hash);
    check_thick(whole, &judge, span, (struct thickness){motion->thickness, 0});
    check_thick(whole, &judge, span, (struct thickness){motion->thickness, 0.5});
    judge_deinit(&judge);
}

static const struct pccd_contact *find(const struct judge_records *records,
                                       const struct pccd_contact *name)
{
    for (uint64_t i = 0; i < records->count; i++) {
        const struct pccd_contact *one = &records->items[i];
        if (one->kind == name->kind && one->object_a == name->object_a &&
            one->feature_a == name->feature_a && one->object_b == name->object_b &&
            one->feature_b == name->feature_b) {
            return one;
        }
    }
    return NULL;
}

/* Where no position of the parts was rounded: what meets in the step meets first in the
 * first part that has it, and nothing else meets in any. */
static void check_sum(const struct judge *whole, const struct judge_records *all,
                      const struct judge_records *parts, uint32_t count)
{
    for (uint64_t i = 0; i < all->count; i++) {
        const struct pccd_contact *first = NULL;
        for (uint32_t k = 0; k < count && !first; k++) {
            first = find(&parts[k], &all->items[i]);
        }
        if (!first || first->toi > all->items[i].toi_hi ||
            first->toi_hi < all->items[i].toi) {
            judge_fail(whole, "the parts do not meet when the whole does",
                       &all->items[i]);
        }
    }
    for (uint32_t k = 0; k < count; k++) {
        for (uint64_t i = 0; i < parts[k].count; i++) {
            if (!find(all, &parts[k].items[i])) {
                judge_fail(whole, "a part meets where the whole does not",
                           &parts[k].items[i]);
            }
        }
    }
}

/* Its coordinates have few bits, and so have those of its quarters. */
static void make_coarse(struct scenes_mesh *mesh)
{
    for (uint32_t v = 0; v < 3 * mesh->vertex_count; v++) {
        double *x0 = &mesh->x0[v / 3][v % 3];
        double *x1 = &mesh->x1[v / 3][v % 3];
        *x0 = rint(*x0 * 0x1p20) * 0x1p-20;
        *x1 = rint(*x1 * 0x1p20) * 0x1p-20;
    }
}

static void begin_motion(struct motion *motion, enum scenes_kind kind, struct prng *prng)
{
    bool is_dense = kind == SCENES_SNAPPED || kind == SCENES_STILL ||
                    kind == SCENES_FAST || kind == SCENES_SLIDING;
    motion->kind = kind;
    motion->seed = prng_next(prng);
    motion->tolerance = prng_below(prng, 3) ? 1e-6 : 1e-3;
    scenes_make(&motion->mesh, kind, is_dense ? 12 : 40, false, motion->seed);
    motion->thickness = 0.01 * fabs(motion->mesh.x0[0][0] - motion->mesh.x0[1][0]);
    draw_times(motion, prng);
}

/* All parts of a motion; then the next motion, so that nothing is left of them. */
static void check_motion(struct motion *motion, bool is_exact, struct prng *prng)
{
    static const double all_of_it[2] = {0, 1};
    struct eng_step_result result;
    struct judge whole;
    struct judge_records parts[SPANS_MAX];
    begin(&whole, motion, all_of_it, motion->tolerance);
    if (prng_below(prng, 2)) { /* else the first part moves the scene on */
        judge_step(&whole, PCCD_MODE_ALL, &result);
    }
    for (uint32_t i = 0; i < motion->span_count; i++) {
        check_part(&whole, motion, &motion->times[i], &parts[i]);
    }
    judge_stage_whole(&whole);
    judge_step(&whole, PCCD_MODE_ALL, &result);
    struct judge_records all = judge_copy(&result);
    if (is_exact) {
        check_sum(&whole, &all, parts, motion->span_count);
    }
    for (uint32_t i = 0; i < whole.object_count; i++) {
        scenes_move_on(&whole.objects[i].mesh, motion->kind, prng);
    }
    judge_stage_whole(&whole);
    judge_everything(&whole);
    for (uint32_t i = 0; i < motion->span_count; i++) {
        free(parts[i].items);
    }
    free(all.items);
    judge_deinit(&whole);
}

/* If this failed, a part of a motion would have other contacts than the motion has there,
 * or at other times; or a step would go by boxes of a part of another. */
CASE(part__is_the_step_between_its_ends)
{
    struct prng prng = {prng_seed()};
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)prng.state);
    for (uint32_t i = 0; i < 2 * SCENES_KINDS; i++) {
        struct motion motion;
        begin_motion(&motion, (enum scenes_kind)(i % SCENES_KINDS), &prng);
        check_motion(&motion, false, &prng);
        scenes_deinit(&motion.mesh);
    }
    assert_true(contacts > 300 && thick_contacts > 300);
}

/* If this failed, something could slip through between two parts of one motion. */
CASE(part__of_all_parts_together_meets_what_meets)
{
    static const enum scenes_kind kinds[] = {SCENES_SOUP,        SCENES_CLOTH,
                                             SCENES_TWO_SPHERES, SCENES_SNAPPED,
                                             SCENES_FAST,        SCENES_STILL};
    static const double quarters[] = {0, 0.25, 0.5, 0.75, 1};
    struct prng prng = {prng_seed() + 1};
    for (uint32_t i = 0; i < 12; i++) {
        struct motion motion;
        begin_motion(&motion, kinds[i % 6], &prng);
        make_coarse(&motion.mesh);
        motion.span_count = 4;
        memcpy(motion.times, quarters, sizeof quarters);
        check_motion(&motion, true, &prng);
        scenes_deinit(&motion.mesh);
    }
}

/* If this failed, what is near would be that of a part of the last step. */
CASE(part__leaves_where_the_scene_is)
{
    static const double span[2] = {0.25, 0.5};
    struct prng prng = {prng_seed() + 2};
    for (uint32_t i = 0; i < 12; i++) {
        struct eng_question near = ENG_QUESTION_DEFAULT;
        struct eng_step_result results[2];
        struct eng_step_result part;
        struct motion motion;
        struct judge whole;
        begin_motion(&motion, i % 2 ? SCENES_CLOTH : SCENES_TWO_SPHERES, &prng);
        begin(&whole, &motion, (const double[2]){0, 1}, 1e-6);
        near.verb = PCCD_NEAR_PAIRS;
        near.distance = 0.1;
        near.end = i / 2 % 2;
        near.method = i % 3 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER;
        results[0] = kit_near(whole.scene, &near);
        ask(&whole, span, PCCD_MODE_ALL, thin, &part);
        results[1] = kit_near(whole.scene, &near);
        assert_memory_equal(results[0].hash, results[1].hash, sizeof results[0].hash);
        judge_deinit(&whole);
        scenes_deinit(&motion.mesh);
    }
}

/* If this failed, a question that nobody can answer would be answered by another. */
CASE(part__is_refused_where_it_is_none)
{
    static const double spans[][2] = {{0.5, 0.5},  {0.5, 0.25}, {-0.25, 0.5},
                                      {0.5, 1.25}, {NAN, 0.5},  {0.5, NAN}};
    struct prng prng = {7};
    struct motion motion;
    struct judge whole;
    struct eng_step_result result;
    begin_motion(&motion, SCENES_SOUP, &prng);
    begin(&whole, &motion, (const double[2]){0, 1}, 1e-6);
    judge_step(&whole, PCCD_MODE_ALL, &result);
    for (size_t i = 0; i < sizeof spans / sizeof *spans + 2; i++) {
        struct eng_question question = ENG_QUESTION_DEFAULT;
        memcpy(question.span, spans[i % 6], sizeof question.span);
        if (i >= 6) {
            question.span[0] = 0.25;
            question.span[1] = 0.5;
            question.brief = i == 6;
            question.tells_start = i == 7;
        }
        assert_int_equal(eng_step(whole.scene, &question, &result), PCCD_E_INVAL);
    }
    judge_deinit(&whole);
    scenes_deinit(&motion.mesh);
}

static int tell(void **state)
{
    (void)state;
    print_message("# %llu contacts of parts, %llu at a distance, %llu of the oracle's\n",
                  (unsigned long long)contacts, (unsigned long long)thick_contacts,
                  (unsigned long long)sums.queries);
    return 0;
}

CASES_WITH(NULL, tell);
