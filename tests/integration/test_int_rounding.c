/* test_int_rounding.c - direct: in a program that computes with floats in its own way. */
#include "cases.h"

#include <fenv.h>
#include <float.h>
#include <omp.h>
#include <pthread.h>

#include "pccd.h"
#include "prng.h"
#include "rounding.h"

#define SIDE      48u
#define VERTICES  (SIDE * SIDE)
#define TRIANGLES (2 * (SIDE - 1) * (SIDE - 1))
#define FEW       8 /* triangles, in the first two rows */
#define TEAM      2

static const int directions[] = {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO};
#if defined(__x86_64__)
/* Flush to zero, denormals are zeros, both; last, all exceptions trap. */
static const uint32_t specials[] = {0, 0x8000, 0x0040, 0x8040, 0x1f80};
#else
static const uint32_t specials[] = {0};
#endif
#define DIRECTIONS (sizeof directions / sizeof directions[0])
#define SPECIALS   (sizeof specials / sizeof specials[0])
#define WAYS       (DIRECTIONS * SPECIALS)

/* Not of cmocka, which would leave a thread by longjmp. */
static bool is_bad;
#define EXPECT(condition)                                                                \
    do {                                                                                 \
        if (!(condition)) {                                                              \
            print_error("%s:%d: %s\n", __FILE__, __LINE__, #condition);                  \
            is_bad = true;                                                               \
        }                                                                                \
    } while (0)

/* Compute in the n-th way from here on. */
static void take_way(size_t n)
{
    EXPECT(fesetround(directions[n % DIRECTIONS]) == 0);
#if defined(__x86_64__)
    struct common_rounding now = common_rounding_now();
    now.sse = (now.sse & ~COMMON_ROUNDING_EXCEPTIONS) ^ specials[n / DIRECTIONS];
    __asm__ volatile("ldmxcsr %0" : : "m"(now.sse));
#endif
}

/* But for the exceptions that were raised. */
static bool is_the_same(struct common_rounding a, struct common_rounding b)
{
#if defined(__x86_64__)
    a.sse &= ~COMMON_ROUNDING_EXCEPTIONS;
    b.sse &= ~COMMON_ROUNDING_EXCEPTIONS;
    return a.sse == b.sse && a.x87 == b.x87;
#else
    return memcmp(&a, &b, sizeof a) == 0;
#endif
}

/* ---- a scene ----------------------------------------------------------------------- */

/* Two crumpled sheets, one of which falls through the other; made before anybody computes
 * in another way. The small ones are a few hundred of the smallest normal number wide. */
static double sheets[2][2][VERTICES][3], small_sheets[2][2][VERTICES][3];
static float thin_sheets[2][2][VERTICES][3]; /* subnormal as floats */
static uint32_t triangles[TRIANGLES][3];

static void make_sheets(void)
{
    struct prng prng = {7};
    uint32_t at = 0;

    for (uint32_t y = 0; y + 1 < SIDE; y++) {
        for (uint32_t x = 0; x + 1 < SIDE; x++) {
            uint32_t corner = y * SIDE + x;
            const uint32_t two[2][3] = {{corner, corner + 1, corner + SIDE},
                                        {corner + 1, corner + SIDE + 1, corner + SIDE}};

            memcpy(triangles[at], two, sizeof two);
            at += 2;
        }
    }
    for (uint32_t i = 0; i < 4 * VERTICES; i++) {
        uint32_t sheet = i / (2 * VERTICES), end = i / VERTICES % 2, v = i % VERTICES;
        double *x = sheets[sheet][end][v];

        x[0] = v % SIDE + prng_between(&prng, 0, 0.3);
        x[1] = v / SIDE * 1. + prng_between(&prng, 0, 0.3);
        x[2] = (sheet == 1) * (end == 0 ? 0.4 : -0.3) + prng_between(&prng, 0, 0.7);
        for (int k = 0; k < 3; k++) {
            small_sheets[sheet][end][v][k] = x[k] * DBL_MIN;
            thin_sheets[sheet][end][v][k] = (float)(x[k] * 1e-40);
        }
    }
}

/* Answers about the scene; what is thick, about a few of its triangles. */
struct told {
    uint64_t hash[2], near_hash[2], thick_hash[2];
    uint64_t total, near_total, thick_total, degenerate;
    double safe_step, part, reached[VERTICES][3];
};

/* The first `count` triangles of both sheets, and how the second one falls. */
struct sheets_scene {
    uint32_t scene, object[2];
    struct pccd_motion motion;
};

static struct sheets_scene make_scene(struct pccd_client *client, enum pccd_format format,
                                      const void *x, uint32_t count, struct told *told)
{
    const size_t bytes = VERTICES * (format == PCCD_FORMAT_F64 ? 24 : 12);
    const char *at = x;
    const uint32_t vertices = count == TRIANGLES ? VERTICES : 2 * SIDE;
    struct sheets_scene made;
    struct pccd_mesh_info info;
    uint32_t mesh;

    EXPECT(pccd_scene_create(client, NULL, &made.scene) == 0);
    for (int i = 0; i < 2; i++) {
        EXPECT(pccd_mesh_create(client, at + 2 * (size_t)i * bytes, format, vertices,
                                (const uint32_t(*)[3])triangles, count, &mesh,
                                &info) == 0);
        told->degenerate += info.degenerate_count;
        EXPECT(pccd_scene_add(client, made.scene, mesh, &made.object[i]) == 0);
    }
    made.motion = (struct pccd_motion){.object = made.object[1],
                                       .count = vertices,
                                       .format = format,
                                       .x0 = at + 2 * bytes,
                                       .x1 = at + 3 * bytes};
    return made;
}

static void tell(struct pccd_client *client, enum pccd_format format, const void *x,
                 double distance, struct told *told)
{
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                            .what = PCCD_OBJECT_RADIUS,
                                            .radius = 5e-324 /* which DAZ takes for 0 */};
    struct pccd_near_settings near = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    const struct common_rounding before = common_rounding_now();
    void *const to[1] = {told->reached};

    memset(told, 0, sizeof *told);
    struct sheets_scene all = make_scene(client, format, x, TRIANGLES, told);
    EXPECT(is_the_same(before, common_rounding_now()));
    EXPECT(pccd_step(client, all.scene, &all.motion, 1, NULL, &answer) == 0);
    EXPECT(is_the_same(before, common_rounding_now()));
    memcpy(told->hash, answer.hash, sizeof told->hash);
    told->total = answer.total;
    told->safe_step = answer.safe_step;
    pccd_answer_release(client, &answer);
    near.what = PCCD_NEAR_PAIRS;
    near.distance = distance;
    EXPECT(pccd_ask_near(client, all.scene, NULL, 0, &near, &answer) == 0);
    memcpy(told->near_hash, answer.hash, sizeof told->near_hash);
    told->near_total = answer.total;
    pccd_answer_release(client, &answer);
    EXPECT(pccd_step_safe(client, all.scene, &all.motion, 1, NULL, to, &told->part,
                          &answer) == 0);
    pccd_answer_release(client, &answer);
    EXPECT(pccd_scene_destroy(client, all.scene) == 0);
    EXPECT(is_the_same(before, common_rounding_now()));

    /* So small a radius leaves every pair to exact integers: few triangles. */
    struct sheets_scene few = make_scene(client, format, x, FEW, told);
    EXPECT(pccd_object_set(client, few.scene, few.object[0], &settings) == 0);
    EXPECT(pccd_step(client, few.scene, &few.motion, 1, NULL, &answer) == 0);
    memcpy(told->thick_hash, answer.hash, sizeof told->thick_hash);
    told->thick_total = answer.total;
    pccd_answer_release(client, &answer);
    EXPECT(pccd_scene_destroy(client, few.scene) == 0);
    EXPECT(is_the_same(before, common_rounding_now()));
}

struct all_told {
    struct told plain, small, thin;
};

static struct pccd_client *connect_direct(void)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;

    pccd_options_init(&options);
    options.url = "direct:";
    EXPECT(pccd_connect(&options, &client) == 0);
    return client;
}

static void tell_all(struct all_told *told)
{
    struct pccd_client *client = connect_direct();

    tell(client, PCCD_FORMAT_F64, sheets, 0.01, &told->plain);
    tell(client, PCCD_FORMAT_F64, small_sheets, 0.01 * DBL_MIN, &told->small);
    tell(client, PCCD_FORMAT_F32, thin_sheets, 1e-42, &told->thin);
    pccd_close(client);
}

static struct all_told right;

/* ---- threads of their own ---------------------------------------------------------- */

struct job {
    size_t way;
    struct all_told told;
};

/* In a new thread, which has no team yet. */
static void in_new_thread(void *(*work)(void *job), struct job *job)
{
    pthread_t thread;

    assert_int_equal(pthread_create(&thread, NULL, work, job), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_false(is_bad);
}

static struct all_told right;

static void *tell_plainly(void *job)
{
    tell_all(&((struct job *)job)->told);
    return NULL;
}

static int set_up(void **state)
{
    static struct job job;

    (void)state;
    (void)setenv("OMP_NUM_THREADS", "2", 1); /* direct: obeys it */
    make_sheets();
    in_new_thread(tell_plainly, &job);
    right = job.told;
    return right.plain.total > 500 && right.plain.near_total > 100 &&
                   right.small.total > 500 && right.thin.total > 500 &&
                   right.small.near_total > 100 && right.plain.thick_total > 0 &&
                   right.small.thick_total > 0 && right.thin.thick_total > 0
               ? 0
               : -1;
}

static void *tell_in_a_way(void *argument)
{
    struct job *job = argument;
    struct common_rounding mine;

    take_way(job->way);
    mine = common_rounding_now();
    tell_all(&job->told);
    EXPECT(is_the_same(mine, common_rounding_now()));
    return NULL;
}

/* If it failed, a program would miss contacts, or get some that there are not, because it
 * rounds otherwise or has loaded a library that does, or would round otherwise later. */
CASE(direct__answers_the_same_however_its_caller_rounds)
{
    for (size_t way = 0; way < WAYS; way++) {
        static struct job job;

        job.way = way;
        in_new_thread(tell_in_a_way, &job);
        assert_memory_equal(&job.told.plain, &right.plain, sizeof right.plain);
        assert_memory_equal(&job.told.small, &right.small, sizeof right.small);
        assert_memory_equal(&job.told.thin, &right.thin, sizeof right.thin);
    }
}

/* The first call makes the team; libgomp's keeps what it had. */
static void *tell_after_a_way(void *argument)
{
    struct job *job = argument;
    struct common_rounding before = common_rounding_now();

    take_way(job->way);
#pragma omp parallel num_threads(TEAM)
    {
        EXPECT(omp_get_num_threads() == TEAM);
    }
    tell_all(&job->told);
    common_rounding_set(&before);
    tell_all(&job->told);
    return NULL;
}

/* If it failed, a program would miss contacts for ever because its first parallel region
 * rounded otherwise. */
CASE(direct__answers_the_same_however_its_team_rounds)
{
    for (size_t way = 0; way < WAYS; way++) {
        static struct job job;

        job.way = way;
        in_new_thread(tell_after_a_way, &job);
        assert_memory_equal(&job.told, &right, sizeof right);
    }
}

static void expect_of_team(struct common_rounding mine)
{
#pragma omp parallel num_threads(TEAM)
    {
        EXPECT(omp_get_num_threads() == TEAM);
        EXPECT(is_the_same(mine, common_rounding_now()));
    }
}

static void *look_at_team(void *argument)
{
    struct job *job = argument;

    take_way(job->way);
    tell_all(&job->told);
    expect_of_team(common_rounding_now());
    return NULL;
}

/* If it failed, the parallel regions of a program would round otherwise because direct:
 * has made their threads, or had them. */
CASE(direct__gives_a_program_its_team_back)
{
    for (size_t way = 0; way < WAYS; way++) {
        static struct job job;

        job.way = way;
        in_new_thread(look_at_team, &job);
    }
}

CASES_WITH(set_up, NULL);
