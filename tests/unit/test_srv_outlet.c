/* test_srv_outlet.c - answers on their way to clients, and a loop that waits for more. */
#include "cases.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "conn.h"
#include "invariant.h"
#include "pccd_types.h"
#include "replies.h"
#include "server.h"
#include "watch.h"

/* ---- answers that go out together -------------------------------------------------- */

static struct srv_outbox outbox;
static char connections[SRV_OUTBOX_ENTRIES + 1]; /* their addresses alone matter */

static struct srv_conn *conn(uint32_t i)
{
    return (struct srv_conn *)(void *)&connections[i];
}

static int clear_outbox(void **state)
{
    (void)state;
    memset(&outbox, 0, sizeof outbox);
    return 0;
}

/* If it failed: an answer would be lost, cut, or go to another client. */
CASE_WITH(outbox__keeps_each_for_its_client, clear_outbox, NULL)
{
    uint8_t message[SRV_OUTBOX_BYTES + 1];
    for (uint32_t i = 0; i < SRV_OUTBOX_ENTRIES; i++) {
        memset(message, (int)i, sizeof message);
        assert_true(srv_outbox_add(&outbox, conn(i), message, SRV_OUTBOX_BYTES - i));
    }
    assert_int_equal(outbox.count, SRV_OUTBOX_ENTRIES);
    for (uint32_t i = 0; i < SRV_OUTBOX_ENTRIES; i++) {
        memset(message, (int)i, sizeof message);
        assert_ptr_equal(outbox.entries[i].conn, conn(i));
        assert_int_equal(outbox.entries[i].bytes, SRV_OUTBOX_BYTES - i);
        assert_memory_equal(outbox.entries[i].data, message, SRV_OUTBOX_BYTES - i);
    }
}

/* If it failed: what there is no place for would be written over something else. */
CASE_WITH(outbox__refuses_what_has_no_place, clear_outbox, NULL)
{
    static const uint8_t message[SRV_OUTBOX_BYTES + 1];
    assert_false(srv_outbox_add(&outbox, conn(0), message, SRV_OUTBOX_BYTES + 1));
    assert_int_equal(outbox.count, 0);
    for (uint32_t i = 0; i < SRV_OUTBOX_ENTRIES; i++) {
        assert_true(srv_outbox_add(&outbox, conn(i), message, 1));
    }
    assert_false(srv_outbox_add(&outbox, conn(SRV_OUTBOX_ENTRIES), message, 1));
    assert_int_equal(outbox.count, SRV_OUTBOX_ENTRIES);
    srv_outbox_clear(&outbox);
    assert_true(srv_outbox_add(&outbox, conn(SRV_OUTBOX_ENTRIES), message, 1));
    assert_ptr_equal(outbox.entries[0].conn, conn(SRV_OUTBOX_ENTRIES));
}

/* If it failed: an answer would wait for as long as others have something to say that is
 * not answered at once. */
CASE_WITH(outbox__is_due_after_so_many_messages, clear_outbox, NULL)
{
    for (int turn = 0; turn < 2; turn++) {
        for (uint32_t i = 0; i < 3 * SRV_OUTBOX_ENTRIES; i++) {
            assert_false(srv_outbox_is_due(&outbox)); /* nothing waits */
        }
        assert_true(srv_outbox_add(&outbox, conn(0), "answer", 6));
        for (uint32_t i = 1; i < SRV_OUTBOX_ENTRIES; i++) {
            assert_false(srv_outbox_is_due(&outbox));
        }
        assert_true(srv_outbox_is_due(&outbox));
        srv_outbox_clear(&outbox);
    }
}

/* ---- the way out of a socket that may be closed meanwhile -------------------------- */

static struct proto_encoder message;

static int enter_loop(void **state)
{
    (void)state;
    srv_thread_enter(SRV_THREAD_LOOP);
    memcpy(message.data, "answer", 6);
    message.bytes = 6;
    return 0;
}

static void open_pair(int fds[2])
{
    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, fds), 0);
}

static bool has_come(int fd)
{
    char got[16];
    return recv(fd, got, sizeof got, 0) == 6 && memcmp(got, "answer", 6) == 0;
}

/* If it failed: no answer would come from where it is computed. */
CASE_WITH(outlet__sends_what_the_socket_takes, enter_loop, NULL)
{
    int fds[2];
    open_pair(fds);
    struct srv_outlet *outlet = srv_outlet_new(fds[0]);
    assert_non_null(outlet);
    assert_int_equal(srv_outlet_send(outlet, &message), 0);
    assert_true(has_come(fds[1]));
    int sent = 0;
    while (srv_outlet_send(outlet, &message) == 0) {
        sent++;
    }
    assert_int_equal(srv_outlet_send(outlet, &message), PCCD_E_AGAIN);
    for (int i = 0; i < sent; i++) {
        assert_true(has_come(fds[1]));
    }
    srv_outlet_close(outlet);
    close(fds[0]);
    close(fds[1]);
}

/* If it failed: a client could be sent the answer of the one whose socket had its number
 * before. */
CASE_WITH(outlet__that_is_closed_sends_nothing, enter_loop, NULL)
{
    int fds[2];
    int others[2];
    open_pair(fds);
    struct srv_outlet *outlet = srv_outlet_new(fds[0]);
    assert_non_null(outlet);
    assert_ptr_equal(srv_outlet_hold(outlet), outlet);
    srv_outlet_close(outlet);
    close(fds[0]);
    open_pair(others);
    assert_int_equal(others[0], fds[0]);
    assert_int_equal(srv_outlet_send(outlet, &message), PCCD_E_DISCONNECTED);
    assert_false(has_come(others[1]));
    srv_outlet_drop(outlet);
    close(fds[1]);
    close(others[0]);
    close(others[1]);
}

/* If it failed: an answer would overtake those that the loop has queued. */
CASE_WITH(outlet__that_is_blocked_waits_its_turn, enter_loop, NULL)
{
    int fds[2];
    open_pair(fds);
    struct srv_outlet *outlet = srv_outlet_new(fds[0]);
    assert_non_null(outlet);
    srv_outlet_block(outlet, true);
    assert_int_equal(srv_outlet_send(outlet, &message), PCCD_E_AGAIN);
    assert_false(has_come(fds[1]));
    srv_outlet_block(outlet, false);
    assert_int_equal(srv_outlet_send(outlet, &message), 0);
    assert_true(has_come(fds[1]));
    srv_outlet_close(outlet);
    close(fds[0]);
    close(fds[1]);
}

/* ---- answers that may have to be sent once more ------------------------------------ */

static struct proto_encoder encoder;

static void keep(struct srv_replies *replies, uint32_t id, int method)
{
    memcpy(encoder.data, &id, sizeof id);
    encoder.bytes = sizeof id + id % 3;
    if (srv_replies_must_keep(method)) {
        srv_replies_keep(replies, srv_reply_copy(id, &encoder));
    }
}

static int finds(const struct srv_replies *replies, uint32_t id)
{
    memset(&encoder, 0, sizeof encoder);
    return srv_replies_find(replies, id, &encoder) &&
           encoder.bytes == sizeof id + id % 3 && memcmp(encoder.data, &id, 4) == 0;
}

/* If it failed, an answer could be gone that its client has not received, or memory would
 * grow with every answer. */
CASE(replies__keep_the_newest)
{
    struct srv_replies *replies = srv_replies_new();
    assert_non_null(replies);
    assert_false(finds(replies, 0));
    for (uint32_t id = 1; id <= 100; id++) {
        keep(replies, id, PROTO_METHOD_FRAME_SUBMIT);
    }
    for (uint32_t id = 1; id <= 100; id++) {
        assert_int_equal(finds(replies, id), id > 100 - PROTO_REPLIES_KEPT);
    }
    assert_false(replies->is_broken);
    srv_replies_free(replies);
}

/* If it failed, a flood of pings would push out the answers that matter; or the answer to
 * shm.attach would come again without its descriptors. */
CASE(replies__of_what_may_run_twice_are_not_kept)
{
    struct srv_replies *replies = srv_replies_new();
    assert_non_null(replies);
    keep(replies, 1, PROTO_METHOD_SCENE_CREATE);
    for (uint32_t id = 2; id < 100; id++) {
        keep(replies, id, PROTO_METHOD_PING);
        keep(replies, id, PROTO_METHOD_SHM_ATTACH);
        keep(replies, id, -1);
    }
    assert_true(finds(replies, 1));
    assert_false(finds(replies, 2));
    srv_replies_free(replies);
}

/* If it failed, the session of a client with many requests would take new ones for old
 * ones, or run old ones again, once its ids wrap. */
CASE(replies__know_new_ids_across_the_wrap)
{
    struct srv_replies *replies = srv_replies_new();
    assert_non_null(replies);
    assert_true(srv_replies_is_new(replies, 5));
    assert_false(srv_replies_is_new(replies, 5));
    assert_false(srv_replies_is_new(replies, 4));
    assert_true(srv_replies_is_new(replies, UINT32_MAX / 2));
    assert_true(srv_replies_is_new(replies, UINT32_MAX - 1));
    assert_true(srv_replies_is_new(replies, 3));
    assert_false(srv_replies_is_new(replies, UINT32_MAX));
    assert_true(srv_replies_is_new(replies, 4));
    srv_replies_free(replies);
    srv_replies_free(NULL);
}

/* ---- a loop that stays awake while its client asks at once ------------------------- */

struct fixture {
    uv_loop_t loop;
    struct srv_service service;
    struct srv_awake awake;
};

static int open_loop(void **state)
{
    static struct fixture fixture;
    memset(&fixture, 0, sizeof fixture);
    *state = &fixture;
    fixture.service.metrics.counters.processors = 2;
    assert_int_equal(uv_loop_init(&fixture.loop), 0);
    srv_awake_init(&fixture.awake, &fixture.loop, &fixture.service);
    return 0;
}

static int close_loop(void **state)
{
    struct fixture *f = *state;
    uv_close((uv_handle_t *)&f->awake.idle, NULL);
    (void)uv_run(&f->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&f->loop), 0);
    return 0;
}

/* Return whether it stays awake after a wait before which the loop has stepped. */
static bool stays(struct fixture *f)
{
    f->service.metrics.counters.steps_brief++;
    srv_awake_before_wait(&f->awake);
    return uv_is_active((uv_handle_t *)&f->awake.idle);
}

/* Look until it ends by itself. */
static void wait_in_vain(struct fixture *f)
{
    while (uv_is_active((uv_handle_t *)&f->awake.idle)) {
        (void)uv_run(&f->loop, UV_RUN_NOWAIT);
    }
}

/* If it failed: a client that asks at once would wait for a processor to wake. */
CASE_WITH(awake__goes_on_while_messages_come, open_loop, close_loop)
{
    struct fixture *f = *state;
    for (int i = 0; i < 100; i++) {
        assert_true(stays(f));
        f->service.metrics.counters.messages++;
        (void)uv_run(&f->loop, UV_RUN_NOWAIT);
        assert_false(uv_is_active((uv_handle_t *)&f->awake.idle));
    }
}

/* If it failed: a client that asks now and then would have a processor for it. */
CASE_WITH(awake__is_seldom_where_nothing_comes, open_loop, close_loop)
{
    struct fixture *f = *state;
    uint32_t between = 0;
    uint32_t asleep = 0;
    for (int i = 0; i < 12; i++) {
        for (asleep = 0; !stays(f); asleep++) {
            assert_true(asleep <= 256);
        }
        assert_true(asleep >= between);
        between = asleep;
        wait_in_vain(f);
    }
    assert_int_equal(between, 256);
    while (!stays(f)) {
        ;
    }
    f->service.metrics.counters.messages++;
    (void)uv_run(&f->loop, UV_RUN_NOWAIT);
    assert_true(stays(f)); /* it was not in vain */
    wait_in_vain(f);
}

/* If it failed: it would keep others from the only processor, or the daemon from its
 * end. */
CASE_WITH(awake__is_not_for_all, open_loop, close_loop)
{
    struct fixture *f = *state;
    srv_awake_before_wait(&f->awake); /* nothing was stepped */
    assert_false(uv_is_active((uv_handle_t *)&f->awake.idle));
    f->service.phase = SRV_PHASE_DRAINING;
    assert_false(stays(f));
    f->service.phase = SRV_PHASE_RUNNING;
    f->service.metrics.counters.processors = 1;
    assert_false(stays(f));
}
