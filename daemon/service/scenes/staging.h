/* staging.h - reads the positions of a step from shared memory into its scene. */
#ifndef SRV_STAGING_H
#define SRV_STAGING_H

#include "codec.h"
#include "messages.h"
#include "ringio.h"
#include "shm.h"
#include "srv_scene.h"

/* Slot in which a message says that what it moves is written. */
struct srv_slot_ref {
    uint32_t slot;
    uint32_t segments; /* 0: nothing moves */
    uint64_t seq;
    uint64_t scenes_bytes; /* of the table before that of the segments; 0: no batch */
};

/* The slot of frame.submit, or of another message with these fields. */
#define SRV_SLOT_OF(request)                                                             \
    ((const struct srv_slot_ref){(request)->slot, (request)->segments, (request)->seq, 0})

/* The table of joints that was staged last. All zeros: none was. */
struct srv_joints {
    uint64_t offset; /* in the payload, and .. */
    uint64_t end;    /* .. behind it */
    uint32_t count;
    uint32_t base;      /* of them in the scene's step */
    uint64_t sent_from; /* offset of the copy for journals */
};

/* The motion of one scene by a request, while it is staged. */
struct srv_staging {
    struct srv_scene *scene;         /* has its staging open */
    const struct srv_member *member; /* whose objects may be moved; NULL: all */
    struct srv_ring *ring;           /* has the slot; NULL: there is a copy of it */
    struct srv_slot_ref slot;        /* segments >= 1: those of this scene */
    const uint8_t *payload;          /* of the copy, or of the slot from srv_stage on */
    uint64_t payload_bytes;
    struct proto_segment *table; /* [slot.segments] */
    uint64_t tables_bytes;       /* before the positions; 0: `table` is only room for what
                                  * the payload begins with */
    uint64_t joints_end; /* of tables of joints, at most; 0: where the payload ends */
    struct srv_joints joints;
    uint64_t copied; /* bytes so far */
    struct proto_error *error;
};

/* Copy and check the table of segments, unless that was done, then copy the positions of
 * each segment into the scene. On failure the caller aborts. Only objects that were added
 * with the member may be moved (PCCD_E_ACCESS). Scenes of a batch are staged by several
 * threads. [compute], [team] */
int srv_stage(struct srv_staging *staging);

/* Say, after PCCD_E_NOTFINITE, which coordinate of an object is none. Returns
 * PCCD_E_NOTFINITE. [compute], [team] */
int srv_stage_explain_stray(const struct srv_scene *scene, struct proto_error *error);
/* Say which vertex is written twice, and by which segments of the table, if it was
 * copied. Returns PCCD_E_SEGMENT. [compute], [team] */
int srv_stage_explain_twice(const struct srv_scene *scene,
                            const struct srv_staging *staging, struct proto_error *error);

/* Make a copy, of malloc, of what the step uses of its slot, *bytes of at most
 * `bytes_max`. Returns 0, PCCD_E_SLOT_STALE, PCCD_E_SLOT_TORN, PCCD_E_SEGMENT (it uses
 * more, or a segment is not as it must be) or PCCD_E_NOMEM with *error set. [any] */
int srv_stage_keep(struct srv_ring *ring, const struct srv_slot_ref *slot,
                   uint64_t bytes_max, uint8_t **copy, uint64_t *bytes,
                   struct proto_error *error);

/* ---- what is kept of it for journals [compute] ------------------------------------- */

/* Forget what there is, and prepare for up to so many segments, and so many bytes with
 * their table. While a scene has journals, its staging copies each segment to scene->sent
 * first and reads the copy: shared memory is read once. */
void srv_sent_begin(struct srv_sent *sent, uint64_t segments_max, uint64_t bytes_max);
/* Copy a checked segment. Its parts, of `bytes` each, are where its positions start
 * (of X1 any) and where they end; then they are the copies, if these fit. */
void srv_sent_add(struct srv_sent *sent, const struct proto_segment *segment,
                  uint64_t bytes, const uint8_t *parts[2]);
void srv_sent_end(struct srv_sent *sent);

#endif
