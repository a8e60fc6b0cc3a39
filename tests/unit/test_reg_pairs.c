/* test_reg_pairs.c - pairs that ignore each other, as the registry keeps them. */
#include "cases.h"
#include "prng.h"
#include "registry.h"

#define OBJECTS 24u

static void check(struct registry_pairs *pairs, bool told[OBJECTS][OBJECTS])
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
            assert_int_equal(registry_pairs_has(pairs, b, a), told[a][b]);
            count += told[a][b];
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
        bool told[OBJECTS][OBJECTS] = {{false}};

        for (uint32_t i = 0; i < 2000; i++) {
            uint32_t a = prng_u32(&prng, OBJECTS);
            uint32_t b = (a + 1 + prng_u32(&prng, OBJECTS - 1)) % OBJECTS;
            bool ignored = prng_below(&prng, 3) > 0;

            if (prng_below(&prng, 100) == 0) {
                registry_pairs_forget(&pairs, a);
                for (uint32_t k = 0; k < OBJECTS; k++) {
                    told[a][k] = told[k][a] = false;
                }
            } else {
                assert_int_equal(registry_pairs_note(&pairs, a, b, ignored), 0);
                told[a][b] = told[b][a] = ignored;
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
