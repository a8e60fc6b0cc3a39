/* test_srv_outbox.c - answers that go out together. */
#include "cases.h"
#include "server.h"

static struct srv_outbox outbox;
static char connections[SRV_OUTBOX_ENTRIES + 1]; /* their addresses alone matter */

static struct srv_conn *conn(uint32_t i)
{
    return (struct srv_conn *)(void *)&connections[i];
}

static int setup(void **state)
{
    (void)state;
    memset(&outbox, 0, sizeof outbox);
    return 0;
}

/* If it failed: an answer would be lost, cut, or go to another client. */
CASE_WITH(outbox__keeps_each_for_its_client, setup, NULL)
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
CASE_WITH(outbox__refuses_what_has_no_place, setup, NULL)
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
CASE_WITH(outbox__is_due_after_so_many_messages, setup, NULL)
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
