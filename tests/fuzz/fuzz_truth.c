/* fuzz_truth.c - is an answer to an elementary test the true one?
 *
 * Room:     tests/fuzz.
 * Does:     see fuzz_truth.h.
 * Threads:  one for one tally.
 */
#include "fuzz_truth.h"

#include <string.h>

#include "fuzz_range.h"
#include "oracle.h"

/* Halvings of the step before exact arithmetic is asked. */
#define DEPTH_MAX 5

/* Halvings of a bracket to find how early it begins: 2^-50 of at most 1. */
#define HALVINGS 50

/* Of the extent: more is a parameter that names another place. */
#define PLACE_OFF_MAX 1e-4

/* p, b, c of query.h at a time, as ranges. */
struct place {
    struct range p[3];
    struct range b[3];
    struct range c[3];
};

static struct range point_at(const struct eng_query *query, int point, int k, double t)
{
    struct range rest = range_sub(range_of(1), range_of(t));
    return range_add(range_mul(rest, range_of(query->x[0][point][k])),
                     range_mul(range_of(t), range_of(query->x[1][point][k])));
}

/* Differences are taken of the ends, where they are nearly exact, and then moved. */
static struct range difference_at(const struct eng_query *query, int to, int from, int k,
                                  double t)
{
    struct range d0 =
        range_sub(range_of(query->x[0][to][k]), range_of(query->x[0][from][k]));
    struct range d1 =
        range_sub(range_of(query->x[1][to][k]), range_of(query->x[1][from][k]));
    struct range rest = range_sub(range_of(1), range_of(t));
    return range_add(range_mul(rest, d0), range_mul(range_of(t), d1));
}

static void place_at(const struct eng_query *query, double t, struct place *place)
{
    bool is_vf = query->kind == ENG_VF;
    for (int k = 0; k < 3; k++) {
        place->p[k] = difference_at(query, is_vf ? 0 : 2, is_vf ? 1 : 0, k, t);
        place->b[k] = difference_at(query, is_vf ? 2 : 1, is_vf ? 1 : 0, k, t);
        place->c[k] = difference_at(query, is_vf ? 3 : 2, is_vf ? 1 : 3, k, t);
    }
}

static void cross(const struct range a[3], const struct range b[3], struct range out[3])
{
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        out[k] = range_sub(range_mul(a[i], b[j]), range_mul(a[j], b[i]));
    }
}

static struct range dot(const struct range a[3], const struct range b[3])
{
    struct range sum = range_mul(a[0], b[0]);
    sum = range_add(sum, range_mul(a[1], b[1]));
    return range_add(sum, range_mul(a[2], b[2]));
}

static struct range volume(const struct range p[3], const struct range b[3],
                           const struct range c[3])
{
    struct range n[3];
    cross(b, c, n);
    return dot(p, n);
}

/* Coefficients of the cubic between two places, in Bernstein form; the middle ones
 * times 3. */
static void bernstein(const struct place *l, const struct place *r, struct range f[4])
{
    f[0] = volume(l->p, l->b, l->c);
    f[1] = range_add(range_add(volume(r->p, l->b, l->c), volume(l->p, r->b, l->c)),
                     volume(l->p, l->b, r->c));
    f[2] = range_add(range_add(volume(l->p, r->b, r->c), volume(r->p, l->b, r->c)),
                     volume(r->p, r->b, l->c));
    f[3] = volume(r->p, r->b, r->c);
}

/* 1: the features are certainly within each other's reach if they are coplanar, at every
 * time between the places; -1: certainly not; 0: not known. With n = b x c the conditions
 * are (p x c) . n >= 0, (b x p) . n >= 0, and what is left of n . n. */
static int domain(const struct eng_query *query, const struct place *l,
                  const struct place *r)
{
    struct place hull;
    struct range n[3];
    struct range m[3];
    for (int k = 0; k < 3; k++) {
        hull.p[k] = range_unite(l->p[k], r->p[k]);
        hull.b[k] = range_unite(l->b[k], r->b[k]);
        hull.c[k] = range_unite(l->c[k], r->c[k]);
    }
    cross(hull.b, hull.c, n);
    struct range nn = dot(n, n);
    cross(hull.p, hull.c, m);
    struct range beta = dot(m, n);
    cross(hull.b, hull.p, m);
    struct range gamma = dot(m, n);
    struct range rest[2];
    if (query->kind == ENG_VF) {
        rest[0] = rest[1] = range_sub(range_sub(nn, beta), gamma);
    } else {
        rest[0] = range_sub(nn, beta);
        rest[1] = range_sub(nn, gamma);
    }
    const int signs[4] = {range_sign(beta), range_sign(gamma), range_sign(rest[0]),
                          range_sign(rest[1])};
    int least = 1;
    for (int i = 0; i < 4; i++) {
        least = signs[i] < least ? signs[i] : least;
    }
    return least;
}

/* Is there an axis along which all points of one feature are before all of the other at
 * both times? */
static bool apart(const struct eng_query *query, double l, double r)
{
    int first_count = query->kind == ENG_VF ? 1 : 2;
    for (int k = 0; k < 3; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            bool all = true;
            for (int a = 0; a < first_count && all; a++) {
                for (int b = first_count; b < 4 && all; b++) {
                    all = range_sign(difference_at(query, b, a, k, l)) == sign &&
                          range_sign(difference_at(query, b, a, k, r)) == sign;
                }
            }
            if (all) {
                return true;
            }
        }
    }
    return false;
}

/* Certainly no contact from l to r? */
static bool is_clear(const struct eng_query *query, double l, double r, int depth)
{
    struct place at_l;
    struct place at_r;
    struct range f[4];
    place_at(query, l, &at_l);
    place_at(query, r, &at_r);
    bernstein(&at_l, &at_r, f);
    int sign = range_sign(f[0]);
    if (sign != 0 && range_sign(f[1]) == sign && range_sign(f[2]) == sign &&
        range_sign(f[3]) == sign) {
        return true;
    }
    if (domain(query, &at_l, &at_r) < 0 || apart(query, l, r)) {
        return true;
    }
    double m = 0.5 * (l + r);
    return depth > 0 && is_clear(query, l, m, depth - 1) &&
           is_clear(query, m, r, depth - 1);
}

static int sign_at(const struct eng_query *query, double t)
{
    struct place place;
    place_at(query, t, &place);
    return range_sign(volume(place.p, place.b, place.c));
}

/* Certainly the first contact is between toi and toi_hi? */
static bool is_bracketed(const struct eng_query *query, const struct eng_hit *hit,
                         double *early)
{
    struct place at_l;
    struct place at_r;
    double l = hit->toi;
    double r = hit->toi_hi;
    if (!(l < r)) {
        return false;
    }
    place_at(query, l, &at_l);
    place_at(query, r, &at_r);
    int sign = sign_at(query, l);
    if (sign == 0 || sign_at(query, r) != -sign || domain(query, &at_l, &at_r) != 1 ||
        (l > 0 && !is_clear(query, 0, l, DEPTH_MAX))) {
        return false;
    }
    /* Nothing before l, and a root in l .. r at which the features meet. The first root
     * is before any time at which the sign has changed. */
    for (int i = 0; i < HALVINGS; i++) {
        double m = 0.5 * (l + r);
        int sign_m = sign_at(query, m);
        if (sign_m == 0) {
            break;
        }
        *(sign_m == sign ? &l : &r) = m;
    }
    *early = r - hit->toi;
    return true;
}

/* As tests/oracle wants the points. */
static void points_of(const struct eng_query *query, double p[8][3])
{
    memcpy(p, query->x, sizeof query->x);
}

static enum oracle_kind kind_of(const struct eng_query *query)
{
    return query->kind == ENG_VF ? ORACLE_VF : ORACLE_EE;
}

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
    } else {
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

/* Do the parameters name the same place on both features? The contact is somewhere in
 * the bracket, during which nothing moves further than its share of the extent. Floats
 * allow 2^-23; where edges are nearly parallel, parameters are worse than that. */
static bool is_one_place(const struct eng_query *query, const struct eng_hit *hit,
                         struct fuzz_tally *tally)
{
    double u = (double)hit->param[0];
    double v = (double)hit->param[1];
    double t = 0.5 * (hit->toi + hit->toi_hi);
    bool is_vf = query->kind == ENG_VF;
    double size = 0;
    double off = 0;
    if (!(u >= 0 && v >= 0 && (is_vf ? u + v <= 1 + 0x1p-22 : u <= 1 && v <= 1))) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        double x[4];
        for (int i = 0; i < 4; i++) {
            x[i] = (double)point_at(query, i, k, t).lo;
            size = fmax(size, fabs(x[i]));
        }
        double first = is_vf ? x[0] : x[0] + u * (x[1] - x[0]);
        double second = is_vf ? x[1] + u * (x[2] - x[1]) + v * (x[3] - x[1])
                              : x[2] + v * (x[3] - x[2]);
        off = fmax(off, fabs(first - second));
    }
    double whole = extent(query);
    off -= 4 * (hit->toi_hi - hit->toi) * whole + 8 * size * DBL_EPSILON;
    if (off > whole * tally->place_max) {
        tally->place_max = off / whole;
    }
    return off <= PLACE_OFF_MAX * whole;
}

/* What every contact has; step.h. */
static bool is_formed(const struct eng_query *query, const struct eng_hit *hit,
                      double tolerance, struct fuzz_tally *tally)
{
    double p[8][3];
    double length2 = 0;
    for (int k = 0; k < 3; k++) {
        length2 += (double)hit->normal[k] * (double)hit->normal[k];
    }
    bool good = (hit->flags & ENG_PROVED) &&
                !(hit->flags & ~(uint32_t)(ENG_PROVED | ENG_INITIAL)) && 0 <= hit->toi &&
                hit->toi <= hit->toi_hi && hit->toi_hi <= 1 &&
                hit->toi_hi - hit->toi <= tolerance &&
                (length2 == 0 || fabs(length2 - 1) < 1e-6) &&
                is_one_place(query, hit, tally);
    if (!good || (hit->toi > 0 && !(hit->flags & ENG_INITIAL))) {
        return good; /* a contact at the start would be before toi: judged elsewhere */
    }
    points_of(query, p);
    return oracle_touching_at(kind_of(query), (const double(*)[3])p, 0) ==
           ((hit->flags & ENG_INITIAL) != 0);
}

const char *fuzz_judgement_text(enum fuzz_judgement judgement)
{
    static const char *const texts[] = {"right", "missed",    "invented",
                                        "late",  "too early", "misformed"};
    return texts[judgement];
}

enum fuzz_judgement fuzz_judge(const struct eng_query *query, const struct eng_hit *hit,
                               double tolerance, struct fuzz_tally *tally, double *early)
{
    double p[8][3];
    *early = 0;
    if (!hit) {
        if (apart(query, 0, 1) || is_clear(query, 0, 1, DEPTH_MAX)) {
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
        judgement = judge_exactly(query, hit, early);
    }
    if (judgement == FUZZ_RIGHT && !is_formed(query, hit, tolerance, tally)) {
        judgement = FUZZ_MISFORMED;
    }
    return judgement;
}
