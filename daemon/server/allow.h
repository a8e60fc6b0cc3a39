/* allow.h - decides which users may connect: the lists of --allow-uid and --allow-gid. */
#ifndef SRV_ALLOW_H
#define SRV_ALLOW_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/types.h>

#include "options.h"

/* Add a name or a number; false: there is none of that name, or no room. */
bool srv_allow_user(struct srv_allow *allow, const char *name);
bool srv_allow_group(struct srv_allow *allow, const char *name);

static inline bool srv_allow_has_list(const struct srv_allow *allow)
{
    return allow->uid_count > 0 || allow->gid_count > 0;
}

/* Return whether the peer of `socket` with these credentials may be a client: the
 * daemon's own user and root always may. */
bool srv_allow_peer(const struct srv_allow *allow, int socket, const struct ucred *peer);

/* Return the peer's group; (gid_t)-1: not known. */
gid_t srv_peer_group(int socket);
/* Return whether that or a further one of its groups is `gid`. */
bool srv_peer_has_group(int socket, gid_t gid);

#endif
