/* raw.h - a client that speaks the protocol without the library, correctly or not. */
#ifndef TEST_RAW_H
#define TEST_RAW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "codec.h"
#include "memfd.h"
#include "messages.h"
#include "shm.h"

struct test_raw {
    int socket; /* -1: none; of a service in this process, a descriptor to poll */
    const struct proto_direct *host; /* of such a one; NULL: a daemon */
    struct proto_direct_inbox *line;
    uint32_t next_id;
    struct proto_decoder *decoder;
    struct proto_envelope envelope; /* of the last message */
    struct proto_error error;       /* of the last answer that failed */
    struct proto_memory upload;
    struct proto_memory result;
    struct proto_SHM_ATTACH_result ring;
    struct proto_encoder encoder;
    uint8_t message[PROTO_MESSAGE_BYTES_MAX];
};

/* Connect without a word. False: nobody listens, or no memory. */
bool test_raw_open(struct test_raw *raw, const char *socket_path);
void test_raw_close(struct test_raw *raw);
/* Another connection; rings and numbers stay. False: nobody listens. */
bool test_raw_reopen(struct test_raw *raw, const char *socket_path);

/* Send one datagram with `fd_count` copies of a descriptor of our own. */
bool test_raw_send(struct test_raw *raw, const void *bytes, size_t count, int fd_count);

/* The same with one given descriptor, waiting for room 5 s at most. */
bool test_raw_send_fd(struct test_raw *raw, const void *bytes, size_t count, int fd);

/* Time that an answer may take: 10 s, unless a program needs more. */
extern int test_raw_wait_ms;

/* Receive and decode one message. Returns 0, PCCD_E_TIMEOUT (nothing for that long),
 * PCCD_E_DISCONNECTED or PCCD_E_BADMSG. */
int test_raw_receive(struct test_raw *raw);

/* Send a request and wait for its answer, skipping others. Returns 0 with *result (may
 * be NULL) set, or the error's code with raw->error set, or what test_raw_receive
 * returned. */
int test_raw_call(struct test_raw *raw, int method, const void *request, void *result);

/* The same of a request whose fields are named here; those that are not are 0. */
#define RAW_CALL(raw, METHOD, result, ...)                                               \
    test_raw_call(raw, PROTO_METHOD_##METHOD,                                            \
                  &(const struct proto_##METHOD##_request){__VA_ARGS__}, result)

/* The same in two halves; send returns the id, 0 on failure. */
uint32_t test_raw_request(struct test_raw *raw, int method, const void *request);
#define RAW_SEND(raw, METHOD, ...)                                                       \
    test_raw_request(raw, PROTO_METHOD_##METHOD,                                         \
                     &(const struct proto_##METHOD##_request){__VA_ARGS__})
int test_raw_answer(struct test_raw *raw, uint32_t id, int method, void *result);

/* Decode the request of a journal's entry at *at into *request, which is as large as any;
 * *at goes behind the entry. Returns the method, -1: that is none; *payload: what was
 * sent with it. */
int test_raw_entry(struct test_raw *raw, const uint8_t **at, void *request,
                   const uint8_t **payload);

/* hello, and a ring. Both return as test_raw_call. */
int test_raw_hello(struct test_raw *raw);
/* hello of a session that may be resumed; `resume`: that of which it is; NULL: a new
 * one. */
int test_raw_hello_again(struct test_raw *raw, const struct proto_HELLO_result *resume,
                         struct proto_HELLO_result *result);
int test_raw_attach(struct test_raw *raw, uint32_t slot_count, uint64_t slot_bytes);
int test_raw_attach_as(struct test_raw *raw,
                       const struct proto_SHM_ATTACH_request *request);

/* Connect, say hello, and attach a ring; slot_bytes 0: none. As test_raw_call. */
int test_raw_session(struct test_raw *raw, const char *socket_path, uint32_t slot_count,
                     uint64_t slot_bytes);

struct proto_upload *test_raw_upload(const struct test_raw *raw);
uint8_t *test_raw_payload(const struct test_raw *raw, uint32_t slot);
/* Store the next even sequence number in the slot's descriptor. */
uint64_t test_raw_publish(const struct test_raw *raw, uint32_t slot);

/* The vertices and triangles of a mesh, or of what replaces one, through slot 0; without
 * the commit. Returns as test_raw_call. */
int test_raw_fill(struct test_raw *raw, uint32_t mesh, const float (*x)[3],
                  uint32_t vertex_count, const uint32_t (*triangles)[3],
                  uint32_t triangle_count);

/* A mesh of these floats and triangles, through slot 0. Returns as test_raw_call. */
int test_raw_mesh(struct test_raw *raw, const float (*x)[3], uint32_t vertex_count,
                  const uint32_t (*triangles)[3], uint32_t triangle_count,
                  uint32_t *mesh);

/* ---- scenes (raw_scene.c) ---------------------------------------------------------- */

/* Make a scene of that name, or take part in it; "": one of this session alone. */
int test_raw_scene(struct test_raw *raw, const char *name, uint32_t *scene);
/* Add an object of a mesh. */
int test_raw_add(struct test_raw *raw, uint32_t scene, uint32_t mesh, uint32_t *object);

/* The smallest scene of a session: a floor, and a triangle above it (crossing.h). */
struct test_raw_crossing {
    uint32_t scene, floor_mesh, mesh, floor, object;
};
/* Make it, with the triangle at `x`. All four return as test_raw_call. */
int test_raw_build(struct test_raw *raw, const char *name, const float x[3][3],
                   struct test_raw_crossing *crossing);

/* Write the way of an object's first `count` vertices to `x` into a slot, and publish it.
 * Return the request for the step. */
struct proto_FRAME_SUBMIT_request test_raw_move(const struct test_raw *raw, uint32_t slot,
                                                uint32_t scene, uint32_t object,
                                                const float (*x)[3], uint32_t count);
/* The same of the triangle to height z. */
struct proto_FRAME_SUBMIT_request test_raw_turn(const struct test_raw *raw, uint32_t slot,
                                                const struct test_raw_crossing *crossing,
                                                float z);

/* Give back the results up to what an answer says in `release`. */
void test_raw_release(const struct test_raw *raw, uint64_t release);

#endif
