/* test_srv_outlet.c - the way out of a socket that may be closed meanwhile. */
#include "cases.h"

#include <sys/socket.h>
#include <unistd.h>

#include "conn.h"
#include "invariant.h"
#include "pccd_types.h"

static struct proto_encoder message;

static int setup(void **state)
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
CASE_WITH(outlet__sends_what_the_socket_takes, setup, NULL)
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
CASE_WITH(outlet__that_is_closed_sends_nothing, setup, NULL)
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
CASE_WITH(outlet__that_is_blocked_waits_its_turn, setup, NULL)
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
