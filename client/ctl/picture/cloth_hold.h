/* cloth_hold.h - moves the demo's cloth so that it never passes through anything.
 *
 * Ask the daemon what would collide on the way of a frame, push it apart until nothing
 * collides, then take the frame. If pushing is not enough, the frame ends before the
 * first contact.
 *
 * Threads: one.
 */
#ifndef CTL_CLOTH_HOLD_H
#define CTL_CLOTH_HOLD_H

#include "cloth_scene.h"
#include "error.h"
#include "pccd.h"

/* What a record's handles and feature numbers mean. */
struct cloth_object {
    uint32_t object;
    uint32_t vertex_count, triangle_count;
    const uint32_t (*triangles)[3];
    struct pccd_edge *edges; /* ours */
};

/* Told of each answer, before its records are given back; `is_taken`: nothing is met, and
 * the frame goes that way. */
typedef void (*cloth_hold_fn)(void *context, const struct pccd_answer *answer,
                              bool is_taken);

struct cloth_hold {
    struct pccd_client *client; /* the caller's */
    struct cloth_scene *cloth;  /* ours */
    uint32_t scene;
    struct cloth_object objects[2]; /* cloth, ball */
    uint32_t threads;               /* of a step; 0: the daemon decides */
    uint64_t cut;                   /* frames that ended before their time */
};

/* Register the meshes of a new scene. E_NOMEM, and what the daemon says. */
int cloth_hold_init(struct cloth_hold *hold, struct pccd_client *client,
                    struct ctl_error *error);
/* Move cloth and ball by one frame. */
int cloth_hold_frame(struct cloth_hold *hold, cloth_hold_fn tell, void *context,
                     struct ctl_error *error);
/* Not the client. */
void cloth_hold_deinit(struct cloth_hold *hold);

#endif
