/* test_int_replace.c - meshes that change their topology while they are in use. */
#include "cases.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "witness.h"

#define SIDE      16u
#define TRIANGLES (2 * (SIDE - 1) * (SIDE - 1))
#define CORNERS   (3 * TRIANGLES)

static struct test_raw raw;

/* ---- a body that breaks ------------------------------------------------------------ */

/* The grid in pieces: every triangle has vertices of its own, a little nearer to its
 * middle than they were, so that no piece touches another. */
struct pieces {
    float x[CORNERS][3];
    uint32_t triangles[TRIANGLES][3];
};

static void break_grid(struct test_grid *grid, float z, struct pieces *pieces)
{
    uint32_t(*whole)[3] = test_grid_triangles(grid);

    assert_non_null(whole);
    test_grid_positions(grid, z);
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        for (uint32_t corner = 0; corner < 3; corner++) {
            for (uint32_t axis = 0; axis < 3; axis++) {
                float middle = (grid->x[whole[i][0]][axis] + grid->x[whole[i][1]][axis] +
                                grid->x[whole[i][2]][axis]) /
                               3.0f;
                float at = grid->x[whole[i][corner]][axis];

                pieces->x[3 * i + corner][axis] = middle + 0.75f * (at - middle);
            }
            pieces->triangles[i][corner] = 3 * i + corner;
        }
    }
    free(whole);
}

/* Move an object of pieces to height z, through the floor: each corner meets it once. */
static void move_pieces(struct test_grid *grid, uint32_t object, float z,
                        struct pccd_answer *answer)
{
    static struct pieces pieces;

    break_grid(grid, z, &pieces);
    assert_ok(pccd_step_x1(grid->client, grid->scene, object, pieces.x, PCCD_FORMAT_F32,
                           CORNERS, NULL, answer));
    assert_int_equal(answer->incomplete, PCCD_COMPLETE);
    assert_int_equal(answer->total, CORNERS);
    assert_int_equal(answer->counts[PCCD_VF], CORNERS);
    pccd_answer_release(grid->client, answer);
}

static int break_mesh(struct test_grid *grid, struct pccd_mesh_info *info)
{
    static struct pieces pieces;

    break_grid(grid, 1, &pieces);
    return pccd_mesh_replace(grid->client, grid->mesh, pieces.x, PCCD_FORMAT_F32, CORNERS,
                             (const uint32_t(*)[3])pieces.triangles, TRIANGLES, info);
}

/* A session in which the floor and the pieces are registered as they are from the start:
 * the same requests give the same handles in every session, so hashes can be compared. */
static void open_fresh(struct test_grid *grid)
{
    static struct pieces pieces;
    struct pccd_client *client = test_client_at(test_witness.daemon.url);

    *grid = (struct test_grid){.client = client,
                               .side = SIDE,
                               .vertex_count = SIDE * SIDE,
                               .x = calloc((size_t)SIDE * SIDE, sizeof *grid->x)};
    assert_non_null(grid->x);
    break_grid(grid, 1, &pieces);
    grid->scene = test_scene(client);
    uint32_t floor_mesh =
        test_mesh(client, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    grid->floor = test_object(client, grid->scene, floor_mesh);
    grid->mesh = test_mesh(client, pieces.x, PCCD_FORMAT_F32, CORNERS, pieces.triangles,
                           TRIANGLES);
    grid->object = test_object(client, grid->scene, grid->mesh);
}

/* If it failed, a broken body would answer otherwise than one registered so, or breaking
 * it disturb somebody else. */
CASE(replace__a_broken_body_answers_as_a_fresh_one)
{
    struct test_grid grid;
    struct test_grid fresh;
    struct pccd_mesh_info info;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_answer expected = PCCD_ANSWER_INIT;

    test_grid_open(&grid, test_witness.daemon.url, SIDE);
    open_fresh(&fresh);
    assert_int_equal(fresh.object, grid.object);
    for (int i = 0; i < 3; i++) {
        test_grid_pass(&grid);
        test_witness_turn();
    }
    assert_ok(break_mesh(&grid, &info));
    assert_int_equal(info.generation, 2);
    assert_int_equal(info.vertex_count, CORNERS);
    assert_int_equal(info.edge_count, CORNERS);
    for (int i = 0; i < 4; i++) {
        float z = i % 2 == 0 ? -1.0f : 1.0f;

        move_pieces(&grid, grid.object, z, &answer);
        move_pieces(&fresh, fresh.object, z, &expected);
        assert_memory_equal(answer.hash, expected.hash, sizeof answer.hash);
        test_witness_turn();
    }
    /* Whole again, and broken again. */
    assert_ok(test_grid_replace(&grid));
    test_grid_pass(&grid);
    assert_ok(break_mesh(&grid, &info));
    assert_int_equal(info.generation, 4);
    move_pieces(&grid, grid.object, -1, &answer);
    test_witness_turn();
    test_grid_close(&fresh);
    test_grid_close(&grid);
}

/* If it failed, an object made of the mesh would be forgotten, or one that is not
 * changed. */
CASE(replace__reaches_every_object_made_of_the_mesh)
{
    enum { SCENES = 3 };
    struct test_grid grid;
    struct test_grid scenes[SCENES];
    struct test_grid other;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t before;
    uint64_t replaced = test_stat(test_witness.crossing.client, "meshes_replaced");
    uint32_t gone = 0;

    /* The floor and the triangle of the witness: others are gone then. */
    before = test_stat_await(test_witness.crossing.client, "triangles_now", 2);
    assert_int_equal(before, 2);
    test_grid_open(&grid, test_witness.daemon.url, SIDE);
    assert_ok(test_grid_make(grid.client, SIDE, &other));
    gone = test_object(grid.client, grid.scene, grid.mesh);
    for (int i = 0; i < SCENES; i++) {
        scenes[i] = grid;
        scenes[i].scene = test_scene(grid.client);
        scenes[i].object = test_object(grid.client, scenes[i].scene, grid.mesh);
    }
    assert_ok(pccd_scene_remove(grid.client, grid.scene, gone));
    assert_ok(pccd_scene_destroy(grid.client, scenes[2].scene));
    assert_ok(break_mesh(&grid, NULL));
    assert_int_equal(test_stat(grid.client, "meshes_replaced"), replaced + 1);
    move_pieces(&grid, grid.object, -1, &answer);
    for (int i = 0; i < 2; i++) { /* no floor here: still, but all there */
        static struct pieces pieces;

        break_grid(&grid, 3, &pieces);
        assert_ok(pccd_step_x1(grid.client, scenes[i].scene, scenes[i].object, pieces.x,
                               PCCD_FORMAT_F32, CORNERS, NULL, &answer));
        pccd_answer_release(grid.client, &answer);
    }
    test_grid_pass(&other);
    /* Every object goes, under the charge that it has now. */
    test_grid_close(&grid);
    test_grid_free(&other);
    assert_int_equal(
        test_stat_await(test_witness.crossing.client, "triangles_now", before), before);
    test_witness_turn();
}

/* If it failed, data that is refused would leave a mesh between two shapes. */
CASE(replace__bad_data_leaves_the_old_mesh)
{
    static struct pieces pieces;
    struct test_grid grid;
    uint64_t triangles;
    uint64_t meshes;

    test_grid_open(&grid, test_witness.daemon.url, SIDE);
    test_grid_pass(&grid);
    triangles = test_stat(grid.client, "triangles_now");
    meshes = test_stat(grid.client, "meshes_now");
#define REFUSED(code, vertex_count, triangle_count)                                      \
    assert_int_equal(pccd_mesh_replace(grid.client, grid.mesh, pieces.x,                 \
                                       PCCD_FORMAT_F32, vertex_count,                    \
                                       (const uint32_t(*)[3])pieces.triangles,           \
                                       triangle_count, NULL),                            \
                     code);                                                              \
    assert_true(pccd_error_text(grid.client)[0] != '\0');                                \
    test_grid_pass(&grid)
    break_grid(&grid, 1, &pieces);
    pieces.triangles[TRIANGLES - 1][2] = CORNERS;
    REFUSED(PCCD_E_INDEX, CORNERS, TRIANGLES);
    pieces.triangles[TRIANGLES - 1][2] = 0;
    pieces.x[CORNERS - 1][1] = NAN;
    REFUSED(PCCD_E_NOTFINITE, CORNERS, TRIANGLES);
    REFUSED(PCCD_E_INVAL, 0, TRIANGLES);
    REFUSED(PCCD_E_INVAL, CORNERS, 0);
#undef REFUSED
    assert_int_equal(test_stat_await(grid.client, "triangles_now", triangles), triangles);
    assert_int_equal(test_stat_await(grid.client, "meshes_now", meshes), meshes);
    test_witness_turn();
    test_grid_close(&grid);
}

/* If it failed, a replacement could take more than its user may have, or one that is too
 * large break what there is. */
CASE_DAEMON(replace__without_quota_changes_nothing, "--triangles-max", "1000")
{
    /* The mesh and the floor, 450 + 1, and 450 that are announced; not 900. */
    static struct pieces pieces;
    static uint32_t doubled[2 * TRIANGLES][3];
    struct test_grid grid;

    if (test_is_direct()) {
        test_skip("with direct: there are no quotas");
    }
    struct pccd_client *client = test_client_at(test_own.url);
    assert_ok(test_grid_make(client, SIDE, &grid));
    assert_int_equal(test_stat(client, "triangles_now"), TRIANGLES + 1);
    break_grid(&grid, 1, &pieces);
    memcpy(doubled, pieces.triangles, sizeof pieces.triangles);
    memcpy(doubled + TRIANGLES, pieces.triangles, sizeof pieces.triangles);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(pccd_mesh_replace(client, grid.mesh, pieces.x, PCCD_FORMAT_F32,
                                           CORNERS, (const uint32_t(*)[3])doubled,
                                           2 * TRIANGLES, NULL),
                         PCCD_E_QUOTA);
        assert_non_null(strstr(pccd_error_text(client), "quota"));
        test_grid_pass(&grid);
        assert_int_equal(test_stat_await(client, "triangles_now", TRIANGLES + 1),
                         TRIANGLES + 1);
        assert_int_equal(test_stat_await(client, "meshes_now", 2), 2);
    }
    test_grid_close(&grid);
}

/* If it failed, a replacement that its objects have no memory for would leave some of
 * them with the old shape and some with the new one, or the memory would be gone. */
CASE_DAEMON(replace__without_memory_changes_nothing, "--memory-max-mib", "24")
{
    struct test_grid grid, large;
    struct pccd_client *client;
    uint32_t(*triangles)[3];
    uint32_t scenes[3];

    if (test_is_direct()) {
        test_skip("with direct: there are no quotas");
    }
    client = test_client_at(test_own.url);
    assert_ok(test_grid_make(client, 80, &large)); /* 12482 triangles */
    assert_ok(pccd_scene_destroy(client, large.scene));
    assert_ok(test_grid_make(client, SIDE, &grid));
    for (int i = 0; i < 3; i++) {
        scenes[i] = test_scene(client);
        for (int k = 0; k < 20; k++) {
            (void)test_object(client, scenes[i], grid.mesh);
        }
    }
    test_grid_pass(&grid);
    triangles = test_grid_triangles(&large);
    assert_non_null(triangles);
    test_grid_positions(&large, 1);
    /* 61 objects of 12482 triangles would take 0.7 MB each. */
    /* What is kept from step to step may grow twice, with what there was room for. */
    for (int i = 0; i < 3; i++) {
        uint64_t before = test_stat(client, "engine_bytes_now");
        assert_int_equal(pccd_mesh_replace(client, grid.mesh, large.x, PCCD_FORMAT_F32,
                                           large.vertex_count,
                                           (const uint32_t(*)[3])triangles, 2u * 79 * 79,
                                           NULL),
                         PCCD_E_QUOTA);
        assert_non_null(strstr(pccd_error_text(client), "engine's memory"));
        test_grid_pass(&grid);
        assert_true(test_stat(client, "engine_bytes_now") <= 24u << 20);
        if (i > 1) {
            assert_int_equal(test_stat_await(client, "engine_bytes_now", before), before);
        }
    }
    for (int i = 0; i < 3; i++) {
        assert_ok(pccd_scene_destroy(client, scenes[i]));
    }
    free(triangles);
    pccd_close(client);
    test_grid_free(&large);
    test_grid_free(&grid);
}

/* If it failed, objects would be charged triangles that are their mesh's, or a user would
 * be charged wrongly ever after. */
CASE_DAEMON(replace__charges_the_mesh_once, "--triangles-max", "901")
{
    struct test_grid grid;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    if (test_is_direct()) {
        test_skip("with direct: there are no quotas");
    }
    struct pccd_client *client = test_client_at(test_own.url);
    assert_ok(test_grid_make(client, SIDE, &grid));
    uint32_t scene = test_scene(client);
    (void)test_object(client, scene, grid.mesh);
    for (int i = 0; i < 3; i++) {
        assert_ok(break_mesh(&grid, NULL));
        move_pieces(&grid, grid.object, -1, &answer);
        assert_int_equal(test_stat_await(client, "triangles_now", TRIANGLES + 1),
                         TRIANGLES + 1);
    }
    /* By something smaller: what it is less is given back. */
    assert_ok(pccd_mesh_replace(client, grid.mesh, test_triangle_x, PCCD_FORMAT_F32, 3,
                                test_triangle, 1, NULL));
    assert_int_equal(test_stat_await(client, "triangles_now", 2), 2);
    assert_ok(pccd_scene_destroy(client, scene));
    assert_int_equal(test_stat_await(client, "triangles_now", 2), 2);
    test_grid_close(&grid);
}

/* ---- order and states, by hand ----------------------------------------------------- */

/* Two triangles, and a vertex more than they have. */
static const float two_x[7][3] = {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {0, 0, 3},
                                  {1, 0, 3}, {0, 1, 3}, {9, 9, 9}};
static const uint32_t two[2][3] = {{0, 1, 2}, {3, 4, 5}};

/* A raw session with the triangle of test_triangle_x in a scene. */
struct bare {
    uint32_t mesh;
    uint32_t scene;
    uint32_t object;
};

static void open_bare(struct bare *bare)
{
    test_witness_open_raw(&raw, 65536);
    assert_ok(test_raw_mesh(&raw, test_triangle_x, 3, test_triangle, 1, &bare->mesh));
    assert_ok(test_raw_scene(&raw, "", &bare->scene));
    assert_ok(test_raw_add(&raw, bare->scene, bare->mesh, &bare->object));
}

static int announce(uint32_t mesh, uint32_t vertex_count, uint32_t triangle_count,
                    uint32_t *generation)
{
    struct proto_MESH_REPLACE_result result = {.generation = 0};
    int status = RAW_CALL(&raw, MESH_REPLACE, &result, .mesh = mesh,
                          .vertex_count = vertex_count, .triangle_count = triangle_count);

    *generation = result.generation;
    return status;
}

static int commit(uint32_t mesh, struct proto_MESH_COMMIT_result *result)
{
    return RAW_CALL(&raw, MESH_COMMIT, result, .mesh = mesh);
}

/* Submit the end positions of `count` vertices without waiting; returns the id. */
static uint32_t submit(const struct bare *bare, uint32_t slot, const float (*x)[3],
                       uint32_t count)
{
    struct proto_FRAME_SUBMIT_request request =
        test_raw_move(&raw, slot, bare->scene, bare->object, x, count);

    request.threads = 1;
    return test_raw_request(&raw, PROTO_METHOD_FRAME_SUBMIT, &request);
}

/* If it failed, a step would run on another topology than the one it was sent for. */
CASE(replace__steps_run_on_the_topology_of_their_turn)
{
    struct proto_MESH_COMMIT_result committed;
    struct proto_FRAME_SUBMIT_result answer;
    struct bare bare;
    uint32_t generation = 0;
    uint32_t ids[4];

    open_bare(&bare);
    assert_ok(announce(bare.mesh, 6, 2, &generation));
    assert_int_equal(generation, 2);
    assert_ok(test_raw_fill(&raw, bare.mesh, two_x, 6, two, 2));
    /* The old triangle serves until the commit. */
    ids[0] = submit(&bare, 0, two_x, 6);
    assert_int_equal(test_raw_answer(&raw, ids[0], PROTO_METHOD_FRAME_SUBMIT, &answer),
                     PCCD_E_SEGMENT);
    assert_non_null(strstr(raw.error.text, "has 3 (generation 1"));
    /* Three in a row, none waited for. */
    ids[1] = submit(&bare, 0, test_triangle_x, 3);
    ids[2] = RAW_SEND(&raw, MESH_COMMIT, .mesh = bare.mesh);
    ids[3] = submit(&bare, 1, two_x, 6);
    assert_ok(test_raw_answer(&raw, ids[1], PROTO_METHOD_FRAME_SUBMIT, &answer));
    assert_ok(test_raw_answer(&raw, ids[2], PROTO_METHOD_MESH_COMMIT, &committed));
    assert_int_equal(committed.generation, 2);
    assert_int_equal(committed.triangle_count, 2);
    assert_ok(test_raw_answer(&raw, ids[3], PROTO_METHOD_FRAME_SUBMIT, &answer));
    ids[0] = submit(&bare, 0, two_x, 7);
    assert_int_equal(test_raw_answer(&raw, ids[0], PROTO_METHOD_FRAME_SUBMIT, &answer),
                     PCCD_E_SEGMENT);
    assert_non_null(strstr(raw.error.text, "has 6 (generation 2"));
    test_raw_close(&raw);
    test_witness_turn();
}

/* If it failed, a wrong order of requests would replace by something half-made, or cost
 * the client its mesh. */
CASE(replace__wrong_order_is_refused)
{
    struct proto_MESH_COMMIT_result committed;
    struct bare bare;
    struct proto_MESH_CREATE_result created;
    uint32_t generation = 0;

    open_bare(&bare);
    assert_int_equal(announce(bare.mesh + 77, 6, 2, &generation), PCCD_E_HANDLE);
    assert_int_equal(announce(0, 6, 2, &generation), PCCD_E_HANDLE);
    assert_int_equal(announce(bare.mesh, 0, 2, &generation), PCCD_E_INVAL);
    assert_int_equal(announce(bare.mesh, 6, 0, &generation), PCCD_E_INVAL);
    assert_int_equal(announce(bare.mesh, 6, 0x80000000u, &generation), PCCD_E_INVAL);
    if (!test_is_direct()) { /* where only the machine limits it */
        assert_int_equal(announce(bare.mesh, 6, PROTO_TRIANGLES_PER_UID, &generation),
                         PCCD_E_QUOTA);
    }
    assert_ok(
        RAW_CALL(&raw, MESH_CREATE, &created, .vertex_count = 3, .triangle_count = 1));
    assert_int_equal(announce(created.mesh, 6, 2, &generation), PCCD_E_STATE);
    /* Nothing was announced: it is committed already. */
    assert_int_equal(commit(bare.mesh, &committed), PCCD_E_STATE);
    /* Announced, but not all there. */
    assert_ok(announce(bare.mesh, 6, 2, &generation));
    assert_int_equal(commit(bare.mesh, &committed), PCCD_E_STATE);
    assert_non_null(strstr(raw.error.text, "0 of 6 vertices"));
    /* Announced anew: what came before counts no more. */
    assert_ok(test_raw_fill(&raw, bare.mesh, two_x, 6, two, 2));
    assert_ok(announce(bare.mesh, 5, 1, &generation));
    assert_int_equal(generation, 2);
    assert_int_equal(commit(bare.mesh, &committed), PCCD_E_STATE);
    assert_non_null(strstr(raw.error.text, "0 of 5 vertices"));
    /* Forgotten, twice: the triangle is what it was. */
    for (int i = 0; i < 2; i++) {
        assert_ok(announce(bare.mesh, 0, 0, &generation));
        assert_int_equal(generation, 1);
    }
    assert_int_equal(commit(bare.mesh, &committed), PCCD_E_STATE);
    assert_ok(test_raw_answer(&raw, submit(&bare, 0, test_triangle_x, 3),
                              PROTO_METHOD_FRAME_SUBMIT, NULL));
    test_raw_close(&raw);
    test_witness_turn();
}

/* If it failed, a request could meet a mesh of which nobody knows yet what it is. */
CASE(replace__mesh_is_busy_while_it_is_committed)
{
    struct proto_MESH_COMMIT_result committed;
    struct bare bare;
    uint32_t generation = 0;
    uint32_t step, id, object;

    if (test_is_direct()) {
        test_skip("with direct: nothing comes between");
    }
    open_bare(&bare);
    assert_ok(announce(bare.mesh, 6, 2, &generation));
    assert_ok(test_raw_fill(&raw, bare.mesh, two_x, 6, two, 2));
    step = test_witness_long_step(&raw);
    id = RAW_SEND(&raw, MESH_COMMIT, .mesh = bare.mesh);
    assert_int_not_equal(id, 0);
    assert_int_equal(RAW_CALL(&raw, MESH_DESTROY, NULL, .mesh = bare.mesh), PCCD_E_BUSY);
    assert_int_equal(test_raw_add(&raw, bare.scene, bare.mesh, &object), PCCD_E_BUSY);
    assert_int_equal(announce(bare.mesh, 3, 1, &generation), PCCD_E_BUSY);
    assert_int_equal(commit(bare.mesh, &committed), PCCD_E_BUSY);
    /* Taken back before it ran: nothing has happened, and it can be asked for again. */
    assert_int_not_equal(RAW_SEND(&raw, CANCEL, .id = id), 0);
    assert_int_equal(test_raw_answer(&raw, id, PROTO_METHOD_MESH_COMMIT, &committed),
                     PCCD_E_CANCELLED);
    assert_int_not_equal(RAW_SEND(&raw, CANCEL, .id = step), 0);
    assert_ok(commit(bare.mesh, &committed));
    assert_int_equal(committed.generation, 2);
    assert_ok(test_raw_add(&raw, bare.scene, bare.mesh, &object));
    assert_ok(RAW_CALL(&raw, MESH_DESTROY, NULL, .mesh = bare.mesh));
    test_raw_close(&raw);
    test_witness_turn();
}

CASES_WITH(test_witness_start, test_witness_stop);
