/* test_eng_refit.c - bottom-up update of every box.
 *
 * Source: daemon/engine/paper/refit.h; paper section 6.1.
 */
#include "eng_kit.h"
#include "refit.h"
#include "step.h"
#include "trees.h"
#include "world.h"

#define VERTICES 300u /* of 100 separate triangles */

static struct eng_scene *new_scene(struct prng *random, uint32_t objects)
{
    struct eng_scene_settings settings = ENG_SCENE_SETTINGS_DEFAULT;
    struct eng_scene *scene = NULL;
    settings.rebuild_ratio = 0; /* refit alone */
    assert_ok(eng_scene_new(&settings, &scene));
    for (uint32_t i = 0; i < objects; i++) {
        kit_add(scene, kit_soup(random, VERTICES / 3), i);
    }
    return scene;
}

static void run(struct eng_scene *scene)
{
    struct eng_question settings = kit_contacts(PCCD_MODE_ANY, PCCD_METHOD_PAPER);
    kit_step(scene, &settings);
}

static void move_to(struct eng_scene *scene, uint32_t object_idx, const double (*x)[3])
{
    assert_ok(eng_stage_x1(scene, object_idx, PCCD_FORMAT_F64, 0, VERTICES, x));
}

/* Around everywhere, at scales from tiny to huge. */
static void random_positions(struct prng *random, double (*x)[3])
{
    double scale = ldexp(1, (int)prng_u32(random, 80) - 40);
    for (uint32_t i = 0; i < 3 * VERTICES; i++) {
        x[i / 3][i % 3] = prng_between(random, -scale, scale);
    }
}

/* The tightest box of a vertex, in its object's frame. */
static struct eng_box box_of(const struct eng_scene *scene, uint32_t v)
{
    struct eng_box box = {.word0 = 0};
    eng_box_of_point(&box, eng_box_frame_of_vertex(scene, v), scene->x[1 - scene->now][v],
                     scene->x[scene->now][v]);
    return box;
}

static void check_point(const struct eng_scene *scene, const void *record, uint32_t v)
{
    const struct eng_box *box = eng_box_of_const(record);
    struct eng_box point = box_of(scene, v);
    for (int k = 0; k < 3; k++) {
        assert_true(box->lo0[k] <= point.lo0[k] && point.hi0[k] <= box->hi0[k]);
        assert_true(box->lo1[k] <= point.lo1[k] && point.hi1[k] <= box->hi1[k]);
    }
}

static void check_all(const struct eng_scene *scene)
{
    for (uint32_t v = 0; v < scene->vertex_ranges.end; v++) {
        check_point(scene, &eng_trees_of(scene)->vertices[v], v);
    }
    for (uint32_t e = 0; e < eng_trees_of(scene)->edge_ranges.end; e++) {
        const struct eng_edge *edge = &eng_trees_of(scene)->edges[e];
        check_point(scene, edge, edge->a);
        check_point(scene, edge, edge->b);
    }
    for (uint32_t i = 0; i < eng_trees_of(scene)->node_ranges.end; i++) {
        const struct eng_node *node = &eng_trees_of(scene)->nodes[i];
        for (int k = 0; k < 3 && node->left == ENG_LEAF; k++) {
            check_point(scene, node, eng_trees_of(scene)->triangles[node->right].v[k]);
        }
    }
    assert_true(eng_tree_validate(scene));
}

/* If it failed: a pair would be culled although its features meet. */
CASE(refit__boxes_contain_their_content_after_every_step)
{
    struct prng random = {30};
    struct eng_scene *scene = new_scene(&random, 3);
    static double x[VERTICES][3];
    for (int step = 0; step < 60; step++) {
        eng_stage_begin(scene);
        for (uint32_t idx = 0; idx < 3; idx++) {
            if (prng_u32(&random, 3) > 0) { /* some stand still */
                random_positions(&random, x);
                move_to(scene, idx, (const double(*)[3])x);
            }
        }
        run(scene);
        check_all(scene);
    }
    eng_scene_free(scene);
}

/* If it failed: boxes would be larger than rounding asks for, and culling worse. */
CASE(refit__root_is_as_tight_as_the_vertices)
{
    struct prng random = {31};
    struct eng_scene *scene = new_scene(&random, 3);
    static double x[VERTICES][3];
    for (int step = 0; step < 20; step++) {
        eng_stage_begin(scene);
        for (uint32_t idx = 0; idx < 3; idx++) {
            random_positions(&random, x);
            move_to(scene, idx, (const double(*)[3])x);
        }
        run(scene);
        const struct eng_node *root =
            &eng_trees_of(scene)->nodes[eng_trees_of(scene)->root];
        struct eng_box all = box_of(scene, 0);
        for (uint32_t v = 1; v < scene->vertex_ranges.end; v++) {
            struct eng_box point = box_of(scene, v);
            eng_box_unite(&all, &all, &point);
        }
        for (int k = 0; k < 3; k++) {
            assert_true(root->lo0[k] == all.lo0[k] && root->hi0[k] == all.hi0[k]);
            assert_true(root->lo1[k] == all.lo1[k] && root->hi1[k] == all.hi1[k]);
        }
    }
    eng_scene_free(scene);
}

/* Copies of every record with a box. */
struct snapshot {
    struct eng_node *nodes;
    struct eng_edge *edges;
    struct eng_vertex *vertices;
};

static struct snapshot snap(const struct eng_scene *scene)
{
    return (struct snapshot){
        test_copy(eng_trees_of(scene)->nodes, eng_trees_of(scene)->node_ranges.end *
                                                  sizeof *eng_trees_of(scene)->nodes),
        test_copy(eng_trees_of(scene)->edges, eng_trees_of(scene)->edge_ranges.end *
                                                  sizeof *eng_trees_of(scene)->edges),
        test_copy(eng_trees_of(scene)->vertices,
                  scene->vertex_ranges.end * sizeof *eng_trees_of(scene)->vertices)};
}

static void drop(struct snapshot *snapshot)
{
    free(snapshot->nodes);
    free(snapshot->edges);
    free(snapshot->vertices);
}

static void check_same(const struct eng_scene *scene, const struct snapshot *before)
{
    assert_memory_equal(eng_trees_of(scene)->nodes, before->nodes,
                        eng_trees_of(scene)->node_ranges.end *
                            sizeof *eng_trees_of(scene)->nodes);
    assert_memory_equal(eng_trees_of(scene)->edges, before->edges,
                        eng_trees_of(scene)->edge_ranges.end *
                            sizeof *eng_trees_of(scene)->edges);
    assert_memory_equal(eng_trees_of(scene)->vertices, before->vertices,
                        scene->vertex_ranges.end * sizeof *eng_trees_of(scene)->vertices);
}

/* If it failed: boxes would grow from step to step without a cause. */
CASE(refit__repeated_refit_does_not_inflate)
{
    struct prng random = {32};
    struct eng_scene *scene = new_scene(&random, 2);
    static double p[VERTICES][3];
    static double q[VERTICES][3];
    random_positions(&random, p);
    random_positions(&random, q);
    struct snapshot first = {NULL, NULL, NULL};
    for (int round = 0; round < 6; round++) {
        eng_stage_begin(scene);
        assert_ok(eng_stage_x0x1(scene, 0, PCCD_FORMAT_F64, 0, VERTICES, p, q));
        assert_ok(eng_stage_x0x1(scene, 1, PCCD_FORMAT_F64, 0, VERTICES, q, p));
        run(scene);
        if (round == 0) {
            first = snap(scene);
        }
        check_same(scene, &first);
        for (int again = 0; again < 5; again++) {
            eng_refit(scene, NULL);
        }
        check_same(scene, &first);
        eng_stage_begin(scene); /* somewhere else in between */
        move_to(scene, 0, (const double(*)[3])p);
        run(scene);
    }
    drop(&first);
    eng_scene_free(scene);
}

/* If it failed: an object that stands still would keep the boxes of its last motion. */
CASE(refit__still_objects_have_equal_boxes_at_both_ends)
{
    struct prng random = {33};
    struct eng_scene *scene = new_scene(&random, 2);
    static double x[VERTICES][3];
    random_positions(&random, x);
    eng_stage_begin(scene);
    move_to(scene, 0, (const double(*)[3])x);
    run(scene);
    run(scene);
    for (uint32_t i = 0; i < eng_trees_of(scene)->node_ranges.end; i++) {
        const struct eng_node *node = &eng_trees_of(scene)->nodes[i];
        assert_memory_equal(node->lo0, node->lo1, sizeof node->lo0);
        assert_memory_equal(node->hi0, node->hi1, sizeof node->hi0);
    }
    check_all(scene);
    eng_scene_free(scene);
}

/* Boxes alone: words of the records are left out. */
static void check_same_boxes(const void *a, const void *b, size_t count)
{
    const struct eng_box *boxes = a;
    const struct eng_box *others = b;
    for (size_t i = 0; i < count; i++) {
        assert_memory_equal(boxes[i].lo0, others[i].lo0, sizeof boxes->lo0);
        assert_memory_equal(boxes[i].hi0, others[i].hi0, sizeof boxes->hi0);
        assert_memory_equal(boxes[i].lo1, others[i].lo1, sizeof boxes->lo1);
        assert_memory_equal(boxes[i].hi1, others[i].hi1, sizeof boxes->hi1);
    }
}

/* Some vertices of one object go somewhere else, now and then all. */
static void move_some(struct prng *random, struct eng_scene *scene)
{
    uint32_t idx = prng_u32(random, 3);
    uint32_t count = 1 + prng_u32(random, prng_u32(random, 4) > 0 ? 3 : VERTICES);
    uint32_t first = prng_u32(random, VERTICES - count + 1);
    static double x[VERTICES][3];
    for (uint32_t i = 0; i < 3 * count; i++) {
        x[i / 3][i % 3] = prng_between(random, -1, 1);
    }
    assert_ok(eng_stage_x1(scene, idx, PCCD_FORMAT_F64, first, count, x));
}

static void check_as_alone(struct eng_scene *scene)
{
    struct snapshot made = snap(scene);
    eng_refit(scene, NULL);
    check_same_boxes(eng_trees_of(scene)->nodes, made.nodes,
                     eng_trees_of(scene)->node_ranges.end);
    check_same_boxes(eng_trees_of(scene)->edges, made.edges,
                     eng_trees_of(scene)->edge_ranges.end);
    check_same_boxes(eng_trees_of(scene)->vertices, made.vertices,
                     scene->vertex_ranges.end);
    drop(&made);
}

/* If this failed, boxes would depend on the number of threads, or some would be those of
 * another step. */
CASE(refit__by_a_team_makes_the_boxes_of_one_thread)
{
    static const enum eng_refit_scheme schemes[] = {ENG_REFIT_EVEN, ENG_REFIT_PAPER};
    struct prng random = {34};
    for (uint32_t way = 0; way < 4; way++) {
        struct eng_scene *scene = new_scene(&random, 3);
        struct eng_question settings = ENG_QUESTION_DEFAULT;
        struct eng_step_result result;
        settings.method = PCCD_METHOD_PAPER;
        settings.threads = 1 + way / 2;
        settings.team_always = true;
        settings.tuning.refit = schemes[way % 2];
        for (uint32_t step = 0; step < 60; step++) {
            eng_stage_begin(scene);
            if (prng_u32(&random, 5) > 0) {
                move_some(&random, scene);
            }
            settings.mode = prng_u32(&random, 8) == 0 ? PCCD_MODE_FIRST : PCCD_MODE_PAIRS;
            result = kit_step(scene, &settings);
            assert_int_equal(result.counters.still_features, 0);
            check_as_alone(scene);
        }
        eng_scene_free(scene);
    }
}

/* If this failed, many threads and small objects would leave nodes without boxes, or
 * write behind the plan: the trees have fewer subtrees than are wanted. */
CASE(refit_plan__covers_every_node_within_its_memory)
{
    struct prng random = {5};
    struct eng_scene *scene = new_scene(&random, 3);
    struct eng_refit_plan plan = {0};
    run(scene); /* builds the tree over the objects */
    for (uint32_t threads = 1; threads < 250; threads += 3) {
        enum eng_refit_scheme scheme = threads % 2 ? ENG_REFIT_EVEN : ENG_REFIT_PAPER;
        assert_ok(eng_refit_plan_tree(&plan, scene, scheme, threads));
        assert_true(plan.opened_count <= plan.capacity);
        assert_true(plan.root_count <= plan.capacity + 1);
        uint32_t covered = plan.opened_count;
        for (uint32_t i = 0; i < plan.root_count; i++) {
            covered += 2 * eng_trees_of(scene)->nodes[plan.roots[i]].count - 1;
        }
        assert_int_equal(covered, 2 * VERTICES - 1); /* three objects of VERTICES / 3 */
    }
    eng_refit_plan_deinit(&plan);
    eng_scene_free(scene);
}
