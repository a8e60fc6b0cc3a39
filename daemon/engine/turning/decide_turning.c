/* decide_turning.c - a pair of features of which one turns, by halves of the step.
 *
 * On a span of time the points are taken to go straight from where they are at its begin
 * to where they are at its end. They do not, but they are at most eps off. If such
 * straight features stay farther apart than r + eps, the true ones stay farther apart
 * than r; if they come within r - eps, so do the true ones within r. With r = 0 nothing
 * is within; there straight features that pass through each other so well that nothing
 * within eps of them could avoid it prove a contact. What is neither is cut: at the time
 * up to which it is free, if that is in its second half, else in the middle.
 *
 * Source: elementary/BOUNDS.md, "Features that turn".
 */
#include "decide.h"

#include <math.h>
#include <string.h>

#include "kernel.h"
#include "motion.h"
#include "passage.h"
#include "rotation.h"
#include "thick_exact.h"
#include "vec.h"

/* Cells of `advance`: each look makes a bracket so much shorter at most. Finer ones would
 * be shorter than rounding where brackets are. */
#define DEPTH 8

/* Halves of the step, and what is cut off at the end of a bracket. */
#define SPANS_MAX 96u

/* Windows that are tried before a contact is called possible. */
#define WINDOWS 20

/* The time is refined when thin features cross, where straight ones are free up to the
 * last such part of the way there. */
#define REFINED_MOST 0.25

/* Shorter spans are not cut where nobody knows. */
#define LENGTH_LEAST 0x1p-44

static const uint32_t whole[1][4] = {{0, 1, 2, 3}};
static const uint32_t numbers[4] = {0, 1, 2, 3};

/* The points of both at one time. */
struct moment {
    double t;
    double x[4][3];
    double error; /* Euclidean, of each point */
    double size;  /* largest coordinate */
};

/* Features that go straight between two moments, and how far from them the true ones
 * are. */
struct span {
    double l;
    double r;
    double length;    /* rounded up */
    double bent;      /* how far off their chords points are */
    double eps;       /* that and the errors at the ends */
    double way;       /* the most that a coordinate of a turning point changes */
    double precision; /* delta, or more, if rounding leaves that no meaning */
    struct eng_point points[4];
};

/* The facts that are known by now. */
struct found {
    double free_until;
    double met_by; /* INFINITY: nothing is proved */
    bool is_possible;
    double possible_until;
    uint32_t ahead; /* looks since then */
    bool has_begun; /* the first instant has been looked at */
};

/* Name what the search does next with a pair. */
enum next {
    NEXT_LOOK,  /* at a span */
    NEXT_CROSS, /* prove that thin features meet where their planes cross */
    NEXT_PROVE, /* that they do in a window */
    NEXT_END
};

struct decider {
    struct eng_poses *poses;
    const struct eng_turning_pair *pair;
    const struct eng_turning_limits *limits;
    struct eng_turning_answer *answer;
    const struct eng_kernels *kernels;
    uint32_t first_turning;
    uint32_t end_turning;
    double at_most;  /* r, rounded up */
    double at_least; /* r, rounded down */
    bool is_thin;
    bool has_planes; /* it is thin, VF or EE: passage.h tells of it */
    bool is_inside;  /* it begins within r, and meets by what approach allows */
    bool again;      /* if a window proves nothing, another one may */
    double guess;    /* thin features have met then, it seems; INFINITY: nobody knows */
    struct eng_passage passage; /* what is known of the pair, and of the span */
    struct found found;
    enum next next;
    struct span span;       /* that, where passage.h does not tell of it */
    double begin;           /* of the earliest span that is left */
    double ends[SPANS_MAX]; /* of spans that are left; of the first one last */
    uint32_t count;
};

/* ---- moments and spans ------------------------------------------------------------- */

static void set_moment(struct decider *decider, double t, struct moment *moment)
{
    const struct eng_turning_pair *pair = decider->pair;
    struct eng_passage *known = &decider->passage;
    const struct eng_path_pose *pose = eng_poses_at(decider->poses, t);
    const double *m = pose->m;
    const eng_d2 column[4] = {
        {m[0], m[4]}, {m[1], m[5]}, {m[2], m[6]}, {m[3], m[7]}}; /* of two rows */
    double size = known->still_size;
    for (uint32_t i = 0; i < 4; i++) {
        const double *x = pair->x[0][i];
        double *at = moment->x[i];
        if (i >= decider->first_turning && i < decider->end_turning) {
            const eng_d2 two =
                ((column[0] * eng_d2_both(x[0]) + column[1] * eng_d2_both(x[1])) +
                 column[2] * eng_d2_both(x[2])) +
                column[3];
            at[0] = two[0];
            at[1] = two[1];
            at[2] = ((m[8] * x[0] + m[9] * x[1]) + m[10] * x[2]) + m[11];
            size = eng_most(size, eng_size(at));
        } else if (!known->stands) {
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                at[k] = (1 - t) * x[k] + t * pair->x[1][i][k];
            }
        } else {
            memcpy(at, x, 3 * sizeof *at);
        }
    }
    known->is_beyond |= !(size <= ENG_PASSAGE_SIZE);
    bool is_given = known->stands || t == 0 || t == 1;
    moment->t = t;
    moment->size = size;
    moment->error =
        (pose->error[0] + pose->error[1] * known->turning_size) * (1 + 8 * ENG_U) +
        (is_given ? 0 : known->still_error);
}

static void set_span(struct decider *decider, double from, double to, struct span *span)
{
    const struct eng_passage *known = &decider->passage;
    struct moment l, r;
    set_moment(decider, from, &l);
    set_moment(decider, to, &r);
    const double error = eng_most(l.error, r.error);
    span->l = from;
    span->r = to;
    span->length = (to - from) * (1 + 2 * ENG_U);
    span->bent = known->bend * span->length * span->length * (0.125 + 2 * ENG_U) +
                 (known->bend > 0 ? ENG_TINY : 0);
    span->eps = (span->bent + error) * (1 + 4 * ENG_U);
    span->precision = eng_most(decider->limits->delta,
                               eng_turning_delta_least(eng_most(l.size, r.size), error));
    span->way = 0;
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(span->points[i].x0, l.x[i], sizeof l.x[i]);
        memcpy(span->points[i].x1, r.x[i], sizeof r.x[i]);
        if (i >= decider->first_turning && i < decider->end_turning) {
            double d[3];
            eng_sub(d, r.x[i], l.x[i]);
            span->way = eng_most(span->way, eng_size(d));
        }
    }
}

/* Return a time that is not after that part of the span, nor before its begin. */
static double time_before(const struct span *span, double part)
{
    double t = span->l + (span->r - span->l) * part - 4 * ENG_U;
    return part <= 0 ? span->l : eng_most(span->l, t);
}

static double time_behind(const struct span *span, double part)
{
    double t = span->l + (span->r - span->l) * part + 4 * ENG_U;
    return part <= 0 ? span->l : eng_least(span->r, t);
}

/* ---- free -------------------------------------------------------------------------- */

/* Return whether an axis keeps the features farther apart than that, at both ends. */
static bool are_apart(const struct span *span, uint32_t points_a, double reach)
{
    const struct eng_point *x = span->points;
    for (int k = 0; k < 3; k++) {
        double above = INFINITY;
        double below = INFINITY;
        for (int end = 0; end < 2; end++) {
            double at[4];
            for (int i = 0; i < 4; i++) {
                at[i] = end == 0 ? x[i].x0[k] : x[i].x1[k];
            }
            double low_a = eng_least(at[0], at[points_a - 1]);
            double high_a = eng_most(at[0], at[points_a - 1]);
            double low_b = eng_least(eng_least(at[points_a], at[2]), at[3]);
            double high_b = eng_most(eng_most(at[points_a], at[2]), at[3]);
            above = eng_least(above, low_a - high_b);
            below = eng_least(below, low_b - high_a);
        }
        if (above > reach || below > reach) {
            return true;
        }
    }
    return false;
}

/* Ask the kernel whether straight features come within r, when. */
static void advance(const struct decider *decider, const struct span *span, double r,
                    struct eng_advance *told)
{
    static const struct eng_advance_limits limits = {0, 1, DEPTH};
    *told = (struct eng_advance){.lo = r};
    decider->kernels->advance(
        (struct eng_quads){(uint32_t)decider->pair->kind, span->points, whole}, numbers,
        1, &limits, told);
}

/* Return the reach within which straight features may mean that the true ones come within
 * r. */
static double reach_of(const struct decider *decider, const struct span *span)
{
    return (decider->at_most + span->eps) * (1 + 4 * ENG_U);
}

/* Tell of a span, as if its features were thick; *until becomes the time up to which it
 * is free, if that is later. */
static enum eng_seen look_closely(const struct decider *decider, const struct span *span,
                                  double *until)
{
    const double r = reach_of(decider, span);
    const uint32_t kind = (uint32_t)decider->pair->kind;
    uint32_t left[1];
    struct eng_advance told;
    if (decider->kernels->reject_thick((struct eng_quads){kind, span->points, whole}, 1,
                                       &r, left) == 0) {
        return ENG_SEEN_FREE;
    }
    advance(decider, span, r, &told);
    if (told.now == ENG_ADVANCE_MISSES) {
        return ENG_SEEN_FREE;
    }
    *until = eng_most(*until, time_before(span, told.until));
    return told.now == ENG_ADVANCE_UNDECIDED ? ENG_SEEN_UNSURE : ENG_SEEN_NEAR;
}

/* Tell of a span; *until becomes the time up to which it is free. */
static enum eng_seen look(const struct decider *decider, const struct span *span,
                          bool closely, double *until)
{
    const double r = reach_of(decider, span);
    const uint32_t points_a = common_kinds[decider->pair->kind].points[0];
    *until = span->l;
    if (!(r <= ENG_PASSAGE_SIZE)) {
        return ENG_SEEN_CUT;
    }
    if (are_apart(span, points_a, r * (1 + 4 * ENG_U))) {
        return ENG_SEEN_FREE;
    }
    /* What is within delta is not bent: points on the axis go nowhere, and rounding bends
     * their way. */
    if (!closely && span->bent > decider->limits->delta &&
        span->bent > ENG_PASSAGE_BENT * span->way) {
        return ENG_SEEN_CUT;
    }
    return look_closely(decider, span, until);
}

/* ---- proved ------------------------------------------------------------------------ */

/* Return a time by which they are within r; INFINITY: it is not proved. */
static double prove_thick(const struct decider *decider, const struct span *span)
{
    double r = (decider->at_least - span->eps) * (1 - 4 * ENG_U);
    struct eng_advance told;
    if (!(r > 0)) {
        return INFINITY;
    }
    advance(decider, span, r, &told);
    switch ((enum eng_advanced)told.now) {
    case ENG_ADVANCE_INITIALLY:
        return span->l;
    case ENG_ADVANCE_MEETS:
        return time_behind(span, eng_thick_cell_begin((int64_t)told.cell + 1, DEPTH));
    case ENG_ADVANCE_MISSES:
    case ENG_ADVANCE_UNDECIDED:
        break;
    }
    return INFINITY;
}

static double length_of(const struct decider *decider)
{
    return (decider->passage.r - decider->passage.l) * (1 + 2 * ENG_U);
}

/* Return where the planes cross, or the end, where neither this span nor the next one
 * would tell. */
static double middle_of(const struct eng_passage *known)
{
    return known->middle >= 0 ? known->l + (known->r - known->l) * known->middle
                              : known->r;
}

/* Set a window of that length before and behind a time. Return whether to try it. */
static bool set_window(struct decider *decider, double middle, double reach)
{
    struct eng_passage *window = &decider->passage;
    window->from = eng_most(middle - reach, 0);
    window->to = eng_least(middle + reach, 1);
    return reach > 2 * ENG_U && window->to - window->from < length_of(decider);
}

/* Near a border, shorter windows prove what longer ones do not. Return a time by which
 * thin features have met, or INFINITY. */
static double try_windows(struct decider *decider, double middle)
{
    struct eng_passage *window = &decider->passage;
    double reach = 0.25 * length_of(decider);
    for (int i = 0; i < WINDOWS; i++, reach *= 0.25) {
        if (set_window(decider, middle, reach)) {
            eng_scalar_passage.prove(decider->poses, decider->pair->kind,
                                     decider->pair->turning, &window, 1);
            if (window->is_met) {
                return window->to;
            }
        }
    }
    return INFINITY;
}

/* Return the part of a span after which the planes across straight features cross; -1:
 * nobody knows. */
static double crossing_of(enum pccd_kind kind, const struct span *span)
{
    struct eng_motion motion;
    struct eng_query query = {.kind = kind};
    struct eng_pose pose[2];
    double f[4], slope;
    for (int i = 0; i < 4; i++) {
        memcpy(query.x[0][i], span->points[i].x0, sizeof query.x[0][i]);
        memcpy(query.x[1][i], span->points[i].x1, sizeof query.x[1][i]);
    }
    eng_motion_init(&motion, &query);
    eng_motion_pose(&motion, 0, &pose[0]);
    eng_motion_pose(&motion, 1, &pose[1]);
    eng_motion_bernstein(&pose[0], &pose[1], f);
    return fabs(f[0]) > motion.e_det && fabs(f[3]) > motion.e_det &&
                   (f[0] < 0) != (f[3] < 0)
               ? eng_bernstein_root(f, &slope)
               : -1;
}

/* Try another window, as long as the tolerance allows, if the first one was shorter. */
static void try_again(struct decider *decider)
{
    if (decider->again && set_window(decider, middle_of(&decider->passage),
                                     0.25 * decider->limits->tolerance)) {
        decider->next = NEXT_PROVE;
    }
    decider->again = false;
}

/* Go on to prove that thin features meet: set decider->next if something is to be tried.
 * They are free up to `until`, which may become later, and the proof is about a window
 * around the time when the straight features meet, which is shorter than the span and may
 * go beyond it. One that is longer than the tolerance would be no more than a guess. */
static void prove_thin(struct decider *decider)
{
    const struct eng_passage *known = &decider->passage;
    const double tolerance = decider->limits->tolerance;
    const double middle = middle_of(known);
    const double reach = 3 * (middle - known->until) + 8 * ENG_U;
    if (2 * reach <= tolerance) {
        decider->again = 8 * reach <= tolerance;
        if (set_window(decider, middle, reach)) {
            decider->next = NEXT_PROVE;
        } else {
            try_again(decider);
        }
        return;
    }
    decider->guess = middle + reach;
    if (decider->is_thin && known->is_inside &&
        middle - known->until <= REFINED_MOST * (middle - known->l)) {
        decider->next = NEXT_CROSS;
    }
}

/* ---- possible ---------------------------------------------------------------------- */

double eng_turning_delta_least(double size, double error)
{
    return eng_most(4 * error, 0x1p-44 * size);
}

/* Set the difference vectors of query.h. */
static void set_pose(enum pccd_kind kind, const struct moment *moment,
                     struct eng_pose *pose)
{
    const double(*x)[3] = moment->x;
    const bool is_ee = kind == PCCD_EE;
    eng_sub(pose->p, is_ee ? x[2] : x[0], is_ee ? x[0] : x[1]);
    eng_sub(pose->b, is_ee ? x[1] : x[2], is_ee ? x[0] : x[1]);
    eng_sub(pose->c, is_ee ? x[2] : x[3], is_ee ? x[3] : x[1]);
}

/* Return how far apart the features are, as far as doubles can tell. */
static double distance_at(enum pccd_kind kind, const struct moment *moment)
{
    struct eng_pose pose;
    struct eng_closest closest;
    set_pose(kind, moment, &pose);
    eng_closest_to_origin(kind == PCCD_EE ? PCCD_EE : PCCD_VF, &pose, &closest);
    return sqrt(eng_dot(closest.gap, closest.gap));
}

/* Return whether there is nothing more to be known of a leaf, and its features come
 * within precision of r. */
static bool comes_near(struct decider *decider)
{
    const struct eng_passage *known = &decider->passage;
    struct moment moment;
    if (known->seen != ENG_SEEN_UNSURE || known->until == known->l) {
        return true;
    }
    if (length_of(decider) > LENGTH_LEAST) {
        return false;
    }
    set_moment(decider, known->until, &moment);
    return !(distance_at(decider->pair->kind, &moment) >
             decider->at_most + known->precision);
}

/* ---- the search -------------------------------------------------------------------- */

static void push(struct decider *decider, double t)
{
    decider->ends[decider->count++] = t;
}

/* Leave the span, which is the first, behind. */
static void pass(struct decider *decider)
{
    decider->begin = decider->ends[--decider->count];
}

/* Go on with the part of the span, which is the first, that is not known to be free: up
 * to where it is guessed to meet, or, in its second half, to its end; else with its first
 * half. */
static void cut(struct decider *decider)
{
    const double l = decider->passage.l;
    const double r = decider->passage.r;
    const double until = decider->passage.until;
    const double end = decider->guess < r ? decider->guess : r;
    if (end - until > 0.5 * (r - l)) {
        push(decider, l + 0.5 * (r - l));
        return;
    }
    if (until > l) {
        decider->begin = until;
    }
    if (end < r) {
        push(decider, end);
    }
}

/* Return whether the bracket is short enough, or nobody wants it. */
static bool is_known(const struct decider *decider)
{
    const struct found *found = &decider->found;
    return found->met_by - found->free_until <= decider->limits->tolerance ||
           (found->is_possible && found->met_by < INFINITY) ||
           found->free_until > decider->limits->t_end;
}

/* Return whether the caller knows that nothing that is wanted is left. What is possible
 * or proved needs more, also later. */
static bool is_behind(const struct decider *decider)
{
    const struct found *found = &decider->found;
    return decider->pair->to > 0 && decider->begin >= decider->pair->to &&
           !found->is_possible && found->met_by == INFINITY;
}

/* Go to the first span that is left and has to be looked at; there may be none. */
static void seek(struct decider *decider)
{
    struct found *found = &decider->found;
    decider->next = NEXT_END;
    while (decider->count > 0) {
        if (decider->answer->looks == decider->limits->looks_max ||
            decider->count > SPANS_MAX - 2 || decider->passage.is_beyond) {
            decider->answer->verdict = ENG_TURNING_LIMIT;
            return;
        }
        decider->answer->looks++;
        if (decider->ends[decider->count - 1] > found->met_by) {
            decider->count = 0;
            push(decider, found->met_by);
        }
        if (is_behind(decider)) {
            found->free_until = 1;
            return;
        }
        if (decider->ends[decider->count - 1] > decider->pair->from) {
            decider->passage.l = decider->begin;
            decider->passage.r = decider->ends[decider->count - 1];
            decider->passage.is_possible = found->is_possible;
            decider->next = NEXT_LOOK;
            return;
        }
        pass(decider);
        if (!found->is_possible) {
            found->free_until = decider->begin;
        }
        if (is_known(decider)) {
            return;
        }
    }
}

/* Look at a span of features that are thick, or have no planes across both. */
static void look_alone(struct decider *decider)
{
    struct eng_passage *known = &decider->passage;
    struct span *span = &decider->span;
    set_span(decider, known->l, known->r, span);
    known->precision = span->precision;
    /* The errors at its ends would be most of a shorter one's eps, too. */
    known->is_leaf = span->eps <= span->precision &&
                     (known->is_possible || (span->length <= decider->limits->tolerance &&
                                             span->bent <= span->eps - span->bent));
    known->seen = look(decider, span, known->is_leaf, &known->until);
}

/* Prove what can be proved of a span whose straight features come near; thin ones may
 * have to wait for it (decider->next). */
static void prove(struct decider *decider, bool hard)
{
    const enum pccd_kind kind = decider->pair->kind;
    struct eng_passage *known = &decider->passage;
    struct found *found = &decider->found;
    double met_by = INFINITY;
    if (!decider->is_thin) {
        if (!found->has_begun && known->until == 0) {
            struct span instant;
            set_span(decider, known->l, known->l, &instant);
            found->met_by = eng_least(found->met_by, prove_thick(decider, &instant));
        }
        met_by = prove_thick(decider, &decider->span);
    }
    found->has_begun = true;
    if (met_by == INFINITY && (kind == PCCD_VF || kind == PCCD_EE)) {
        if (!decider->is_thin) {
            known->middle = crossing_of(kind, &decider->span);
        }
        if (hard) {
            met_by = try_windows(decider, middle_of(known));
        } else {
            prove_thin(decider);
        }
    }
    found->met_by = eng_least(found->met_by, met_by);
}

/* Go on when the span has been cut, or nothing more is to be proved of it. */
static void go_on(struct decider *decider)
{
    struct found *found = &decider->found;
    if (!decider->passage.is_leaf || !comes_near(decider)) {
        cut(decider);
        return;
    }
    if (!found->is_possible) {
        found->is_possible = true;
        found->possible_until = decider->passage.r;
    }
    pass(decider);
    if (found->met_by < INFINITY || ++found->ahead > ENG_TURNING_LOOKS_AHEAD) {
        decider->next = NEXT_END;
    }
}

/* Take what has been proved of the span. */
static void take_proof(struct decider *decider)
{
    if (!decider->found.is_possible) {
        decider->found.free_until = decider->passage.until;
    }
    if (is_known(decider)) {
        decider->next = NEXT_END;
        return;
    }
    go_on(decider);
}

/* Take what has been seen of the span. */
static void take_look(struct decider *decider)
{
    struct eng_passage *known = &decider->passage;
    struct found *found = &decider->found;
    decider->guess = INFINITY;
    if (known->seen == ENG_SEEN_OPEN) {
        set_span(decider, known->l, known->r, &decider->span);
        known->seen = look_closely(decider, &decider->span, &known->until);
    }
    if (!found->is_possible) {
        found->free_until = known->seen == ENG_SEEN_FREE ? known->r : known->until;
    }
    if (known->seen == ENG_SEEN_FREE) {
        pass(decider);
        decider->next = is_known(decider) ? NEXT_END : NEXT_LOOK;
        return;
    }
    if (found->free_until > decider->limits->t_end) {
        decider->next = NEXT_END;
        return;
    }
    if (known->seen == ENG_SEEN_CUT) {
        go_on(decider);
        return;
    }
    prove(decider, known->is_leaf && !found->is_possible);
    if (decider->next == NEXT_LOOK) {
        take_proof(decider);
    }
}

/* Take what has been proved in a window. */
static void take_window(struct decider *decider)
{
    const struct eng_passage *known = &decider->passage;
    const bool was_crossing = decider->next == NEXT_CROSS;
    decider->next = NEXT_LOOK;
    if (known->is_met) {
        decider->found.met_by = eng_least(decider->found.met_by, known->to);
    } else if (!was_crossing) {
        try_again(decider);
    }
    if (decider->next == NEXT_LOOK) {
        take_proof(decider);
    }
}

/* Let features that begin within r meet where their distance is the part of the first
 * one that approach allows. Of those that begin at r, as far as bounds tell, nobody knows
 * which it is: they may meet at r, and do where both ways to read it say so. */
static void take_approach(struct decider *decider)
{
    const double s = decider->limits->approach, most = decider->at_most;
    struct span first;
    struct moment begin;
    double until;
    set_span(decider, 0, 0, &first);
    if (look(decider, &first, true, &until) == ENG_SEEN_FREE) {
        return;
    }
    decider->is_inside = prove_thick(decider, &first) < INFINITY;
    set_moment(decider, 0, &begin);
    double d = distance_at(decider->pair->kind, &begin);
    double pad = 4 * first.eps + 0x1p-40 * begin.size;
    decider->at_most = d - pad; /* the first distance is above that and .. */
    bool is_above = d > pad && look(decider, &first, true, &until) == ENG_SEEN_FREE;
    decider->at_least = d + pad; /* .. at most that, if both can be proved */
    bool is_below = prove_thick(decider, &first) < INFINITY;
    decider->at_least = is_above ? s * (d - pad) * (1 - 4 * ENG_U) : 0;
    decider->at_most =
        decider->is_inside && is_below ? s * (d + pad) * (1 + 4 * ENG_U) : most;
}

static void begin(struct decider *decider)
{
    const struct eng_turning_pair *pair = decider->pair;
    const uint32_t *points = common_kinds[pair->kind].points;
    struct eng_passage *known = &decider->passage;
    decider->kernels = eng_kernels_of(ENG_ISA_SCALAR);
    decider->first_turning = pair->turning == 0 ? 0 : points[0];
    decider->end_turning = pair->turning == 0 ? points[0] : 4;
    decider->is_inside = false;
    decider->count = 0;
    decider->begin = 0;
    decider->found = (struct found){.met_by = INFINITY};
    known->x = pair->x;
    known->stands = true;
    known->still_size = 0;
    known->turning_size = 0;
    known->delta = decider->limits->delta;
    known->tolerance = decider->limits->tolerance;
    known->is_beyond = false;
    known->side = 0;
    for (uint32_t i = 0; i < 4; i++) {
        const double *x = pair->x[0][i];
        const double *y = pair->x[1][i];
        if (i < decider->first_turning || i >= decider->end_turning) {
            known->stands &= x[0] == y[0] && x[1] == y[1] && x[2] == y[2];
            known->still_size =
                eng_most(known->still_size, eng_most(eng_size(x), eng_size(y)));
            continue;
        }
        known->turning_size = eng_most(known->turning_size, eng_size(x));
    }
    known->still_error = 8 * ENG_U * known->still_size + ENG_TINY;
    known->bend =
        eng_path_bend_of(decider->poses->path, pair->x[0] + decider->first_turning,
                         decider->end_turning - decider->first_turning, 0);
    decider->at_most = eng_thick_reach(pair->radius);
    decider->at_least = eng_thick_sum(pair->radius) * (1 - 4 * ENG_U);
    decider->is_thin = decider->at_most == 0;
    decider->has_planes =
        decider->is_thin && (pair->kind == PCCD_VF || pair->kind == PCCD_EE);
    if (decider->limits->approach > 0 && !decider->is_thin) {
        take_approach(decider);
    }
    push(decider, 1);
    decider->next = NEXT_LOOK;
    decider->answer->looks = 0;
    decider->answer->verdict = ENG_TURNING_FREE;
}

/* ---- the answer -------------------------------------------------------------------- */

/* Set the verdict and the times, but for param and normal. */
static void finish(struct decider *decider)
{
    struct found *found = &decider->found;
    struct eng_turning_answer *answer = decider->answer;
    const double t_end = decider->limits->t_end;
    if (answer->verdict == ENG_TURNING_LIMIT && !found->is_possible) {
        /* However far the looks came, so much was known. */
        found->free_until =
            eng_most(found->free_until, eng_least(decider->pair->from, found->met_by));
    }
    if (answer->verdict == ENG_TURNING_LIMIT && found->free_until > t_end) {
        answer->verdict = ENG_TURNING_FREE;
    }
    answer->free_until = found->free_until;
    bool is_proved = found->met_by < INFINITY;
    if (answer->verdict == ENG_TURNING_STOPPED || !(is_proved || found->is_possible) ||
        found->free_until > t_end) {
        return;
    }
    answer->verdict = ENG_TURNING_MEETS;
    answer->hit =
        (struct eng_hit){.flags = is_proved ? PCCD_PROVED : 0,
                         .toi = found->free_until,
                         .toi_hi = is_proved ? found->met_by : found->possible_until};
    answer->hit.flags |= found->met_by == 0 ? PCCD_INITIAL : 0;
    answer->hit.flags |= decider->is_inside ? PCCD_INSIDE : 0;
}

/* Deciders of one kind, and of one side that turns. */
struct batch {
    struct decider *all[ENG_TURNING_BATCH];
    uint32_t count;
    struct decider *some[ENG_TURNING_BATCH];         /* of those, and .. */
    struct eng_passage *passages[ENG_TURNING_BATCH]; /* .. what is known of them */
    uint32_t some_count;
};

static void choose(struct batch *batch, enum next next)
{
    batch->some_count = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        if (batch->all[i]->next == next) {
            batch->some[batch->some_count] = batch->all[i];
            batch->passages[batch->some_count++] = &batch->all[i]->passage;
        }
    }
}

/* Set param and normal of pairs that meet, by their places at toi. */
static void describe(const struct batch *batch)
{
    const struct decider *first = batch->some[0];
    const struct eng_turning_pair *pair = first->pair;
    const uint32_t kind = (uint32_t)pair->kind;
    const uint32_t count = batch->some_count;
    const bool is_one = count == 1;
    struct eng_point points[ENG_TURNING_BATCH][4];
    uint32_t quads[ENG_TURNING_BATCH][4];
    uint32_t numbers_of[ENG_TURNING_BATCH];
    struct eng_hit hits[ENG_TURNING_BATCH];
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < 4; k++) {
            quads[i][k] = 4 * i + k;
        }
        numbers_of[i] = i;
        hits[i] = batch->some[i]->answer->hit;
        batch->passages[i]->at = hits[i].toi;
        hits[i].toi = 0;
    }
    const struct eng_passage_calls *calls = is_one ? &eng_scalar_passage : eng_passage();
    calls->place(first->poses, pair->kind, pair->turning, batch->passages, count, points);
    const struct eng_kernels *kernels = is_one ? first->kernels : eng_kernels();
    kernels->describe((struct eng_quads){kind, points[0], (const uint32_t(*)[4])quads},
                      numbers_of, count, hits);
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_passage *known = batch->passages[i];
        hits[i].toi = known->at;
        if (known->side != 0) {
            memcpy(hits[i].normal, known->normal, sizeof hits[i].normal);
        }
        batch->some[i]->answer->hit = hits[i];
    }
}

static void take_windows(struct batch *batch)
{
    for (uint32_t i = 0; i < batch->some_count; i++) {
        take_window(batch->some[i]);
    }
}

/* Look once at a span of each that has one left. Return how many there were. */
static uint32_t look_at_all(struct batch *batch)
{
    const struct decider *first = batch->all[0];
    const struct eng_turning_pair *pair = first->pair;
    for (uint32_t i = 0; i < batch->count; i++) {
        if (batch->all[i]->next == NEXT_LOOK) {
            seek(batch->all[i]);
        }
    }
    choose(batch, NEXT_LOOK);
    const uint32_t looks = batch->some_count;
    if (looks == 0) {
        return 0;
    }
    /* One pair alone is quicker without lanes. */
    const struct eng_passage_calls *calls =
        looks == 1 ? &eng_scalar_passage : eng_passage();
    if (first->has_planes) {
        calls->look(first->poses, pair->kind, pair->turning, batch->passages, looks);
    }
    for (uint32_t i = 0; i < looks; i++) {
        if (!first->has_planes) {
            look_alone(batch->some[i]);
        }
        take_look(batch->some[i]);
    }
    choose(batch, NEXT_CROSS);
    if (batch->some_count > 0) {
        calls->cross(first->poses, pair->kind, pair->turning, batch->passages,
                     batch->some_count);
        take_windows(batch);
    }
    for (choose(batch, NEXT_PROVE); batch->some_count > 0; choose(batch, NEXT_PROVE)) {
        calls->prove(first->poses, pair->kind, pair->turning, batch->passages,
                     batch->some_count);
        take_windows(batch);
    }
    return looks;
}

static bool is_like(const struct decider *a, const struct decider *b)
{
    return a->pair->kind == b->pair->kind && a->pair->turning == b->pair->turning &&
           a->has_planes == b->has_planes;
}

/* Take the first of those that are left, and all that are like it, away from them. */
static void take_batch(struct decider **left, uint32_t *count, struct batch *batch)
{
    uint32_t kept = 0;
    batch->count = 0;
    for (uint32_t i = 0; i < *count; i++) {
        if (i == 0 || is_like(left[i], batch->all[0])) {
            batch->all[batch->count++] = left[i];
        } else {
            left[kept++] = left[i];
        }
    }
    *count = kept;
}

void eng_turning_decide_all(struct eng_poses *poses, const struct eng_turning_pair *pairs,
                            uint32_t count, const struct eng_turning_limits *limits,
                            struct eng_turning_answer *answers)
{
    struct decider deciders[ENG_TURNING_BATCH];
    struct decider *left[ENG_TURNING_BATCH];
    struct batch batch;
    uint32_t looks = 0; /* since it was asked whether to stop */
    bool stops = false;
    for (uint32_t i = 0; i < count; i++) {
        deciders[i].poses = poses;
        deciders[i].pair = &pairs[i];
        deciders[i].limits = limits;
        deciders[i].answer = &answers[i];
        begin(&deciders[i]);
        left[i] = &deciders[i];
    }
    while (count > 0) {
        take_batch(left, &count, &batch);
        while (!stops) {
            const uint32_t looked = look_at_all(&batch);
            if (looked == 0) {
                break;
            }
            looks += looked;
            if (looks >= ENG_TURNING_LOOKS_BETWEEN) {
                looks = 0;
                stops = limits->should_stop != NULL && limits->should_stop(limits->owner);
            }
        }
        for (uint32_t i = 0; i < batch.count; i++) {
            struct decider *decider = batch.all[i];
            if (decider->next != NEXT_END) {
                decider->answer->verdict = ENG_TURNING_STOPPED;
            }
            finish(decider);
            decider->next =
                decider->answer->verdict == ENG_TURNING_MEETS ? NEXT_LOOK : NEXT_END;
        }
        choose(&batch, NEXT_LOOK); /* to be described */
        if (batch.some_count > 0) {
            describe(&batch);
        }
    }
}

enum eng_turning_verdict eng_turning_decide(struct eng_poses *poses,
                                            const struct eng_turning_pair *pair,
                                            const struct eng_turning_limits *limits,
                                            struct eng_turning_answer *answer)
{
    eng_turning_decide_all(poses, pair, 1, limits, answer);
    return answer->verdict;
}
