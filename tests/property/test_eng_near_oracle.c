/* test_eng_near_oracle.c - steps and what is near, at any moment of a scene's life.
 *
 * Long sequences of steps and questions: objects come, go, are replaced, stand, move and
 * jump, have radii in some sequences and leave pairs thin; steps fail, end early, are
 * given up, or are taken by the other method, with a separation and an approach where
 * there are radii; some questions move the scene themselves, some are cut short; some
 * steps are taken beside others, as those of a batch. Each answer against a scene made
 * anew, which is asked by the other method, and of small scenes against exact arithmetic
 * on all pairs. No step is answered otherwise because of a question, or changes
 * thereafter. More than 600 lines: one life of a scene, and all that is asked in it.
 */
#include "clock.h"
#include "eng_answer.h"
#include "eng_kit.h"
#include "eng_stir.h"
#include "eng_way.h"
#include "near_judge.h"
#include "parallel.h"
#include "play_actor.h"
#include "sequences.h"
#include "thick_judge.h"

#define SEQUENCES   60
#define THREADS_MAX 4u
#define QUERIES_MAX 3000u /* exact decisions for one answer */
#define PAIRS_MAX   400u  /* of a step that are decided exactly: they take longer */
#define SMALL       200u  /* triangles of a scene whose pairs are looked at one by one */
#define BATCH       3u    /* scenes */

static struct {
    uint64_t sequences;
    uint64_t steps;
    uint64_t inside;    /* pairs of complete steps that began within their distance */
    uint64_t shortened; /* steps with fewer records than there are, of which these are */
    uint64_t interrupted; /* ended before they were complete */
    uint64_t together;    /* taken beside others */
    uint64_t decided;     /* steps of which every pair was decided exactly .. */
    uint64_t pairs;       /* .. so many */
    uint64_t contacts[PCCD_KIND_COUNT]; /* .. with these contacts */
    uint64_t starts_crossed;            /* steps that say so .. */
    uint64_t starts_inside;             /* .. or that */
    uint64_t questions;
    uint64_t moving;  /* of these: moved the scene */
    uint64_t cut;     /* ended before they were complete */
    uint64_t limited; /* of these: had more records than were kept */
    uint64_t named;   /* of two objects that may not meet */
    uint64_t records; /* of complete answers */
    uint64_t large;   /* triangles of the largest scene */
} sums;

static struct near_sums judged;

struct sequence {
    uint64_t seed;
    uint32_t step;
    struct prng prng;
    struct stir stir;
    struct eng_question settings; /* of the steps */
    struct eng_question question; /* the last one */
    bool is_thick;                /* there may be radii and a separation */
    bool is_spoilt;               /* where the last step began is not kept */
    /* The answer of the last step, and a copy of it; NULL: there is none. */
    struct eng_step_result last;
    void *records;
    void *threads;
};

static void must(const struct sequence *sequence, bool holds, const char *what)
{
    if (!holds) {
        char way[WAY_TEXT_MAX];
        way_tell(&sequence->settings, way);
        print_message("# step: mode %d, %s\n", (int)sequence->settings.mode, way);
        way_tell(&sequence->question, way);
        print_message("# question: what %d, distance %a, end %u, %s\n",
                      (int)sequence->question.verb, sequence->question.distance,
                      sequence->question.end, way);
        fail_msg("PCCD_SEED=%llu, step %u: %s", (unsigned long long)sequence->seed,
                 sequence->step, what);
    }
}

static uint32_t draw(struct sequence *sequence, uint32_t bound)
{
    return prng_u32(&sequence->prng, bound);
}

/* ---- steps ------------------------------------------------------------------------- */

static void forget_last(struct sequence *sequence)
{
    free(sequence->records);
    free(sequence->threads);
    sequence->records = NULL;
    sequence->threads = NULL;
}

static size_t record_bytes_of(const struct eng_step_result *result)
{
    return result->count * result->record_bytes;
}

static void keep_last(struct sequence *sequence, const struct eng_step_result *result)
{
    forget_last(sequence);
    sequence->last = *result;
    sequence->records = test_copy(result->records, record_bytes_of(result));
    sequence->threads = test_copy(result->thread_records,
                                  result->threads * sizeof *result->thread_records);
}

static void check_last(const struct sequence *sequence)
{
    const struct eng_step_result *last = &sequence->last;
    if (!sequence->records) {
        return;
    }
    must(sequence,
         record_bytes_of(last) == 0 ||
             memcmp(last->records, sequence->records, record_bytes_of(last)) == 0,
         "a question has changed the answer of the last step");
    must(sequence,
         memcmp(last->thread_records, sequence->threads,
                last->threads * sizeof *last->thread_records) == 0,
         "a question has changed what is told of the last step's threads");
}

static uint64_t triangles_of(const struct player *player)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < player->object_count; i++) {
        count += player->objects[i].triangle_count;
    }
    return count;
}

/* Judge what the answer says of the begin of the step. */
static void judge_start(struct sequence *sequence, const struct eng_question *settings,
                        const struct near_objects *objects,
                        const struct eng_step_result *result)
{
    const struct player *player = &sequence->stir.player;
    struct near_objects start = *objects;
    struct oracle_moment moment = {.objects = start.items,
                                   .object_count = player->object_count,
                                   .may_meet = near_may_meet,
                                   .context = player};
    struct oracle_nears crossings = {.count = 0}, pairs = {.count = 0};
    for (uint32_t i = 0; i < player->object_count; i++) {
        start.items[i].x1 = start.items[i].x0;
    }
    oracle_moment_thicken(&moment, PCCD_NEAR_PAIRS);
    if (!settings->tells_start) {
        must(sequence, result->crossings + result->start_inside == 0,
             "it tells how it begins, unasked");
        return;
    }
    if (oracle_near_crossings(&moment, QUERIES_MAX, &crossings) &&
        (settings->approach == 0 ||
         oracle_near_pairs(&moment, settings->distance, QUERIES_MAX, &pairs))) {
        bool is_free = crossings.count + pairs.count == 0;
        bool is_any = settings->mode == PCCD_MODE_ANY;
        must(sequence, result->crossings == crossings.count,
             "what it begins crossed with");
        must(sequence, result->start_inside == pairs.count, "what begins inside");
        must(sequence, !is_any || is_free || result->verdict == PCCD_VERDICT_YES,
             "a verdict that what begins crossed is free");
        must(sequence, crossings.count == 0 || result->safe_step == 0,
             "a safe way from where it is crossed");
        sums.starts_crossed += crossings.count > 0;
        sums.starts_inside += pairs.count > 0;
    }
    oracle_nears_deinit(&crossings);
    oracle_nears_deinit(&pairs);
}

/* Return how far it would be safe if it were not crossed at first. */
static double safe_step_of(const struct eng_step_result *result)
{
    bool has_time = result->toi_first > 0 && result->toi_first <= 1;
    return result->count == 0 ? 1 : has_time ? nextafter(result->toi_first, 0) : 0;
}

/* Decide every pair of a small scene, unless that takes too long. */
static void judge_step(struct sequence *sequence, const struct eng_question *settings,
                       const struct eng_step_result *result)
{
    const struct player *player = &sequence->stir.player;
    struct near_objects objects;
    struct thick_truths truths;
    if (triangles_of(player) > SMALL) {
        return;
    }
    near_objects_list(player, &objects);
    const struct thick_step seen = {.objects = objects.items,
                                    .object_count = player->object_count,
                                    .may_meet = near_may_meet,
                                    .context = player,
                                    .separation = settings->distance,
                                    .approach = settings->approach,
                                    .tolerance = settings->tolerance};
    judge_start(sequence, settings, &objects, result);
    if (!thick_judge_decide(&seen, 0, PAIRS_MAX, &truths)) {
        return;
    }
    bool is_told =
        settings->mode == PCCD_MODE_ANY && result->crossings + result->start_inside > 0;
    struct eng_step_result told = *result;
    told.safe_step = result->crossings > 0 ? safe_step_of(result) : result->safe_step;
    const char *wrong =
        is_told ? NULL : thick_judge(&seen, &truths, &told, sums.contacts);
    sums.decided++;
    sums.pairs += truths.count;
    thick_judge_forget(&truths);
    must(sequence, wrong == NULL, wrong);
}

static void check_step(struct sequence *sequence, const struct eng_question *settings,
                       const struct eng_step_result *result)
{
    struct answer fresh;
    answer_find_fresh(&sequence->stir.player, settings, &fresh);
    const char *difference = answer_difference(&fresh, result);
    must(sequence, difference == NULL, difference);
    must(sequence, way_tree_is_sound(sequence->stir.player.scene, result),
         "the tree is not sound");
    answer_free(&fresh);
    if (result->incomplete == PCCD_COMPLETE) {
        judge_step(sequence, settings, result);
    }
}

/* Scenes that take the same step beside each other, as those of a batch do; the first one
 * is that of the sequence. */
struct together {
    struct player *players[BATCH];
    struct eng_question settings[BATCH];
    struct eng_step_result results[BATCH];
    int statuses[BATCH];
};

static void step_one(void *context, uint32_t item, uint32_t thread)
{
    struct together *together = context;
    (void)thread;
    together->statuses[item] = player_step(
        together->players[item], &together->settings[item], &together->results[item]);
}

/* Returns what the sequence's own scene has. */
static int step_together(struct sequence *sequence, const struct eng_question *settings,
                         struct eng_step_result *result)
{
    struct together together;
    struct player others[BATCH - 1];
    const struct eng_parallel_for each = {.count = BATCH,
                                          .threads = 1 + draw(sequence, BATCH),
                                          .item = step_one,
                                          .context = &together};
    for (uint32_t i = 0; i < BATCH; i++) {
        if (i > 0) {
            player_copy(&sequence->stir.player, NULL, &others[i - 1]);
        }
        together.players[i] = i > 0 ? &others[i - 1] : &sequence->stir.player;
        together.settings[i] = *settings;
        together.settings[i].threads = 1;
        together.settings[i].method = way_methods[draw(sequence, WAY_METHODS)];
    }
    eng_parallel_for(&each);
    for (uint32_t i = 0; i < BATCH; i++) {
        must(sequence, together.statuses[i] == PCCD_OK, "a step beside others failed");
        must(sequence,
             memcmp(together.results[i].hash, together.results[0].hash,
                    sizeof together.results[0].hash) == 0,
             "the same steps beside each other have other hashes");
    }
    for (uint32_t i = 0; i < BATCH - 1; i++) {
        player_deinit(&others[i]);
    }
    sums.together++;
    *result = together.results[0];
    return together.statuses[0];
}

/* Mostly as the last step was taken. */
static void change_settings(struct sequence *sequence)
{
    static const double tolerances[] = {1e-6, 1e-3, 1e-12};
    struct eng_question *settings = &sequence->settings;
    if (draw(sequence, 4) == 0) {
        way_draw(&sequence->prng, THREADS_MAX, settings);
    }
    if (draw(sequence, 4) == 0) {
        settings->mode = (enum pccd_mode)draw(sequence, PCCD_MODE_COUNT);
        settings->tells_start = draw(sequence, 2) == 0;
    }
    if (sequence->is_thick && draw(sequence, 4) == 0) {
        settings->tolerance = tolerances[draw(sequence, 3)];
        settings->distance = draw(sequence, 2) * PLAY_UNIT * draw(sequence, 64);
        settings->approach = 0.25 * draw(sequence, 4);
    }
}

/* The step that is staged. One of five ends early, or may; of these brief ones owe an
 * answer that nobody asks for. */
static void take_step(struct sequence *sequence)
{
    struct eng_question settings = sequence->settings;
    struct eng_step_result result;
    atomic_bool cancel = true;
    uint32_t how = draw(sequence, 20);
    forget_last(sequence);
    if (how == 0) {
        settings.cancel = &cancel;
    } else if (how == 1) {
        settings.deadline_ns = common_now_ns() + draw(sequence, 400) * 1000;
    } else if (how == 2) {
        settings.brief = true;
    } else if (how == 3) {
        settings.contact_max = draw(sequence, 20);
    }
    int status = how == 4 ? step_together(sequence, &settings, &result)
                          : player_step(&sequence->stir.player, &settings, &result);
    if (status == PCCD_E_INVAL && settings.brief) { /* not by this method */
        player_stage_copies(&sequence->stir.player);
        status = player_step(&sequence->stir.player, &sequence->settings, &result);
    }
    sequence->is_spoilt = false;
    sums.steps++;
    must(sequence, status == PCCD_OK || (settings.brief && status == PCCD_E_AGAIN),
         "the step failed");
    if (status == PCCD_OK) {
        bool is_complete = result.incomplete == PCCD_COMPLETE;
        /* Those that are too many to keep are the last ones, in these modes. */
        bool is_prefix = how == 3 && (settings.mode == PCCD_MODE_ALL ||
                                      settings.mode == PCCD_MODE_PAIRS);
        keep_last(sequence, &result);
        if (is_complete || is_prefix) {
            check_step(sequence, &settings, &result);
        }
        sums.interrupted += !is_complete;
        sums.inside += is_complete ? result.inside : 0;
        sums.shortened += is_prefix && !is_complete;
    }
}

/* ---- questions --------------------------------------------------------------------- */

/* As far as features, with radii of any play, may be asked for. */
#define FAR 0x1p59
/* Triangles of which not everything is asked for: tens of millions of pairs would take
 * minutes, and gigabytes. */
#define MANY 1500u

static double some_distance(struct sequence *sequence)
{
    double unit = PLAY_UNIT;
    switch (draw(sequence, 8)) {
    case 0:
        return 0;
    case 1: /* that of many features that touch none */
        return unit * (1 + draw(sequence, 8));
    case 2:
        return unit * PLAY_ONE / 16;
    case 3: /* an edge */
        return nextafter(unit * PLAY_ONE / 8, draw(sequence, 2) ? 0 : 1);
    case 4:
        return unit * draw(sequence, PLAY_ONE);
    case 5:
        return ldexp(1, -(int)draw(sequence, 1074));
    case 6: /* everything, seldom */
        return draw(sequence, 4) == 0 ? FAR : unit * PLAY_ONE / 4;
    default:
        return prng_between(&sequence->prng, 0, unit * PLAY_ONE / 8);
    }
}

static void draw_question(struct sequence *sequence)
{
    static const enum pccd_near_what whats[] = {
        PCCD_NEAR_PAIRS,   PCCD_NEAR_FEATURES, PCCD_NEAR_VERTICES, PCCD_NEAR_CROSSINGS,
        PCCD_NEAR_NEAREST, PCCD_NEAR_DEPTH}; /* of closed meshes, last */
    const struct player *player = &sequence->stir.player;
    struct eng_question *question = &sequence->question;
    *question = kit_question(whats[draw(sequence, sequence->stir.is_closed ? 6 : 5)]);
    question->distance = some_distance(sequence);
    question->tells_crossings = draw(sequence, 2) == 0;
    if (triangles_of(player) > MANY) {
        question->distance = fmin(question->distance, PLAY_UNIT * PLAY_ONE / 16);
    }
    question->end = sequence->is_spoilt || draw(sequence, 3) > 0;
    if (draw(sequence, 3) == 0) { /* else as the last step was taken */
        way_draw(&sequence->prng, THREADS_MAX, question);
    } else {
        struct eng_question step = sequence->settings;
        step.verb = question->verb;
        step.distance = question->distance;
        step.tells_crossings = question->tells_crossings;
        step.end = question->end;
        step.mode = (enum pccd_mode)draw(sequence, PCCD_MODE_COUNT);
        *question = step;
    }
    uint32_t count = player->object_count;
    if (question->verb == PCCD_NEAR_VERTICES && draw(sequence, 4) == 0 && count > 0) {
        question->objects[0] = player->objects[draw(sequence, count)].id;
    }
    if (question->verb == PCCD_NEAR_NEAREST) {
        question->gap = draw(sequence, 3) ? 0 : some_distance(sequence);
        question->distance = draw(sequence, 4) ? question->distance : INFINITY;
    }
    bool is_of_two =
        question->verb == PCCD_NEAR_NEAREST || question->verb == PCCD_NEAR_DEPTH;
    if (is_of_two && count > 1 && draw(sequence, 3) == 0) { /* or one with all others */
        uint32_t first = draw(sequence, count);
        uint32_t other = (first + 1 + draw(sequence, count - 1)) % count;
        question->objects[0] = player->objects[first].id;
        question->objects[1] = draw(sequence, 3) ? player->objects[other].id : 0;
        sums.named += question->objects[0] != 0 && question->objects[1] != 0 &&
                      !filters_may_meet(&player->filters, question->objects[0],
                                        question->objects[1]);
    }
}

static void check_answer(struct sequence *sequence, const struct eng_step_result *result)
{
    const struct player *player = &sequence->stir.player;
    const struct eng_question *question = &sequence->question;
    bool is_limited = result->incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT;
    const char *wrong = near_judge_player(player, question, result, QUERIES_MAX, &judged);
    must(sequence, !wrong, wrong);
    if (result->incomplete == PCCD_COMPLETE || is_limited) {
        struct answer fresh;
        answer_find_fresh(player, question, &fresh);
        if (question->gap == 0) {
            wrong = answer_difference(&fresh, result);
        } else if (!is_limited && fresh.result.count != result->count) {
            wrong = "two objects have a pair by one method alone";
        }
        answer_free(&fresh);
        must(sequence, !wrong, wrong);
        sums.records += result->count;
    }
    sums.cut += result->incomplete != PCCD_COMPLETE;
    sums.limited += is_limited;
}

/* Ask where the scene is or, if something is staged, where that leads to. */
static void ask(struct sequence *sequence)
{
    struct player *player = &sequence->stir.player;
    struct eng_question limited;
    struct eng_step_result result;
    atomic_bool cancel = true;
    uint32_t how = draw(sequence, 16);
    draw_question(sequence);
    if (how == 0) {
        sequence->question.contact_max = draw(sequence, 20);
    }
    limited = sequence->question;
    if (how == 1) {
        limited.cancel = &cancel;
    } else if (how == 2) {
        limited.deadline_ns = common_now_ns() + draw(sequence, 400) * 1000;
    }
    sums.questions++;
    sums.moving += player->is_staging;
    player->is_staging = false;
    must(sequence, eng_near(player->scene, &limited, &result) == PCCD_OK,
         "the question failed");
    check_last(sequence);
    check_answer(sequence, &result);
}

static void ask_some(struct sequence *sequence)
{
    for (uint32_t count = draw(sequence, 3); count > 0; count--) {
        ask(sequence);
    }
}

/* ---- sequences --------------------------------------------------------------------- */

/* All objects come anew, closed or some of meshes that have radii, as others that come
 * later. */
static void begin_anew(struct sequence *sequence)
{
    struct player *player = &sequence->stir.player;
    player->radii_from = sequence->is_thick ? &sequence->prng : NULL;
    for (uint32_t i = 0; i < player->object_count; i++) {
        stir_replace(&sequence->stir, i);
    }
}

static void note_size(const struct player *player)
{
    uint64_t count = triangles_of(player);
    sums.large = count > sums.large ? count : sums.large;
}

static void live(uint64_t seed)
{
    struct sequence sequence = {.seed = seed, .prng = {seed}};
    struct eng_scene_settings made = stir_draw_scene(&sequence.prng);
    uint32_t size = stir_draw_size(&sequence.prng, 4);
    uint32_t steps = 3 + draw(&sequence, 8);
    sequence.settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    way_draw(&sequence.prng, THREADS_MAX, &sequence.settings);
    stir_init(&sequence.stir, &made, size, prng_next(&sequence.prng));
    sequence.is_thick = draw(&sequence, 2) > 0;
    sequence.stir.is_closed = draw(&sequence, 4) == 0;
    if (sequence.is_thick || sequence.stir.is_closed) {
        begin_anew(&sequence);
    }
    for (; sequence.step < steps; sequence.step++) {
        note_size(&sequence.stir.player);
        forget_last(&sequence); /* it may go with an object */
        stir_change(&sequence.stir);
        if (sequence.is_thick && draw(&sequence, 2) > 0) {
            player_draw_thickness(&sequence.stir.player, &sequence.prng);
        }
        ask_some(&sequence);
        if (draw(&sequence, 8) == 0) {
            stir_fail(&sequence.stir);
            sequence.is_spoilt = true;
            ask_some(&sequence);
        }
        change_settings(&sequence);
        stir_move(&sequence.stir);
        player_open(&sequence.stir.player);
        if (draw(&sequence, 4) == 0) {
            sequence.is_spoilt = false;
            ask(&sequence);
        } else {
            take_step(&sequence);
        }
        ask_some(&sequence);
    }
    forget_last(&sequence);
    sums.sequences++;
    stir_deinit(&sequence.stir);
}

/* If this failed, an answer about what is near would be that of other positions, objects
 * or filters than those that hold, or a step would be answered otherwise because somebody
 * has asked. */
CASE(near__is_answered_as_by_a_fresh_scene)
{
    sequences_live(live, SEQUENCES, "PCCD_NEAR_SEQUENCES");
    print_message(
        "# %llu sequences, %llu steps (%llu interrupted, %llu shortened, %llu "
        "beside others, %llu pairs inside, %llu begin crossed and %llu inside); decided "
        "%llu of them, %llu pairs: %llu "
        "VF, %llu EE\n",
        (unsigned long long)sums.sequences, (unsigned long long)sums.steps,
        (unsigned long long)sums.interrupted, (unsigned long long)sums.shortened,
        (unsigned long long)sums.together, (unsigned long long)sums.inside,
        (unsigned long long)sums.starts_crossed, (unsigned long long)sums.starts_inside,
        (unsigned long long)sums.decided, (unsigned long long)sums.pairs,
        (unsigned long long)sums.contacts[PCCD_VF],
        (unsigned long long)sums.contacts[PCCD_EE]);
    print_message("# %llu questions: %llu that moved, %llu cut, %llu limited, %llu named "
                  "in vain; %llu records; up to %llu triangles\n",
                  (unsigned long long)sums.questions, (unsigned long long)sums.moving,
                  (unsigned long long)sums.cut, (unsigned long long)sums.limited,
                  (unsigned long long)sums.named, (unsigned long long)sums.records,
                  (unsigned long long)sums.large);
    near_sums_tell(&judged);
    if (!getenv("PCCD_SEED") && sums.sequences >= SEQUENCES) {
        assert_true(sums.moving > 0 && sums.cut > sums.limited && sums.limited > 0);
        assert_true(sums.large > 4096 && judged.features > 0 && judged.bounds > 0);
        assert_true(judged.touching > 0 && judged.at_distance > 0 && judged.free > 0);
        assert_true(judged.thick > 0 && sums.inside > 0 && sums.shortened > 0);
        assert_true(judged.beside > 0 && sums.starts_crossed > 0 &&
                    sums.starts_inside > 0);
        assert_true(judged.crossings > 0 && judged.parts > 0 && judged.nearest > 0);
        assert_true(judged.others > 0 && judged.inside > 0 && judged.through > 0);
        assert_true(sums.decided > 0 && sums.contacts[PCCD_EE] > 0 && sums.named > 0);
        assert_true(sums.together > 0 && sums.interrupted > sums.shortened);
    }
}
