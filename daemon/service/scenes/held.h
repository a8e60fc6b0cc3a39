/* held.h - held frames: movements of one client that go along with the next step of a
 * shared scene, whoever submits it.
 */
#ifndef SRV_HELD_H
#define SRV_HELD_H

#include <stdint.h>

#include "codec.h"
#include "member.h"
#include "messages.h"
#include "srv_scene.h"

struct srv_request;

struct srv_held_frame {
    struct srv_held_frame *next; /* [compute] of the scene, the oldest first */
    struct srv_request *request; /* [loop] that waits for it; NULL: it was answered */
    /* [loop] the scene is left before a step: answer the request */
    void (*left)(struct srv_request *request);
    struct srv_member *member; /* that has brought it */
    struct proto_FRAME_SUBMIT_request submit;
    uint8_t *copy; /* of the slot, of malloc */
    uint64_t bytes;
    uint64_t charge;          /* SRV_QUOTA_SHM_BYTES: a whole slot */
    uint64_t changes;         /* of the scene, when it was checked last */
    struct proto_error error; /* code 0; else why it could not be taken along */
};

/* Charge the session of a member for its one frame. Returns 0 or PCCD_E_QUOTA with *error
 * set. [loop] */
int srv_held_frame_charge(struct srv_member *member, uint64_t bytes,
                          struct proto_error *error);
/* Refund it. [loop] */
void srv_held_frame_refund(struct srv_member *member, uint64_t bytes);

/* Put a frame behind those that wait, if the scene takes it as it is now; nothing moves.
 * Returns 0, or else a status with *error set. [compute] */
int srv_held_frame_add(struct srv_held_frame *held, struct srv_scene *scene,
                       struct proto_error *error);

/* Check anew what waits, where the scene has changed since: what cannot be moved any more
 * goes to *taken. [compute] */
void srv_held_frame_check(struct srv_scene *scene, struct srv_held_frame **taken);
/* Stage what waits, in the staging that is open. [compute] */
int srv_held_frame_stage(struct srv_scene *scene, struct proto_error *error);
/* Move what was staged to *taken, after the step that took it along. [compute] */
void srv_held_frame_take(struct srv_scene *scene, struct srv_held_frame **taken);
/* Take what was held with the member out of the scene. [compute] */
struct srv_held_frame *srv_held_frame_remove(struct srv_scene *scene,
                                             const struct srv_member *member);

/* Refund and free frames that no scene has any more. [loop] */
void srv_held_frame_free(struct srv_held_frame *list);

#endif
