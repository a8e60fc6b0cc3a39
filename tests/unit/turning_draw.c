/* turning_draw.c - random motions of pairs of features. */
#include "turning_draw.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- where points are -------------------------------------------------------------- */

static void cross(const long double a[3], const long double b[3], long double r[3])
{
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        r[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static long double dot(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Turn x about u, of any length, by an angle. */
static void turn(const long double axis[3], long double angle, long double x[3])
{
    long double length = sqrtl(dot(axis, axis));
    long double u[3], once[3], twice[3];
    if (length == 0) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        u[k] = axis[k] / length;
    }
    cross(u, x, once);
    cross(u, once, twice);
    for (int k = 0; k < 3; k++) {
        x[k] += sinl(angle) * once[k] + (1 - cosl(angle)) * twice[k];
    }
}

/* Take x from the frame of a link to the world, or back from there. */
static void move_point(const struct turning_drawn *drawn, uint32_t link, long double t,
                       bool is_back, long double x[3])
{
    uint32_t list[TURNING_JOINTS_MAX], count = 0;
    for (; link != PCCD_NO_JOINT; link = drawn->joints[link].parent) {
        list[count++] = link;
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct pccd_joint *joint =
            &drawn->joints[list[is_back ? count - 1 - i : i]];
        const double *q = joint->rotation;
        long double sign = is_back ? -1 : 1;
        long double value[3], axis[3] = {joint->axis[0], joint->axis[1], joint->axis[2]};
        long double v[3] = {q[0], q[1], q[2]};
        long double by = 2 * atan2l(sqrtl(dot(v, v)), q[3]);
        for (int k = 0; k < 3; k++) {
            value[k] = joint->from[k] + t * ((long double)joint->to[k] - joint->from[k]);
        }
        if (is_back) {
            for (int k = 0; k < 3; k++) {
                x[k] -= joint->position[k];
            }
            turn(v, -by, x);
        }
        if (joint->kind == PCCD_JOINT_TURN) {
            turn(axis, sign * value[0], x);
        } else if (joint->kind == PCCD_JOINT_VECTOR) {
            turn(value, sign * sqrtl(dot(value, value)), x);
        } else if (joint->kind == PCCD_JOINT_SLIDE) {
            for (int k = 0; k < 3; k++) {
                x[k] += sign * value[0] * axis[k] / sqrtl(dot(axis, axis));
            }
        } else if (joint->kind == PCCD_JOINT_SHIFT) {
            for (int k = 0; k < 3; k++) {
                x[k] += sign * value[k];
            }
        }
        if (!is_back) {
            turn(v, by, x);
            for (int k = 0; k < 3; k++) {
                x[k] += joint->position[k];
            }
        }
    }
}

static uint32_t side_of(const struct turning_drawn *drawn, uint32_t point)
{
    return point >= drawn->points[0];
}

void turning_place(const struct turning_drawn *drawn, uint32_t point, long double t,
                   long double place[3])
{
    for (int k = 0; k < 3; k++) {
        place[k] = drawn->x[0][point][k] +
                   t * ((long double)drawn->x[1][point][k] - drawn->x[0][point][k]);
    }
    move_point(drawn, drawn->link[side_of(drawn, point)], t, false, place);
}

/* The square of the distance of a point and an edge, which may have no length. */
static long double to_edge(const long double x[3], const long double a[3],
                           const long double b[3])
{
    long double w[3], e[3];
    for (int k = 0; k < 3; k++) {
        w[k] = x[k] - a[k];
        e[k] = b[k] - a[k];
    }
    long double square = dot(e, e);
    long double along = square > 0 ? dot(w, e) / square : 0;
    along = along < 0 ? 0 : along > 1 ? 1 : along;
    for (int k = 0; k < 3; k++) {
        w[k] -= along * e[k];
    }
    return dot(w, w);
}

/* That of the insides of a vertex and a face, or of two edges; far: there is none. */
static long double to_inside(const long double x[4][3], bool is_face)
{
    long double w[3], u[3], v[3], n[3], c[3];
    for (int k = 0; k < 3; k++) {
        w[k] = x[0][k] - x[is_face ? 1 : 2][k];
        u[k] = x[is_face ? 2 : 1][k] - x[is_face ? 1 : 0][k];
        v[k] = x[3][k] - x[is_face ? 1 : 2][k];
    }
    cross(u, v, n);
    long double square = dot(n, n);
    cross(w, v, c);
    long double first = dot(c, n);
    cross(is_face ? u : w, is_face ? w : u, c);
    long double second = dot(c, n);
    bool is_inside = is_face
                         ? first > 0 && second > 0 && first + second < square
                         : first < 0 && second < 0 && -first < square && -second < square;
    return is_inside ? dot(w, n) * dot(w, n) / square : HUGE_VALL;
}

long double turning_distance(const struct turning_drawn *drawn, long double t)
{
    long double x[4][3], least = HUGE_VALL;
    uint32_t a = drawn->points[0], all = a + drawn->points[1];
    for (uint32_t i = 0; i < all; i++) {
        turning_place(drawn, i, t, x[i]);
    }
    for (uint32_t i = 0; i < all; i++) {
        uint32_t begin = i < a ? a : 0, end = i < a ? all : a;
        for (uint32_t j = begin; j < end; j++) {
            for (uint32_t k = j; k < end; k++) {
                least = fminl(least, to_edge(x[i], x[j], x[k]));
            }
        }
    }
    if (all == 4) {
        least = fminl(least, to_inside((const long double(*)[3])x, a == 1));
    }
    return sqrtl(least);
}

/* ---- chance ------------------------------------------------------------------------ */

static bool one_in(struct prng *prng, uint32_t n)
{
    return prng_u32(prng, n) == 0;
}

static double draw_number(struct prng *prng, double size)
{
    double x = prng_between(prng, -1, 1);
    return size * (one_in(prng, 3) ? rint(4 * x) / 4 : x);
}

static void draw_vector(struct prng *prng, double size, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = draw_number(prng, size);
    }
}

/* One that is not 0. */
static void draw_axis(struct prng *prng, double x[3])
{
    draw_vector(prng, one_in(prng, 4) ? 1e-3 : 2, x);
    if (x[0] == 0 && x[1] == 0 && x[2] == 0) {
        x[prng_u32(prng, 3)] = 2;
    }
}

/* Radians: some tenth of a turn, some turns, very many, or nearly nothing. */
static double draw_angle(struct prng *prng)
{
    uint32_t what = prng_u32(prng, 1000);
    double by = what < 500   ? 1
                : what < 800 ? PI
                : what < 930 ? 4 * PI
                : what < 960 ? 1e-7
                : what < 990 ? 40
                : what < 999 ? 600
                             : 0x1p20 * 2 * PI;
    return by * prng_between(prng, -1, 1);
}

static struct pccd_joint *add_joint(struct turning_drawn *drawn, uint32_t kind,
                                    uint32_t parent)
{
    struct pccd_joint *joint = &drawn->joints[drawn->count++];
    *joint =
        (struct pccd_joint){.kind = kind, .parent = parent, .rotation = {0, 0, 0, 1}};
    return joint;
}

static void draw_rotation(struct prng *prng, double q[4])
{
    draw_axis(prng, q);
    q[3] = prng_between(prng, -1, 1);
}

/* Add a joint of any kind; return its number. */
static uint32_t add_any(struct prng *prng, struct turning_drawn *drawn, uint32_t parent)
{
    static const uint32_t kinds[8] = {PCCD_JOINT_TURN,  PCCD_JOINT_TURN,  PCCD_JOINT_TURN,
                                      PCCD_JOINT_SLIDE, PCCD_JOINT_SHIFT, PCCD_JOINT_TURN,
                                      PCCD_JOINT_FIXED, PCCD_JOINT_VECTOR};
    struct pccd_joint *joint = add_joint(drawn, kinds[prng_u32(prng, 8)], parent);
    draw_vector(prng, drawn->size, joint->position);
    if (!one_in(prng, 3)) {
        draw_rotation(prng, joint->rotation);
    }
    if (joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_SLIDE) {
        draw_axis(prng, joint->axis);
        bool turns = joint->kind == PCCD_JOINT_TURN;
        joint->from[0] = turns ? draw_angle(prng) : draw_number(prng, drawn->size);
        joint->to[0] = turns ? joint->from[0] + (one_in(prng, 4) ? 0 : draw_angle(prng))
                             : draw_number(prng, drawn->size);
        if (fabs(joint->to[0]) > 0x1p20 * 2 * PI) {
            joint->to[0] = joint->from[0];
        }
    } else if (joint->kind == PCCD_JOINT_SHIFT) {
        draw_vector(prng, drawn->size, joint->from);
        draw_vector(prng, drawn->size, joint->to);
    } else if (joint->kind == PCCD_JOINT_VECTOR) {
        double size = fabs(draw_angle(prng)) / 2;
        draw_vector(prng, size, joint->from);
        draw_vector(prng, one_in(prng, 2) ? 1 : size, joint->to);
        for (int k = 0; k < 3; k++) {
            joint->to[k] += one_in(prng, 2) ? joint->from[k] : 0;
        }
    }
    return drawn->count - 1;
}

/* Add one that does turn. */
static uint32_t add_turn(struct prng *prng, struct turning_drawn *drawn, uint32_t parent)
{
    struct pccd_joint *joint = add_joint(drawn, PCCD_JOINT_TURN, parent);
    draw_vector(prng, drawn->size, joint->position);
    draw_rotation(prng, joint->rotation);
    draw_axis(prng, joint->axis);
    joint->from[0] = prng_between(prng, -3, 3);
    joint->to[0] = draw_angle(prng);
    return drawn->count - 1;
}

static uint32_t add_screw(struct prng *prng, struct turning_drawn *drawn, uint32_t parent)
{
    struct pccd_joint *joint = add_joint(drawn, PCCD_JOINT_SLIDE, parent);
    double centre[3], axis[3];
    draw_vector(prng, drawn->size, centre);
    draw_axis(prng, axis);
    memcpy(joint->position, centre, sizeof centre);
    memcpy(joint->axis, axis, sizeof axis);
    joint->to[0] = draw_number(prng, drawn->size);
    joint = add_joint(drawn, PCCD_JOINT_TURN, drawn->count - 1);
    memcpy(joint->axis, axis, sizeof axis);
    joint->to[0] = draw_angle(prng);
    joint = add_joint(drawn, PCCD_JOINT_FIXED, drawn->count - 1);
    for (int k = 0; k < 3; k++) {
        joint->position[k] = -centre[k];
    }
    return drawn->count - 1;
}

static uint32_t add_poses(struct prng *prng, struct turning_drawn *drawn, uint32_t parent)
{
    struct pccd_joint *joint = add_joint(drawn, PCCD_JOINT_SHIFT, parent);
    draw_vector(prng, drawn->size, joint->from);
    draw_vector(prng, drawn->size, joint->to);
    joint = add_joint(drawn, PCCD_JOINT_TURN, drawn->count - 1);
    draw_axis(prng, joint->axis);
    joint->to[0] = draw_angle(prng);
    joint = add_joint(drawn, PCCD_JOINT_FIXED, drawn->count - 1);
    draw_rotation(prng, joint->rotation);
    return drawn->count - 1;
}

static uint32_t add_vector(struct prng *prng, struct turning_drawn *drawn,
                           uint32_t parent)
{
    struct pccd_joint *joint = add_joint(drawn, PCCD_JOINT_SHIFT, parent);
    draw_vector(prng, drawn->size, joint->from);
    draw_vector(prng, drawn->size, joint->to);
    joint = add_joint(drawn, PCCD_JOINT_VECTOR, drawn->count - 1);
    draw_vector(prng, 2, joint->from);
    draw_vector(prng, fabs(draw_angle(prng)) / 2, joint->to);
    return drawn->count - 1;
}

uint32_t turning_draw_joints(struct prng *prng, struct turning_drawn *drawn,
                             uint32_t parent)
{
    uint32_t joints = 1 + prng_u32(prng, one_in(prng, 4) ? 8 : 3);
    switch (drawn->way) {
    case TURNING_SCREW:
        return add_screw(prng, drawn, parent);
    case TURNING_POSES:
        return add_poses(prng, drawn, parent);
    case TURNING_VECTOR:
        return add_vector(prng, drawn, parent);
    default:
        for (uint32_t i = 1; i < joints; i++) {
            parent = add_any(prng, drawn, parent);
        }
        return add_turn(prng, drawn, parent);
    }
}

/* One side turns, or both, each by itself or both on what turns, too. */
static void draw_links(struct prng *prng, struct turning_drawn *drawn)
{
    uint32_t shared = PCCD_NO_JOINT;
    uint32_t first = prng_u32(prng, 2);
    uint32_t what = prng_u32(prng, 4);
    if (what == 0) {
        shared = add_any(prng, drawn, shared);
    }
    drawn->link[first] = turning_draw_joints(prng, drawn, shared);
    drawn->link[!first] = shared;
    if (what <= 1) {
        drawn->link[!first] = turning_draw_joints(prng, drawn, shared);
    }
}

/* Points of both features that are to be near each other. */
enum spot {
    SPOT_INSIDE,   /* by much */
    SPOT_ANYWHERE, /* corners, sides and insides */
    SPOT_RIM       /* inside of a, on the side of b that is not its first point's */
};

static void draw_spots(struct prng *prng, const struct turning_drawn *drawn,
                       enum spot spot, long double t, long double at[2][3])
{
    uint32_t begin = drawn->points[0], all = begin + drawn->points[1];
    long double sum[2] = {0};
    memset(at, 0, 2 * sizeof at[0]);
    for (uint32_t i = 0; i < all; i++) {
        uint32_t side = side_of(drawn, i);
        bool is_off =
            spot == SPOT_ANYWHERE ? one_in(prng, 4) : spot == SPOT_RIM && i == begin;
        bool is_last = i + 1 == begin || i + 1 == all;
        long double weight = is_off ? 0 : prng_between(prng, 0.05, 1);
        long double place[3];
        weight = is_last && sum[side] == 0 ? 1 : weight;
        turning_place(drawn, i, t, place);
        for (int k = 0; k < 3; k++) {
            at[side][k] += weight * place[k];
        }
        sum[side] += weight;
    }
    for (int k = 0; k < 6; k++) {
        at[k / 3][k % 3] /= sum[k / 3];
    }
}

/* Draw where the spot of b lies from that of a. */
static void draw_direction(struct prng *prng, const struct turning_drawn *drawn,
                           enum spot spot, long double t, long double at[2][3],
                           long double direction[3])
{
    double any[3];
    long double e[2][3], n[3], x[3][3];
    draw_axis(prng, any);
    for (int k = 0; k < 3; k++) {
        direction[k] = any[k];
    }
    for (uint32_t i = 0; i < 3; i++) {
        turning_place(drawn, drawn->points[0] + (i < drawn->points[1] ? i : 0), t, x[i]);
    }
    for (int k = 0; k < 3; k++) {
        e[0][k] = x[1][k] - x[0][k];
        e[1][k] = drawn->points[1] == 3 ? x[2][k] - x[0][k] : any[k];
        n[k] = x[0][k] - at[1][k];
    }
    if (drawn->family == TURNING_TOUCHES && drawn->points[1] >= 2) {
        cross(e[0], e[1], n); /* perpendicular, so that they touch */
    } else if (spot != SPOT_RIM) {
        return;
    }
    for (int k = 0; k < 3 && dot(n, n) > 0; k++) {
        direction[k] = n[k];
    }
}

/* Move feature b so that a point of it comes to a point of a, at some time, but for what
 * the family says. */
static void bring_near(struct prng *prng, struct turning_drawn *drawn)
{
    bool is_near = drawn->family == TURNING_NEAR;
    bool is_rim = is_near && drawn->points[1] >= 2 && one_in(prng, 2);
    enum spot spot = drawn->family == TURNING_MEETS ? SPOT_INSIDE
                     : is_rim                       ? SPOT_RIM
                                                    : SPOT_ANYWHERE;
    /* The ends of the step are where nobody can tell. */
    uint32_t what = spot == SPOT_ANYWHERE ? prng_u32(prng, 8) : 2;
    long double t = what == 0 ? 0 : what == 1 ? 1 : prng_between(prng, 0.01, 0.99);
    long double at[2][3], direction[3], gap[3], zero[3] = {0};
    double r = drawn->radius[0] + drawn->radius[1] + drawn->radius[2];
    double length = drawn->family == TURNING_MEETS ? r * prng_between(prng, 0, 0.9) : r;
    if (is_near) {
        double past = drawn->size * pow(10, prng_between(prng, -12, -1));
        length += one_in(prng, 2) ? past : -past;
    }
    draw_spots(prng, drawn, spot, t, at);
    draw_direction(prng, drawn, spot, t, at, direction);
    long double size = sqrtl(dot(direction, direction));
    for (int k = 0; k < 3; k++) {
        gap[k] = at[0][k] - at[1][k] + length * direction[k] / size;
    }
    /* The same change of all its points in the frame of its link. */
    move_point(drawn, drawn->link[1], t, true, zero);
    move_point(drawn, drawn->link[1], t, true, gap);
    for (uint32_t i = drawn->points[0]; i < drawn->points[0] + drawn->points[1]; i++) {
        for (int k = 0; k < 6; k++) {
            drawn->x[k / 3][i][k % 3] += (double)(gap[k % 3] - zero[k % 3]);
        }
    }
}

static void draw_points(struct prng *prng, struct turning_drawn *drawn)
{
    double size = drawn->size * (one_in(prng, 4) ? 0.05 : 1);
    for (uint32_t i = 0; i < 4; i++) {
        draw_vector(prng, size, drawn->x[0][i]);
        memcpy(drawn->x[1][i], drawn->x[0][i], sizeof drawn->x[0][i]);
        if (drawn->link[side_of(drawn, i)] == PCCD_NO_JOINT && one_in(prng, 2)) {
            draw_vector(prng, size, drawn->x[1][i]); /* deforms */
        }
    }
}

void turning_draw(struct prng *prng, struct turning_drawn *drawn)
{
    static const double sizes[8] = {1, 1, 1, 1, 1, 100, 0x1p-40, 0x1p40};
    static const uint32_t points[PCCD_KIND_COUNT][2] = {{1, 3}, {2, 2}, {1, 2}, {1, 1}};
    static const double radii[8] = {0, 0, 0, 0x1p-10, 0.1, 0.3, -1, 0.02};
    uint32_t kind = prng_u32(prng, 8);
    uint32_t family = prng_u32(prng, 100);
    *drawn = (struct turning_drawn){.count = 0};
    drawn->size = sizes[prng_u32(prng, 8)];
    drawn->way = (enum turning_way)prng_u32(prng, TURNING_WAY_COUNT);
    drawn->kind = kind < 3 ? PCCD_VF : kind < 6 ? PCCD_EE : kind == 6 ? PCCD_VE : PCCD_VV;
    drawn->points[0] = points[drawn->kind][0];
    drawn->points[1] = points[drawn->kind][1];
    drawn->family = family < 45   ? TURNING_ANY
                    : family < 90 ? TURNING_MEETS
                    : family < 99 ? TURNING_NEAR
                                  : TURNING_TOUCHES;
    bool is_thick = drawn->kind == PCCD_VE || drawn->kind == PCCD_VV || one_in(prng, 2);
    for (int i = 0; i < 3 && is_thick; i++) {
        /* One that is far below what a step can resolve is for those that are near. */
        double tiny = drawn->family == TURNING_NEAR ? 1e-9 : 0x1p-14;
        double radius = radii[prng_u32(prng, 8)];
        drawn->radius[i] = drawn->size * (radius < 0 ? tiny : radius);
    }
    if (drawn->kind == PCCD_VE || drawn->kind == PCCD_VV) {
        drawn->radius[0] += 0.01 * drawn->size; /* without any they only touch */
    }
    draw_links(prng, drawn);
    draw_points(prng, drawn);
    if (drawn->family != TURNING_ANY) {
        bring_near(prng, drawn);
    }
}
