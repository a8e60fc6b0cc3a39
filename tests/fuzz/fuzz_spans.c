/* fuzz_spans.c - what ranges prove about an elementary test.
 *
 * No contact in a span: the cubic's coefficients have one sign; or the features are out
 * of each other's reach wherever they are coplanar; or a fixed direction separates them
 * at both ends, in the same order, and so in between. Else the span is halved.
 */
#include "fuzz_spans.h"

#include "fuzz_range.h"

#ifdef FUZZ_SPANS_LONG
#define FUZZ_NAME(name) name##_long
#else
#define FUZZ_NAME(name) name##_double
#endif

#define SPANS_MAX  16
#define PROBES_MAX 60

/* How early a bracket begins is not told below this. */
#define EARLY_ENOUGH 0x1p-44

struct triple {
    struct range c[3];
};

/* A query's differences at both ends of the step. */
struct ends {
    enum pccd_kind kind;
    int gap_count;
    struct triple p[2];
    struct triple b[2];
    struct triple c[2];
    struct triple gap[4][2]; /* from each point of one feature to each of the other */
};

/* The same at a time. */
struct place {
    struct triple p;
    struct triple b;
    struct triple c;
    struct triple gap[4];
    struct triple n; /* b x c */
    struct range f;  /* p . n */
};

static struct triple between(const struct eng_query *query, int end, int from, int to)
{
    struct triple d;
    for (int k = 0; k < 3; k++) {
        d.c[k] =
            range_sub(range_of(query->x[end][to][k]), range_of(query->x[end][from][k]));
    }
    return d;
}

/* Differences are taken of the ends, where they are nearly exact, and then moved. */
static void set_ends(const struct eng_query *query, struct ends *ends)
{
    bool is_vf = query->kind == PCCD_VF;
    int first_count = is_vf ? 1 : 2;
    ends->kind = query->kind;
    for (int end = 0; end < 2; end++) {
        ends->p[end] = between(query, end, is_vf ? 1 : 0, is_vf ? 0 : 2);
        ends->b[end] = between(query, end, is_vf ? 1 : 0, is_vf ? 2 : 1);
        ends->c[end] = between(query, end, is_vf ? 1 : 3, is_vf ? 3 : 2);
        ends->gap_count = 0;
        for (int a = 0; a < first_count; a++) {
            for (int b = first_count; b < 4; b++) {
                ends->gap[ends->gap_count++][end] = between(query, end, a, b);
            }
        }
    }
}

static struct triple move(const struct triple ends[2], double t)
{
    struct triple d;
    if (t == 0 || t == 1) {
        return ends[t == 1];
    }
    struct range rest = range_sub(range_of(1), range_of(t));
    for (int k = 0; k < 3; k++) {
        d.c[k] = range_add(range_mul(rest, ends[0].c[k]),
                           range_mul(range_of(t), ends[1].c[k]));
    }
    return d;
}

static struct triple cross(const struct triple *a, const struct triple *b)
{
    struct triple out;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        out.c[k] = range_sub(range_mul(a->c[i], b->c[j]), range_mul(a->c[j], b->c[i]));
    }
    return out;
}

static struct range dot(const struct triple *a, const struct triple *b)
{
    struct range sum = range_mul(a->c[0], b->c[0]);
    sum = range_add(sum, range_mul(a->c[1], b->c[1]));
    return range_add(sum, range_mul(a->c[2], b->c[2]));
}

static struct triple sum(const struct triple *a, const struct triple *b)
{
    struct triple out;
    for (int k = 0; k < 3; k++) {
        out.c[k] = range_add(a->c[k], b->c[k]);
    }
    return out;
}

static struct triple unite(const struct triple *a, const struct triple *b)
{
    struct triple out;
    for (int k = 0; k < 3; k++) {
        out.c[k] = range_unite(a->c[k], b->c[k]);
    }
    return out;
}

static void set_place(const struct ends *ends, double t, struct place *place)
{
    place->p = move(ends->p, t);
    place->b = move(ends->b, t);
    place->c = move(ends->c, t);
    for (int i = 0; i < ends->gap_count; i++) {
        place->gap[i] = move(ends->gap[i], t);
    }
    place->n = cross(&place->b, &place->c);
    place->f = dot(&place->p, &place->n);
}

/* Return whether the cubic has one sign from l to r. Its coefficients in Bernstein form,
 * the middle ones times 3. */
static bool is_one_sided(const struct place *l, const struct place *r)
{
    int sign = range_sign(l->f);
    if (sign == 0 || range_sign(r->f) != sign) {
        return false;
    }
    struct triple lr = cross(&l->b, &r->c);
    struct triple rl = cross(&r->b, &l->c);
    struct triple mixed = sum(&lr, &rl);
    struct range f1 = range_add(dot(&r->p, &l->n), dot(&l->p, &mixed));
    struct range f2 = range_add(dot(&l->p, &r->n), dot(&r->p, &mixed));
    return range_sign(f1) == sign && range_sign(f2) == sign;
}

/* 1: the features are certainly within each other's reach if they are coplanar, at every
 * time between the places; -1: certainly not; 0: not known. With n = b x c the conditions
 * are (p x c) . n >= 0, (b x p) . n >= 0, and what is left of n . n. */
static int domain(const struct ends *ends, const struct place *l, const struct place *r)
{
    struct triple p = unite(&l->p, &r->p);
    struct triple b = unite(&l->b, &r->b);
    struct triple c = unite(&l->c, &r->c);
    struct triple n = cross(&b, &c);
    struct range nn = dot(&n, &n);
    struct triple m = cross(&p, &c);
    struct range beta = dot(&m, &n);
    m = cross(&b, &p);
    struct range gamma = dot(&m, &n);
    struct range rest[2];
    if (ends->kind == PCCD_VF) {
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

/* Return whether all points of one feature are before all of the other along `direction`
 * at both times. Any numbers will do. */
static bool separates(const struct ends *ends, const struct place *l,
                      const struct place *r, const FUZZ_REAL direction[3])
{
    struct triple d;
    int sign = 0;
    for (int k = 0; k < 3; k++) {
        d.c[k] = (struct range){direction[k], direction[k]};
    }
    for (int i = 0; i < ends->gap_count; i++) {
        int sign_l = range_sign(dot(&d, &l->gap[i]));
        int sign_r = range_sign(dot(&d, &r->gap[i]));
        if (sign_l == 0 || sign_l != sign_r || (i > 0 && sign_l != sign)) {
            return false;
        }
        sign = sign_l;
    }
    return true;
}

/* About the middle of each range: which numbers, does not matter. */
static void middle(const struct triple *a, FUZZ_REAL out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = (FUZZ_REAL)0.5 * (a->c[k].lo + a->c[k].hi);
    }
}

static void cross_middle(const FUZZ_REAL a[3], const FUZZ_REAL b[3], FUZZ_REAL out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

/* Return whether there is a direction that separates them: the axes, the normal, what
 * is across each edge within the plane, and the way from one feature to the other are
 * tried. */
static bool is_separated(const struct ends *ends, const struct place *l,
                         const struct place *r)
{
    static const FUZZ_REAL axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; k++) {
        if (separates(ends, l, r, axes[k])) {
            return true;
        }
    }
    const struct place *const places[2] = {l, r};
    for (int i = 0; i < 2; i++) {
        FUZZ_REAL p[3];
        FUZZ_REAL b[3];
        FUZZ_REAL c[3];
        FUZZ_REAL n[3];
        FUZZ_REAL across[3][3];
        middle(&places[i]->p, p);
        middle(&places[i]->b, b);
        middle(&places[i]->c, c);
        cross_middle(b, c, n);
        cross_middle(n, b, across[0]);
        cross_middle(n, c, across[1]);
        for (int k = 0; k < 3; k++) {
            c[k] -= b[k];
        }
        cross_middle(n, c, across[2]);
        for (int j = 0; j < 3; j++) {
            if (separates(ends, l, r, across[j])) {
                return true;
            }
        }
        if (separates(ends, l, r, n) || separates(ends, l, r, p)) {
            return true;
        }
    }
    return false;
}

static bool is_clear_span(const struct ends *ends, const struct place *l,
                          const struct place *r)
{
    return is_one_sided(l, r) || domain(ends, l, r) < 0 || is_separated(ends, l, r);
}

/* From l to where there is certainly no contact: r, or less. The spans that are left wait
 * on a stack, the earliest on top. */
double FUZZ_NAME(fuzz_clear_until)(const struct eng_query *query, double l, double r,
                                   int work)
{
    struct ends ends;
    struct place at[SPANS_MAX + 1];
    double time[SPANS_MAX + 1];
    int top = 1;
    set_ends(query, &ends);
    time[0] = r;
    time[1] = l;
    set_place(&ends, r, &at[0]);
    set_place(&ends, l, &at[1]);
    while (top > 0) {
        if (work-- == 0) {
            break;
        }
        if (is_clear_span(&ends, &at[top], &at[top - 1])) {
            top--;
            continue;
        }
        if (top == SPANS_MAX) {
            break;
        }
        double m = 0.5 * (time[top] + time[top - 1]);
        time[top + 1] = time[top];
        at[top + 1] = at[top];
        time[top] = m;
        set_place(&ends, m, &at[top]);
        top++;
    }
    return time[top];
}

/* Span in which the sign of the cubic changes, and about what it is there. */
struct span_of_root {
    double l;
    double r;
    FUZZ_REAL f_l;
    FUZZ_REAL f_r;
    int sign; /* at l */
};

/* Until the root's distance from `begin` is known within a tenth. */
static void narrow(const struct ends *ends, double begin, struct span_of_root *root)
{
    for (int i = 0; i < PROBES_MAX; i++) {
        double left = root->r - root->l;
        if (root->r - begin <= EARLY_ENOUGH || left <= 0.1 * (root->r - begin)) {
            return;
        }
        /* Just after the secant's root, or, where that has not helped, in the middle. */
        double share = i % 2 ? 0.5 : (double)(root->f_l / (root->f_l - root->f_r));
        double m = root->l + left * (share + 0x1p-6);
        struct place place;
        if (!(root->l < m && m < root->r)) {
            continue;
        }
        set_place(ends, m, &place);
        int sign = range_sign(place.f);
        if (sign == 0) {
            return;
        }
        *(sign == root->sign ? &root->l : &root->r) = m;
        *(sign == root->sign ? &root->f_l : &root->f_r) = place.f.lo;
    }
}

/* Certainly a contact between l and r, if there is none before l? *early: it is before
 * l + *early. */
bool FUZZ_NAME(fuzz_is_crossing)(const struct eng_query *query, double l, double r,
                                 double *early)
{
    struct ends ends;
    struct place at_l;
    struct place at_r;
    set_ends(query, &ends);
    set_place(&ends, l, &at_l);
    set_place(&ends, r, &at_r);
    int sign = range_sign(at_l.f);
    if (sign == 0 || range_sign(at_r.f) != -sign || domain(&ends, &at_l, &at_r) != 1) {
        return false;
    }
    /* The first root is before any time at which the sign has changed. */
    struct span_of_root root = {l, r, at_l.f.lo, at_r.f.lo, sign};
    narrow(&ends, l, &root);
    *early = root.r - l;
    return true;
}

#ifndef FUZZ_SPANS_LONG

bool fuzz_is_apart(const struct eng_query *query)
{
    int first_count = query->kind == PCCD_VF ? 1 : 2;
    for (int k = 0; k < 3; k++) {
        bool before = true;
        bool after = true;
        for (int end = 0; end < 2; end++) {
            for (int a = 0; a < first_count; a++) {
                for (int b = first_count; b < 4; b++) {
                    before &= query->x[end][a][k] < query->x[end][b][k];
                    after &= query->x[end][a][k] > query->x[end][b][k];
                }
            }
        }
        if (before || after) {
            return true;
        }
    }
    return false;
}

#endif
