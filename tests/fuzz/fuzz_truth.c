/* fuzz_truth.c - an answer to an elementary test is compared with the true one. */
#include "fuzz_truth.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "fuzz_spans.h"
#include "oracle.h"

/* Spans that ranges look at before exact arithmetic is asked. */
#define WORK_DOUBLE 48
#define WORK_LONG   8

/* Answers of which the oracle judges one, in some 50 us: how early its bracket begins. */
#define NARROWED 16

/* Share of the extent: a parameter that is off by more names another place. */
#define PLACE_OFF_MAX 1e-4

/* Faces and pairs of edges that are nearer to one line than this, |b x c| of the square
 * of the longer: the normal alone would not tell a place there. Counted apart. */
#define NEARLY_A_LINE 0x1p-26

/* As oracle wants the points. */
static void points_of(const struct eng_query *query, double p[8][3])
{
    memcpy(p, query->x, sizeof query->x);
}

static enum oracle_kind kind_of(const struct eng_query *query)
{
    return query->kind == PCCD_VF ? ORACLE_VF : ORACLE_EE;
}

/* *early: as for fuzz_judge if it is 0. */
static enum fuzz_judgement judge_exactly(const struct eng_query *query,
                                         const struct eng_hit *hit, double *early)
{
    double p[8][3];
    enum fuzz_judgement judgement = FUZZ_RIGHT;
    points_of(query, p);
    struct oracle_first *first = oracle_first_new(kind_of(query), (const double(*)[3])p);
    if (!first) {
        return FUZZ_INVENTED;
    }
    if (oracle_first_compare(first, hit->toi) < 0) {
        judgement = FUZZ_LATE;
    } else if (oracle_first_compare(first, hit->toi_hi) > 0) {
        judgement = FUZZ_EARLY;
    } else if (*early >= 0) {
        mpq_t lo;
        mpq_t hi;
        mpq_inits(lo, hi, NULL);
        oracle_first_bracket(first, 60, lo, hi);
        *early = mpq_get_d(hi) - hit->toi;
        mpq_clears(lo, hi, NULL);
    }
    oracle_first_free(first);
    return judgement;
}

/* Largest distance along an axis that any two points have or travel. */
static double extent(const struct eng_query *query)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double lo = query->x[0][0][k];
        double hi = lo;
        for (int i = 1; i < 8; i++) {
            lo = fmin(lo, query->x[i / 4][i % 4][k]);
            hi = fmax(hi, query->x[i / 4][i % 4][k]);
        }
        most = fmax(most, hi - lo);
    }
    return most;
}

static bool is_nearly_a_line(const struct eng_query *query, double t)
{
    bool is_vf = query->kind == PCCD_VF;
    double b[3];
    double c[3];
    double n2 = 0;
    double b2 = 0;
    double c2 = 0;
    for (int k = 0; k < 3; k++) { /* differences of the ends: nearly exact far away */
        b[k] = (1 - t) * (query->x[0][is_vf ? 2 : 1][k] - query->x[0][is_vf ? 1 : 0][k]) +
               t * (query->x[1][is_vf ? 2 : 1][k] - query->x[1][is_vf ? 1 : 0][k]);
        c[k] = (1 - t) * (query->x[0][is_vf ? 3 : 2][k] - query->x[0][is_vf ? 1 : 3][k]) +
               t * (query->x[1][is_vf ? 3 : 2][k] - query->x[1][is_vf ? 1 : 3][k]);
        b2 += b[k] * b[k];
        c2 += c[k] * c[k];
    }
    for (int k = 0; k < 3; k++) {
        double n = b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3];
        n2 += n * n;
    }
    double longer2 = fmax(b2, c2);
    return n2 <= NEARLY_A_LINE * NEARLY_A_LINE * longer2 * longer2;
}

/* Return whether the parameters name the same place on both features. The contact is
 * somewhere in the bracket, during which nothing moves further than its share of the
 * extent. Floats allow 2^-23; where edges are nearly parallel, parameters are worse than
 * that. */
static bool is_one_place(const struct eng_query *query, const struct eng_hit *hit,
                         struct fuzz_tally *tally)
{
    double u = (double)hit->param[0];
    double v = (double)hit->param[1];
    double t = 0.5 * (hit->toi + hit->toi_hi);
    bool is_vf = query->kind == PCCD_VF;
    double size = 0;
    double off = 0;
    if (!(u >= 0 && v >= 0 && (is_vf ? u + v <= 1 + 0x1p-22 : u <= 1 && v <= 1))) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        double x[4];
        for (int i = 0; i < 4; i++) {
            x[i] = (1 - t) * query->x[0][i][k] + t * query->x[1][i][k];
            size = fmax(size, fabs(x[i]));
        }
        double first = is_vf ? x[0] : x[0] + u * (x[1] - x[0]);
        double second = is_vf ? x[1] + u * (x[2] - x[1]) + v * (x[3] - x[1])
                              : x[2] + v * (x[3] - x[2]);
        off = fmax(off, fabs(first - second));
    }
    double whole = extent(query);
    off -= 4 * (hit->toi_hi - hit->toi) * whole + 8 * size * DBL_EPSILON;
    bool is_line = is_nearly_a_line(query, t);
    double *most = is_line ? &tally->line_place_max : &tally->place_max;
    if (off > whole * *most) {
        *most = off / whole;
    }
    return off <= PLACE_OFF_MAX * whole;
}

/* Return whether a contact has what every one has (step.h). */
static bool is_formed(const struct eng_query *query, const struct eng_hit *hit,
                      double tolerance, struct fuzz_tally *tally)
{
    double p[8][3];
    double length2 = 0;
    for (int k = 0; k < 3; k++) {
        length2 += (double)hit->normal[k] * (double)hit->normal[k];
    }
    bool good = (hit->flags & PCCD_PROVED) &&
                !(hit->flags & ~(uint32_t)(PCCD_PROVED | PCCD_INITIAL)) &&
                0 <= hit->toi && hit->toi <= hit->toi_hi && hit->toi_hi <= 1 &&
                hit->toi_hi - hit->toi <= tolerance &&
                (length2 == 0 || fabs(length2 - 1) < 1e-6) &&
                is_one_place(query, hit, tally);
    if (!good || (hit->toi > 0 && !(hit->flags & PCCD_INITIAL))) {
        return good; /* a contact at the start would be before toi: judged elsewhere */
    }
    points_of(query, p);
    return oracle_touching_at(kind_of(query), (const double(*)[3])p, 0) ==
           ((hit->flags & PCCD_INITIAL) != 0);
}

const char *fuzz_judgement_text(enum fuzz_judgement judgement)
{
    static const char *const texts[] = {"right", "missed",    "invented",
                                        "late",  "too early", "misformed"};
    return texts[judgement];
}

/* Return whether there is certainly no contact before `end`. */
static bool is_clear(const struct eng_query *query, double end)
{
    double from = fuzz_clear_until_double(query, 0, end, WORK_DOUBLE);
    return from == end || fuzz_clear_until_long(query, from, end, WORK_LONG) == end;
}

/* Return whether the first contact is certainly in the bracket. */
static bool is_bracketed(const struct eng_query *query, const struct eng_hit *hit,
                         double *early)
{
    return hit->toi < hit->toi_hi &&
           (fuzz_is_crossing_double(query, hit->toi, hit->toi_hi, early) ||
            fuzz_is_crossing_long(query, hit->toi, hit->toi_hi, early)) &&
           (hit->toi == 0 || is_clear(query, hit->toi));
}

/* Small ones times a power of two, exactly: ranges are made for numbers about 1. No
 * coordinate becomes larger than 2^60; one that all points share may be far larger than
 * their extent. */
static void enlarge(struct eng_query *query)
{
    double *x = &query->x[0][0][0];
    double most = 0;
    int exponent;
    int most_exponent;
    double size = extent(query);
    for (int i = 0; i < 24; i++) {
        most = fmax(most, fabs(x[i]));
    }
    frexp(size, &exponent);
    frexp(most, &most_exponent);
    int by = -exponent < 60 - most_exponent ? -exponent : 60 - most_exponent;
    if (size == 0 || exponent >= -8 || by <= 0) {
        return;
    }
    for (int i = 0; i < 24; i++) {
        x[i] = ldexp(x[i], by);
    }
}

enum fuzz_judgement fuzz_judge(const struct eng_query *given, const struct eng_hit *hit,
                               double tolerance, struct fuzz_tally *tally, double *early)
{
    double p[8][3];
    struct eng_query enlarged = *given;
    const struct eng_query *query = &enlarged;
    enlarge(&enlarged);
    *early = 0;
    if (!hit) {
        if (fuzz_is_apart(query) || is_clear(query, 1)) {
            tally->ranges++;
            return FUZZ_RIGHT;
        }
        tally->exact++;
        points_of(query, p);
        return oracle_hits(kind_of(query), (const double(*)[3])p) ? FUZZ_MISSED
                                                                  : FUZZ_RIGHT;
    }
    enum fuzz_judgement judgement = FUZZ_RIGHT;
    if (is_bracketed(query, hit, early)) {
        tally->ranges++;
    } else {
        tally->exact++;
        *early = tally->exact % NARROWED == 0 ? 0 : -1;
        judgement = judge_exactly(query, hit, early);
    }
    if (judgement == FUZZ_RIGHT && !is_formed(query, hit, tolerance, tally)) {
        judgement = FUZZ_MISFORMED;
    }
    return judgement;
}
