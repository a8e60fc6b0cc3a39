/* distance.c - exact distances, by the first stage that is sure. */
#include "distance.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "crossing.h"
#include "distance_quick.h"
#include "distance_rule.h"

int eng_distances_init(struct eng_distances *distances)
{
    memset(distances, 0, sizeof *distances);
    return eng_numbers_init(&distances->numbers);
}

void eng_distances_deinit(struct eng_distances *distances)
{
    eng_numbers_deinit(&distances->numbers);
}

/* Is it doubles' turn? */
static bool may_be_quick(const struct eng_distances *distances)
{
    return distances->first == ENG_DISTANCE_BY_DOUBLES;
}

/* The first stage after that of doubles. */
static enum eng_distance_stage slow_stage(const struct eng_distances *distances)
{
    return may_be_quick(distances) ? ENG_DISTANCE_BY_PAIRS : distances->first;
}

/* Load the points for a stage. */
static void begin(struct eng_distances *distances, enum eng_distance_stage stage,
                  const double (*x)[3], int point_count)
{
    eng_numbers_load(&distances->numbers, stage == ENG_DISTANCE_BY_INTEGERS, x,
                     point_count);
}

/* Is the stage's answer one? Integers are never unsure. */
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
    struct eng_way way;
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
    struct eng_place place;
    struct eng_distance at_0;
    if (may_be_quick(distances) && eng_quick_meet(kind, x, &at_0) > 0) {
        distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
        return d > 0 ? ENG_MINUS : ENG_ZERO;
    }
    if (may_be_quick(distances) && eng_quick_place(kind, x, &place)) {
        enum eng_sign sign = eng_quick_compare(&place, d);
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

static void describe(struct eng_numbers *numbers, const struct eng_way *way,
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
    struct eng_place place;
    if (may_be_quick(distances) &&
        (eng_quick_meet(kind, x, distance) == 1 ||
         (eng_quick_place(kind, x, &place) && eng_quick_describe(&place, distance)))) {
        distances->decided[ENG_DISTANCE_BY_DOUBLES]++;
        return;
    }
    struct eng_numbers *numbers = &distances->numbers;
    enum eng_distance_stage stage = slow_stage(distances);
    for (;; stage++) {
        struct eng_way way;
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
    eng_distance_place(kind, distance);
}

bool eng_distance_crosses(struct eng_distances *distances, const double x[5][3])
{
    if (may_be_quick(distances)) {
        enum eng_sign sign = eng_quick_crosses(x);
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
