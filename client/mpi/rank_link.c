/* rank_link.c - what ranks say to each other. */
#include "rank_link.h"

#include <inttypes.h>
#include <sched.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clock.h"

#define CHUNK_BYTES (1u << 30) /* of a message: counts of MPI-3.1 are int */
#define TAG         17

/* Times to look again at once, then to give the processor away, before sleeping. */
#define SPIN_NS  20000u
#define YIELD_NS 2000000u
#define SLEEP_NS 50000

void *ranks_array(uint64_t count, size_t item_bytes)
{
    return count < SIZE_MAX / item_bytes / 2 ? malloc((size_t)(count + 1) * item_bytes)
                                             : NULL;
}

int ranks_fail(struct ranks_link *link, int status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(link->text, sizeof link->text, format, arguments);
    va_end(arguments);
    return status;
}

int ranks_missing(struct ranks_link *link, const char *what)
{
    return ranks_fail(link, PCCD_E_INVAL, "rank %d: %s is NULL", link->rank, what);
}

int ranks_link_no_memory(struct ranks_link *link)
{
    return ranks_fail(link, PCCD_E_NOMEM, "rank %d: out of memory", link->rank);
}

int ranks_mpi(struct ranks_link *link, int code, const char *what)
{
    if (code == MPI_SUCCESS) {
        return link->broken;
    }
    char text[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    MPI_Error_string(code, text, &length);
    link->broken = PCCD_E_SYSTEM;
    return ranks_fail(link, PCCD_E_SYSTEM, "rank %d: MPI: %s: %.300s", link->rank, what,
                      text);
}

/* ---- waiting ---------------------------------------------------------------------- */

static void pause_after(uint64_t waited_ns)
{
    if (waited_ns > YIELD_NS) {
        nanosleep(&(struct timespec){.tv_nsec = SLEEP_NS}, NULL);
    } else if (waited_ns > SPIN_NS) {
        sched_yield();
    }
}

int ranks_wait(struct ranks_link *link, MPI_Request *requests, int count)
{
    uint64_t begin_ns = common_now_ns();
    uint64_t limit_ns = (uint64_t)link->timeout_ms * 1000000u;
    for (int done = 0; done < count && link->broken == PCCD_OK;) {
        int is_done = 0;
        int code = MPI_Test(&requests[done], &is_done, MPI_STATUS_IGNORE);
        if (ranks_mpi(link, code, "waiting") != PCCD_OK || is_done) {
            done++;
            continue;
        }
        if (link->meanwhile != NULL) {
            link->meanwhile(link->context);
        }
        uint64_t waited_ns = common_now_ns() - begin_ns;
        if (waited_ns > limit_ns) {
            link->broken = PCCD_E_TIMEOUT;
            return ranks_fail(link, PCCD_E_TIMEOUT,
                              "rank %d: another rank did not come within %g s",
                              link->rank, link->timeout_ms / 1e3);
        }
        pause_after(waited_ns);
    }
    return link->broken;
}

static int await_one(struct ranks_link *link, int code, const char *what,
                     MPI_Request *request)
{
    int status = ranks_mpi(link, code, what);
    return status == PCCD_OK ? ranks_wait(link, request, 1) : status;
}

/* ---- numbers of all ranks --------------------------------------------------------- */

/* Memory that MPI writes to: after a timeout it may do so at any time, so the memory is
 * left to it then. */
static void *shared_array(struct ranks_link *link, uint64_t count, size_t item_bytes)
{
    void *array = ranks_array(count, item_bytes);
    if (array == NULL) { /* the others wait for what never comes */
        link->broken = PCCD_E_NOMEM;
        (void)ranks_link_no_memory(link);
    }
    return array;
}

static int take_array(int status, void *to, void *array, size_t bytes)
{
    if (status == PCCD_OK) {
        memcpy(to, array, bytes);
        free(array);
    }
    return status;
}

int ranks_tell_all(struct ranks_link *link, uint64_t mine, uint64_t *all)
{
    MPI_Request request;
    uint64_t *heard = shared_array(link, (uint64_t)link->size + 1, sizeof *heard);
    if (heard == NULL) {
        return link->broken;
    }
    heard[link->size] = mine;
    int status = await_one(link,
                           MPI_Iallgather(&heard[link->size], 1, MPI_UINT64_T, heard, 1,
                                          MPI_UINT64_T, link->comm, &request),
                           "MPI_Iallgather", &request);
    return take_array(status, all, heard, (size_t)link->size * sizeof *heard);
}

static int reduce(struct ranks_link *link, void *numbers, int count, size_t item_bytes,
                  MPI_Datatype type, MPI_Op op)
{
    MPI_Request request;
    if (count == 0 || link->broken != PCCD_OK) {
        return link->broken;
    }
    size_t bytes = (size_t)count * item_bytes;
    void *array = shared_array(link, (uint64_t)count, item_bytes);
    if (array == NULL) {
        return link->broken;
    }
    memcpy(array, numbers, bytes);
    int status = await_one(
        link, MPI_Iallreduce(MPI_IN_PLACE, array, count, type, op, link->comm, &request),
        "MPI_Iallreduce", &request);
    return take_array(status, numbers, array, bytes);
}

int ranks_sum(struct ranks_link *link, uint64_t *numbers, int count)
{
    return reduce(link, numbers, count, sizeof *numbers, MPI_UINT64_T, MPI_SUM);
}

int ranks_max_bytes(struct ranks_link *link, uint8_t *bytes, int count)
{
    return reduce(link, bytes, count, 1, MPI_UINT8_T, MPI_MAX);
}

int ranks_min_doubles(struct ranks_link *link, double *numbers, int count)
{
    return reduce(link, numbers, count, sizeof *numbers, MPI_DOUBLE, MPI_MIN);
}

int ranks_max_doubles(struct ranks_link *link, double *numbers, int count)
{
    return reduce(link, numbers, count, sizeof *numbers, MPI_DOUBLE, MPI_MAX);
}

/* ---- agreement -------------------------------------------------------------------- */

/* Message of a rank at the beginning of a call. */
struct head {
    uint64_t number; /* of its calls */
    uint64_t call;   /* enum ranks_call */
    uint64_t arguments;
    int64_t status;
};
#define HEAD_WORDS ((int)(sizeof(struct head) / sizeof(uint64_t)))

static const char *const call_names[] = {
    [RANKS_OPEN] = "pccd_mpi_open",
    [RANKS_MESH_PUT] = "pccd_mpi_mesh_put",
    [RANKS_MESH_DESTROY] = "pccd_mpi_mesh_destroy",
    [RANKS_ADD] = "pccd_mpi_add",
    [RANKS_REMOVE] = "pccd_mpi_remove",
    [RANKS_OBJECT_SET] = "pccd_mpi_object_set",
    [RANKS_PAIR_IGNORE] = "pccd_mpi_pair_ignore",
    [RANKS_STEP] = "pccd_mpi_step",
    [RANKS_NEAR] = "pccd_mpi_near",
    [RANKS_GATHER] = "pccd_mpi_gather",
    [RANKS_GET_SHARE] = "pccd_mpi_get_share",
    [RANKS_INSIDE] = "what is inside another call",
};

static const char *name_of(uint64_t call)
{
    return call <= RANKS_INSIDE ? call_names[call] : "something unknown";
}

/* The text of the rank that failed, on every rank. */
static int hear_of(struct ranks_link *link, int rank, int status)
{
    MPI_Request request;
    int heard = await_one(
        link,
        MPI_Ibcast(link->text, RANKS_TEXT_BYTES, MPI_CHAR, rank, link->comm, &request),
        "MPI_Ibcast", &request);
    return heard == PCCD_OK ? status : heard;
}

static int judge(struct ranks_link *link, const struct head *heads)
{
    for (int r = 1; r < link->size; r++) {
        if (heads[r].call != heads[0].call || heads[r].number != heads[0].number) {
            return ranks_fail(link, PCCD_E_STATE,
                              "rank %d called %s (its call %" PRIu64
                              "), rank 0 %s (its call %" PRIu64 ")",
                              r, name_of(heads[r].call), heads[r].number,
                              name_of(heads[0].call), heads[0].number);
        }
    }
    for (int r = 0; r < link->size; r++) {
        if (heads[r].status != PCCD_OK) {
            return hear_of(link, r, (int)heads[r].status);
        }
    }
    for (int r = 1; r < link->size; r++) {
        if (heads[r].arguments != heads[0].arguments) {
            return ranks_fail(link, PCCD_E_INVAL,
                              "rank %d gave other arguments to %s than rank 0", r,
                              name_of(heads[0].call));
        }
    }
    return PCCD_OK;
}

int ranks_agree(struct ranks_link *link, enum ranks_call call, uint64_t arguments,
                int status)
{
    if (link->broken != PCCD_OK) {
        return ranks_fail(link, PCCD_E_STATE,
                          "rank %d: an earlier call has ended this world", link->rank);
    }
    struct head *heads = shared_array(link, (uint64_t)link->size + 1, sizeof *heads);
    MPI_Request request;
    if (heads == NULL) {
        return link->broken;
    }
    heads[link->size] = (struct head){link->calls++, call, arguments, status};
    int heard =
        await_one(link,
                  MPI_Iallgather(&heads[link->size], HEAD_WORDS, MPI_UINT64_T, heads,
                                 HEAD_WORDS, MPI_UINT64_T, link->comm, &request),
                  "MPI_Iallgather", &request);
    if (heard != PCCD_OK) {
        return heard; /* MPI may still write to heads */
    }
    heard = judge(link, heads);
    free(heads);
    return heard;
}

int ranks_agree_on(struct ranks_link *link, int status)
{
    return link->broken != PCCD_OK ? link->broken
                                   : ranks_agree(link, RANKS_INSIDE, 0, status);
}

/* ---- arrays ----------------------------------------------------------------------- */

static uint64_t chunks_of(uint64_t bytes)
{
    return (bytes + CHUNK_BYTES - 1) / CHUNK_BYTES;
}

/* Return how many messages come or go. */
static uint64_t count_messages(const struct ranks_link *link, size_t item_bytes,
                               const uint64_t *first)
{
    uint64_t count = 0;
    for (int r = 0; r < link->size; r++) {
        count += r == link->rank ? 0 : chunks_of((first[r + 1] - first[r]) * item_bytes);
    }
    return count;
}

/* Messages that are under way. */
struct messages {
    MPI_Request *requests;
    int begun; /* of these */
    int status;
};

/* Begin to send to a rank, or to receive from it. */
static void begin(struct ranks_link *link, bool sends, char *bytes, uint64_t count,
                  int rank, struct messages *messages)
{
    for (uint64_t at = 0; at < count && messages->status == PCCD_OK; at += CHUNK_BYTES) {
        MPI_Request *request = &messages->requests[messages->begun];
        int length = (int)(count - at < CHUNK_BYTES ? count - at : CHUNK_BYTES);
        int code =
            sends
                ? MPI_Isend(bytes + at, length, MPI_BYTE, rank, TAG, link->comm, request)
                : MPI_Irecv(bytes + at, length, MPI_BYTE, rank, TAG, link->comm, request);
        messages->status = ranks_mpi(link, code, sends ? "MPI_Isend" : "MPI_Irecv");
        messages->begun += messages->status == PCCD_OK;
    }
}

/* Nothing is received any more into memory that the caller will free. */
static void give_up(struct messages *messages)
{
    for (int i = 0; i < messages->begun; i++) {
        if (messages->requests[i] != MPI_REQUEST_NULL) {
            MPI_Cancel(&messages->requests[i]);
            MPI_Request_free(&messages->requests[i]);
        }
    }
}

int ranks_swap_into(struct ranks_link *link, size_t item_bytes, const void *out,
                    const uint64_t *first_out, void *const *in, const uint64_t *first_in)
{
    uint64_t count = count_messages(link, item_bytes, first_out) +
                     count_messages(link, item_bytes, first_in);
    struct messages messages = {.requests =
                                    shared_array(link, count, sizeof(MPI_Request)),
                                .status = link->broken};
    if (messages.requests == NULL) {
        return link->broken;
    }
    for (int turn = 1; turn < link->size; turn++) {
        int r = (link->rank + link->size - turn) % link->size;
        begin(link, false, in[r], (first_in[r + 1] - first_in[r]) * item_bytes, r,
              &messages);
    }
    for (int turn = 1; turn < link->size; turn++) {
        int r = (link->rank + turn) % link->size;
        uint64_t bytes = (first_out[r + 1] - first_out[r]) * item_bytes;
        begin(link, true, (char *)(uintptr_t)out + first_out[r] * item_bytes, bytes, r,
              &messages);
        link->sent_bytes += bytes;
    }
    if (messages.status == PCCD_OK) {
        messages.status = ranks_wait(link, messages.requests, messages.begun);
    }
    if (messages.status != PCCD_OK) {
        give_up(&messages);
    }
    free((void *)messages.requests);
    return messages.status;
}

int ranks_swap(struct ranks_link *link, size_t item_bytes, const void *out,
               const uint64_t *first_out, void *in, const uint64_t *first_in)
{
    const int own = link->rank;
    void **places = shared_array(link, (uint64_t)link->size, sizeof *places);
    if (places == NULL) {
        return link->broken;
    }
    for (int r = 0; r < link->size; r++) {
        places[r] = (char *)in + first_in[r] * item_bytes;
    }
    if (first_out[own + 1] > first_out[own]) {
        memcpy(places[own], (const char *)out + first_out[own] * item_bytes,
               (first_out[own + 1] - first_out[own]) * item_bytes);
    }
    int status = ranks_swap_into(link, item_bytes, out, first_out, places, first_in);
    free((void *)places);
    return status;
}

/* Collective: memory for what comes, counts[r] items of rank r. */
static int make_room(struct ranks_link *link, size_t item_bytes, const uint64_t *counts,
                     void **in, uint64_t *first_in)
{
    first_in[0] = 0;
    for (int r = 0; r < link->size; r++) {
        first_in[r + 1] = first_in[r] + counts[r];
    }
    *in = ranks_array(first_in[link->size], item_bytes);
    return ranks_agree_on(link, *in != NULL ? PCCD_OK : ranks_link_no_memory(link));
}

int ranks_deal(struct ranks_link *link, size_t item_bytes, const void *out,
               const uint64_t *first_out, void **in, uint64_t *first_in)
{
    int size = link->size;
    uint64_t *counts = shared_array(link, 2 * (uint64_t)size, sizeof *counts);
    MPI_Request request;
    *in = NULL;
    if (counts == NULL) {
        return link->broken;
    }
    for (int r = 0; r < size; r++) {
        counts[r] = first_out[r + 1] - first_out[r];
    }
    int status = await_one(link,
                           MPI_Ialltoall(counts, 1, MPI_UINT64_T, counts + size, 1,
                                         MPI_UINT64_T, link->comm, &request),
                           "MPI_Ialltoall", &request);
    if (status != PCCD_OK) {
        return status; /* MPI may still write there */
    }
    status = make_room(link, item_bytes, counts + size, in, first_in);
    free(counts);
    if (status == PCCD_OK) {
        status = ranks_swap(link, item_bytes, out, first_out, *in, first_in);
    }
    if (status != PCCD_OK && link->broken == PCCD_OK) {
        free(*in);
        *in = NULL;
    }
    return status;
}

int ranks_ask(struct ranks_link *link, const struct ranks_question *question,
              const void *items, const uint64_t *first, void *answers)
{
    uint64_t *first_in = shared_array(link, (uint64_t)link->size + 1, sizeof *first_in);
    void *asked = NULL, *made = NULL;
    if (first_in == NULL) {
        return link->broken;
    }
    int status = ranks_deal(link, question->item_bytes, items, first, &asked, first_in);
    if (status == PCCD_OK) {
        made = ranks_array(first_in[link->size], question->answer_bytes);
        status =
            ranks_agree_on(link, made != NULL ? PCCD_OK : ranks_link_no_memory(link));
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(
            link, question->answer(question->context, asked, first_in[link->size], made));
    }
    if (status == PCCD_OK) {
        status = ranks_swap(link, question->answer_bytes, made, first_in, answers, first);
    }
    free(first_in);
    free(asked);
    free(made);
    return status;
}

void ranks_post_begin(struct ranks_post *post, size_t item_bytes, uint64_t room)
{
    *post = (struct ranks_post){.item_bytes = item_bytes,
                                .items = ranks_array(room, item_bytes),
                                .to = ranks_array(room, sizeof *post->to),
                                .room = room};
    post->is_lost = post->items == NULL || post->to == NULL;
}

static void grow(struct ranks_post *post)
{
    uint64_t room = post->room + post->room / 2 + 1024;
    void *items = realloc(post->items, room * post->item_bytes);
    post->items = items != NULL ? items : post->items;
    uint32_t *to = realloc(post->to, room * sizeof *to);
    post->to = to != NULL ? to : post->to;
    post->is_lost = items == NULL || to == NULL;
    post->room = room;
}

void *ranks_post_room(struct ranks_post *post, uint32_t to)
{
    if (post->count == post->room && !post->is_lost) {
        grow(post);
    }
    if (post->is_lost) {
        return NULL;
    }
    post->to[post->count] = to;
    return (char *)post->items + post->count++ * post->item_bytes;
}

void ranks_post_add(struct ranks_post *post, uint32_t to, const void *item)
{
    void *room = ranks_post_room(post, to);
    if (room != NULL) {
        memcpy(room, item, post->item_bytes);
    }
}

/* Send what all ranks had memory for. */
static int deal_post(struct ranks_link *link, const struct ranks_post *post, void **in,
                     uint64_t *in_count)
{
    const size_t size = (size_t)link->size, item_bytes = post->item_bytes;
    const uint64_t count = post->count;
    const uint32_t *to = post->to;
    uint64_t *first = shared_array(link, 3 * (size + 1), sizeof *first);
    char *out = shared_array(link, count, item_bytes);
    int status = link->broken;
    if (status == PCCD_OK) {
        uint64_t *next = first + size + 1, *first_in = next + size + 1;
        memset(first, 0, (size + 1) * sizeof *first);
        for (uint64_t i = 0; i < count; i++) {
            first[to[i] + 1]++;
        }
        for (size_t r = 0; r < size; r++) {
            first[r + 1] += first[r];
        }
        memcpy(next, first, size * sizeof *next);
        for (uint64_t i = 0; i < count; i++) {
            memcpy(out + next[to[i]]++ * item_bytes,
                   (const char *)post->items + i * item_bytes, item_bytes);
        }
        status = ranks_deal(link, item_bytes, out, first, in, first_in);
        *in_count = status == PCCD_OK ? first_in[size] : 0;
    }
    if (link->broken == PCCD_OK) {
        free(out);
        free(first);
    }
    return status;
}

int ranks_post_deal(struct ranks_link *link, struct ranks_post *post, void **in,
                    uint64_t *in_count)
{
    *in = NULL;
    *in_count = 0;
    int status =
        ranks_agree_on(link, post->is_lost ? ranks_link_no_memory(link) : PCCD_OK);
    if (status == PCCD_OK) {
        status = deal_post(link, post, in, in_count);
    }
    free(post->items);
    free(post->to);
    *post = (struct ranks_post){0};
    return status;
}

int ranks_spread(struct ranks_link *link, size_t item_bytes, const void *mine,
                 uint64_t count, void **all, uint64_t *first)
{
    /* Everybody gets the same; who sends does so once to each. */
    int size = link->size;
    uint64_t *counts = shared_array(link, (uint64_t)size, sizeof *counts);
    *all = NULL;
    if (counts == NULL) {
        return link->broken;
    }
    int status = ranks_tell_all(link, count, counts);
    if (status != PCCD_OK) {
        return status;
    }
    status = make_room(link, item_bytes, counts, all, first);
    free(counts);
    for (int r = 0; r < size && status == PCCD_OK; r++) {
        char *at = (char *)*all + first[r] * item_bytes;
        uint64_t bytes = (first[r + 1] - first[r]) * item_bytes;
        if (r == link->rank && bytes > 0) {
            memcpy(at, mine, bytes);
            link->sent_bytes += bytes * (uint64_t)(size - 1);
        }
        for (uint64_t done = 0; done < bytes && status == PCCD_OK; done += CHUNK_BYTES) {
            MPI_Request request;
            int length = (int)(bytes - done < CHUNK_BYTES ? bytes - done : CHUNK_BYTES);
            status = await_one(
                link, MPI_Ibcast(at + done, length, MPI_BYTE, r, link->comm, &request),
                "MPI_Ibcast", &request);
        }
    }
    if (status != PCCD_OK && link->broken == PCCD_OK) {
        free(*all);
        *all = NULL;
    }
    return status;
}
