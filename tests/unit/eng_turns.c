/* eng_turns.c - joints by long floats. */
#include "eng_turns.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "sine.h"

#define HALVINGS 60
#define TERMS    12

void turns_init(struct turns_place *place)
{
    for (int i = 0; i < 3; i++) {
        mpf_init2(place->x[i], TURNS_BITS);
    }
}

void turns_deinit(struct turns_place *place)
{
    for (int i = 0; i < 3; i++) {
        mpf_clear(place->x[i]);
    }
}

/* The series of an angle below 2^-36, then doubled: what is lost is 120 bits at most. */
void turns_sine(mpf_srcptr angle, mpf_ptr sine, mpf_ptr cosine)
{
    mpf_t x, term, s, c, next;
    mpf_init2(x, TURNS_BITS);
    mpf_init2(term, TURNS_BITS);
    mpf_init2(s, TURNS_BITS);
    mpf_init2(c, TURNS_BITS);
    mpf_init2(next, TURNS_BITS);
    mpf_div_2exp(x, angle, HALVINGS);
    mpf_set_ui(term, 1);
    for (unsigned long n = 0; n < TERMS; n++) {
        if (n > 0) {
            mpf_mul(term, term, x);
            mpf_div_ui(term, term, n);
        }
        mpf_ptr sum = n & 1 ? s : c;
        if (n & 2) {
            mpf_sub(sum, sum, term);
        } else {
            mpf_add(sum, sum, term);
        }
    }
    for (int i = 0; i < HALVINGS; i++) {
        mpf_mul(next, s, c);
        mpf_mul(s, s, s);
        mpf_mul_2exp(s, s, 1);
        mpf_ui_sub(c, 1, s);
        mpf_mul_2exp(s, next, 1);
    }
    mpf_set(sine, s);
    mpf_set(cosine, c);
    mpf_clears(x, term, s, c, next, NULL);
}

/* Set `out` to a . b. */
static void dot(mpf_ptr out, mpf_t a[3], mpf_t b[3])
{
    mpf_t product, sum;
    mpf_init2(product, TURNS_BITS);
    mpf_init2(sum, TURNS_BITS);
    for (int i = 0; i < 3; i++) {
        mpf_mul(product, a[i], b[i]);
        mpf_add(sum, sum, product);
    }
    mpf_set(out, sum);
    mpf_clears(product, sum, NULL);
}

/* Turn x about u, of the given length, by an angle. */
static void turn(mpf_t x[3], mpf_t u[3], mpf_srcptr length, mpf_srcptr angle)
{
    struct turns_place cross;
    mpf_t sine, cosine, along, product;
    mpf_inits(sine, cosine, along, product, NULL);
    mpf_set_prec(sine, TURNS_BITS);
    mpf_set_prec(cosine, TURNS_BITS);
    mpf_set_prec(along, TURNS_BITS);
    mpf_set_prec(product, TURNS_BITS);
    turns_init(&cross);
    turns_sine(angle, sine, cosine);
    dot(along, u, x);
    mpf_div(along, along, length);
    mpf_div(along, along, length);
    mpf_ui_sub(product, 1, cosine);
    mpf_mul(along, along, product);
    mpf_div(sine, sine, length);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpf_mul(cross.x[i], u[j], x[k]);
        mpf_mul(product, u[k], x[j]);
        mpf_sub(cross.x[i], cross.x[i], product);
        mpf_mul(cross.x[i], cross.x[i], sine);
        mpf_mul(product, u[i], along);
        mpf_add(cross.x[i], cross.x[i], product);
    }
    for (int i = 0; i < 3; i++) {
        mpf_mul(x[i], x[i], cosine);
        mpf_add(x[i], x[i], cross.x[i]);
    }
    turns_deinit(&cross);
    mpf_clears(sine, cosine, along, product, NULL);
}

/* Apply what the joint does at t to x. */
static void move(const struct pccd_joint *joint, double t, bool is_inverse, mpf_t x[3])
{
    struct turns_place value, axis;
    mpf_t length, angle, from;
    mpf_inits(length, angle, from, NULL);
    mpf_set_prec(length, TURNS_BITS);
    mpf_set_prec(angle, TURNS_BITS);
    mpf_set_prec(from, TURNS_BITS);
    turns_init(&value);
    turns_init(&axis);
    for (int i = 0; i < 3; i++) {
        mpf_set_d(from, joint->from[i]);
        mpf_set_d(value.x[i], joint->to[i]);
        mpf_sub(value.x[i], value.x[i], from);
        mpf_set_d(angle, t);
        mpf_mul(value.x[i], value.x[i], angle);
        mpf_add(value.x[i], value.x[i], from);
        if (is_inverse) {
            mpf_neg(value.x[i], value.x[i]);
        }
        mpf_set_d(axis.x[i], joint->axis[i]);
    }
    bool is_vector = joint->kind == PCCD_JOINT_VECTOR;
    mpf_t *along = is_vector ? value.x : axis.x;
    dot(length, along, along);
    mpf_sqrt(length, length);
    if (is_vector) {
        if (mpf_sgn(length) != 0) {
            turn(x, value.x, length, length);
        }
    } else if (joint->kind == PCCD_JOINT_TURN) {
        turn(x, axis.x, length, value.x[0]);
    } else if (joint->kind == PCCD_JOINT_SLIDE) {
        for (int i = 0; i < 3; i++) {
            mpf_mul(angle, value.x[0], axis.x[i]);
            mpf_div(angle, angle, length);
            mpf_add(x[i], x[i], angle);
        }
    } else if (joint->kind == PCCD_JOINT_SHIFT) {
        for (int i = 0; i < 3; i++) {
            mpf_add(x[i], x[i], value.x[i]);
        }
    }
    turns_deinit(&axis);
    turns_deinit(&value);
    mpf_clears(length, angle, from, NULL);
}

/* Turn x by the quaternion (v, w): x + 2 (w v x x + v x (v x x)) / |q|^2. */
static void turn_by(const double q[4], bool is_inverse, mpf_t x[3])
{
    mpf_t m, n, square, sum[3], v[4];
    mpf_init2(m, TURNS_BITS);
    mpf_init2(n, TURNS_BITS);
    mpf_init2(square, TURNS_BITS);
    for (int i = 0; i < 4; i++) {
        mpf_init2(v[i], TURNS_BITS);
        mpf_set_d(v[i], is_inverse && i < 3 ? -q[i] : q[i]);
        mpf_mul(m, v[i], v[i]);
        mpf_add(square, square, m);
    }
    for (int i = 0; i < 3; i++) { /* rows of the matrix */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpf_init2(sum[i], TURNS_BITS);
        mpf_mul(m, v[j], v[j]);
        mpf_mul(n, v[k], v[k]);
        mpf_add(m, m, n);
        mpf_mul(m, m, x[i]);
        mpf_neg(sum[i], m);
        mpf_mul(m, v[i], v[j]);
        mpf_mul(n, v[3], v[k]);
        mpf_sub(m, m, n);
        mpf_mul(m, m, x[j]);
        mpf_add(sum[i], sum[i], m);
        mpf_mul(m, v[i], v[k]);
        mpf_mul(n, v[3], v[j]);
        mpf_add(m, m, n);
        mpf_mul(m, m, x[k]);
        mpf_add(sum[i], sum[i], m);
    }
    for (int i = 0; i < 3; i++) {
        mpf_mul_2exp(sum[i], sum[i], 1);
        mpf_div(sum[i], sum[i], square);
        mpf_add(x[i], x[i], sum[i]);
        mpf_clear(sum[i]);
    }
    for (int i = 0; i < 4; i++) {
        mpf_clear(v[i]);
    }
    mpf_clears(m, n, square, NULL);
}

static void shift(mpf_t x[3], const double d[3], bool is_inverse)
{
    mpf_t m;
    mpf_init2(m, TURNS_BITS);
    for (int i = 0; i < 3; i++) {
        mpf_set_d(m, is_inverse ? -d[i] : d[i]);
        mpf_add(x[i], x[i], m);
    }
    mpf_clear(m);
}

static void go_back(const struct pccd_joint *joints, uint32_t of, double t, mpf_t x[3])
{
    uint32_t chain[4096];
    uint32_t count = 0;
    for (uint32_t i = of; i != PCCD_NO_JOINT; i = joints[i].parent) {
        chain[count++] = i;
    }
    while (count-- > 0) {
        const struct pccd_joint *joint = &joints[chain[count]];
        shift(x, joint->position, true);
        turn_by(joint->rotation, true, x);
        move(joint, t, true, x);
    }
}

void turns_go(const struct pccd_joint *joints, uint32_t of, uint32_t to, double t,
              const double b[3], struct turns_place *place)
{
    for (int i = 0; i < 3; i++) {
        mpf_set_d(place->x[i], b[i]);
    }
    for (uint32_t i = to; i != PCCD_NO_JOINT; i = joints[i].parent) {
        move(&joints[i], t, false, place->x);
        turn_by(joints[i].rotation, false, place->x);
        shift(place->x, joints[i].position, false);
    }
    go_back(joints, of, t, place->x);
}

double turns_distance(const struct turns_place *place, const double x[3])
{
    mpf_t m, n;
    mpf_init2(m, TURNS_BITS);
    mpf_init2(n, TURNS_BITS);
    for (int i = 0; i < 3; i++) {
        mpf_set_d(m, x[i]);
        mpf_sub(m, m, place->x[i]);
        mpf_mul(m, m, m);
        mpf_add(n, n, m);
    }
    mpf_sqrt(n, n);
    double distance = mpf_get_d(n);
    mpf_clears(m, n, NULL);
    return distance;
}

static double random_angle(struct prng *random)
{
    int exponent = -(int)prng_u32(random, 200);
    switch (prng_u32(random, 6)) {
    case 0:
        return 0;
    case 1:
        return prng_between(random, -COMMON_ANGLE_MAX, COMMON_ANGLE_MAX);
    case 2:
        return prng_integer(random, 4) * 0x1.921fb54442d18p+0;
    case 3:
        return ldexp(prng_between(random, -1, 1), exponent);
    case 4:
        return prng_integer(random, 1) * COMMON_ANGLE_MAX;
    default:
        return prng_between(random, -4, 4);
    }
}

static void random_vector(struct prng *random, double v[3], double size)
{
    uint32_t zeros = prng_u32(random, 3) ? 0 : prng_u32(random, 7);
    for (int i = 0; i < 3; i++) {
        v[i] = zeros >> i & 1 ? 0 : prng_between(random, -size, size);
    }
}

static void random_values(struct prng *random, struct pccd_joint *joint, double size)
{
    if (joint->kind == PCCD_JOINT_SLIDE || joint->kind == PCCD_JOINT_SHIFT) {
        random_vector(random, joint->from, size);
        random_vector(random, joint->to, size);
    } else {
        for (int i = 0; i < 3; i++) {
            joint->from[i] = random_angle(random) / 2;
            joint->to[i] = random_angle(random) / 2;
        }
        if (joint->kind == PCCD_JOINT_VECTOR && prng_u32(random, 4) == 0) {
            double factor = prng_integer(random, 4) / 4;
            for (int i = 0; i < 3; i++) {
                joint->to[i] = factor * joint->from[i];
            }
        }
    }
    if (prng_u32(random, 8) == 0) {
        memcpy(joint->to, joint->from, sizeof joint->to);
    }
}

void turns_random(struct prng *random, struct pccd_joint *joints, uint32_t count,
                  double size)
{
    memset(joints, 0, count * sizeof *joints);
    for (uint32_t i = 0; i < count; i++) {
        struct pccd_joint *joint = &joints[i];
        double scale = ldexp(1, (int)prng_u32(random, 48) - 20);
        joint->kind = prng_u32(random, PCCD_JOINT_KIND_COUNT);
        joint->parent = i == 0                         ? PCCD_NO_JOINT
                        : prng_u32(random, 4) || i < 2 ? i - 1
                                                       : i - 2;
        random_vector(random, joint->position, size);
        joint->rotation[3] = scale;
        for (int k = 0; k < 4 && prng_u32(random, 8); k++) {
            joint->rotation[k] = scale * prng_between(random, -1, 1);
        }
        if (joint->rotation[3] == 0) {
            joint->rotation[3] = scale;
        }
        bool has_axis = joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_SLIDE;
        if (has_axis) {
            random_vector(random, joint->axis, scale);
            joint->axis[prng_u32(random, 3)] = prng_u32(random, 2) ? scale : -scale;
        }
        if (joint->kind != PCCD_JOINT_FIXED) {
            random_values(random, joint, size);
        }
        for (int k = has_axis ? 1 : joint->kind == PCCD_JOINT_FIXED ? 0 : 3; k < 3; k++) {
            joint->from[k] = 0;
            joint->to[k] = 0;
        }
    }
}
