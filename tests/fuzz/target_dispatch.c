/* target_dispatch.c - any messages to a real server. */

#include "fuzz_target.h"
#include "host.h"
#include "peer.h"

#define ACTS_MAX     64   /* of one script */
#define CHECKS_EVERY 2048 /* scripts */

static void send_raw(struct fuzz_peer *peer, struct fuzz_input *input, int fd_count)
{
    static uint8_t message[4096];
    size_t bytes = fuzz_take_bytes(input, message, fuzz_take_u16(input) % sizeof message);
    fuzz_peer_send(peer, message, bytes, fd_count);
}

/* The two clients of a script, and which of them acts. */
struct cast {
    struct fuzz_peer peers[2];
    unsigned turn;
};

static void act(struct cast *cast, struct fuzz_input *input)
{
    struct fuzz_peer *peer = &cast->peers[cast->turn];
    uint8_t choice = fuzz_take_u8(input);
    switch (choice % 8) {
    case 0:
        send_raw(peer, input, 0);
        break;
    case 1:
    case 2:
    case 3:
        fuzz_peer_ask(peer, fuzz_take_u8(input) % PROTO_METHOD_COUNT, input);
        break;
    case 4:
        fuzz_peer_write(peer, input);
        break;
    case 5:
        fuzz_peer_release(peer, choice < 128 ? peer->release : fuzz_take_u64(input));
        break;
    case 6:
        if (choice >= 240) {
            send_raw(peer, input, 1 + choice % 2);
        } else if (choice >= 128) {
            cast->turn = 1 - cast->turn;
        } else {
            fuzz_peer_return(peer);
        }
        break;
    default:
        fuzz_peer_settle(peer);
        break;
    }
}

void fuzz_dispatch(const uint8_t *data, size_t bytes)
{
    struct fuzz_input input = {data, bytes};
    static unsigned inputs;
    struct cast cast = {.turn = 0};
    fuzz_host_start();
    for (int i = 0; i < 2; i++) {
        fuzz_peer_open(&cast.peers[i]);
    }
    for (int i = 0; i < ACTS_MAX && input.left > 0 && !cast.peers[cast.turn].is_over;
         i++) {
        act(&cast, &input);
    }
    for (int i = 0; i < 2; i++) {
        fuzz_peer_settle(&cast.peers[i]);
    }
    fuzz_scarcity_pause();
    for (int i = 0; i < 2; i++) {
        fuzz_peer_close(&cast.peers[i]);
    }
    if (++inputs % CHECKS_EVERY == 0) {
        fuzz_host_check();
    }
}
