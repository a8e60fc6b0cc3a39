/* fuzz_distance.c - exact distances of the engine against those of the oracle. */
#include "fuzz_distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_distance.h"
#include "oracle_near.h"

#define FAILURES_MAX 10

/* One case in so many is decided once more, by a later stage alone. */
#define EXTRA_STAGE 4u

static const char *const names[FUZZ_DISTANCE_FAMILIES] = {
    "random", "needle",   "parallel",   "foot",  "coincident", "far",
    "powers", "denormal", "degenerate", "known", "grid",       "slender"};

const char *fuzz_distance_name(enum fuzz_distance_family family)
{
    return names[family];
}

/* -bound .. bound */
static double integer(struct prng *prng, uint64_t bound)
{
    return (double)prng_below(prng, 2 * bound + 1) - (double)bound;
}

static void make_integers(struct prng *prng, uint64_t bound, double x[5][3])
{
    for (int i = 0; i < 15; i++) {
        x[i / 3][i % 3] = integer(prng, bound);
    }
}

static void make_random(struct prng *prng, double x[5][3])
{
    double apart = ldexp(1, 2 - (int)prng_below(prng, 30));
    for (int i = 0; i < 15; i++) {
        x[i / 3][i % 3] = prng_between(prng, -1, 1);
        if (i < 3) {
            x[0][i] *= apart; /* near the others' middle, or not */
        }
    }
}

/* x[to] on the line of x[from] and x[on], but for `width`. */
static void put_near_line(struct prng *prng, double x[5][3], int to, int from, int on,
                          double width)
{
    double share = prng_between(prng, -1, 2);
    for (int k = 0; k < 3; k++) {
        x[to][k] = x[from][k] + share * (x[on][k] - x[from][k]) +
                   width * prng_between(prng, -1, 1);
    }
}

static void make_needle(struct prng *prng, uint64_t bits, double x[5][3])
{
    double width = ldexp(1, -(int)prng_below(prng, bits));
    make_random(prng, x);
    put_near_line(prng, x, 3, 1, 2, width);
    put_near_line(prng, x, 4, 2, 3, width);
    if (prng_below(prng, 2)) {
        put_near_line(prng, x, 0, 1, 2, width);
    } else { /* edges 0 1 and 2 3 are nearly parallel */
        for (int k = 0; k < 3; k++) {
            x[3][k] =
                x[2][k] + 1.5 * (x[1][k] - x[0][k]) + width * prng_between(prng, -1, 1);
        }
    }
}

static void make_parallel(struct prng *prng, double x[5][3])
{
    make_integers(prng, 9, x);
    double share = integer(prng, 4) / 2;
    for (int k = 0; k < 3; k++) {
        x[3][k] = x[2][k] + share * (x[1][k] - x[0][k]);
        x[4][k] = x[2][k] + 2 * (x[1][k] - x[0][k]);
    }
}

/* Four or five points with the foot of x[0] on the edge of x[1] and x[2], or of x[2] and
 * x[3], exactly; x[1] is then beyond x[0]'s foot for the sake of crossings. */
static void make_foot(struct prng *prng, double x[5][3])
{
    make_integers(prng, 9, x);
    int from = 1 + (int)prng_below(prng, 2);
    double share = (double)prng_below(prng, 9) / 8;
    double e[3];
    for (int k = 0; k < 3; k++) {
        e[k] = x[from + 1][k] - x[from][k];
    }
    double away[3] = {e[1] * x[4][2] - e[2] * x[4][1], e[2] * x[4][0] - e[0] * x[4][2],
                      e[0] * x[4][1] - e[1] * x[4][0]};
    double scale = ldexp(1, -(int)prng_below(prng, 12));
    for (int k = 0; k < 3; k++) {
        double foot = x[from][k] + share * e[k];
        x[0][k] = foot + scale * away[k];
        if (from == 2 && prng_below(prng, 2) == 0) {
            x[1][k] = foot - scale * away[k];
        }
    }
}

static void make_coincident(struct prng *prng, double x[5][3])
{
    make_random(prng, x);
    for (uint64_t i = 1 + prng_below(prng, 3); i > 0; i--) {
        memcpy(x[prng_below(prng, 5)], x[prng_below(prng, 5)], sizeof x[0]);
    }
}

static void make_far(struct prng *prng, double x[5][3])
{
    double ulp = prng_below(prng, 2) ? 128 : 4096 * 1024;
    double base[3];
    for (int k = 0; k < 3; k++) {
        base[k] = prng_between(prng, -0.99e18, 0.99e18);
    }
    for (int i = 0; i < 15; i++) {
        x[i / 3][i % 3] = base[i % 3] + ulp * integer(prng, 50);
        if (prng_below(prng, 40) == 0) {
            x[i / 3][i % 3] = integer(prng, 1) * 1e18;
        }
    }
}

static void make_powers(struct prng *prng, double x[5][3])
{
    int least = prng_below(prng, 3) ? -1074 : -300;
    bool is_small = prng_below(prng, 2);
    bool is_mixed = prng_below(prng, 2);
    uint64_t span = (uint64_t)(59 - least);
    for (int i = 0; i < 15; i++) {
        uint64_t above = is_mixed ? prng_below(prng, 2) * span : prng_below(prng, span);
        double mantissa = is_small ? integer(prng, 4) / 8 : prng_between(prng, -1, 1);
        x[i / 3][i % 3] = ldexp(mantissa, least + (int)above);
        if (prng_below(prng, 5) == 0) {
            x[i / 3][i % 3] = x[prng_below(prng, 5)][i % 3]; /* or not yet made: 0 */
        }
    }
}

static void make_denormal(struct prng *prng, double x[5][3])
{
    make_integers(prng, prng_below(prng, 2) ? 5 : 1 << 20, x);
    for (int i = 0; i < 15; i++) {
        x[i / 3][i % 3] = ldexp(x[i / 3][i % 3], -1074);
    }
}

static void make_degenerate(struct prng *prng, double x[5][3])
{
    make_integers(prng, 6, x);
    for (int i = 1; i < 4; i += 2) { /* of triangles 1 2 3 and 2 3 4 */
        double share = integer(prng, 4) / 2;
        for (int k = 0; k < 3; k++) {
            x[i == 1 ? 3 : 4][k] = x[2][k] + share * (x[i == 1 ? 1 : 3][k] - x[2][k]);
        }
    }
    if (prng_below(prng, 3) == 0) {
        memcpy(x[1], x[0], sizeof x[0]);
    }
    if (prng_below(prng, 3) == 0) {
        memcpy(x[3], x[2], sizeof x[0]);
    }
}

/* Features in two planes across (2, 3, 6), which is 7 long. */
static void make_known(struct prng *prng, struct fuzz_distance_case *made)
{
    static const double across[3][3] = {{3, -2, 0}, {6, 2, -3}, {3, -6, 2}};
    static const double normal[3] = {2, 3, 6};
    double height = (double)prng_below(prng, 4);
    double unit = ldexp(1, 20 - (int)prng_below(prng, 40));
    for (int i = 0; i < 5; i++) {
        double a = integer(prng, 6);
        double b = integer(prng, 6);
        int other = 1 + (int)prng_below(prng, 2);
        bool is_up = made->kind == PCCD_VF ? i == 0 : i < 2;
        for (int k = 0; k < 3; k++) {
            made->x[i][k] = unit * (a * across[0][k] + b * across[other][k] +
                                    (is_up ? height * normal[k] : 0));
        }
    }
    made->d = unit * 7 * height;
}

/* All coordinates with a power of two, and now and then moved by one unit. */
static void vary(struct prng *prng, struct fuzz_distance_case *made)
{
    bool fits = made->family != FUZZ_DISTANCE_FAR &&
                made->family != FUZZ_DISTANCE_POWERS &&
                made->family != FUZZ_DISTANCE_DENORMAL;
    int exponent =
        fits && prng_below(prng, 4) == 0 ? 20 - (int)prng_below(prng, 1100) : 0;
    uint64_t nudged = prng_below(prng, 4) == 0 ? prng_below(prng, 15) : 15;
    for (uint64_t i = 0; i < 15; i++) {
        double *x = &made->x[i / 3][i % 3];
        *x = ldexp(*x, exponent);
        *x = i == nudged ? nextafter(*x, prng_below(prng, 2) ? 1e18 : -1e18) : *x;
    }
    made->d = ldexp(made->d, exponent);
}

enum fuzz_distance_family fuzz_distance_family_some(struct prng *prng)
{
    return (enum fuzz_distance_family)prng_below(prng, FUZZ_DISTANCE_FAMILIES);
}

void fuzz_distance_make(struct prng *prng, enum fuzz_distance_family family,
                        enum pccd_kind kind, struct fuzz_distance_case *made)
{
    memset(made, 0, sizeof *made);
    made->family = family;
    made->kind = kind;
    made->d = -1;
    switch (made->family) {
    case FUZZ_DISTANCE_NEEDLE:
        make_needle(prng, 54, made->x);
        break;
    case FUZZ_DISTANCE_SLENDER:
        make_needle(prng, 8, made->x);
        break;
    case FUZZ_DISTANCE_PARALLEL:
        make_parallel(prng, made->x);
        break;
    case FUZZ_DISTANCE_FOOT:
        make_foot(prng, made->x);
        break;
    case FUZZ_DISTANCE_COINCIDENT:
        make_coincident(prng, made->x);
        break;
    case FUZZ_DISTANCE_FAR:
        make_far(prng, made->x);
        break;
    case FUZZ_DISTANCE_POWERS:
        make_powers(prng, made->x);
        break;
    case FUZZ_DISTANCE_DENORMAL:
        make_denormal(prng, made->x);
        break;
    case FUZZ_DISTANCE_DEGENERATE:
        make_degenerate(prng, made->x);
        break;
    case FUZZ_DISTANCE_KNOWN:
        make_known(prng, made);
        break;
    case FUZZ_DISTANCE_GRID:
        make_integers(prng, 1 + prng_below(prng, 4), made->x);
        break;
    default:
        make_random(prng, made->x);
        break;
    }
    vary(prng, made);
    for (uint8_t i = 0; i < 4; i++) {
        uint64_t at = prng_below(prng, i + 1u);
        made->rank[i] = made->rank[at];
        made->rank[at] = i;
    }
}

void fuzz_distance_init(struct fuzz_distance_run *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    if (eng_distances_init(&run->distances) != PCCD_OK) {
        abort();
    }
}

void fuzz_distance_deinit(struct fuzz_distance_run *run)
{
    eng_distances_deinit(&run->distances);
}

const char *fuzz_distance_differ(const struct eng_distance *got,
                                 const struct oracle_distance *due)
{
    if ((int)got->type != (int)due->type) {
        return "type";
    }
    if (got->points != due->points) {
        return "points";
    }
    if (memcmp(&got->lo, &due->lo, sizeof got->lo) != 0 ||
        memcmp(&got->hi, &due->hi, sizeof got->hi) != 0) {
        return "bracket";
    }
    if (memcmp(got->param, due->param, sizeof got->param) != 0) {
        return "param";
    }
    return memcmp(got->direction, due->direction, sizeof got->direction) != 0
               ? "direction"
               : NULL;
}

/* Truth of a case, by the oracle. */
struct truth {
    struct oracle_distance due;
    bool is_within; /* d, if there is one */
    bool crosses;
    bool is_on; /* x[0] is on the tetrahedron of the other four */
    int64_t winding;
};

/* Every edge is run through in both directions. */
static const uint32_t tetrahedron[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

static void find_truth(const struct fuzz_distance_case *made, struct truth *truth)
{
    const double(*x)[3] = made->x;
    enum oracle_kind kind = (enum oracle_kind)made->kind;
    oracle_distance_find(kind, x, made->rank, &truth->due);
    truth->crosses = oracle_crosses(x);
    truth->is_on = !oracle_winding(x[0], x + 1, tetrahedron, 4, &truth->winding);
}

/* Once d is chosen; between the ends of the bracket the oracle is asked again. */
static void find_whether_within(const struct fuzz_distance_case *made,
                                struct truth *truth)
{
    const struct oracle_distance *due = &truth->due;
    truth->is_within =
        made->d >= due->hi ||
        (made->d > due->lo &&
         oracle_distance_within((enum oracle_kind)made->kind, made->x, made->d));
}

static bool is_winding_wrong(struct fuzz_distance_run *run,
                             const struct fuzz_distance_case *made,
                             const struct truth *truth)
{
    int64_t winding = 0;
    for (int i = 0; i < 4; i++) {
        double face[3][3];
        for (int corner = 0; corner < 3; corner++) {
            memcpy(face[corner], made->x[1 + tetrahedron[i][corner]], sizeof face[0]);
        }
        enum eng_sign sign =
            eng_winding(&run->distances.numbers, made->x[0], (const double(*)[3])face);
        if (sign == ENG_UNSURE) {
            return !truth->is_on;
        }
        winding += (int64_t)sign;
    }
    return !truth->is_on && winding != truth->winding;
}

/* Judge the engine's distance, found by stage `first` or a later one, which is
 * counted. */
static const char *judge_distance(struct fuzz_distance_run *run,
                                  const struct fuzz_distance_case *made,
                                  const struct truth *truth)
{
    struct eng_distance got;
    uint64_t before[ENG_DISTANCE_STAGES];
    memcpy(before, run->distances.decided, sizeof before);
    eng_distance_find(&run->distances, made->kind, made->x, made->rank, &got);
    for (int i = 0;
         i < ENG_DISTANCE_STAGES && run->distances.first == ENG_DISTANCE_BY_DOUBLES;
         i++) {
        run->stages[made->family][i] += run->distances.decided[i] - before[i];
    }
    return fuzz_distance_differ(&got, &truth->due);
}

static const char *judge(struct fuzz_distance_run *run,
                         const struct fuzz_distance_case *made,
                         enum eng_distance_stage first, const struct truth *truth)
{
    const double(*x)[3] = made->x;
    const struct oracle_distance *due = &truth->due;
    run->distances.first = first;
    const char *what = judge_distance(run, made, truth);
    /* The bracket says which of these are within. */
    double inner = due->lo < due->hi ? due->lo : nextafter(due->lo, -1);
    if (inner >= 0 && inner <= 1e18 &&
        eng_distance_within(&run->distances, made->kind, x, inner)) {
        what = "within less than the distance";
    }
    if (due->hi <= 1e18 &&
        !eng_distance_within(&run->distances, made->kind, x, due->hi)) {
        what = "not within the distance";
    }
    if (made->d >= 0 && eng_distance_within(&run->distances, made->kind, x, made->d) !=
                            truth->is_within) {
        what = "within d";
    }
    if (eng_distance_crosses(&run->distances, x) != truth->crosses) {
        what = "crosses";
    }
    if (truth->crosses &&
        eng_distance_crossing(&run->distances, x) != oracle_crossing(x)) {
        what = "where it crosses";
    }
    return what;
}

const char *fuzz_distance_judge(struct fuzz_distance_run *run,
                                const struct fuzz_distance_case *made,
                                enum eng_distance_stage first)
{
    struct truth truth;
    find_truth(made, &truth);
    find_whether_within(made, &truth);
    const char *what = judge(run, made, first, &truth);
    return what == NULL && is_winding_wrong(run, made, &truth) ? "winding" : what;
}

static void print_case(FILE *log, const struct fuzz_distance_case *made,
                       enum eng_distance_stage first, const char *what)
{
    fprintf(log, "# wrong: %s, from stage %d on, family %s\n%s d %a ranks %d %d %d %d\n",
            what, (int)first, names[made->family], made->kind == PCCD_VF ? "vf" : "ee",
            made->d, made->rank[0], made->rank[1], made->rank[2], made->rank[3]);
    for (int i = 0; i < 5; i++) {
        fprintf(log, "    {%a, %a, %a},\n", made->x[i][0], made->x[i][1], made->x[i][2]);
    }
}

static void fail(struct fuzz_distance_run *run, const struct fuzz_distance_case *made,
                 int first, const char *what)
{
    run->failures++;
    print_case(run->log, made, (enum eng_distance_stage)first, what);
}

static void run_case(struct fuzz_distance_run *run, struct fuzz_distance_case *made)
{
    struct truth truth;
    find_truth(made, &truth);
    if (made->d < 0 && prng_below(&run->prng, 2)) { /* near the distance */
        made->d = fmin(1e18, truth.due.hi * (1 + integer(&run->prng, 4) * 0x1p-34));
    }
    find_whether_within(made, &truth);
    int extra = prng_below(&run->prng, EXTRA_STAGE) == 0
                    ? 1 + (int)prng_below(&run->prng, ENG_DISTANCE_STAGES - 1)
                    : 0;
    for (int first = 0; first < ENG_DISTANCE_STAGES; first++) {
        if (!run->all_stages && first != 0 && first != extra) {
            continue;
        }
        const char *what = judge(run, made, (enum eng_distance_stage)first, &truth);
        if (what) {
            fail(run, made, first, what);
        }
    }
    if (is_winding_wrong(run, made, &truth)) {
        fail(run, made, 0, "winding");
    }
    run->cases++;
    run->family_cases[made->family]++;
    run->types[truth.due.type]++;
    run->within += made->d >= 0 && truth.due.hi <= made->d;
    run->crossings += truth.crosses;
    run->inside += !truth.is_on && truth.winding != 0;
    run->on_surface += truth.is_on;
}

void fuzz_distance_more(struct fuzz_distance_run *run, uint64_t count)
{
    for (uint64_t i = 0; i < count && run->failures < FAILURES_MAX; i++) {
        struct fuzz_distance_case made;
        enum fuzz_distance_family family = fuzz_distance_family_some(&run->prng);
        fuzz_distance_make(&run->prng, family, i % 2 ? PCCD_VF : PCCD_EE, &made);
        run_case(run, &made);
    }
}
