/* test_int_room.c - what a session that waits for its client holds of its user's
 * quotas. */
#include "cases.h"

#include <unistd.h>

#include "daemon.h"
#include "raw.h"

#define WAIT_MS   10000u
#define SIDE      96u
#define VERTICES  (SIDE * SIDE)
#define TRIANGLES (2 * (SIDE - 1) * (SIDE - 1))

/* Two clients of one user: one that can come back, and one that asks. */
struct fixture {
    struct test_daemon daemon;
    struct test_raw first;
    struct test_raw second;
    struct proto_HELLO_result session; /* of the first */
};

static struct fixture fixture;
static float x[VERTICES][3];
static uint32_t triangles[TRIANGLES][3];

static void make_grid(void)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < VERTICES; i++) {
        x[i][0] = (float)(i % SIDE);
        x[i][1] = (float)(i / SIDE);
    }
    for (uint32_t i = 0; i < VERTICES - SIDE; i++) {
        if (i % SIDE != SIDE - 1) {
            const uint32_t corners[2][3] = {{i, i + 1, i + SIDE},
                                            {i + 1, i + SIDE + 1, i + SIDE}};
            for (uint32_t k = 0; k < 6; k++) {
                triangles[count + k / 3][k % 3] = corners[k / 3][k % 3];
            }
            count += 2;
        }
    }
    assert_int_equal(count, TRIANGLES);
}

static int hello(bool again)
{
    return test_raw_hello_again(&fixture.first, again ? &fixture.session : NULL,
                                &fixture.session);
}

static void open_second(void)
{
    assert_ok(test_raw_session(&fixture.second, fixture.daemon.socket, 0, 0));
}

/* A daemon that has all the patience in the world, and both clients. */
static void open_both(const char *option, const char *value)
{
    const char *options[] = {"--threads", "1", "--linger", "600", option, value, NULL};
    assert_true(test_daemon_start(&fixture.daemon, options));
    assert_true(test_raw_open(&fixture.first, fixture.daemon.socket));
    assert_int_equal(hello(false), 0);
    open_second();
}

/* Until the daemon has seen it. */
static void lose_first(void)
{
    struct proto_STATS_result stats;
    uint64_t until_ms = test_now_ms() + WAIT_MS;
    (void)close(fixture.first.socket);
    fixture.first.socket = -1;
    do {
        assert_ok(RAW_CALL(&fixture.second, STATS, &stats, .reserved = 0));
    } while (stats.sessions_waiting_now == 0 && test_now_ms() < until_ms);
    assert_int_equal(stats.sessions_waiting_now, 1);
}

/* Return whether the first client finds its session as it was. */
static bool first_comes_back(void)
{
    assert_true(test_raw_reopen(&fixture.first, fixture.daemon.socket));
    assert_int_equal(hello(true), 0);
    return fixture.session.resumed;
}

static void close_both(void)
{
    test_raw_close(&fixture.first);
    test_raw_close(&fixture.second);
    assert_true(test_daemon_finish(&fixture.daemon));
}

static int create_mesh(struct test_raw *raw, uint32_t triangle_count)
{
    return RAW_CALL(raw, MESH_CREATE, NULL, .vertex_count = 3,
                    .triangle_count = triangle_count);
}

/* If it failed, a program that lost its connection, and starts anew, would be refused
 * shared memory for as long as its former self is waited for. */
CASE(room__of_shared_memory_is_made)
{
    open_both("--shm-max-mib", "96");
    assert_ok(test_raw_attach(&fixture.first, 4, 16u << 20));
    assert_int_equal(test_raw_attach(&fixture.second, 4, 16u << 20), PCCD_E_QUOTA);
    lose_first();
    assert_ok(test_raw_attach(&fixture.second, 4, 16u << 20));
    assert_false(first_comes_back());
    close_both();
}

/* The same of meshes and triangles. If the second part failed, a request that cannot be
 * met at all would cost other clients what they have. */
CASE(room__of_meshes_is_made_where_it_helps)
{
    open_both("--triangles-max", "1000000");
    assert_int_equal(create_mesh(&fixture.first, 600000), 0);
    assert_int_equal(create_mesh(&fixture.second, 600000), PCCD_E_QUOTA);
    lose_first();
    assert_int_equal(create_mesh(&fixture.second, 1000001), PCCD_E_QUOTA);
    assert_true(first_comes_back());
    lose_first();
    assert_int_equal(create_mesh(&fixture.second, 600000), 0);
    assert_false(first_comes_back());
    close_both();
}

/* The same of what the engine allocates, long after the request that leads to it. */
CASE(room__of_the_engine_is_made)
{
    uint32_t mesh = 0;
    uint32_t held = 0;
    int status = 0;
    make_grid();
    open_both("--memory-max-mib", "16");
    assert_ok(test_raw_attach(&fixture.first, 2, sizeof triangles));
    assert_ok(test_raw_attach(&fixture.second, 2, sizeof triangles));
    while (status == 0 && held < 100) {
        status = test_raw_mesh(&fixture.first, x, VERTICES, triangles, TRIANGLES, &mesh);
        held += status == 0;
    }
    assert_int_equal(status, PCCD_E_QUOTA);
    assert_true(held >= 2);
    status = test_raw_mesh(&fixture.second, x, VERTICES, triangles, TRIANGLES, &mesh);
    assert_int_equal(status, PCCD_E_QUOTA);
    test_raw_close(&fixture.second); /* with what the refused mesh has of data */
    open_second();
    assert_ok(test_raw_attach(&fixture.second, 2, sizeof triangles));
    lose_first();
    for (uint32_t i = 0; i < held; i++) {
        status = test_raw_mesh(&fixture.second, x, VERTICES, triangles, TRIANGLES, &mesh);
        assert_int_equal(status, 0);
    }
    assert_false(first_comes_back());
    close_both();
}
