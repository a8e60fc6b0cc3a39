/* tests/unit/test_eng_kernel.c - the kernels of every instruction set.
 *
 * Room:     engine (kernel.h).
 * Does:     compare each set with the scalar one, bit for bit; choose one by name.
 * Threads:  one.
 */
#include "eng_kit.h"

#include <math.h>
#include <string.h>

#include "kernel.h"

#define COUNT_MAX 67u /* more than eight vectors of the widest set */
#define LIMIT     1e18

/* The sets that this processor has besides the reference. */
static unsigned others(const struct eng_kernels *sets[ENG_ISA_COUNT])
{
    unsigned count = 0;
    for (int isa = ENG_ISA_SCALAR + 1; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels) {
            assert_int_equal(kernels->isa, isa);
            sets[count++] = kernels;
        }
    }
    return count;
}

/* If a name chose another set than it says, PCCD_CPU would measure the wrong kernels. */
static void kernels__are_chosen_by_name(void **state)
{
    static const char *const names[ENG_ISA_COUNT] = {"scalar", "sse4", "avx2", "avx512",
                                                     "neon"};
    (void)state;
    const struct eng_kernels *best = NULL;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        assert_ptr_equal(eng_kernels_named(names[isa]), kernels);
        best = kernels ? kernels : best;
    }
    assert_non_null(eng_kernels_of(ENG_ISA_SCALAR));
    assert_ptr_equal(eng_kernels_named(NULL), best);
    assert_ptr_equal(eng_kernels_named(""), best);
    assert_null(eng_kernels_named("avx"));
}

/* If a value out of range passed in some lane or in the rest behind the last vector, a
 * step would compute with it. */
static void kernels__find_a_bad_value_at_any_place(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1.0000000000000002e18, -2e18};
    (void)state;
    double x[COUNT_MAX];
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        for (uint32_t count = 0; kernels && count <= COUNT_MAX; count++) {
            for (uint32_t i = 0; i < count; i++) {
                x[i] = i % 2 ? LIMIT : -LIMIT;
            }
            assert_true(kernels->all_within(x, count, LIMIT));
            for (uint32_t i = 0; i < count; i++) {
                double good = x[i];
                x[i] = bad[i % 5];
                assert_false(kernels->all_within(x, count, LIMIT));
                x[i] = good;
            }
        }
    }
}

/* If widening differed between sets, a step's input would depend on the processor. */
static void kernels__widen_to_the_same_bits(void **state)
{
    const struct eng_kernels *sets[ENG_ISA_COUNT];
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    unsigned count = others(sets);
    float x[COUNT_MAX];
    double expected[COUNT_MAX];
    double out[COUNT_MAX];
    (void)state;
    for (uint32_t i = 0; i < COUNT_MAX; i++) {
        x[i] = ldexpf(i % 2 ? -1.0f - (float)i / 64 : 1.0f, (int)(i * 4) - 149);
    }
    for (uint32_t n = 0; n <= COUNT_MAX; n++) {
        bool good = scalar->widen_within(expected, x, n, LIMIT);
        assert_int_equal(good, n <= 53); /* x[53] is beyond the limit */
        for (unsigned k = 0; k < count; k++) {
            memset(out, 0xff, sizeof out);
            assert_int_equal(sets[k]->widen_within(out, x, n, LIMIT), good);
            assert_memory_equal(out, expected, n * sizeof *out);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels__are_chosen_by_name),
        cmocka_unit_test(kernels__find_a_bad_value_at_any_place),
        cmocka_unit_test(kernels__widen_to_the_same_bits),
    };
    return cmocka_run_group_tests_name("eng_kernel", tests, NULL, NULL);
}
