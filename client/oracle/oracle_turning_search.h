/* oracle_turning_search.h - the search for the first meeting of two features that turn;
 * included once for each kind of REAL.
 *
 * A span of time is free where some direction keeps the features more than r apart all
 * through it: where each point of the one is along it, less each of the other, at the
 * middle, with what the first derivative there and the second over the span can change.
 * They meet in a span where at its middle two of their points are at most r apart; or,
 * without r, where the signed volume of their points changes its sign over it while the
 * sides of the common point stay above 0: then it is 0 somewhere in between, and they
 * have that point in common. Spans are looked at in the order of time, and halved, not
 * quite in the middle, so that no round time is an end of all of them.
 */
#ifndef ORACLE_TURNING_SEARCH_H
#define ORACLE_TURNING_SEARCH_H

#include "oracle_turning.h"
#include "oracle_turning_balls.h"

#include <string.h>

#ifndef REAL_SEARCH
#define REAL_SEARCH oracle_turning_search
#define REAL_LEAST  0x1p-12 /* of the width: the shortest span */
#endif

#define STACK_MAX 256

/* ---- where points are -------------------------------------------------------------- */

struct link {
    uint32_t kind;
    bool is_turned; /* it has a rotation */
    struct ball rotation[3][3];
    struct ball position[3];
    struct ball cross[3][3], twice[3][3]; /* TURN: K and K K of u x .. */
    struct ball along[3];                 /* SLIDE: u */
    struct ball from[3], slope[3];
};

struct body {
    uint32_t points;
    bool goes_straight;
    struct ball begin[3][3], way[3][3]; /* points; of what goes straight, per step */
    uint32_t count;
    struct link links[ORACLE_TURNING_JOINTS_MAX];
};

/* Set k to by times the matrix of v x .., and its square. */
static void set_cross(const double v[3], struct ball k[3][3], struct ball by)
{
    for (int i = 0; i < 3; i++) {
        k[i][i] = ball_exact(0);
        k[(i + 2) % 3][(i + 1) % 3] = ball_mul(ball_exact((REAL)v[i]), by);
        k[(i + 1) % 3][(i + 2) % 3] = ball_negative(k[(i + 2) % 3][(i + 1) % 3]);
    }
}

static void set_square(struct ball k[3][3], struct ball square[3][3])
{
    for (int i = 0; i < 9; i++) {
        struct ball sum = ball_exact(0);
        for (int n = 0; n < 3; n++) {
            sum = ball_add(sum, ball_mul(k[i / 3][n], k[n][i % 3]));
        }
        square[i / 3][i % 3] = sum;
    }
}

static struct ball square_length(const double *v, int count)
{
    struct ball sum = ball_exact(0);
    for (int i = 0; i < count; i++) {
        sum = ball_add(sum, ball_mul(ball_exact((REAL)v[i]), ball_exact((REAL)v[i])));
    }
    return sum;
}

static void set_link(struct link *link, const struct pccd_joint *joint)
{
    struct ball k[3][3];
    const double *q = joint->rotation;
    link->kind = joint->kind;
    link->is_turned = q[0] != 0 || q[1] != 0 || q[2] != 0;
    /* I + 2 (w K + K K) / |q|^2 */
    struct ball two = ball_mul(ball_exact(2), ball_inverse(square_length(q, 4)));
    set_cross(q, k, ball_exact(1));
    set_square(k, link->rotation);
    for (int i = 0; i < 9; i++) {
        struct ball *at = &link->rotation[i / 3][i % 3];
        *at = ball_add(*at, ball_mul(k[i / 3][i % 3], ball_exact((REAL)q[3])));
        *at = ball_add(ball_mul(*at, two), ball_exact(i % 4 == 0));
    }
    for (int i = 0; i < 3; i++) {
        link->position[i] = ball_exact((REAL)joint->position[i]);
        link->from[i] = ball_exact((REAL)joint->from[i]);
        link->slope[i] = ball_sub(ball_exact((REAL)joint->to[i]), link->from[i]);
    }
    if (link->kind == PCCD_JOINT_TURN || link->kind == PCCD_JOINT_SLIDE) {
        struct ball over = ball_inverse(ball_sqrt(square_length(joint->axis, 3)));
        set_cross(joint->axis, link->cross, over);
        set_square(link->cross, link->twice);
        for (int i = 0; i < 3; i++) {
            link->along[i] = ball_mul(ball_exact((REAL)joint->axis[i]), over);
        }
    }
}

/* List the joints from the one that a side hangs on to the world; return how many, or
 * ORACLE_TURNING_JOINTS_MAX + 1: too many. */
static uint32_t list_joints(const struct oracle_turning *pair, int side,
                            uint32_t list[ORACLE_TURNING_JOINTS_MAX])
{
    uint32_t count = 0;
    uint32_t joint = pair->side[side].joint;
    while (joint != PCCD_NO_JOINT) {
        if (count == ORACLE_TURNING_JOINTS_MAX) {
            return count + 1;
        }
        list[count++] = joint;
        joint = pair->joints[joint].parent;
    }
    return count;
}

/* Return whether there are not too many joints. */
static bool set_bodies(struct body bodies[2], const struct oracle_turning *pair)
{
    uint32_t list[2][ORACLE_TURNING_JOINTS_MAX];
    for (int side = 0; side < 2; side++) {
        struct body *body = &bodies[side];
        const struct oracle_turning_side *is = &pair->side[side];
        body->points = is->points;
        body->goes_straight = is->joint == PCCD_NO_JOINT;
        body->count = list_joints(pair, side, list[side]);
        if (body->count > ORACLE_TURNING_JOINTS_MAX) {
            return false;
        }
        for (uint32_t i = 0; i < 3 * is->points; i++) {
            struct ball *begin = &body->begin[i / 3][i % 3];
            *begin = ball_exact((REAL)is->x[0][i / 3][i % 3]);
            body->way[i / 3][i % 3] = ball_exact(0);
            if (body->goes_straight) {
                REAL end = (REAL)is->x[1][i / 3][i % 3];
                body->way[i / 3][i % 3] = ball_sub(ball_exact(end), *begin);
            }
        }
    }
    /* What moves both moves neither against the other. */
    while (bodies[0].count > 0 && bodies[1].count > 0 &&
           list[0][bodies[0].count - 1] == list[1][bodies[1].count - 1]) {
        bodies[0].count--;
        bodies[1].count--;
    }
    for (int side = 0; side < 2; side++) {
        for (uint32_t i = 0; i < bodies[side].count; i++) {
            set_link(&bodies[side].links[i], &pair->joints[list[side][i]]);
        }
    }
    return true;
}

/* Add sin q K x + (1 - cos q) K K x to each x. */
static void turn_points(const struct link *link, struct jet t, uint32_t points,
                        struct jet x[3][3])
{
    struct jet q = {{ball_add(link->from[0], ball_mul(link->slope[0], t.c[0])),
                     link->slope[0], ball_exact(0)}};
    struct ball s, c;
    ball_turn(q.c[0], &s, &c);
    const struct ball sines[3] = {s, c, ball_negative(s)};
    const struct ball rest[3] = {ball_sub(ball_exact(1), c), s, c};
    struct jet sine = jet_chain(sines, q), versine = jet_chain(rest, q);
    for (uint32_t p = 0; p < points; p++) {
        struct jet was[3] = {x[p][0], x[p][1], x[p][2]};
        for (int i = 0; i < 3; i++) {
            struct jet once = jet_of(ball_exact(0)), twice = once;
            for (int k = 0; k < 3; k++) {
                once = jet_add(once, jet_scale(was[k], link->cross[i][k]));
                twice = jet_add(twice, jet_scale(was[k], link->twice[i][k]));
            }
            once = jet_add(jet_mul(sine, once), jet_mul(versine, twice));
            x[p][i] = jet_add(was[i], once);
        }
    }
}

/* Add f w x x + g w x (w x x) to each x, w going straight. */
static void turn_by_vector(const struct link *link, struct jet t, uint32_t points,
                           struct jet x[3][3])
{
    struct jet w[3];
    struct ball f[3], g[3];
    for (int i = 0; i < 3; i++) {
        w[i] = jet_add(jet_of(link->from[i]), jet_scale(t, link->slope[i]));
    }
    struct jet y = jet_dot(w, w);
    ball_turn_of_square(y.c[0], f, g);
    struct jet once_by = jet_chain(f, y), twice_by = jet_chain(g, y);
    for (uint32_t p = 0; p < points; p++) {
        struct jet once[3], twice[3];
        jet_cross(once, w, x[p]);
        jet_cross(twice, w, once);
        for (int i = 0; i < 3; i++) {
            struct jet more = jet_mul(once_by, once[i]);
            more = jet_add(more, jet_mul(twice_by, twice[i]));
            x[p][i] = jet_add(x[p][i], more);
        }
    }
}

static void shift_points(const struct link *link, struct jet t, uint32_t points,
                         struct jet x[3][3])
{
    for (uint32_t i = 0; i < 3 * points; i++) {
        bool slides = link->kind == PCCD_JOINT_SLIDE;
        uint32_t n = slides ? 0 : i % 3;
        struct jet d = jet_add(jet_of(link->from[n]), jet_scale(t, link->slope[n]));
        if (slides) {
            d = jet_scale(d, link->along[i % 3]);
        }
        x[i / 3][i % 3] = jet_add(x[i / 3][i % 3], d);
    }
}

static void place_points(const struct link *link, uint32_t points, struct jet x[3][3])
{
    for (uint32_t p = 0; p < points; p++) {
        struct jet was[3] = {x[p][0], x[p][1], x[p][2]};
        for (int i = 0; i < 3; i++) {
            struct jet sum = was[i];
            if (link->is_turned) {
                sum = jet_scale(was[0], link->rotation[i][0]);
                sum = jet_add(sum, jet_scale(was[1], link->rotation[i][1]));
                sum = jet_add(sum, jet_scale(was[2], link->rotation[i][2]));
            }
            sum.c[0] = ball_add(sum.c[0], link->position[i]);
            x[p][i] = sum;
        }
    }
}

/* Bound where its points are at all times of the ball, and how they move there. */
static void place_body(const struct body *body, struct ball time, struct jet x[3][3])
{
    const struct jet t = {{time, {1, 0}, {0, 0}}};
    for (uint32_t i = 0; i < 3 * body->points; i++) {
        const struct ball way = body->way[i / 3][i % 3];
        x[i / 3][i % 3] = jet_of(body->begin[i / 3][i % 3]);
        if (body->goes_straight) {
            x[i / 3][i % 3] = jet_add(x[i / 3][i % 3], jet_scale(t, way));
        }
    }
    for (uint32_t i = 0; i < body->count; i++) {
        const struct link *link = &body->links[i];
        if (link->kind == PCCD_JOINT_TURN) {
            turn_points(link, t, body->points, x);
        } else if (link->kind == PCCD_JOINT_VECTOR) {
            turn_by_vector(link, t, body->points, x);
        } else if (link->kind != PCCD_JOINT_FIXED) {
            shift_points(link, t, body->points, x);
        }
        place_points(link, body->points, x);
    }
}

/* ---- a span ------------------------------------------------------------------------ */

/* The points over a span: those of the first feature, then those of the second. */
struct span {
    double t0, t1;
    REAL half; /* from its middle to its ends, at most */
    uint32_t count[2];
    struct jet mid[4][3];
    struct jet all[4][3];
};

static void look(const struct body bodies[2], double t0, double t1, struct span *span)
{
    REAL mid = (REAL)(t0 + (t1 - t0) / 2);
    REAL before = mid - (REAL)t0, after = (REAL)t1 - mid;
    uint32_t at = 0;
    span->t0 = t0;
    span->t1 = t1;
    span->half = real_up(before > after ? before : after);
    for (int side = 0; side < 2; side++) {
        struct jet x[3][3];
        span->count[side] = bodies[side].points;
        place_body(&bodies[side], ball_exact(mid), x);
        memcpy(&span->mid[at], x, bodies[side].points * sizeof x[0]);
        place_body(&bodies[side], (struct ball){mid, span->half}, x);
        memcpy(&span->all[at], x, bodies[side].points * sizeof x[0]);
        at += bodies[side].points;
    }
}

/* Return what a function is s after the middle; s may be all of -half .. half. */
static struct ball after_middle(struct jet mid, struct jet all, struct ball s)
{
    struct ball square = ball_scale(ball_mul(s, s), (REAL)0.5);
    if (s.m == 0) { /* 0 .. half^2 / 2 */
        square = ball_of(square.r / 2, square.r / 2);
    }
    return ball_add(ball_add(mid.c[0], ball_mul(mid.c[1], s)),
                    ball_mul(all.c[2], square));
}

/* ---- the nearest points at the middle, by rounded numbers -------------------------- */

/* Two points of the features: base + w0 (other0 - base) + w1 (other1 - base) of each. */
struct way {
    int base[2];
    int other[2][2];
    REAL w[2][2];
    REAL n[3]; /* from the second to the first, perpendicular to what it is between */
    REAL square;
};

static REAL dot3(const REAL a[3], const REAL b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross3(REAL r[3], const REAL a[3], const REAL b[3])
{
    r[0] = a[1] * b[2] - a[2] * b[1];
    r[1] = a[2] * b[0] - a[0] * b[2];
    r[2] = a[0] * b[1] - a[1] * b[0];
}

static void sub3(REAL r[3], const REAL a[3], const REAL b[3])
{
    for (int k = 0; k < 3; k++) {
        r[k] = a[k] - b[k];
    }
}

static void keep_nearer(struct way *best, const struct way *way)
{
    if (!(way->square >= best->square)) {
        *best = *way;
    }
}

/* Try point i of side `side` with an edge of the other side from j to k, or a point:
 * k = j. */
static void try_foot(const REAL x[4][3], int side, int i, int j, int k, struct way *best)
{
    struct way way = {.base = {i, i}, .other = {{i, i}, {i, i}}};
    REAL w[3], e[3];
    sub3(w, x[i], x[j]);
    sub3(e, x[k], x[j]);
    REAL square = dot3(e, e);
    REAL along = 0;
    way.base[!side] = j;
    way.other[!side][0] = way.other[!side][1] = k;
    for (int pass = 0; pass < 2 && square > 0; pass++) {
        REAL more = dot3(w, e) / square; /* the second pass takes what rounding left */
        along += more;
        for (int axis = 0; axis < 3; axis++) {
            w[axis] -= more * e[axis];
        }
    }
    if (j != k && !(along > 0 && along < 1)) {
        return; /* one of its ends is nearer */
    }
    way.w[!side][0] = along;
    for (int axis = 0; axis < 3; axis++) {
        way.n[axis] = side == 0 ? w[axis] : -w[axis];
    }
    way.square = dot3(w, w);
    keep_nearer(best, &way);
}

/* Try a vertex and the inside of a triangle, or those of two edges: w from corner to
 * vertex, or from edge to edge, as u and v span. */
static void try_inside(const REAL x[4][3], bool is_face, struct way *best)
{
    struct way way = {.base = {0, is_face ? 1 : 2},
                      .other = {{is_face ? 0 : 1, 0}, {is_face ? 2 : 3, 3}}};
    REAL w[3], u[3], v[3], n[3], c[3];
    sub3(w, x[0], x[is_face ? 1 : 2]);
    sub3(u, x[is_face ? 2 : 1], x[is_face ? 1 : 0]);
    sub3(v, x[3], x[is_face ? 1 : 2]);
    cross3(n, u, v);
    REAL square = dot3(n, n);
    REAL height = dot3(w, n);
    cross3(c, w, v);
    REAL first = dot3(c, n) / square;
    cross3(c, is_face ? u : w, is_face ? w : u);
    REAL second = dot3(c, n) / square;
    if (is_face) {
        way.w[1][0] = first;
        way.w[1][1] = second;
    } else { /* w + s u = r v */
        way.w[0][0] = -first;
        way.w[1][0] = -second;
    }
    REAL a = is_face ? first : -first;
    REAL b = is_face ? second : -second;
    if (!(square > 0) || !(a > 0 && b > 0) || !(is_face ? a + b < 1 : a < 1 && b < 1)) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        way.n[k] = height < 0 ? -n[k] : n[k];
    }
    way.square = height * height / square;
    keep_nearer(best, &way);
}

static void find_way(const struct span *span, struct way *best)
{
    REAL x[4][3];
    int a = (int)span->count[0];
    int all = a + (int)span->count[1];
    for (int i = 0; i < 3 * all; i++) {
        x[i / 3][i % 3] = span->mid[i / 3][i % 3].c[0].m;
    }
    *best = (struct way){.square = (REAL)INFINITY};
    for (int i = 0; i < all; i++) {
        int side = i >= a;
        int begin = side == 0 ? a : 0;
        int end = side == 0 ? all : a;
        for (int j = begin; j < end; j++) {
            if (side == 0) {
                try_foot((const REAL(*)[3])x, 0, i, j, j, best);
            }
            for (int k = j + 1; k < end; k++) {
                try_foot((const REAL(*)[3])x, side, i, j, k, best);
            }
        }
    }
    if (all == 4) {
        try_inside((const REAL(*)[3])x, a == 1, best);
    }
    /* Only the direction counts. */
    REAL size = (REAL)sqrt((double)dot3(best->n, best->n));
    for (int k = 0; k < 3 && size > 0; k++) {
        best->n[k] /= size;
    }
}

/* ---- what is certain of a span ----------------------------------------------------- */

/* Return whether the direction keeps the features more than r apart all the time. */
static bool is_apart(const struct span *span, const REAL n[3], struct ball r)
{
    struct jet mid[4], all[4];
    uint32_t a = span->count[0], count = a + span->count[1];
    const struct ball s = {0, span->half};
    struct ball length = ball_exact(0);
    for (int k = 0; k < 3; k++) {
        length = ball_add(length, ball_mul(ball_exact(n[k]), ball_exact(n[k])));
    }
    length = ball_mul(ball_sqrt(length), r);
    for (uint32_t i = 0; i < count; i++) {
        mid[i] = all[i] = jet_of(ball_exact(0));
        for (int k = 0; k < 3; k++) {
            mid[i] = jet_add(mid[i], jet_scale(span->mid[i][k], ball_exact(n[k])));
            all[i] = jet_add(all[i], jet_scale(span->all[i][k], ball_exact(n[k])));
        }
    }
    for (uint32_t i = 0; i < a; i++) {
        for (uint32_t j = a; j < count; j++) {
            struct ball at =
                after_middle(jet_sub(mid[i], mid[j]), jet_sub(all[i], all[j]), s);
            if (!(ball_low(at) > ball_high(length))) {
                return false;
            }
        }
    }
    return true;
}

/* Keep the point in its feature, whatever was rounded. */
static void confine(REAL w[2])
{
    w[0] = w[0] > 0 ? w[0] < 1 ? w[0] : 1 : 0;
    w[1] = w[1] > 0 ? w[1] < 1 ? w[1] : 1 : 0;
    REAL sum = real_up(w[0] + w[1]);
    if (w[1] > 0 && sum > 1) {
        w[0] /= real_up(sum);
        w[1] /= real_up(sum);
        w[1] *= 1 - 64 * REAL_UNIT;
        w[0] *= 1 - 64 * REAL_UNIT;
    }
}

/* Return whether two points of the features are at most r apart at the middle. */
static bool is_within(const struct span *span, const struct way *way, struct ball r)
{
    struct ball square = ball_exact(0);
    REAL w[2][2] = {{way->w[0][0], way->w[0][1]}, {way->w[1][0], way->w[1][1]}};
    confine(w[0]);
    confine(w[1]);
    for (int k = 0; k < 3; k++) {
        struct ball at[2];
        for (int side = 0; side < 2; side++) {
            struct ball base = span->mid[way->base[side]][k].c[0];
            at[side] = base;
            for (int n = 0; n < 2; n++) {
                struct ball other = span->mid[way->other[side][n]][k].c[0];
                if (w[side][n] > 0) {
                    at[side] = ball_add(at[side], ball_mul(ball_exact(w[side][n]),
                                                           ball_sub(other, base)));
                }
            }
        }
        struct ball way_k = ball_sub(at[0], at[1]);
        square = ball_add(square, ball_mul(way_k, way_k));
    }
    return ball_high(square) <= ball_low(ball_mul(r, r));
}

/* Set the signed volume, and the sides that are above 0 where the features have the point
 * of both lines, or of line and plane, in common; return how many. */
static int set_sides(const struct jet x[4][3], bool is_face, struct jet *volume,
                     struct jet sides[5])
{
    struct jet w[3], u[3], v[3], n[3], c[3];
    for (int k = 0; k < 3; k++) {
        w[k] = jet_sub(x[0][k], x[is_face ? 1 : 2][k]);
        u[k] = jet_sub(x[is_face ? 2 : 1][k], x[is_face ? 1 : 0][k]);
        v[k] = jet_sub(x[3][k], x[is_face ? 1 : 2][k]);
    }
    jet_cross(n, u, v);
    *volume = jet_dot(w, n);
    sides[0] = jet_dot(n, n);
    jet_cross(c, w, v);
    sides[1] = jet_dot(c, n);
    jet_cross(c, is_face ? u : w, is_face ? w : u);
    sides[2] = jet_dot(c, n);
    if (is_face) {
        sides[3] = jet_sub(jet_sub(sides[0], sides[1]), sides[2]);
        return 4;
    }
    const struct ball minus = ball_exact(-1);
    sides[1] = jet_scale(sides[1], minus);
    sides[2] = jet_scale(sides[2], minus);
    sides[3] = jet_sub(sides[0], sides[1]);
    sides[4] = jet_sub(sides[0], sides[2]);
    return 5;
}

/* Return whether they pass through each other, of two features that cross in a point. */
static bool passes(const struct span *span)
{
    bool is_face = span->count[0] == 1;
    struct jet volume[2], mid[5], all[5];
    if (span->count[0] + span->count[1] != 4) {
        return false;
    }
    int count = set_sides((const struct jet(*)[3])span->mid, is_face, &volume[0], mid);
    set_sides((const struct jet(*)[3])span->all, is_face, &volume[1], all);
    for (int i = 0; i < count; i++) {
        const struct ball s = {0, span->half};
        if (!(ball_low(after_middle(mid[i], all[i], s)) > 0)) {
            return false;
        }
    }
    REAL middle = (REAL)(span->t0 + (span->t1 - span->t0) / 2);
    struct ball s = ball_sub(ball_exact((REAL)span->t0), ball_exact(middle));
    struct ball begin = after_middle(volume[0], volume[1], s);
    s = ball_sub(ball_exact((REAL)span->t1), ball_exact(middle));
    struct ball end = after_middle(volume[0], volume[1], s);
    return (ball_high(begin) < 0 && ball_low(end) > 0) ||
           (ball_low(begin) > 0 && ball_high(end) < 0);
}

/* ---- the search -------------------------------------------------------------------- */

struct stack {
    double t[STACK_MAX][2];
    uint32_t count;
};

static void push(struct stack *stack, double t0, double t1)
{
    stack->t[stack->count][0] = t0;
    stack->t[stack->count][1] = t1;
    stack->count++;
}

void REAL_SEARCH(const struct oracle_turning *pair,
                 const struct oracle_turning_asked *asked, uint32_t spans,
                 struct oracle_turning_answer *answer)
{
    struct body bodies[2];
    struct stack stack = {.count = 0};
    struct ball r = ball_exact(0);
    bool is_free = true; /* until now */
    bool has_radius = false;
    const double coarse = fmax(asked->width, 0x1p-6 * (asked->to - asked->from));
    *answer = (struct oracle_turning_answer){.free_until = asked->from,
                                             .met_by = ORACLE_TURNING_NEVER};
    for (int i = 0; i < 4; i++) {
        r = ball_add(r, ball_exact((REAL)pair->radius[i]));
        has_radius = has_radius || pair->radius[i] > 0;
    }
    if (!set_bodies(bodies, pair)) {
        return;
    }
    push(&stack, asked->from, asked->to);
    if (asked->from < asked->to) {
        push(&stack, asked->from, asked->from); /* which may be within r already */
    }
    while (stack.count > 0 && answer->spans < spans) {
        double t0 = stack.t[--stack.count][0], t1 = stack.t[stack.count][1];
        struct span span;
        struct way way;
        if (t0 >= answer->met_by) {
            break;
        }
        answer->spans++;
        look(bodies, t0, t1, &span);
        find_way(&span, &way);
        if (is_apart(&span, way.n, r)) {
            answer->free_until = is_free ? t1 : answer->free_until;
            continue;
        }
        double met = ORACLE_TURNING_NEVER;
        if (has_radius && is_within(&span, &way, r)) {
            met = t0 + (t1 - t0) / 2;
        } else if (!has_radius && passes(&span)) {
            met = t1;
        }
        answer->met_by = met < answer->met_by ? met : answer->met_by;
        double split = t0 + 0.4785 * (t1 - t0);
        /* Where something is open already, only a meeting is looked for. */
        double least = is_free ? asked->width * REAL_LEAST : coarse;
        bool is_exact = met < ORACLE_TURNING_NEVER && t1 - t0 <= asked->width;
        if (is_exact || t1 - t0 <= least || !(t0 < split && split < t1) ||
            stack.count + 2 > STACK_MAX) {
            is_free = false;
        } else {
            push(&stack, split, t1);
            push(&stack, t0, split);
        }
    }
    answer->is_free = is_free && stack.count == 0 &&
                      answer->met_by == ORACLE_TURNING_NEVER &&
                      answer->free_until == asked->to;
}

#endif
