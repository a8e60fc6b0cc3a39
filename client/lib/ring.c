/* ring.c - the memory that a client shares with its daemon. */
#include "ring.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"

void cli_ring_deinit(struct cli_ring *ring)
{
    for (uint32_t i = 0; i < PROTO_SLOTS_MAX; i++) {
        free(ring->slots[i].segments);
        free(ring->slots[i].scenes);
    }
    proto_memory_deinit(&ring->upload);
    proto_memory_deinit(&ring->result);
    memset(ring, 0, sizeof *ring);
    ring->upload = ring->result = (struct proto_memory)PROTO_MEMORY_NONE;
}

/* *array with room for `wanted` items, half as many again where it has to grow. */
static int make_room(void **array, uint32_t *room, uint32_t wanted, size_t item_bytes)
{
    uint32_t more = wanted + wanted / 2 + 4;
    void *larger;

    if (wanted <= *room) {
        return 0;
    }
    larger = realloc(*array, more * item_bytes);
    if (larger == NULL) {
        return PCCD_E_NOMEM;
    }
    *array = larger;
    *room = more;
    return 0;
}

int cli_slot_room(struct cli_slot *own, uint32_t segments, uint32_t scenes)
{
    void *segment_array = own->segments;
    void *scene_array = own->scenes;
    int status =
        make_room(&segment_array, &own->segment_room, segments, sizeof *own->segments);

    own->segments = segment_array;
    if (status == 0) {
        status = make_room(&scene_array, &own->scene_room, scenes, sizeof *own->scenes);
        own->scenes = scene_array;
    }
    return status;
}

static struct proto_slot *descriptor(const struct cli_ring *ring, uint32_t slot)
{
    struct proto_upload *upload = ring->upload.base;

    return &upload->slots[slot];
}

uint8_t *cli_slot_payload(const struct cli_ring *ring, uint32_t slot)
{
    uint8_t *base = ring->upload.base;

    assert(base != NULL && slot < ring->slot_count);
    return base + sizeof(struct proto_upload) + slot * ring->slot_stride;
}

uint64_t cli_slot_publish(struct cli_ring *ring, uint32_t slot)
{
    struct cli_slot *own = &ring->slots[slot];
    struct proto_upload *upload = ring->upload.base;

    assert(slot < ring->slot_count && own->state == CLI_SLOT_BEGUN);
    own->state = CLI_SLOT_SENT;
    own->seq++; /* even: whole. Release; pairs with the daemon's first, acquiring load */
    assert(own->seq % 2 == 0);
    atomic_store_explicit(&upload->slots[slot].seq, own->seq, memory_order_release);
    (void)atomic_fetch_add_explicit(&upload->head.value, 1, memory_order_relaxed);
    return own->seq;
}

void cli_slot_abort(struct cli_ring *ring, uint32_t slot)
{
    struct cli_slot *own = &ring->slots[slot];

    assert(slot < ring->slot_count && own->state != CLI_SLOT_KEPT);
    if (own->state == CLI_SLOT_BEGUN) {
        own->seq++;
        atomic_store_explicit(&descriptor(ring, slot)->seq, own->seq,
                              memory_order_release);
    }
    own->state = CLI_SLOT_FREE;
    cli_slot_offer(ring, slot);
}

void cli_slot_offer(struct cli_ring *ring, uint32_t slot)
{
    uint64_t expected = PROTO_SLOT_NEEDED;

    assert(slot < ring->slot_count && ring->slots[slot].state == CLI_SLOT_FREE);
    /* Release; pairs with the daemon's acquiring exchange before it gives memory back. */
    (void)atomic_compare_exchange_strong_explicit(
        &descriptor(ring, slot)->memory, &expected, PROTO_SLOT_FREE, memory_order_release,
        memory_order_relaxed);
}

void cli_slot_offer_all(struct cli_ring *ring)
{
    for (uint32_t i = 0; i < ring->slot_count; i++) {
        if (ring->slots[i].state == CLI_SLOT_FREE) {
            cli_slot_offer(ring, i);
        }
    }
}

bool cli_slot_has_memory(const struct cli_ring *ring, uint32_t slot)
{
    return atomic_load_explicit(&descriptor(ring, slot)->memory, memory_order_relaxed) !=
           PROTO_SLOT_EMPTY;
}

bool cli_slot_withdraw_offer(struct cli_ring *ring, uint32_t slot)
{
    uint64_t expected = PROTO_SLOT_FREE;

    /* Acquire: what the daemon did with the memory is done. */
    return atomic_compare_exchange_strong_explicit(
               &descriptor(ring, slot)->memory, &expected, PROTO_SLOT_NEEDED,
               memory_order_acquire, memory_order_acquire) ||
           expected == PROTO_SLOT_NEEDED;
}

void cli_slot_open(struct cli_ring *ring, uint32_t slot)
{
    struct cli_slot *own = &ring->slots[slot];

    assert(slot < ring->slot_count && own->state == CLI_SLOT_FREE);
    own->state = CLI_SLOT_BEGUN;
    own->frame = 0;
    own->segment_count = 0;
    own->scene_count = 0;
    own->used_bytes = 0;
    own->joints_at = 0;
    own->joint_count = 0;
    own->seq++; /* odd: being written */
    assert(own->seq % 2 == 1);
    atomic_store_explicit(&descriptor(ring, slot)->seq, own->seq, memory_order_relaxed);
    /* Pairs with the daemon's second load of seq: a reader that sees any of the payload
     * written from here on also sees the odd number. */
    atomic_thread_fence(memory_order_release);
}

uint32_t cli_slot_oldest_kept(const struct cli_ring *ring)
{
    uint32_t oldest = CLI_SLOT_NONE;

    for (uint32_t i = 0; i < ring->slot_count; i++) {
        const struct cli_slot *own = &ring->slots[i];

        if (own->state == CLI_SLOT_KEPT &&
            (oldest == CLI_SLOT_NONE || own->step < ring->slots[oldest].step)) {
            oldest = i;
        }
    }
    return oldest;
}
