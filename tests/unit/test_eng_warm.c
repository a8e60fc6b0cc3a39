/* test_eng_warm.c - a warm step allocates nothing. */
#include "eng_kit.h"
#include "step.h"

/* Calls of malloc and its kin since the start. Compilers believe that malloc changes
 * nothing that they see. */
static volatile size_t calls;

/* Calls of malloc, realloc, calloc and aligned_alloc that are seen: the thread sanitizer
 * of clang 14 does not tell of the last. */
#define SEEN 4
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HAS_SANITIZER 1
#endif
#if __has_feature(thread_sanitizer)
#undef SEEN
#define SEEN 3
#endif
#endif

#ifdef HAS_SANITIZER

/* The sanitizer owns malloc, and tells. */
int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void *,
                                                                size_t),
                                              void (*on_free)(const volatile void *));

static void on_malloc(const volatile void *block, size_t bytes)
{
    (void)block;
    (void)bytes;
    calls++;
}

static void on_free(const volatile void *block)
{
    (void)block;
}

static int start_counting(void **state)
{
    (void)state;
    assert_true(__sanitizer_install_malloc_and_free_hooks(on_malloc, on_free) > 0);
    return 0;
}

#else

/* These take the place of the C library's for every library of the process; its own names
 * with two underscores remain. */
#define EXPORT __attribute__((visibility("default")))

void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *block, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);

EXPORT void *malloc(size_t bytes)
{
    calls++;
    return __libc_malloc(bytes);
}

EXPORT void *calloc(size_t count, size_t bytes)
{
    calls++;
    return __libc_calloc(count, bytes);
}

EXPORT void *realloc(void *block, size_t bytes)
{
    calls++;
    return __libc_realloc(block, bytes);
}

EXPORT void *aligned_alloc(size_t alignment, size_t bytes)
{
    calls++;
    return __libc_memalign(alignment, bytes);
}

static int start_counting(void **state)
{
    (void)state;
    return 0;
}

#endif

/* If it failed: the counting below would count nothing. */
CASE(warm__counting_counts)
{
    size_t before = calls;
    void *volatile block = malloc(10);
    block = realloc(block, 100000);
    free(block);
    block = calloc(3, 5);
    free(block);
    block = aligned_alloc(64, 128);
    free(block);
    assert_true(calls - before >= SEEN);
    mpz_t number; /* of GMP, another library */
    before = calls;
    mpz_init2(number, 1024);
    assert_true(calls - before >= 1);
    mpz_clear(number);
}

#define SIDE     12u
#define MODES    4
#define VERTICES ((SIDE + 1) * (SIDE + 1))

struct fixture {
    struct eng_scene *scene;
    double x0[VERTICES][3];
    double x1[VERTICES][3];
    float up[VERTICES][3];
    float down[VERTICES][3];
};

/* Three sheets: one stands, one falls through it in waves, one comes in its own plane, so
 * that exact arithmetic has work too. */
static int setup(void **state)
{
    static struct fixture f;
    struct prng random = {95};
    f.scene = kit_scene();
    for (uint32_t i = 0; i < 3; i++) {
        kit_add(f.scene, kit_sheet(SIDE, 0), i);
    }
    for (uint32_t v = 0; v < VERTICES; v++) {
        double x = (double)(v % (SIDE + 1)) / SIDE;
        double y = (double)(v / (SIDE + 1)) / SIDE;
        for (int k = 0; k < 3; k++) {
            f.x0[v][k] = k == 0 ? x + 0.03 : k == 1 ? y + 0.07 : 0.1;
            f.x1[v][k] = f.x0[v][k] - (k == 2 ? prng_between(&random, 0, 0.2) : 0);
            f.up[v][k] = (float)(k == 0 ? x + 1.5 : k == 1 ? y : 0);
            f.down[v][k] = f.up[v][k] - (k == 0 ? 1.25f : 0);
        }
    }
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    eng_scene_free(f->scene);
    return 0;
}

static struct eng_step_result run_by(struct fixture *f, enum pccd_mode mode,
                                     enum pccd_method method)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    int status = PCCD_OK;
    settings.mode = mode;
    settings.method = method;
    eng_stage_begin(f->scene);
    status |= eng_stage_x0x1(f->scene, 1, PCCD_FORMAT_F64, 0, VERTICES, f->x0, f->x1);
    status |= eng_stage_x0x1(f->scene, 2, PCCD_FORMAT_F32, 0, 100, f->up, f->down);
    status |= eng_stage_x0x1(f->scene, 2, PCCD_FORMAT_F32, 100, VERTICES - 100,
                             f->up + 100, f->down + 100);
    status |= eng_step(f->scene, &settings, &result);
    assert_ok(status);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    return result;
}

/* If it failed: a step's time would depend on the state of the heap, and could fail in
 * it. */
CASE_WITH(warm__second_step_allocates_nothing, setup, teardown)
{
    struct fixture *f = *state;
    for (int round = 0; round < 2 * MODES; round++) {
        enum pccd_mode mode = (enum pccd_mode)(round % MODES);
        enum pccd_method method = round < MODES ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE;
        struct eng_step_result first = run_by(f, mode, method);
        (void)run_by(f, mode, method); /* the first that keeps what stands */
        for (int again = 0; again < 3; again++) {
            size_t before = calls;
            struct eng_step_result second = run_by(f, mode, method);
            size_t after = calls;
            assert_int_equal(after - before, 0);
            assert_int_equal(second.counters.allocs, 0);
            assert_int_equal(second.counters.builds, 0);
            assert_int_equal(second.hash[0], first.hash[0]);
            assert_int_equal(second.hash[1], first.hash[1]);
        }
        assert_true(mode != PCCD_MODE_ALL || first.count > 1000);
        assert_true(mode != PCCD_MODE_ALL || first.counters.exact > 100);
    }
}

/* If it failed: aborting a step would cost memory. */
CASE_WITH(warm__aborted_staging_allocates_nothing, setup, teardown)
{
    struct fixture *f = *state;
    run_by(f, PCCD_MODE_ANY, PCCD_METHOD_DEFAULT);
    size_t before = calls;
    for (int again = 0; again < 10; again++) {
        eng_stage_begin(f->scene);
        int status =
            eng_stage_x0x1(f->scene, 1, PCCD_FORMAT_F64, 0, VERTICES, f->x0, f->x1);
        eng_stage_abort(f->scene);
        assert_ok(status);
    }
    assert_int_equal(calls - before, 0);
}

CASES_WITH(start_counting, NULL);
