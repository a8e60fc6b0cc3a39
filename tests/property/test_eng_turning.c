/* test_eng_turning.c - pairs of features that turn, against an oracle that bounds them by
 * intervals: what is missed, invented or late, and how much nobody can tell.
 *
 * Motions are screws, pose to pose, rotation vectors and chains of up to 8 joints, of one
 * side or both, beside sides that deform; angles of 10^-7 to 2^20 turns, sizes of 2^-40
 * to 2^40; most pairs meet, some pass within 10^-12 of r, some touch.
 *
 * PCCD_TURNING_MOTIONS: so many are tried; 1e6 take a quarter of an hour.
 * PCCD_TURNING_SHOW: each of the recorded queries is told with its bracket.
 */
#include <jansson.h>

#include "cases.h"
#include "data.h"
#include "decide.h"
#include "turning_truth.h"

#define TOLERANCE 0x1p-20

struct trial {
    uint64_t seed;
    struct turning_drawn drawn;
    struct eng_path path;
    struct eng_poses poses;
    struct eng_turning_pair pair;
    struct eng_turning_limits limits;
    struct eng_turning_answer answer;
    enum eng_turning_verdict verdict;
};

#define FAMILIES 4

static struct {
    uint64_t pairs[FAMILIES], met[FAMILIES], possible[FAMILIES], limit[FAMILIES],
        unknown[FAMILIES];
    uint64_t looks, initial, wide;
} sums;

/* ---- the engine -------------------------------------------------------------------- */

static void decide(struct trial *trial, double t_end)
{
    struct turning_drawn *drawn = &trial->drawn;
    uint32_t all = drawn->points[0] + drawn->points[1];
    uint32_t side = drawn->link[0] == PCCD_NO_JOINT   ? 1
                    : drawn->link[1] == PCCD_NO_JOINT ? 0
                                                      : (uint32_t)(trial->seed / 7 % 2);
    trial->pair.kind = drawn->kind;
    trial->pair.turning = side;
    memcpy(trial->pair.x, drawn->x, sizeof drawn->x);
    for (uint32_t i = all; i < 4; i++) {
        for (int end = 0; end < 2; end++) {
            memcpy(trial->pair.x[end][i], drawn->x[end][all - 1], 3 * sizeof(double));
        }
    }
    memcpy(trial->pair.radius, drawn->radius, sizeof drawn->radius);
    trial->limits = (struct eng_turning_limits){.delta = 0x1p-20 * drawn->size,
                                                .tolerance = TOLERANCE,
                                                .t_end = t_end,
                                                .looks_max = ENG_TURNING_LOOKS_MAX};
    assert_ok(eng_path_between(drawn->joints, drawn->link[!side], drawn->link[side],
                               &trial->path));
    eng_poses_begin(&trial->poses, &trial->path);
    trial->verdict =
        eng_turning_decide(&trial->poses, &trial->pair, &trial->limits, &trial->answer);
}

/* ---- the truth --------------------------------------------------------------------- */

static struct turning_truth truth_of(const struct trial *trial, double from, double to,
                                     double more)
{
    return turning_truth(&trial->drawn, from, to, more, TOLERANCE / 4, 300);
}

static void fail_trial(const struct trial *trial, const struct turning_truth *is,
                       const char *what)
{
    const struct eng_hit *hit = &trial->answer.hit;
    fail_msg("PCCD_SEED=%llu PCCD_TURNING_MOTIONS=1: %s: kind %d, verdict %d, flags %u, "
             "%.17g .. %.17g, free until %.17g; the oracle: free until %.17g, met by "
             "%.17g",
             (unsigned long long)trial->seed, what, (int)trial->drawn.kind,
             (int)trial->verdict, hit->flags, hit->toi, hit->toi_hi,
             trial->answer.free_until, is->free_until, is->met_by);
}

/* Return what is wrong with param and normal of a hit; NULL: nothing. */
static const char *misplaced(const struct trial *trial)
{
    const struct turning_drawn *drawn = &trial->drawn;
    const struct eng_hit *hit = &trial->answer.hit;
    const double *w = (const double[2]){hit->param[0], hit->param[1]};
    long double square = 0, length = 0;
    long double x[4][3];
    for (uint32_t i = 0; i < drawn->points[0] + drawn->points[1]; i++) {
        turning_place(drawn, i, hit->toi, x[i]);
    }
    for (int k = 0; k < 3; k++) {
        long double at[2] = {x[0][k], x[1][k]};
        if (drawn->kind == PCCD_VF) {
            at[1] += w[0] * (x[2][k] - x[1][k]) + w[1] * (x[3][k] - x[1][k]);
        } else if (drawn->kind == PCCD_EE) {
            at[0] += w[0] * (x[1][k] - x[0][k]);
            at[1] = x[2][k] + w[1] * (x[3][k] - x[2][k]);
        } else if (drawn->kind == PCCD_VE) {
            at[1] += w[1] * (x[2][k] - x[1][k]);
        }
        square += (at[0] - at[1]) * (at[0] - at[1]);
        length += (long double)hit->normal[k] * hit->normal[k];
    }
    if (!(w[0] >= -1e-5 && w[1] >= -1e-5 && w[0] <= 1 + 1e-5 && w[1] <= 1 + 1e-5) ||
        (drawn->kind == PCCD_VF && w[0] + w[1] > 1 + 1e-5)) {
        return "param is outside of the features";
    }
    if (!(length == 0 || fabsl(sqrtl(length) - 1) <= 1e-5L)) {
        return "the normal is neither of unit length nor zero";
    }
    return sqrtl(square) <= turning_distance(drawn, hit->toi) + 1e-4L * drawn->size
               ? NULL
               : "param is not where the features are nearest";
}

/* Return whether at t = 0 it is within r by more than rounding may hide. */
static bool is_well_within(const struct trial *trial)
{
    const struct turning_drawn *drawn = &trial->drawn;
    double r = drawn->radius[0] + drawn->radius[1] + drawn->radius[2];
    return turning_distance(drawn, 0) < r - 0x1p-40 * drawn->size;
}

static void check_hit(const struct trial *trial, const struct turning_truth *is)
{
    const struct eng_hit *hit = &trial->answer.hit;
    bool is_proved = (hit->flags & PCCD_PROVED) != 0;
    const char *what = misplaced(trial);
    if (!(hit->toi >= 0 && hit->toi <= hit->toi_hi && hit->toi_hi <= 1)) {
        what = "the times are out of order";
    } else if (is->met_by < hit->toi) {
        what = "it meets before toi";
    } else if (is_proved && (is->is_free || is->free_until > hit->toi_hi)) {
        what = "invented: it is proved, and free until after toi_hi";
    } else if ((hit->flags & PCCD_INITIAL) != 0 &&
               (is->free_until > 0 || hit->toi_hi > 0 || !is_proved)) {
        what = "invented: it is initial, and free at first";
    } else if ((hit->flags & PCCD_INITIAL) == 0 && is->met_by == 0 &&
               is_well_within(trial)) {
        what = "it is not initial, and meets at once";
    } else if (hit->toi > 0 && truth_of(trial, hit->toi, hit->toi, 0).met_by <= 1) {
        what = "it is free before toi, and within r there";
    } else if (!is_proved && hit->toi_hi - hit->toi > TOLERANCE) {
        what = "what is possible is longer than the tolerance";
    } else if (!is_proved &&
               truth_of(trial, hit->toi, hit->toi_hi, 2 * trial->limits.delta).is_free) {
        what = "possible, and farther than 2 delta all the while";
    }
    if (what != NULL) {
        fail_trial(trial, is, what);
    }
    sums.initial += (hit->flags & PCCD_INITIAL) != 0;
    sums.wide += is_proved && hit->toi_hi - hit->toi > TOLERANCE;
}

static void check(struct trial *trial)
{
    uint32_t family = trial->drawn.family;
    double t_end = trial->limits.t_end;
    const struct turning_truth is = truth_of(trial, 0, 1, 0);
    bool meets = trial->verdict == ENG_TURNING_MEETS;
    if (trial->verdict == ENG_TURNING_FREE && is.met_by <= t_end) {
        fail_trial(trial, &is, "missed: it is free, and meets");
    }
    if (is.met_by < fmin(trial->answer.free_until, 1)) {
        fail_trial(trial, &is, "it meets where it is free");
    }
    assert_true(trial->verdict != ENG_TURNING_STOPPED);
    if (meets) {
        check_hit(trial, &is);
    }
    bool is_possible = meets && (trial->answer.hit.flags & PCCD_PROVED) == 0;
    sums.pairs[family]++;
    sums.met[family] += meets && !is_possible;
    sums.possible[family] += is_possible;
    sums.limit[family] += trial->verdict == ENG_TURNING_LIMIT;
    sums.unknown[family] +=
        !is.is_free && (is.met_by > 1 || is.met_by - is.free_until > TOLERANCE);
    sums.looks += trial->answer.looks;
}

static uint64_t wanted(void)
{
    const char *text = getenv("PCCD_TURNING_MOTIONS");
    return text ? (uint64_t)strtod(text, NULL) : 20000;
}

/* If it failed: something would pass through something unseen, or be stopped by what it
 * never meets; or too much would be left open. */
CASE(motions__meet_where_intervals_say)
{
    static const char *const names[FAMILIES] = {"any", "meeting", "near", "touching"};
    static struct trial trial;
    uint64_t most = wanted();
    for (uint64_t i = 0; i < most; i++) {
        struct prng prng = {prng_seed() + i};
        trial.seed = prng_seed() + i;
        turning_draw(&prng, &trial.drawn);
        bool is_part = prng_below(&prng, 8) == 0;
        decide(&trial, is_part ? prng_between(&prng, 0, 1) : 1);
        check(&trial);
    }
    for (int i = 0; i < FAMILIES; i++) {
        printf("# %s: %llu pairs, %llu meet, %llu possible, %llu at the limit; the "
               "oracle cannot tell %llu\n",
               names[i], (unsigned long long)sums.pairs[i],
               (unsigned long long)sums.met[i], (unsigned long long)sums.possible[i],
               (unsigned long long)sums.limit[i], (unsigned long long)sums.unknown[i]);
        /* Nearer than delta is possible, whoever decides. */
        bool is_near = i == TURNING_NEAR || i == TURNING_TOUCHES;
        assert_true(is_near ||
                    (double)sums.possible[i] <= 1 + 0.001 * (double)sums.pairs[i]);
    }
    printf("# %.1f looks a pair; %llu initial, %llu brackets begin with what is "
           "possible\n",
           (double)sums.looks / (double)most, (unsigned long long)sums.initial,
           (unsigned long long)sums.wide);
}

/* ---- recorded queries -------------------------------------------------------------- */

static void read_vector(const json_t *array, double x[3])
{
    assert_int_equal(json_array_size(array), 3);
    for (size_t k = 0; k < 3; k++) {
        x[k] = json_number_value(json_array_get(array, k));
    }
}

/* Two poses of a rotation vector: what goes straight, and what turns it. */
static void read_feature(const json_t *feature, uint32_t side,
                         struct turning_drawn *drawn)
{
    const json_t *points = json_object_get(feature, "points");
    struct pccd_joint *joints = &drawn->joints[2 * side];
    uint32_t begin = side == 0 ? 0 : drawn->points[0];
    drawn->link[side] = 2 * side + 1;
    assert_int_equal(json_array_size(points), drawn->points[side]);
    for (uint32_t i = 0; i < drawn->points[side]; i++) {
        read_vector(json_array_get(points, i), drawn->x[0][begin + i]);
        memcpy(drawn->x[1][begin + i], drawn->x[0][begin + i], 3 * sizeof(double));
    }
    for (uint32_t i = 0; i < 2; i++) {
        const char *what = i == 0 ? "position" : "rotation";
        const json_t *pose[2] = {json_object_get(feature, "pose0"),
                                 json_object_get(feature, "pose1")};
        joints[i] =
            (struct pccd_joint){.kind = i == 0 ? PCCD_JOINT_SHIFT : PCCD_JOINT_VECTOR,
                                .parent = i == 0 ? PCCD_NO_JOINT : 2 * side,
                                .rotation = {0, 0, 0, 1}};
        read_vector(json_object_get(pose[0], what), joints[i].from);
        read_vector(json_object_get(pose[1], what), joints[i].to);
    }
}

/* The largest extent of both features together, at t = 0. */
static double extent(const struct turning_drawn *drawn)
{
    long double x[4][3], most = 0;
    for (uint32_t i = 0; i < 4; i++) {
        turning_place(drawn, i, 0, x[i]);
        for (uint32_t n = 0; n < 3 * i; n++) {
            most = fmaxl(most, fabsl(x[i][n % 3] - x[n / 3][n % 3]));
        }
    }
    return (double)most;
}

static void read_query(const char *line, struct turning_drawn *drawn)
{
    json_t *query = json_loads(line, 0, NULL);
    const json_t *features = json_object_get(query, "features");
    assert_non_null(query);
    bool is_face = strcmp(json_string_value(json_object_get(query, "kind")), "fv") == 0;
    *drawn = (struct turning_drawn){.count = 4, .way = TURNING_VECTOR};
    drawn->kind = is_face ? PCCD_VF : PCCD_EE;
    drawn->points[0] = is_face ? 1 : 2;
    drawn->points[1] = 4 - drawn->points[0];
    for (uint32_t i = 0; i < 2; i++) {
        const json_t *feature = json_array_get(features, i);
        size_t count = json_array_size(json_object_get(feature, "points"));
        /* The vertex comes first here, wherever it is there. */
        uint32_t side = !is_face ? i : count == 1 ? 0 : 1;
        read_feature(feature, side, drawn);
    }
    drawn->size = extent(drawn);
    json_decref(query);
}

/* If it failed: what simulations of rigid bodies ask, turns of thousands of times among
 * it, would be decided wrongly. */
CASE(recorded_queries__are_decided_as_intervals_say)
{
    static const char *const verdicts[] = {"free", "meets", "limit", "stopped"};
    static struct trial trial;
    static char line[1 << 16];
    char path[DATA_PATH_MAX];
    uint64_t counts[3] = {0}, possible = 0, unknown = 0, count = 0;
    bool shows = getenv("PCCD_TURNING_SHOW") != NULL;
    if (!data_find("turning-queries/queries.jsonl", path)) {
        test_skip("no recorded queries of features that turn in $PCCD_DATA");
    }
    FILE *file = fopen(path, "re");
    assert_non_null(file);
    memset(&sums, 0, sizeof sums);
    while (fgets(line, sizeof line, file) != NULL) {
        read_query(line, &trial.drawn);
        trial.seed = count++;
        decide(&trial, 1);
        check(&trial);
        bool meets = trial.verdict == ENG_TURNING_MEETS;
        bool is_proved = (trial.answer.hit.flags & PCCD_PROVED) != 0;
        counts[trial.verdict]++;
        possible += meets && !is_proved;
        if (shows) {
            printf("# %llu: %s", (unsigned long long)count, verdicts[trial.verdict]);
            printf(meets ? ", %s, %.17g .. %.17g\n" : "\n",
                   is_proved ? "proved" : "possible", trial.answer.hit.toi,
                   trial.answer.hit.toi_hi);
        }
    }
    fclose(file);
    unknown = sums.unknown[TURNING_ANY];
    printf("# %llu queries: %llu free, %llu meet, %llu of them possible, %llu at the "
           "limit; the oracle cannot tell %llu\n",
           (unsigned long long)count, (unsigned long long)counts[0],
           (unsigned long long)counts[1], (unsigned long long)possible,
           (unsigned long long)counts[2], (unsigned long long)unknown);
    assert_int_equal(count, 269);
}
