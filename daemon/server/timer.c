/* timer.c - the service's timers, of libuv. */
#include <stdlib.h>
#include <uv.h>

#include "host.h"
#include "server.h"

struct srv_timer {
    uv_timer_t uv; /* first: the handle that is closed */
    void (*fire)(void *context);
    void *context;
};

static void on_timer(uv_timer_t *uv)
{
    const struct srv_timer *timer = (const struct srv_timer *)uv;
    timer->fire(timer->context);
}

struct srv_timer *srv_timer_new(struct srv_service *service, void (*fire)(void *context),
                                void *context)
{
    struct srv_timer *timer = malloc(sizeof *timer);
    if (timer != NULL) {
        uv_timer_init(&srv_server_of(service)->uv, &timer->uv);
        timer->fire = fire;
        timer->context = context;
    }
    return timer;
}

void srv_timer_start(struct srv_timer *timer, uint64_t after_ms, uint64_t every_ms)
{
    uv_update_time(timer->uv.loop);
    uv_timer_start(&timer->uv, on_timer, after_ms, every_ms);
}

void srv_timer_stop(struct srv_timer *timer)
{
    uv_timer_stop(&timer->uv);
}

static void on_closed(uv_handle_t *handle)
{
    free(handle); /* the timer's first member */
}

void srv_timer_free(struct srv_timer *timer)
{
    if (timer != NULL) {
        uv_close((uv_handle_t *)&timer->uv, on_closed);
    }
}
