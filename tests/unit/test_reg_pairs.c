/* test_reg_pairs.c - pairs that ignore each other, as the registry keeps them. */
#include "cases.h"
#include "prng.h"
#include "registry.h"

#define OBJECTS 24u

/* Check what was told of pairs: 0 nothing, 1 they ignore each other, else a clearance. */
static void check(struct registry_pairs *pairs, int told[OBJECTS][OBJECTS])
{
    uint32_t count = 0;

    registry_pairs_settle(pairs);
    for (uint32_t i = 0; i < pairs->count; i++) {
        const struct registry_pair *pair = &pairs->said[i];

        assert_true(pair->a < pair->b && told[pair->a][pair->b]);
        assert_true(i == 0 || pairs->said[i - 1].a < pair->a ||
                    pairs->said[i - 1].b < pair->b); /* each once */
    }
    for (uint32_t a = 0; a < OBJECTS; a++) {
        for (uint32_t b = a + 1; b < OBJECTS; b++) {
            const struct registry_pair *pair = registry_pairs_find(pairs, b, a);
            assert_int_equal(pair != NULL, told[a][b] != 0);
            assert_true(pair == NULL || pair->ignored == (told[a][b] == 1));
            assert_true(registry_pairs_clearance(pairs, b, a) ==
                        (told[a][b] > 1 ? told[a][b] : -1));
            count += told[a][b] != 0;
        }
    }
    assert_int_equal(pairs->count, count);
}

/* If it failed, a daemon that was told anew would test pairs that the last one had been
 * told to ignore, or ignore those that it had not. */
CASE(pairs__are_the_last_word_on_each)
{
    struct prng prng = {prng_seed()};

    for (uint32_t round = 0; round < 100; round++) {
        struct registry_pairs pairs = {.count = 0};
        int told[OBJECTS][OBJECTS] = {{0}};

        for (uint32_t i = 0; i < 2000; i++) {
            uint32_t a = prng_u32(&prng, OBJECTS);
            uint32_t b = (a + 1 + prng_u32(&prng, OBJECTS - 1)) % OBJECTS;
            int word = (int)prng_below(&prng, 4);
            const struct registry_pair said = {.a = a,
                                               .b = b,
                                               .ignored = word == 1,
                                               .has_clearance = word > 1,
                                               .clearance = word};

            if (prng_below(&prng, 100) == 0) {
                registry_pairs_forget(&pairs, a);
                for (uint32_t k = 0; k < OBJECTS; k++) {
                    told[a][k] = told[k][a] = 0;
                }
            } else {
                assert_int_equal(registry_pairs_note(&pairs, &said), 0);
                told[a][b] = told[b][a] = word;
            }
            if (prng_below(&prng, 300) == 0) {
                check(&pairs, told);
            }
        }
        check(&pairs, told);
        assert_true(pairs.room <= 1024); /* it does not grow with what was said twice */
        registry_pairs_deinit(&pairs);
    }
}
