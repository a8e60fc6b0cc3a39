/* fuzz_sharp.c - pairs whose distance is about to be rounded otherwise. */
#include "fuzz_sharp.h"

#include <math.h>

#define NUMBERS 7

/* Return one of the numbers of a distance; what it is between counts as one, too. */
static double number_of(const struct eng_distance *distance, int i)
{
    switch (i) {
    case 0:
        return distance->lo;
    case 1:
    case 2:
        return distance->param[i - 1];
    case 3:
        return distance->points;
    default:
        return distance->direction[i - 4];
    }
}

static void find(struct eng_distances *distances, const struct fuzz_distance_case *made,
                 struct eng_distance *found)
{
    eng_distance_find(distances, made->kind, made->x, made->rank, found);
}

/* A number in which they differ, looked for from `first` on; NUMBERS: there is none. */
static int differing(const struct eng_distance *a, const struct eng_distance *b,
                     int first)
{
    for (int n = 0; n < NUMBERS; n++) {
        int i = (first + n) % NUMBERS;
        if (number_of(a, i) != number_of(b, i)) {
            return i;
        }
    }
    return NUMBERS;
}

/* Until no double is between the coordinates. */
static void halve(struct eng_distances *distances, int number, int point, int axis,
                  struct fuzz_distance_case made[2])
{
    struct eng_distance at;
    find(distances, &made[0], &at);
    double before = number_of(&at, number);
    for (;;) {
        struct fuzz_distance_case middle = made[0];
        double *x = &middle.x[point][axis];
        *x += (made[1].x[point][axis] - *x) / 2;
        if (*x == made[0].x[point][axis] || *x == made[1].x[point][axis]) {
            return;
        }
        find(distances, &middle, &at);
        made[number_of(&at, number) != before] = middle;
    }
}

void fuzz_sharp_make(struct prng *prng, struct eng_distances *distances,
                     enum pccd_kind kind, struct fuzz_distance_case made[2])
{
    for (;;) {
        struct eng_distance found[2];
        int point = (int)prng_below(prng, 4);
        int axis = (int)prng_below(prng, 3);
        fuzz_distance_make(prng, FUZZ_DISTANCE_SLENDER, kind, &made[0]);
        made[1] = made[0];
        /* By some of the steps in which numbers are given. */
        made[1].x[point][axis] *= 1 + ldexp(1, -34 + (int)prng_below(prng, 6));
        find(distances, &made[0], &found[0]);
        find(distances, &made[1], &found[1]);
        int number = differing(&found[0], &found[1], (int)prng_below(prng, NUMBERS));
        if (number < NUMBERS) {
            halve(distances, number, point, axis, made);
            return;
        }
    }
}
