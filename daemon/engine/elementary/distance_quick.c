/* distance_quick.c - distances by doubles, where those are sure. */
#include "distance_quick.h"

#include <math.h>
#include <string.h>

#include "query.h"
#include "vec.h"

/* Sizes for which nothing that is added up here overflows, or loses more than LOST. */
#define SIZE_LEAST 0x1p-100
#define SIZE_MOST  0x1p62
#define LOST       0x1p-900
#define SQUARE_MIN 0x1p-850

#define DOT_ERROR    (18.5 * ENG_U) /* of two differences, times their sizes */
#define CROSS_ERROR  (8.5 * ENG_U)  /* likewise, of a coordinate */
#define NORMAL_RATIO 0x1p-30        /* of the error of a normal to it, at most */

static double dot_error(double size_a, double size_b)
{
    return DOT_ERROR * size_a * size_b + LOST;
}

/* A cross product of two differences; each coordinate is off by `error` at most. */
struct across {
    double c[3];
    double size;
    double error;
};

static struct across across(const double a[3], double size_a, const double b[3],
                            double size_b)
{
    struct across out;
    eng_cross(out.c, a, b);
    out.size = eng_size(out.c);
    out.error = CROSS_ERROR * size_a * size_b + LOST;
    return out;
}

/* *error: of the dot product of the true ones. */
static double across_dot(const struct across *a, const struct across *b, double *error)
{
    *error = 3.1 * (a->size * b->error + b->size * a->error + a->error * b->error) +
             9.5 * ENG_U * a->size * b->size + LOST;
    return eng_dot(a->c, b->c);
}

/* Two vertices, w between them. */
static bool place_vertices(const double w[3], struct eng_place *place)
{
    double ww = eng_dot(w, w);
    if (!(ww > SQUARE_MIN)) {
        return false;
    }
    place->type = ENG_NEAREST_VV;
    place->length = sqrt(ww);
    place->is_exact = false;
    place->length_error = 5 * ENG_U * place->length;
    place->param_error[0] = place->param_error[1] = 0;
    for (int k = 0; k < 3; k++) {
        place->direction[k] = w[k] / place->length;
    }
    place->direction_error = 8 * ENG_U;
    return true;
}

/* A vertex and its foot on an edge e, w from the edge's nearer end, along = w . e. *at is
 * where the foot is. */
static bool place_foot(const double w[3], const double e[3], double along,
                       struct eng_place *place, double *at)
{
    double size_w = eng_size(w);
    double size_e = eng_size(e);
    struct across cross = across(e, size_e, w, size_w);
    double ee = eng_dot(e, e);
    double mm = eng_dot(cross.c, cross.c);
    if (!(ee > SQUARE_MIN && mm > SQUARE_MIN)) {
        return false;
    }
    double length_e = sqrt(ee);
    double length = sqrt(mm) / length_e;
    place->type = ENG_NEAREST_VE;
    place->length = length;
    place->is_exact = false;
    place->length_error = 1.8 * cross.error / length_e + 12 * ENG_U * length;
    *at = along / ee;
    /* The last part is for whoever takes 1 - *at. */
    double at_error = dot_error(size_w, size_e) / ee + 10 * ENG_U * *at + 4 * ENG_U;
    place->param_error[0] = place->param_error[1] = at_error;
    for (int k = 0; k < 3; k++) {
        place->direction[k] = (w[k] - *at * e[k]) / length;
    }
    place->direction_error =
        1.1 *
            (4 * ENG_U * size_w + (at_error + 6 * ENG_U) * size_e + place->length_error) /
            length +
        6 * ENG_U;
    return true;
}

/* Inside a face or on two edges: n is across both, w between any two of their points. */
static bool place_inside(const struct across *n, const double w[3],
                         struct eng_place *place, double *nn, double *nn_error)
{
    *nn = across_dot(n, n, nn_error);
    if (!(*nn > SQUARE_MIN && n->error <= NORMAL_RATIO * n->size)) {
        return false;
    }
    double length_n = sqrt(*nn);
    double height = eng_dot(w, n->c);
    double size_w = eng_size(w);
    double height_error = 3.1 * size_w * (n->error + 4.5 * ENG_U * n->size) + LOST;
    if (!(fabs(height) > height_error)) {
        return false;
    }
    place->points = 15;
    place->length = fabs(height) / length_n;
    place->is_exact = false;
    place->length_error =
        1.1 * (height_error + 1.8 * place->length * n->error) / length_n +
        10 * ENG_U * place->length;
    double sign = height < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        place->direction[k] = sign * n->c[k] / length_n;
    }
    place->direction_error = 3 * n->error / length_n + 8 * ENG_U;
    return true;
}

/* Is x the difference of a and b, exactly? */
static bool is_difference(double x, double a, double b)
{
    double other = a - x;
    return a - (x + other) == 0 && other - b == 0;
}

/* Of a place inside: where both edges, u and v, lie across an axis, the distance is how
 * far the points a and b of the features are apart along it. */
static void look_along_axes(const double u[3], const double v[3], const double a[3],
                            const double b[3], struct eng_place *place)
{
    for (int k = 0; k < 3; k++) {
        double apart = a[k] - b[k];
        if (u[k] == 0 && v[k] == 0 && is_difference(apart, a[k], b[k])) {
            place->length = fabs(apart);
            place->length_error = 0;
            place->is_exact = true;
        }
    }
}

static double share_error(double share, double error, double nn, double nn_error)
{
    return 1.1 * (error + share * nn_error) / nn + 4 * ENG_U * share;
}

/* The smallest of some vectors. */
static const double *smallest(const double (*const *w)[3], int count)
{
    const double *best = *w[0];
    for (int i = 1; i < count; i++) {
        best = eng_size(*w[i]) < eng_size(best) ? *w[i] : best;
    }
    return best;
}

/* Differences of a vertex and a face. Corner i; side i is the edge from corner i to the
 * next, i + 1. */
struct face {
    double to_vertex[3][3]; /* from corner i */
    double side[3][3];
    double size_to[3];
    double size_side[3];
    double ahead[3]; /* to_vertex[i] . side[i] */
    double back[3];  /* to_vertex[i] . -side[i - 1] */
    double ahead_error[3];
    double back_error[3];
};

static int next(int i)
{
    return i == 2 ? 0 : i + 1;
}

static bool is_in_range(double size)
{
    return size >= SIZE_LEAST && size <= SIZE_MOST;
}

static bool set_face(const double x[4][3], struct face *face)
{
    double size = 0;
    for (int i = 0; i < 3; i++) {
        eng_sub(face->to_vertex[i], x[0], x[1 + i]);
        eng_sub(face->side[i], x[1 + next(i)], x[1 + i]);
        face->size_to[i] = eng_size(face->to_vertex[i]);
        face->size_side[i] = eng_size(face->side[i]);
        size = eng_most(size, eng_most(face->size_to[i], face->size_side[i]));
    }
    for (int i = 0; i < 3; i++) {
        int k = next(i);
        face->ahead[i] = eng_dot(face->to_vertex[i], face->side[i]);
        face->ahead_error[i] = dot_error(face->size_to[i], face->size_side[i]);
        face->back[k] = -eng_dot(face->to_vertex[k], face->side[i]);
        face->back_error[k] = dot_error(face->size_to[k], face->size_side[i]);
    }
    return is_in_range(size);
}

/* The vertex's foot on side i. */
static bool place_on_side(const struct face *face, int i, struct eng_place *place)
{
    int k = next(i);
    double at;
    double back[3] = {-face->side[i][0], -face->side[i][1], -face->side[i][2]};
    bool from_next = face->back[k] < face->ahead[i];
    if (!(from_next ? place_foot(face->to_vertex[k], back, face->back[k], place, &at)
                    : place_foot(face->to_vertex[i], face->side[i], face->ahead[i], place,
                                 &at))) {
        return false;
    }
    double weight[3] = {0, 0, 0};
    weight[i] = from_next ? at : 1 - at;
    weight[k] = from_next ? 1 - at : at;
    for (int corner = 1; corner < 3; corner++) {
        place->param[corner - 1] = weight[corner];
        if (corner != i && corner != k) {
            place->param_error[corner - 1] = 0;
        }
    }
    place->points = 1u | 2u << i | 2u << k;
    return true;
}

static bool place_face(const double x[4][3], struct eng_place *place)
{
    struct face face;
    if (!set_face(x, &face)) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        if (face.ahead[i] < -face.ahead_error[i] && face.back[i] < -face.back_error[i]) {
            place->points = 1u | 2u << i;
            place->param[0] = i == 1;
            place->param[1] = i == 2;
            return place_vertices(face.to_vertex[i], place);
        }
    }
    double back[3] = {-face.side[2][0], -face.side[2][1], -face.side[2][2]};
    struct across n = across(face.side[0], face.size_side[0], back, face.size_side[2]);
    double share[3]; /* of the corner that side i does not have, times n . n */
    double error[3];
    bool is_inside = true;
    for (int i = 0; i < 3; i++) {
        int k = next(i);
        struct across m =
            across(face.side[i], face.size_side[i], face.to_vertex[i], face.size_to[i]);
        share[i] = across_dot(&m, &n, &error[i]);
        if (share[i] < -error[i] && face.ahead[i] > face.ahead_error[i] &&
            face.back[k] > face.back_error[k]) {
            return place_on_side(&face, i, place);
        }
        is_inside &= share[i] > error[i];
    }
    const double(*const ways[3])[3] = {&face.to_vertex[0], &face.to_vertex[1],
                                       &face.to_vertex[2]};
    double nn;
    double nn_error;
    if (!is_inside || !place_inside(&n, smallest(ways, 3), place, &nn, &nn_error)) {
        return false;
    }
    look_along_axes(face.side[0], face.side[2], x[0], x[1], place);
    place->type = ENG_NEAREST_VF;
    place->param[0] = share[2] / nn; /* of corner 1, which side 2 does not have */
    place->param[1] = share[0] / nn;
    place->param_error[0] = share_error(place->param[0], error[2], nn, nn_error);
    place->param_error[1] = share_error(place->param[1], error[0], nn, nn_error);
    return true;
}

/* Differences of two edges: ends 0 and 1 of the first, 2 and 3 of the second. */
struct edges {
    double edge[2][3];
    double size_edge[2];
    double way[2][2][3]; /* way[i][j]: from end 2 + j to end i */
    double size_way[2][2];
    /* The foot of an end on the other edge: how far it is from each of its ends, times
     * the edge's length. */
    double foot[4][2];
    double foot_error[4][2];
};

static bool set_edges(const double x[4][3], struct edges *edges)
{
    double size = 0;
    for (int i = 0; i < 2; i++) {
        eng_sub(edges->edge[i], x[2 * i + 1], x[2 * i]);
        edges->size_edge[i] = eng_size(edges->edge[i]);
        size = eng_most(size, edges->size_edge[i]);
        for (int j = 0; j < 2; j++) {
            eng_sub(edges->way[i][j], x[i], x[2 + j]);
            edges->size_way[i][j] = eng_size(edges->way[i][j]);
            size = eng_most(size, edges->size_way[i][j]);
        }
    }
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            const double *way = edges->way[i][j];
            double on_second = eng_dot(way, edges->edge[1]);
            double on_first = -eng_dot(way, edges->edge[0]);
            edges->foot[i][j] = j == 0 ? on_second : -on_second;
            edges->foot[2 + j][i] = i == 0 ? on_first : -on_first;
            edges->foot_error[i][j] =
                dot_error(edges->size_way[i][j], edges->size_edge[1]);
            edges->foot_error[2 + j][i] =
                dot_error(edges->size_way[i][j], edges->size_edge[0]);
        }
    }
    return is_in_range(size);
}

/* Is the foot of `end` strictly within the other edge? */
static bool has_foot(const struct edges *edges, int end)
{
    return edges->foot[end][0] > edges->foot_error[end][0] &&
           edges->foot[end][1] > edges->foot_error[end][1];
}

/* `end` and its foot on the other edge. */
static bool place_end(const struct edges *edges, int end, struct eng_place *place)
{
    int near = edges->foot[end][1] < edges->foot[end][0];
    double w[3];
    double e[3];
    double at;
    for (int k = 0; k < 3; k++) {
        w[k] = end < 2 ? edges->way[end][near][k] : -edges->way[near][end - 2][k];
        e[k] = near ? -edges->edge[end < 2][k] : edges->edge[end < 2][k];
    }
    if (!place_foot(w, e, edges->foot[end][near], place, &at)) {
        return false;
    }
    place->param[end < 2] = near ? 1 - at : at;
    place->param[end >= 2] = end % 2;
    place->param_error[end >= 2] = 0;
    place->points = 1u << end | (end < 2 ? 12u : 3u);
    for (int k = 0; k < 3 && end >= 2; k++) {
        place->direction[k] = -place->direction[k];
    }
    return true;
}

static bool place_edges(const double x[4][3], struct eng_place *place)
{
    struct edges edges;
    if (!set_edges(x, &edges)) {
        return false;
    }
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            if (edges.foot[i][j] < -edges.foot_error[i][j] &&
                edges.foot[2 + j][i] < -edges.foot_error[2 + j][i]) {
                place->points = 1u << i | 4u << j;
                place->param[0] = i;
                place->param[1] = j;
                return place_vertices(edges.way[i][j], place);
            }
        }
    }
    struct across n =
        across(edges.edge[0], edges.size_edge[0], edges.edge[1], edges.size_edge[1]);
    double inward[4]; /* how far each end is from the common perpendicular, times n . n */
    double error[4];
    bool is_inside = true;
    for (int end = 0; end < 4; end++) {
        bool is_first = end < 2;
        const double *way = is_first ? edges.way[end][0] : edges.way[0][end - 2];
        double size = is_first ? edges.size_way[end][0] : edges.size_way[0][end - 2];
        struct across m =
            across(edges.edge[is_first], edges.size_edge[is_first], way, size);
        double value = across_dot(&m, &n, &error[end]);
        inward[end] = end == 0 || end == 2 ? value : -value;
        if (inward[end] < -error[end] && has_foot(&edges, end)) {
            return place_end(&edges, end, place);
        }
        is_inside &= inward[end] > error[end];
    }
    const double(*const ways[4])[3] = {
        (const double(*)[3])edges.way[0][0], (const double(*)[3])edges.way[0][1],
        (const double(*)[3])edges.way[1][0], (const double(*)[3])edges.way[1][1]};
    double nn;
    double nn_error;
    if (!is_inside || !place_inside(&n, smallest(ways, 4), place, &nn, &nn_error)) {
        return false;
    }
    look_along_axes(edges.edge[0], edges.edge[1], x[0], x[2], place);
    place->type = ENG_NEAREST_EE;
    place->param[0] = inward[0] / nn;
    place->param[1] = inward[2] / nn;
    place->param_error[0] = share_error(place->param[0], error[0], nn, nn_error);
    place->param_error[1] = share_error(place->param[1], error[2], nn, nn_error);
    return true;
}

bool eng_quick_place(enum pccd_kind kind, const double x[4][3], struct eng_place *place)
{
    return kind == PCCD_VF ? place_face(x, place) : place_edges(x, place);
}

/* Rounds to the nearest multiple of 2^-32, halves to even, for |x| <= 2. */
static double fixed(double x)
{
    return (x + 0x1.8p20) - 0x1.8p20;
}

/* False: the true number, within `error` of x, might be rounded either way. */
static bool round_fixed(double x, double error, double *out)
{
    double low = fixed(x - error);
    *out = low + 0.0; /* no zero has a sign */
    return low == fixed(x + error);
}

#define BITS_CUT ((UINT64_C(1) << 20) - 1)

/* A positive normal double without its last 20 bits: 33 are left. */
static double cut(double x, uint64_t add)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = (bits & ~BITS_CUT) + add;
    memcpy(&x, &bits, sizeof x);
    return x;
}

bool eng_quick_describe(const struct eng_place *place, struct eng_distance *distance)
{
    /* Twice the error: what is subtracted and added is rounded, too. */
    double low = place->length - 2 * place->length_error;
    double high = place->length + 2 * place->length_error;
    if (!(low > LOST)) {
        return false;
    }
    distance->type = place->type;
    distance->points = place->points;
    distance->lo = cut(low, 0);
    distance->hi = cut(low, BITS_CUT + 1);
    bool is_sure = distance->lo < low && high < distance->hi;
    if (place->is_exact && distance->lo == place->length) {
        distance->hi = distance->lo;
        is_sure = true;
    }
    for (int i = 0; i < 2; i++) {
        is_sure &=
            round_fixed(place->param[i], 2 * place->param_error[i], &distance->param[i]);
    }
    for (int k = 0; k < 3; k++) {
        is_sure &= round_fixed(place->direction[k], 2 * place->direction_error,
                               &distance->direction[k]);
    }
    return is_sure;
}

int eng_quick_meet(enum pccd_kind kind, const double x[4][3],
                   struct eng_distance *distance)
{
    int first = kind == PCCD_VF ? 1 : 2; /* point of the second feature */
    int count = 0;
    for (int i = 0; i < first; i++) {
        for (int j = first; j < 4; j++) {
            if (x[i][0] == x[j][0] && x[i][1] == x[j][1] && x[i][2] == x[j][2]) {
                *distance = (struct eng_distance){
                    .param = {kind == PCCD_VF ? j == 2 : i == 1, j == 3},
                    .type = ENG_NEAREST_VV,
                    .points = 1u << i | 1u << j};
                count++;
            }
        }
    }
    return count;
}

enum eng_sign eng_quick_compare(const struct eng_place *place, double d)
{
    if (place->length - 2 * place->length_error > d) {
        return ENG_PLUS;
    }
    if (place->is_exact && place->length == d) {
        return ENG_ZERO;
    }
    return place->length + 2 * place->length_error < d ? ENG_MINUS : ENG_UNSURE;
}

/* Sign of e . (a x b), all three differences. */
static enum eng_sign side_of(const double e[3], const double a[3], const double b[3])
{
    double size_e = eng_size(e);
    struct across cross = across(a, eng_size(a), b, eng_size(b));
    double value = eng_dot(e, cross.c);
    double error = 3.1 * size_e * (cross.error + 4.5 * ENG_U * cross.size) + LOST;
    return value > error ? ENG_PLUS : value < -error ? ENG_MINUS : ENG_UNSURE;
}

enum eng_sign eng_quick_crosses(const double x[5][3])
{
    double edge[3];
    double from[3][3];
    double other[3];
    enum eng_sign turn[3];
    eng_sub(edge, x[1], x[0]);
    double size = eng_size(edge);
    for (int i = 0; i < 3; i++) {
        eng_sub(from[i], x[2 + i], x[0]);
        size = eng_most(size, eng_size(from[i]));
    }
    if (!is_in_range(size)) {
        return ENG_UNSURE;
    }
    for (int i = 0; i < 3; i++) {
        turn[i] = side_of(edge, from[i], from[next(i)]);
    }
    for (int i = 0; i < 3; i++) {
        if (turn[i] != ENG_UNSURE && turn[next(i)] != ENG_UNSURE &&
            turn[i] != turn[next(i)]) {
            return ENG_MINUS;
        }
    }
    double u[3];
    double v[3];
    eng_sub(u, x[3], x[2]);
    eng_sub(v, x[4], x[2]);
    eng_sub(other, x[1], x[2]);
    double begin[3] = {-from[0][0], -from[0][1], -from[0][2]};
    enum eng_sign first = side_of(begin, u, v);
    enum eng_sign second = side_of(other, u, v);
    if (first == ENG_UNSURE || second == ENG_UNSURE) {
        return ENG_UNSURE;
    }
    if (first == second) {
        return ENG_MINUS;
    }
    for (int i = 0; i < 3; i++) {
        if (turn[i] == ENG_UNSURE) {
            return ENG_UNSURE;
        }
    }
    return ENG_PLUS;
}
