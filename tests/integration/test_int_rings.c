/* test_int_rings.c - memory of rings that clients do not use any more, and keep mapped.
 *
 * Room:     tests/integration. May include: tests/support, proto.
 * Does:     attach and leave by hand, and ask the kernel what is still held.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "crossing.h"
#include "daemon.h"
#include "raw.h"

#define SLOT_BYTES (4u << 20)
#define SLOTS      4u
#define KEPT_MAX 6u

/* What clients keep of the rings that they had. */
struct kept {
    struct proto_memory memories[2 * KEPT_MAX];
    uint32_t count;
};

/* Keep both memories mapped, with their descriptors, whatever becomes of the client. */
static void keep_ring(struct kept *kept, struct test_raw *raw)
{
    assert_true(kept->count + 2 <= 2 * KEPT_MAX);
    kept->memories[kept->count++] = raw->upload;
    kept->memories[kept->count++] = raw->result;
    raw->upload = raw->result = (struct proto_memory)PROTO_MEMORY_NONE;
}

static uint64_t held_of(const struct kept *kept)
{
    uint64_t bytes = 0;

    for (uint32_t i = 0; i < kept->count; i++) {
        bytes += proto_memory_held(&kept->memories[i]);
    }
    return bytes;
}

/* Until they hold at most `bytes`, 10 s at most. */
static uint64_t await_held(const struct kept *kept, uint64_t bytes)
{
    for (int i = 0; i < 1000 && held_of(kept) > bytes; i++) {
        test_sleep_ms(10);
    }
    return held_of(kept);
}

static void drop_kept(struct kept *kept)
{
    while (kept->count > 0) {
        proto_memory_deinit(&kept->memories[--kept->count]);
    }
}

/* If it failed, a client would have any amount of memory that the daemon has made, and
 * nobody were charged for: it attaches ring after ring and keeps them all mapped. */
static void ring__that_was_replaced_is_freed(void **state)
{
    static struct test_raw raw;
    struct kept kept = {.count = 0};
    struct test_daemon daemon;
    struct pccd_client *client;
    uint64_t before;

    (void)state;
    assert_true(test_daemon_start(&daemon, NULL));
    client = test_connect(daemon.url);
    assert_non_null(client);
    assert_true(test_raw_open(&raw, daemon.socket));
    assert_int_equal(test_raw_hello(&raw), 0);
    assert_int_equal(test_raw_attach(&raw, SLOTS, SLOT_BYTES), 0);
    before = test_stat(client, "shm_bytes_now");
    assert_true(before > SLOTS * SLOT_BYTES);
    for (uint32_t i = 0; i < KEPT_MAX; i++) {
        memset(test_raw_payload(&raw, 0), 1, SLOTS * SLOT_BYTES);
        keep_ring(&kept, &raw);
        assert_int_equal(test_raw_attach(&raw, SLOTS, SLOT_BYTES), 0);
    }
    assert_int_equal(await_held(&kept, 0), 0);
    assert_int_equal(test_stat_await(client, "shm_bytes_now", before), before);
    drop_kept(&kept);
    test_raw_close(&raw);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* If it failed, clients that come and go could do the same. */
static void ring__of_a_session_that_is_over_is_freed(void **state)
{
    static struct test_raw raw;
    struct kept kept = {.count = 0};
    struct test_daemon daemon;
    struct pccd_client *client;
    uint64_t before;

    (void)state;
    assert_true(test_daemon_start(&daemon, NULL));
    client = test_connect(daemon.url);
    assert_non_null(client);
    before = test_stat(client, "shm_bytes_now");
    for (uint32_t i = 0; i < KEPT_MAX; i++) {
        assert_true(test_raw_open(&raw, daemon.socket));
        assert_int_equal(test_raw_hello(&raw), 0);
        assert_int_equal(test_raw_attach(&raw, SLOTS, SLOT_BYTES), 0);
        memset(test_raw_payload(&raw, 0), 1, SLOTS * SLOT_BYTES);
        keep_ring(&kept, &raw);
        test_raw_close(&raw);
    }
    assert_int_equal(await_held(&kept, 0), 0);
    assert_int_equal(test_stat_await(client, "shm_bytes_now", before), before);
    drop_kept(&kept);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

/* A client that can be resumed, with a ring of SLOTS slots, which it says it needs, but
 * for the last one. */
static void attach_resumably(struct test_raw *raw, const char *socket)
{
    const struct proto_HELLO_request hello = {.version_min = PROTO_VERSION_MIN,
                                              .version_max = PROTO_VERSION_MAX,
                                              .client = "raw",
                                              .resumable = true};

    assert_true(test_raw_open(raw, socket));
    assert_int_equal(test_raw_call(raw, PROTO_METHOD_HELLO, &hello, NULL), 0);
    assert_int_equal(test_raw_attach(raw, SLOTS, SLOT_BYTES), 0);
    memset(test_raw_payload(raw, 0), 1, SLOTS * SLOT_BYTES);
    atomic_store(&test_raw_upload(raw)->slots[SLOTS - 1].memory, PROTO_SLOT_FREE);
}

static uint64_t sum_of(const struct proto_memory *upload)
{
    const uint8_t *bytes = upload->base;
    uint64_t sum = 0;

    for (size_t i = sizeof(struct proto_upload); i < upload->bytes; i++) {
        sum += bytes[i];
    }
    return sum;
}

/* If it failed, a client that comes back too late would find zeros for the positions that
 * only its slots have; or, if it never does, memory would stay that nobody is charged
 * for. */
static void ring__that_was_left_is_charged_while_it_is_needed(void **state)
{
    static const char *const options[] = {"--linger", "1", "--shm-max-mib", "40", NULL};
    static struct test_raw raw;
    struct kept kept = {.count = 0};
    struct test_daemon daemon;
    struct pccd_client *client;
    const uint64_t needed = (SLOTS - 1) * SLOT_BYTES;
    struct test_crossing crossing;
    uint64_t before;

    (void)state;
    assert_true(test_daemon_start(&daemon, options));
    client = test_connect(daemon.url);
    assert_non_null(client);
    assert_int_equal(test_crossing_make(client, &crossing), 0); /* it has a ring */
    test_sleep_ms(1200);                                        /* and rests */
    before = test_stat(client, "shm_bytes_now");
    for (int is_evicted = 0; is_evicted <= 1; is_evicted++) {
        attach_resumably(&raw, daemon.socket);
        keep_ring(&kept, &raw);
        test_raw_close(&raw);
        assert_int_equal(test_stat_await(client, "sessions_now", 1), 1);
        assert_in_range(await_held(&kept, needed + (64u << 10)), needed,
                        needed + (64u << 10));
        test_sleep_ms(1200);
        assert_in_range(test_stat(client, "shm_bytes_now"), before + needed,
                        before + needed + (64u << 10));
        assert_int_equal(sum_of(&kept.memories[0]), needed);
        struct proto_upload *upload = kept.memories[0].base;
        if (is_evicted) {
            assert_true(test_raw_open(&raw, daemon.socket)); /* needs the memory */
            assert_int_equal(test_raw_hello(&raw), 0);
            assert_int_equal(test_raw_attach(&raw, SLOTS, 2 * SLOT_BYTES), 0);
            assert_int_equal(upload->header.magic, 0);
            test_raw_close(&raw);
        } else {
            test_raw_offer(&kept.memories[0], SLOTS - 1);
            for (int i = 0; i < 20; i++) {
                assert_true(test_crossing_turn(&crossing)); /* a second later it looks */
                test_sleep_ms(100);
            }
            test_sleep_ms(1200);
        }
        assert_int_equal(test_stat_await(client, "shm_bytes_now", before), before);
        assert_in_range(await_held(&kept, 2 * PROTO_SHM_PAGE), 0, 2 * PROTO_SHM_PAGE);
        drop_kept(&kept);
    }
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ring__that_was_replaced_is_freed),
        cmocka_unit_test(ring__of_a_session_that_is_over_is_freed),
        cmocka_unit_test(ring__that_was_left_is_charged_while_it_is_needed),
    };
    return cmocka_run_group_tests_name("rings", tests, NULL, NULL);
}
