/* raw.c - a peer that speaks the protocol without the library, well or badly. */
#include "raw.h"

#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto_direct.h"
#include "seqpacket.h"

#define DATAGRAMS_MAX 100000 /* messages skipped while waiting for one answer */

int test_raw_wait_ms = 10000;

/* A connected socket, or -1. */
static int connect_socket(const char *socket_path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", socket_path);
    if (fd >= 0 && connect(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        (void)close(fd);
        return -1;
    }
    return fd;
}

/* The service in this process. Returns a descriptor to poll, or -1. */
static int open_direct(struct test_raw *raw)
{
    const char *build = getenv("top_builddir");
    char path[512];
    char text[PROTO_DIRECT_TEXT_BYTES];
    proto_direct_fn entrance = NULL;
    void *library;
    void *symbol;

    (void)snprintf(path, sizeof path, "%s/.libs/%s", build != NULL ? build : ".",
                   PROTO_DIRECT_LIBRARY);
    library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    symbol = library != NULL ? dlsym(library, PROTO_DIRECT_SYMBOL) : NULL;
    memcpy(&entrance, &symbol, sizeof entrance);
    raw->host = entrance != NULL ? entrance(PROTO_DIRECT_VERSION) : NULL;
    if (raw->host == NULL || raw->host->open(&raw->line, text) != 0) {
        return -1;
    }
    return raw->host->descriptor(raw->line);
}

bool test_raw_reopen(struct test_raw *raw, const char *socket_path)
{
    (void)close(raw->socket);
    raw->socket = connect_socket(socket_path);
    return raw->socket >= 0;
}

bool test_raw_open(struct test_raw *raw, const char *socket_path)
{
    memset(raw, 0, sizeof *raw);
    raw->upload = raw->result = (struct proto_memory)PROTO_MEMORY_NONE;
    raw->next_id = 1;
    raw->socket = strcmp(socket_path, "direct:") == 0 ? open_direct(raw)
                                                      : connect_socket(socket_path);
    raw->decoder = proto_decoder_new();
    if (raw->socket < 0 || raw->decoder == NULL) {
        test_raw_close(raw);
        return false;
    }
    return true;
}

void test_raw_close(struct test_raw *raw)
{
    if (raw->line != NULL) {
        raw->host->close(raw->line);
    } else if (raw->socket >= 0) {
        (void)close(raw->socket);
    }
    raw->line = NULL;
    raw->socket = -1;
    proto_decoder_free(raw->decoder);
    raw->decoder = NULL;
    proto_memory_deinit(&raw->upload);
    proto_memory_deinit(&raw->result);
}

static bool send_fds(struct test_raw *raw, const void *bytes, size_t count,
                     const int *fds, int fd_count)
{
    union {
        struct cmsghdr header;
        char space[CMSG_SPACE(sizeof(int[PROTO_FDS_RECEIVED_MAX]))];
    } control;
    struct iovec part = {(void *)(uintptr_t)bytes, count};
    struct msghdr header = {.msg_iov = &part, .msg_iovlen = 1};
    ssize_t sent;

    if (raw->line != NULL) {
        return raw->host->send(raw->line, bytes, count) == 0;
    }
    if (fd_count > 0) {
        struct cmsghdr *rights;

        memset(&control, 0, sizeof control);
        header.msg_control = &control;
        header.msg_controllen = CMSG_SPACE((size_t)fd_count * sizeof(int));
        rights = CMSG_FIRSTHDR(&header);
        rights->cmsg_level = SOL_SOCKET;
        rights->cmsg_type = SCM_RIGHTS;
        rights->cmsg_len = CMSG_LEN((size_t)fd_count * sizeof(int));
        memcpy(CMSG_DATA(rights), fds, (size_t)fd_count * sizeof(int));
    }
    do {
        sent = sendmsg(raw->socket, &header, MSG_NOSIGNAL);
    } while (sent < 0 && errno == EINTR);
    return sent == (ssize_t)count;
}

bool test_raw_send(struct test_raw *raw, const void *bytes, size_t count, int fd_count)
{
    int fds[PROTO_FDS_RECEIVED_MAX];

    for (int i = 0; i < PROTO_FDS_RECEIVED_MAX; i++) {
        fds[i] = raw->socket;
    }
    return send_fds(raw, bytes, count, fds, fd_count);
}

bool test_raw_send_fd(struct test_raw *raw, const void *bytes, size_t count, int fd)
{
    struct pollfd watched = {.fd = raw->socket, .events = POLLOUT};

    return poll(&watched, 1, 5000) > 0 && send_fds(raw, bytes, count, &fd, 1);
}

/* One datagram; its descriptors, if it has exactly two, become the ring's memories. */
static int receive_bytes(struct test_raw *raw, size_t *bytes, int fds[PROTO_FDS_MAX],
                         int *fd_count)
{
    struct pollfd watched = {.fd = raw->socket, .events = POLLIN};
    int status;

    do { /* a fuzzer's alarm may ring */
        status = poll(&watched, 1, test_raw_wait_ms);
    } while (status < 0 && errno == EINTR);
    if (status <= 0) {
        return PCCD_E_TIMEOUT;
    }
    if (raw->line != NULL) {
        return raw->host->receive(raw->line, raw->message, sizeof raw->message, bytes,
                                  fds, fd_count);
    }
    status = proto_receive(raw->socket, raw->message, sizeof raw->message, bytes, fds,
                           fd_count);
    if (status == PCCD_E_DISCONNECTED) { /* a reset: what was said before it follows */
        status = proto_receive(raw->socket, raw->message, sizeof raw->message, bytes, fds,
                               fd_count);
    }
    return status;
}

int test_raw_receive(struct test_raw *raw)
{
    int fds[PROTO_FDS_MAX];
    int fd_count = 0;
    size_t bytes = 0;
    int status = receive_bytes(raw, &bytes, fds, &fd_count);

    if (status != 0) {
        return status;
    }
    status = proto_decode(raw->decoder, raw->message, bytes, &raw->envelope, &raw->error);
    if (fd_count == 2) { /* upload, results: mapped once their sizes are known */
        raw->upload.fd = fds[0];
        raw->result.fd = fds[1];
    } else if (fd_count > 0) {
        (void)close(fds[0]);
        return PCCD_E_BADMSG;
    }
    return status;
}

uint32_t test_raw_request(struct test_raw *raw, int method, const void *request)
{
    uint32_t id = raw->next_id++;

    if (proto_encode_request(&raw->encoder, id, method, request) != 0 ||
        !test_raw_send(raw, raw->encoder.data, raw->encoder.bytes, 0)) {
        return 0;
    }
    return id;
}

int test_raw_answer(struct test_raw *raw, uint32_t id, int method, void *result)
{
    for (int i = 0; i < DATAGRAMS_MAX; i++) {
        int status = test_raw_receive(raw);

        if (status != 0) {
            return status;
        }
        if (raw->envelope.kind != PROTO_RESPONSE || raw->envelope.id != id) {
            continue;
        }
        if (raw->envelope.failed) {
            raw->error = raw->envelope.error;
            return raw->error.code;
        }
        return result != NULL
                   ? proto_decode_body(&raw->envelope, &proto_messages[method].result,
                                       result, &raw->error)
                   : 0;
    }
    return PCCD_E_TIMEOUT;
}

int test_raw_call(struct test_raw *raw, int method, const void *request, void *result)
{
    uint32_t id = test_raw_request(raw, method, request);

    return id == 0 ? PCCD_E_DISCONNECTED : test_raw_answer(raw, id, method, result);
}

int test_raw_entry(struct test_raw *raw, const uint8_t **at, void *request,
                   const uint8_t **payload)
{
    struct proto_journal_entry entry;
    memcpy(&entry, *at, sizeof entry);
    *payload = *at + PROTO_JOURNAL_PAYLOAD(entry.message_bytes);
    int status = proto_decode(raw->decoder, *at + sizeof entry, entry.message_bytes,
                              &raw->envelope, &raw->error);
    *at += entry.bytes;
    if (status != 0 || entry.bytes % 8 != 0 || raw->envelope.kind != PROTO_REQUEST ||
        raw->envelope.method < 0 || *payload > *at) {
        return -1;
    }
    const struct proto_fields *fields = &proto_messages[raw->envelope.method].request;
    return proto_decode_body(&raw->envelope, fields, request, &raw->error) == 0
               ? raw->envelope.method
               : -1;
}

int test_raw_hello(struct test_raw *raw)
{
    struct proto_HELLO_result result;

    return RAW_CALL(raw, HELLO, &result, .version_min = PROTO_VERSION_MIN,
                    .version_max = PROTO_VERSION_MAX, .client = "raw");
}

int test_raw_hello_again(struct test_raw *raw, const struct proto_HELLO_result *resume,
                         struct proto_HELLO_result *result)
{
    struct proto_HELLO_request hello = {
        .version_min = 1, .version_max = 1, .client = "raw", .resumable = true};
    if (resume != NULL) {
        hello.resume_epoch = resume->epoch;
        hello.resume_session = resume->session;
        hello.token_hi = resume->token_hi;
        hello.token_lo = resume->token_lo;
    }
    return test_raw_call(raw, PROTO_METHOD_HELLO, &hello, result);
}

int test_raw_attach(struct test_raw *raw, uint32_t slot_count, uint64_t slot_bytes)
{
    const struct proto_SHM_ATTACH_request request = {.slot_count = slot_count,
                                                     .slot_bytes = slot_bytes,
                                                     .result_bytes =
                                                         PROTO_RESULT_BYTES_MIN};
    return test_raw_attach_as(raw, &request);
}

int test_raw_attach_as(struct test_raw *raw,
                       const struct proto_SHM_ATTACH_request *request)
{
    int status;

    proto_memory_deinit(&raw->upload);
    proto_memory_deinit(&raw->result);
    raw->upload = raw->result = (struct proto_memory)PROTO_MEMORY_NONE;
    status = test_raw_call(raw, PROTO_METHOD_SHM_ATTACH, request, &raw->ring);
    if (status != 0) {
        return status;
    }
    status =
        proto_memory_map(&raw->upload, raw->upload.fd, raw->ring.upload_bytes, false);
    if (status != 0) {
        return status;
    }
    return proto_memory_map(&raw->result, raw->result.fd, raw->ring.result_bytes, true);
}

int test_raw_session(struct test_raw *raw, const char *socket_path, uint32_t slot_count,
                     uint64_t slot_bytes)
{
    if (!test_raw_open(raw, socket_path)) {
        return PCCD_E_NODAEMON;
    }
    int status = test_raw_hello(raw);

    return status == 0 && slot_bytes > 0 ? test_raw_attach(raw, slot_count, slot_bytes)
                                         : status;
}

struct proto_upload *test_raw_upload(const struct test_raw *raw)
{
    return raw->upload.base;
}

uint8_t *test_raw_payload(const struct test_raw *raw, uint32_t slot)
{
    return (uint8_t *)raw->upload.base + sizeof(struct proto_upload) +
           slot * raw->ring.slot_stride;
}

uint64_t test_raw_publish(const struct test_raw *raw, uint32_t slot)
{
    struct proto_slot *descriptor = &test_raw_upload(raw)->slots[slot];
    uint64_t seq = (atomic_load(&descriptor->seq) | 1u) + 1u;

    atomic_store(&descriptor->seq, seq);
    return seq;
}

int test_raw_fill(struct test_raw *raw, uint32_t mesh, const float (*x)[3],
                  uint32_t vertex_count, const uint32_t (*triangles)[3],
                  uint32_t triangle_count)
{
    struct proto_MESH_DATA_request data = {
        .mesh = mesh, .slot = 0, .count = vertex_count};
    int status;

    memcpy(test_raw_payload(raw, 0), x, vertex_count * sizeof *x);
    data.seq = test_raw_publish(raw, 0);
    status = test_raw_call(raw, PROTO_METHOD_MESH_DATA, &data, NULL);
    if (status != 0) {
        return status;
    }
    memcpy(test_raw_payload(raw, 0), triangles, triangle_count * sizeof *triangles);
    data.part = 1;
    data.count = triangle_count;
    data.seq = test_raw_publish(raw, 0);
    return test_raw_call(raw, PROTO_METHOD_MESH_DATA, &data, NULL);
}

int test_raw_mesh(struct test_raw *raw, const float (*x)[3], uint32_t vertex_count,
                  const uint32_t (*triangles)[3], uint32_t triangle_count, uint32_t *mesh)
{
    struct proto_MESH_CREATE_result created;
    int status = RAW_CALL(raw, MESH_CREATE, &created, .vertex_count = vertex_count,
                          .triangle_count = triangle_count);

    if (status != 0) {
        return status;
    }
    *mesh = created.mesh;
    status = test_raw_fill(raw, *mesh, x, vertex_count, triangles, triangle_count);
    return status != 0 ? status : RAW_CALL(raw, MESH_COMMIT, NULL, .mesh = *mesh);
}
