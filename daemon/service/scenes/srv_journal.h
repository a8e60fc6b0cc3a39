/* srv_journal.h - the journal of a shared scene: everything that any client does to it,
 * for a member that records it.
 *
 * Note the requests that change the scene as they were sent, and the slots of steps, in
 * the order in which they were done; keep them until the member has fetched them.
 *
 * Threads: [compute]. The memory is the C library's, charged before it is taken
 * (handlers_journal.c).
 */
#ifndef SRV_JOURNAL_H
#define SRV_JOURNAL_H

#include <stdbool.h>
#include <stdint.h>

#include "srv_scene.h"

struct srv_held_frame;

/* A session's journal of a scene, while it takes part with that member. Positions count
 * bytes from its beginning. */
struct srv_journal {
    struct srv_journal *next;        /* of the scene */
    const struct srv_member *member; /* whose it is */
    struct srv_journal_entry *first; /* that is kept */
    struct srv_journal_entry *last;
    uint64_t begin;     /* of the first entry */
    uint64_t end;       /* of the last */
    uint64_t bytes_max; /* that may be kept */
    int status;         /* 0, or why nothing is noted any more: LIMIT, NOMEM */
};

/* Begin one with the scene as it is. Returns 0, PCCD_E_STATE (the session has one),
 * PCCD_E_LIMIT (even this does not fit) or PCCD_E_NOMEM. */
int srv_journal_begin(struct srv_scene *scene, struct srv_member *member,
                      uint64_t bytes_max);
/* Forget the entries before `position`, as far as they are whole. */
void srv_journal_forget(struct srv_journal *journal, uint64_t position);
/* Copy `bytes` bytes from `position` on, which are kept. */
void srv_journal_copy(const struct srv_journal *journal, uint64_t position,
                      uint64_t bytes, uint8_t *to);
/* End the session's, if it has one. */
void srv_journal_end(struct srv_scene *scene, struct srv_member *member);

/* Note what has been done, for every session that wants to know; nothing for none. */
void srv_journal_add(struct srv_scene *scene, const struct srv_placed *placed);
void srv_journal_gone(struct srv_scene *scene, uint32_t object);
/* Note an object.set or a scene.ignore, as it was sent. */
void srv_journal_note(struct srv_scene *scene, int method, const void *request);
/* Keep from now on what a staging takes, until its step is noted: so many segments, and
 * those of held frames. */
void srv_journal_open(struct srv_scene *scene, uint32_t segments);
/* Note that a step has run, which a session submitted with that member, and that it has
 * taken along what was held. */
void srv_journal_step(struct srv_scene *scene,
                      const struct proto_FRAME_SUBMIT_request *submit,
                      const struct srv_member *member,
                      const struct srv_held_frame *taken);
/* Note that a session has asked with that member what is near, and has moved what it
 * moves. The journals of others have only the motion. */
void srv_journal_near(struct srv_scene *scene,
                      const struct proto_SCENE_NEAR_request *near,
                      const struct srv_member *member);

#endif
