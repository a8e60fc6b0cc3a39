/* attach.c - the upload ring and the result region.
 *
 * Room:     client/lib. May include: attach.h, page.h, rpc.h, proto.
 * Does:     shm.attach, the mappings, and the writer's side of the slot protocol of
 *           shm.h.
 * Does not: lay out payloads (frame.c, mesh.c) or release pages (page.c).
 * Threads:  [owner].
 */
#include "attach.h"

#include <stdlib.h>
#include <string.h>

#include "keep.h"
#include "page.h"
#include "rpc.h"

#define CLI_SLOT_BYTES                                                                   \
    (64ull << 10) /* of a slot at first, when the user did not choose */

void cli_ring_deinit(struct cli_ring *ring)
{
    for (uint32_t i = 0; i < PROTO_SLOTS_MAX; i++) {
        free(ring->slots[i].segments);
    }
    proto_memory_deinit(&ring->upload);
    proto_memory_deinit(&ring->result);
    memset(ring, 0, sizeof(*ring));
    ring->upload = ring->result = (struct proto_memory)PROTO_MEMORY_NONE;
}

/* Take the two descriptors of the answer and map them. Whatever the answer says, no
 * access of ours may leave the mappings; who asked for slots of `slot_bytes` writes as
 * much to each. */
static int map_ring(struct pccd_client *client, uint64_t slot_bytes,
                    const struct proto_SHM_ATTACH_result *result, struct cli_ring *ring)
{
    int fds[2] = {client->fds[0], client->fds[1]};
    int rc;

    client->fds[0] = client->fds[1] = -1;
    rc = proto_memory_map(&ring->upload, fds[0], result->upload_bytes, false);
    if (rc == 0) {
        rc = proto_memory_map(&ring->result, fds[1], result->result_bytes, true);
        fds[1] = -1; /* taken over */
    }
    if (fds[1] >= 0) {
        struct proto_memory unused = {fds[1], NULL, 0};

        proto_memory_deinit(&unused);
    }
    if (rc != 0) {
        return cli_fail(client, rc, "shm.attach: the memory cannot be mapped: %s",
                        proto_status_text(rc));
    }
    if (result->slot_count == 0 || result->slot_count > PROTO_SLOTS_MAX ||
        result->upload_bytes < sizeof(struct proto_upload) ||
        result->slot_stride % 8 != 0 || result->slot_stride < slot_bytes ||
        result->slot_stride >
            (result->upload_bytes - sizeof(struct proto_upload)) / result->slot_count) {
        return cli_fail(client, PCCD_E_BADMSG, "shm.attach: slots outside the memory");
    }
    ring->slot_count = result->slot_count;
    ring->slot_stride = result->slot_stride;
    ring->inflight_max = result->inflight_max > 0 ? result->inflight_max : 1;
    return 0;
}

/* On an error of the daemon's the old one stays. */
int cli_ring_attach(struct pccd_client *client, uint64_t slot_bytes, uint32_t slot_count,
                    uint64_t deadline_ns)
{
    struct proto_SHM_ATTACH_request request = {.slot_count = slot_count,
                                               .slot_bytes = slot_bytes,
                                               .result_bytes = client->result_bytes};
    struct proto_SHM_ATTACH_result result;
    struct cli_ring ring;
    bool was_attaching = client->is_attaching; /* by one that a recovery interrupts */
    int rc;

    client->is_attaching = true;
    rc = cli_call_sync(client, PROTO_METHOD_SHM_ATTACH, &request, &result, deadline_ns);
    client->is_attaching = was_attaching;
    if (rc == PCCD_E_TIMEOUT) {
        /* It may still be attached: which ring the daemon reads is not known any more. */
        cli_ring_deinit(&client->ring);
    }
    if (rc != 0) {
        cli_fds_close(client); /* an honest daemon's errors bring none */
        return rc;
    }
    memset(&ring, 0, sizeof(ring));
    ring.page_first = client->page_end;
    ring.upload = ring.result = (struct proto_memory)PROTO_MEMORY_NONE;
    rc = map_ring(client, slot_bytes, &result, &ring);
    cli_ring_deinit(&client->ring);
    if (rc != 0) {
        cli_ring_deinit(&ring);
        return rc;
    }
    client->ring = ring;
    return 0;
}

/* Whether the daemon may take the ring away from under us. */
static int check_idle(struct pccd_client *client, uint64_t slot_bytes,
                      uint64_t deadline_ns)
{
    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        if (client->ring.slots[i].state == CLI_SLOT_BEGUN) {
            return cli_fail(
                client, PCCD_E_BUSY,
                "a slot of %llu bytes needs a larger ring: commit or abort the "
                "frames that are begun first",
                (unsigned long long)slot_bytes);
        }
    }
    while (cli_call_inflight(client) > 0) {
        int rc = cli_progress(client, deadline_ns);

        if (rc != 0) {
            return rc;
        }
    }
    if (cli_page_count(client) > 0) {
        return cli_fail(
            client, PCCD_E_BUSY,
            "a slot of %llu bytes needs a larger ring: take and release the %u "
            "answers with records first",
            (unsigned long long)slot_bytes, cli_page_count(client));
    }
    return cli_keep_fold_all(client); /* what only the old memory holds */
}

int cli_ring_reserve(struct pccd_client *client, uint64_t slot_bytes,
                     uint64_t deadline_ns)
{
    uint64_t wanted = client->slot_bytes > 0 ? client->slot_bytes : CLI_SLOT_BYTES;
    uint64_t least = slot_bytes > wanted ? slot_bytes : wanted;
    uint64_t old_bytes = client->ring.slot_stride;
    uint32_t slot_count = client->slot_count;
    uint64_t bytes;
    int rc;

    if (client->ring.upload.base != NULL && old_bytes >= slot_bytes) {
        return 0;
    }
    rc = check_idle(client, slot_bytes, deadline_ns);
    if (rc != 0) {
        return rc;
    }
    /* Half as much again, so that slow growth does not attach anew for each step. */
    bytes = least > old_bytes + old_bytes / 2 ? least : old_bytes + old_bytes / 2;
    for (;;) {
        rc = cli_ring_attach(client, bytes, slot_count, deadline_ns);
        if (rc != PCCD_E_QUOTA) {
            return rc;
        }
        if (bytes > least) {
            bytes = least;
        } else if (!client->slots_chosen && slot_count > 1) {
            slot_count /= 2;
        } else {
            return rc;
        }
    }
}

/* ---- slots ------------------------------------------------------------------------- */

static struct proto_slot *descriptor(const struct pccd_client *client, uint32_t slot)
{
    struct proto_upload *upload = client->ring.upload.base;

    return &upload->slots[slot];
}

uint8_t *cli_slot_payload(const struct pccd_client *client, uint32_t slot)
{
    uint8_t *base = client->ring.upload.base;

    return base + sizeof(struct proto_upload) + slot * client->ring.slot_stride;
}

/* The first slot that is free, or else the KEPT one of the oldest step. */
static uint32_t choose_slot(const struct pccd_client *client)
{
    uint32_t chosen = CLI_SLOT_NONE;

    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        const struct cli_slot *candidate = &client->ring.slots[i];

        if (candidate->state == CLI_SLOT_FREE) {
            return i;
        }
        if (candidate->state == CLI_SLOT_KEPT &&
            (chosen == CLI_SLOT_NONE ||
             candidate->step < client->ring.slots[chosen].step)) {
            chosen = i;
        }
    }
    return chosen;
}

static bool is_any_sent(const struct pccd_client *client)
{
    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        if (client->ring.slots[i].state == CLI_SLOT_SENT) {
            return true;
        }
    }
    return false;
}

int cli_slot_begin(struct pccd_client *client, uint64_t deadline_ns, uint32_t *slot)
{
    uint32_t chosen;
    struct cli_slot *own;
    int rc = 0;

    while ((chosen = choose_slot(client)) == CLI_SLOT_NONE) {
        if (!is_any_sent(client)) {
            return cli_fail(client, PCCD_E_BUSY,
                            "all %u slots are begun: commit or abort one",
                            client->ring.slot_count);
        }
        rc = cli_progress(client, deadline_ns);
        if (rc != 0) {
            return rc;
        }
    }
    own = &client->ring.slots[chosen];
    if (own->state == CLI_SLOT_KEPT) {
        rc = cli_keep_fold(client, chosen);
        if (rc != 0) {
            return rc;
        }
    }
    own->state = CLI_SLOT_BEGUN;
    own->segment_count = 0;
    own->used_bytes = 0;
    own->seq++; /* odd: being written */
    atomic_store_explicit(&descriptor(client, chosen)->seq, own->seq,
                          memory_order_relaxed);
    /* Pairs with the daemon's second load of seq: a reader that sees any of the payload
     * written from here on also sees the odd number. */
    atomic_thread_fence(memory_order_release);
    *slot = chosen;
    return 0;
}

uint64_t cli_slot_publish(struct pccd_client *client, uint32_t slot)
{
    struct cli_slot *own = &client->ring.slots[slot];
    struct proto_upload *upload = client->ring.upload.base;

    own->state = CLI_SLOT_SENT;
    own->seq++; /* even: whole. Release; pairs with the daemon's first, acquiring load */
    atomic_store_explicit(&upload->slots[slot].seq, own->seq, memory_order_release);
    (void)atomic_fetch_add_explicit(&upload->head.value, 1, memory_order_relaxed);
    return own->seq;
}

void cli_slot_abort(struct pccd_client *client, uint32_t slot)
{
    struct cli_slot *own = &client->ring.slots[slot];

    if (own->state == CLI_SLOT_BEGUN) {
        own->seq++;
        atomic_store_explicit(&descriptor(client, slot)->seq, own->seq,
                              memory_order_release);
    }
    own->state = CLI_SLOT_FREE;
}
