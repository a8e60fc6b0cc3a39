/* solve.c - the certified solver of one elementary test.
 *
 * Walk the step in time order over spans of t. A span is dropped when the cubic det[p, b,
 * c] is certainly not zero on it, when a fixed direction separates the features at both
 * its ends, or when it is short and (beta, gamma) is certainly outside its domain. A
 * short span over which the cubic certainly changes sign while (beta, gamma) is certainly
 * inside is a proved contact. Other spans are cut, at a bracket around the cubic's root
 * where there is one, else in the middle; the short ones that remain are decided by exact
 * arithmetic.
 *
 * Source: every constant times u is derived in BOUNDS.md.
 */
#include "solve.h"

#include <math.h>
#include <string.h>

#include "kernel.h"
#include "motion.h"
#include "vec.h"

/* ---- from where a query is measured ---------------------------------------------- */

/* The points are reordered so that the vector p between the features starts and ends at
 * the points nearest to each other. Every error bound is proportional to the size of p: a
 * vertex one micrometre from a corner of a metre-wide face is decided a million times
 * more finely. */

/* The order in which the points were taken. VF: the face's corners rotated by `first`.
 * EE: bit 0: the ends of edge a swapped, bit 1: those of edge b. */
typedef unsigned base_t;

/* Largest coordinate of the difference of two points over the step. */
static double extent(const struct eng_query *query, int i, int j)
{
    double d0[3];
    double d1[3];
    eng_sub(d0, query->x[0][i], query->x[0][j]);
    eng_sub(d1, query->x[1][i], query->x[1][j]);
    double size0 = eng_size(d0);
    double size1 = eng_size(d1);
    return size0 > size1 ? size0 : size1;
}

/* Copy `query` with its points reordered. Depends on the query alone. */
static base_t rebase(const struct eng_query *query, struct eng_query *rebased)
{
    int order[4] = {0, 1, 2, 3};
    base_t base = 0;
    if (query->kind == PCCD_VF) {
        double best = extent(query, 0, 1);
        for (unsigned corner = 1; corner < 3; corner++) {
            double d = extent(query, 0, 1 + (int)corner);
            if (d < best) {
                best = d;
                base = corner;
            }
        }
        for (int k = 0; k < 3; k++) {
            order[1 + k] = 1 + ((int)base + k) % 3;
        }
    } else {
        double best = extent(query, 0, 2);
        for (unsigned ends = 1; ends < 4; ends++) {
            double d = extent(query, ends & 1 ? 1 : 0, ends & 2 ? 3 : 2);
            if (d < best) {
                best = d;
                base = ends;
            }
        }
        if (base & 1) {
            order[0] = 1;
            order[1] = 0;
        }
        if (base & 2) {
            order[2] = 3;
            order[3] = 2;
        }
    }
    rebased->kind = query->kind;
    for (int i = 0; i < 4; i++) {
        memcpy(rebased->x[0][i], query->x[0][order[i]], sizeof rebased->x[0][i]);
        memcpy(rebased->x[1][i], query->x[1][order[i]], sizeof rebased->x[1][i]);
    }
    return base;
}

/* A weight that rounding left a little outside 0 .. 1 (1 - beta - gamma) is put back. */
static float to_unit(double weight)
{
    return (float)(weight < 0 ? 0 : weight > 1 ? 1 : weight);
}

/* (beta, gamma) of the reordered query to the parameters of the original: VF the weights
 * of corners 1 and 2, EE the positions along a and b. */
static void set_params(enum pccd_kind kind, base_t base, double beta, double gamma,
                       float param[2])
{
    if (kind == PCCD_VF) {
        double weight[3];
        weight[base] = 1 - beta - gamma;
        weight[(base + 1) % 3] = beta;
        weight[(base + 2) % 3] = gamma;
        param[0] = to_unit(weight[1]);
        param[1] = to_unit(weight[2]);
    } else {
        param[0] = to_unit(base & 1 ? 1 - beta : beta);
        param[1] = to_unit(base & 2 ? 1 - gamma : gamma);
    }
}

/* ---- the search ------------------------------------------------------------------ */

/* Cuts at the middle end at the floor: 50 levels leave one span each, a bracket two. */
#define SPANS_MAX 256

/* Spans looked at, some 200 ns each, before exact arithmetic takes the rest of the step.
 * Measured: misses and contacts in general position take 2 to 4, grazing ones up to
 * 100. */
#define WORK_MAX 40

/* Spans that exact arithmetic finds empty before it is asked about all the rest. */
#define EMPTY_MAX 2

/* Brackets are at most this long whatever the tolerance: a contact that is said to begin
 * much earlier would be no use to who advances to it. */
#define WIDTH_MAX 0x1p-30

struct span {
    double l, r;
    bool is_bracket; /* came out of a cut around a root */
};

struct search {
    struct eng_query query; /* measured from its nearest points */
    base_t base;
    struct eng_motion motion;
    double tolerance;
    double small; /* spans this short are looked at closely */
    double floor; /* spans this short are not cut again */
    struct eng_exact *exact;
    struct eng_moment moment[2]; /* at t = 0 and 1, once known */
    bool moment_known[2];
    uint32_t empty_count; /* spans that exact arithmetic found empty */
    double f_start;       /* cubic at t = 0, for the normal's side */
    struct span spans[SPANS_MAX];
    uint32_t span_count;
};

static const struct eng_moment *moment_at(struct search *search, int end)
{
    if (!search->moment_known[end]) {
        search->moment[end] = eng_exact_moment(search->exact, &search->query, end);
        search->moment_known[end] = true;
    }
    return &search->moment[end];
}

static void push(struct search *search, double l, double r, bool is_bracket)
{
    if (l < r) {
        search->spans[search->span_count++] = (struct span){l, r, is_bracket};
    }
}

static void cut_in_the_middle(struct search *search, const struct span *span)
{
    double m = 0.5 * (span->l + span->r);
    push(search, m, span->r, false);
    push(search, span->l, m, false);
}

/* Cut a span whose cubic has ends of opposite sign around the root: the outer two parts
 * then have a certain sign as a rule, and the middle one is as short as rounding allows.
 * False if the bracket would not be much shorter than the span. */
static bool cut_around_root(struct search *search, const struct span *span,
                            const double f[4])
{
    double slope;
    double s = eng_bernstein_root(f, &slope);
    double reach = 4.0 * search->motion.e_det / fabs(slope) + 0x1p-50;
    if (!(reach < 0.125)) {
        return false;
    }
    double width = span->r - span->l;
    double x = eng_most(span->l, span->l + width * (s - reach));
    double y = eng_least(span->r, span->l + width * (s + reach));
    if (!(x < y)) {
        return false;
    }
    push(search, y, span->r, false);
    push(search, x, y, true);
    push(search, span->l, x, false);
    return true;
}

/* Certain sign of the cubic at an end of a span: from its value, or exactly at 0
 * and 1. */
static int sign_at(struct search *search, double t, double f)
{
    if (fabs(f) > search->motion.e_det) {
        return f > 0 ? 1 : -1;
    }
    if (t == 0 || t == 1) {
        return moment_at(search, t == 1)->side;
    }
    return 0;
}

static void set_hit(struct search *search, double l, double r, uint32_t flags,
                    struct eng_hit *hit)
{
    hit->flags = flags;
    hit->toi = l;
    hit->toi_hi = r;
    double beta;
    double gamma;
    if (fabs(search->f_start) <= search->motion.e_det) {
        /* Coplanar at the start up to rounding, as after a projection onto a surface: the
         * side that the normal names is known exactly only. */
        search->f_start = moment_at(search, 0)->side;
    }
    eng_motion_describe(&search->motion, 0.5 * (l + r), search->f_start, &beta, &gamma,
                        hit->normal);
    set_params(search->query.kind, search->base, beta, gamma, hit->param);
}

enum look { LOOK_EMPTY, LOOK_HIT, LOOK_CUT };

/* A contact is certain in the span: bracket the first. */
static enum look narrow(struct search *search, struct span span, struct eng_hit *hit)
{
    if (span.r - span.l > search->tolerance) {
        eng_exact_first(search->exact, &search->query, search->tolerance, &span.l,
                        &span.r);
    }
    set_hit(search, span.l, span.r, PCCD_PROVED, hit);
    return LOOK_HIT;
}

/* Where the first contact is, if there is one, from a time on before which there is
 * none. Asked about the whole step: its ends are short numbers. */
static enum look look_at_rest(struct search *search, struct eng_hit *hit)
{
    double l = 0;
    double r = 1;
    search->span_count = 0;
    if (!eng_exact_first(search->exact, &search->query, search->tolerance, &l, &r)) {
        return LOOK_EMPTY;
    }
    set_hit(search, l, r, PCCD_PROVED, hit);
    return LOOK_HIT;
}

/* A span that floating point cannot decide: exact arithmetic does, and brackets the first
 * contact if the span is longer than the tolerance. Features that stay coplanar up to
 * rounding, or graze each other, would be asked about span after span: one answer about
 * the rest of the step settles it. */
static enum look decide_exactly(struct search *search, struct span span,
                                struct eng_hit *hit)
{
    if (eng_exact_meets(search->exact, &search->query, span.l, span.r)) {
        return narrow(search, span, hit);
    }
    return ++search->empty_count == EMPTY_MAX ? look_at_rest(search, hit) : LOOK_EMPTY;
}

/* Return whether the features stay apart along the direction that is between them in the
 * middle of a span. */
static bool separates(const struct search *search, const struct eng_pose *l,
                      const struct eng_pose *r)
{
    struct eng_pose middle;
    for (int k = 0; k < 3; k++) {
        middle.p[k] = 0.5 * (l->p[k] + r->p[k]);
        middle.b[k] = 0.5 * (l->b[k] + r->b[k]);
        middle.c[k] = 0.5 * (l->c[k] + r->c[k]);
    }
    return eng_motion_separates(&search->motion, l, r, &middle);
}

/* Decide a short span, or say that it has to be cut. */
static enum look look_at_short(struct search *search, const struct span *span,
                               const struct eng_pose *pose_l,
                               const struct eng_pose *pose_r, const double f[4],
                               struct eng_hit *hit)
{
    enum eng_domain domain = eng_motion_domain(&search->motion, pose_l, pose_r);
    if (domain == ENG_OUTSIDE) {
        return LOOK_EMPTY;
    }
    bool certain_at_ends = (fabs(f[0]) > search->motion.e_det || span->l == 0) &&
                           (fabs(f[3]) > search->motion.e_det || span->r == 1);
    if (certain_at_ends && (domain == ENG_INSIDE || span->is_bracket)) {
        int sign_l = sign_at(search, span->l, f[0]);
        int sign_r = sign_at(search, span->r, f[3]);
        enum eng_plane plane = sign_l * sign_r >= 0 ? ENG_PLANE_UNSURE
                               : domain == ENG_INSIDE
                                   ? ENG_PLANE_MEET
                                   : eng_plane_look(&search->query, span->l, span->r);
        if (plane == ENG_PLANE_MEET) {
            return narrow(search, *span, hit);
        }
        if (plane == ENG_PLANE_MISS) {
            return LOOK_EMPTY;
        }
    }
    /* Nearly parallel edges and slivers hide (beta, gamma); a gap in the plane shows. */
    if (domain == ENG_UNSURE && separates(search, pose_l, pose_r)) {
        return LOOK_EMPTY;
    }
    if (span->r - span->l <= search->floor || span->is_bracket) {
        return decide_exactly(search, *span, hit);
    }
    return LOOK_CUT;
}

/* Look at the earliest span left. */
static enum look look_at(struct search *search, const struct span *span,
                         struct eng_hit *hit)
{
    struct eng_pose pose_l;
    struct eng_pose pose_r;
    double f[4];
    eng_motion_pose(&search->motion, span->l, &pose_l);
    eng_motion_pose(&search->motion, span->r, &pose_r);
    eng_motion_bernstein(&pose_l, &pose_r, f);
    double e = search->motion.e_det;
    if ((f[0] > e && f[1] > e && f[2] > e && f[3] > e) ||
        (f[0] < -e && f[1] < -e && f[2] < -e && f[3] < -e)) {
        return LOOK_EMPTY;
    }
    if (span->r - span->l <= search->small) {
        enum look look = look_at_short(search, span, &pose_l, &pose_r, f, hit);
        if (look != LOOK_CUT) {
            return look;
        }
    }
    bool crosses = (f[0] < 0) != (f[3] < 0);
    if (crosses && cut_around_root(search, span, f)) {
        return LOOK_CUT;
    }
    if (separates(search, &pose_l, &pose_r)) {
        return LOOK_EMPTY;
    }
    cut_in_the_middle(search, span);
    return LOOK_CUT;
}

/* Features that touch at t = 0 are known exactly, whatever happens later. */
static bool touches_at_start(struct search *search)
{
    struct eng_pose pose;
    search->f_start = 0;
    if (eng_exact_share_corner(&search->query, 0)) {
        return true;
    }
    eng_motion_pose(&search->motion, 0, &pose);
    search->f_start = eng_pose_det(&pose);
    if (fabs(search->f_start) > search->motion.e_det ||
        eng_motion_domain(&search->motion, &pose, &pose) == ENG_OUTSIDE) {
        return false;
    }
    return moment_at(search, 0)->touching;
}

bool eng_search(const struct eng_query *query, double tolerance, double t_end,
                struct eng_exact *exact, struct eng_hit *hit)
{
    struct search search;
    search.base = rebase(query, &search.query);
    search.floor = eng_most(eng_least(tolerance * 0x1p-10, WIDTH_MAX), 0x1p-44);
    search.small = eng_least(tolerance, 0x1p-20);
    search.tolerance = eng_least(tolerance, WIDTH_MAX);
    search.exact = exact;
    search.moment_known[0] = false;
    search.moment_known[1] = false;
    search.empty_count = 0;
    search.span_count = 0;
    eng_motion_init(&search.motion, &search.query);
    if (touches_at_start(&search)) {
        set_hit(&search, 0, 0, PCCD_PROVED | PCCD_INITIAL, hit);
        return true;
    }
    double l;
    double r;
    switch (eng_plane_first(&search.query, search.tolerance, &l, &r)) {
    case ENG_PLANE_MEET:
        set_hit(&search, l, r, PCCD_PROVED, hit);
        return l <= t_end;
    case ENG_PLANE_MISS:
        return false;
    case ENG_PLANE_UNSURE:
        break;
    }
    /* The bracket of a contact may begin before the span where it is found; BOUNDS.md. */
    double until = t_end + search.tolerance + 0x1p-48;
    push(&search, 0, 1, false);
    for (uint32_t work = 0; search.span_count > 0; work++) {
        struct span span = search.spans[--search.span_count];
        if (span.l > until) {
            return false;
        }
        if (work == WORK_MAX || search.span_count + 3 > SPANS_MAX) {
            return look_at_rest(&search, hit) == LOOK_HIT && hit->toi <= t_end;
        }
        if (look_at(&search, &span, hit) == LOOK_HIT) {
            return hit->toi <= t_end;
        }
    }
    return false;
}

enum eng_again eng_search_again(const struct eng_query *query, double tolerance,
                                struct eng_exact *exact, struct eng_hit *hit)
{
    struct search search;
    double l;
    double r;
    int side;
    search.base = rebase(query, &search.query);
    search.exact = exact;
    search.moment_known[0] = false;
    eng_motion_init(&search.motion, &search.query);
    enum eng_again again = eng_exact_again(
        exact, &search.query, eng_least(tolerance, WIDTH_MAX), &l, &r, &side);
    if (again == ENG_AGAIN_MEETS) {
        search.f_start = side * 2 * search.motion.e_det; /* certain */
        set_hit(&search, l, r, PCCD_PROVED, hit);
    }
    return again;
}

/* ---- one query ------------------------------------------------------------------- */

/* The filter takes half the time of the bracket kernel, and the search ten times that. */
static bool is_filtered(const struct eng_query *query)
{
    static const uint32_t quads[1][4] = {{0, 1, 2, 3}};
    struct eng_point points[4];
    uint32_t pair = 0;
    for (int i = 0; i < 4; i++) {
        memcpy(points[i].x0, query->x[0][i], sizeof points[i].x0);
        memcpy(points[i].x1, query->x[1][i], sizeof points[i].x1);
    }
    return eng_kernels_of(ENG_ISA_SCALAR)
               ->filter((struct eng_quads){query->kind, points, quads}, &pair, 1,
                        &pair) == 0;
}

bool eng_solve(const struct eng_query *query, double tolerance, double t_end,
               struct eng_exact *exact, struct eng_hit *hit)
{
    if (eng_query_separates(query)) {
        return false;
    }
    switch (eng_decide(query, tolerance, t_end, hit)) {
    case ENG_MISSES:
        return false;
    case ENG_MEETS:
        return true;
    case ENG_UNDECIDED:
        break;
    }
    return !is_filtered(query) && eng_search(query, tolerance, t_end, exact, hit);
}

const struct eng_solver eng_solvers[PCCD_KIND_COUNT] = {
    [PCCD_VF] = {.has_kernels = true, .search = eng_search},
    [PCCD_EE] = {.has_kernels = true, .search = eng_search},
    [PCCD_VE] = {.search = NULL},
    [PCCD_VV] = {.search = NULL},
};
