/* attach.h - gets the memory shared with the daemon, and free slots in it. */
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

/* Attach a ring of any size, for what brings or takes little; does nothing where there is
 * one. Returns what cli_ring_reserve does, or PCCD_E_DISCONNECTED. */
int cli_ring_ensure(struct pccd_client *client);

/* Attach a ring of that many slots in place of any that there is; the first `slots_now`
 * of them have memory. */
int cli_ring_attach(struct pccd_client *client, uint64_t slot_bytes, uint32_t slot_count,
                    uint32_t slots_now, uint64_t deadline_ns);

/* Make sure that a slot that is FREE has memory, and keeps it. Returns 0, PCCD_E_QUOTA,
 * PCCD_E_NOMEM, ...: then it has none. */
int cli_slot_take(struct pccd_client *client, uint32_t slot, uint64_t deadline_ns);

/* Take a free slot, with memory, and mark it as being written (state BEGUN). Waits while
 * slots are in flight. PCCD_E_BUSY: every slot is begun. PCCD_E_QUOTA, PCCD_E_NOMEM: no
 * slot that could be used gets memory. */
int cli_slot_begin(struct pccd_client *client, uint64_t deadline_ns, uint32_t *slot);

#endif
