/* animals_talk.c - hostile clients: messages and descriptors. */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <sys/socket.h>

#include "animals.h"
#include "crossing.h"
#include "daemon.h"
#include "seqpacket.h"

#define CONNECTIONS 8
#define HELLO_MS    10000u
#define FLOOD_MAX   100000
#define FLOOD_ROUND 64
#define OVERLONG    (PROTO_MESSAGE_BYTES_MAX + 1)
#define PING        "\x94\x00\x01\xa4ping\x80"
#define PING_BYTES  (sizeof(PING) - 1)

static struct test_raw raw;

/* Return whether the daemon says a fatal `code` now, and closes. */
static bool is_dropped(struct test_raw *peer, int code)
{
    return test_raw_receive(peer) == 0 && peer->envelope.failed &&
           peer->envelope.error.code == code && peer->envelope.error.fatal &&
           test_raw_receive(peer) == PCCD_E_DISCONNECTED;
}

/* Connects and never says hello: dropped without a word after 10 s, not before. */
bool zoo_says_nothing(struct zoo_cage *cage)
{
    static struct test_raw peers[CONNECTIONS];
    uint64_t begin_ms = test_now_ms();

    for (int i = 0; i < CONNECTIONS; i++) {
        EXPECT(cage, test_raw_open(&peers[i], cage->socket));
    }
    for (int i = 0; i < CONNECTIONS; i++) {
        struct pollfd watched = {.fd = peers[i].socket, .events = POLLIN};

        if (!cage->patient) {
            EXPECT(cage, poll(&watched, 1, 0) == 0); /* still there */
            continue;
        }
        EXPECT(cage, poll(&watched, 1, 2 * (int)HELLO_MS) == 1);
        EXPECT(cage, test_raw_receive(&peers[i]) == PCCD_E_DISCONNECTED);
        EXPECT(cage, test_now_ms() - begin_ms >= HELLO_MS - 1000);
        test_raw_close(&peers[i]);
    }
    return true; /* the impatient stay connected */
}

/* Sends and never reads: once 16 answers wait it is not read either, so that its own
 * socket takes no more; it is not dropped, and later every request has its answer. */
bool zoo_never_reads(struct zoo_cage *cage)
{
    uint32_t sent = 0;

    EXPECT(cage, zoo_enter(cage, &raw, 0));
    for (int quiet = 0; quiet < 20; quiet++) {
        while (sent < FLOOD_MAX &&
               send(raw.socket, PING, PING_BYTES, MSG_NOSIGNAL | MSG_DONTWAIT) > 0) {
            sent++;
            quiet = 0;
        }
        test_sleep_ms(2);
    }
    EXPECT(cage, sent > PROTO_REPLIES_QUEUED_MAX && sent < FLOOD_MAX);
    for (uint32_t i = 0; i < sent; i++) {
        EXPECT(cage, test_raw_receive(&raw) == 0 && !raw.envelope.failed);
    }
    test_raw_close(&raw);
    return true;
}

/* Sends as fast as it can: served, in order, as fast as it reads. */
bool zoo_floods(struct zoo_cage *cage)
{
    EXPECT(cage, zoo_enter(cage, &raw, 0));
    for (int round = 0; round < 100; round++) {
        uint32_t ids[FLOOD_ROUND];

        for (int i = 0; i < FLOOD_ROUND; i++) {
            ids[i] = RAW_SEND(&raw, PING, .token = (uint64_t)i);
            EXPECT(cage, ids[i] != 0);
        }
        for (int i = 0; i < FLOOD_ROUND; i++) {
            struct proto_PING_result pong = {.token = 0};

            EXPECT(cage, test_raw_answer(&raw, ids[i], PROTO_METHOD_PING, &pong) == 0);
            EXPECT(cage, pong.token == (uint64_t)i);
        }
    }
    test_raw_close(&raw);
    return true;
}

/* Sends as many descriptors as a message can carry, before the daemon has looked at it
 * and as its client: they are closed, and it is dropped with E_BADMSG; or the kernel does
 * not take them (seqpacket.h), and nothing has happened. */
bool zoo_sends_253_descriptors(struct zoo_cage *cage)
{
    for (int round = 0; round < 2; round++) {
        EXPECT(cage,
               round == 0 ? test_raw_open(&raw, cage->socket) : zoo_enter(cage, &raw, 0));
        if (test_raw_send(&raw, PING, PING_BYTES, PROTO_FDS_RECEIVED_MAX)) {
            EXPECT(cage, is_dropped(&raw, PCCD_E_BADMSG));
        } else {
            EXPECT(cage, errno == EPERM);
            EXPECT(cage, test_raw_send(&raw, PING, PING_BYTES, 0));
            EXPECT(cage, test_raw_receive(&raw) == 0 && !raw.envelope.failed);
        }
        test_raw_close(&raw);
    }
    return true;
}

/* An empty message is an end of file; one beyond the limit is dropped with E_BADMSG. */
bool zoo_sends_wrong_lengths(struct zoo_cage *cage)
{
    static const uint8_t zeros[OVERLONG];

    EXPECT(cage, zoo_enter(cage, &raw, 0));
    EXPECT(cage, test_raw_send(&raw, "", 0, 0));
    EXPECT(cage, test_raw_receive(&raw) == PCCD_E_DISCONNECTED);
    test_raw_close(&raw);
    EXPECT(cage, zoo_enter(cage, &raw, 0));
    EXPECT(cage, test_raw_send(&raw, zeros, OVERLONG, 0));
    EXPECT(cage, is_dropped(&raw, PCCD_E_BADMSG));
    test_raw_close(&raw);
    return true;
}

static int remove_object(const struct test_raw_crossing *scene)
{
    return RAW_CALL(&raw, SCENE_REMOVE, NULL, .scene = scene->scene,
                    .object = scene->object);
}

/* Names what is gone, and what never was: E_HANDLE, and it stays. */
bool zoo_uses_stale_handles(struct zoo_cage *cage)
{
    struct test_raw_crossing scene;
    struct proto_FRAME_SUBMIT_request submit;
    uint32_t object;

    EXPECT(cage, zoo_enter(cage, &raw, 65536));
    EXPECT(cage, test_raw_build(&raw, "", test_triangle_x, &scene) == 0);
    EXPECT(cage, remove_object(&scene) == 0);
    EXPECT(cage, remove_object(&scene) == PCCD_E_HANDLE);
    submit = test_raw_turn(&raw, 0, &scene, -1); /* moves the object that was removed */
    EXPECT(cage, test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit, NULL) ==
                     PCCD_E_HANDLE);
    EXPECT(cage, RAW_CALL(&raw, MESH_DESTROY, NULL, .mesh = scene.mesh) == 0);
    EXPECT(cage, test_raw_add(&raw, scene.scene, scene.mesh, &object) == PCCD_E_HANDLE);
    EXPECT(cage, RAW_CALL(&raw, SCENE_DESTROY, NULL, .scene = scene.scene) == 0);
    submit = test_raw_turn(&raw, 0, &scene, 1);
    for (uint32_t i = 0; i < 64; i++) { /* guesses, near and far */
        submit.scene = scene.scene + (i << i % 32);
        EXPECT(cage, test_raw_call(&raw, PROTO_METHOD_FRAME_SUBMIT, &submit, NULL) ==
                         PCCD_E_HANDLE);
    }
    EXPECT(cage, RAW_CALL(&raw, PING, NULL, .token = 1) == 0);
    test_raw_close(&raw);
    return true;
}
