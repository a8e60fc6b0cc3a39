/* test_reg_map.c - what belongs to a handle, among many. */
#include "cases.h"
#include "prng.h"
#include "registry.h"

#define HANDLES 300u

/* Handles as a daemon gives them, and some that fall on the same place. */
static uint32_t handle_of(uint32_t i)
{
    return i % 3 == 0 ? (i + 1) << 20 : i % 3 == 1 ? 0x100000 + i : i + 1;
}

/* If it failed, a scene among many would not be found, or another one in its place: its
 * objects would not come back after a crash. */
CASE(map__has_what_was_put_last)
{
    struct prng prng = {prng_seed()};

    for (uint32_t round = 0; round < 50; round++) {
        struct registry_map map = {.entries = NULL};
        uint64_t told[HANDLES] = {0}; /* 0: not there */
        uint32_t count = 0;

        for (uint64_t step = 1; step <= 3000; step++) {
            uint32_t i = prng_u32(&prng, HANDLES);

            if (prng_below(&prng, 2) == 0) {
                assert_int_equal(registry_map_put(&map, handle_of(i), step), 0);
                count += told[i] == 0;
                told[i] = step;
            } else {
                registry_map_remove(&map, handle_of(i));
                count -= told[i] != 0;
                told[i] = 0;
            }
            assert_int_equal(map.count, count);
        }
        for (uint32_t i = 0; i < HANDLES; i++) {
            uint64_t value = 7;

            assert_int_equal(registry_map_get(&map, handle_of(i), &value), told[i] != 0);
            assert_int_equal(value, told[i] != 0 ? told[i] : 7);
        }
        registry_map_deinit(&map);
    }
}
