/* test_eng_plays.c - objects that move, break, come and go are answered exactly.
 *
 * The golden plays, and plays from random seeds under random settings of scene and step,
 * each step compared with brute force in exact arithmetic.
 *
 * Threads: teams of one to eight, where a play is large enough for a team.
 */
#include "cases.h"

#include <time.h>

#include "eng_way.h"
#include "golden.h"
#include "judge.h"
#include "record_hash.h"

#define ROUNDS          20
#define SMALL_TRIANGLES 60
#define TEAM_TRIANGLES  400 /* for all threads of a team something to do */

/* Sums of what was judged, for the report. */
static struct judge_sums sums[PLAY_KINDS];
static uint64_t team_steps[PLAY_KINDS];
static uint64_t rebuilds[PLAY_KINDS];

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Manner in which the steps of a play are taken. */
struct manner {
    struct prng prng;
    bool is_random;   /* settings of every step; else one thread and the defaults */
    bool is_filtered; /* who may meet changes with every third step or so */
    double tolerance;
};

static struct eng_question some_settings(struct manner *manner)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.tolerance = manner->tolerance;
    if (manner->is_random) {
        way_draw(&manner->prng, 8, &settings);
    }
    return settings;
}

static void take_step(struct player *player, enum play_kind kind, struct manner *manner,
                      enum pccd_mode mode, struct eng_step_result *result)
{
    struct eng_question settings = some_settings(manner);
    settings.mode = mode;
    assert_ok(player_step(player, &settings, result));
    assert_int_equal(result->incomplete, PCCD_COMPLETE);
    assert_true(way_tree_is_sound(player->scene, result));
    team_steps[kind] += result->threads > 1;
    rebuilds[kind] += result->counters.rebuilds + result->counters.swaps;
}

/* Judge what is staged, in every mode. Set `hash` to that of mode ALL, version 1, as in
 * golden.c. */
static void judge_step_of(struct judge *judge, struct player *player, enum play_kind kind,
                          struct manner *manner, uint64_t hash[2])
{
    struct eng_step_result result;
    struct oracle_contacts truth;
    take_step(player, kind, manner, PCCD_MODE_ALL, &result);
    record_hash_1(result.records, result.count, result.record_bytes, hash);
    judge_watch(judge, player);
    judge_find(judge, &truth);
    judge_check_all(judge, &result, &truth);
    struct judge_records all = judge_copy(&result);
    player_stage_copies(player);
    take_step(player, kind, manner, PCCD_MODE_FIRST, &result);
    judge_check_first(judge, &result, &all);
    player_stage_copies(player);
    take_step(player, kind, manner, PCCD_MODE_ANY, &result);
    judge_check_any(judge, &result, &all);
    player_stage_copies(player);
    take_step(player, kind, manner, PCCD_MODE_PAIRS, &result);
    judge_check_pairs(judge, &result, &truth, &all);
    free(all.items);
    oracle_contacts_deinit(&truth);
}

static void judge_play(const struct golden *golden, uint32_t triangle_count,
                       const struct eng_scene_settings *made, struct manner *manner)
{
    struct play play;
    struct player player;
    struct judge judge;
    uint64_t hash[GOLDEN_STEPS_MAX][2];
    uint32_t step = 0;
    play_make(&play, golden->kind, triangle_count, golden->seed);
    player_init(&player, made);
    judge_watch_init(&judge, &sums[golden->kind], manner->tolerance);
    snprintf(judge.context, sizeof judge.context,
             "%s, %u triangles, seed %llu, tolerance %g, ratio %g, region %u",
             play_name(golden->kind), triangle_count, (unsigned long long)golden->seed,
             manner->tolerance, made->rebuild_ratio, made->region_triangles);
    for (uint32_t i = 0; i < play.act_count; i++) {
        if (play.acts[i].what == PLAY_STEP) {
            if (manner->is_filtered && prng_below(&manner->prng, 3) == 0) {
                player_draw_filters(&player, &manner->prng);
            }
            judge_step_of(&judge, &player, golden->kind, manner, hash[step++]);
        } else {
            player_act(&player, &play.acts[i]);
        }
    }
    for (uint32_t i = 0; i < step && !manner->is_random; i++) {
        assert_true(hash[i][0] == golden->steps[i].hash[GOLDEN_ALL][0]);
        assert_true(hash[i][1] == golden->steps[i].hash[GOLDEN_ALL][1]);
    }
    judge_deinit(&judge);
    player_deinit(&player);
    play_deinit(&play);
}

/* If this failed, what is written down in golden.c would be wrong. */
CASE(plays__golden_answers_are_exact)
{
    const struct eng_scene_settings made = ENG_SCENE_SETTINGS_DEFAULT;
    for (uint32_t i = 0; i < GOLDEN_PLAYS; i++) {
        struct manner manner = {.tolerance = 1e-6};
        judge_play(&golden_plays[i], golden_plays[i].triangle_count, &made, &manner);
    }
}

static struct eng_scene_settings some_scene(struct prng *prng)
{
    static const double ratios[] = {0, 0.9, 0.9, 1};
    static const uint32_t regions[] = {1, 8, 16, 40, 1024};
    struct eng_scene_settings made = ENG_SCENE_SETTINGS_DEFAULT;
    made.rebuild_ratio = ratios[prng_below(prng, 4)];
    made.region_triangles = regions[prng_below(prng, 5)];
    return made;
}

/* If this failed, a contact would be missed or invented by some way to build, rebuild or
 * share the work, or because of what an object was before. */
CASE(plays__are_exact_under_random_settings)
{
    static const double tolerances[] = {1e-6, 1e-3, 1e-12};
    const char *seconds = getenv("PCCD_PROPERTY_SECONDS");
    struct prng prng = {prng_seed()};
    double end_s = seconds ? now_s() + strtod(seconds, NULL) : 0;
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)prng.state);
    for (uint32_t i = 0; seconds ? now_s() < end_s : i < ROUNDS; i++) {
        struct golden golden = {.kind = i % PLAY_KINDS, .seed = prng_next(&prng)};
        struct manner manner = {.prng = {prng_next(&prng)},
                                .is_random = true,
                                .is_filtered = prng_below(&prng, 2) == 0,
                                .tolerance = tolerances[prng_below(&prng, 3)]};
        struct eng_scene_settings made = some_scene(&prng);
        uint32_t size = i / PLAY_KINDS % 4 == 3 ? TEAM_TRIANGLES : SMALL_TRIANGLES;
        judge_play(&golden, size + prng_u32(&prng, 100), &made, &manner);
    }
    for (uint32_t i = 0; i < PLAY_KINDS; i++) {
        assert_true(team_steps[i] > 0);
    }
}

static int report(void **state)
{
    (void)state;
    print_message("# %-12s %8s %8s %9s %9s %9s %9s %9s\n", "kind", "steps", "by team",
                  "true", "proved", "initial", "rebuilt", "queries");
    for (unsigned i = 0; i < PLAY_KINDS; i++) {
        const struct judge_sums *s = &sums[i];
        print_message("# %-12s %8llu %8llu %9llu %9llu %9llu %9llu %9llu\n", play_name(i),
                      (unsigned long long)s->steps, (unsigned long long)team_steps[i],
                      (unsigned long long)s->truths,
                      (unsigned long long)(s->records - s->possible),
                      (unsigned long long)s->initial, (unsigned long long)rebuilds[i],
                      (unsigned long long)s->queries);
    }
    return 0;
}

CASES_WITH(NULL, report);
