/* test_eng_separate.c - fixed directions between two features. */
#include "eng_kit.h"
#include "kernel.h"

#define DIRECTIONS 9

static const int directions[DIRECTIONS][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                              {1, 1, 0},  {1, -1, 0}, {0, 1, 1},
                                              {0, 1, -1}, {1, 0, 1},  {-1, 0, 1}};

/* Return whether the second feature is above the first at both ends, or below it at
 * both. */
static bool is_apart_along(const struct eng_query *query, const int d[3])
{
    int split = query->kind == PCCD_VF ? 1 : 2;
    bool above = true;
    bool below = true;
    for (int end = 0; end < 2; end++) {
        for (int a = 0; a < split; a++) {
            for (int b = split; b < 4; b++) {
                double gap = 0; /* of small whole numbers: exact */
                for (int k = 0; k < 3; k++) {
                    gap += d[k] * (query->x[end][b][k] - query->x[end][a][k]);
                }
                above = above && gap > 0;
                below = below && gap < 0;
            }
        }
    }
    return above || below;
}

/* If it failed: a direction would be left out, or a pair that only a direction between
 * them tells apart, or one that changes sides, would be dropped. */
CASE(separate__says_what_nine_directions_say)
{
    struct prng random = {811};
    int alone[2][DIRECTIONS] = {{0}};
    int apart = 0;
    enum { ROUNDS = 200000 };
    for (int round = 0; round < ROUNDS; round++) {
        struct eng_query query = {.kind = round % 2 ? PCCD_EE : PCCD_VF};
        for (int i = 0; i < 24; i++) {
            query.x[i / 12][i / 3 % 4][i % 3] = prng_integer(&random, 6);
        }
        int count = 0;
        int last = 0;
        for (int k = 0; k < DIRECTIONS; k++) {
            if (is_apart_along(&query, directions[k])) {
                count++;
                last = k;
            }
        }
        assert_int_equal(eng_query_separates(&query), count > 0);
        apart += count > 0;
        alone[query.kind == PCCD_EE][last] += count == 1;
    }
    for (int k = 0; k < DIRECTIONS; k++) {
        assert_true(alone[0][k] > 50 && alone[1][k] > 50);
    }
    assert_true(apart > ROUNDS / 50 && apart < ROUNDS / 2);
}

/* If it failed: a contact would be missed whose sums of coordinates are rounded. */
CASE(separate__never_drops_a_contact)
{
    struct prng random = {812};
    for (int round = 0; round < 60000; round++) {
        struct eng_query query;
        kit_plant(&random, round % 2 ? PCCD_EE : PCCD_VF, prng_u32(&random, 9), &query);
        assert_false(eng_query_separates(&query));
        /* A sixth of the numbers moved by a bit: less than any margin. */
        struct eng_query near = query;
        for (int i = 0; i < 24; i++) {
            double *x = &near.x[i / 12][i / 3 % 4][i % 3];
            *x = prng_u32(&random, 6) == 0 ? *x * (1 + 0x1p-52) : *x;
        }
        assert_true(!eng_query_separates(&near) || is_apart_along(&near, directions[0]) ||
                    is_apart_along(&near, directions[1]) ||
                    is_apart_along(&near, directions[2]));
    }
}
