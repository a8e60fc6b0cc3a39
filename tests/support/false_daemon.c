/* false_daemon.c - a daemon that is played from a script. */
#include "false_daemon.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cases.h"
#include "daemon.h"
#include "seqpacket.h"
#include "shm.h"

struct false_daemon false_daemon;

/* ---- in the child ------------------------------------------------------------------ */

void false_take_client(void)
{
    if (false_daemon.socket > 0) {
        (void)close(false_daemon.socket);
    }
    false_daemon.socket = accept(false_daemon.listener, NULL, NULL);
}

int false_next(void)
{
    struct proto_error error;
    size_t bytes = 0;
    int fd_count = 0;

    if (proto_await(false_daemon.socket, false_daemon.message,
                    sizeof false_daemon.message, &bytes, NULL, &fd_count) != 0 ||
        proto_decode(false_daemon.decoder, false_daemon.message, bytes,
                     &false_daemon.envelope, &error) != 0) {
        _exit(0);
    }
    return false_daemon.envelope.method;
}

void false_answer(uint32_t id, int method, const void *result, const int *fds, int count)
{
    if (proto_encode_result(&false_daemon.encoder, id, method, result) != 0 ||
        proto_send(false_daemon.socket, false_daemon.encoder.data,
                   false_daemon.encoder.bytes, fds, count) != 0) {
        _exit(0);
    }
}

void false_refuse(int code, const char *text)
{
    struct proto_error error;

    (void)proto_error_set(&error, code, "%s", text);
    if (proto_encode_error(&false_daemon.encoder, false_daemon.envelope.id, &error) !=
            0 ||
        proto_send(false_daemon.socket, false_daemon.encoder.data,
                   false_daemon.encoder.bytes, NULL, 0) != 0) {
        _exit(0);
    }
}

void false_hello(uint32_t version)
{
    struct proto_HELLO_result result = {
        .version = version, .features = UINT64_MAX, .pid = FALSE_PID};

    if (false_next() == PROTO_METHOD_HELLO) {
        false_answer(false_daemon.envelope.id, PROTO_METHOD_HELLO, &result, NULL, 0);
    }
}

void false_attach(struct proto_SHM_ATTACH_result result, int fd_count)
{
    if (false_next() != PROTO_METHOD_SHM_ATTACH) {
        _exit(0);
    }
    false_attached(result, fd_count);
}

void false_attached(struct proto_SHM_ATTACH_result result, int fd_count)
{
    struct proto_memory upload = PROTO_MEMORY_NONE;
    struct proto_memory records = PROTO_MEMORY_NONE;
    int fds[2];

    if (proto_memory_create(&upload, "upload", FALSE_RING_BYTES, FALSE_RING_BYTES,
                            false) != 0 ||
        proto_memory_create(&records, "results", FALSE_RESULT_BYTES, FALSE_RESULT_BYTES,
                            true) != 0) {
        _exit(0);
    }
    /* Who finds none here knows that the memory is gone. */
    ((struct proto_upload *)upload.base)->header.magic = PROTO_UPLOAD_MAGIC;
    fds[0] = upload.fd;
    fds[1] = records.fd;
    false_answer(false_daemon.envelope.id, PROTO_METHOD_SHM_ATTACH, &result, fds,
                 fd_count);
}

const struct proto_SHM_ATTACH_result false_good_ring = {.upload_bytes = FALSE_RING_BYTES,
                                                        .result_bytes =
                                                            FALSE_RESULT_BYTES,
                                                        .slot_count = 4,
                                                        .slot_stride = 262144,
                                                        .inflight_max = 4};

void false_step(uint32_t id, uint64_t offset, uint64_t count, uint32_t bytes)
{
    struct proto_FRAME_SUBMIT_result result = {.offset = offset,
                                               .count = count,
                                               .total = count,
                                               .cursor = count,
                                               .record_bytes = bytes,
                                               .release = count * bytes};

    false_answer(id, PROTO_METHOD_FRAME_SUBMIT, &result, NULL, 0);
}

/* ---- in the test ------------------------------------------------------------------- */

void false_start(false_script script)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);

    (void)snprintf(false_daemon.directory, sizeof false_daemon.directory,
                   "/tmp/pccd-test-XXXXXX");
    assert_non_null(mkdtemp(false_daemon.directory));
    (void)snprintf(false_daemon.socket_path, sizeof false_daemon.socket_path, "%s/s",
                   false_daemon.directory);
    (void)snprintf(false_daemon.url, sizeof false_daemon.url, "unix:%s",
                   false_daemon.socket_path);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s",
                   false_daemon.socket_path);
    assert_true(listener >= 0);
    assert_ok(bind(listener, (const struct sockaddr *)&address, sizeof address));
    assert_int_equal(listen(listener, 4), 0);
    false_daemon.child = fork();
    assert_true(false_daemon.child >= 0);
    if (false_daemon.child == 0) {
        test_end_with_parent();
        false_daemon.listener = listener;
        false_daemon.decoder = proto_decoder_new();
        if (false_daemon.decoder == NULL) {
            _exit(1);
        }
        false_take_client();
        script();
        _exit(0);
    }
    (void)close(listener);
}

int false_stop(void **state)
{
    (void)state;
    if (false_daemon.child > 0) {
        (void)kill(false_daemon.child, SIGKILL);
        (void)waitpid(false_daemon.child, NULL, 0);
    }
    false_daemon.child = 0;
    (void)unlink(false_daemon.socket_path);
    (void)rmdir(false_daemon.directory);
    return 0;
}

int false_connect(struct pccd_client **client)
{
    struct pccd_options options;

    pccd_options_init(&options);
    options.url = false_daemon.url;
    options.timeout_ms = FALSE_TIMEOUT_MS;
    options.reconnect_ms = -1;
    return pccd_connect(&options, client);
}

struct pccd_client *false_connect_good(void)
{
    struct pccd_client *client = NULL;

    assert_int_equal(false_connect(&client), 0);
    assert_int_equal(pccd_daemon_pid(client), FALSE_PID);
    return client;
}
