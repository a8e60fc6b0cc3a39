/* test_eng_ids.c - which object of a scene has an id. */
#include "eng_kit.h"
#include "pccd_types.h"
#include "world.h"

#define NUMBERS 300u
#define TURNS   20000u

/* Ids as handles are: an index and a generation. Many of them share their low bits. */
static uint32_t id_of(uint32_t number)
{
    return (number % 7) << 20 | (number + 1);
}

static void check(const struct eng_ids *ids, const uint32_t model[NUMBERS])
{
    for (uint32_t i = 0; i < NUMBERS; i++) {
        assert_int_equal(eng_ids_find(ids, id_of(i)), model[i]);
    }
}

/* If this failed, an object would not be found by its id, or one that is gone would. */
CASE(ids__are_those_that_came_and_did_not_go)
{
    struct eng_ids ids = {.table = NULL};
    uint32_t model[NUMBERS];
    uint32_t count = 0;
    for (uint32_t i = 0; i < NUMBERS; i++) {
        model[i] = ENG_NO_OBJECT;
    }
    check(&ids, model);
    srand(1);
    for (uint32_t turn = 0; turn < TURNS; turn++) {
        uint32_t number = (uint32_t)rand() % NUMBERS;
        if (model[number] != ENG_NO_OBJECT) {
            eng_ids_remove(&ids, id_of(number));
            model[number] = ENG_NO_OBJECT;
            count--;
        } else {
            assert_ok(eng_ids_reserve(&ids, ++count));
            eng_ids_add(&ids, id_of(number), turn);
            model[number] = turn;
        }
        if (turn % 50 == 0) {
            check(&ids, model);
        }
    }
    check(&ids, model);
    assert_true(ids.size <= 4 * NUMBERS); /* it grows with what is there alone */
    assert_int_equal(eng_ids_bytes(&ids), ids.size * sizeof *ids.table);
    eng_ids_deinit(&ids);
}
