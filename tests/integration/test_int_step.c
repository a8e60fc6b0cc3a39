/* test_int_step.c - steps through a real daemon: what goes in and what comes out. */
#include "cases.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"

/* A whole step of one object with x1 positions; asserts that it succeeds. */
static void step_x1(struct test_crossing *crossing, uint32_t object, const float (*x1)[3],
                    const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    assert_ok(pccd_step_x1(crossing->client, crossing->scene, object, x1, PCCD_FORMAT_F32,
                           3, settings, answer));
}

/* ---- meshes ------------------------------------------------------------------------ */

/* If it failed, what a mesh holds would be counted wrongly, and edges be named
 * wrongly. */
CASE_CROSSING(mesh__counts_and_edges_are_those_of_the_data)
{
    static const double x[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                   {0, 0, 1}, {5, 5, 5}, {2, 0, 0}};
    static const uint32_t triangles[6][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2},
                                             {1, 2, 3}, {3, 2, 1}, {0, 1, 5}};
    static const struct pccd_edge expected[8] = {{0, 1}, {0, 2}, {1, 2}, {0, 3},
                                                 {1, 3}, {2, 3}, {0, 5}, {1, 5}};
    struct test_crossing *crossing = *state;
    struct pccd_mesh_info info;
    struct pccd_edge edges[12], untouched[12];
    uint32_t mesh = 0;

    assert_ok(pccd_mesh_create(crossing->client, x, PCCD_FORMAT_F64, 6, triangles, 6,
                               &mesh, &info));
    assert_int_equal(info.vertex_count, 6);
    assert_int_equal(info.triangle_count, 6);
    assert_int_equal(info.edge_count, 8);
    assert_int_equal(info.duplicate_count, 1);  /* (3, 2, 1) is (1, 2, 3) again */
    assert_int_equal(info.degenerate_count, 1); /* (0, 1, 5) lies on a line */
    assert_int_equal(info.isolated_count, 1);   /* vertex 4 */
    memset(edges, 0xff, sizeof edges);
    memcpy(untouched, edges, sizeof edges);
    assert_ok(pccd_mesh_edges(crossing->client, mesh, edges, 8));
    assert_memory_equal(edges, expected, sizeof expected);
    assert_ok(pccd_mesh_edges(crossing->client, mesh, edges, 12)); /* more room */
    assert_memory_equal(edges, expected, sizeof expected);
    assert_memory_equal(edges + 8, untouched + 8, 4 * sizeof *edges);
    memcpy(edges, untouched, sizeof edges);
    for (uint32_t room = 0; room < 8; room += 7) {
        assert_int_equal(pccd_mesh_edges(crossing->client, mesh, edges, room),
                         PCCD_E_INVAL);
        assert_memory_equal(edges, untouched, sizeof edges);
    }
    assert_non_null(strstr(pccd_error_text(crossing->client), "edge_count is 7"));
    assert_non_null(strstr(pccd_error_text(crossing->client), "has 8 edges"));
    assert_int_equal(pccd_mesh_edges(crossing->client, mesh + 77, edges, 8),
                     PCCD_E_HANDLE);
    assert_ok(pccd_mesh_destroy(crossing->client, mesh));
}

/* If it failed, a mesh that needs several slots would arrive damaged. */
CASE_CROSSING(mesh__larger_than_a_slot_arrives_whole)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_edge *edges;
    struct pccd_mesh_info info;
    struct test_grid grid;
    uint64_t step = 0;
    uint32_t mesh = 0;
    uint32_t edge_count = 3 * 89 * 89 + 2 * 89; /* of a grid of 90 x 90 vertices */

    struct pccd_client *client =
        test_client(&(struct pccd_options){.url = test_shared.url,
                                           .slot_bytes = 4096,
                                           .slot_count = 3,
                                           .result_bytes = 65536});
    assert_ok(test_grid_make(client, 90, &grid));
    /* The edges need several pages of the result region. */
    edges = test_room(edge_count * sizeof *edges);
    assert_ok(pccd_mesh_edges(client, grid.mesh, edges, edge_count));
    for (uint32_t i = 1; i < edge_count; i++) {
        assert_true(edges[i - 1].b < edges[i].b ||
                    (edges[i - 1].b == edges[i].b && edges[i - 1].a < edges[i].a));
    }
    free(edges);
    /* The step needs a ring with larger slots. */
    assert_ok(test_grid_submit(&grid, NULL, &step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_int_equal(answer.total, 8100);
    assert_int_equal(answer.counts[PCCD_VF], 8100);
    pccd_answer_release(client, &answer);
    test_grid_close(&grid);
    assert_ok(pccd_mesh_create(crossing->client, test_floor_x, PCCD_FORMAT_F32, 3,
                               test_triangle, 1, &mesh, &info));
    assert_int_equal(info.edge_count, 3);
}

/* If it failed, bad data would be registered, or a refused mesh stay in the daemon. */
CASE_CROSSING(mesh__bad_data_is_refused_and_leaves_nothing)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    const uint64_t meshes = 2; /* the crossing's: those of the case before may be there */
    const uint32_t beyond[1][3] = {{0, 1, 3}};
    float x[3][3];
    uint32_t mesh = 0;

    memcpy(x, test_floor_x, sizeof x);
    assert_int_equal(
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, beyond, 1, &mesh, NULL),
        PCCD_E_INDEX);
    assert_non_null(strstr(pccd_error_text(client), "triangle 0 names vertex 3; the mesh "
                                                    "has 3 vertices, which begin at 0"));
    x[1][2] = NAN;
    assert_int_equal(
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, test_triangle, 1, &mesh, NULL),
        PCCD_E_NOTFINITE);
    assert_non_null(strstr(pccd_error_text(client), "z of vertex 1 is nan"));
    x[1][2] = 1.5e18f;
    assert_int_equal(
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, test_triangle, 1, &mesh, NULL),
        PCCD_E_NOTFINITE);
    assert_true(pccd_error_text(client)[0] != '\0');
    assert_int_equal(test_stat_await(client, "meshes_now", meshes), meshes);
    assert_true(test_crossing_turn(crossing));
}

/* ---- segments ---------------------------------------------------------------------- */

/* If it failed, end positions in float would be read wrongly. */
CASE_CROSSING(step__x1_in_float_meets_the_floor)
{
    struct test_crossing *crossing = *state;

    for (int i = 0; i < 20; i++) {
        assert_true(test_crossing_turn(crossing));
    }
}

/* If it failed, end positions in double would be read wrongly. */
CASE_CROSSING(step__x1_in_double_meets_the_floor)
{
    const double x1[3][3] = {{0, 0, -3}, {1, 0, -3}, {0, 1, -3}};
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_ok(pccd_step_x1(crossing->client, crossing->scene, crossing->object, x1,
                           PCCD_FORMAT_F64, 3, NULL, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 3);
    assert_int_equal(answer.counts[PCCD_EE], 0);
    assert_true(answer.toi_first <= 0.25 && answer.toi_first > 0.249998);
    assert_true(answer.contacts[0].flags & PCCD_PROVED);
    /* The vertex comes from above: the normal points up, from the floor to it. */
    assert_true(answer.contacts[0].normal[2] > 0.999f);
    pccd_answer_release(crossing->client, &answer);
    assert_null(answer.contacts);
}

/* If it failed, a jump between steps would be taken for motion, or a start be ignored. */
CASE_CROSSING(step__x0x1_gives_both_ends)
{
    const double far0[3][3] = {{0, 0, -5}, {1, 0, -5}, {0, 1, -5}};
    const double far1[3][3] = {{0, 0, -4}, {1, 0, -4}, {0, 1, -4}};
    const double up0[3][3] = {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}};
    const double up1[3][3] = {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}};
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_ok(pccd_step_x0x1(crossing->client, crossing->scene, crossing->object, far0,
                             far1, PCCD_FORMAT_F64, 3, NULL, &answer));
    assert_int_equal(answer.count, 0);
    assert_null(answer.contacts);
    assert_true(answer.toi_first == 2.0);
    pccd_answer_release(crossing->client, &answer);
    assert_ok(pccd_step_x0x1(crossing->client, crossing->scene, crossing->object, up0,
                             up1, PCCD_FORMAT_F64, 3, NULL, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 3);
    assert_true(answer.toi_first <= 0.25 && answer.toi_first > 0.249998);
    pccd_answer_release(crossing->client, &answer);
    /* The end of that step is the start of the next. */
    crossing->z = 3;
    step_x1(crossing, crossing->object, (const float(*)[3])test_floor_x, NULL, &answer);
    assert_true(answer.count > 0);
    pccd_answer_release(crossing->client, &answer);
}

/* If it failed, a range would move the wrong vertices. */
CASE_CROSSING(step__ranges_move_only_their_vertices)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t step = 0;
    void *x1 = NULL;

    /* Vertex 1 alone goes through the floor. */
    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 1, 12, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 1, 1, &x1));
    memcpy(x1, (const float[3]){1, 0, -1}, 12);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(crossing->client, step, -1, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 1);
    assert_int_equal(answer.contacts[0].feature_a, 1);
    pccd_answer_release(crossing->client, &answer);
    /* Then the other two, in two segments of different formats. */
    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 2, 12 + 24, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 2, 1, &x1));
    memcpy(x1, (const float[3]){0, 1, -1}, 12);
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F64, 0, 1, &x1));
    memcpy(x1, (const double[3]){0, 0, -1}, 24);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(crossing->client, step, -1, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 2);
    assert_int_equal(answer.contacts[0].feature_a, 0);
    assert_int_equal(answer.contacts[1].feature_a, 2);
    pccd_answer_release(crossing->client, &answer);
    crossing->z = -1;
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, transforms would be applied to the wrong positions or transposed. */
CASE_CROSSING(step__rigid_transforms_the_registered_positions)
{
    const double from[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    /* A quarter turn about z, and down by 4: the vertices end at height -3. */
    const double to[12] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, -4};
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t step = 0;

    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 1, 192, &frame));
    assert_ok(pccd_frame_rigid(&frame, crossing->object, 0, 3, from, to));
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(crossing->client, step, -1, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 3);
    assert_true(answer.toi_first <= 0.25 && answer.toi_first > 0.249998);
    pccd_answer_release(crossing->client, &answer);
    /* Registered, not last: the same transform again ends where it ended. */
    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 1, 192, &frame));
    assert_ok(pccd_frame_rigid(&frame, crossing->object, 0, 3, to, from));
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(crossing->client, step, -1, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 3);
    assert_true(answer.toi_first <= 0.75 && answer.toi_first > 0.749998);
    pccd_answer_release(crossing->client, &answer);
    crossing->z = 1;
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, objects that are not named would move, or moving ones meet twice. */
CASE_CROSSING(step__still_objects_stand_and_two_can_move)
{
    const float low[3][3] = {{-9, -9, -1}, {9, -9, -1}, {0, 9, -1}};
    const float middle[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame frame;
    uint64_t step = 0;
    void *x1 = NULL;
    float high[3][3];

    test_still(crossing->client, crossing->scene, NULL, &answer);
    assert_int_equal(answer.count, 0);
    pccd_answer_release(crossing->client, &answer);
    /* The floor from 0 to -1 while the triangle goes from 1 to 0: they keep their
     * distance. */
    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 2, 72, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->floor, PCCD_FORMAT_F32, 0, 3, &x1));
    memcpy(x1, low, sizeof low);
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, &x1));
    memcpy(x1, middle, sizeof middle);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(crossing->client, step, -1, &answer));
    assert_int_equal(answer.count, 0);
    pccd_answer_release(crossing->client, &answer);
    /* Now they swap: they meet at half time. */
    memcpy(high, low, sizeof high);
    high[0][2] = high[1][2] = high[2][2] = 0;
    assert_ok(pccd_frame_begin(crossing->client, crossing->scene, 2, 72, &frame));
    assert_ok(pccd_frame_x1(&frame, crossing->floor, PCCD_FORMAT_F32, 0, 3, &x1));
    memcpy(x1, high, sizeof high);
    assert_ok(pccd_frame_x1(&frame, crossing->object, PCCD_FORMAT_F32, 0, 3, &x1));
    test_crossing_positions(x1, -1);
    assert_ok(pccd_frame_commit(&frame, NULL, &step));
    assert_ok(pccd_wait(crossing->client, step, -1, &answer));
    assert_int_equal(answer.counts[PCCD_VF], 3);
    assert_true(answer.toi_first <= 0.5 && answer.toi_first > 0.499998);
    pccd_answer_release(crossing->client, &answer);
}

/* If it failed, objects could not come and go between steps. */
CASE_CROSSING(step__objects_come_and_go)
{
    struct test_crossing *crossing = *state;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x1[3][3];

    uint32_t second = test_object(crossing->client, crossing->scene, crossing->mesh);
    assert_int_not_equal(second, crossing->object);
    test_crossing_positions(x1, -1);
    step_x1(crossing, second, (const float(*)[3])x1, NULL, &answer);
    /* Three vertices of the new one through the floor. At the start it lies exactly on
     * the old one: vertices on faces, edges on edges, touching at t = 0. */
    assert_true(answer.initial > 0);
    assert_true(answer.count >= 3 + answer.initial);
    pccd_answer_release(crossing->client, &answer);
    assert_ok(pccd_scene_remove(crossing->client, crossing->scene, second));
    assert_int_equal(pccd_scene_remove(crossing->client, crossing->scene, second),
                     PCCD_E_HANDLE);
    assert_true(test_crossing_turn(crossing));
    assert_ok(pccd_scene_remove(crossing->client, crossing->scene, crossing->floor));
    test_crossing_positions(x1, 1);
    step_x1(crossing, crossing->object, (const float(*)[3])x1, NULL, &answer);
    assert_int_equal(answer.count, 0);
    pccd_answer_release(crossing->client, &answer);
    crossing->floor =
        test_object(crossing->client, crossing->scene, crossing->floor_mesh);
    crossing->z = 1;
    assert_true(test_crossing_turn(crossing));
    /* The mesh may go; the objects made of it stay. */
    assert_ok(pccd_mesh_destroy(crossing->client, crossing->mesh));
    assert_true(test_crossing_turn(crossing));
}

/* If it failed, what a program of another release asks for would be read past its end, or
 * be ignored in silence. */
CASE_CROSSING(step__settings_of_another_release_are_read_or_refused)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct {
        struct pccd_step_settings known;
        uint64_t added;
    } settings = {.known = {.mode = PCCD_MODE_ALL}};
    const size_t sizes[] = {1, sizeof(struct pccd_step_settings) - 1, SIZE_MAX};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x1[3][3];

    test_crossing_positions(x1, -1);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        settings.known.struct_bytes = sizes[i];
        assert_int_equal(test_crossing_step(crossing, x1, &settings.known, &answer),
                         PCCD_E_INVAL);
        assert_non_null(
            strstr(pccd_error_text(client), "settings of the step: struct_bytes"));
    }
    settings.known.struct_bytes = sizeof settings;
    settings.added = 1;
    assert_int_equal(test_crossing_step(crossing, x1, &settings.known, &answer),
                     PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(client), "does not know"));
    settings.added = 0;
    assert_ok(test_crossing_step(crossing, x1, &settings.known, &answer));
    pccd_answer_release(client, &answer);
    settings.known.struct_bytes = 0;
    settings.added = 1; /* is not looked at */
    assert_ok(test_crossing_step(crossing, x1, &settings.known, &answer));
    pccd_answer_release(client, &answer);
}

/* If it failed, a library of another release would write behind a program's answer, or
 * leave what the program knows and the library does not as it was. */
CASE_CROSSING(step__answers_of_another_release_are_filled_or_refused)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct {
        struct pccd_answer known;
        uint64_t added[2];
    } answer;
    const size_t wrong[] = {1, sizeof(struct pccd_answer) - 1, SIZE_MAX};
    uint64_t step = 0;
    float x1[3][3];

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        memset(&answer, 0x5a, sizeof answer);
        answer.known.struct_bytes = wrong[i];
        test_crossing_positions(x1, -1);
        assert_int_equal(test_crossing_step(crossing, x1, NULL, &answer.known),
                         PCCD_E_INVAL); /* and nothing was submitted */
        assert_non_null(strstr(pccd_error_text(client), "answer: struct_bytes"));
        assert_int_equal(pccd_poll(client, &answer.known), PCCD_E_INVAL);
        assert_int_equal(pccd_wait(client, 1, 0, &answer.known), PCCD_E_INVAL);
        assert_int_equal(pccd_fetch(client, crossing->scene, 1, 0, &answer.known),
                         PCCD_E_INVAL);
        assert_int_equal(pccd_scene_read(client, crossing->scene, 1, 0, &answer.known),
                         PCCD_E_INVAL);
        assert_int_equal(answer.known.step, 0x5a5a5a5a5a5a5a5au);
    }
    for (size_t added = 0; added <= 2; added++) {
        size_t bytes = sizeof answer.known + added * sizeof answer.added[0];

        memset(&answer, 0x5a, sizeof answer);
        answer.known.struct_bytes = added == 0 ? 0 : bytes;
        test_crossing_positions(x1, added % 2 == 0 ? -1 : 1);
        assert_ok(pccd_submit(
            client, crossing->scene,
            &(struct pccd_motion){.object = crossing->object, .count = 3, .x1 = x1}, 1,
            NULL, &step));
        assert_ok(pccd_wait(client, step, -1, &answer.known));
        assert_int_equal(answer.known.struct_bytes, added == 0 ? 0 : bytes);
        assert_int_equal(answer.known.step, step);
        assert_int_equal(answer.known.counts[PCCD_VF], 3);
        assert_int_equal(answer.known.counts[PCCD_KINDS_MAX - 1], 0);
        for (size_t i = 0; i < 2; i++) {
            assert_int_equal(answer.added[i], i < added ? 0 : 0x5a5a5a5a5a5a5a5au);
        }
        pccd_answer_release(client, &answer.known);
    }
}

/* If it failed, a step that is refused would still move something. */
CASE_CROSSING(step__refused_steps_change_nothing)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    const struct pccd_step_settings wrong[] = {{.mode = (enum pccd_mode)9},
                                               {.method = (enum pccd_method)9},
                                               {.tolerance = NAN},
                                               {.tolerance = -1},
                                               {.tolerance = 2}};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x1[4][3] = {{0}}; /* one more than the object has */

    test_crossing_positions(x1, -1);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct pccd_step_settings settings = wrong[i];

        settings.struct_bytes = sizeof settings;
        memset(&answer, 0xa5, sizeof answer);
        answer.struct_bytes = sizeof answer;
        assert_int_equal(test_crossing_step(crossing, x1, &settings, &answer),
                         PCCD_E_INVAL);
        assert_true(pccd_error_text(client)[0] != '\0');
        pccd_answer_release(client, &answer); /* safe, whatever it holds */
    }
    x1[2][0] = INFINITY;
    assert_int_equal(test_crossing_step(crossing, x1, NULL, &answer), PCCD_E_NOTFINITE);
    assert_int_equal(answer.status, PCCD_E_NOTFINITE);
    assert_non_null(strstr(pccd_error_text(client), "x of vertex 2 is inf at t = 1"));
    const struct pccd_motion moves = {
        .object = crossing->object, .count = 3, .x0 = x1, .x1 = test_floor_x};
    assert_int_equal(pccd_step(client, crossing->scene, &moves, 1, NULL, &answer),
                     PCCD_E_NOTFINITE);
    assert_non_null(strstr(pccd_error_text(client), "x of vertex 2 is inf at t = 0"));
    x1[2][0] = 0;
    const struct pccd_motion twice[3] = {
        {.object = crossing->object, .first = 1, .count = 2, .x1 = x1},
        {.object = crossing->object, .count = 1, .x1 = x1},
        {.object = crossing->object, .first = 2, .count = 1, .x1 = x1}};
    assert_int_equal(pccd_step(client, crossing->scene, twice, 3, NULL, &answer),
                     PCCD_E_SEGMENT);
    assert_non_null(strstr(pccd_error_text(client), "vertex 2 of object 0x"));
    assert_non_null(strstr(pccd_error_text(client), "by the segments 0 and 2"));
    assert_int_equal(pccd_step_x1(client, crossing->scene, crossing->object, x1,
                                  PCCD_FORMAT_F32, 4, NULL, &answer),
                     PCCD_E_SEGMENT);
    assert_int_equal(pccd_step_x1(client, crossing->scene, crossing->object, x1,
                                  PCCD_FORMAT_F32, 0, NULL, &answer),
                     PCCD_E_SEGMENT);
    assert_int_equal(pccd_step_x1(client, crossing->scene + 99, crossing->object, x1,
                                  PCCD_FORMAT_F32, 3, NULL, &answer),
                     PCCD_E_HANDLE);
    assert_true(test_crossing_turn(crossing)); /* from where it was */
}

/* ---- modes ------------------------------------------------------------------------- */

/* Heights 1, 1.5 and 2 down by 3: the vertices meet the floor at 1/3, 1/2 and 2/3. */
static void tilted_ends(float x0[3][3], float x1[3][3])
{
    memcpy(x0, test_triangle_x, sizeof test_triangle_x);
    x0[0][2] = 1.0f;
    x0[1][2] = 1.5f;
    x0[2][2] = 2.0f;
    memcpy(x1, x0, sizeof test_triangle_x);
    for (int i = 0; i < 3; i++) {
        x1[i][2] -= 3.0f;
    }
}

/* If it failed, a mode would answer another question than the one asked. */
CASE_CROSSING(step__modes_answer_what_they_say)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings settings = {.struct_bytes =
                                              sizeof(struct pccd_step_settings),
                                          .mode = PCCD_MODE_ALL,
                                          .threads = 1};
    struct pccd_client *client = crossing->client;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x0[3][3];
    float x1[3][3];

    tilted_ends(x0, x1);
#define STEP()                                                                           \
    assert_int_equal(pccd_step_x0x1(client, crossing->scene, crossing->object, x0, x1,   \
                                    PCCD_FORMAT_F32, 3, &settings, &answer),             \
                     0);                                                                 \
    assert_int_equal(answer.mode, settings.mode);                                        \
    assert_int_equal(answer.incomplete, PCCD_COMPLETE)
    STEP();
    assert_int_equal(answer.count, 3);
    assert_int_equal(answer.method, PCCD_METHOD_WIDE);
    assert_int_equal(answer.threads, 1);
    assert_int_equal(answer.verdict, PCCD_VERDICT_NONE);
    assert_true(answer.contacts[2].toi <= 2.0 / 3 &&
                answer.contacts[2].toi_hi >= 2.0 / 3);
    pccd_answer_release(client, &answer);

    settings.mode = PCCD_MODE_FIRST;
    STEP();
    assert_int_equal(answer.count, 1);
    assert_int_equal(answer.contacts[0].feature_a, 0);
    assert_true(answer.contacts[0].toi <= 1.0 / 3 &&
                answer.contacts[0].toi_hi >= 1.0 / 3);
    assert_true(answer.toi_first == answer.contacts[0].toi);
    pccd_answer_release(client, &answer);

    settings.mode = PCCD_MODE_ANY;
    STEP();
    assert_int_equal(answer.verdict, PCCD_VERDICT_YES);
    assert_int_equal(answer.count, 0);
    assert_null(answer.contacts);
    pccd_answer_release(client, &answer);
    test_still(client, crossing->scene, &settings, &answer);
    assert_int_equal(answer.verdict, PCCD_VERDICT_NO); /* it ends under the floor */
    pccd_answer_release(client, &answer);

    settings.mode = PCCD_MODE_PAIRS;
    STEP();
    assert_null(answer.contacts);
    assert_non_null(answer.pairs);
    assert_true(answer.counts[PCCD_VF] >= 3);
    for (uint32_t vertex = 0; vertex < 3; vertex++) {
        bool found = false;

        for (uint64_t i = 0; i < answer.count; i++) {
            found = found || (answer.pairs[i].kind == PCCD_VF &&
                              answer.pairs[i].object_a == crossing->object &&
                              answer.pairs[i].feature_a == vertex &&
                              answer.pairs[i].object_b == crossing->floor);
        }
        assert_true(found);
    }
    pccd_answer_release(client, &answer);
#undef STEP
}

/* If it failed, answers would depend on how many threads there are. */
CASE_CROSSING(step__threads_do_not_change_the_hash)
{
    struct test_crossing *crossing = *state;
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = 1};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct test_grid grid;
    uint64_t hash[2][2] = {{0, 0}, {0, 0}};

    assert_ok(test_grid_make(crossing->client, 50, &grid));
    for (uint32_t i = 0; i < 8; i++) {
        settings.threads = 1 + i / 2;
        assert_ok(test_grid_turn(&grid, &settings, &answer));
        assert_true(test_grid_is_right(&grid, &answer));
        if (i < 2) {
            memcpy(hash[i], answer.hash, sizeof hash[i]);
        }
        assert_memory_equal(hash[i % 2], answer.hash, sizeof answer.hash);
        pccd_answer_release(grid.client, &answer);
    }
    test_grid_free(&grid);
}

CASES_WITH(test_shared_start, test_shared_stop);
