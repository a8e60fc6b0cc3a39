/* distance_rule.c - what a distance is between.
 *
 * Two points of convex features are nearest exactly if, seen from each of them, no corner
 * of its own feature lies further on towards the other point. That is asked of all pairs
 * of vertices, then of every vertex and its foot on an edge; where all say no, the
 * distance is between the insides. It needs no comparison of lengths (BOUNDS.md,
 * "Distances: what they are between").
 */
#include "distance_rule.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum answer { NO, YES, STRICTLY, NOBODY_KNOWS };

/* Return whether all of them are at most 0. STRICTLY: below. */
static enum answer at_most_0(enum eng_sign a, enum eng_sign b)
{
    if (a == ENG_PLUS || b == ENG_PLUS) {
        return NO;
    }
    if (a == ENG_UNSURE || b == ENG_UNSURE) {
        return NOBODY_KNOWS;
    }
    return a == ENG_MINUS && b == ENG_MINUS ? STRICTLY : YES;
}

static enum eng_sign opposite(enum eng_sign sign)
{
    return sign == ENG_PLUS ? ENG_MINUS : sign == ENG_MINUS ? ENG_PLUS : sign;
}

/* A candidate that may be chosen, or the one chosen so far; keys say which is first. */
struct choice {
    bool is_open; /* somebody might be chosen, nobody knows */
    bool is_only; /* no other can be as near */
    bool is_made;
    unsigned key;
    int first;  /* the vertex; VV: of the first feature */
    int second; /* the other vertex; VE: the edge's begin */
    int third;  /* VE: the edge's end */
};

static void offer(struct choice *choice, enum answer answer, struct choice candidate)
{
    if (answer == NOBODY_KNOWS) {
        choice->is_open = true;
    } else if (answer != NO && (!choice->is_made || candidate.key < choice->key)) {
        bool is_open = choice->is_open;
        *choice = candidate;
        choice->is_made = true;
        choice->is_open = is_open;
    }
    choice->is_only |= answer == STRICTLY;
}

static unsigned sorted_key(unsigned a, unsigned b, bool higher_first)
{
    unsigned lower = a < b ? a : b;
    unsigned higher = a < b ? b : a;
    return higher_first ? higher << 8 | lower : lower << 8 | higher;
}

/* A pair in terms of what both kinds have in common. */
struct pair {
    struct eng_numbers *numbers;
    enum pccd_kind kind;
    const uint8_t *rank;
    struct eng_vector from[4][4]; /* from[i][j] = x[i] - x[j]; those that are needed */
    /* (x[i] - x[j]) . (x[k] - x[j]): how far the foot of i on the edge from j to k is
     * from j. VF: along[j][k], i is the vertex. EE: along[i][j], k is the other end of
     * the edge of j. */
    struct eng_number along[4][4];
    enum eng_sign sign[4][4];
};

static void set_from(struct pair *pair, int i, int j)
{
    pair->from[i][j] = eng_number_between(pair->numbers, i, j);
}

static void set_along(struct pair *pair, int i, int j, const struct eng_vector *w,
                      const struct eng_vector *e)
{
    pair->along[i][j] = eng_number_dot(pair->numbers, w, e);
    pair->sign[i][j] = eng_number_sign(pair->numbers, pair->along[i][j]);
}

static int other_end(int i)
{
    return i ^ 1;
}

static void set_up(struct pair *pair)
{
    if (pair->kind == PCCD_VF) {
        for (int j = 1; j <= 3; j++) {
            set_from(pair, 0, j);
            for (int k = 1; k <= 3; k++) {
                if (k != j) {
                    set_from(pair, k, j);
                    set_along(pair, j, k, &pair->from[0][j], &pair->from[k][j]);
                }
            }
        }
        return;
    }
    for (int i = 0; i < 4; i++) {
        set_from(pair, i, other_end(i));
        set_from(pair, i, i < 2 ? 2 : 0);
        set_from(pair, i, i < 2 ? 3 : 1);
    }
    for (int i = 0; i < 4; i++) {
        for (int end = 0; end < 2; end++) {
            int j = (i < 2 ? 2 : 0) + end;
            set_along(pair, i, j, &pair->from[i][j], &pair->from[other_end(j)][j]);
        }
    }
}

/* Return whether vertex i of the first feature and j of the second are nearest. */
static enum answer vertices_are_nearest(const struct pair *pair, int i, int j)
{
    if (pair->kind == PCCD_VF) {
        return at_most_0(pair->sign[j][1 + j % 3], pair->sign[j][1 + (j + 1) % 3]);
    }
    return at_most_0(pair->sign[i][j], pair->sign[j][i]);
}

static void choose_vertices(const struct pair *pair, struct choice *choice)
{
    int count = pair->kind == PCCD_VF ? 3 : 4;
    for (int n = 0; n < count && !choice->is_only; n++) {
        int i = pair->kind == PCCD_VF ? 0 : n / 2;
        int j = pair->kind == PCCD_VF ? 1 + n : 2 + n % 2;
        struct choice candidate = {.key = sorted_key(pair->rank[i], pair->rank[j], false),
                                   .first = i,
                                   .second = j};
        offer(choice, vertices_are_nearest(pair, i, j), candidate);
    }
}

/* Return whether vertex i and its foot strictly between j and k are nearest. Where w is
 * from j to the vertex, e from j to k and `more` what still has to be looked at, times e
 * . e,
 *   VF  (foot to vertex) . (third corner - j) = (e x w) . (e x (third - j)) <= 0
 *   EE  (foot to vertex) . (other end - i)    = (e x w) . (e x (other - i)) >= 0 */
static enum answer foot_is_nearest(struct pair *pair, int i, int j, int k)
{
    bool is_vf = pair->kind == PCCD_VF;
    enum eng_sign at_j = is_vf ? pair->sign[j][k] : pair->sign[i][j];
    enum eng_sign at_k = is_vf ? pair->sign[k][j] : pair->sign[i][k];
    if (at_j == ENG_MINUS || at_j == ENG_ZERO || at_k == ENG_MINUS || at_k == ENG_ZERO) {
        return NO;
    }
    int third = is_vf ? 6 - j - k : other_end(i);
    const struct eng_vector *e = &pair->from[k][j];
    const struct eng_vector *more = is_vf ? &pair->from[third][j] : &pair->from[third][i];
    struct eng_number_mark mark = eng_numbers_mark(pair->numbers);
    struct eng_vector one = eng_number_cross(pair->numbers, e, &pair->from[i][j]);
    struct eng_vector other = eng_number_cross(pair->numbers, e, more);
    struct eng_number value = eng_number_dot(pair->numbers, &one, &other);
    enum eng_sign sign = eng_number_sign(pair->numbers, value);
    eng_numbers_forget(pair->numbers, mark);
    enum answer answer = at_most_0(is_vf ? sign : opposite(sign), ENG_MINUS);
    bool is_sure = at_j == ENG_PLUS && at_k == ENG_PLUS;
    return answer == NO || is_sure ? answer : NOBODY_KNOWS;
}

static void choose_foot(struct pair *pair, struct choice *choice)
{
    int count = pair->kind == PCCD_VF ? 3 : 4;
    for (int n = 0; n < count && !choice->is_only; n++) {
        int i = pair->kind == PCCD_VF ? 0 : n;
        int j = pair->kind == PCCD_VF ? 1 + n : n < 2 ? 2 : 0;
        int k = pair->kind == PCCD_VF ? 1 + (n + 1) % 3 : j + 1;
        struct choice candidate = {.key = (unsigned)pair->rank[i] << 16 |
                                          sorted_key(pair->rank[j], pair->rank[k], true),
                                   .first = i,
                                   .second = j,
                                   .third = k};
        offer(choice, foot_is_nearest(pair, i, j, k), candidate);
    }
}

static void set_vertices(struct pair *pair, const struct choice *choice,
                         struct eng_distance_exact *way)
{
    int i = choice->first;
    int j = choice->second;
    way->type = ENG_NEAREST_VV;
    way->points = 1u << i | 1u << j;
    way->at[0] = pair->kind == PCCD_VF ? j == 2 : i == 1;
    way->at[1] = j == 3;
    way->g = pair->from[i][j];
    way->num = eng_number_dot(pair->numbers, &way->g, &way->g);
    way->den = eng_number_one(pair->numbers);
    way->gg = way->num;
    way->side = ENG_PLUS;
}

/* g = (e . e) w - (w . e) e,  g . g = (e . e) |e x w|^2 */
static void set_foot(struct pair *pair, const struct choice *choice,
                     struct eng_distance_exact *way)
{
    struct eng_numbers *numbers = pair->numbers;
    int i = choice->first;
    int j = choice->second;
    int k = choice->third;
    const struct eng_vector *w = &pair->from[i][j];
    const struct eng_vector *e = &pair->from[k][j];
    bool is_vf = pair->kind == PCCD_VF;
    struct eng_number from_j = is_vf ? pair->along[j][k] : pair->along[i][j];
    struct eng_number from_k = is_vf ? pair->along[k][j] : pair->along[i][k];
    struct eng_vector cross = eng_number_cross(numbers, e, w);
    way->type = ENG_NEAREST_VE;
    way->points = 1u << i | 1u << j | 1u << k;
    way->num = eng_number_dot(numbers, &cross, &cross);
    way->den = eng_number_dot(numbers, e, e);
    way->gg = eng_number_mul(numbers, way->den, way->num);
    way->side = is_vf || i < 2 ? ENG_PLUS : ENG_MINUS;
    for (int axis = 0; axis < 3; axis++) {
        struct eng_number left = eng_number_mul(numbers, way->den, w->c[axis]);
        struct eng_number right = eng_number_mul(numbers, from_j, e->c[axis]);
        way->g.c[axis] = eng_number_sub(numbers, left, right);
    }
    if (!is_vf) {
        way->at[j == 2] = NAN;
        way->share[j == 2] = from_j;
        way->at[j != 2] = i % 2;
        return;
    }
    for (int corner = 2; corner <= 3; corner++) {
        way->at[corner - 2] = corner == j || corner == k ? NAN : 0;
        way->share[corner - 2] = corner == k ? from_j : from_k;
    }
}

/* Set the distance where both are nearest at their insides. With n = u x v it is |w . n|
 * / |n|, and
 *   VF  w = p - a, u = b - a, v = c - a:   (w x v) . n, (u x w) . n   times n . n
 *   EE  w = c - a, u = b - a, v = c - d:   the same, along u and from c to d */
static void set_inside(struct pair *pair, struct eng_distance_exact *way)
{
    struct eng_numbers *numbers = pair->numbers;
    bool is_vf = pair->kind == PCCD_VF;
    const struct eng_vector *w = is_vf ? &pair->from[0][1] : &pair->from[2][0];
    const struct eng_vector *u = is_vf ? &pair->from[2][1] : &pair->from[1][0];
    const struct eng_vector *v = is_vf ? &pair->from[3][1] : &pair->from[2][3];
    struct eng_vector cross;
    way->type = is_vf ? ENG_NEAREST_VF : ENG_NEAREST_EE;
    way->points = 15;
    way->g = eng_number_cross(numbers, u, v);
    way->gg = eng_number_dot(numbers, &way->g, &way->g);
    way->den = way->gg;
    struct eng_number height = eng_number_dot(numbers, w, &way->g);
    way->side = eng_number_sign(numbers, height);
    way->side = is_vf ? way->side : opposite(way->side);
    way->num = eng_number_mul(numbers, height, height);
    cross = eng_number_cross(numbers, w, v);
    way->share[0] = eng_number_dot(numbers, &cross, &way->g);
    cross = eng_number_cross(numbers, u, w);
    way->share[1] = eng_number_dot(numbers, &cross, &way->g);
    way->at[0] = NAN;
    way->at[1] = NAN;
}

void eng_distance_rule(struct eng_numbers *numbers, enum pccd_kind kind,
                       const uint8_t rank[4], struct eng_distance_exact *way)
{
    assert(kind == PCCD_VF || kind == PCCD_EE);
    struct pair pair = {.numbers = numbers, .kind = kind, .rank = rank};
    struct choice choice = {0};
    set_up(&pair);
    choose_vertices(&pair, &choice);
    if (choice.is_made && (choice.is_only || !choice.is_open)) {
        set_vertices(&pair, &choice, way);
        return;
    }
    if (!choice.is_made) {
        choose_foot(&pair, &choice);
    }
    if (choice.is_made && (choice.is_only || !choice.is_open)) {
        set_foot(&pair, &choice, way);
    } else if (choice.is_open) {
        numbers->is_unsure = true;
    } else {
        set_inside(&pair, way);
    }
}

/* Sign of (x[j] - x[i]) . ((x[k] - x[i]) x (x[l] - x[i])). */
static enum eng_sign side_of(struct eng_numbers *numbers, int i, int j, int k, int l)
{
    struct eng_number_mark mark = eng_numbers_mark(numbers);
    struct eng_vector a = eng_number_between(numbers, j, i);
    struct eng_vector b = eng_number_between(numbers, k, i);
    struct eng_vector c = eng_number_between(numbers, l, i);
    struct eng_vector cross = eng_number_cross(numbers, &b, &c);
    enum eng_sign sign = eng_number_sign(numbers, eng_number_dot(numbers, &a, &cross));
    eng_numbers_forget(numbers, mark);
    return sign;
}

/* Both are sure and strictly different. Sets is_unsure where that may be so. */
static bool differ(struct eng_numbers *numbers, enum eng_sign a, enum eng_sign b)
{
    if (a == ENG_ZERO || b == ENG_ZERO) {
        return false;
    }
    if (a == ENG_UNSURE || b == ENG_UNSURE) {
        numbers->is_unsure = true;
        return false;
    }
    return a != b;
}

bool eng_crossing_rule(struct eng_numbers *numbers)
{
    enum eng_sign turn = side_of(numbers, 0, 1, 2, 3);
    if (!differ(numbers, turn, opposite(side_of(numbers, 0, 1, 3, 4))) ||
        !differ(numbers, turn, opposite(side_of(numbers, 0, 1, 4, 2)))) {
        return false;
    }
    return differ(numbers, side_of(numbers, 2, 0, 3, 4), side_of(numbers, 2, 1, 3, 4));
}
