/* enginemem.h - charges the engine's memory to the user whose work needs it, and stops at
 * the user's quota.
 *
 * Wrap everything that allocates or frees in the engine for a session: meshes, trees,
 * scratch of steps, records of answers. Beyond the user's quota the engine gets no
 * memory.
 *
 * Threads: [compute]; several, for one user or for more.
 */
#ifndef SRV_ENGINEMEM_H
#define SRV_ENGINEMEM_H

#include <stdbool.h>
#include <stdint.h>

#include "quota.h"

struct srv_enginemem {
    struct srv_quota_user *user;
    uint64_t limit;        /* bytes of one user */
    uint64_t refused;      /* allocations of the user's, before */
    uint64_t ceiling_hits; /* for all users' bound, before */
};

void srv_enginemem_begin(struct srv_enginemem *memory, struct srv_quota_user *user);

/* End it. Returns whether the quota has refused memory since it began. */
bool srv_enginemem_end(struct srv_enginemem *memory);

/* End it, and return the status of a work that ended with `status`: a lack of memory that
 * was the quota's, or the bound's of all users, is PCCD_E_QUOTA, with *error naming
 * amount and limit. */
int srv_enginemem_explain(struct srv_enginemem *memory, int status,
                          struct proto_error *error);
/* Return the status of a part of such a work, which goes on: of what was refused
 * meanwhile some may have been for other parts. [compute], [team] */
int srv_enginemem_tell(const struct srv_enginemem *memory, int status,
                       struct proto_error *error);

/* Allocate memory of the loop that a user can make much of, all zero, charged like the
 * engine's, for `what`; NULL, with *error set: there is none, or the quota refuses it.
 * [loop] */
void *srv_enginemem_new(struct srv_quota_user *user, size_t bytes, const char *what,
                        struct proto_error *error);
/* Free and refund it. [loop] */
void srv_enginemem_delete(struct srv_quota_user *user, void *block);

/* Refuse a mesh or object of so many triangles that would hardly fit into what the engine
 * may hold for the user, while sessions that wait, or are not freed yet, hold some of it:
 * the engine allocates later, on [compute], where no room can be made any more. Returns
 * 0, or PCCD_E_QUOTA with *error set. [loop] */
int srv_enginemem_refuse_tight(struct srv_quota_user *user, uint64_t triangles,
                               struct proto_error *error);

#endif
