/* test_srv_replies.c - answers that may have to be sent once more. */
#include "cases.h"
#include "replies.h"

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
