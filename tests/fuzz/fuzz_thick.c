/* fuzz_thick.c - the engine's test of thick features against the oracle's. */
#include "fuzz_thick.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_distance.h"
#include "oracle_thick.h"

#define FAILURES_MAX 10

static const char *const names[FUZZ_THICK_FAMILIES] = {
    "random", "grid",     "tangent", "minimum",    "throughout",
    "sliver", "collapse", "shrink",  "degenerate", "flat",
    "inside", "zero",     "far",     "powers",     "denormal"};

const char *fuzz_thick_name(enum fuzz_thick_family family)
{
    return names[family];
}

void fuzz_thick_init(struct fuzz_thick_run *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    run->oracle_each = 1;
    if (eng_thick_init(&run->thick) != PCCD_OK ||
        eng_exact_init(&run->contacts) != PCCD_OK) {
        abort();
    }
}

void fuzz_thick_deinit(struct fuzz_thick_run *run)
{
    eng_thick_deinit(&run->thick);
    eng_exact_deinit(&run->contacts);
}

struct fuzz_thick_truth fuzz_thick_truth_of(const struct fuzz_thick_case *made)
{
    const struct oracle_thick thick = {
        .points_a = fuzz_thick_points(made, 0),
        .points_b = fuzz_thick_points(made, 1),
        .p = (const double(*)[3])made->query.query.x,
        .radius = {made->query.radius[0], made->query.radius[1], made->query.radius[2]},
        .approach = made->query.approach};
    return (struct fuzz_thick_truth){oracle_thick_is_inside(&thick),
                                     oracle_thick_first_new(&thick)};
}

static bool is_contact(const struct fuzz_thick_case *made)
{
    uint32_t kind = (uint32_t)made->query.query.kind;
    const double *r = made->query.radius;
    return r[0] + r[1] + r[2] == 0 && (kind == PCCD_VF || kind == PCCD_EE);
}

const char *fuzz_thick_judge_hit(const struct fuzz_thick_case *made,
                                 const struct fuzz_thick_truth *truth,
                                 const struct eng_hit *hit)
{
    if (!hit) {
        return truth->first ? "missed" : NULL;
    }
    bool is_inside = made->query.approach > 0 && truth->is_inside;
    if (((hit->flags & PCCD_INSIDE) != 0) != is_inside && !is_contact(made)) {
        return "INSIDE";
    }
    if (truth->first && oracle_first_compare(truth->first, hit->toi) < 0) {
        return "toi is late";
    }
    if ((hit->flags & PCCD_PROVED) == 0) {
        return "not proved";
    }
    if (!truth->first) {
        return "invented";
    }
    bool is_initial = oracle_first_compare(truth->first, 0) == 0;
    if (((hit->flags & PCCD_INITIAL) != 0) != is_initial) {
        return "INITIAL";
    }
    int side = oracle_first_compare(truth->first, hit->toi_hi);
    if (side > 0 || !(hit->toi_hi - hit->toi <= made->tolerance)) {
        return "toi_hi";
    }
    if (!is_contact(made) && !is_initial && side == 0 && hit->toi_hi < 1) {
        return "the cell before that of the first time";
    }
    double length = hypot(hypot((double)hit->normal[0], (double)hit->normal[1]),
                          (double)hit->normal[2]);
    return length != 0 && fabs(length - 1) > 1e-6 ? "normal" : NULL;
}

static const char *judge(struct fuzz_thick_run *run, const struct fuzz_thick_case *made,
                         enum eng_thick_stage first, const struct fuzz_thick_truth *truth,
                         struct eng_hit *hit)
{
    run->thick.first = first;
    memset(hit, 0, sizeof *hit);
    bool hits = eng_thick_solve(&run->thick, &run->contacts, &made->query,
                                made->tolerance, 1, hit);
    const char *what = fuzz_thick_judge_hit(made, truth, hits ? hit : NULL);
    if (what || !hits) {
        return what;
    }
    /* Asked only for what begins until some time, it says the same or nothing. */
    struct eng_hit same;
    double t_end = prng_below(&run->prng, 2) ? hit->toi : nextafter(hit->toi, -1);
    if (t_end >= 0 &&
        eng_thick_solve(&run->thick, &run->contacts, &made->query, made->tolerance, t_end,
                        &same) != (hit->toi <= t_end)) {
        return "t_end";
    }
    return NULL;
}

bool fuzz_thick_same_hit(const struct eng_hit *a, const struct eng_hit *b)
{
    return a->flags == b->flags && memcmp(&a->toi, &b->toi, sizeof a->toi) == 0 &&
           memcmp(&a->toi_hi, &b->toi_hi, sizeof a->toi_hi) == 0 &&
           memcmp(a->param, b->param, sizeof a->param) == 0 &&
           memcmp(a->normal, b->normal, sizeof a->normal) == 0;
}

void fuzz_thick_print(FILE *log, const struct fuzz_thick_case *made,
                      const struct eng_hit *hit, const char *what)
{
    const struct eng_thick_query *query = &made->query;
    fprintf(log, "# wrong: %s, family %s; flags %u, %a .. %a\n", what,
            names[made->family], hit->flags, hit->toi, hit->toi_hi);
    fprintf(log, "%s tolerance %a r %a %a %a approach %a\n",
            common_kinds[(uint32_t)query->query.kind].name, made->tolerance,
            query->radius[0], query->radius[1], query->radius[2], query->approach);
    for (int i = 0; i < 8; i++) {
        const double *x = query->query.x[i / 4][i % 4];
        fprintf(log, "    {%a, %a, %a},\n", x[0], x[1], x[2]);
    }
}

/* Return whether no axis keeps the two farther apart than r, in one order at both
 * ends. */
static bool is_inseparable(const struct fuzz_thick_case *made)
{
    const double *radius = made->query.radius;
    double r = radius[0] + radius[1] + radius[2];
    int used = fuzz_thick_points(made, 0) + fuzz_thick_points(made, 1);
    for (int axis = 0; axis < 6; axis++) {
        double least = INFINITY;
        for (int n = 0; n < 2 * used * used; n++) {
            int i = n / 2 / used;
            int j = n / 2 % used;
            if (!fuzz_thick_is_of_b(made, i) && fuzz_thick_is_of_b(made, j)) {
                double gap = made->query.query.x[n % 2][i][axis / 2] -
                             made->query.query.x[n % 2][j][axis / 2];
                least = fmin(least, axis % 2 ? gap : -gap);
            }
        }
        if (least > r) {
            return false;
        }
    }
    return true;
}

static void fail(struct fuzz_thick_run *run, const struct fuzz_thick_case *made,
                 const struct eng_hit *hit, const char *what)
{
    run->failures++;
    fuzz_thick_print(run->log, made, hit, what);
}

/* By doubles first, then by integers alone; hits[i] has no flags where there is none. */
static void solve_both(struct fuzz_thick_run *run, const struct fuzz_thick_case *made,
                       bool found[ENG_THICK_STAGES],
                       struct eng_hit hits[ENG_THICK_STAGES])
{
    struct fuzz_thick_counts *counts = &run->counts[made->family];
    uint64_t by_integers = run->thick.decided[ENG_THICK_BY_INTEGERS];
    for (int i = 0; i < ENG_THICK_STAGES; i++) {
        memset(&hits[i], 0, sizeof hits[i]);
        run->thick.first = (enum eng_thick_stage)i;
        found[i] = eng_thick_solve(&run->thick, &run->contacts, &made->query,
                                   made->tolerance, 1, &hits[i]);
        if (i == 0) {
            counts->by_integers +=
                run->thick.decided[ENG_THICK_BY_INTEGERS] > by_integers;
        }
    }
}

/* Return whether what both find has the same bytes, and is proved. */
static bool agree(const bool found[ENG_THICK_STAGES],
                  const struct eng_hit hits[ENG_THICK_STAGES])
{
    return found[0] == found[1] &&
           (!found[0] || ((hits[0].flags & PCCD_PROVED) != 0 &&
                          fuzz_thick_same_hit(&hits[0], &hits[1])));
}

/* Return what is wrong with what the engine says of the distance just after t = 0. */
static const char *judge_trend(struct fuzz_thick_run *run,
                               const struct fuzz_thick_case *made)
{
    const uint32_t *points = common_kinds[(uint32_t)made->query.query.kind].points;
    const uint32_t last = points[0] + points[1] - 1;
    double p[8][3], radius[3] = {0, 0, 0};
    for (uint32_t i = 0; i < 8; i++) {
        uint32_t point = i % 4 < last ? i % 4 : last;
        memcpy(p[i], made->query.query.x[i / 4][point], sizeof p[i]);
    }
    const enum oracle_kind kind = points[0] == 1 ? ORACLE_VF : ORACLE_EE;
    int truth = oracle_distance_trend(kind, (const double(*)[3])p);
    bool touches = false;
    int trend = eng_thick_exact_trend(&run->thick.exact, &made->query, &touches);
    run->trends[1 + truth]++;
    run->touching += touches;
    if (touches != oracle_is_within(points[0], (const double(*)[3])p, radius, 0)) {
        return "whether they touch";
    }
    return trend == truth ? NULL : "whether the distance falls";
}

static void run_case(struct fuzz_thick_run *run, const struct fuzz_thick_case *made)
{
    struct fuzz_thick_counts *counts = &run->counts[made->family];
    bool found[ENG_THICK_STAGES];
    struct eng_hit hits[ENG_THICK_STAGES];
    solve_both(run, made, found, hits);
    if (!agree(found, hits)) {
        fail(run, made, &hits[0], "integers say otherwise");
        fuzz_thick_print(run->log, made, &hits[1], "this is what they say");
    }
    if (prng_below(&run->prng, run->oracle_each) == 0) {
        struct fuzz_thick_truth truth = fuzz_thick_truth_of(made);
        const char *untrue = judge_trend(run, made);
        if (untrue) {
            fail(run, made, &hits[0], untrue);
        }
        for (int i = 0; i < ENG_THICK_STAGES; i++) {
            const char *what =
                judge(run, made, (enum eng_thick_stage)i, &truth, &hits[i]);
            if (what) {
                fail(run, made, &hits[i], what);
            }
        }
        oracle_first_free(truth.first);
        run->judged++;
    }
    run->kinds[(uint32_t)made->query.query.kind]++;
    counts->cases++;
    counts->hits += found[0];
    counts->initial += found[0] && (hits[0].flags & PCCD_INITIAL) != 0;
    counts->inside += found[0] && (hits[0].flags & PCCD_INSIDE) != 0;
    counts->inseparable += is_inseparable(made);
}

void fuzz_thick_more(struct fuzz_thick_run *run, uint64_t count)
{
    for (uint64_t i = 0; i < count && run->failures < FAILURES_MAX; i++) {
        struct fuzz_thick_case made;
        fuzz_thick_make(&run->prng, run->least_kind, &made);
        run_case(run, &made);
    }
}

struct fuzz_thick_counts fuzz_thick_total(const struct fuzz_thick_run *run)
{
    struct fuzz_thick_counts total = {0};
    for (int i = 0; i < FUZZ_THICK_FAMILIES; i++) {
        const struct fuzz_thick_counts *own = &run->counts[i];
        total.cases += own->cases;
        total.hits += own->hits;
        total.initial += own->initial;
        total.inside += own->inside;
        total.inseparable += own->inseparable;
        total.by_integers += own->by_integers;
    }
    return total;
}
