/* rank_stop.c - ends a step or a question on all ranks before it is done. */
#include "rank_stop.h"

#include <stdlib.h>

#include "clock.h"

#define STOP_TAG 18

/* Between two looks for messages while libpccd computes: one takes 0.02 us (MPICH) to
 * 4 us (Open MPI). libpccd asks every 4 us as a rule, and the clock takes 0.03 us. */
#define LOOK_NS         1000000u
#define ASKED_PER_CLOCK 16u

int ranks_stop_init(struct ranks_stop *stop, struct ranks_link *link)
{
    *stop = (struct ranks_stop){.link = link};
    atomic_init(&stop->is_cancelled, false);
    stop->requests = ranks_array(2 * (uint64_t)link->size, sizeof(MPI_Request));
    return stop->requests == NULL ? ranks_link_no_memory(link) : PCCD_OK;
}

void ranks_stop_deinit(struct ranks_stop *stop)
{
    free((void *)stop->requests);
    stop->requests = NULL;
}

void ranks_stop_cancel(struct ranks_stop *stop)
{
    atomic_store(&stop->is_cancelled, true);
}

void ranks_stop_begin(struct ranks_stop *stop)
{
    stop->end_ns = 0;
    stop->is_set = false;
    stop->said = stop->heard = 0;
    atomic_store(&stop->is_cancelled, false);
}

void ranks_stop_limit(struct ranks_stop *stop, uint64_t deadline_ns)
{
    uint64_t now_ns = common_now_ns();
    stop->end_ns = deadline_ns == 0                    ? 0
                   : deadline_ns > UINT64_MAX - now_ns ? UINT64_MAX
                                                       : now_ns + deadline_ns;
}

/* ---- why --------------------------------------------------------------------------- */

static bool is_cancelled(const struct ranks_stop *stop)
{
    return atomic_load_explicit(&stop->is_cancelled, memory_order_relaxed);
}

enum pccd_incomplete ranks_stop_reason(struct ranks_stop *stop)
{
    stop->is_set = stop->is_set || is_cancelled(stop);
    return stop->is_set ? PCCD_INCOMPLETE_CANCELLED
           : stop->end_ns != 0 && common_now_ns() >= stop->end_ns
               ? PCCD_INCOMPLETE_DEADLINE
               : PCCD_COMPLETE;
}

int ranks_stop_agree(struct ranks_stop *stop, enum pccd_incomplete *reason)
{
    uint8_t mine = (uint8_t)ranks_stop_reason(stop);
    int status = ranks_max_bytes(stop->link, &mine, 1);
    *reason = (enum pccd_incomplete)mine;
    stop->is_set |= *reason == PCCD_INCOMPLETE_CANCELLED;
    return status;
}

uint64_t ranks_stop_rest(const struct ranks_stop *stop)
{
    uint64_t now_ns = common_now_ns();
    return stop->end_ns == 0 ? 0 : now_ns < stop->end_ns ? stop->end_ns - now_ns : 1;
}

/* ---- messages ---------------------------------------------------------------------- */

static void hear(struct ranks_stop *stop)
{
    struct ranks_link *link = stop->link;
    int is_there = link->size > 1;
    while (is_there && link->broken == PCCD_OK) {
        int code = MPI_Iprobe(MPI_ANY_SOURCE, STOP_TAG, link->comm, &is_there,
                              MPI_STATUS_IGNORE);
        if (ranks_mpi(link, code, "MPI_Iprobe") == PCCD_OK && is_there) {
            code = MPI_Recv(NULL, 0, MPI_BYTE, MPI_ANY_SOURCE, STOP_TAG, link->comm,
                            MPI_STATUS_IGNORE);
            (void)ranks_mpi(link, code, "MPI_Recv");
            stop->heard++;
            stop->is_set = true;
        }
    }
}

static void say(struct ranks_stop *stop)
{
    struct ranks_link *link = stop->link;
    stop->is_set = true;
    stop->said = 1;
    for (int turn = 1; turn < link->size && link->broken == PCCD_OK; turn++) {
        int code = MPI_Isend(NULL, 0, MPI_BYTE, (link->rank + turn) % link->size,
                             STOP_TAG, link->comm, &stop->requests[stop->request_count]);
        stop->request_count += ranks_mpi(link, code, "MPI_Isend") == PCCD_OK;
    }
}

void ranks_stop_say(struct ranks_stop *stop)
{
    hear(stop);
    if (!stop->is_set) {
        say(stop);
    }
}

bool ranks_stop_look(void *asked)
{
    struct ranks_stop *stop = asked;
    if (stop->is_set || !stop->is_open) {
        return stop->is_set;
    }
    if (is_cancelled(stop)) {
        ranks_stop_say(stop);
        return true;
    }
    if (stop->link->size > 1 && ++stop->asked % ASKED_PER_CLOCK == 0) {
        uint64_t now_ns = common_now_ns();
        if (now_ns >= stop->next_ns) {
            stop->next_ns = now_ns + LOOK_NS;
            hear(stop);
        }
    }
    return stop->is_set || stop->link->broken != PCCD_OK;
}

/* This rank waits for those who still compute. */
static void look_meanwhile(void *context)
{
    struct ranks_stop *stop = context;
    if (is_cancelled(stop) && !stop->is_set) {
        ranks_stop_say(stop);
    } else {
        hear(stop);
    }
}

void ranks_stop_open(struct ranks_stop *stop)
{
    stop->is_open = true;
    stop->next_ns = common_now_ns() + LOOK_NS;
    stop->link->meanwhile = look_meanwhile;
    stop->link->context = stop;
}

void ranks_stop_close(struct ranks_stop *stop)
{
    stop->is_open = false;
    stop->link->meanwhile = NULL;
}

int ranks_stop_settle(struct ranks_stop *stop, uint64_t said)
{
    struct ranks_link *link = stop->link;
    for (; stop->heard + stop->said < said && link->broken == PCCD_OK; stop->heard++) {
        int code = MPI_Irecv(NULL, 0, MPI_BYTE, MPI_ANY_SOURCE, STOP_TAG, link->comm,
                             &stop->requests[stop->request_count]);
        stop->request_count += ranks_mpi(link, code, "MPI_Irecv") == PCCD_OK;
    }
    int status = ranks_wait(link, stop->requests, stop->request_count);
    stop->request_count = 0;
    return status;
}

int ranks_stop_settle_alone(struct ranks_stop *stop)
{
    uint64_t said = stop->said;
    int status = ranks_sum(stop->link, &said, 1);
    return status == PCCD_OK ? ranks_stop_settle(stop, said) : status;
}
