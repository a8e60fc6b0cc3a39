/* test_eng_parts.c - ids of objects, a stable radix sort, divisors by primes, and which
 * nodes of a tree are below which.
 *
 * Source: daemon/engine/paper/trees.h; paper section 4.1.
 */
#include "eng_kit.h"

#include "eng_crew.h"
#include "pccd_types.h"
#include "poly.h"
#include "sort.h"
#include "trees.h"
#include "world.h"

/* ---- which object of a scene has an id --------------------------------------------- */

#define NUMBERS 300u
#define TURNS   20000u

/* Ids as handles are: an index and a generation. Many of them share their low bits. */
static uint32_t id_of(uint32_t number)
{
    return (number % 7) << 20 | (number + 1);
}

static void check_ids(const struct eng_ids *ids, const uint32_t model[NUMBERS])
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
    check_ids(&ids, model);
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
            check_ids(&ids, model);
        }
    }
    check_ids(&ids, model);
    assert_true(ids.size <= 4 * NUMBERS); /* it grows with what is there alone */
    assert_int_equal(eng_ids_bytes(&ids), ids.size * sizeof *ids.table);
    eng_ids_deinit(&ids);
}

/* ---- a stable radix sort ----------------------------------------------------------- */

#define ITEMS_MAX 3000u

static int compare(const void *a, const void *b)
{
    const struct eng_radix_key *x = a;
    const struct eng_radix_key *y = b;
    if (x->key != y->key) {
        return x->key < y->key ? -1 : 1;
    }
    return x->index < y->index ? -1 : x->index > y->index;
}

static void check_sort(struct prng *random, size_t count, uint64_t mask)
{
    static struct eng_radix_key keys[ITEMS_MAX];
    static struct eng_radix_key room[ITEMS_MAX];
    static struct eng_radix_key sorted_keys[ITEMS_MAX];
    uint64_t common = prng_next(random) & ~mask;
    for (size_t i = 0; i < count; i++) {
        keys[i] = (struct eng_radix_key){common | (prng_next(random) & mask), i};
    }
    memcpy(sorted_keys, keys, count * sizeof *keys);
    qsort(sorted_keys, count, sizeof *sorted_keys, compare);
    const struct eng_radix_key *sorted = eng_radix_sort(keys, room, count);
    assert_true(sorted == keys || sorted == room);
    if (count > 0) {
        assert_memory_equal(sorted, sorted_keys, count * sizeof *sorted);
    }
}

/* If it failed: an answer would come out of order where its names differ in bits that
 * fill no whole number of digits. */
CASE(radix__keys_sort_for_any_bits_that_differ)
{
    struct prng random = {7};
    const size_t counts[] = {0, 1, 2, 23, 24, 25, 26, 300, ITEMS_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        check_sort(&random, counts[i], 0);
        check_sort(&random, counts[i], UINT64_MAX);
        check_sort(&random, counts[i], 0x8000000000000001u);
        for (unsigned low = 0; low < 64; low += 3) {
            for (unsigned bits = 1; bits <= 64 - low; bits += 4) {
                check_sort(&random, counts[i] % 1000, (UINT64_MAX >> (64 - bits)) << low);
            }
        }
    }
}

/* If it failed: an answer of threads would depend on which of them had found it. */
CASE(radix__equal_keys_keep_their_order)
{
    struct prng random = {5};
    check_sort(&random, ITEMS_MAX, 3);                     /* few keys, long runs */
    check_sort(&random, ITEMS_MAX, (uint64_t)1 << 52 | 1); /* in digits far apart */
}

/* ---- greatest common divisors ------------------------------------------------------ */

static void set_numbers(struct eng_poly *poly, int degree, const long *numbers,
                        unsigned long shift)
{
    poly->degree = degree;
    for (int i = 0; i <= degree; i++) {
        mpz_set_si(poly->c[i], numbers[i]);
        mpz_mul_2exp(poly->c[i], poly->c[i], shift * (unsigned long)(degree - i));
    }
}

static struct eng_divisor *divisor_scratch(void)
{
    static struct eng_divisor divisor;
    struct eng_limbs limbs = {NULL, 0};
    eng_divisor_allocate(&divisor, &limbs);
    limbs = (struct eng_limbs){calloc(limbs.count, sizeof(mp_limb_t)), 0};
    assert_non_null(limbs.next);
    eng_divisor_allocate(&divisor, &limbs);
    return &divisor;
}

/* Products of short and of long polynomials; and t - 2^260 and 2 t^2 - 1, which have a
 * common root modulo 2^521 - 1. If it failed: a side would be said to be 0 at a root
 * where it is not, or a root to be there twice. */
CASE(divisor__is_that_of_remainders)
{
    static const long unlucky[2][3] = {{-1, 1}, {-1, 0, 2}};
    struct prng random = {3};
    struct eng_divisor *divisor = divisor_scratch();
    mp_limb_t *block = divisor->common.c[0]->_mp_d;
    struct eng_poly p[6];
    int degrees[6] = {0}; /* 3 + 2 at most */
    for (int i = 0; i < 6; i++) {
        kit_poly_init(&p[i]);
    }
    for (int n = 0; n < 2000; n++) {
        unsigned long shift = prng_u32(&random, 3) ? prng_u32(&random, 40) : 700;
        for (int i = 0; i < 3; i++) {
            long numbers[4];
            int degree = (int)prng_u32(&random, i == 0 ? 4 : 3);
            for (int k = 0; k <= degree; k++) {
                numbers[k] = (long)prng_u32(&random, 9) - 4;
            }
            numbers[degree] = 1 + (long)prng_u32(&random, 3);
            set_numbers(&p[i], degree, numbers, shift);
        }
        eng_poly_mul(&p[3], &p[0], &p[1]);
        eng_poly_mul(&p[4], &p[0], &p[2]);
        if (p[3].degree < 1 || p[4].degree < 1) {
            continue;
        }
        eng_divisor_find(divisor, &p[3], &p[4]);
        eng_poly_gcd(&p[5], &p[3], &p[4]);
        eng_poly_make_primitive(&p[5]);
        assert_int_equal(divisor->common.degree, p[5].degree);
        for (int i = 0; i <= p[5].degree && p[5].degree > 0; i++) {
            int same = mpz_sgn(p[5].c[p[5].degree]) > 0
                           ? mpz_cmp(divisor->common.c[i], p[5].c[i])
                           : mpz_cmpabs(divisor->common.c[i], p[5].c[i]);
            assert_int_equal(same, 0);
        }
        degrees[p[5].degree]++;
    }
    assert_true(degrees[0] > 50 && degrees[1] > 50 && degrees[2] > 50 && degrees[3] > 50);
    set_numbers(&p[3], 1, unlucky[0], 260);
    set_numbers(&p[4], 2, unlucky[1], 0);
    eng_divisor_find(divisor, &p[3], &p[4]);
    assert_int_equal(divisor->common.degree, 0);
    for (int i = 0; i < 6; i++) {
        kit_poly_deinit(&p[i]);
    }
    free(block);
}

/* ---- which nodes are below which --------------------------------------------------- */

/* Parents of all nodes; the root's is ENG_NO_NODE. */
static void find_parents(const struct eng_scene *scene, uint32_t *parents)
{
    for (uint32_t i = 0; i < eng_trees_of(scene)->node_ranges.end; i++) {
        parents[i] = ENG_NO_NODE;
    }
    for (uint32_t i = 0; i < eng_trees_of(scene)->node_ranges.end; i++) {
        if (eng_trees_of(scene)->nodes[i].left != ENG_LEAF) {
            parents[eng_trees_of(scene)->nodes[i].left] = i;
            parents[eng_trees_of(scene)->nodes[i].right] = i;
        }
    }
}

/* If it failed: the check of disjoint task units would miss, or invent, a conflict, and a
 * subtree would be refit in part. */
CASE(subtree__order_says_what_the_links_say)
{
    static const uint32_t sizes[] = {5, 1, 9, 1, 2, 17};
    static uint32_t parents[256];
    struct prng random = {5};
    struct eng_scene *scene = kit_scene();
    for (uint32_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        kit_add(scene, kit_soup(&random, sizes[i]), i);
    }
    assert_ok(eng_paper_add_objects(scene));
    assert_ok(eng_build_top(scene));
    assert_true(eng_trees_of(scene)->node_ranges.end <= sizeof parents / sizeof *parents);
    find_parents(scene, parents);
    uint32_t pairs = 0;
    for (uint32_t root = 0; root < eng_trees_of(scene)->node_ranges.end; root++) {
        for (uint32_t node = 0; node < eng_trees_of(scene)->node_ranges.end; node++) {
            uint32_t up = node;
            while (up != ENG_NO_NODE && up != root) {
                up = parents[up];
            }
            assert_int_equal(eng_node_is_below(scene, root, node), up == root);
            pairs += up == root;
        }
    }
    assert_true(pairs > eng_trees_of(scene)->node_ranges.end);
    eng_scene_free(scene);
}

/* If it failed: two threads would work below the same node without a lock (the step
 * asserts it in builds with --enable-validate), or a task unit would be left out. */
CASE_WITH(subtree__threads_perform_disjoint_task_units, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_step_result alone = crew_run(crew, crew_alone(PCCD_MODE_ALL));
    for (uint32_t threads = 2; threads <= 8; threads++) {
        for (int round = 0; round < 10; round++) {
            struct eng_question settings = crew_alone(PCCD_MODE_ALL);
            settings.threads = threads;
            settings.tuning.scheduler = ENG_SCHEDULER_PAPER;
            struct eng_step_result team = crew_run(crew, settings);
            assert_int_equal(team.counters.task_units, alone.counters.task_units);
            assert_int_equal(team.hash[1], alone.hash[1]);
        }
    }
}
