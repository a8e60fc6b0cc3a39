/* deadlines.c - what has to happen at a time, the earliest first. */
#include "deadlines.h"

#include <stdlib.h>

#include "host.h"
#include "invariant.h"
#include "now.h"
#include "pccd_types.h"

#define NS_PER_MS    1000000u
#define CAPACITY_MIN 64u

/* To answer one may copy 1 MiB. When many come at a time, what else the loop has to do
 * has its turn after that long. */
#define TURN_NS 500000u

static void put(struct srv_deadlines *deadlines, uint32_t at,
                struct srv_deadline *deadline)
{
    deadlines->heap[at] = deadline;
    deadline->place = at;
}

/* `deadline` belongs at `at` or nearer to the first. */
static void rise(struct srv_deadlines *deadlines, uint32_t at,
                 struct srv_deadline *deadline)
{
    while (at > 0 && deadline->at_ns < deadlines->heap[(at - 1) / 2]->at_ns) {
        put(deadlines, at, deadlines->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    put(deadlines, at, deadline);
}

/* `deadline` belongs at `at` or below it. */
static void sink(struct srv_deadlines *deadlines, uint32_t at,
                 struct srv_deadline *deadline)
{
    for (uint32_t child = 2 * at + 1; child < deadlines->count; child = 2 * at + 1) {
        if (child + 1 < deadlines->count &&
            deadlines->heap[child + 1]->at_ns < deadlines->heap[child]->at_ns) {
            child++;
        }
        if (deadline->at_ns <= deadlines->heap[child]->at_ns) {
            break;
        }
        put(deadlines, at, deadlines->heap[child]);
        at = child;
    }
    put(deadlines, at, deadline);
}

/* For the first of them, `least_ms` from now or later; a millisecond is the finest that a
 * timer can be set to. */
static void set_timer(struct srv_deadlines *deadlines, uint64_t least_ms)
{
    if (deadlines->count == 0) {
        srv_timer_stop(deadlines->timer);
        return;
    }
    uint64_t now_ns = common_now_ns();
    uint64_t first_ns = deadlines->heap[0]->at_ns;
    uint64_t left_ns = first_ns > now_ns ? first_ns - now_ns : 0;
    uint64_t left_ms = left_ns / NS_PER_MS + (left_ns % NS_PER_MS != 0);
    srv_timer_start(deadlines->timer, left_ms > least_ms ? left_ms : least_ms, 0);
}

static void on_timer(void *context)
{
    struct srv_deadlines *deadlines = context;
    uint64_t begin_ns = common_now_ns();
    while (deadlines->count > 0 && deadlines->heap[0]->at_ns <= begin_ns &&
           common_now_ns() - begin_ns < TURN_NS) {
        struct srv_deadline *deadline = deadlines->heap[0];
        srv_deadlines_remove(deadlines, deadline);
        deadlines->come(deadline);
    }
    set_timer(deadlines, 1); /* with 0, libuv would call this again at once */
}

int srv_deadlines_init(struct srv_deadlines *deadlines, struct srv_service *service,
                       void (*come)(struct srv_deadline *deadline))
{
    deadlines->come = come;
    deadlines->timer = srv_timer_new(service, on_timer, deadlines);
    return deadlines->timer != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_deadlines_deinit(struct srv_deadlines *deadlines)
{
    PCCD_ASSERT(deadlines->count == 0);
    free(deadlines->heap);
    srv_timer_free(deadlines->timer);
    *deadlines = (struct srv_deadlines){0};
}

int srv_deadlines_reserve(struct srv_deadlines *deadlines)
{
    srv_assert_loop();
    if (deadlines->count < deadlines->capacity) {
        return 0;
    }
    uint32_t capacity = deadlines->capacity == 0 ? CAPACITY_MIN : 2 * deadlines->capacity;
    struct srv_deadline **heap =
        realloc(deadlines->heap, capacity * sizeof(struct srv_deadline *));
    if (heap == NULL) {
        return PCCD_E_NOMEM;
    }
    deadlines->heap = heap;
    deadlines->capacity = capacity;
    return 0;
}

void srv_deadlines_add(struct srv_deadlines *deadlines, struct srv_deadline *deadline)
{
    srv_assert_loop();
    PCCD_ASSERT(deadline->place == SRV_DEADLINE_NOWHERE);
    PCCD_ASSERT(deadlines->count < deadlines->capacity);
    rise(deadlines, deadlines->count++, deadline);
    if (deadline->place == 0) {
        set_timer(deadlines, 0);
    }
}

void srv_deadlines_remove(struct srv_deadlines *deadlines, struct srv_deadline *deadline)
{
    uint32_t at = deadline->place;
    if (at == SRV_DEADLINE_NOWHERE) {
        return;
    }
    deadline->place = SRV_DEADLINE_NOWHERE;
    struct srv_deadline *last = deadlines->heap[--deadlines->count];
    if (last != deadline) {
        rise(deadlines, at, last);
        sink(deadlines, last->place, last);
    }
    if (deadlines->count == 0) {
        srv_timer_stop(deadlines->timer); /* else it fires once for nothing */
    }
}
