/* peer.h - a client that does what a fuzzer's input says. */
#ifndef FUZZ_PEER_H
#define FUZZ_PEER_H

#include "codec.h"
#include "fuzz_target.h"
#include "memfd.h"
#include "shm.h"

struct fuzz_peer {
    int socket;   /* -1: none */
    bool is_over; /* the server has closed it */
    uint32_t next_id;
    uint32_t answered;                 /* messages that were received and decoded */
    uint64_t release;                  /* of the results */
    uint32_t hello_id;                 /* of the last hello that was asked for */
    struct proto_HELLO_result welcome; /* its answer, with the session's secret */
    struct proto_memory upload;
    struct proto_memory results;
    struct proto_decoder *decoder;
};

void fuzz_peer_open(struct fuzz_peer *peer);
void fuzz_peer_close(struct fuzz_peer *peer);
/* Lose the connection, come back over another, and ask for the session. */
void fuzz_peer_return(struct fuzz_peer *peer);

/* Any bytes, with that many descriptors. */
void fuzz_peer_send(struct fuzz_peer *peer, const void *data, size_t bytes, int fd_count);

/* A request whose fields the input chooses. */
void fuzz_peer_ask(struct fuzz_peer *peer, int method, struct fuzz_input *input);

/* Take answers until the one to a ping comes, or the end. */
void fuzz_peer_settle(struct fuzz_peer *peer);

/* Write into the ring, publish a slot, release results: nothing without a ring. */
void fuzz_peer_write(struct fuzz_peer *peer, struct fuzz_input *input);
uint64_t fuzz_peer_publish(struct fuzz_peer *peer, uint32_t slot);
void fuzz_peer_release(struct fuzz_peer *peer, uint64_t head);

#endif
