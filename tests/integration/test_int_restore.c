/* test_int_restore.c - what another daemon is told, and daemons that end meanwhile. */
#include "cases.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "farm.h"
#include "must.h"
#include "raw.h"

#define CROSSINGS 8u

static struct test_daemon daemon_;
static struct test_crossing crossings[CROSSINGS];

/* A supervised daemon whose queue holds `queue` requests. */
static void start(const char *queue)
{
    const char *const options[] = {"--supervise", "--threads",   "1",   "--crashes-max",
                                   "1000",        "--queue-max", queue, NULL};

    assert_true(test_daemon_start(&daemon_, options));
}

static void finish(struct pccd_client *client)
{
    pccd_close(client);
    (void)test_daemon_end(&daemon_, SIGTERM, 10000);
    (void)test_daemon_finish(&daemon_);
}

static struct pccd_client *connect_with(uint32_t slots, uint64_t slot_bytes)
{
    return test_client(&(struct pccd_options){
        .url = daemon_.url, .slot_count = slots, .slot_bytes = slot_bytes});
}

static void make_crossings(struct pccd_client *client)
{
    for (unsigned i = 0; i < CROSSINGS; i++) {
        assert_ok(test_crossing_make(client, &crossings[i]));
    }
    /* Meshes without a name, of which objects are left, are told in another way. */
    assert_ok(pccd_mesh_destroy(client, crossings[1].mesh));
    assert_ok(pccd_mesh_destroy(client, crossings[2].floor_mesh));
}

static void turn_crossings(void)
{
    for (unsigned i = 0; i < CROSSINGS; i++) {
        assert_true(test_crossing_turn(&crossings[i]));
    }
}

/* If requests that are sent one behind the other mixed their slots, handles or order, a
 * scene would come back wrong, or not at all. */
CASE(restore__brings_many_meshes_back_through_any_ring)
{
    static const uint32_t slots[] = {1, 3, 16};

    start("4096");
    for (size_t i = 0; i < sizeof slots / sizeof slots[0]; i++) {
        struct pccd_client *client = connect_with(slots[i], 4096);

        make_crossings(client);
        for (uint64_t round = 1; round <= 3; round++) {
            turn_crossings();
            assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
            turn_crossings();
            assert_int_equal(test_link(client).reconnects, round);
        }
        pccd_close(client);
    }
    finish(NULL);
}

/* The same where the queue has room for one request, and what is left of a session that
 * was made by half may be that one: what is refused has not been begun. */
static void turn_despite_refusals(void)
{
    for (unsigned i = 0; i < CROSSINGS; i++) {
        struct test_crossing *crossing = &crossings[i];
        uint64_t until_ms = test_now_ms() + 10000;
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        float x1[3][3];
        int status;

        test_crossing_positions(x1, -crossing->z);
        do {
            status = test_crossing_step(crossing, x1, NULL, &answer);
        } while (status == PCCD_E_BUSY && test_now_ms() < until_ms);
        assert_int_equal(status, 0);
        crossing->z = -crossing->z;
        assert_true(test_crossing_is_right(crossing, &answer));
    }
}

/* If a refusal for want of room ended it, clients that come back all at once would be
 * lost; if what was refused were left out, they would go on with half a scene. */
CASE(restore__goes_on_after_a_refusal_for_want_of_room)
{
    struct pccd_client *client;

    start("1");
    client = connect_with(4, 4096);
    make_crossings(client);
    for (uint64_t round = 1; round <= 5; round++) {
        turn_despite_refusals();
        assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
        turn_despite_refusals();
        assert_int_equal(test_link(client).reconnects, round);
    }
    finish(client);
}

/* In a child: kill every worker some milliseconds after it has begun to serve. */
static pid_t kill_workers(const char *socket_path, unsigned least_ms, unsigned count)
{
    pid_t killer = fork();

    assert_true(killer >= 0);
    if (killer == 0) {
        for (unsigned i = 0; i < count; i++) {
            struct proto_HELLO_request hello = {.version_min = 1, .version_max = 1};
            struct proto_HELLO_result result;
            struct test_raw raw;

            while (!test_raw_open(&raw, socket_path)) {
                test_sleep_ms(1);
            }
            if (test_raw_call(&raw, PROTO_METHOD_HELLO, &hello, &result) == 0) {
                test_sleep_ms(least_ms + i % 4);
                (void)kill((pid_t)result.pid, SIGKILL);
                while (test_raw_receive(&raw) == 0) {
                    ;
                }
            }
            test_raw_close(&raw);
        }
        _exit(0);
    }
    return killer;
}

/* If a daemon that ends while it is told left anything behind, in the client or in what
 * the next one is told, scenes would be wrong later. */
CASE(restore__begins_anew_when_the_daemon_ends_meanwhile)
{
    struct pccd_client *client;

    start("4096");
    client = connect_with(2, 4096);
    make_crossings(client);
    for (unsigned round = 0; round < 4; round++) {
        pid_t killer = kill_workers(daemon_.socket, round % 2, 8);

        for (int ended = 0; ended == 0; ended = waitpid(killer, NULL, WNOHANG)) {
            turn_crossings();
        }
    }
    turn_crossings();
    assert_true(test_link(client).reconnects >= 4);
    finish(client);
}

/* If it failed, a mesh over which the daemon crashes would be sent to one daemon after
 * the other, until the supervisor gives up and all other clients are without. */
CASE(restore__gives_up_a_mesh_that_ends_every_daemon)
{
    enum { VERTICES = 600000 };
    float(*x)[3] = calloc(VERTICES, sizeof *x);
    uint32_t(*triangles)[3] = calloc(VERTICES, sizeof *triangles);
    struct pccd_client *client;
    uint32_t mesh = 0;
    pid_t killer;
    int status;

    assert_true(x != NULL && triangles != NULL);
    for (uint32_t i = 0; i < VERTICES; i++) {
        x[i][0] = (float)i;
        triangles[i][0] = i;
        triangles[i][1] = (i + 1) % VERTICES;
        triangles[i][2] = (i + 2) % VERTICES;
    }
    start("4096");
    client = connect_with(4, 4096); /* slow: thousands of chunks, always some in flight */
    killer = kill_workers(daemon_.socket, 4, 60);
    status = pccd_mesh_create(client, x, PCCD_FORMAT_F32, VERTICES, triangles, VERTICES,
                              &mesh, NULL);
    assert_int_equal(kill(killer, SIGKILL), 0);
    assert_int_equal(waitpid(killer, NULL, 0), killer);
    assert_int_equal(status, PCCD_E_DISCONNECTED);
    assert_non_null(strstr(pccd_error_text(client), "daemon after daemon"));
    assert_int_equal(mesh, 0);
    mesh = test_mesh(client, x, PCCD_FORMAT_F32, VERTICES, triangles,
                     VERTICES); /* that one is not to blame any more */
    make_crossings(client);
    turn_crossings();
    free(x);
    free(triangles);
    finish(client);
}

/* ---- batches ----------------------------------------------------------------------- */

#define WORLDS 24u

/* A turn of all worlds, over which the daemon is killed `after_us` after its request,
 * says what a turn of each of them by itself says. */
static void turn_over_a_kill(struct test_farm *farm, struct test_farm *other,
                             uint32_t turn, unsigned after_us)
{
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    uint64_t step = 0;
    uint64_t records = 0;

    /* The last daemon may have answered before it ended. */
    assert_ok(pccd_ping(farm->client, NULL));
    assert_ok(test_farm_submit(farm, turn, NULL, &step));
    usleep(after_us);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(farm->client), SIGKILL), 0);
    assert_ok(pccd_batch_wait(farm->client, step, -1, &all));
    assert_int_equal(all.failed, 0);
    for (uint32_t i = 0; i < WORLDS; i++) {
        struct pccd_answer alone = PCCD_ANSWER_INIT;

        assert_ok(test_farm_alone(other, i, turn, NULL, &alone));
        assert_memory_equal(all.scenes[i].hash, alone.hash, sizeof alone.hash);
        records += alone.total;
        pccd_answer_release(other->client, &alone);
    }
    assert_true(records > 0);
    pccd_batch_release(farm->client, &all);
}

/* If it failed, a batch that a daemon left without an answer would never have one, or one
 * of scenes that are not where they were. */
CASE(restore__answers_batches_as_if_nothing_had_happened)
{
    struct pccd_client *client, *direct = test_connect("direct:");
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct test_farm farm, other;
    void *x1[WORLDS];
    uint64_t step = 0;

    start("4096");
    client = connect_with(3, 4096);
    assert_ok(test_farm_make(client, WORLDS, 12, &farm));
    assert_ok(test_farm_make(direct, WORLDS, 12, &other));
    for (uint32_t turn = 1; turn <= 8; turn++) {
        turn_over_a_kill(&farm, &other, turn, (turn - 1) * (turn - 1) * 200);
    }
    /* A scene that fails was not moved, and the others were: so it is after a crash. */
    assert_ok(pccd_batch_begin(farm.batch, NULL, x1));
    for (uint32_t i = 0; i < WORLDS; i++) {
        test_farm_positions(&farm, i, 9, x1[i]);
    }
    ((float *)x1[5])[0] = 1e30f; /* beyond 1e18 */
    assert_ok(pccd_batch_commit(farm.batch, NULL, &step));
    assert_ok(pccd_batch_wait(client, step, -1, &all));
    assert_int_equal(all.failed, 1);
    assert_int_equal(all.scenes[5].status, PCCD_E_NOTFINITE);
    pccd_batch_release(client, &all);
    for (uint32_t i = 0; i < WORLDS; i++) {
        struct pccd_answer alone = PCCD_ANSWER_INIT;

        if (i != 5) {
            assert_ok(test_farm_alone(&other, i, 9, NULL, &alone));
            pccd_answer_release(direct, &alone);
        }
    }
    turn_over_a_kill(&farm, &other, 10, 0); /* the fifth one from 8, the others from 9 */
    assert_ok(pccd_ping(client, NULL));
    assert_int_equal(test_link(client).reconnects, 9);
    test_farm_free(&farm);
    test_farm_free(&other);
    pccd_close(direct);
    finish(client);
}

/* ---- handles whose places lie above empty ones ------------------------------------- */

#define LOSERS 1500u

static const uint32_t one_triangle[1][3] = {{0, 1, 2}};
static const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

/* If it failed, a client whose scenes have each lost a few objects would not come back
 * after a crash. */
CASE(restore__brings_back_scenes_that_have_lost_objects)
{
    static uint32_t scenes[LOSERS], left[LOSERS];
    struct pccd_client *client;

    start("4096");
    client = connect_with(4, 4096);
    uint32_t mesh = test_mesh(client, corners, PCCD_FORMAT_F32, 3, one_triangle, 1);
    for (uint32_t i = 0; i < LOSERS; i++) {
        uint32_t lost[2];

        scenes[i] = test_scene(client);
        lost[0] = test_object(client, scenes[i], mesh);
        lost[1] = test_object(client, scenes[i], mesh);
        left[i] = test_object(client, scenes[i], mesh);
        assert_ok(pccd_scene_remove(client, scenes[i], lost[0]));
        assert_ok(pccd_scene_remove(client, scenes[i], lost[1]));
    }
    assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
    for (uint32_t i = 0; i < LOSERS; i += LOSERS / 3) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;

        assert_ok(pccd_step_x1(client, scenes[i], left[i], corners, PCCD_FORMAT_F32, 3,
                               NULL, &answer));
        pccd_answer_release(client, &answer);
    }
    assert_int_equal(test_link(client).reconnects, 1);
    finish(client);
}

/* If it failed, a long recording could not be played again: after some 200 scenes that
 * had lost objects, and were destroyed, no other could be had. */
CASE(restore__wanted_places_cost_nothing_when_their_scene_is_gone)
{
    const uint32_t want = 1u << 20 | 60000u;
    struct pccd_client *client;
    uint32_t mesh;

    start("4096");
    client = connect_with(4, 4096);
    mesh = test_mesh(client, corners, PCCD_FORMAT_F32, 3, one_triangle, 1);
    for (uint32_t i = 0; i < 100; i++) {
        uint32_t scene, object;

        scene = test_scene(client);
        assert_ok(pccd_request_handle(client, want));
        object = test_object(client, scene, mesh);
        assert_int_equal(object, want);
        assert_ok(pccd_scene_destroy(client, scene));
    }
    finish(client);
}

/* ---- lists ------------------------------------------------------------------------- */

#define IGNORING 12u

struct pairs {
    uint32_t objects[IGNORING];
    uint32_t count, seen[IGNORING][IGNORING];
};

static void see_pair(void *context, const struct pccd_ignored_pair *pair)
{
    struct pairs *pairs = context;

    pairs->count++;
    for (uint32_t a = 0; a < IGNORING; a++) {
        for (uint32_t b = 0; b < IGNORING; b++) {
            pairs->seen[a][b] += pair->object_a == pairs->objects[a] &&
                                 pair->object_b == pairs->objects[b];
        }
    }
}

/* If it failed, a list that is read while the daemon is replaced would have entries twice
 * and lack others. */
CASE(restore__lists_are_those_of_one_daemon)
{
    const uint32_t all = IGNORING * (IGNORING - 1) / 2;
    static struct pairs pairs;
    struct pccd_client *client;
    uint32_t scene, mesh;
    pid_t killer = 0;

    start("4096");
    client = connect_with(4, 4096);
    mesh = test_mesh(client, corners, PCCD_FORMAT_F32, 3, one_triangle, 1);
    scene = test_scene(client);
    for (uint32_t a = 0; a < IGNORING; a++) {
        pairs.objects[a] = test_object(client, scene, mesh);
    }
    for (uint32_t n = 0; n < IGNORING * IGNORING; n++) { /* in no order */
        uint32_t a = n * 29 % (IGNORING * IGNORING) / IGNORING;
        uint32_t b = n * 29 % IGNORING;

        if (a < b) {
            assert_ok(pccd_pair_ignore(client, scene, pairs.objects[a], pairs.objects[b],
                                       true));
        }
    }
    /* A busy machine lets us see few of the daemons that are killed. */
    for (int round = 0; round < 8 && test_link(client).reconnects <= 2;) {
        uint32_t once = 0;

        if (killer == 0) {
            killer = kill_workers(daemon_.socket, 10, 12);
        }

        pairs.count = 0;
        memset(pairs.seen, 0, sizeof pairs.seen);
        assert_ok(pccd_list_pairs(client, 0, scene, see_pair, &pairs));
        for (uint32_t n = 0; n < IGNORING * IGNORING; n++) {
            uint32_t a = n / IGNORING, b = n % IGNORING;

            once += a < b && pairs.seen[a][b] + pairs.seen[b][a] == 1;
        }
        assert_int_equal(pairs.count, all);
        assert_int_equal(once, all);
        if (waitpid(killer, NULL, WNOHANG) == killer) {
            killer = 0;
            round++;
        }
    }
    if (killer != 0) {
        assert_int_equal(waitpid(killer, NULL, 0), killer);
    }
    assert_true(test_link(client).reconnects > 2);
    finish(client);
}
