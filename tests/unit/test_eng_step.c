/* test_eng_step.c - one step of a scene. */
#include "eng_kit.h"

#include <pthread.h>

#include "clock.h"
#include "memory.h"
#include "record_hash.h"
#include "trees.h"
#include "world.h"

/* Object ids; the lower one comes first, high bit or not. */
#define SHEET          0x80000001u
#define SOUP           5u
#define SHEET_SIDE     8u
#define SOUP_TRIANGLES 80u
#define SOUP_VERTICES  (3 * SOUP_TRIANGLES)

/* A sheet that stands and a soup of triangles that is shaken through it. */
struct fixture {
    struct eng_scene *scene;
    uint32_t sheet;
    uint32_t soup;
    double x0[SOUP_VERTICES][3];
    double x1[SOUP_VERTICES][3];
};

static uint32_t add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t id)
{
    uint32_t idx = UINT32_MAX;
    idx = kit_add(scene, mesh, id);
    return idx;
}

static int setup(void **state)
{
    static struct fixture f;
    struct prng random = {90};
    f.scene = kit_scene();
    f.sheet = add(f.scene, kit_sheet(SHEET_SIDE, 0.5), SHEET);
    struct eng_mesh *soup = kit_soup(&random, SOUP_TRIANGLES);
    f.soup = add(f.scene, eng_mesh_acquire(soup), SOUP);
    const double(*rest)[3] = eng_scene_object(f.scene, f.soup)->mesh->x;
    for (uint32_t i = 0; i < 3 * SOUP_VERTICES; i++) {
        f.x0[i / 3][i % 3] = rest[i / 3][i % 3];
        f.x1[i / 3][i % 3] = rest[i / 3][i % 3] + prng_between(&random, -0.25, 0.25);
    }
    eng_mesh_release(soup);
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    eng_scene_free(f->scene);
    return 0;
}

/* The same step every time, whatever was before. */
static struct eng_step_result run_with(struct fixture *f,
                                       const struct eng_question *settings)
{
    eng_stage_begin(f->scene);
    assert_ok(eng_stage_x0x1(f->scene, f->soup, PCCD_FORMAT_F64, 0, SOUP_VERTICES, f->x0,
                             f->x1));
    struct eng_step_result result = kit_step(f->scene, settings);
    return result;
}

static struct eng_step_result run(struct fixture *f, enum pccd_mode mode)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_PAPER);
    struct eng_step_result result = run_with(f, &settings);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    assert_int_equal(result.mode, mode);
    return result;
}

/* A copy of the records, for the scene's memory changes with the next step. */
static void *copy_records(const struct eng_step_result *result)
{
    return test_copy(result->records, result->count * result->record_bytes);
}

/* The literals are of version 1 of the hash, so that they outlive any other. */
static void check_golden(const struct eng_step_result *result, uint64_t count,
                         uint64_t hash_hi, uint64_t hash_lo)
{
    uint64_t hash[2] = {0};
    assert_int_equal(result->count, count);
    record_hash_1(result->records, result->count, result->record_bytes, hash);
    assert_int_equal(hash[0], hash_hi);
    assert_int_equal(hash[1], hash_lo);
    record_hash_2(result->records, result->count, result->record_bytes, hash);
    assert_int_equal(result->hash[0], hash[0]);
    assert_int_equal(result->hash[1], hash[1]);
}

/* If it failed: a compiler, an option or a change would alter answers unnoticed. (A
 * wanted change of the solver's arithmetic changes the first two.) */
CASE_WITH(step__golden_hashes_hold, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_step_result result = run(f, PCCD_MODE_ALL);
    check_golden(&result, 432, 0xd92ff9de82e2df4f, 0x520fa04f1a680fc4);
    result = run(f, PCCD_MODE_FIRST);
    check_golden(&result, 1, 0x11bd9952783f2638, 0xb2a9cd1b90c433db);
    result = run(f, PCCD_MODE_PAIRS);
    check_golden(&result, 5636, 0x76cc4e5ba9e374a2, 0xfa8d61b9a199716b);
}

/* If it failed: counts beside the records would not be those of the records. */
CASE_WITH(step__counts_describe_the_records, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_step_result result = run(f, PCCD_MODE_ALL);
    const struct pccd_contact *contacts = result.records;
    uint64_t vf = 0;
    uint64_t initial = 0;
    double first = 2;
    for (uint64_t i = 0; i < result.count; i++) {
        vf += contacts[i].kind == PCCD_VF;
        initial += (contacts[i].flags & PCCD_INITIAL) != 0;
        first = contacts[i].toi < first ? contacts[i].toi : first;
        assert_true(contacts[i].toi_hi - contacts[i].toi <= 1e-6);
        assert_int_equal(contacts[i].reserved, 0);
    }
    assert_true(vf > 10 && result.count - vf > 10);
    assert_int_equal(result.counts[PCCD_VF], vf);
    assert_int_equal(result.counts[PCCD_EE], result.count - vf);
    assert_int_equal(result.initial, initial);
    assert_int_equal(result.possible, 0);
    assert_true(result.toi_first == first);
    assert_int_equal(result.verdict, PCCD_VERDICT_NONE);
    assert_int_equal(result.record_bytes, sizeof *contacts);
    assert_true(result.counters.candidates[PCCD_VF] +
                    result.counters.candidates[PCCD_EE] >=
                result.counters.survivors);
    assert_true(result.counters.survivors >= result.count);
}

static int compare_pairs(const void *a, const void *b)
{
    const uint32_t *x = a;
    const uint32_t *y = b;
    for (int i = 0; i < 5; i++) {
        if (x[i] != y[i]) {
            return x[i] < y[i] ? -1 : 1;
        }
    }
    return 0;
}

/* If it failed: the modes would contradict each other about one step. */
CASE_WITH(step__modes_agree, setup, teardown)
{
    struct fixture *f = *state;
    for (int move = 0; move < 4; move++) {
        for (uint32_t v = 0; v < SOUP_VERTICES;
             v++) { /* start above the sheet, then higher */
            f->x0[v][2] += move > 0 ? 0.5 : 0;
            f->x1[v][2] += move > 0 ? 0.25 : 0;
        }
        struct eng_step_result all = run(f, PCCD_MODE_ALL);
        struct pccd_contact *contacts = copy_records(&all);
        struct eng_step_result pairs = run(f, PCCD_MODE_PAIRS);
        assert_int_equal(pairs.count, pairs.counters.candidates[PCCD_VF] +
                                          pairs.counters.candidates[PCCD_EE]);
        double bound = 2;
        for (uint64_t i = 0; i < all.count; i++) {
            const struct pccd_contact *c = &contacts[i];
            const struct pccd_pair name = {c->kind, c->object_a, c->feature_a,
                                           c->object_b, c->feature_b};
            assert_non_null(
                bsearch(&name, pairs.records, pairs.count, sizeof name, compare_pairs));
            bound = c->toi_hi < bound ? c->toi_hi : bound;
        }
        struct eng_step_result first = run(f, PCCD_MODE_FIRST);
        const struct pccd_contact *earliest = first.records;
        uint64_t kept = 0;
        for (uint64_t i = 0; i < all.count; i++) {
            if (contacts[i].toi <= bound) {
                assert_true(kept < first.count);
                assert_memory_equal(&earliest[kept], &contacts[i], sizeof *contacts);
                kept++;
            }
        }
        assert_int_equal(first.count, kept);
        assert_true(first.toi_first == all.toi_first);
        struct eng_step_result any = run(f, PCCD_MODE_ANY);
        assert_int_equal(any.verdict, all.count > 0 ? PCCD_VERDICT_YES : PCCD_VERDICT_NO);
        assert_int_equal(any.count, 0);
        free(contacts);
    }
}

#define RAIN 200u

/* Small triangles at random heights over the square, each alone in its column; they land
 * in another order than that of their numbers. */
static void make_rain(struct prng *random, double (*x)[3], uint32_t (*triangles)[3])
{
    for (uint32_t t = 0; t < RAIN; t++) {
        double height = prng_between(random, 0.5, 2);
        for (uint32_t k = 0; k < 3; k++) {
            double *corner = x[3 * t + k];
            corner[0] = (t % 20 + (k == 1 ? 0.7 : 0.2)) / 20;
            corner[1] = (double)(t / 20 + (k == 2 ? 0.7 : 0.2)) / 10;
            corner[2] = height + 0.01 * k;
            triangles[t][k] = 3 * t + k;
        }
    }
}

/* If it failed: what culls later contacts would cull the earliest, or not all that share
 * its time. */
CASE(step__first_is_found_whatever_is_found_before)
{
    struct prng random = {93};
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    const double here[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const double below[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -4};
    for (int round = 0; round < 8; round++) {
        double x[3 * RAIN][3];
        uint32_t triangles[RAIN][3];
        double lowest = 2;
        make_rain(&random, x, triangles);
        for (uint32_t v = 0; v < 3 * RAIN; v++) {
            lowest = x[v][2] < lowest ? x[v][2] : lowest;
        }
        struct eng_scene *scene = kit_scene();
        add(scene, kit_sheet(1 + (uint32_t)round % 3, 0), 1);
        add(scene, kit_mesh(x, 3 * RAIN, triangles, RAIN), 2);
        settings.mode = PCCD_MODE_FIRST;
        settings.method = round % 2 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER;
        eng_stage_begin(scene);
        assert_ok(eng_stage_rigid(scene, 1, 0, 3 * RAIN, here, below));
        result = kit_step(scene, &settings);
        assert_true(settings.method == PCCD_METHOD_WIDE || /* it finds the first sooner */
                    result.counters.candidates[PCCD_VF] +
                            result.counters.candidates[PCCD_EE] >
                        1024);
        assert_true(result.count > 0);
        assert_true(result.toi_first <= lowest / 4 &&
                    result.toi_first > lowest / 4 - 1e-6);
        /* Back on the sheet, all at rest: every contact is the first. */
        add(scene, kit_sheet(2, 0), 3);
        result = kit_step(scene, &settings);
        uint64_t first_count = result.count;
        settings.mode = PCCD_MODE_ALL;
        result = kit_step(scene, &settings);
        assert_true(result.initial > 0);
        assert_int_equal(first_count, result.initial);
        eng_scene_free(scene);
    }
}

/* If it failed: a finer tolerance would find other contacts. */
CASE_WITH(step__tolerance_narrows_brackets_only, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result coarse = run(f, PCCD_MODE_ALL);
    struct pccd_contact *contacts = copy_records(&coarse);
    settings.tolerance = 1e-12;
    struct eng_step_result fine = run_with(f, &settings);
    const struct pccd_contact *narrow = fine.records;
    assert_int_equal(fine.count, coarse.count);
    for (uint64_t i = 0; i < fine.count; i++) {
        assert_memory_equal(&narrow[i], &contacts[i], offsetof(struct pccd_contact, toi));
        assert_true(narrow[i].toi_hi - narrow[i].toi <= 1e-12);
        assert_true(narrow[i].toi <= contacts[i].toi_hi);
        assert_true(narrow[i].toi_hi >= contacts[i].toi);
    }
    free(contacts);
}

/* Every record of an incomplete answer is one of the complete answer. */
static void check_subset(const struct eng_step_result *part,
                         const struct pccd_contact *contacts, uint64_t count)
{
    const struct pccd_contact *records = part->records;
    uint64_t at = 0;
    for (uint64_t i = 0; i < part->count; i++) {
        while (at < count && memcmp(&records[i], &contacts[at], sizeof *contacts) != 0) {
            at++;
        }
        assert_true(at < count);
        at++;
    }
}

/* If it failed: a step that ran out of time, was called off or was cut would pass for
 * whole, or the next step would start from the wrong place. */
CASE_WITH(step__early_ends_say_why, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_step_result all = run(f, PCCD_MODE_ALL);
    struct pccd_contact *contacts = copy_records(&all);
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    atomic_bool cancel = false;
    settings.deadline_ns = 1;
    struct eng_step_result part = run_with(f, &settings);
    assert_int_equal(part.incomplete, PCCD_INCOMPLETE_DEADLINE);
    check_subset(&part, contacts, all.count);
    const double(*now)[3] = (const double(*)[3])f->scene->x[f->scene->now];
    assert_memory_equal(now + f->scene->objects[f->soup].vertices.first, f->x1,
                        sizeof f->x1);

    settings.deadline_ns = common_now_ns() + 3600u * (uint64_t)1000000000;
    settings.cancel = &cancel;
    part = run_with(f, &settings);
    assert_int_equal(part.incomplete, PCCD_COMPLETE);
    assert_int_equal(part.hash[1], all.hash[1]);
    atomic_store(&cancel, true);
    part = run_with(f, &settings);
    assert_int_equal(part.incomplete, PCCD_INCOMPLETE_CANCELLED);
    check_subset(&part, contacts, all.count);
    atomic_store(&cancel, false);

    const uint64_t limits[] = {0, 1, 7, all.count - 1, all.count};
    for (int i = 0; i < 5; i++) {
        settings.contact_max = limits[i];
        part = run_with(f, &settings);
        assert_int_equal(part.count, limits[i]);
        assert_int_equal(part.incomplete, limits[i] < all.count
                                              ? PCCD_INCOMPLETE_CONTACT_LIMIT
                                              : PCCD_COMPLETE);
        check_subset(&part, contacts, all.count);
    }
    free(contacts);
}

/* Take it back, without an answer. */
static void move_back(struct fixture *f, const struct eng_question *settings)
{
    struct eng_step_result result;
    uint64_t builds = f->scene->builds;
    eng_stage_begin(f->scene);
    assert_ok(eng_stage_x0x1(f->scene, f->soup, PCCD_FORMAT_F64, 0, SOUP_VERTICES, f->x0,
                             f->x1));
    uint64_t allocs = atomic_load(&eng_payer()->allocs);
    assert_ok(eng_move(f->scene, settings, &result));
    if (settings->method == PCCD_METHOD_WIDE) {
        assert_int_equal(atomic_load(&eng_payer()->allocs), allocs);
        assert_int_equal(f->scene->builds, builds);
    }
    assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CANCELLED);
    assert_int_equal(result.count, 0);
}

/* Take the soup far away and back, by a step that makes boxes, and one that is called off
 * before it makes any, or by eng_move; then ask what is near. */
static struct eng_step_result
near_after_cancel(struct fixture *f, const struct eng_question *settings, bool moves)
{
    const atomic_bool cancel = true;
    struct eng_question called_off = *settings, near = *settings;
    double far[SOUP_VERTICES][3];
    for (uint32_t i = 0; i < 3 * SOUP_VERTICES; i++) {
        far[i / 3][i % 3] = f->x1[i / 3][i % 3] + 100;
    }
    eng_stage_begin(f->scene);
    assert_ok(
        eng_stage_x0x1(f->scene, f->soup, PCCD_FORMAT_F64, 0, SOUP_VERTICES, far, far));
    assert_int_equal(kit_step(f->scene, settings).incomplete, PCCD_COMPLETE);
    called_off.cancel = &cancel;
    if (moves) {
        move_back(f, &called_off);
    } else {
        assert_int_equal(run_with(f, &called_off).incomplete, PCCD_INCOMPLETE_CANCELLED);
    }
    near.verb = PCCD_NEAR_PAIRS;
    near.distance = 0.05;
    return kit_near(f->scene, &near);
}

/* If it failed: what is asked behind a step that was called off would be looked for in
 * boxes of an older one, and missed. */
CASE_WITH(step__called_off_leaves_no_boxes_to_go_by, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_step_result all = run(f, PCCD_MODE_ALL);
    const uint64_t hash = all.hash[1];
    struct eng_question near = ENG_QUESTION_DEFAULT;
    near.verb = PCCD_NEAR_PAIRS;
    near.distance = 0.05;
    const uint64_t near_hash = kit_near(f->scene, &near).hash[1];
    for (int way = 0; way < 8; way++) {
        struct eng_question settings = kit_contacts(
            PCCD_MODE_ALL, way % 2 == 0 ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE);
        settings.threads = way % 4 < 2 ? 1 : 3;
        settings.team_always = true;
        struct eng_step_result found = near_after_cancel(f, &settings, way >= 4);
        assert_true(found.count > 0);
        assert_int_equal(found.hash[1], near_hash);
        assert_int_equal(run_with(f, &settings).hash[1], hash);
    }
}

/* If it failed: the first step of each scene of a batch that is over would build its
 * trees before the next request of the client has its turn: milliseconds each. */
CASE_WITH(step__called_off_at_first_makes_nothing, setup, teardown)
{
    struct fixture *f = *state;
    const atomic_bool cancel = true;
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_WIDE);
    settings.cancel = &cancel;
    move_back(f, &settings);
    settings.cancel = NULL;
    struct eng_step_result result = run_with(f, &settings);
    check_golden(&result, 432, 0xd92ff9de82e2df4f, 0x520fa04f1a680fc4);
}

#define SPIKES 3500u
#define KEPT   20u

/* Spikes over a floor, in a row; those in the middle are nearer. */
static struct eng_scene *make_spikes(void)
{
    static const double floor[4][3] = {
        {-9, -9, 0}, {3 * SPIKES, -9, 0}, {3 * SPIKES, 9, 0}, {-9, 9, 0}};
    static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static double x[3 * SPIKES][3];
    static uint32_t corners[SPIKES][3];
    for (uint32_t i = 0; i < SPIKES; i++) {
        double height = i / 500 == 3 ? 0.5 : 0.75;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t v = 3 * i + k;
            x[v][0] = 3.0 * i + (k == 1);
            x[v][1] = 0.25 + (k == 2);
            x[v][2] = height + (k > 0 ? 5 : 0);
            corners[i][k] = v;
        }
    }
    struct eng_mesh *meshes[2] = {kit_mesh(floor, 4, halves, 2),
                                  kit_mesh(x, 3 * SPIKES, corners, SPIKES)};
    struct eng_scene *scene = kit_scene();
    for (uint32_t i = 0; i < 2; i++) {
        kit_add(scene, meshes[i], i + 1);
    }
    return scene;
}

/* All spikes fall by 1. */
static struct eng_step_result fall(struct eng_scene *scene,
                                   const struct eng_question *settings)
{
    static const double pose[2][12] = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                       {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1}};
    eng_stage_begin(scene);
    assert_ok(eng_stage_rigid(scene, 1, 0, 3 * SPIKES, pose[0], pose[1]));
    struct eng_step_result result = kit_step(scene, settings);
    return result;
}

/* If it failed: of many contacts that are found early in the search and meet late so few
 * would be kept that none is left when others are found to be earlier. */
CASE(step__keeps_the_first_of_the_earliest)
{
    struct eng_scene *scene = make_spikes();
    struct pccd_contact first[KEPT];
    for (uint32_t round = 0; round < 3 * 2; round++) {
        struct eng_question settings = kit_contacts(
            PCCD_MODE_FIRST, round % 2 == 0 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER);
        settings.threads = 1 + round / 2;
        settings.team_always = true;
        struct eng_step_result result = fall(scene, &settings);
        assert_true(result.incomplete == PCCD_COMPLETE && result.count >= 500);
        double toi = result.toi_first;
        memcpy(first, result.records, sizeof first);
        settings.contact_max = KEPT;
        result = fall(scene, &settings);
        assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_int_equal(result.count, KEPT);
        assert_memory_equal(result.records, first, sizeof first);
        assert_true(result.toi_first >= toi); /* that of the records */
    }
    eng_scene_free(scene);
}

struct asked {
    pthread_t thread; /* that called */
    bool was_other;
    uint32_t times, stop_at;
};

static bool count_questions(void *context)
{
    struct asked *asked = context;
    asked->was_other |= pthread_equal(asked->thread, pthread_self()) == 0;
    return ++asked->times >= asked->stop_at;
}

/* If it failed: libpccd-mpi would call MPI from a thread that must not, or a step would
 * not end for what another rank has found. */
CASE_WITH(step__only_the_caller_is_asked_and_can_stop, setup, teardown)
{
    struct fixture *f = *state;
    const uint64_t total = run(f, PCCD_MODE_ALL).count;
    for (uint32_t threads = 1; threads <= 4; threads += 3) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        struct asked asked = {.thread = pthread_self(), .stop_at = UINT32_MAX};
        settings.threads = threads;
        settings.team_always = true;
        settings.is_stopped = count_questions;
        settings.asked = &asked;
        struct eng_step_result result = run_with(f, &settings);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        assert_true(asked.times > 0 && !asked.was_other);
        asked.stop_at = asked.times = 0;
        result = run_with(f, &settings);
        assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CANCELLED);
        /* The other threads may have been done. */
        assert_true(result.count < total || threads > 1);
        assert_false(asked.was_other);
    }
}

/* Triangles with coordinates of every magnitude, for which each pair takes long; the same
 * each time. */
static struct eng_scene *hostile_scene(void)
{
    struct prng random = {91};
    double x[2][120][3];
    uint32_t triangles[40][3];
    struct eng_scene *scene = kit_scene();
    for (uint32_t i = 0; i < 720; i++) {
        double scale = prng_u32(&random, 2) ? 0x1p-1070 : 0x1p57;
        x[i / 360][i % 360 / 3][i % 3] = prng_integer(&random, 3) * scale;
        triangles[i % 120 / 3][i % 3] = i % 120;
    }
    add(scene, kit_mesh(x[0], 120, triangles, 40), 1);
    eng_stage_begin(scene);
    assert_ok(eng_stage_x1(scene, 0, PCCD_FORMAT_F64, 0, 120, x[1]));
    return scene;
}

/* Is asked wherever a step looks whether it is to end, and cancels it at a question,
 * however fast it runs. */
struct canceller {
    atomic_bool cancel;
    uint32_t questions, cancel_at; /* 0: at none */
};

static bool cancel_at_question(void *context)
{
    struct canceller *canceller = context;
    canceller->questions++;
    if (canceller->questions == canceller->cancel_at) {
        atomic_store(&canceller->cancel, true);
    }
    return false;
}

/* Return the processor time of this thread: what others do on the machine does not
 * count. */
static uint64_t processor_ns(void)
{
    struct timespec now;
    assert_int_equal(clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now), 0);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* A step of the hostile scene, how often it looked, and what it took of a processor. */
static enum pccd_incomplete step_hostile(uint64_t budget_ns, uint32_t cancel_at,
                                         uint32_t *questions, uint64_t *took_ns)
{
    struct eng_scene *scene = hostile_scene();
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct canceller canceller = {.cancel_at = cancel_at};
    settings.cancel = &canceller.cancel;
    settings.is_stopped = cancel_at_question;
    settings.asked = &canceller;
    uint64_t begin_ns = processor_ns();
    settings.deadline_ns = budget_ns == 0 ? 0 : common_now_ns() + budget_ns;
    struct eng_step_result result = kit_step(scene, &settings);
    *took_ns = processor_ns() - begin_ns;
    *questions = canceller.questions;
    eng_scene_free(scene);
    return result.incomplete;
}

/* If it failed: one client's odd numbers would hold up every other client for seconds.
 * Counted in looks at the clock: a busy machine is late for reasons of its own. */
CASE(step__deadline_is_seen_between_slow_tests)
{
    uint32_t whole, part;
    uint64_t whole_ns, took_ns;
    assert_int_equal(step_hostile(0, 0, &whole, &whole_ns), PCCD_COMPLETE);
    assert_true(whole > 100); /* some 10 us between two looks */
    assert_int_equal(step_hostile(0, whole / 2, &part, &took_ns),
                     PCCD_INCOMPLETE_CANCELLED);
    assert_int_equal(part, whole / 2); /* at once */
    assert_int_equal(step_hostile(whole_ns / 4, 0, &part, &took_ns),
                     PCCD_INCOMPLETE_DEADLINE);
    assert_true(part < whole);
}

/* If it failed: a scene without objects, or with nothing that can meet, would trip. */
CASE(step__empty_scene_and_single_object_have_no_contacts)
{
    struct eng_scene *scene = kit_scene();
    for (int objects = 0; objects < 2; objects++) {
        for (int mode = PCCD_MODE_ALL; mode < PCCD_MODE_COUNT; mode++) {
            struct eng_question settings =
                kit_contacts((enum pccd_mode)mode, PCCD_METHOD_DEFAULT);
            struct eng_step_result result = kit_step(scene, &settings);
            assert_int_equal(result.incomplete, PCCD_COMPLETE);
            assert_true(mode == PCCD_MODE_PAIRS || result.count == 0);
            assert_true(result.toi_first == 2);
            assert_int_equal(result.verdict,
                             mode == PCCD_MODE_ANY ? PCCD_VERDICT_NO : PCCD_VERDICT_NONE);
        }
        if (objects == 0) {
            add(scene, kit_sheet(5, 0), 1); /* flat: neighbours share vertices only */
        }
    }
    eng_scene_free(scene);
}

/* If it failed: cloth would pass through itself. */
CASE(step__one_object_meets_itself)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    const double corner[1][3] = {{0.6, 0.55, 0.5}};
    const double below[1][3] = {{0.6, 0.55, -0.5}};
    struct eng_scene *scene = kit_scene();
    add(scene, kit_sheet(4, 0), 9);
    eng_stage_begin(scene); /* vertex 0 is lifted over the sheet ... */
    assert_ok(eng_stage_x0x1(scene, 0, PCCD_FORMAT_F64, 0, 1, corner, corner));
    struct eng_step_result result = kit_step(scene, &settings);
    assert_int_equal(result.counts[PCCD_VF], 0);
    eng_stage_begin(scene); /* ... and pushed through it */
    assert_ok(eng_stage_x1(scene, 0, PCCD_FORMAT_F64, 0, 1, below));
    result = kit_step(scene, &settings);
    const struct pccd_contact *contact = result.records;
    assert_true(result.counts[PCCD_VF] > 0 && result.counts[PCCD_EE] > 0);
    assert_true(contact->kind == PCCD_VF && contact->object_a == 9 &&
                contact->object_b == 9);
    assert_int_equal(contact->feature_a, 0);      /* the corner is the first vertex */
    for (uint64_t i = 0; i < result.count; i++) { /* all when its triangle lies flat */
        assert_true(contact[i].toi <= 0.5 && contact[i].toi_hi >= 0.5);
    }
    eng_scene_free(scene);
}

/* A range of nodes. The caller frees it. */
static struct eng_node *copy_nodes(const struct eng_scene *scene, struct eng_range range)
{
    struct eng_node *nodes =
        test_copy(eng_trees_of(scene)->nodes + range.first, range.count * sizeof *nodes);
    return nodes;
}

static void check_nodes(const struct eng_scene *scene, struct eng_range range,
                        const struct eng_node *before)
{
    assert_memory_equal(eng_trees_of(scene)->nodes + range.first, before,
                        range.count * sizeof *before);
}

/* If it failed: adding or removing an object would cost or change the others. */
CASE_WITH(step__objects_come_and_go_without_touching_others, setup, teardown)
{
    struct fixture *f = *state;
    struct prng random = {92};
    struct eng_step_result before = run(f, PCCD_MODE_ALL);
    struct eng_range range = eng_paper_object_of(&f->scene->objects[f->soup])->nodes;
    struct eng_node *nodes = copy_nodes(f->scene, range);
    uint32_t others[6];
    for (uint32_t i = 0; i < 6; i++) {
        others[i] = add(f->scene, kit_soup(&random, 50), 100 + i);
        struct eng_step_result with = run(f, PCCD_MODE_ALL);
        assert_true(with.count > before.count);
        assert_int_equal(eng_paper_object_of(&f->scene->objects[f->soup])->nodes.first,
                         range.first);
        check_nodes(f->scene, range, nodes);
        assert_true(eng_tree_validate(f->scene));
    }
    for (uint32_t i = 0; i < 6; i++) {
        assert_ok(eng_scene_remove(f->scene, others[(i * 5) % 6]));
        assert_int_equal(eng_scene_remove(f->scene, others[(i * 5) % 6]), PCCD_E_INVAL);
        run(f, PCCD_MODE_ALL);
        check_nodes(f->scene, range, nodes);
        assert_true(eng_tree_validate(f->scene));
    }
    struct eng_step_result after = run(f, PCCD_MODE_ALL);
    assert_int_equal(after.hash[0], before.hash[0]);
    assert_int_equal(after.hash[1], before.hash[1]);
    free(nodes);
}

/* If it failed: an id could name two objects, or a wrong index remove one. */
CASE_WITH(step__ids_are_unique_and_come_free_again, setup, teardown)
{
    struct fixture *f = *state;
    uint32_t idx = 77;
    struct eng_mesh *mesh = kit_sheet(1, 0);
    struct eng_mesh *raw = NULL;
    assert_int_equal(eng_scene_add(f->scene, mesh, SOUP, &idx), PCCD_E_INVAL);
    assert_ok(eng_mesh_new(3, 1, &raw));
    assert_int_equal(eng_scene_add(f->scene, raw, 1, &idx), PCCD_E_STATE);
    assert_int_equal(idx, 77);
    assert_int_equal(eng_scene_remove(f->scene, 77), PCCD_E_INVAL);
    assert_int_equal(eng_scene_remove(f->scene, UINT32_MAX), PCCD_E_INVAL);
    assert_int_equal(eng_scene_object_count(f->scene), 2);
    assert_ok(eng_scene_remove(f->scene, f->soup));
    assert_int_equal(eng_scene_vertex_count(f->scene, f->soup), 0);
    assert_ok(eng_scene_add(f->scene, mesh, SOUP, &idx));
    assert_int_equal(idx, f->soup);
    assert_int_equal(eng_scene_vertex_count(f->scene, idx), 4);
    eng_mesh_release(mesh);
    eng_mesh_release(raw);
}

/* If it failed: the order of records would depend on the order of arrival. */
CASE(step__object_ids_decide_the_order)
{
    static const uint32_t ids[2][2] = {{1, 0x90000000u}, {0x90000000u, 1}};
    for (int order = 0; order < 2; order++) {
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        struct eng_scene *scene = kit_scene();
        add(scene, kit_sheet(2, 0), ids[order][0]);
        add(scene, kit_sheet(3, 0), ids[order][1]); /* in the same plane: touching */
        struct eng_step_result result = kit_step(scene, &settings);
        const struct pccd_contact *contacts = result.records;
        assert_true(result.counts[PCCD_EE] > 20 && result.counts[PCCD_VF] > 20);
        assert_int_equal(result.initial, result.count);
        for (uint64_t i = 0; i < result.count; i++) {
            assert_int_not_equal(contacts[i].object_a, contacts[i].object_b);
            if (contacts[i].kind == PCCD_EE) {
                assert_int_equal(contacts[i].object_a, 1);
            } else if (i > 0) {
                assert_true(contacts[i - 1].object_a <= contacts[i].object_a);
            }
        }
        eng_scene_free(scene);
    }
}

/* If it failed: instances of one mesh would share positions, or need their own copies. */
CASE(step__two_instances_of_one_mesh_are_two_objects)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    const double up[12] = {1, 0, 0, 0.25, 0, 1, 0, 0.125, 0, 0, 1, 1};
    const double down[12] = {1, 0, 0, 0.25, 0, 1, 0, 0.125, 0, 0, 1, -1};
    struct eng_mesh *mesh = kit_sheet(2, 0);
    struct eng_scene *scene = kit_scene();
    uint32_t a = add(scene, eng_mesh_acquire(mesh), 1);
    uint32_t b = add(scene, mesh, 2); /* nobody but the scene holds the mesh now */
    eng_stage_begin(scene);
    assert_ok(eng_stage_rigid(scene, b, 0, 9, up, down));
    struct eng_step_result result = kit_step(scene, &settings);
    assert_true(result.counts[PCCD_VF] > 0 && result.counts[PCCD_EE] > 0);
    assert_true(result.toi_first <= 0.5 && result.toi_first >= 0.5 - 1e-6);
    assert_ok(eng_scene_remove(scene, a));
    result = kit_step(scene, &settings);
    assert_int_equal(result.count, 0);
    eng_scene_free(scene);
}

/* [team] */
static void count_weighed(void *weigher, const struct pccd_pair *pairs, uint32_t count)
{
    uint64_t *counts = weigher;
    for (uint32_t i = 0; i < count; i++) {
        counts[pairs[i].kind]++;
    }
}

/* If it failed: who weighs would not know what it takes to tell how a step begins. */
CASE_WITH(step__who_weighs_is_told_of_each_pair_that_the_lanes_leave, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    uint64_t counts[PCCD_KINDS_MAX] = {0};
    settings.method = PCCD_METHOD_WIDE;
    settings.tells_start = true;
    settings.weigh = count_weighed;
    settings.weigher = counts;
    struct eng_step_result result = run_with(f, &settings);
    assert_true(result.crossings > 0);
    assert_int_equal(counts[PCCD_EF], result.crossings);
    assert_int_equal(counts[PCCD_VF] + counts[PCCD_EE] + counts[PCCD_EF],
                     result.counters.survivors);
}
