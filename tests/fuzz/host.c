/* host.c - the daemon's server as a thread of the fuzzer's process. */
#include "host.h"

#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "commandline.h"
#include "fuzz_target.h"
#include "log.h"
#include "memory.h"
#include "raw.h"
#include "reactor.h"
#include "visitor.h"

#define BACKLOG     64
#define SHM_BYTES   (2u << 20)
#define TRIANGLES   20000u
#define WAIT_MS     120000 /* fuzzers run beside others, who have the processor first */
#define WAIT_ROUNDS 20000  /* of a millisecond */

static struct srv_options options;
static char folder[] = "/tmp/pccd-fuzz-XXXXXX";
static int fds_before;
static uint64_t bytes_before;
static pthread_t server;

static void *serve(void *context)
{
    (void)context;
    FUZZ_CHECK(srv_reactor_run(&options, NULL) == 0);
    return NULL;
}

static void remove_socket(void)
{
    (void)unlink(options.socket_path);
    (void)rmdir(folder);
}

/* Sockets and shared memory: a fuzzer may have opened other things. */
static int count_fds(void)
{
    int count = 0;
    DIR *entries = opendir("/proc/self/fd");
    FUZZ_CHECK(entries != NULL);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        char target[64] = "";
        if (readlinkat(dirfd(entries), entry->d_name, target, sizeof target - 1) > 0) {
            count +=
                strncmp(target, "socket:", 7) == 0 || strncmp(target, "/memfd:", 7) == 0;
        }
    }
    closedir(entries);
    return count;
}

static struct sockaddr_un address(void)
{
    struct sockaddr_un at = {.sun_family = AF_UNIX};
    strcpy(at.sun_path, options.socket_path);
    return at;
}

static void listen_there(void)
{
    FUZZ_CHECK(mkdtemp(folder) != NULL);
    snprintf(options.socket_path, sizeof options.socket_path, "%s/s", folder);
    struct sockaddr_un at = address();
    options.listen_fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    FUZZ_CHECK(options.listen_fd >= 0 &&
               bind(options.listen_fd, (struct sockaddr *)&at, sizeof at) == 0 &&
               listen(options.listen_fd, BACKLOG) == 0);
    atexit(remove_socket);
}

void fuzz_host_start(void)
{
    static bool is_started;
    if (is_started) {
        return;
    }
    is_started = true;
    fuzz_scarcity_pause();
    char *arguments[] = {(char *)(uintptr_t) "pccdd", NULL};
    srv_options_parse(&options, 1, arguments);
    options.threads_max = 1;
    options.pin = SRV_PIN_OFF;
    options.sandbox = SRV_SANDBOX_OFF;
    options.connections_max = 64;
    options.queue_max = 256;
    options.contacts_max = 4096;
    options.linger_s = 1;
    options.quota[SRV_QUOTA_CLIENTS] = 32;
    options.quota[SRV_QUOTA_SHM_BYTES] = SHM_BYTES;
    options.quota[SRV_QUOTA_MESHES] = 16;
    options.quota[SRV_QUOTA_TRIANGLES] = TRIANGLES;
    srv_log_set_level(SRV_LOG_ERROR);
    listen_there();
    test_raw_wait_ms = WAIT_MS;
    FUZZ_CHECK(pthread_create(&server, NULL, serve, NULL) == 0);
    for (int i = 0; i < 3; i++) { /* what is made once */
        fuzz_visit(options.socket_path);
    }
    usleep(100000);
    fds_before = count_fds();
    bytes_before = eng_alloc_bytes();
    fuzz_scarcity_resume();
}

const char *fuzz_host_socket(void)
{
    return options.socket_path;
}

int fuzz_host_connect(void)
{
    struct sockaddr_un at = address();
    int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    FUZZ_CHECK(fd >= 0 && connect(fd, (struct sockaddr *)&at, sizeof at) == 0);
    return fd;
}

/* Until all sessions are gone, those that wait for their clients, too. */
static void await_peace(void)
{
    int fds = count_fds();
    uint64_t bytes = eng_alloc_bytes();
    for (int i = 0; fds != fds_before || bytes != bytes_before; i++) {
        if (i == WAIT_ROUNDS) {
            fprintf(stderr, "%d descriptors and %llu bytes, were %d and %llu\n", fds,
                    (unsigned long long)bytes, fds_before,
                    (unsigned long long)bytes_before);
        }
        FUZZ_CHECK(i < WAIT_ROUNDS);
        usleep(1000);
        fds = count_fds();
        bytes = eng_alloc_bytes();
    }
}

void fuzz_host_check(void)
{
    await_peace();
    fuzz_visit(options.socket_path);
    await_peace();
}
