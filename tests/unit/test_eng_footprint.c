/* test_eng_footprint.c - the memory that a scene takes. */
#include "eng_kit.h"
#include "eng_way.h"

#include <malloc.h>
#include <unistd.h>

#include "memory.h"
#include "step_memory.h"
#include "wide_cells.h"
#include "world.h"

#define SHEETS    5u
#define SIDE      100u
#define TRIANGLES (SHEETS * SIDE * SIDE * 2.0)
#define APART     0.01 /* one sheet from the next; a square has sides of 1 / SIDE */
#define BYTES_OF_WIDE     252.0
#define BYTES_WITH_FLOATS 460.0
#define BYTES_OF_PAPER    400.0

struct cloth {
    struct eng_scene *scene;
    uint32_t objects[SHEETS];
    uint64_t engine_before;
    double process_before;
};

static double process_bytes(void)
{
    unsigned long pages[2] = {0, 0};
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%lu %lu", &pages[0], &pages[1]), 2);
    fclose(file);
    return (double)pages[1] * (double)sysconf(_SC_PAGESIZE);
}

static void cloth_init(struct cloth *cloth)
{
    memset(cloth, 0, sizeof *cloth);
    malloc_trim(0);
    cloth->engine_before = eng_alloc_bytes();
    cloth->process_before = process_bytes();
    cloth->scene = kit_scene();
    for (uint32_t i = 0; i < SHEETS; i++) {
        cloth->objects[i] = kit_add(cloth->scene, kit_sheet(SIDE, APART * i), i);
    }
}

/* Every vertex goes up or down by less than a sheet is from the next; some meet. */
static void step(struct cloth *cloth, enum pccd_method method, enum pccd_mode mode,
                 struct prng *random)
{
    static double x1[(SIDE + 1) * (SIDE + 1)][3];
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    eng_stage_begin(cloth->scene);
    for (uint32_t i = 0; i < SHEETS; i++) {
        uint32_t count = eng_scene_vertex_count(cloth->scene, cloth->objects[i]);
        const double(*x0)[3] =
            eng_mesh_vertices(eng_scene_mesh(cloth->scene, cloth->objects[i]));
        assert_true(count <= sizeof x1 / sizeof x1[0]);
        memcpy(x1, x0, count * sizeof x1[0]);
        for (uint32_t v = 0; v < count; v++) {
            x1[v][2] += 0.55 * APART * prng_between(random, -1, 1);
        }
        assert_ok(
            eng_stage_x1(cloth->scene, cloth->objects[i], PCCD_FORMAT_F64, 0, count, x1));
    }
    settings.method = method;
    settings.mode = mode;
    struct eng_step_result result = kit_step(cloth->scene, &settings);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    assert_true(result.count > 0);
}

/* By the scene's own account, and its meshes', without what a step leaves for the next:
 * answers and scratch. */
static double resident_bytes(const struct cloth *cloth)
{
    uint64_t bytes = eng_scene_bytes(cloth->scene);
    for (uint32_t i = 0; i < SHEETS; i++) {
        bytes += eng_mesh_bytes(eng_scene_mesh(cloth->scene, cloth->objects[i]));
    }
    return (double)(bytes - eng_step_memory_bytes(cloth->scene));
}

/* The scene's account against the engine's. Returns the latter. */
static double check_account(const struct cloth *cloth)
{
    double answers = (double)eng_step_memory_bytes(cloth->scene);
    double account = resident_bytes(cloth) + answers;
    double engine = (double)(eng_alloc_bytes() - cloth->engine_before);
    assert_true(account <= engine && engine < 1.005 * account);
    return engine;
}

/* If an array came back that holds what another one does, or one grew past what it holds,
 * a scene that fits a machine today would not tomorrow. */
CASE(footprint__of_wide_is_as_promised)
{
    static const enum pccd_mode modes[] = {PCCD_MODE_ALL,   PCCD_MODE_ALL,
                                           PCCD_MODE_FIRST, PCCD_MODE_PAIRS,
                                           PCCD_MODE_ALL,   PCCD_MODE_PAIRS};
    const uint32_t first_pairs = 3;
    struct prng random = {41};
    struct cloth cloth;
    uint32_t quantised = 0;
    double bytes = 0;
    double whole = 0;
    cloth_init(&cloth);
    for (uint32_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        uint64_t allocs = eng_alloc_count();
        double before = bytes;
        step(&cloth, PCCD_METHOD_WIDE, modes[i], &random);
        quantised += eng_wide_of(cloth.scene)->has_quantised;
        bytes = resident_bytes(&cloth);
        whole = i < first_pairs ? bytes : whole;
        assert_true(whole <= BYTES_OF_WIDE * TRIANGLES);
        assert_true(bytes <= BYTES_WITH_FLOATS * TRIANGLES);
        /* Floats are made beside whole numbers where they are asked for, and stay. */
        assert_true(i == 0 || i == first_pairs || bytes == before);
        assert_true(i <= first_pairs || eng_alloc_count() == allocs);
    }
    assert_int_equal(quantised, 4); /* pairs are those of floats */
    (void)check_account(&cloth);
    print_message("# wide: %.1f bytes a triangle, with floats %.1f\n", whole / TRIANGLES,
                  bytes / TRIANGLES);
    eng_scene_free(cloth.scene);
    assert_int_equal(eng_alloc_bytes(), cloth.engine_before);
}

/* If it failed, a rank of which most of its part has gone to others would keep the memory
 * of all that it once had. */
CASE(footprint__of_wide_follows_a_scene_that_shrinks)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct prng random = {43};
    struct cloth cloth;
    cloth_init(&cloth);
    step(&cloth, PCCD_METHOD_WIDE, PCCD_MODE_ALL, &random);
    uint64_t before = eng_wide_bytes(eng_wide_of(cloth.scene));
    for (uint32_t i = 1; i < SHEETS; i++) {
        assert_ok(eng_scene_remove(cloth.scene, cloth.objects[i]));
    }
    settings.method = PCCD_METHOD_WIDE;
    eng_stage_begin(cloth.scene);
    kit_step(cloth.scene, &settings);
    assert_true(eng_wide_bytes(eng_wide_of(cloth.scene)) < before / 2);
    eng_scene_free(cloth.scene);
    assert_int_equal(eng_alloc_bytes(), cloth.engine_before);
}

/* Two sheets of a few triangles come into the scene, and one goes through the other. */
static void fall_through_another(struct eng_scene *scene)
{
    const struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    struct eng_mesh *small = kit_sheet(2, 0);
    uint32_t objects[2];
    double x1[9][3];
    for (uint32_t i = 0; i < 2; i++) {
        assert_ok(eng_scene_add(scene, small, 100 + i, &objects[i]));
    }
    for (int end = 0; end < 2; end++) { /* it begins where the last one ended */
        memcpy(x1, eng_mesh_vertices(small), sizeof x1);
        for (uint32_t v = 0; v < 9; v++) {
            x1[v][0] += 0.1;
            x1[v][2] += end == 0 ? APART : -APART;
        }
        eng_stage_begin(scene);
        assert_ok(
            eng_stage_x1(scene, objects[0], PCCD_FORMAT_F64, 0, 9, (const void *)x1));
        result = kit_step(scene, &settings);
    }
    assert_true(result.count > 0);
    eng_mesh_release(small);
}

/* If it failed, a rank whose leaves all travel while a scene is cut anew would keep what
 * a step of the old ones took beside what the new ones take to arrive. */
CASE(footprint__of_an_emptied_scene_is_given_back)
{
    struct prng random = {44};
    struct cloth cloth;
    cloth_init(&cloth);
    step(&cloth, PCCD_METHOD_WIDE, PCCD_MODE_ALL, &random);
    uint64_t wide = eng_wide_bytes(eng_wide_of(cloth.scene));
    const struct eng_step_memory *memory = eng_step_memory_of(cloth.scene);
    uint64_t records = memory->sorted.capacity_bytes;
    assert_true(eng_merge_bytes(memory->merge) > records / 8);
    for (uint32_t i = 0; i < SHEETS; i++) {
        assert_ok(eng_scene_remove(cloth.scene, cloth.objects[i]));
    }
    assert_true(eng_wide_bytes(eng_wide_of(cloth.scene)) < wide / 16);
    assert_true(eng_merge_bytes(memory->merge) < records / 16);
    assert_true(eng_pool_bytes(memory->pool) < records / 16);
    /* The records are the last answer's until there is another one. */
    assert_int_equal(memory->sorted.capacity_bytes, records);
    fall_through_another(cloth.scene);
    assert_true(memory->sorted.capacity_bytes < records / 16);
    eng_scene_free(cloth.scene);
    assert_int_equal(eng_alloc_bytes(), cloth.engine_before);
}

/* If it failed, paper would need more memory than is promised; the first step makes its
 * hierarchies. */
CASE(footprint__of_paper_is_as_promised)
{
    struct prng random = {42};
    struct cloth cloth;
    cloth_init(&cloth);
    for (uint32_t i = 0; i < 3; i++) {
        step(&cloth, PCCD_METHOD_PAPER, PCCD_MODE_ALL, &random);
    }
    assert_true(resident_bytes(&cloth) <= BYTES_OF_PAPER * TRIANGLES);
    (void)check_account(&cloth);
    print_message("# paper: %.1f bytes a triangle\n", resident_bytes(&cloth) / TRIANGLES);
    eng_scene_free(cloth.scene);
    assert_int_equal(eng_alloc_bytes(), cloth.engine_before);
}

/* If it failed, the account would leave out what a scene takes. Not all of what the
 * engine was given has been written to. */
CASE(footprint__is_what_the_process_has_grown_by)
{
    struct prng random = {45};
#ifdef PCCD_SANITIZED
    test_skip("red zones and shadows are the process's, too");
#endif
    test_skip_emulated("what the emulator takes is the process's, too");
    for (uint32_t way = 0; way < WAY_METHODS; way++) {
        struct cloth cloth;
        cloth_init(&cloth);
        for (uint32_t i = 0; i < 3; i++) {
            step(&cloth, way_methods[way], PCCD_MODE_ALL, &random);
        }
        double engine = check_account(&cloth);
        malloc_trim(0);
        double process = process_bytes() - cloth.process_before;
        assert_true(process < 1.05 * engine && process > 0.75 * engine);
        eng_scene_free(cloth.scene);
    }
}

/* If candidates were collected, a step in which everything crosses everything would need
 * memory for millions of pairs: others have run out of it there. */
CASE(footprint__does_not_follow_the_candidates)
{
    struct prng random = {8};
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    uint64_t candidates[2];
    uint64_t bytes[2];
    uint32_t object;
    settings.method = PCCD_METHOD_WIDE;
    settings.contact_max = 1000;
    struct eng_scene *scene = kit_scene();
    struct eng_mesh *mesh = kit_soup(&random, 300);
    assert_ok(eng_scene_add(scene, mesh, 1, &object));
    uint32_t count = eng_scene_vertex_count(scene, object);
    double(*x1)[3] = malloc(count * sizeof *x1);
    assert_non_null(x1);
    for (int i = 0; i < 2; i++) {
        for (uint32_t k = 0; k < 3 * count; k++) {
            x1[k / 3][k % 3] = eng_mesh_vertices(mesh)[k / 3][k % 3] +
                               (i == 0 ? 0.001 : 50) * prng_between(&random, -1, 1);
        }
        eng_stage_begin(scene);
        assert_ok(eng_stage_x1(scene, object, PCCD_FORMAT_F64, 0, count, x1));
        result = kit_step(scene, &settings);
        candidates[i] =
            result.counters.candidates[PCCD_VF] + result.counters.candidates[PCCD_EE];
        bytes[i] = eng_scene_bytes(scene);
    }
    assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
    assert_true(candidates[1] > 200000 && candidates[1] > 20 * candidates[0]);
    assert_true(bytes[1] < bytes[0] + (1u << 20));
    free(x1);
    eng_mesh_release(mesh);
    eng_scene_free(scene);
}

/* As the daemon does: what is freed goes back. */
static int set_up(void **state)
{
    (void)state;
    (void)mallopt(M_MMAP_THRESHOLD, 256 << 10);
    (void)mallopt(M_TRIM_THRESHOLD, 256 << 10);
    return 0;
}

CASES_WITH(set_up, NULL);
