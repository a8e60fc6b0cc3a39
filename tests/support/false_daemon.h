/* false_daemon.h - a fake daemon that answers from a script. */
#ifndef TEST_FALSE_DAEMON_H
#define TEST_FALSE_DAEMON_H

#include <stdint.h>
#include <sys/types.h>

#include "codec.h"
#include "memfd.h"
#include "messages.h"
#include "pccd.h"

#define FALSE_RING_BYTES   (4096u + 4u * 262144u) /* of what the library asks first for */
#define FALSE_RESULT_BYTES (4096u + 65536u)
#define FALSE_TIMEOUT_MS   400
#define FALSE_PID          4711

struct false_daemon {
    char directory[64];
    char socket_path[80];
    char url[96];
    pid_t child;  /* 0: none */
    int listener; /* in the child, as what follows */
    int socket;
    int scenes; /* a script's own count */
    struct proto_decoder *decoder;
    struct proto_envelope envelope; /* of the last request */
    struct proto_encoder encoder;
    uint8_t message[PROTO_MESSAGE_BYTES_MAX];
};

extern struct false_daemon false_daemon;

/* ---- for scripts, in the child ----------------------------------------------------- */

typedef void (*false_script)(void);

/* The next client, in place of the last. */
void false_take_client(void);
/* Take the next request; ends the process when there is none. Returns its method. */
int false_next(void);
void false_answer(uint32_t id, int method, const void *result, const int *fds, int count);
/* Refuse the last request. */
void false_refuse(int code, const char *text);
/* Answer hello, if that is the next request. */
void false_hello(uint32_t version);
/* Answer shm.attach with true memories, of which the message says what it likes. */
void false_attach(struct proto_SHM_ATTACH_result result, int fd_count);
extern const struct proto_SHM_ATTACH_result false_good_ring;
/* The same of a request that was taken already. */
void false_attached(struct proto_SHM_ATTACH_result result, int fd_count);
/* Answer a submit with a page of `count` contacts at `offset`. */
void false_step(uint32_t id, uint64_t offset, uint64_t count, uint32_t bytes);

/* ---- for tests --------------------------------------------------------------------- */

/* Start it with a script; it accepts one client before. */
void false_start(false_script script);
int false_stop(void **state); /* a teardown */

/* Without another try when the connection is lost. Returns a status. */
int false_connect(struct pccd_client **client);
/* A client of a script that begins with hello and attach; a still step attaches. */
struct pccd_client *false_connect_good(void);

#endif
