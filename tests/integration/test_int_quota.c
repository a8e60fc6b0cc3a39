/* test_int_quota.c - the quota of the engine's memory, and the bound of all users. */
#include "cases.h"

#include <grp.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "farm.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "raw.h"

#define FLOORS   200u
#define SIDE     40u
#define CONTACTS (FLOORS * SIDE * SIDE)

/* A grid that falls through a stack of floors: little geometry, many contacts. */
struct stack {
    struct test_grid grid;
    uint32_t floors;
};

static int make_stack(struct pccd_client *client, struct stack *stack)
{
    static float x[3 * FLOORS][3];
    static uint32_t triangles[FLOORS][3];
    uint32_t mesh = 0;

    for (uint32_t i = 0; i < 3 * FLOORS; i++) {
        x[i][0] = test_floor_x[i % 3][0];
        x[i][1] = test_floor_x[i % 3][1];
        x[i][2] = -0.5f + (float)(i / 3 + 1) / (float)(FLOORS + 2);
        triangles[i / 3][i % 3] = i;
    }
    if (test_grid_make(client, SIDE, &stack->grid) != 0 ||
        pccd_scene_remove(client, stack->grid.scene, stack->grid.floor) != 0 ||
        pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3 * FLOORS,
                         (const uint32_t(*)[3])triangles, FLOORS, &mesh, NULL) != 0) {
        return -1;
    }
    return pccd_scene_add(client, stack->grid.scene, mesh, &stack->floors);
}

/* A turn through all floors. Returns a status. */
static int fall(struct stack *stack, struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status = test_grid_submit(&stack->grid, NULL, &step);

    return status != 0 ? status : pccd_wait(stack->grid.client, step, 60000, answer);
}

/* If it failed, the records of answers would be memory that nobody is charged for: a few
 * triangles are enough to fill the machine. */
CASE_DAEMON(memory__of_answers_is_bounded, "--memory-max-mib", "24")
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct stack stack;
    uint64_t before;

    struct pccd_client *client = test_client_at(test_own.url);
    before = test_stat(client, "engine_bytes_now");
    assert_int_equal(make_stack(client, &stack), 0);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(fall(&stack, &answer), 0);
        assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        assert_true(answer.total < CONTACTS);
        pccd_answer_release(client, &answer);
        assert_true(test_stat(client, "engine_bytes_now") <= before + (24u << 20));
    }
    assert_ok(pccd_scene_destroy(client, stack.grid.scene));
    pccd_close(client);
    test_grid_free(&stack.grid);
    client = test_client_at(test_own.url);
    assert_int_equal(test_stat_await(client, "engine_bytes_now", before), before);
    pccd_close(client);
}

/* If it failed, the quota would refuse what fits, or cut an answer without need. */
CASE_DAEMON(memory__within_the_quota_answers_are_whole, "--memory-max-mib", "256")
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct stack stack;

    struct pccd_client *client = test_client_at(test_own.url);
    assert_int_equal(make_stack(client, &stack), 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(fall(&stack, &answer), 0);
        assert_int_equal(answer.total, CONTACTS);
        assert_int_equal(answer.counts[PCCD_VF], CONTACTS);
        assert_int_not_equal(answer.incomplete, PCCD_INCOMPLETE_CONTACT_LIMIT);
        pccd_answer_release(client, &answer);
    }
    pccd_close(client);
    test_grid_free(&stack.grid);
}

/* If it failed, a mesh could take what its user may not have, or its refusal break what
 * is there, or stay for ever. */
CASE_DAEMON(memory__of_meshes_and_hierarchies_is_bounded, "--memory-max-mib", "16")
{
    struct pccd_client *client;
    struct test_crossing crossing;
    struct test_grid grid;

    struct pccd_client *other = test_client_at(test_own.url);
    client = test_client_at(test_own.url);
    assert_ok(test_crossing_make(other, &crossing));
    assert_true(test_crossing_turn(&crossing));
    assert_true(test_crossing_turn(&crossing));
    for (int i = 0; i < 3; i++) {
        uint64_t step = 0;
        int status = test_grid_make(client, 300, &grid); /* 178 802 triangles */

        if (status == 0) {
            struct pccd_answer answer = PCCD_ANSWER_INIT;

            status = test_grid_submit(&grid, NULL, &step);
            status = status != 0 ? status : pccd_wait(client, step, 60000, &answer);
        }
        assert_int_equal(status, PCCD_E_QUOTA);
        assert_non_null(strstr(pccd_error_text(client), "engine's memory"));
        assert_true(test_crossing_turn(&crossing));
        test_grid_free(&grid);
        pccd_close(client);
        client = test_client_at(test_own.url);
    }
    /* Everything of the refused ones has been given back. */
    assert_int_equal(test_stat_await(other, "meshes_now", 2), 2);
    assert_ok(test_grid_make(client, 30, &grid));
    test_grid_free(&grid);
    pccd_close(client);
    pccd_close(other);
}

/* ---- objects of one mesh ----------------------------------------------------------- */

/* If it failed, a batch of many scenes would meet the quota of triangles, though all of
 * them have one mesh; or a mesh more than that quota would be let in. */
CASE_DAEMON(objects__share_the_triangles_of_their_mesh, "--triangles-max", "19")
{
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm;
    uint32_t mesh = 0;

    struct pccd_client *client = test_client_at(test_own.url);
    assert_ok(test_farm_make(client, 50, 4, &farm)); /* 18 triangles and 1 */
    assert_ok(test_farm_turn(&farm, 1, NULL, &answer));
    assert_int_equal(answer.failed, 0);
    pccd_batch_release(client, &answer);
    assert_int_equal(test_stat(client, "triangles_now"), 19);
    assert_int_equal(pccd_mesh_create(client, test_triangle_x, PCCD_FORMAT_F32, 3,
                                      test_triangle, 1, &mesh, NULL),
                     PCCD_E_QUOTA);
    assert_non_null(strstr(pccd_error_text(client), "triangles"));
    test_farm_free(&farm);
    pccd_close(client);
}

/* Add objects of a mesh to a scene each, until there may be no more; how many. */
static uint32_t fill_scenes(struct pccd_client *client, uint32_t mesh, uint32_t *scenes,
                            uint32_t most)
{
    uint32_t count = 0;
    uint32_t object = 0;

    for (; count < most; count++) {
        int status = pccd_scene_create(client, NULL, &scenes[count]);
        if (status == 0) {
            status = pccd_scene_add(client, scenes[count], mesh, &object);
            if (status != 0) {
                assert_ok(pccd_scene_destroy(client, scenes[count]));
            }
        }
        if (status != 0) {
            assert_int_equal(status, PCCD_E_QUOTA);
            assert_non_null(strstr(pccd_error_text(client), "--memory-max-mib"));
            return count;
        }
    }
    return count;
}

/* If it failed, objects, which cost no triangles, would cost nothing: one mesh would do
 * to take all the memory of the machine; or what they took would be gone for ever. */
CASE_DAEMON(objects__cost_the_memory_that_they_take, "--memory-max-mib", "16")
{
    enum { MIB = 16, MOST = 4000 };
    static uint32_t scenes[MOST];
    struct pccd_client *client;
    struct test_farm farm;
    uint64_t before = 0;
    uint32_t most[2];

    client = test_client_at(test_own.url);
    assert_ok(test_farm_make(client, 1, 24, &farm));
    for (int i = 0; i < 2; i++) {
        most[i] = fill_scenes(client, farm.mesh, scenes, MOST);
        /* Two ends of 576 vertices are 27 KB. */
        assert_in_range(most[i], 100, (MIB << 20) / (2 * 576 * 24));
        assert_true(test_stat(client, "engine_bytes_now") <= MIB << 20);
        assert_int_equal(test_farm_alone(&farm, 0, (uint32_t)i, NULL,
                                         &(struct pccd_answer)PCCD_ANSWER_INIT),
                         PCCD_E_QUOTA);
        for (uint32_t k = 0; k < most[i]; k++) {
            assert_ok(pccd_scene_destroy(client, scenes[k]));
        }
        assert_int_equal(test_stat_await(client, "scenes_now", 1), 1);
        before = i == 0 ? test_stat(client, "engine_bytes_now") : before;
        assert_int_equal(test_stat_await(client, "engine_bytes_now", before), before);
    }
    assert_int_equal(most[0], most[1]);
    test_farm_free(&farm);
    pccd_close(client);
}

#define RING_MIB 60u

/* In a child, as another user where that can be: take a ring of RING_MIB, and stay. */
static void take_ring(const struct test_daemon *daemon, int told)
{
    static struct test_raw raw;

    test_end_with_parent();
    if (geteuid() == 0 && (setgroups(0, NULL) != 0 || setuid(65534) != 0)) {
        _exit(1);
    }
    test_end_with_parent();
    if (test_raw_open(&raw, daemon->socket) && test_raw_hello(&raw) == 0 &&
        test_raw_attach(&raw, 1, RING_MIB << 20) == 0 && write(told, "1", 1) == 1) {
        (void)pause();
    }
    _exit(1);
}

/* If it failed, users who each keep to their quotas could together take all the memory
 * that the machine has. */
CASE_DAEMON(memory__of_all_users_is_bounded, "--memory-total-mib", "96", "--allow-uid",
            "65534")
{
    static struct test_raw raw;
    struct test_grid grid;
    struct test_crossing crossing;
    uint64_t max_mib;
    char text[64];
    int told[2];
    char byte;

    assert_int_equal(chmod(test_own.directory, 0755), 0);
    assert_int_equal(pipe(told), 0);
    pid_t child = fork();
    if (child == 0) {
        take_ring(&test_own, told[1]);
    }
    assert_int_equal(read(told[0], &byte, 1), 1);
    assert_ok(test_raw_session(&raw, test_own.socket, 0, 0));
    assert_int_equal(test_raw_attach(&raw, 1, RING_MIB << 20), PCCD_E_QUOTA);
    assert_non_null(strstr(raw.error.text, "all users have "));
    assert_non_null(strstr(raw.error.text, "the bound of 96 MiB"));
    assert_non_null(strstr(raw.error.text, "--memory-total-mib"));

    /* The engine's memory counts, too: what is shared leaves less for it. */
    struct proto_CONFIG_SET_request more = {.name = "memory-total-mib", .value = "256"};
    assert_ok(test_raw_call(&raw, PROTO_METHOD_CONFIG_SET, &more, NULL));
    struct pccd_client *client = test_connect(test_own.url);
    assert_non_null(client);
    assert_int_equal(test_stat(client, "memory_bytes_max"), 256u << 20);
    assert_int_equal(test_stat(client, "memory_refusals"), 1);
    assert_ok(test_crossing_make(client, &crossing));
    assert_true(test_crossing_turn(&crossing)); /* its ring is there */
    max_mib = (test_stat(client, "shm_bytes_now") >> 20) + 12;
    (void)snprintf(text, sizeof text, "%llu", (unsigned long long)max_mib);
    assert_ok(pccd_config_set(client, "memory-total-mib", text));
    int status = test_grid_make(client, 300, &grid); /* 178 802 triangles */
    if (status == 0) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t step = 0;

        status = test_grid_submit(&grid, NULL, &step);
        status = status != 0 ? status : pccd_wait(client, step, 60000, &answer);
    }
    assert_int_equal(status, PCCD_E_QUOTA);
    (void)snprintf(text, sizeof text, "the bound of %llu MiB",
                   (unsigned long long)max_mib);
    assert_non_null(strstr(pccd_error_text(client), text));
    assert_true(test_crossing_turn(&crossing)); /* others go on */
    assert_true(test_stat(client, "memory_refusals") > 1);
    assert_true(test_stat(client, "engine_bytes_now") +
                    test_stat(client, "shm_bytes_now") <=
                max_mib << 20);
    test_grid_free(&grid);
    pccd_close(client);
    (void)strcpy(more.value, "400");
    assert_ok(test_raw_call(&raw, PROTO_METHOD_CONFIG_SET, &more, NULL));
    assert_ok(test_raw_attach(&raw, 1, RING_MIB << 20));
    test_raw_close(&raw);
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, NULL, 0), child);
    (void)close(told[0]);
    (void)close(told[1]);
}

#define MESHES           2000u
#define MESH_BYTES_LEAST 200u /* of one that was only announced */

/* If it failed, meshes that are only announced would be memory that nobody is charged
 * for. */
CASE_DAEMON(meshes__cost_memory_before_they_are_filled, "--memory-max-mib", "8")
{
    const struct proto_MESH_CREATE_request create = {.vertex_count = 3,
                                                     .triangle_count = 1};
    static struct test_raw raw;
    struct pccd_client *client;
    uint32_t meshes = 0;
    uint64_t before;

    client = test_client_at(test_own.url);
    before = test_stat(client, "engine_bytes_now");
    assert_ok(test_raw_session(&raw, test_own.socket, 0, 0));
    for (; meshes < MESHES; meshes++) {
        assert_ok(test_raw_call(&raw, PROTO_METHOD_MESH_CREATE, &create, NULL));
    }
    assert_true(test_stat(client, "engine_bytes_now") >=
                before + MESHES * MESH_BYTES_LEAST);
    while (test_raw_call(&raw, PROTO_METHOD_MESH_CREATE, &create, NULL) == 0) {
        meshes++;
        assert_true(meshes < (8u << 20) / MESH_BYTES_LEAST);
    }
    assert_int_equal(raw.error.code, PCCD_E_QUOTA);
    test_raw_close(&raw);
    assert_int_equal(test_stat_await(client, "engine_bytes_now", before), before);
    pccd_close(client);
}

/* ---- what nobody was given --------------------------------------------------------- */

#define SLOT_BYTES (4u << 20)
#define SLOTS      4u

/* A ring of which one slot of four has memory, and no record was written. */
static void attach_sparsely(struct test_raw *raw, const char *socket)
{
    const struct proto_SHM_ATTACH_request request = {.slot_count = SLOTS,
                                                     .slot_bytes = SLOT_BYTES,
                                                     .result_bytes = SLOT_BYTES,
                                                     .slots_now = 1};

    assert_ok(test_raw_session(raw, socket, 0, 0));
    assert_ok(test_raw_attach_as(raw, &request));
}

/* Write to slots that it was not given, and read where no record is. */
static void stray(const struct test_raw *raw)
{
    const volatile uint8_t *results = raw->result.base;
    volatile uint8_t sum = 0;

    for (uint32_t slot = 1; slot < SLOTS; slot++) {
        memset(test_raw_payload(raw, slot), 1, SLOT_BYTES);
    }
    for (uint32_t i = 0; i < SLOT_BYTES; i += PROTO_SHM_PAGE) {
        sum = (uint8_t)(sum + results[i]);
    }
}

static uint64_t held_by(const struct test_raw *raw)
{
    return proto_memory_held(&raw->upload) + proto_memory_held(&raw->result);
}

/* If it failed, clients could take as much memory as their rings are large, all together
 * many times a quota, and nobody would be charged. */
CASE_DAEMON(memory__that_nobody_was_given_is_charged_and_freed, NULL)
{
    static struct test_raw raw;
    uint64_t before;
    uint64_t most = 0;

    struct pccd_client *client = test_client_at(test_own.url);
    attach_sparsely(&raw, test_own.socket);
    before = test_stat(client, "shm_bytes_now");
    assert_in_range(held_by(&raw), SLOT_BYTES, before);
    stray(&raw);
    assert_true(held_by(&raw) >= before + (SLOTS - 1) * SLOT_BYTES);
    for (int i = 0; i < 1000 && (most <= before || held_by(&raw) > before); i++) {
        uint64_t now = test_stat(client, "shm_bytes_now");
        most = now > most ? now : most;
        test_sleep_ms(10);
    }
    assert_true(most >= before + (SLOTS - 1) * SLOT_BYTES);
    assert_in_range(held_by(&raw), SLOT_BYTES, before);
    assert_int_equal(test_stat_await(client, "shm_bytes_now", before), before);
    test_raw_close(&raw);
    pccd_close(client);
}

/* If it failed, a client could go on to take what its user's quota does not bear. */
CASE_DAEMON(memory__that_the_quota_does_not_bear_ends_the_session, "--shm-max-mib", "24")
{
    static struct test_raw raw[2];
    int status = PCCD_E_TIMEOUT;

    attach_sparsely(&raw[0], test_own.socket);
    attach_sparsely(&raw[1], test_own.socket);
    test_raw_wait_ms = 20;
    for (int i = 0; i < 1000 && status == PCCD_E_TIMEOUT; i++) {
        stray(&raw[0]);
        stray(&raw[1]);
        status = test_raw_receive(&raw[0]);
        status = status == PCCD_E_TIMEOUT ? test_raw_receive(&raw[1]) : status;
    }
    test_raw_wait_ms = 10000;
    assert_int_equal(status, 0);
    test_raw_close(&raw[0]);
    test_raw_close(&raw[1]);
}
