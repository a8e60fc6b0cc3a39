/* srv_batch.c - the scenes of a batch. */
#include "srv_batch.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"
#include "service.h"
#include "session.h"
#include "shared.h"

const char *srv_batch_why(int status)
{
    switch (status) {
    case PCCD_E_HANDLE:
        return "there is no such scene";
    case PCCD_E_ACCESS:
        return "the session may only read the scene";
    default:
        return "the batch names the scene more than once";
    }
}

/* The scene of an entry, or why there is none; its member, if it is shared. */
static int find(const struct srv_session *session, uint32_t handle, uint64_t number,
                struct srv_scene **found, struct srv_member **member)
{
    struct srv_scene *scene = srv_handles_get(&session->scenes, handle);
    if (scene == NULL) {
        return PCCD_E_HANDLE;
    }
    *member = srv_shared_member(scene, session);
    if (*member != NULL && !(*member)->is_writer) {
        return PCCD_E_ACCESS;
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
        struct srv_member *member = NULL;
        memcpy(&entry, table + i * sizeof entry, sizeof entry); /* the one read of it */
        __asm__ volatile("" : : : "memory");
        *item = (struct srv_batch_item){
            .handle = entry.scene, .first = (uint32_t)first, .segments = entry.segments};
        first += entry.segments;
        item->status = find(session, entry.scene, number, &item->scene, &member);
        if (item->scene == NULL) {
            continue;
        }
        batch->claims[batch->claim_count++] = &item->scene->claim;
        if (member == NULL) {
            batch->order[batch->order_count++] = i;
        } else {
            PCCD_ASSERT(batch->shared_count < session->shared_count);
            item->shared = &batch->shared[batch->shared_count++];
            item->shared->member = member;
        }
    }
    return first;
}

/* The next `count` items of `bytes` each behind *end. */
static void *put(void *base, size_t *end, size_t count, size_t bytes)
{
    void *at = base != NULL ? (char *)base + *end : NULL;
    *end += (count * bytes + 15) / 16 * 16;
    return at;
}

/* Where everything is that a batch has, behind each other; returns the size of it all.
 * `batch` NULL: only that. */
static size_t lay_out(struct srv_batch *batch, const struct srv_session *session,
                      const struct proto_BATCH_SUBMIT_request *request)
{
    uint32_t count = request->scenes;
    uint32_t lanes = session->service->options->threads_max;
    struct srv_batch made = {.count = count, .lane_count = lanes};
    size_t end = 0;
    (void)put(batch, &end, 1, sizeof made + count * sizeof made.items[0]);
    made.lanes = put(batch, &end, lanes, sizeof *made.lanes);
    made.shared =
        put(batch, &end, count < session->shared_count ? count : session->shared_count,
            sizeof *made.shared);
    size_t cleared = end;
    made.claims = put(batch, &end, count, sizeof *made.claims);
    made.segments = put(batch, &end, request->segments, sizeof *made.segments);
    made.order = put(batch, &end, count, sizeof *made.order);
    made.rest = put(batch, &end, count, sizeof *made.rest);
    if (batch != NULL) {
        memset(batch, 0, cleared);
        *batch = made;
        batch->user = session->owner.user;
        batch->bytes = end;
    }
    return end;
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
    size_t bytes = lay_out(NULL, session, request);
    status = srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, bytes, error);
    if (status != 0) {
        return status;
    }
    struct srv_batch *made = malloc(bytes);
    if (made == NULL) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, bytes);
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for a batch");
    }
    (void)lay_out(made, session, request);
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
