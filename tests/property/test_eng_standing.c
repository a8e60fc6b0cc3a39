/* test_eng_standing.c - what stands still is answered as what moves.
 *
 * Long sequences of steps of scenes in which most things stand: objects move and stop, a
 * few vertices of a large sheet, the same motion once more, bytes that are there already;
 * objects come, go and are replaced between; steps fail, end early, are given up, or are
 * taken in another way. Each complete answer against a fresh scene's, those of tiny
 * scenes against brute force in exact arithmetic, too.
 */
#include "cases.h"
#include "clock.h"
#include "eng_answer.h"
#include "eng_stir.h"
#include "eng_way.h"
#include "judge.h"
#include "sequences.h"

#define SEQUENCES   400
#define THREADS_MAX 3u

static struct {
    uint64_t sequences;
    uint64_t complete;
    uint64_t cut;      /* ended before they were complete */
    uint64_t given_up; /* brief steps that were */
    uint64_t failures;
    uint64_t records;
    uint64_t initial;
    uint64_t kept;  /* records that were taken from the answer before */
    uint64_t large; /* triangles of the largest scene */
} sums;

static struct judge_sums judged;

struct sequence {
    uint64_t seed;
    uint32_t step;
    struct prng prng;
    struct stir stir;
    struct eng_question settings; /* of the last complete step */
    bool is_tiny;
};

static void must(const struct sequence *sequence, bool holds, const char *what)
{
    if (!holds) {
        char way[WAY_TEXT_MAX];
        way_tell(&sequence->settings, way);
        print_message("# mode %d, tolerance %g, %s\n", (int)sequence->settings.mode,
                      sequence->settings.tolerance, way);
        fail_msg("PCCD_SEED=%llu, step %u: %s", (unsigned long long)sequence->seed,
                 sequence->step, what);
    }
}

static uint32_t draw(struct sequence *sequence, uint32_t bound)
{
    return prng_u32(&sequence->prng, bound);
}

/* Mostly as the last step was taken. */
static void change_settings(struct sequence *sequence)
{
    static const double tolerances[] = {1e-6, 1e-3, 1e-12};
    struct eng_question *settings = &sequence->settings;
    if (draw(sequence, 6) == 0) {
        way_draw(&sequence->prng, THREADS_MAX, settings);
        settings->team_always = draw(sequence, 4) > 0; /* else by a team where it pays */
    }
    if (draw(sequence, 8) == 0) {
        settings->mode = (enum pccd_mode)draw(sequence, PCCD_MODE_COUNT);
    }
    if (draw(sequence, 12) == 0) {
        settings->tolerance = tolerances[draw(sequence, 3)];
    }
    if (draw(sequence, 12) == 0) { /* another size of team alone */
        settings->threads = 1 + draw(sequence, THREADS_MAX);
    }
}

static void check(struct sequence *sequence, const struct eng_question *settings,
                  struct eng_step_result *result)
{
    struct answer fresh;
    answer_find_fresh(&sequence->stir.player, settings, &fresh);
    const char *difference = answer_difference(&fresh, result);
    must(sequence, difference == NULL, difference);
    must(sequence, way_tree_is_sound(sequence->stir.player.scene, result),
         "the tree is not sound");
    answer_free(&fresh);
    if (sequence->is_tiny && result->mode == PCCD_MODE_ALL &&
        result->incomplete == PCCD_COMPLETE) {
        judge_check_play(&judged, &sequence->stir.player, sequence->settings.tolerance,
                         sequence->seed, sequence->step, result);
    }
    sums.complete++;
    sums.records += result->count;
    sums.initial += result->initial;
    sums.kept += result->counters.kept_records;
}

/* The step that is staged, but it may not end: cancelled, too late, too many records. */
static void take_cut_step(struct sequence *sequence)
{
    struct eng_question settings = sequence->settings;
    struct eng_step_result result;
    atomic_bool cancel = true;
    uint32_t why = draw(sequence, 4);
    if (why == 0) {
        settings.cancel = &cancel;
    } else if (why == 1) {
        settings.contact_max = draw(sequence, 20);
    } else if (why == 2) {
        settings.deadline_ns = 1;
    } else {
        settings.deadline_ns = common_now_ns() + draw(sequence, 400) * 1000;
    }
    must(sequence, player_step(&sequence->stir.player, &settings, &result) == PCCD_OK,
         "a step with a limit failed");
    sums.cut += result.incomplete != PCCD_COMPLETE;
    /* Those that are too many to keep are the last ones, in these modes. */
    bool is_prefix =
        why == 1 && (settings.mode == PCCD_MODE_ALL || settings.mode == PCCD_MODE_PAIRS);
    if (result.incomplete == PCCD_COMPLETE || is_prefix) {
        check(sequence, &settings, &result);
    }
}

static void take_whole_step(struct sequence *sequence)
{
    struct eng_step_result result;
    must(sequence,
         player_step(&sequence->stir.player, &sequence->settings, &result) == PCCD_OK,
         "the step failed");
    check(sequence, &sequence->settings, &result);
}

/* The step that is staged, as a brief one. What is given up is owed, or the scene goes on
 * from its end; what no brief step can do is refused, and nothing has moved. */
static void take_brief_step(struct sequence *sequence)
{
    struct player *player = &sequence->stir.player;
    struct eng_question settings = sequence->settings;
    struct eng_step_result result;
    settings.brief = true;
    int status = player_step(player, &settings, &result);
    if (status == PCCD_E_INVAL) {
        player_stage_copies(player);
        take_whole_step(sequence);
        return;
    }
    must(sequence, status == PCCD_OK || status == PCCD_E_AGAIN, "a brief step failed");
    sums.given_up += status == PCCD_E_AGAIN;
    if (status == PCCD_E_AGAIN && draw(sequence, 2) > 0) {
        settings.brief = false;
        status = eng_step(player->scene, &settings, &result);
        must(sequence, status == PCCD_OK, "what is owed failed");
    }
    if (status == PCCD_OK) {
        check(sequence, &sequence->settings, &result);
    }
}

static void take_step(struct sequence *sequence)
{
    uint32_t how = draw(sequence, 10);
    player_open(&sequence->stir.player);
    if (how == 0) {
        take_cut_step(sequence);
    } else if (how == 1) {
        take_brief_step(sequence);
    } else {
        take_whole_step(sequence);
    }
}

static uint64_t triangles_of(const struct player *player)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < player->object_count; i++) {
        count += player->objects[i].triangle_count;
    }
    return count;
}

static void live(uint64_t seed)
{
    struct sequence sequence = {.seed = seed, .prng = {seed}};
    struct eng_scene_settings made = stir_draw_scene(&sequence.prng);
    uint32_t size = stir_draw_size(&sequence.prng, 1);
    uint32_t steps = 4 + draw(&sequence, 12);
    sequence.is_tiny = size == STIR_TINY;
    sequence.settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    way_draw(&sequence.prng, THREADS_MAX, &sequence.settings);
    stir_init(&sequence.stir, &made, size, prng_next(&sequence.prng));
    for (; sequence.step < steps; sequence.step++) {
        uint64_t triangles = triangles_of(&sequence.stir.player);
        sums.large = triangles > sums.large ? triangles : sums.large;
        stir_change(&sequence.stir);
        if (draw(&sequence, 8) == 0) {
            stir_fail(&sequence.stir);
        }
        stir_move(&sequence.stir);
        change_settings(&sequence);
        take_step(&sequence);
    }
    sums.failures += sequence.stir.failures;
    sums.sequences++;
    stir_deinit(&sequence.stir);
}

/* If this failed, a contact that has come or gone would not be told because what it is of
 * stands still, or one would be told that is long gone. */
CASE(standing__is_answered_as_by_a_fresh_scene)
{
    sequences_live(live, SEQUENCES, "PCCD_STANDING_SEQUENCES");
    print_message(
        "# %llu sequences, %llu complete steps, %llu cut, %llu given up, %llu "
        "failures; %llu records, %llu initial, %llu kept; up to %llu triangles; by the "
        "oracle %llu steps, %llu contacts\n",
        (unsigned long long)sums.sequences, (unsigned long long)sums.complete,
        (unsigned long long)sums.cut, (unsigned long long)sums.given_up,
        (unsigned long long)sums.failures, (unsigned long long)sums.records,
        (unsigned long long)sums.initial, (unsigned long long)sums.kept,
        (unsigned long long)sums.large, (unsigned long long)judged.steps,
        (unsigned long long)judged.truths);
    if (!getenv("PCCD_SEED") && sums.sequences >= SEQUENCES) {
        assert_true(sums.cut > 0 && sums.given_up > 0 && sums.failures > 0);
        assert_true(sums.initial > 0 && sums.kept > 0 && sums.large > 4096 &&
                    judged.truths > 0);
    }
}
