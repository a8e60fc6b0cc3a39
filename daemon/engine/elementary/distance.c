/* distance.c - exact distances, by the first stage that is sure. */
#include "distance.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "distance_rule.h"
#include "nearest_points.h"
#include "winding.h"

int eng_distances_init(struct eng_distances *distances)
{
    memset(distances, 0, sizeof *distances);
    return eng_numbers_init(&distances->numbers);
}

void eng_distances_deinit(struct eng_distances *distances)
{
    eng_numbers_deinit(&distances->numbers);
}

/* Return whether it is doubles' turn. */
static bool may_be_quick(const struct eng_distances *distances)
{
    return distances->first == ENG_DISTANCE_BY_DOUBLES;
}

/* The first stage after that of doubles. */
static enum eng_distance_stage slow_stage(const struct eng_distances *distances)
{
    return may_be_quick(distances) ? ENG_DISTANCE_BY_PAIRS : distances->first;
}

/* ---- by doubles: the kernel's lanes, of one pair ----------------------------------- */

struct glance {
    struct eng_nearest_points at;
    struct eng_length length; /* low and high are equal where it is known exactly */
};

ENG_INLINE struct eng_v vector_of(const double x[3])
{
    return (struct eng_v){x[0], x[1], x[2]};
}

/* Return whether x is the difference of a and b, exactly. */
static bool is_difference(double x, double a, double b)
{
    double other = a - x;
    return a - (x + other) == 0 && other - b == 0;
}

/* Look along the axes, for features that are nearest at their insides: where both lie
 * across an axis, the distance is how far they are apart along it. Meshes on a grid have
 * many such pairs. */
static void look_along_axes(enum pccd_kind kind, const double x[4][3],
                            struct eng_length *length)
{
    for (int k = 0; k < 3; k++) {
        double first = x[0][k];
        double second = kind == PCCD_VF ? x[1][k] : x[2][k];
        bool is_across = kind == PCCD_VF ? second == x[2][k] && second == x[3][k]
                                         : first == x[1][k] && second == x[3][k];
        if (is_across && is_difference(first - second, first, second)) {
            length->value = length->low = length->high = fabs(first - second);
        }
    }
}

/* False: nobody knows, by doubles, what the distance is between. */
static bool look(enum pccd_kind kind, const double x[4][3], struct glance *glance)
{
    const struct eng_v at[4] = {vector_of(x[0]), vector_of(x[1]), vector_of(x[2]),
                                vector_of(x[3])};
    glance->at = kind == PCCD_VF ? eng_nearest_vf(at) : eng_nearest_ee(at);
    glance->length = eng_length_of(&glance->at);
    if (eng_dm_bits(glance->at.inside) != 0) {
        look_along_axes(kind, x, &glance->length);
    }
    return eng_dm_bits(eng_is_known(&glance->at)) != 0;
}

/* Sign of the length less d. */
static enum eng_sign compare_quickly(const struct eng_length *length, double d)
{
    if (length->low == d && length->high == d) {
        return ENG_ZERO;
    }
    return length->low > d ? ENG_PLUS : length->high < d ? ENG_MINUS : ENG_UNSURE;
}

/* False: *distance means nothing, for a number might be rounded either way. */
static bool describe_quickly(const struct glance *glance, struct eng_distance *distance)
{
    const struct eng_length *length = &glance->length;
    struct eng_distance_lanes numbers;
    eng_dm rest_is_sure = eng_is_known(&glance->at);
    eng_round_rest(&glance->at, length, &numbers, &rest_is_sure);
    eng_dm is_sure = rest_is_sure;
    eng_round_length(length, &numbers, &is_sure);
    if (length->low == length->high && length->low == numbers.lo) {
        numbers.hi = numbers.lo;
        is_sure = rest_is_sure;
    }
    int64_t code = eng_di_of(numbers.code)[0];
    *distance = (struct eng_distance){
        .lo = numbers.lo,
        .hi = numbers.hi,
        .param = {numbers.param[0], numbers.param[1]},
        .direction = {numbers.direction.x, numbers.direction.y, numbers.direction.z},
        .type = (enum eng_nearest)(code & 3),
        .points = (uint32_t)(code >> 2)};
    return eng_dm_bits(is_sure) != 0;
}

/* Return how many points of the first feature are where one of the second is: the
 * distance is 0 if any. One: *distance is set. Of several it depends on ranks which the
 * distance is between. */
static int count_shared(enum pccd_kind kind, const double x[4][3],
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

bool eng_distance_bound(enum pccd_kind kind, const double x[4][3],
                        struct eng_distance_bounds *bounds)
{
    struct glance glance;
    if (!look(eng_distance_form(kind), x, &glance)) {
        return false;
    }
    *bounds = (struct eng_distance_bounds){glance.length.low, glance.length.high,
                                           (uint32_t)(eng_di_of(glance.at.code)[0] >> 2)};
    return true;
}

static enum eng_sign cross_quickly(const double x[5][3])
{
    const struct eng_v at[5] = {vector_of(x[0]), vector_of(x[1]), vector_of(x[2]),
                                vector_of(x[3]), vector_of(x[4])};
    struct eng_sure crossing = eng_crossing_of(at);
    return eng_dm_bits(crossing.yes) != 0  ? ENG_PLUS
           : eng_dm_bits(crossing.no) != 0 ? ENG_MINUS
                                           : ENG_UNSURE;
}

/* ---- by pairs of doubles and by integers ------------------------------------------- */

/* Load the points for a stage. */
static void begin(struct eng_distances *distances, enum eng_distance_stage stage,
                  const double (*x)[3], int point_count)
{
    eng_numbers_load(&distances->numbers, stage == ENG_DISTANCE_BY_INTEGERS, x,
                     point_count);
}

/* Return whether the stage's answer is one. Integers are never unsure. */
static bool is_decided(struct eng_distances *distances, enum eng_distance_stage stage)
{
    assert(stage != ENG_DISTANCE_BY_INTEGERS || !distances->numbers.is_unsure);
    distances->decided[stage] += !distances->numbers.is_unsure;
    return !distances->numbers.is_unsure;
}

/* Sign of the distance less d. */
static enum eng_sign compare(struct eng_numbers *numbers, enum pccd_kind kind, double d)
{
    static const uint8_t any_rank[4] = {0, 1, 2, 3};
    struct eng_distance_exact way;
    if (!numbers->is_exact && numbers->unit < 0 && d >= ldexp(2, numbers->unit)) {
        return ENG_MINUS; /* all points are within 2^unit of each other along each axis */
    }
    eng_distance_rule(numbers, kind, any_rank, &way);
    if (numbers->is_unsure) {
        return ENG_UNSURE;
    }
    enum eng_sign sign = eng_number_compare(numbers, way.num, way.den, d);
    numbers->is_unsure = sign == ENG_UNSURE;
    return sign;
}

/* The same by the first stage that is sure. */
static enum eng_sign compare_surely(struct eng_distances *distances, enum pccd_kind kind,
                                    const double x[4][3], double d)
{
    assert(d >= 0 && d <= 1e18);
    struct glance glance;
    struct eng_distance at_0;
    if (may_be_quick(distances) && count_shared(kind, x, &at_0) > 0) {
        distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
        return d > 0 ? ENG_MINUS : ENG_ZERO;
    }
    if (may_be_quick(distances) && look(kind, x, &glance)) {
        enum eng_sign sign = compare_quickly(&glance.length, d);
        if (sign != ENG_UNSURE) {
            distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
            return sign;
        }
    }
    enum eng_distance_stage stage = slow_stage(distances);
    for (;; stage++) {
        begin(distances, stage, x, 4);
        enum eng_sign sign = compare(&distances->numbers, kind, d);
        if (is_decided(distances, stage)) {
            return sign;
        }
    }
}

bool eng_distance_within(struct eng_distances *distances, enum pccd_kind kind,
                         const double x[4][3], double d)
{
    return compare_surely(distances, eng_distance_form(kind), x, d) != ENG_PLUS;
}

bool eng_distance_below(struct eng_distances *distances, enum pccd_kind kind,
                        const double x[4][3], double d)
{
    return compare_surely(distances, eng_distance_form(kind), x, d) == ENG_MINUS;
}

static void describe(struct eng_numbers *numbers, const struct eng_distance_exact *way,
                     struct eng_distance *distance)
{
    distance->type = way->type;
    distance->points = way->points;
    eng_number_length(numbers, way->num, way->den, &distance->lo, &distance->hi);
    for (int i = 0; i < 2 && !numbers->is_unsure; i++) {
        distance->param[i] = isnan(way->at[i])
                                 ? eng_number_ratio(numbers, way->share[i], way->den)
                                 : way->at[i];
    }
    bool is_apart = distance->hi > 0;
    numbers->is_unsure |= is_apart && way->side == ENG_UNSURE;
    for (int k = 0; k < 3 && !numbers->is_unsure; k++) {
        double cosine = is_apart ? eng_number_cosine(numbers, way->g.c[k], way->gg) : 0;
        distance->direction[k] = (way->side == ENG_MINUS ? -cosine : cosine) + 0.0;
    }
}

static void find(struct eng_distances *distances, enum pccd_kind kind,
                 const double x[4][3], const uint8_t rank[4],
                 struct eng_distance *distance)
{
    struct glance glance;
    if (may_be_quick(distances) &&
        (count_shared(kind, x, distance) == 1 ||
         (look(kind, x, &glance) && describe_quickly(&glance, distance)))) {
        distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
        return;
    }
    struct eng_numbers *numbers = &distances->numbers;
    enum eng_distance_stage stage = slow_stage(distances);
    for (;; stage++) {
        struct eng_distance_exact way;
        begin(distances, stage, x, 4);
        eng_distance_rule(numbers, kind, rank, &way);
        if (!numbers->is_unsure) {
            describe(numbers, &way, distance);
        }
        if (is_decided(distances, stage)) {
            return;
        }
    }
}

void eng_distance_find(struct eng_distances *distances, enum pccd_kind kind,
                       const double x[4][3], const uint8_t rank[4],
                       struct eng_distance *distance)
{
    find(distances, eng_distance_form(kind), x, rank, distance);
    eng_distance_convert_params(kind, distance);
}

bool eng_distance_crosses(struct eng_distances *distances, const double x[5][3])
{
    if (may_be_quick(distances)) {
        enum eng_sign sign = cross_quickly(x);
        if (sign != ENG_UNSURE) {
            distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
            return sign == ENG_PLUS;
        }
    }
    enum eng_distance_stage stage = slow_stage(distances);
    for (;; stage++) {
        begin(distances, stage, x, 5);
        bool answer = eng_crossing_rule(&distances->numbers);
        if (is_decided(distances, stage)) {
            return answer;
        }
    }
}

double eng_distance_crossing(struct eng_distances *distances, const double x[5][3])
{
    double position;
    if (may_be_quick(distances) && eng_crossing_quickly(x, &position)) {
        distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
        return position;
    }
    enum eng_distance_stage stage = slow_stage(distances);
    for (;; stage++) {
        begin(distances, stage, x, 5);
        position = eng_crossing_position(&distances->numbers);
        if (is_decided(distances, stage)) {
            return position;
        }
    }
}
