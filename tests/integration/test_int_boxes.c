/* test_int_boxes.c - what the hierarchies of a scene look like, through a real daemon. */
#include "cases.h"

#include <float.h>

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"

#define SIDE       60u
#define BOXES_MAX  8192u
#define LEVELS_MAX 32u

/* A client with little room for results, and a grid that has fallen for a step. */
struct fallen {
    struct pccd_client *client;
    struct test_grid grid;
    struct pccd_box boxes[BOXES_MAX];
    uint32_t count;
};

static void fall(struct fallen *fallen, enum pccd_method method)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .method = method};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    fallen->client = test_client(&(struct pccd_options){
        .url = test_shared.url,
        .result_bytes = 65536}); /* boxes need several pages of it */
    assert_ok(test_grid_make(fallen->client, SIDE, &fallen->grid));
    assert_ok(test_grid_turn(&fallen->grid, &settings, &answer));
    pccd_answer_release(fallen->client, &answer);
}

static void end(struct fallen *fallen)
{
    test_grid_free(&fallen->grid);
    pccd_close(fallen->client);
    free(fallen);
}

/* All boxes of a level. */
static uint32_t read_level(struct fallen *fallen, enum pccd_tree tree, uint32_t level)
{
    fallen->count = 0;
    assert_ok(pccd_scene_boxes(fallen->client, fallen->grid.scene, tree, level,
                               fallen->boxes, BOXES_MAX, &fallen->count));
    assert_true(fallen->count <= BOXES_MAX);
    return fallen->count;
}

/* The box around those of the level that was read. */
static struct pccd_box hull(const struct fallen *fallen)
{
    struct pccd_box around = {.low0 = {FLT_MAX, FLT_MAX, FLT_MAX},
                              .high0 = {-FLT_MAX, -FLT_MAX, -FLT_MAX},
                              .low1 = {FLT_MAX, FLT_MAX, FLT_MAX},
                              .high1 = {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    for (uint32_t i = 0; i < fallen->count; i++) {
        const struct pccd_box *box = &fallen->boxes[i];
        for (uint32_t k = 0; k < 3 && box->low0[0] <= box->high0[0]; k++) {
            around.low0[k] =
                box->low0[k] < around.low0[k] ? box->low0[k] : around.low0[k];
            around.low1[k] =
                box->low1[k] < around.low1[k] ? box->low1[k] : around.low1[k];
            around.high0[k] =
                box->high0[k] > around.high0[k] ? box->high0[k] : around.high0[k];
            around.high1[k] =
                box->high1[k] > around.high1[k] ? box->high1[k] : around.high1[k];
        }
    }
    return around;
}

/* Return whether a vertex of the grid, at its height at each end, is in a box of the
 * level. */
static bool is_covered(const struct fallen *fallen, const float x[3])
{
    for (uint32_t i = 0; i < fallen->count; i++) {
        const struct pccd_box *box = &fallen->boxes[i];
        bool is_in = true;
        for (uint32_t k = 0; k < 2; k++) {
            is_in = is_in && box->low0[k] <= x[k] && x[k] <= box->high0[k] &&
                    box->low1[k] <= x[k] && x[k] <= box->high1[k];
        }
        if (is_in && box->high0[2] > 0 && box->low1[2] < 0) {
            return true;
        }
    }
    return false;
}

/* The levels of a tree, from the root to the last that has so many boxes. */
static uint32_t check_tree(struct fallen *fallen, enum pccd_tree tree, uint32_t widest)
{
    uint32_t level = 0, before = 0;
    assert_int_equal(read_level(fallen, tree, 0), 1);
    struct pccd_box root = hull(fallen);
    for (; level < LEVELS_MAX && read_level(fallen, tree, level) > 0; level++) {
        struct pccd_box around = hull(fallen);
        if (tree != PCCD_TREE_TRIANGLES || fallen->count == 1u << level) {
            assert_memory_equal(&around, &root, sizeof root);
            for (uint32_t i = 0; i < fallen->grid.vertex_count; i += 7) {
                assert_true(is_covered(fallen, fallen->grid.x[i]));
            }
        }
        widest = fallen->count > widest ? fallen->count : widest;
        before += fallen->count;
    }
    assert_in_range(level, 3, LEVELS_MAX - 1);
    assert_true(before > widest);
    return widest;
}

/* If it failed, what is shown as a hierarchy would not be over the scene, or pages of it
 * would be lost. */
CASE(boxes__of_wide_cover_what_is_below)
{
    struct fallen *fallen = test_room(sizeof *fallen);
    fall(fallen, PCCD_METHOD_WIDE);
    for (uint32_t tree = PCCD_TREE_VERTICES; tree <= PCCD_TREE_FACES; tree++) {
        /* Sixteen features to a box at most. */
        assert_in_range(check_tree(fallen, (enum pccd_tree)tree, 0), SIDE * SIDE / 16,
                        SIDE * SIDE);
    }
    assert_int_equal(read_level(fallen, PCCD_TREE_TRIANGLES, 0), 0);
    end(fallen);
}

/* If it failed, the same of the paper's tree. */
CASE(boxes__of_paper_cover_what_is_below)
{
    struct fallen *fallen = test_room(sizeof *fallen);
    fall(fallen, PCCD_METHOD_PAPER);
    assert_in_range(check_tree(fallen, PCCD_TREE_TRIANGLES, 0), SIDE * SIDE,
                    2 * SIDE * SIDE);
    assert_int_equal(read_level(fallen, PCCD_TREE_FACES, 0), 0);
    end(fallen);
}

/* If it failed, a hierarchy of objects that are gone would be walked, or shown. */
CASE(boxes__of_paper_go_when_objects_do)
{
    struct fallen *fallen = test_room(sizeof *fallen);
    fall(fallen, PCCD_METHOD_PAPER);
    assert_int_equal(read_level(fallen, PCCD_TREE_TRIANGLES, 0), 1);
    assert_ok(pccd_scene_remove(fallen->client, fallen->grid.scene, fallen->grid.object));
    assert_int_equal(read_level(fallen, PCCD_TREE_TRIANGLES, 0), 0);
    end(fallen);
}

/* If it failed, a wrong question would be answered, or end a session. */
CASE(boxes__are_refused_where_there_are_none)
{
    struct fallen *fallen = test_room(sizeof *fallen);
    uint32_t count = 77;
    fall(fallen, PCCD_METHOD_WIDE);
    struct pccd_client *client = fallen->client;
    uint32_t scene = fallen->grid.scene;
    assert_int_equal(
        pccd_scene_boxes(client, scene + 1, PCCD_TREE_FACES, 0, NULL, 0, &count),
        PCCD_E_HANDLE);
    assert_int_equal(pccd_scene_boxes(client, scene, PCCD_TREE_COUNT, 0, NULL, 0, &count),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_scene_boxes(client, scene, PCCD_TREE_FACES, 0, NULL, 1, &count),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_scene_boxes(client, scene, PCCD_TREE_FACES, 0, NULL, 0, NULL),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_scene_boxes(NULL, scene, PCCD_TREE_FACES, 0, NULL, 0, &count),
                     PCCD_E_INVAL);
    assert_int_equal(count, 77);
    assert_ok(
        pccd_scene_boxes(client, scene, PCCD_TREE_FACES, UINT32_MAX, NULL, 0, &count));
    assert_int_equal(count, 0);
    assert_ok(
        pccd_scene_boxes(client, scene, PCCD_TREE_FACES, 1, fallen->boxes, 1, &count));
    assert_in_range(count, 2, 16);
    end(fallen);
}

/* If it failed, whoever asks for boxes before the first object or step would end the
 * daemon, and with it everybody's sessions. */
CASE(boxes__of_an_empty_scene_are_none)
{
    struct pccd_client *client =
        test_client(&(struct pccd_options){.url = test_shared.url});
    uint32_t scene = test_scene(client);
    for (uint32_t tree = 0; tree < PCCD_TREE_COUNT; tree++) {
        struct pccd_box box;
        uint32_t count = 77;
        assert_ok(
            pccd_scene_boxes(client, scene, (enum pccd_tree)tree, 0, &box, 1, &count));
        assert_int_equal(count, 0);
    }
    pccd_close(client);
}

CASES_WITH(test_shared_start, test_shared_stop);
