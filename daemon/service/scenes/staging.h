/* staging.h - reads the positions of a step from shared memory into its scene. */
#ifndef SRV_STAGING_H
#define SRV_STAGING_H

#include "codec.h"
#include "messages.h"
#include "ringio.h"
#include "shm.h"
#include "srv_scene.h"

/* Where a request says that what it moves is written. */
struct srv_cargo {
    uint32_t slot;
    uint32_t segments; /* >= 1 */
    uint64_t seq;
};

/* Of frame.submit, or of another message with these fields. */
#define SRV_CARGO_OF(request)                                                            \
    (&(const struct srv_cargo){(request)->slot, (request)->segments, (request)->seq})

/* Stage the step in a slot: copy and check the segment table, then copy the positions of
 * each segment into `scene`, which has its staging open. On failure the caller aborts it.
 * Only objects that were added with `member` may be moved (PCCD_E_ACCESS), NULL: all.
 * `table` has room for PROTO_SEGMENTS_MAX. *bytes is what was copied. [compute] */
int srv_stage_slot(struct srv_ring *ring, const struct srv_cargo *cargo,
                   const struct srv_member *member, struct srv_scene *scene,
                   struct proto_segment *table, uint64_t *bytes,
                   struct proto_error *error);
/* The same of one scene of a batch, whose tables were copied already (srv_batch.h): stage
 * the `segments` of the cargo, which are at `table`; positions lie behind the
 * `tables_bytes`. Scenes of a batch are staged by several threads. [compute], [team] */
int srv_stage_scene(struct srv_ring *ring, const struct srv_cargo *cargo,
                    uint64_t tables_bytes, const struct srv_member *member,
                    struct srv_scene *scene, const struct proto_segment *table,
                    uint64_t *bytes, struct proto_error *error);
/* The same out of a copy of a slot. [compute] */
int srv_stage_copy(const uint8_t *copy, uint64_t copy_bytes,
                   const struct srv_cargo *cargo, const struct srv_member *member,
                   struct srv_scene *scene, struct proto_segment *table, uint64_t *bytes,
                   struct proto_error *error);
/* A copy, of malloc, of what the step uses of its slot, *bytes of at most `bytes_max`.
 * Returns 0, PCCD_E_SLOT_STALE, PCCD_E_SLOT_TORN, PCCD_E_SEGMENT (it uses more, or a
 * segment is not as it must be) or PCCD_E_NOMEM with *error set. [any] */
int srv_stage_keep(struct srv_ring *ring, const struct srv_cargo *cargo,
                   uint64_t bytes_max, uint8_t **copy, uint64_t *bytes,
                   struct proto_error *error);

/* ---- what is kept of it for journals [compute] ------------------------------------- */

/* While a scene has journals, its staging copies each segment to scene->sent first and
 * reads the copy: shared memory is read once. Forget what there is; up to so many
 * segments come, and bytes with their table. */
void srv_sent_begin(struct srv_sent *sent, uint64_t segments_max, uint64_t bytes_max);
/* Copy a checked segment. Its parts, of `bytes` each, are where its positions start
 * (of X1 any) and where they end; then they are the copies, if these fit. */
void srv_sent_add(struct srv_sent *sent, const struct proto_segment *segment,
                  uint64_t bytes, const uint8_t *parts[2]);
void srv_sent_end(struct srv_sent *sent);

#endif
