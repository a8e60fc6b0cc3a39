/* srv_batch.c - the scenes of a batch.
 *
 * Room:     service. See srv_batch.h.
 * Does:     one look at each entry of the table, which the client may be writing to.
 * Threads:  [loop]
 */
#include "srv_batch.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"
#include "service.h"
#include "session.h"

const char *srv_batch_why(int status)
{
    switch (status) {
    case PCCD_E_HANDLE:
        return "there is no such scene";
    case PCCD_E_STATE:
        return "the scene is shared: its steps are made one by one";
    default:
        return "the batch names the scene more than once";
    }
}

/* The scene of an entry, or why there is none. */
static int find(const struct srv_session *session, uint32_t handle, uint64_t number,
                struct srv_scene **found)
{
    struct srv_scene *scene = srv_handles_get(&session->scenes, handle);
    if (scene == NULL) {
        return PCCD_E_HANDLE;
    }
    if (scene->shared != NULL) {
        return PCCD_E_STATE;
    }
    if (scene->batch == number) {
        return PCCD_E_INVAL;
    }
    scene->batch = number;
    srv_resource_acquire(&scene->resource);
    *found = scene;
    return 0;
}

/* Every entry, at `table` in the slot. Returns how many segments they have together. */
static uint64_t read_table(struct srv_batch *batch, const struct srv_session *session,
                           const uint8_t *table)
{
    uint64_t number = ++session->service->batch_last;
    uint64_t first = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        struct srv_batch_item *item = &batch->items[i];
        struct proto_batch_scene entry;
        memcpy(&entry, table + i * sizeof entry, sizeof entry); /* the one read of it */
        __asm__ volatile("" : : : "memory");
        *item = (struct srv_batch_item){
            .handle = entry.scene, .first = (uint32_t)first, .segments = entry.segments};
        first += entry.segments;
        item->status = find(session, entry.scene, number, &item->scene);
        if (item->scene != NULL) {
            batch->claims[batch->claim_count] = &item->scene->claim;
            batch->order[batch->claim_count++] = i;
        }
    }
    return first;
}

/* Room for so many scenes; the arrays behind the items. NULL: no memory. */
static struct srv_batch *make(struct srv_quota_user *user, uint32_t count)
{
    struct srv_batch *batch;
    size_t items = sizeof *batch + count * sizeof batch->items[0];
    size_t bytes = items + count * (sizeof batch->claims[0] + sizeof batch->order[0]);
    batch = malloc(bytes);
    if (batch != NULL) {
        struct srv_claim **claims = (struct srv_claim **)(void *)((char *)batch + items);
        *batch = (struct srv_batch){.user = user,
                                    .bytes = bytes,
                                    .count = count,
                                    .claims = claims,
                                    .order = (uint32_t *)(void *)(claims + count)};
    }
    return batch;
}

int srv_batch_begin(struct srv_session *session, struct srv_ring *ring,
                    const struct proto_BATCH_SUBMIT_request *request,
                    struct srv_batch **batch, struct proto_error *error)
{
    srv_assert_loop();
    struct srv_quota_user *user = session->owner.user;
    const uint8_t *payload = NULL;
    int status = srv_ring_open_slot(ring, request->slot, request->seq, &payload, error);
    if (status != 0) {
        return status;
    }
    struct srv_batch *made = make(user, request->scenes);
    if (made == NULL) {
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for a batch");
    }
    status = srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, made->bytes, error);
    if (status != 0) {
        free(made);
        return status;
    }
    uint64_t segments = read_table(made, session, payload);
    status = srv_ring_check_slot(ring, request->slot, request->seq, error);
    if (status == 0 && segments != request->segments) {
        status = proto_error_set(
            error, PCCD_E_SEGMENT,
            "the scenes of the table have %llu segments, the request says %u",
            (unsigned long long)segments, request->segments);
    }
    if (status != 0) {
        srv_batch_end(made);
        return status;
    }
    *batch = made;
    return 0;
}

void srv_batch_end(struct srv_batch *batch)
{
    srv_assert_loop();
    for (uint32_t i = 0; i < batch->count; i++) {
        if (batch->items[i].scene != NULL) {
            srv_resource_drop(&batch->items[i].scene->resource);
        }
    }
    srv_quota_refund(batch->user, SRV_QUOTA_SHM_BYTES, batch->bytes);
    free(batch);
}
