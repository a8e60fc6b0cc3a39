/* test_eng_pairset.c - a set of unordered pairs. */
#include "eng_kit.h"
#include "masks.h"
#include "memory.h"

#define NUMBERS 60u

struct model {
    bool has[NUMBERS][NUMBERS];
    uint32_t count;
};

static void set(struct model *model, uint32_t a, uint32_t b, bool has)
{
    model->count += (uint32_t)has - (uint32_t)model->has[a][b];
    model->has[a][b] = has;
    model->has[b][a] = has;
}

static double value_of(uint32_t a, uint32_t b)
{
    return a + b + 0.5 * a * b;
}

static void check(const struct model *model, const struct eng_pairset *pairs)
{
    assert_int_equal(pairs->count, model->count);
    assert_true(2 * pairs->count <= pairs->capacity);
    assert_int_equal(pairs->capacity == 0, pairs->count == 0);
    for (uint32_t a = 0; a < NUMBERS; a++) {
        for (uint32_t b = 0; b < NUMBERS; b++) {
            assert_true(a == b || eng_pairset_has(pairs, a, b) == model->has[a][b]);
            assert_true(a == b || eng_pairset_value(pairs, a, b, -1) ==
                                      (model->has[a][b] ? value_of(a, b) : -1));
        }
    }
}

/* Everything that has `a`, each once. */
static void take_all(struct model *model, struct eng_pairset *pairs, uint32_t a)
{
    uint32_t from = 0;
    uint32_t other;
    double value;
    while (eng_pairset_take(pairs, a, &from, &other, &value)) {
        assert_true(other < NUMBERS && model->has[a][other]);
        assert_true(value == value_of(a, other));
        set(model, a, other, false);
    }
    for (uint32_t b = 0; b < NUMBERS; b++) {
        assert_false(model->has[a][b]);
    }
}

/* If it failed: pairs of objects would be ignored, or tested, that should not. */
CASE(pairset__holds_what_was_added)
{
    struct prng random = {5};
    for (uint32_t round = 0; round < 40; round++) {
        struct model model = {.count = 0};
        struct eng_pairset pairs = {.capacity = 0};
        uint32_t adds = 1 + prng_u32(&random, 4); /* of five */
        for (uint32_t i = 0; i < 2000; i++) {
            uint32_t a = prng_u32(&random, NUMBERS);
            uint32_t b = (a + 1 + prng_u32(&random, NUMBERS - 1)) % NUMBERS;
            if (prng_u32(&random, 100) == 0) {
                take_all(&model, &pairs, a);
            } else if (prng_u32(&random, 5) < adds) {
                assert_ok(eng_pairset_add(&pairs, a, b, value_of(a, b)));
                set(&model, a, b, true);
            } else {
                eng_pairset_remove(&pairs, a, b);
                set(&model, a, b, false);
            }
            if (i % 100 == 99) {
                check(&model, &pairs);
            }
        }
        for (uint32_t a = 0; a < NUMBERS; a++) {
            take_all(&model, &pairs, a);
        }
        check(&model, &pairs);
        assert_null(pairs.slots);
    }
}

/* If it failed: without memory a pair would be lost, or a wrong one found. */
CASE(pairset__stays_as_it_was_without_memory)
{
    struct eng_pairset pairs = {.capacity = 0};
    uint64_t before = eng_alloc_bytes();
    uint32_t a = 1;
    struct eng_account account = {.limit = 0};
    eng_payer()->account = &account;
    assert_int_equal(eng_pairset_add(&pairs, 0, 1, 0), PCCD_E_NOMEM);
    account.limit = INT64_MAX;
    assert_int_equal(pairs.count, 0);
    assert_ok(eng_pairset_add(&pairs, 0, 1, 0));
    account.limit = account.bytes;
    do {
        a++;
    } while (eng_pairset_add(&pairs, a, 0, 0) == PCCD_OK);
    eng_payer()->account = NULL;
    assert_int_equal(pairs.count, a - 1);
    assert_true(eng_pairset_has(&pairs, 0, a - 1));
    assert_false(eng_pairset_has(&pairs, 0, a));
    assert_true(eng_pairset_bytes(&pairs) <= eng_alloc_bytes() - before);
    eng_pairset_deinit(&pairs);
    assert_int_equal(eng_alloc_bytes(), before);
}

/* If it failed: a client could take any memory, or be refused before the limit, and
 * what it takes back would not make room. */
CASE(pairset__of_a_scene_has_a_limit)
{
    struct eng_masks masks;
    uint32_t a = 0;
    uint32_t b = 0;
    int status = PCCD_OK;
    eng_masks_init(&masks);
    assert_ok(eng_masks_reserve(&masks, 1000));
    while (status == PCCD_OK) {
        a = b == a + 1 || b == 0 ? 0 : a + 1;
        b = a == 0 ? b + 1 : b;
        status = eng_masks_set_pair(&masks, a, b, ENG_PAIR_IGNORED);
    }
    assert_int_equal(status, PCCD_E_LIMIT);
    assert_int_equal(masks.ignored_count, PROTO_IGNORED_PER_SCENE);
    assert_false(eng_masks_ignores(&masks, a, b));
    assert_true(eng_masks_allows(&masks, a, b));
    assert_ok(eng_masks_set_pair(&masks, 1, 0, ENG_PAIR_IGNORED)); /* it is already */
    assert_ok(eng_masks_set_pair(&masks, 0, 1, ENG_PAIR_PLAIN));
    assert_ok(eng_masks_set_pair(&masks, b, a, ENG_PAIR_IGNORED));
    assert_true(eng_masks_ignores(&masks, a, b));
    for (uint32_t i = 0; i < 1000; i++) {
        eng_masks_forget(&masks, i);
        assert_int_equal(masks.entries[i].pairs, 0);
    }
    assert_false(eng_masks_is_on(&masks));
    assert_int_equal(eng_pairset_bytes(&masks.pairs), 0);
    eng_masks_deinit(&masks);
}

/* If it failed: pairs of objects that go would stay, or others' pairs go with them; or
 * the counts of the others be wrong, whose pairs are looked for by these. */
CASE(pairset__of_hidden_objects_goes_at_once)
{
    struct prng random = {6};
    for (uint32_t round = 0; round < 200; round++) {
        struct eng_masks masks;
        bool ignored[NUMBERS][NUMBERS] = {{false}};
        eng_masks_init(&masks);
        assert_ok(eng_masks_reserve(&masks, NUMBERS));
        for (uint32_t i = 0; i < 1 + prng_u32(&random, 300); i++) {
            uint32_t a = prng_u32(&random, NUMBERS);
            uint32_t b = (a + 1 + prng_u32(&random, NUMBERS - 1)) % NUMBERS;
            assert_ok(eng_masks_set_pair(&masks, a, b, ENG_PAIR_IGNORED));
            ignored[a][b] = ignored[b][a] = true;
        }
        uint32_t hidden = prng_u32(&random, NUMBERS + 1); /* the first ones */
        for (uint32_t a = 0; a < hidden; a++) {
            eng_masks_exclude(&masks, a);
        }
        eng_masks_purge_excluded(&masks);
        for (uint32_t a = 0; a < NUMBERS; a++) {
            uint32_t count = 0;
            for (uint32_t b = 0; b < NUMBERS; b++) {
                bool stays = ignored[a][b] && a >= hidden && b >= hidden;
                assert_true(a == b || eng_masks_ignores(&masks, a, b) == stays);
                assert_true(a >= hidden || !eng_masks_allows(&masks, a, b));
                count += stays;
            }
            assert_int_equal(masks.entries[a].pairs, count);
        }
        eng_masks_deinit(&masks);
    }
}
