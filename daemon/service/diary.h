/* diary.h - what is done to a shared scene, written down for a session.
 *
 * Room:     service. May include: resource.h, proto/journal.h.
 * Does:     note each object that comes, goes or changes, and each step with what moved,
 *           in the order in which it was done; keep it until it has been taken.
 * Does not: keep more than was asked for: then nothing more is noted, and that is said.
 * Threads:  [compute]. The memory is the C library's, charged before it is taken
 *           (handlers_journal.c).
 */
#ifndef SRV_DIARY_H
#define SRV_DIARY_H

#include <stdbool.h>
#include <stdint.h>

#include "journal.h"
#include "resource.h"

struct srv_request;

/* A session's journal of a scene, while it takes part with that seat. Positions count
 * bytes from its beginning. */
struct srv_diary {
    struct srv_diary *next;        /* of the scene */
    const struct srv_seat *seat;   /* whose it is */
    struct srv_diary_entry *first; /* that is kept */
    struct srv_diary_entry *last;
    uint64_t begin;     /* of the first entry */
    uint64_t end;       /* of the last */
    uint64_t bytes_max; /* that may be kept */
    int status;         /* 0, or why nothing is noted any more: LIMIT, NOMEM */
};

/* Begin one with the scene as it is. PCCD_E_STATE: the session has one; PCCD_E_LIMIT:
 * even this does not fit; PCCD_E_NOMEM. */
int srv_diary_begin(struct srv_scene *scene, const struct srv_seat *seat,
                    uint64_t bytes_max);
/* NULL: it has none. */
struct srv_diary *srv_diary_find(const struct srv_scene *scene,
                                 const struct srv_seat *seat);
/* Forget the entries before `position`, as far as they are whole. */
void srv_diary_forget(struct srv_diary *diary, uint64_t position);
/* Copy `bytes` bytes from `position` on, which are kept. */
void srv_diary_copy(const struct srv_diary *diary, uint64_t position, uint64_t bytes,
                    uint8_t *to);
/* The session's, if it has one. */
void srv_diary_end(struct srv_scene *scene, const struct srv_seat *seat);

/* Note what has been done, for every session that wants to know; nothing for none. */
void srv_diary_add(struct srv_scene *scene, const struct srv_placed *placed);
void srv_diary_gone(struct srv_scene *scene, uint32_t object);
void srv_diary_filter(struct srv_scene *scene, const struct srv_placed *placed);
void srv_diary_pair(struct srv_scene *scene, uint32_t a, uint32_t b, bool ignored);
/* The request's step has run, and has taken along what was held (request->taken). */
void srv_diary_step(const struct srv_request *request);

#endif
