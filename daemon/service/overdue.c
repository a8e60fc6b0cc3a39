/* overdue.c - steps whose deadline may come before their turn.
 *
 * Room:     service. See overdue.h.
 * Does:     a binary heap, whose members know their places, and one timer.
 * Threads:  [loop]
 */
#include "overdue.h"

#include <stdlib.h>

#include "host.h"
#include "invariant.h"
#include "now.h"
#include "request.h"

#define NS_PER_MS    1000000u
#define CAPACITY_MIN 64u

/* To answer one may copy 1 MiB. When many come at a time, what else the loop has to do
 * has its turn after that long. */
#define TURN_NS 500000u

static void put(struct srv_overdue *overdue, uint32_t at, struct srv_request *request)
{
    overdue->heap[at] = request;
    request->overdue_at = at;
}

/* `request` belongs at `at` or nearer to the first. */
static void rise(struct srv_overdue *overdue, uint32_t at, struct srv_request *request)
{
    while (at > 0 && request->deadline_ns < overdue->heap[(at - 1) / 2]->deadline_ns) {
        put(overdue, at, overdue->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    put(overdue, at, request);
}

/* `request` belongs at `at` or below it. */
static void sink(struct srv_overdue *overdue, uint32_t at, struct srv_request *request)
{
    for (uint32_t child = 2 * at + 1; child < overdue->count; child = 2 * at + 1) {
        if (child + 1 < overdue->count &&
            overdue->heap[child + 1]->deadline_ns < overdue->heap[child]->deadline_ns) {
            child++;
        }
        if (request->deadline_ns <= overdue->heap[child]->deadline_ns) {
            break;
        }
        put(overdue, at, overdue->heap[child]);
        at = child;
    }
    put(overdue, at, request);
}

/* For the first of them, `least_ms` from now or later; a millisecond is the finest that a
 * timer can be set to. */
static void set_timer(struct srv_overdue *overdue, uint64_t least_ms)
{
    if (overdue->count == 0) {
        srv_timer_stop(overdue->timer);
        return;
    }
    uint64_t now_ns = srv_now_ns();
    uint64_t deadline_ns = overdue->heap[0]->deadline_ns;
    uint64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
    uint64_t left_ms = left_ns / NS_PER_MS + (left_ns % NS_PER_MS != 0);
    srv_timer_start(overdue->timer, left_ms > least_ms ? left_ms : least_ms, 0);
}

static void on_timer(void *context)
{
    struct srv_overdue *overdue = context;
    uint64_t begin_ns = srv_now_ns();
    while (overdue->count > 0 && overdue->heap[0]->deadline_ns <= begin_ns &&
           srv_now_ns() - begin_ns < TURN_NS) {
        struct srv_request *request = overdue->heap[0];
        srv_overdue_remove(overdue, request);
        srv_request_overdue(request);
    }
    set_timer(overdue, 1); /* with 0, libuv would call this again at once */
}

int srv_overdue_init(struct srv_overdue *overdue, struct srv_loop *loop)
{
    overdue->timer = srv_timer_new(loop, on_timer, overdue);
    return overdue->timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_overdue_deinit(struct srv_overdue *overdue)
{
    PCCD_ASSERT(overdue->count == 0);
    free(overdue->heap);
    srv_timer_free(overdue->timer);
    *overdue = (struct srv_overdue){0};
}

int srv_overdue_reserve(struct srv_overdue *overdue)
{
    srv_assert_loop();
    if (overdue->count < overdue->capacity) {
        return 0;
    }
    uint32_t capacity = overdue->capacity == 0 ? CAPACITY_MIN : 2 * overdue->capacity;
    struct srv_request **heap =
        realloc(overdue->heap, capacity * sizeof(struct srv_request *));
    if (heap == NULL) {
        return PCCD_E_NOMEM;
    }
    overdue->heap = heap;
    overdue->capacity = capacity;
    return 0;
}

void srv_overdue_add(struct srv_overdue *overdue, struct srv_request *request)
{
    srv_assert_loop();
    PCCD_ASSERT(request->overdue_at == SRV_OVERDUE_NOWHERE);
    PCCD_ASSERT(overdue->count < overdue->capacity);
    rise(overdue, overdue->count++, request);
    if (request->overdue_at == 0) {
        set_timer(overdue, 0);
    }
}

void srv_overdue_remove(struct srv_overdue *overdue, struct srv_request *request)
{
    uint32_t at = request->overdue_at;
    if (at == SRV_OVERDUE_NOWHERE) {
        return;
    }
    request->overdue_at = SRV_OVERDUE_NOWHERE;
    struct srv_request *last = overdue->heap[--overdue->count];
    if (last != request) {
        rise(overdue, at, last);
        sink(overdue, last->overdue_at, last);
    }
    if (overdue->count == 0) {
        srv_timer_stop(overdue->timer); /* else it fires once for nothing */
    }
}
