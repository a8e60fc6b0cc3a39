/* closer.c - closes descriptors on a thread of its own. */
#include "watch.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "invariant.h"
#include "log.h"

#define PATIENCE_MS     1000
#define DESCRIPTORS_MAX (1u << 20) /* believed of a system that sets no limit */

/* With so many to close the loop waits a little rather than take more: who sends them
 * fast could use them all up. Not again while none of them closes. */
#define CALM_MAX 256u
#define CALM_MS  100

struct srv_closer {
    pthread_t thread;
    pthread_mutex_t mutex; /* everything below */
    pthread_cond_t wake;   /* there is one to close, or stop */
    pthread_cond_t calm;   /* fewer than CALM_MAX are left, or the thread has ended */
    uint64_t closed;       /* since the start */
    uint64_t stuck_at;     /* `closed` when the loop has waited in vain */
    bool stop;
    bool has_ended; /* the thread, but for its return */
    uint32_t first; /* in the ring */
    uint32_t count;
    uint32_t capacity;
    int fds[];
};

static void *closer_main(void *context)
{
    struct srv_closer *closer = context;
    pthread_mutex_lock(&closer->mutex);
    for (;;) { /* ends when stopped and nothing is left */
        while (closer->count == 0 && !closer->stop) {
            pthread_cond_wait(&closer->wake, &closer->mutex);
        }
        if (closer->count == 0) {
            break;
        }
        int fd = closer->fds[closer->first];
        closer->first = (closer->first + 1) % closer->capacity;
        closer->count--;
        pthread_mutex_unlock(&closer->mutex);
        close(fd);
        pthread_mutex_lock(&closer->mutex);
        closer->closed++;
        if (closer->count + 1 == CALM_MAX) {
            pthread_cond_signal(&closer->calm);
        }
    }
    closer->has_ended = true;
    pthread_cond_signal(&closer->calm);
    pthread_mutex_unlock(&closer->mutex);
    return NULL;
}

/* Descriptors that the process may have. */
static uint32_t descriptor_limit(void)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur > DESCRIPTORS_MAX) {
        return DESCRIPTORS_MAX;
    }
    return (uint32_t)limit.rlim_cur;
}

struct srv_closer *srv_closer_new(void)
{
    uint32_t capacity = descriptor_limit();
    struct srv_closer *closer =
        malloc(sizeof *closer + (size_t)capacity * sizeof closer->fds[0]);
    if (closer == NULL) {
        return NULL;
    }
    *closer = (struct srv_closer){.capacity = capacity, .stuck_at = UINT64_MAX};
    pthread_mutex_init(&closer->mutex, NULL); /* neither fails on Linux */
    pthread_cond_init(&closer->wake, NULL);
    pthread_condattr_t monotonic; /* whoever sets the clock back holds up nobody */
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&closer->calm, &monotonic);
    pthread_condattr_destroy(&monotonic);
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&closer->thread, NULL, closer_main, closer);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed != 0) {
        free(closer);
        return NULL;
    }
    return closer;
}

/* CLOCK_MONOTONIC, as `calm` waits by. */
static struct timespec after(long ms)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += ms / 1000;
    until.tv_nsec += ms % 1000 * 1000000;
    if (until.tv_nsec >= 1000000000) {
        until.tv_nsec -= 1000000000;
        until.tv_sec++;
    }
    return until;
}

void srv_closer_free(struct srv_closer *closer)
{
    if (closer == NULL) {
        return;
    }
    const struct timespec until = after(PATIENCE_MS);
    int status = 0;
    pthread_mutex_lock(&closer->mutex);
    closer->stop = true;
    pthread_cond_signal(&closer->wake);
    while (!closer->has_ended && status == 0) {
        status = pthread_cond_timedwait(&closer->calm, &closer->mutex, &until);
    }
    bool has_ended = closer->has_ended;
    pthread_mutex_unlock(&closer->mutex);
    if (!has_ended) {
        srv_log(SRV_LOG_WARN, 0, "a descriptor of a client does not close; leaving it");
        return; /* its thread still uses it */
    }
    pthread_join(closer->thread, NULL);
    pthread_cond_destroy(&closer->wake);
    pthread_cond_destroy(&closer->calm);
    pthread_mutex_destroy(&closer->mutex);
    free(closer);
}

/* Locked. */
static void wait_for_calm(struct srv_closer *closer)
{
    const struct timespec until = after(CALM_MS);
    int status = 0;
    while (closer->count >= CALM_MAX && status == 0) {
        status = pthread_cond_timedwait(&closer->calm, &closer->mutex, &until);
    }
    if (closer->count >= CALM_MAX) {
        closer->stuck_at = closer->closed;
    }
}

void srv_closer_push(struct srv_closer *closer, int fd)
{
    srv_assert_loop();
    PCCD_ASSERT(fd >= 0);
    pthread_mutex_lock(&closer->mutex);
    /* Each descriptor is here once, and was made below the limit. */
    PCCD_ASSERT(closer->count < closer->capacity);
    closer->fds[(closer->first + closer->count) % closer->capacity] = fd;
    closer->count++;
    pthread_cond_signal(&closer->wake);
    if (closer->count >= CALM_MAX && closer->stuck_at != closer->closed) {
        wait_for_calm(closer);
    }
    pthread_mutex_unlock(&closer->mutex);
}
