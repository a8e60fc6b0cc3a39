/* member.h - one client's part in a shared scene (a member).
 *
 * Threads: [loop], but for members marked otherwise.
 */
#ifndef SRV_MEMBER_H
#define SRV_MEMBER_H

#include <stdbool.h>
#include <stdint.h>

#include "codec.h"
#include "compute.h"

struct srv_held_frame;
struct srv_journal;
struct srv_session;
struct srv_shared;

/* One session that takes part. */
struct srv_member {
    struct srv_job leave;    /* first: runs when it leaves, behind its requests */
    struct srv_claim *claim; /* of the scene */
    struct srv_member *next;
    struct srv_member *next_hiding; /* of shared->hiding */
    struct srv_shared *shared;
    struct srv_session *session;
    struct proto_error owed; /* [compute] of a step of its own that was answered before
                              * its turn; code 0: none */
    struct srv_held_frame *left; /* [compute] then [loop]: frames that it had held */
    uint32_t cursor;             /* [compute] objects before it have been taken out */
    uint32_t aside;              /* place of the next object of srv_shared_aside */
    uint32_t handle;             /* of the scene, in the session's table */
    struct srv_journal *journal; /* [compute] of the scene; NULL: none */
    uint64_t journal_bytes;      /* SRV_QUOTA_SHM_BYTES, for its journal; 0: none */
    bool is_writer;
    bool holds;         /* a frame for the scene's next step (held.h) */
    uint64_t held_step; /* the client's number of the frame that waits; 0: none does */
    bool owes_held;     /* that it waits could not be told yet */
    bool is_behind;     /* the last step could not be told yet */
};

#endif
