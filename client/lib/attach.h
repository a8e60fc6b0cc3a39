/* attach.h - the upload ring and the result region.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     attach, map and grow the shared memory; hand out slots and write their
 *           sequence numbers.
 * Threads:  [owner].
 */
#ifndef CLI_ATTACH_H
#define CLI_ATTACH_H

#include "client.h"

/* Make sure that a slot's payload holds slot_bytes. A ring that is too small is replaced
 * by a larger one, which is possible only while nothing is in flight, no slot is begun
 * and no page of records is held: replies are waited for, the rest is PCCD_E_BUSY. With
 * the default number of slots, fewer are taken when the quota does not allow more.
 * Returns 0, PCCD_E_BUSY, PCCD_E_QUOTA, PCCD_E_LIMIT, PCCD_E_TIMEOUT, ... */
int cli_ring_reserve(struct pccd_client *client, uint64_t slot_bytes,
                     uint64_t deadline_ns);

/* Attach a ring of that many slots in place of any that there is. */
int cli_ring_attach(struct pccd_client *client, uint64_t slot_bytes, uint32_t slot_count,
                    uint64_t deadline_ns);

/* Unmap; nothing is attached afterwards. */
void cli_ring_deinit(struct cli_ring *ring);

/* Take a free slot and mark it as being written (state BEGUN). Waits while slots are in
 * flight. PCCD_E_BUSY: every slot is begun. */
int cli_slot_begin(struct pccd_client *client, uint64_t deadline_ns, uint32_t *slot);

/* Publish a begun slot (state SENT). Returns the sequence number for the message. */
uint64_t cli_slot_publish(struct pccd_client *client, uint32_t slot);

/* Give a slot back without a request in flight. */
void cli_slot_abort(struct pccd_client *client, uint32_t slot);

/* First byte of a slot's payload. */
uint8_t *cli_slot_payload(const struct pccd_client *client, uint32_t slot);

#endif
