/* attach.c - the upload ring and the result region. */
#include "attach.h"

#include <assert.h>
#include <string.h>

#include "connection.h"
#include "replica.h"
#include "rpc.h"

#define CLI_SLOT_BYTES                                                                   \
    (64ull << 10) /* of a slot at first, when the user did not choose */

/* Slots that have memory at once: one with the last positions, one to write to. */
#define SLOTS_NOW 2u

/* Return where a slot's payload begins in the upload ring. */
static uint64_t slot_offset(const struct cli_ring *ring, uint32_t slot)
{
    return sizeof(struct proto_upload) + slot * ring->slot_stride;
}

/* Take the two descriptors of the answer and map them. Whatever the answer says, no
 * access of ours may leave the mappings; who asked for slots of `slot_bytes` writes as
 * much to each. */
static int map_ring(struct pccd_client *client, uint64_t slot_bytes, uint32_t slots_now,
                    const struct proto_SHM_ATTACH_result *result, struct cli_ring *ring)
{
    int fds[2] = {client->fds[0], client->fds[1]};
    int status;

    client->fds[0] = client->fds[1] = -1;
    status = proto_memory_map(&ring->upload, fds[0], result->upload_bytes, false);
    if (status == 0) {
        status = proto_memory_map(&ring->result, fds[1], result->result_bytes, true);
        fds[1] = -1; /* taken over */
    }
    if (fds[1] >= 0) {
        struct proto_memory unused = {fds[1], NULL, 0, 0, NULL};

        proto_memory_deinit(&unused);
    }
    if (status != 0) {
        return cli_fail(client, status, "shm.attach: the memory cannot be mapped: %s",
                        proto_status_text(status));
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
    (void)proto_memory_populate(&ring->upload, 0, slot_offset(ring, slots_now));
    cli_slot_offer_all(ring);
    return 0;
}

/* On an error of the daemon's the old one stays. */
int cli_ring_attach(struct pccd_client *client, uint64_t slot_bytes, uint32_t slot_count,
                    uint32_t slots_now, uint64_t deadline_ns)
{
    struct proto_SHM_ATTACH_request request = {.slot_count = slot_count,
                                               .slot_bytes = slot_bytes,
                                               .result_bytes = client->result_bytes,
                                               .slots_now = slots_now};
    struct proto_SHM_ATTACH_result result;
    struct cli_ring ring;
    bool was_attaching = client->is_attaching; /* by one that a recovery interrupts */
    int status;

    client->is_attaching = true;
    status =
        cli_call_sync(client, PROTO_METHOD_SHM_ATTACH, &request, &result, deadline_ns);
    client->is_attaching = was_attaching;
    if (status == PCCD_E_TIMEOUT) {
        /* It may still be attached: which ring the daemon reads is not known any more. */
        cli_page_retire(client, &client->ring.result);
        cli_ring_deinit(&client->ring);
    }
    if (status != 0) {
        cli_fds_close(client); /* an honest daemon's errors bring none */
        return status;
    }
    memset(&ring, 0, sizeof ring);
    ring.page_first = client->page_end; /* the old region keeps those that are held */
    ring.upload = ring.result = (struct proto_memory)PROTO_MEMORY_NONE;
    status = map_ring(client, slot_bytes, slots_now, &result, &ring);
    if (client->unmap.call != NULL) {
        ring.upload.unmap = ring.result.unmap = &client->unmap;
    }
    cli_page_retire(client, &client->ring.result);
    cli_ring_deinit(&client->ring);
    if (status != 0) {
        cli_ring_deinit(&ring);
        return status;
    }
    client->ring = ring;
    return 0;
}

/* Check whether the daemon may take the ring away from under us. */
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
        int status = cli_progress(client, deadline_ns);

        if (status != 0) {
            return status;
        }
    }
    return cli_positions_fold_all(client); /* what only the old memory holds */
}

int cli_ring_ensure(struct pccd_client *client)
{
    int status = cli_alive(client);

    if (status == 0 && client->ring.upload.base == NULL) {
        status = cli_ring_reserve(client, PROTO_SLOT_BYTES_MIN, cli_deadline(client, -1));
    }
    return status;
}

int cli_ring_reserve(struct pccd_client *client, uint64_t slot_bytes,
                     uint64_t deadline_ns)
{
    uint64_t wanted = client->slot_bytes > 0 ? client->slot_bytes : CLI_SLOT_BYTES;
    uint64_t least = slot_bytes > wanted ? slot_bytes : wanted;
    uint64_t old_bytes = client->ring.slot_stride;
    uint32_t slot_count = client->slot_count;
    uint64_t bytes;
    int status;

    if (client->ring.upload.base != NULL && old_bytes >= slot_bytes) {
        return 0;
    }
    status = check_idle(client, slot_bytes, deadline_ns);
    if (status != 0) {
        return status;
    }
    /* Half as much again, so that slow growth does not attach anew for each step. */
    bytes = least > old_bytes + old_bytes / 2 ? least : old_bytes + old_bytes / 2;
    for (;;) {
        uint32_t slots_now = slot_count < SLOTS_NOW ? slot_count : SLOTS_NOW;

        status = cli_ring_attach(client, bytes, slot_count, slots_now, deadline_ns);
        if (status != PCCD_E_QUOTA) {
            return status;
        }
        if (bytes > least) {
            bytes = least;
        } else if (!client->slots_chosen && slot_count > 1) {
            slot_count /= 2;
        } else {
            return status;
        }
    }
}

/* ---- slots ------------------------------------------------------------------------- */

/* The first slot that is free and has memory; or else, if it can have memory, the first
 * that is free; or else the KEPT one of the oldest step. */
static uint32_t choose_slot(const struct cli_ring *ring, bool can_take)
{
    uint32_t empty = CLI_SLOT_NONE;

    for (uint32_t i = 0; i < ring->slot_count; i++) {
        if (ring->slots[i].state != CLI_SLOT_FREE) {
            continue;
        }
        if (cli_slot_has_memory(ring, i)) {
            return i;
        }
        empty = empty == CLI_SLOT_NONE ? i : empty;
    }
    return can_take && empty != CLI_SLOT_NONE ? empty : cli_slot_oldest_kept(ring);
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

int cli_slot_take(struct pccd_client *client, uint32_t slot, uint64_t deadline_ns)
{
    struct proto_SHM_TAKE_request request = {.slot = slot};
    struct cli_ring *ring = &client->ring;
    int status;

    if (cli_slot_withdraw_offer(ring, slot)) {
        return 0;
    }
    status = cli_call_sync(client, PROTO_METHOD_SHM_TAKE, &request, NULL, deadline_ns);
    if (status != 0) {
        return status;
    }
    /* The ring may be another daemon's by now, which has memory for all slots. */
    assert(slot < ring->slot_count);
    status = proto_memory_populate(&ring->upload, slot_offset(ring, slot),
                                   slot_offset(ring, slot + 1));
    if (status != 0) {
        return cli_fail(client, status, "no memory for slot %u", slot);
    }
    (void)cli_slot_withdraw_offer(ring, slot);
    return 0;
}

int cli_slot_begin(struct pccd_client *client, uint64_t deadline_ns, uint32_t *slot)
{
    const struct cli_ring *ring = &client->ring;
    int refused = 0; /* why no slot gets memory any more */

    for (;;) {
        uint32_t chosen = choose_slot(ring, refused == 0);
        int status = 0;

        if (chosen == CLI_SLOT_NONE && is_any_sent(client)) {
            status = cli_progress(client, deadline_ns);
        } else if (chosen == CLI_SLOT_NONE) {
            return refused != 0 ? refused
                                : cli_fail(client, PCCD_E_BUSY,
                                           "all %u slots are begun: commit or abort one",
                                           ring->slot_count);
        } else if (ring->slots[chosen].state == CLI_SLOT_KEPT) {
            status = cli_positions_fold(client, chosen);
        } else if ((status = cli_slot_take(client, chosen, deadline_ns)) == 0) {
            cli_slot_open(&client->ring, chosen);
            *slot = chosen;
            return 0;
        } else if (status == PCCD_E_QUOTA || status == PCCD_E_NOMEM) {
            refused = status;
            status = 0;
        }
        if (status != 0) {
            return status;
        }
    }
}
