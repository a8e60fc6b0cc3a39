/* test_eng_recorded.c - recorded scenes have the same bytes whoever computes them. */
#include "cases.h"
#include "data.h"
#include "eng_kit.h"
#include "kernel.h"
#include "ply.h"
#include "record_hash.h"
#include "step.h"

struct row {
    uint32_t threads;
    enum eng_scheduler scheduler;
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
    double ratio;
    uint32_t region;
    uint32_t detours; /* steps back and forth before */
    enum pccd_method method;
    enum eng_isa isa; /* or the best, where this processor does not have it */
};

static const struct row rows[] = {
    {1, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN, 0, 1024, 0,
     PCCD_METHOD_PAPER, ENG_ISA_AVX512},
    {3, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_PAPER, 1, 64, 1,
     PCCD_METHOD_PAPER, ENG_ISA_AVX2},
    {4, ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_DISJOINT, ENG_REFIT_EVEN, 0.9, 8, 1,
     PCCD_METHOD_PAPER, ENG_ISA_SCALAR},
    {1, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN, 0.9, 1024, 1,
     PCCD_METHOD_WIDE, ENG_ISA_SSE4},
    {2, ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_PAPER, 0.9, 1024, 1,
     PCCD_METHOD_PAPER, ENG_ISA_SCALAR},
    {8, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN, 1, 1024, 0,
     PCCD_METHOD_WIDE, ENG_ISA_SSE2},
    {16, ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_DISJOINT, ENG_REFIT_EVEN, 0.9, 64, 0,
     PCCD_METHOD_PAPER, ENG_ISA_AVX2},
    {2, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN, 0.9, 1024, 1,
     PCCD_METHOD_WIDE, ENG_ISA_AVX512},
    {4, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN, 0.9, 1024, 0,
     PCCD_METHOD_WIDE, ENG_ISA_AVX2},
    {16, ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN, 0.9, 1024, 0,
     PCCD_METHOD_WIDE, ENG_ISA_SCALAR},
};
#define ROWS (sizeof rows / sizeof *rows)

/* Known answers of a scene: its contacts, and the hash of their records, version 1. */
struct known {
    enum data_scene_name scene;
    size_t first_row; /* of those that it is run under */
    uint64_t truths;
    uint64_t hash[2];
};

static void step(struct eng_scene *scene, uint32_t object_idx, const struct ply *from,
                 const struct ply *to, const struct row *row,
                 struct eng_step_result *result)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.threads = row->threads;
    settings.team_always = true;
    settings.tuning.scheduler = row->scheduler;
    settings.tuning.high_level = row->high_level;
    settings.tuning.refit = row->refit;
    settings.method = row->method;
    settings.kernels = eng_kernels_of(row->isa);
    eng_stage_begin(scene);
    assert_ok(eng_stage_x0x1(scene, object_idx, PCCD_FORMAT_F64, 0, from->vertex_count,
                             from->x, to->x));
    assert_ok(eng_step(scene, &settings, result));
    assert_int_equal(result->threads, row->threads);
    assert_int_equal(result->incomplete, PCCD_COMPLETE);
}

static void check_row(const struct known *known, const struct ply frames[2],
                      struct eng_mesh *mesh, const struct row *row)
{
    struct eng_scene_settings made = {row->ratio, row->region, 1};
    struct eng_scene *scene = NULL;
    struct eng_step_result result;
    uint32_t object_idx;
    assert_ok(eng_scene_new(&made, &scene));
    assert_ok(eng_scene_add(scene, mesh, 0, &object_idx));
    for (uint32_t i = 0; i < row->detours; i++) {
        step(scene, object_idx, &frames[0], &frames[1], row, &result);
        step(scene, object_idx, &frames[1], &frames[0], row, &result);
    }
    step(scene, object_idx, &frames[0], &frames[1], row, &result);
    uint64_t one[2];
    uint64_t two[2];
    record_hash_1(result.records, result.count, result.record_bytes, one);
    record_hash_2(result.records, result.count, result.record_bytes, two);
    if (one[0] != known->hash[0] || one[1] != known->hash[1]) {
        fail_msg("method %d, %u threads: %llu records, {0x%016llx, 0x%016llx}",
                 (int)row->method, row->threads, (unsigned long long)result.count,
                 (unsigned long long)one[0], (unsigned long long)one[1]);
    }
    assert_int_equal(result.hash[0], two[0]);
    assert_int_equal(result.hash[1], two[1]);
    assert_int_equal(result.count, known->truths);
    eng_scene_free(scene);
}

static void check(const struct known *known)
{
    char paths[2][DATA_PATH_MAX];
    struct ply frames[2];
    for (int i = 0; i < 2; i++) {
        if (!data_find(data_scenes[known->scene].frames[i], paths[i])) {
            test_skip("no such frames in $PCCD_DATA");
        }
    }
    for (int i = 0; i < 2; i++) {
        assert_true(ply_read(paths[i], &frames[i]));
    }
    struct eng_mesh *mesh = kit_mesh(frames[0].x, frames[0].vertex_count,
                                     frames[0].triangles, frames[0].triangle_count);
    for (size_t i = known->first_row; i < ROWS; i++) {
        check_row(known, frames, mesh, &rows[i]);
    }
    eng_mesh_release(mesh);
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
}

/* If this failed, nearly degenerate cloth would be answered by luck. */
CASE(recorded__cloth_funnel_has_the_same_bytes)
{
    check(&(struct known){
        DATA_CLOTH_FUNNEL, 0, 134, {0x96934191120c231b, 0x21e66ae8977a4142}});
}

/* If this failed, a scene of ninety thousand triangles would be answered by luck. */
CASE(recorded__cloth_ball_has_the_same_bytes)
{
    check(&(struct known){
        DATA_CLOTH_BALL, 4, 113854, {0xb20724bc3459bd24, 0x93a2fbc57574998e}});
}
