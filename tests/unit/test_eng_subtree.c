/* test_eng_subtree.c - which nodes are below which; disjoint task units.
 *
 * Source: daemon/engine/paper/trees.h; paper section 4.1.
 */
#include "eng_crew.h"
#include "trees.h"

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
