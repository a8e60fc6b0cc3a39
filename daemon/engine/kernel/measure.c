/* measure.c - distances of pairs at one end of the step, a pair to each lane.
 *
 * Write the distances of pairs that are certainly within d, where every rounded number is
 * sure. What is not certain is left to distance.c.
 *
 * Source: BOUNDS.md, "Distances in lanes".
 */
#include "place_edges.h"
#include "place_face.h"
#include "points.h"
#include "rims.h"
#include "table.h"

/* Doubles of 33 bits: the last 20 of 53 are cut off. */
#define BITS_CUT ((INT64_C(1) << 20) - 1)

/* What struct eng_distance has, in lanes. */
struct numbers {
    eng_d lo, hi;
    eng_d param[2];
    struct eng_v direction;
    eng_d code;
};

/* What is known of the lanes. */
struct known {
    eng_dm near;   /* certainly within d */
    eng_dm beyond; /* certainly not */
    eng_dm sure;   /* near, and each number is certainly rounded as it should be */
};

/* A length, and what params and directions are computed with. */
struct length {
    eng_d value, error;
    eng_d size_w, size_e;
    eng_d inverse;    /* 1 / e.e, 1 / n.n */
    eng_d per;        /* 1 / |e|, 1 / |n| */
    eng_d signed_per; /* by the side on which the first feature is */
    eng_d nn_error;
};

/* A positive normal double without its last bits, `add` times the last one that is left
 * more. */
ENG_INLINE eng_d cut(eng_d x, int64_t add)
{
    return eng_d_of((eng_di_of(x) & ~BITS_CUT) + add * (BITS_CUT + 1));
}

/* The nearest multiple of 2^-32 to x; sure: it is for all that is within twice an error.
 * `room` is half of 2^-32 less that. What is 0 has no sign, as it is a difference of
 * equal numbers. */
ENG_INLINE eng_d fixed(eng_d x, eng_d room, eng_dm *sure)
{
    eng_d nearest = (x + 0x1.8p20) - 0x1.8p20;
    *sure = eng_dm_and(*sure, eng_d_less(eng_d_abs(x - nearest), room));
    return nearest;
}

ENG_INLINE eng_d room_of(eng_d error)
{
    return 0x1p-33 - 2 * error;
}

/* The length; of the masks those go that squares or margins forbid. */
ENG_INLINE struct length length_of(struct eng_parts *parts)
{
    const eng_d least = eng_d_all(ENG_SQUARE_MIN);
    const struct eng_across *n = &parts->n;
    struct length length;
    length.size_w = eng_v_size(parts->w);
    length.size_e = eng_v_size(parts->e);
    struct eng_across m = eng_across(parts->e, length.size_e, parts->w, length.size_w);
    eng_d square =
        eng_d_select(parts->foot, eng_v_dot(m.v, m.v), eng_v_dot(parts->w, parts->w));
    eng_d below = eng_d_select(parts->foot, eng_v_dot(parts->e, parts->e), parts->nn);
    eng_d height = eng_v_dot(parts->w, n->v);
    eng_d height_error = eng_height_error(length.size_w, n);
    eng_dm is_large = eng_d_less(least, square);
    eng_dm is_long = eng_d_less(least, below);
    parts->vertices = eng_dm_and(parts->vertices, is_large);
    parts->foot = eng_dm_and(parts->foot, eng_dm_and(is_large, is_long));
    parts->inside = eng_dm_and(eng_dm_and(parts->inside, is_long),
                               eng_dm_and(eng_d_at_most(n->error, 0x1p-30 * n->size),
                                          eng_d_less(height_error, eng_d_abs(height))));
    length.nn_error = eng_across_error(n, n);
    length.inverse = 1 / below;
    length.per = eng_d_sqrt(below) * length.inverse;
    length.signed_per =
        eng_d_select(eng_d_less(height, eng_d_all(0)), -length.per, length.per);
    eng_d root = eng_d_sqrt(square);
    length.value = eng_d_select(parts->inside, eng_d_abs(height), root);
    length.value = eng_d_select(parts->vertices, root, length.value * length.per);
    eng_d off = eng_d_select(parts->foot, 1.8 * m.error,
                             1.1 * (height_error + 1.8 * length.value * n->error));
    length.error = 12 * ENG_U * length.value;
    length.error =
        eng_d_select(parts->vertices, length.error, length.error + off * length.per);
    return length;
}

/* Params; returns what is subtracted from w, in units of e, to have the direction. */
ENG_INLINE eng_d set_params(const struct eng_parts *parts, const struct length *length,
                            eng_d at_error, struct numbers *numbers, eng_dm *sure)
{
    const eng_d zero = {0};
    eng_d along = eng_v_dot(parts->w, parts->e) * length->inverse;
    eng_d at = eng_d_abs(along);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        eng_d share = parts->share[i] * length->inverse;
        eng_d error =
            1.1 * (parts->share_error[i] + share * length->nn_error) * length->inverse +
            4 * ENG_U * share;
        eng_d value =
            eng_d_select(parts->is_one[i], 1 - eng_d_select(parts->moves[i], at, zero),
                         eng_d_select(parts->moves[i], at, zero));
        error = eng_d_select(parts->inside, error,
                             eng_d_select(parts->moves[i], at_error, zero));
        numbers->param[i] =
            fixed(eng_d_select(parts->inside, share, value), room_of(error), sure);
    }
    return along;
}

ENG_INLINE void set_rest(const struct eng_parts *parts, const struct length *length,
                         struct numbers *numbers, eng_dm *sure)
{
    const eng_d zero = {0};
    /* Of how far along e the foot is, at most 1; the last part is for 1 less that. */
    eng_d at_error =
        eng_dot_error(length->size_w, length->size_e) * length->inverse + 14 * ENG_U;
    eng_d along = set_params(parts, length, at_error, numbers, sure);
    eng_d per_length = 1 / length->value;
    eng_d scale = eng_d_select(parts->inside, length->signed_per, per_length);
    struct eng_v back = eng_v_times(eng_d_select(parts->foot, along, zero), parts->e);
    struct eng_v g = eng_v_select(parts->inside, parts->n.v, eng_v_sub(parts->w, back));
    eng_d foot_error = 1.1 *
                       (4 * ENG_U * length->size_w +
                        (at_error + 6 * ENG_U) * length->size_e + length->error) *
                       per_length;
    eng_d error = eng_d_select(parts->foot, foot_error, zero);
    error = eng_d_select(parts->inside, 3 * parts->n.error * length->per, error);
    eng_d room = room_of(error + 8 * ENG_U);
    numbers->direction =
        (struct eng_v){fixed(g.x * scale, room, sure), fixed(g.y * scale, room, sure),
                       fixed(g.z * scale, room, sure)};
    numbers->code = parts->code;
}

ENG_INLINE struct known measure_lanes(enum pccd_kind kind, const struct eng_v x[4],
                                      double d, enum eng_distance_wanted wanted,
                                      struct numbers *numbers)
{
    struct eng_parts parts = kind == PCCD_VF ? eng_place_vf(x) : eng_place_ee(x);
    struct length length = length_of(&parts);
    eng_dm placed = eng_dm_or(eng_dm_or(parts.vertices, parts.foot), parts.inside);
    /* Twice the error: what is subtracted and added is rounded, too. */
    eng_d low = length.value - 2 * length.error;
    eng_d high = length.value + 2 * length.error;
    struct known known;
    known.near = eng_dm_and(placed, eng_d_less(high, eng_d_all(d)));
    known.beyond = eng_dm_and(placed, eng_d_less(eng_d_all(d), low));
    known.sure = known.near;
    if (wanted != ENG_DISTANCE_WITHIN) {
        numbers->lo = cut(low, 0);
        numbers->hi = cut(low, 1);
        known.sure = eng_dm_and(known.sure, eng_d_less(eng_d_all(ENG_LOST), low));
        known.sure = eng_dm_and(known.sure, eng_dm_and(eng_d_less(numbers->lo, low),
                                                       eng_d_less(high, numbers->hi)));
    }
    if (wanted == ENG_DISTANCE_WHOLE) {
        set_rest(&parts, &length, numbers, &known.sure);
    }
    return known;
}

#if ENG_VECTOR_BYTES == 64

static_assert(sizeof(struct eng_distance) == 64 &&
                  offsetof(struct eng_distance, param) == 16 &&
                  offsetof(struct eng_distance, direction) == 32 &&
                  offsetof(struct eng_distance, type) == 56 &&
                  offsetof(struct eng_distance, points) == 60,
              "a vector");

/* The whole of eight lanes, those `bits` one after the other; the place behind them is
 * written to as well. */
ENG_INLINE void write_eight(const struct numbers *numbers, const uint32_t *pairs,
                            uint32_t bits, struct eng_measured *out)
{
    uint32_t count = out->near_count;
    eng_di code = eng_di_of(numbers->code);
    const eng_d in[8] = {numbers->lo,          numbers->hi,
                         numbers->param[0],    numbers->param[1],
                         numbers->direction.x, numbers->direction.y,
                         numbers->direction.z, eng_d_of((code & 3) | (code >> 2 << 32))};
    eng_d row[8];
    eng_points_turn_back(in, row);
#pragma GCC unroll 8
    for (uint32_t lane = 0; lane < 8; lane++) {
        memcpy(&out->found[count], &row[lane], sizeof row[lane]);
        count += bits >> lane & 1;
    }
    out->near_count += eng_keep(out->index + out->near_count, pairs, 8, bits);
}

#endif

/* Append the lanes `bits`, of n. */
ENG_INLINE void write_near(const struct numbers *numbers, const uint32_t *pairs,
                           uint32_t n, uint32_t bits, enum eng_distance_wanted wanted,
                           struct eng_measured *out)
{
#if ENG_VECTOR_BYTES == 64
    if (wanted == ENG_DISTANCE_WHOLE && n == ENG_D_LANES) {
        write_eight(numbers, pairs, bits, out);
        return;
    }
#else
    (void)n;
#endif
    double at[7][ENG_D_LANES];
    int64_t code[ENG_D_LANES];
    uint32_t count = out->near_count;
    if (wanted != ENG_DISTANCE_WITHIN) {
        eng_d_store(at[0], numbers->lo);
        eng_d_store(at[1], numbers->hi);
    }
    if (wanted == ENG_DISTANCE_WHOLE) {
        eng_d_store(at[2], numbers->param[0]);
        eng_d_store(at[3], numbers->param[1]);
        eng_d_store(at[4], numbers->direction.x);
        eng_d_store(at[5], numbers->direction.y);
        eng_d_store(at[6], numbers->direction.z);
        memcpy(code, &numbers->code, sizeof code);
    }
    for (; bits != 0; bits &= bits - 1, count++) {
        uint32_t lane = (uint32_t)__builtin_ctz(bits);
        out->index[count] = pairs[lane];
        if (wanted == ENG_DISTANCE_WITHIN) {
            continue;
        }
        struct eng_distance *distance = &out->found[count];
        distance->lo = at[0][lane];
        distance->hi = at[1][lane];
        if (wanted == ENG_DISTANCE_WHOLE) {
            distance->param[0] = at[2][lane];
            distance->param[1] = at[3][lane];
            distance->direction[0] = at[4][lane];
            distance->direction[1] = at[5][lane];
            distance->direction[2] = at[6][lane];
            distance->type = (enum eng_nearest)(code[lane] & 3);
            distance->points = (uint32_t)(code[lane] >> 2);
        }
    }
    out->near_count = count;
}

ENG_INLINE void measure(enum pccd_kind kind, enum eng_distance_wanted wanted,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        const uint32_t *pairs, uint32_t count, uint32_t end, double d,
                        struct eng_measured *out)
{
    eng_d square = eng_d_all(eng_square_most(d));
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        uint32_t all = ENG_D_ALL >> (ENG_D_LANES - n);
        struct eng_group group = eng_group_of(points, quads, pairs + i, n);
        struct eng_v x[4];
        struct numbers numbers;
        eng_group_load_end(&group, end, x);
        struct known known = measure_lanes(kind, x, d, wanted, &numbers);
        uint32_t near = eng_dm_bits(known.near) & all;
        uint32_t sure = eng_dm_bits(known.sure) & all;
        uint32_t undecided = all & ~(near | eng_dm_bits(known.beyond));
        if (undecided != 0) {
            struct eng_rims rims = eng_rims_of(kind, x, eng_d_all(d), square);
            near |= undecided & eng_dm_bits(rims.near);
            undecided &= ~(eng_dm_bits(rims.near) | eng_dm_bits(rims.beyond));
        }
        sure = wanted == ENG_DISTANCE_WITHIN ? near : sure;
        write_near(&numbers, pairs + i, n, sure, wanted, out);
        if ((undecided | (near & ~sure)) != 0) {
            out->imprecise_count += eng_keep(out->imprecise + out->imprecise_count,
                                             pairs + i, n, near & ~sure);
            out->undecided_count +=
                eng_keep(out->undecided + out->undecided_count, pairs + i, n, undecided);
        }
    }
}

#define MEASURE(KIND, WANTED)                                                            \
    case WANTED:                                                                         \
        measure(KIND, WANTED, points, quads, pairs, count, end, d, out);                 \
        break

#define MEASURE_ANY(KIND)                                                                \
    switch (out->wanted) {                                                               \
        MEASURE(KIND, ENG_DISTANCE_WITHIN);                                              \
        MEASURE(KIND, ENG_DISTANCE_LENGTH);                                              \
        MEASURE(KIND, ENG_DISTANCE_WHOLE);                                               \
    }

void ENG_KERNEL(measure)(enum pccd_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], const uint32_t *pairs,
                         uint32_t count, uint32_t end, double d, struct eng_measured *out)
{
    if (kind == PCCD_VF) {
        MEASURE_ANY(PCCD_VF)
    } else {
        MEASURE_ANY(PCCD_EE)
    }
}
