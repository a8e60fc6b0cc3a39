/* test_eng_fuzz.c - whatever a scene has been through, it answers as one made anew. */
#include "cases.h"
#include "clock.h"
#include "eng_answer.h"
#include "eng_way.h"
#include "trace.h"

#define ROUNDS 10

static struct {
    uint64_t cases;
    uint64_t steps;
    uint64_t team_steps;
    uint64_t early; /* steps that ended before they were complete */
    uint64_t records;
    uint64_t near; /* records of what is near */
    uint64_t rebuilds;
    uint64_t swaps;
} sums;

struct fuzz {
    struct prng prng;
    uint64_t seed; /* of the case */
    uint32_t step;
    uint32_t thread_max;
    double distance; /* that pairs of the step have to keep */
    struct player player;
    struct eng_trace trace;
};

#define CHECK(fuzz, condition)                                                           \
    do {                                                                                 \
        if (!(condition)) {                                                              \
            fail_msg("PCCD_SEED=%llu, step %u: not %s",                                  \
                     (unsigned long long)(fuzz)->seed, (fuzz)->step, #condition);        \
        }                                                                                \
    } while (0)

static uint32_t draw(struct fuzz *fuzz, uint32_t bound)
{
    return prng_u32(&fuzz->prng, bound);
}

static struct eng_scene_settings some_scene(struct fuzz *fuzz)
{
    static const double ratios[] = {0, 0.5, 0.9, 0.9, 1};
    static const uint32_t regions[] = {1, 8, 16, 20, 30, 40, 100, 1024};
    struct eng_scene_settings made = ENG_SCENE_SETTINGS_DEFAULT;
    made.rebuild_ratio = ratios[draw(fuzz, 5)];
    made.region_triangles = regions[draw(fuzz, 8)];
    return made;
}

static struct eng_question some_settings(struct fuzz *fuzz, enum pccd_mode mode)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.mode = mode;
    settings.distance = fuzz->distance;
    way_draw(&fuzz->prng, fuzz->thread_max, &settings);
    settings.team_always = draw(fuzz, 4) > 0; /* else by a team where it pays */
    settings.trace = draw(fuzz, 4) == 0 ? &fuzz->trace : NULL;
    return settings;
}

/* Find what a fresh scene, one thread and default settings answer. */
static void find_reference(struct fuzz *fuzz, enum pccd_mode mode, struct answer *answer)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.mode = mode;
    settings.distance = fuzz->distance;
    answer_find_fresh(&fuzz->player, &settings, answer);
    CHECK(fuzz, answer->result.incomplete == PCCD_COMPLETE);
}

static void tally(const struct eng_step_result *result)
{
    sums.steps++;
    sums.team_steps += result->threads > 1;
    sums.early += result->incomplete != PCCD_COMPLETE;
    sums.records += result->count;
    sums.rebuilds += result->counters.rebuilds;
    sums.swaps += result->counters.swaps;
}

static void take_whole_step(struct fuzz *fuzz, enum pccd_mode mode,
                            const struct answer *want)
{
    struct eng_question settings = some_settings(fuzz, mode);
    struct eng_step_result result;
    CHECK(fuzz, player_step(&fuzz->player, &settings, &result) == PCCD_OK);
    tally(&result);
    const char *difference = answer_difference(want, &result);
    if (difference) {
        fail_msg("PCCD_SEED=%llu, step %u: not the same: %s",
                 (unsigned long long)fuzz->seed, fuzz->step, difference);
    }
    CHECK(fuzz, way_tree_is_sound(fuzz->player.scene, &result));
}

/* Both are sorted; what is kept must be the very records. */
static bool is_part_of(const struct eng_step_result *result,
                       const struct eng_step_result *whole)
{
    const char *have = result->records;
    const char *from = whole->records;
    size_t bytes = whole->record_bytes;
    uint64_t at = 0;
    for (uint64_t i = 0; i < result->count; i++, at++) {
        while (at < whole->count && memcmp(have + i * bytes, from + at * bytes, bytes)) {
            at++;
        }
        if (at == whole->count) {
            return false;
        }
    }
    return true;
}

/* The step that is staged, but it may not end: too late, cancelled, or, in mode `all` or
 * `pairs`, too many records. */
static void take_cut_step(struct fuzz *fuzz, enum pccd_mode mode,
                          const struct answer *want)
{
    const struct eng_step_result *whole = &want->result;
    bool is_list = mode == PCCD_MODE_ALL || mode == PCCD_MODE_PAIRS;
    struct eng_question settings = some_settings(fuzz, mode);
    struct eng_step_result result;
    atomic_bool cancel = true;
    enum pccd_incomplete reason = PCCD_INCOMPLETE_DEADLINE;
    uint32_t why = is_list ? draw(fuzz, 3) : 2 * draw(fuzz, 2);
    if (why == 0) {
        settings.cancel = &cancel;
        reason = PCCD_INCOMPLETE_CANCELLED;
    } else if (why == 1) {
        settings.contact_max = draw(fuzz, (uint32_t)whole->count + 20);
        reason = PCCD_INCOMPLETE_CONTACT_LIMIT;
    } else {
        settings.deadline_ns = common_now_ns() + draw(fuzz, 400) * 1000;
    }
    CHECK(fuzz, player_step(&fuzz->player, &settings, &result) == PCCD_OK);
    tally(&result);
    CHECK(fuzz, result.incomplete == PCCD_COMPLETE || result.incomplete == reason);
    CHECK(fuzz, result.incomplete != PCCD_COMPLETE || !answer_difference(want, &result));
    CHECK(fuzz, !is_list || is_part_of(&result, whole));
    if (why == 1) { /* the first ones */
        uint64_t most = settings.contact_max;
        CHECK(fuzz, result.count == (whole->count < most ? whole->count : most));
        CHECK(fuzz, (result.incomplete == PCCD_COMPLETE) == (whole->count <= most));
        CHECK(fuzz, result.count == 0 || memcmp(result.records, whole->records,
                                                result.count * whole->record_bytes) == 0);
    }
    CHECK(fuzz, way_tree_is_sound(fuzz->player.scene, &result));
}

/* Everything to other places, in too little time for it. */
static void take_detour(struct fuzz *fuzz)
{
    struct eng_question settings = some_settings(fuzz, PCCD_MODE_ALL);
    settings.deadline_ns = common_now_ns() + 1000000;
    if (draw(fuzz, 2) == 0) {
        player_scramble(&fuzz->player, &settings);
    } else {
        player_go_back(&fuzz->player, &settings);
    }
    player_stage_copies(&fuzz->player);
}

/* Ask what is near now, any question. */
static void ask_what_is_near(struct fuzz *fuzz)
{
    static const double distances[] = {0, 0x1p-6, 0x1p-4, INFINITY};
    struct eng_question question = some_settings(fuzz, PCCD_MODE_ALL);
    struct eng_step_result result;
    struct answer want;
    question.verb = draw(fuzz, PCCD_NEAR_DEPTH); /* that is of closed meshes alone */
    question.end = draw(fuzz, 2);
    question.distance = distances[draw(fuzz, question.verb == PCCD_NEAR_NEAREST ? 4 : 3)];
    answer_find_fresh(&fuzz->player, &question, &want);
    CHECK(fuzz, eng_near(fuzz->player.scene, &question, &result) == PCCD_OK);
    const char *difference = answer_difference(&want, &result);
    if (difference) {
        fail_msg("PCCD_SEED=%llu, step %u: not the same, what is near (%u): %s",
                 (unsigned long long)fuzz->seed, fuzz->step, question.verb, difference);
    }
    sums.near += result.count;
    answer_free(&want);
}

/* The step that is staged, without an answer. */
static void move_alone(struct fuzz *fuzz)
{
    struct eng_question settings = some_settings(fuzz, PCCD_MODE_ALL);
    struct eng_step_result result;
    fuzz->player.is_staging = false;
    CHECK(fuzz, eng_move(fuzz->player.scene, &settings, &result) == PCCD_OK);
    CHECK(fuzz, result.incomplete != PCCD_COMPLETE || result.method != PCCD_METHOD_WIDE);
    if (draw(fuzz, 2)) {
        ask_what_is_near(fuzz);
    }
    player_stage_copies(&fuzz->player);
}

/* An object gets another's mesh, and gets its own back. */
static void try_and_take_back(struct fuzz *fuzz)
{
    struct player *player = &fuzz->player;
    player_drop(player);
    const struct player_object *object =
        &player->objects[draw(fuzz, player->object_count)];
    const struct player_object *other =
        &player->objects[draw(fuzz, player->object_count)];
    CHECK(fuzz,
          eng_scene_try_replace(player->scene, object->idx, other->mesh) == PCCD_OK);
    eng_scene_take_back(player->scene);
    CHECK(fuzz,
          eng_scene_vertex_count(player->scene, object->idx) == object->vertex_count);
    player_stage_copies(player);
}

static void fuzz_step(struct fuzz *fuzz)
{
    /* The first step is taken as the play staged it, the others from the copies. */
    static const enum pccd_mode modes[] = {PCCD_MODE_ALL, PCCD_MODE_FIRST, PCCD_MODE_ANY,
                                           PCCD_MODE_FIRST_PER_PAIR,
                                           PCCD_MODE_PAIRS}; /* not where bodies turn */
    enum pccd_mode mode = modes[draw(fuzz, fuzz->player.has_joints ? 4 : 5)];
    struct answer want;
    fuzz->distance = draw(fuzz, 4) == 0 ? 0x1p-6 : 0;
    if (draw(fuzz, 4) == 0) {
        player_draw_filters(&fuzz->player, &fuzz->prng);
    }
    player_open(&fuzz->player);
    find_reference(fuzz, mode, &want);
    if (fuzz->player.object_count > 0 && draw(fuzz, 8) == 0) {
        try_and_take_back(fuzz);
    }
    if (draw(fuzz, 6) == 0) {
        take_detour(fuzz);
    }
    if (draw(fuzz, 6) == 0) {
        move_alone(fuzz);
    }
    if (draw(fuzz, 4) == 0) {
        take_cut_step(fuzz, mode, &want);
        player_stage_copies(&fuzz->player);
    }
    take_whole_step(fuzz, mode, &want);
    for (uint32_t again = draw(fuzz, 3); again > 0; again--) {
        player_stage_copies(&fuzz->player);
        take_whole_step(fuzz, mode, &want);
    }
    answer_free(&want);
    if (draw(fuzz, 3) == 0) {
        ask_what_is_near(fuzz);
    }
    fuzz->step++;
}

static void fuzz_case(uint64_t seed)
{
    struct fuzz fuzz = {.prng = {seed}, .seed = seed};
    struct eng_scene_settings made = some_scene(&fuzz);
    struct play play;
    static const uint32_t sizes[] = {40, 40, 400, 400};
    uint32_t size = sizes[draw(&fuzz, 4)];
    fuzz.thread_max = 1 + draw(&fuzz, 9);
    assert_ok(eng_trace_init(&fuzz.trace, 4, 64, 0));
    play_wild(&play, 3 + draw(&fuzz, 20), size, prng_next(&fuzz.prng));
    player_init(&fuzz.player, &made);
    fuzz.player.turns_from = draw(&fuzz, 2) ? &fuzz.prng : NULL;
    for (uint32_t i = 0; i < play.act_count; i++) {
        if (play.acts[i].what == PLAY_STEP) {
            fuzz_step(&fuzz);
        } else {
            player_act(&fuzz.player, &play.acts[i]);
        }
    }
    player_deinit(&fuzz.player);
    eng_trace_deinit(&fuzz.trace);
    play_deinit(&play);
    sums.cases++;
}

/* If this failed, an answer would depend on what a scene has been through, or on how its
 * steps are taken. */
CASE(fuzz__answers_as_a_fresh_scene)
{
    const char *seconds = getenv("PCCD_FUZZ_SECONDS");
    struct prng prng = {prng_seed()};
    uint64_t end_ns = common_now_ns();
    end_ns += seconds ? (uint64_t)(strtod(seconds, NULL) * 1e9) : 0;
    for (uint32_t i = 0; seconds ? common_now_ns() < end_ns : i < ROUNDS; i++) {
        fuzz_case(i == 0 ? prng.state : prng_next(&prng));
    }
    print_message("# %llu cases, %llu steps, %llu by a team, %llu ended early; %llu "
                  "records, %llu of what is near; %llu subtrees rebuilt, %llu swapped\n",
                  (unsigned long long)sums.cases, (unsigned long long)sums.steps,
                  (unsigned long long)sums.team_steps, (unsigned long long)sums.early,
                  (unsigned long long)sums.records, (unsigned long long)sums.near,
                  (unsigned long long)sums.rebuilds, (unsigned long long)sums.swaps);
    if (!getenv("PCCD_SEED")) {
        assert_true(sums.team_steps > 0 && sums.early > 0);
    }
}
