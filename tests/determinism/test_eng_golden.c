/* test_eng_golden.c - the bytes of an answer, written down. */
#include "cases.h"
#include "eng_player.h"
#include "eng_way.h"
#include "golden.h"
#include "record_hash.h"

/* ---- settings -------------------- */

enum factor {
    THREADS,
    METHOD,
    KERNELS,
    SCHEDULER,
    HIGH_LEVEL,
    REFIT,
    RATIO,
    REGION,
    HISTORY,
    MODE,
    FACTORS
};

enum history {
    RESIDENT, /* the steps before, each once */
    BACK,     /* each step forward, back and forward again */
    FRESH,    /* a scene made for the step */
    HISTORIES
};

static const uint32_t thread_counts[] = {1, 2, 3, 4, 8, 16};
static const double ratios[] = {0, 0.9, 1};
static const uint32_t regions[] = {8, 40, 1024};

#define LEVELS_MAX 6u

/* Levels of a factor: as many instruction sets as this processor has. */
static uint32_t levels(uint32_t factor)
{
    static const uint32_t counts[FACTORS] = {6, WAY_METHODS, 0, 2,         2,
                                             2, 3,           3, HISTORIES, 4};
    uint32_t count = factor == KERNELS ? way_kernels_count() : counts[factor];
    assert_true(count > 0 && count <= LEVELS_MAX);
    return count;
}

struct row {
    uint32_t level[FACTORS];
};

static struct eng_scene_settings scene_settings(const struct row *row)
{
    struct eng_scene_settings settings = ENG_SCENE_SETTINGS_DEFAULT;
    settings.rebuild_ratio = ratios[row->level[RATIO]];
    settings.region_triangles = regions[row->level[REGION]];
    return settings;
}

static struct eng_question step_settings(const struct row *row)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.mode = (enum pccd_mode)row->level[MODE];
    settings.method = way_methods[row->level[METHOD]];
    settings.kernels = way_kernels(row->level[KERNELS]);
    settings.threads = thread_counts[row->level[THREADS]];
    settings.team_always = true;
    settings.tuning.scheduler = (enum eng_scheduler)(row->level[SCHEDULER]);
    settings.tuning.high_level = (enum eng_high_level)(row->level[HIGH_LEVEL]);
    settings.tuning.refit = (enum eng_refit_scheme)(row->level[REFIT]);
    return settings;
}

/* ---- rows that cover all pairs of levels -------------------- */

#define ROWS_MAX   64u
#define CANDIDATES 64u /* for a row */

/* covered[f][g][i][j]: some row has level i of f and level j of g. */
struct cover {
    struct row rows[ROWS_MAX];
    uint32_t row_count;
    bool covered[FACTORS][FACTORS][LEVELS_MAX][LEVELS_MAX];
};

/* Pairs of levels of the row that no row before has. */
static uint32_t news(const struct cover *cover, const struct row *row)
{
    uint32_t count = 0;
    for (uint32_t f = 0; f < FACTORS; f++) {
        for (uint32_t g = f + 1; g < FACTORS; g++) {
            count += !cover->covered[f][g][row->level[f]][row->level[g]];
        }
    }
    return count;
}

static void mark(struct cover *cover, const struct row *row)
{
    for (uint32_t f = 0; f < FACTORS; f++) {
        for (uint32_t g = f + 1; g < FACTORS; g++) {
            cover->covered[f][g][row->level[f]][row->level[g]] = true;
        }
    }
    cover->rows[cover->row_count++] = *row;
}

static uint32_t uncovered(const struct cover *cover)
{
    uint32_t count = 0;
    for (uint32_t f = 0; f < FACTORS; f++) {
        for (uint32_t g = f + 1; g < FACTORS; g++) {
            for (uint32_t i = 0; i < levels(f) * levels(g); i++) {
                count += !cover->covered[f][g][i / levels(g)][i % levels(g)];
            }
        }
    }
    return count;
}

/* The best of many random rows, again and again. */
static void cover_make(struct cover *cover, uint64_t seed)
{
    struct prng prng = {seed};
    memset(cover, 0, sizeof *cover);
    while (uncovered(cover) > 0) {
        struct row best = {{0}};
        assert_true(cover->row_count < ROWS_MAX);
        for (uint32_t i = 0; i < CANDIDATES; i++) {
            struct row row;
            for (uint32_t f = 0; f < FACTORS; f++) {
                row.level[f] = prng_u32(&prng, levels(f));
            }
            if (i == 0 || news(cover, &row) > news(cover, &best)) {
                best = row;
            }
        }
        mark(cover, &best);
    }
}

/* ---- the play by one thread -------------------- */

struct answer {
    uint64_t count;
    uint64_t bytes;
    uint64_t hash[2];     /* of the engine, version 2 */
    uint64_t hash_one[2]; /* version 1, as in golden.c */
    enum pccd_verdict verdict;
    void *records;
};

/* Answers of every step in every mode, by one thread with default settings. */
struct fixture {
    const struct golden *golden;
    struct play play;
    struct answer answers[GOLDEN_STEPS_MAX][4];
    uint64_t rebuilds; /* of all rows */
    uint64_t swaps;
};

static void keep(struct answer *answer, const struct eng_step_result *result)
{
    answer->count = result->count;
    answer->bytes = result->count * result->record_bytes;
    answer->hash[0] = result->hash[0];
    answer->hash[1] = result->hash[1];
    record_hash_1(result->records, result->count, result->record_bytes, answer->hash_one);
    answer->verdict = result->verdict;
    answer->records = test_copy(result->records, answer->bytes);
}

static void fixture_init(struct fixture *f, const struct golden *golden)
{
    struct player player;
    uint32_t step = 0;
    f->golden = golden;
    play_make(&f->play, golden->kind, golden->triangle_count, golden->seed);
    assert_true(f->play.step_count <= GOLDEN_STEPS_MAX);
    player_init(&player, NULL);
    for (uint32_t i = 0; i < f->play.act_count; i++) {
        if (f->play.acts[i].what != PLAY_STEP) {
            player_act(&player, &f->play.acts[i]);
            continue;
        }
        for (uint32_t mode = 0; mode < 4; mode++) {
            struct eng_question settings = ENG_QUESTION_DEFAULT;
            struct eng_step_result result;
            settings.mode = (enum pccd_mode)mode;
            if (mode > 0) {
                player_stage_copies(&player);
            }
            assert_ok(player_step(&player, &settings, &result));
            keep(&f->answers[step][mode], &result);
        }
        step++;
    }
    player_deinit(&player);
}

static void fixture_deinit(struct fixture *f)
{
    for (uint32_t i = 0; i < GOLDEN_STEPS_MAX * 4; i++) {
        free(f->answers[i / 4][i % 4].records);
    }
    play_deinit(&f->play);
    memset(f, 0, sizeof *f);
}

static const enum pccd_mode columns[GOLDEN_MODES] = {PCCD_MODE_ALL, PCCD_MODE_FIRST,
                                                     PCCD_MODE_PAIRS};

static void print_golden(const struct fixture *f)
{
    print_message("# %s, %u triangles, is now:\n", play_name(f->golden->kind),
                  f->golden->triangle_count);
    for (uint32_t step = 0; step < f->play.step_count; step++) {
        const struct answer *a = f->answers[step];
        print_message("# {{%llu, %llu, %llu},\n", (unsigned long long)a[0].count,
                      (unsigned long long)a[1].count, (unsigned long long)a[3].count);
        for (int m = 0; m < GOLDEN_MODES; m++) {
            print_message("# %s{0x%016llx, 0x%016llx}%s\n", m == 0 ? " {" : "  ",
                          (unsigned long long)a[columns[m]].hash_one[0],
                          (unsigned long long)a[columns[m]].hash_one[1],
                          m == 2 ? "}}," : ",");
        }
    }
}

static uint32_t record_bytes_of(enum pccd_mode mode)
{
    return mode == PCCD_MODE_PAIRS ? sizeof(struct pccd_pair)
                                   : sizeof(struct pccd_contact);
}

static bool is_golden(const struct fixture *f)
{
    for (uint32_t i = 0; i < f->play.step_count * GOLDEN_MODES; i++) {
        uint32_t mode = i % GOLDEN_MODES;
        const struct golden_step *want = &f->golden->steps[i / GOLDEN_MODES];
        const struct answer *have = &f->answers[i / GOLDEN_MODES][columns[mode]];
        uint64_t sum[2];
        record_hash_2(have->records, have->count, record_bytes_of(columns[mode]), sum);
        if (have->count != want->count[mode] ||
            memcmp(have->hash_one, want->hash[mode], sizeof have->hash_one) != 0 ||
            memcmp(have->hash, sum, sizeof sum) != 0) {
            return false;
        }
    }
    return true;
}

/* ---- the play under a row -------------------- */

static void fail_row(const struct fixture *f, const struct row *row, uint32_t step,
                     const char *what)
{
    const struct eng_question settings = step_settings(row);
    char way[WAY_TEXT_MAX];
    way_tell(&settings, way);
    fail_msg("%s, step %u: %s; %s, ratio %g, region %u, history %u, mode %u",
             play_name(f->golden->kind), step, what, way, ratios[row->level[RATIO]],
             regions[row->level[REGION]], row->level[HISTORY], row->level[MODE]);
}

static void compare(struct fixture *f, const struct row *row, uint32_t step,
                    const struct eng_scene *scene, const struct eng_step_result *result)
{
    f->rebuilds += result->counters.rebuilds;
    f->swaps += result->counters.swaps;
    const struct answer *want = &f->answers[step][row->level[MODE]];
    if (result->threads != thread_counts[row->level[THREADS]]) {
        fail_row(f, row, step, "not by as many threads as asked");
    }
    if (result->method != way_methods[row->level[METHOD]]) {
        fail_row(f, row, step, "by another method");
    }
    if (result->incomplete != PCCD_COMPLETE) {
        fail_row(f, row, step, "incomplete");
    }
    if (result->count != want->count || result->verdict != want->verdict ||
        result->hash[0] != want->hash[0] || result->hash[1] != want->hash[1]) {
        fail_row(f, row, step, "another answer");
    }
    if (want->bytes > 0 && memcmp(result->records, want->records, want->bytes) != 0) {
        fail_row(f, row, step, "other bytes under the same hash");
    }
    if (!way_tree_is_sound(scene, result)) {
        fail_row(f, row, step, "a tree that is none");
    }
}

/* The step that is staged, after a history. */
static void take_step(struct fixture *f, const struct row *row, uint32_t step,
                      struct player *player)
{
    const struct eng_scene_settings made = scene_settings(row);
    const struct eng_question settings = step_settings(row);
    struct eng_step_result result;
    if (row->level[HISTORY] == FRESH) {
        struct player copy;
        player_copy(player, &made, &copy);
        assert_ok(player_step(&copy, &settings, &result));
        compare(f, row, step, copy.scene, &result);
        player_deinit(&copy);
        player_drop(player);
        return;
    }
    assert_ok(player_step(player, &settings, &result));
    compare(f, row, step, player->scene, &result);
    if (row->level[HISTORY] == BACK) {
        player_go_back(player, &settings);
        player_stage_copies(player);
        assert_ok(player_step(player, &settings, &result));
        compare(f, row, step, player->scene, &result);
    }
}

static void perform(struct fixture *f, const struct row *row)
{
    const struct eng_scene_settings settings = scene_settings(row);
    struct player player;
    uint32_t step = 0;
    player_init(&player, &settings);
    for (uint32_t i = 0; i < f->play.act_count; i++) {
        if (f->play.acts[i].what == PLAY_STEP) {
            take_step(f, row, step++, &player);
        } else {
            player_act(&player, &f->play.acts[i]);
        }
    }
    player_deinit(&player);
}

/* ---- tests -------------------- */

/* If this failed, the bytes of an answer would not be those of the release before. */
CASE(golden__answers_are_as_written_down)
{
    uint32_t different = 0;
    for (uint32_t p = 0; p < GOLDEN_PLAYS; p++) {
        struct fixture f = {0};
        fixture_init(&f, &golden_plays[p]);
        if (!is_golden(&f)) {
            print_golden(&f);
            different++;
        }
        for (uint32_t step = 0; step < f.play.step_count; step++) {
            assert_true(f.answers[step][PCCD_MODE_ALL].count > 0);
            assert_int_equal(f.answers[step][PCCD_MODE_ANY].verdict, PCCD_VERDICT_YES);
        }
        fixture_deinit(&f);
    }
    assert_int_equal(different, 0);
}

static void perform_all(struct fixture *f, const struct cover *cover)
{
    for (uint32_t threads = 0; threads < levels(THREADS); threads++) {
        for (uint32_t i = 0; i < cover->row_count; i++) {
            if (cover->rows[i].level[THREADS] == threads) { /* teams stay as large */
                perform(f, &cover->rows[i]);
            }
        }
    }
}

#define COVERS_MAX 8u

static void under_cover(uint32_t play)
{
    static struct cover cover;
    struct fixture f = {0};
    fixture_init(&f, &golden_plays[play]);
    /* Which rows rebuild in the background is drawn, and of traffic objects go before a
     * tree is done: if no row swaps one in, others are drawn. */
    bool must_swap = play == PLAY_TEAR || play == PLAY_TRAFFIC;
    uint32_t draw = 0;
    do {
        cover_make(&cover, golden_plays[play].seed + draw);
        perform_all(&f, &cover);
    } while (must_swap && f.swaps == 0 && ++draw < COVERS_MAX);
    print_message("# %u rows, %llu subtrees rebuilt, %llu swapped\n", cover.row_count,
                  (unsigned long long)f.rebuilds, (unsigned long long)f.swaps);
    /* Else a history would have left nothing behind. */
    assert_true(f.rebuilds > 0);
    assert_true(f.swaps > 0 || !must_swap);
    fixture_deinit(&f);
}

/* If this failed, what touches in a soup would depend on who looks, and how. */
CASE(golden__soup_has_the_same_bytes_under_all_settings)
{
    under_cover(PLAY_SOUP);
}

/* If this failed, an answer would depend on the hierarchy that a bursting sheet leaves
 * behind. */
CASE(golden__tear_has_the_same_bytes_under_all_settings)
{
    under_cover(PLAY_TEAR);
}

/* If this failed, an answer would depend on how objects are merged into one tree. */
CASE(golden__crowd_has_the_same_bytes_under_all_settings)
{
    under_cover(PLAY_CROWD);
}

/* If this failed, an object that breaks would leave something of its old mesh. */
CASE(golden__break_has_the_same_bytes_under_all_settings)
{
    under_cover(PLAY_BREAK);
}

/* If this failed, an object that came or went would change what others answer. */
CASE(golden__traffic_has_the_same_bytes_under_all_settings)
{
    under_cover(PLAY_TRAFFIC);
}

/* Combinations that make a difference: one thread has no scheduler, only the paper's has
 * high-level nodes, and wide trees have neither those nor a choice of refits. */
static bool is_a_combination(const struct row *row)
{
    bool by_paper = (enum eng_scheduler)row->level[SCHEDULER] == ENG_SCHEDULER_PAPER;
    bool is_alone = row->level[THREADS] == 0;
    bool is_wide = way_methods[row->level[METHOD]] == PCCD_METHOD_WIDE;
    return (by_paper || row->level[HIGH_LEVEL] == 0) &&
           (!is_wide || (row->level[HIGH_LEVEL] == 0 && row->level[REFIT] == 0)) &&
           (!is_alone || (!by_paper && row->level[REFIT] == 0));
}

/* The second step of the play, back and forward again under every combination of the
 * step's settings; modes and instruction sets take turns, from `turn` on. */
static void under_all_step_settings(struct fixture *f, struct row row, uint32_t turn)
{
    struct eng_scene_settings settings = scene_settings(&row);
    struct player player;
    uint32_t steps = 0;
    player_init(&player, &settings);
    for (uint32_t i = 0; steps < 2; i++) {
        if (f->play.acts[i].what == PLAY_STEP) {
            row.level[MODE] = PCCD_MODE_ALL;
            take_step(f, &row, steps++, &player);
        } else {
            player_act(&player, &f->play.acts[i]);
        }
    }
    for (uint32_t i = 0; i < 6 * WAY_METHODS * 2 * 2 * 2; i++) {
        row.level[THREADS] = i / 8 % 6;
        row.level[METHOD] = i / (8 * 6);
        row.level[SCHEDULER] = i / 4 % 2;
        row.level[HIGH_LEVEL] = i / 2 % 2;
        row.level[REFIT] = i % 2;
        if (is_a_combination(&row)) {
            struct eng_question back = step_settings(&row);
            row.level[MODE] = turn % 4;
            row.level[KERNELS] = turn / 4 % levels(KERNELS);
            turn++;
            player_go_back(&player, &back);
            player_stage_copies(&player);
            take_step(f, &row, 1, &player);
        }
    }
    player_deinit(&player);
}

/* If this failed, some combination of settings would have an answer of its own. */
CASE(golden__every_combination_has_the_same_bytes)
{
    struct fixture f = {0};
    fixture_init(&f, &golden_plays[PLAY_KINDS]);
    for (uint32_t i = 0; i < 3 * 3; i++) {
        struct row row = {{0}};
        row.level[RATIO] = i / 3;
        row.level[REGION] = i % 3;
        under_all_step_settings(&f, row, i);
    }
    fixture_deinit(&f);
}
