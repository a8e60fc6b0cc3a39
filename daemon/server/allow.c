/* allow.c - which users may be clients. */
#include "allow.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdlib.h>
#include <unistd.h>

#define GROUPS_MAX 65536 /* NGROUPS_MAX of Linux */

static bool number_of(const char *name, uint32_t *number)
{
    char *end = NULL;
    errno = 0;
    unsigned long value = strtoul(name, &end, 10);
    *number = (uint32_t)value;
    return name[0] >= '0' && name[0] <= '9' && *end == '\0' && errno == 0 &&
           value < UINT32_MAX; /* (uid_t)-1 is nobody */
}

bool srv_allow_user(struct srv_allow *allow, const char *name)
{
    uint32_t number = 0;
    if (allow->uid_count >= SRV_ALLOW_MAX) {
        return false;
    }
    if (!number_of(name, &number)) {
        const struct passwd *entry = getpwnam(name);
        if (entry == NULL) {
            return false;
        }
        number = entry->pw_uid;
    }
    allow->uids[allow->uid_count++] = number;
    return true;
}

bool srv_allow_group(struct srv_allow *allow, const char *name)
{
    uint32_t number = 0;
    if (allow->gid_count >= SRV_ALLOW_MAX) {
        return false;
    }
    if (!number_of(name, &number)) {
        const struct group *entry = getgrnam(name);
        if (entry == NULL) {
            return false;
        }
        number = entry->gr_gid;
    }
    allow->gids[allow->gid_count++] = number;
    return true;
}

static bool has_group(const struct srv_allow *allow, gid_t gid)
{
    for (uint32_t i = 0; i < allow->gid_count; i++) {
        if (allow->gids[i] == gid) {
            return true;
        }
    }
    return false;
}

/* Return whether one of the further groups that the peer had is in the list. */
static bool has_further_group(const struct srv_allow *allow, int socket)
{
    gid_t few[64];
    gid_t *groups = few;
    socklen_t bytes = sizeof few;
    int status = getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups, &bytes);
    if (status != 0 && errno == ERANGE && bytes <= GROUPS_MAX * sizeof few[0]) {
        groups = malloc(bytes); /* `bytes` says what it takes */
        status = groups == NULL
                     ? -1
                     : getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups, &bytes);
    }
    bool found = false;
    for (size_t i = 0; status == 0 && i < bytes / sizeof groups[0] && !found; i++) {
        found = has_group(allow, groups[i]);
    }
    if (groups != few) {
        free(groups);
    }
    return found;
}

bool srv_allow_peer(const struct srv_allow *allow, int socket, const struct ucred *peer)
{
    if (!srv_allow_has_list(allow) || peer->uid == 0 || peer->uid == geteuid()) {
        return true;
    }
    for (uint32_t i = 0; i < allow->uid_count; i++) {
        if (allow->uids[i] == peer->uid) {
            return true;
        }
    }
    return allow->gid_count > 0 &&
           (has_group(allow, peer->gid) || has_further_group(allow, socket));
}

gid_t srv_peer_group(int socket)
{
    struct ucred peer;
    socklen_t bytes = sizeof peer;
    return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) == 0 ? peer.gid
                                                                           : (gid_t)-1;
}

bool srv_peer_has_group(int socket, gid_t gid)
{
    const struct srv_allow allow = {.gid_count = 1, .gids = {gid}};
    return gid != (gid_t)-1 &&
           (srv_peer_group(socket) == gid || has_further_group(&allow, socket));
}
