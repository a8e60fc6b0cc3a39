/* test_eng_rebuild.c - selective, lazy reconstruction.
 *
 * Source: daemon/engine/paper/rebuild.h; paper section 6.2.
 */
#include "eng_blast.h"

#include <time.h>

#include "rebuild.h"
#include "trees.h"

#define STEPS 8u
#define DT    0.02

static struct blast blast;

static void start(double ratio, uint32_t region_triangles)
{
    blast_init(&blast, &(struct eng_scene_settings){ratio, region_triangles, 1});
}

static struct eng_question team_of(uint32_t threads, enum eng_scheduler scheduler)
{
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_PAPER);
    settings.threads = threads;
    settings.team_always = true;
    settings.tuning.scheduler = scheduler;
    return settings;
}

static struct eng_step_result run_step(uint32_t step, struct eng_question settings)
{
    return blast_run(&blast, step * DT, (step + 1) * DT, settings);
}

static struct eng_step_result run_alone(uint32_t step)
{
    return run_step(step, team_of(1, ENG_SCHEDULER_STEAL));
}

/* Nothing but boxes: the same step again and again. */
static struct eng_step_result stand_still(double t)
{
    return blast_run(&blast, t, t, team_of(1, ENG_SCHEDULER_STEAL));
}

/* Box tests of each step without reconstruction, with hierarchies built for it, and with
 * the default. */
static void count_box_tests(uint64_t never[STEPS], uint64_t every[STEPS],
                            uint64_t lazy[STEPS])
{
    for (int way = 0; way < 3; way++) {
        start(way == 2 ? 0.9 : 0, BLAST_TRIANGLES);
        for (uint32_t step = 0; step < STEPS; step++) {
            if (way == 1) {
                blast_rebuild(&blast);
            }
            struct eng_step_result result = run_alone(step);
            uint64_t *counts = way == 0 ? never : way == 1 ? every : lazy;
            counts[step] = result.counters.box_tests;
            assert_true(way == 2 || result.counters.rebuilds == 0);
        }
        blast_deinit(&blast);
    }
}

/* If it failed: refit alone would carry a hierarchy along that does not cull any more. */
CASE(rebuild__poor_nodes_are_built_anew)
{
    uint64_t never[STEPS];
    uint64_t every[STEPS];
    uint64_t lazy[STEPS];
    count_box_tests(never, every, lazy);
    for (uint32_t step = STEPS / 2; step < STEPS; step++) {
        assert_true(never[step] > 3 * every[step]);
        assert_true((double)lazy[step] < 1.3 * (double)every[step]);
    }
}

/* If it failed: the next step would begin with what this one has found to be poor. */
CASE(rebuild__next_step_refits_what_this_one_left)
{
    start(0.9, BLAST_TRIANGLES);
    stand_still(0.3);
    uint32_t root = eng_trees_of(blast.scene)->root;
    size_t bytes = eng_paper_object_of(&blast.scene->objects[blast.idx])->nodes.count *
                   sizeof(struct eng_node);
    struct eng_node *nodes = test_copy(eng_trees_of(blast.scene)->nodes + root, bytes);
    struct eng_step_result again = stand_still(0.3);
    assert_int_equal(again.counters.rebuilds, 0);
    assert_memory_equal(eng_trees_of(blast.scene)->nodes + root, nodes, bytes);
    free(nodes);
    blast_deinit(&blast);
}

/* If it failed: time would go into building what is good already. */
CASE(rebuild__good_nodes_are_left_alone)
{
    static double x[BLAST_VERTICES][3];
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_PAPER);
    struct eng_step_result result;
    start(0.9, 300);
    for (uint32_t step = 1; step < STEPS; step++) {
        for (uint32_t v = 0; v < BLAST_VERTICES; v++) {
            for (int k = 0; k < 3; k++) {
                x[v][k] = blast.rest[v][k] + (double)step * (k + 1);
            }
        }
        eng_stage_begin(blast.scene);
        int status =
            eng_stage_x1(blast.scene, blast.idx, PCCD_FORMAT_F64, 0, BLAST_VERTICES, x);
        assert_ok(status);
        result = kit_step(blast.scene, &settings);
        assert_int_equal(result.counters.rebuilds, 0);
        assert_int_equal(result.counters.swaps, 0);
    }
    blast_deinit(&blast);
}

/* If it failed: what overlaps by nature would be rebuilt in every step, for nothing. */
CASE(rebuild__nodes_that_stay_poor_are_built_once)
{
    struct prng random = {62};
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_PAPER);
    uint32_t idx;
    uint32_t poor = 0;
    struct eng_scene *scene = kit_scene();
    idx = kit_add(scene, kit_soup(&random, 600), 0);
    for (uint32_t step = 0; step < STEPS; step++) {
        eng_stage_begin(scene);
        struct eng_step_result result = kit_step(scene, &settings);
        assert_int_equal(result.counters.rebuilds, 0);
    }
    for (uint32_t i = 0; i < eng_paper_object_of(&scene->objects[idx])->nodes.count;
         i++) {
        const struct eng_node *node = &eng_trees_of(scene)->nodes[i];
        poor += node->count >= ENG_EXAMINE_MIN &&
                eng_metric(eng_trees_of(scene)->nodes, node) < 0.9f;
    }
    assert_true(poor > 10);
    eng_scene_free(scene);
}

/* If it failed: settings that say "never" would not be obeyed, or a threshold would be
 * none. */
CASE(rebuild__threshold_decides)
{
    const double ratios[] = {0, 0.3, 0.7, 0.9, 1};
    uint64_t before = 0;
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios; i++) {
        start(ratios[i], BLAST_TRIANGLES);
        uint64_t triangles = 0;
        for (uint32_t step = 0; step < 4; step++) {
            triangles += run_alone(step).counters.rebuilt_triangles;
        }
        /* A node holds its children, so the ratio is never below a half. */
        assert_true(ratios[i] >= 0.5 ? triangles > before : triangles == 0);
        before = triangles;
        blast_deinit(&blast);
    }
}

/* Regions that a step touched and did not, in *touched; those it did not must be as they
 * were before, those it did without a poor node. */
static void check_regions(const struct eng_node *before, uint32_t touched[2])
{
    const struct eng_scene *scene = blast.scene;
    struct eng_range nodes = eng_paper_object_of(&scene->objects[blast.idx])->nodes;
    touched[0] = touched[1] = 0;
    for (uint32_t i = nodes.first; i < nodes.first + nodes.count; i++) {
        if (eng_trees_of(scene)->nodes[i].gate != ENG_GATE_REGION) {
            continue;
        }
        bool is_touched =
            atomic_load(&eng_trees_of(scene)->upkeep[i].gate) == eng_gate_ready(scene);
        touched[is_touched]++;
        for (uint32_t k = i; k < i + 2 * eng_trees_of(scene)->nodes[i].count - 1; k++) {
            const struct eng_node *node = &eng_trees_of(scene)->nodes[k];
            const struct eng_node *old = &before[k - nodes.first];
            if (!is_touched) {
                assert_int_equal(node->left, old->left);
                assert_int_equal(node->right, old->right);
            } else if (node->count >= ENG_EXAMINE_MIN) {
                assert_false(
                    eng_metric_is_poor(eng_metric(eng_trees_of(scene)->nodes, node),
                                       eng_trees_of(scene)->upkeep[k].built_ratio, 0.9f));
            }
        }
    }
}

/* If it failed: a step that ends early would pay for rebuilding everything, or one that
 * does not would traverse poor nodes. */
CASE(rebuild__touched_regions_are_made_good_and_no_others)
{
    static struct eng_node before[2 * BLAST_TRIANGLES];
    atomic_bool cancel;
    for (int way = 0; way < 8; way++) {
        struct eng_question settings =
            team_of(1u << way / 2, way & 1 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL);
        start(0.9, 40);
        assert_ok(eng_paper_add_objects(blast.scene));
        struct eng_range nodes =
            eng_paper_object_of(&blast.scene->objects[blast.idx])->nodes;
        uint64_t rebuilds = 0;
        for (int part = 1; part >= 0; part--) {
            uint32_t touched[2];
            atomic_init(&cancel, part == 1);
            settings.cancel = &cancel;
            memcpy(before, eng_trees_of(blast.scene)->nodes + nodes.first,
                   nodes.count * sizeof *before);
            struct eng_step_result result = run_step(STEPS, settings);
            check_regions(before, touched);
            /* One thread alone looks at the flag when there is something to test. */
            assert_true(part == 1 ? way < 2 || touched[0] > 10 : touched[0] == 0);
            /* What was made in the background meanwhile leaves less, or nothing, to the
             * traversal. */
            rebuilds += result.counters.rebuilds + result.counters.swaps;
        }
        assert_true(rebuilds > 0);
        blast_deinit(&blast);
    }
}

struct answer {
    uint64_t hash[2];
    uint64_t count;
};

static struct answer answer_of(const struct eng_step_result *result)
{
    return (struct answer){{result->hash[0], result->hash[1]}, result->count};
}

/* If it failed: a contact would depend on how hierarchies came to be. */
CASE(rebuild__answers_are_those_of_fresh_trees)
{
    struct answer expected[STEPS];
    start(0, 1024);
    for (uint32_t step = 0; step < STEPS; step++) {
        struct eng_step_result result = run_alone(step);
        expected[step] = answer_of(&result);
        assert_true(result.count > 100);
    }
    blast_deinit(&blast);
    for (int way = 0; way < 8; way++) {
        enum eng_scheduler scheduler =
            way & 1 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL;
        uint64_t rebuilds = 0;
        start(0.9, 60);
        for (uint32_t step = 0; step < STEPS; step++) {
            struct eng_step_result result =
                run_step(step, team_of(1u << way / 2, scheduler));
            struct answer answer = answer_of(&result);
            assert_memory_equal(&answer, &expected[step], sizeof answer);
            rebuilds += result.counters.rebuilds;
        }
        assert_true(rebuilds > 0);
        blast_deinit(&blast);
    }
}

/* If it failed: trees, and with them times, would differ from run to run. */
CASE(rebuild__same_trees_by_any_number_of_threads)
{
    struct pccd_step_counters expected[STEPS];
    for (int way = 0; way < 8; way++) {
        start(0.9, 200);
        /* High nodes are built in the background, and when depends on the clock. */
        for (uint32_t step = 0; step < 1; step++) {
            struct eng_step_result result =
                run_step(STEPS, team_of(1u << way / 2, way & 1 ? ENG_SCHEDULER_PAPER
                                                               : ENG_SCHEDULER_STEAL));
            if (way == 0) {
                expected[step] = result.counters;
            }
            assert_int_equal(result.counters.rebuilds, expected[step].rebuilds);
            assert_int_equal(result.counters.rebuilt_triangles,
                             expected[step].rebuilt_triangles);
            assert_int_equal(result.counters.box_tests, expected[step].box_tests);
        }
        blast_deinit(&blast);
    }
}

/* If it failed: a client that cancels would leave a scene behind that hangs or errs. */
CASE(rebuild__steps_cut_short_leave_good_trees)
{
    struct answer expected[STEPS];
    start(0, 1024);
    for (uint32_t step = 0; step < STEPS; step++) {
        struct eng_step_result result = run_alone(step);
        expected[step] = answer_of(&result);
    }
    blast_deinit(&blast);
    start(0.9, 100);
    for (uint32_t step = 0; step < STEPS; step++) {
        for (int i = 0; i < 8; i++) {
            struct eng_question settings =
                team_of(1u << i / 2, i & 1 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL);
            settings.mode = i % 3 ? PCCD_MODE_ALL : PCCD_MODE_ANY;
            struct timespec now;
            clock_gettime(CLOCK_MONOTONIC, &now);
            settings.deadline_ns = (uint64_t)now.tv_sec * 1000000000u +
                                   (uint64_t)now.tv_nsec + 300000u * (unsigned)i;
            run_step(step, settings); /* looks at the tree */
        }
        struct eng_step_result result = run_step(step, team_of(4, ENG_SCHEDULER_STEAL));
        struct answer answer = answer_of(&result);
        assert_memory_equal(&answer, &expected[step], sizeof answer);
    }
    blast_deinit(&blast);
}

/* If it failed: steps that rebuild would go to the system for memory. */
CASE(rebuild__warm_steps_allocate_nothing)
{
    start(0.9, BLAST_TRIANGLES);
    stand_still(0.1); /* contacts take memory too: as many as will ever be */
    for (uint32_t step = 0; step < STEPS; step++) {
        blast_run(&blast, 0.1 * step, 0.1 * step + 0.1, team_of(2, ENG_SCHEDULER_STEAL));
    }
    uint64_t rebuilds = 0;
    for (uint32_t step = 0; step < STEPS; step++) {
        struct eng_step_result result = blast_run(&blast, 0.1 * step, 0.1 * step + 0.1,
                                                  team_of(2, ENG_SCHEDULER_STEAL));
        assert_int_equal(result.counters.allocs, 0);
        rebuilds += result.counters.rebuilds;
    }
    assert_true(rebuilds > 0);
    blast_deinit(&blast);
}

#define OBJECTS 60u

static void fly_apart(struct eng_scene *scene, const uint32_t *objects, double t,
                      struct eng_step_result *result)
{
    struct eng_question settings = kit_contacts(PCCD_MODE_ALL, PCCD_METHOD_PAPER);
    struct prng random = {63};
    eng_stage_begin(scene);
    for (uint32_t i = 0; i < OBJECTS; i++) {
        double m0[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        double m1[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        uint32_t count = eng_scene_vertex_count(scene, objects[i]);
        for (int k = 0; k < 3; k++) {
            double velocity = prng_between(&random, -20, 20);
            m0[4 * k + 3] = t * velocity + (k == 0 ? 2.0 * i : 0);
            m1[4 * k + 3] = (t + 0.1) * velocity + (k == 0 ? 2.0 * i : 0);
        }
        assert_ok(eng_stage_rigid(scene, objects[i], 0, count, m0, m1));
    }
    assert_ok(eng_step(scene, &settings, result));
    assert_true(eng_tree_validate(scene));
}

/* If it failed: objects that change places would be tested against ever more others. */
CASE(rebuild__tree_over_objects_follows_them)
{
    uint64_t box_tests[2];
    for (int way = 0; way < 2; way++) {
        struct eng_scene_settings settings = ENG_SCENE_SETTINGS_DEFAULT;
        struct eng_step_result result = {0};
        struct eng_scene *scene;
        uint32_t objects[OBJECTS];
        uint64_t rebuilds = 0;
        settings.rebuild_ratio = way == 0 ? 0.9 : 0;
        assert_ok(eng_scene_new(&settings, &scene));
        for (uint32_t i = 0; i < OBJECTS; i++) {
            objects[i] = kit_add(scene, kit_sheet(1, 0), i);
        }
        for (uint32_t step = 0; step < 40; step++) {
            fly_apart(scene, objects, 0.1 * step, &result);
            rebuilds += result.counters.rebuilds;
        }
        box_tests[way] = result.counters.box_tests;
        assert_int_equal(rebuilds > 0, way == 0);
        eng_scene_free(scene);
    }
    assert_true(box_tests[1] > 2 * box_tests[0]);
}
