/* sessions.h - lists the clients of a daemon, with their scenes and objects. */
#ifndef CTL_SESSIONS_H
#define CTL_SESSIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd.h"

#define SESSION_NAME_BYTES 256u
#define SCENE_NAME_BYTES   256u

struct session_row {
    struct pccd_session_info info;
    char name[SESSION_NAME_BYTES]; /* in the place of info.client */
    char state[48]; /* what is not usual: "waits", "batch 412 of 1000", or "" */
};

/* All zero: nothing. The arrays are ours. */
struct sessions {
    struct session_row *rows; /* the newest first */
    uint32_t count;
    size_t capacity;
    bool is_short; /* there was no memory for all of them */
};

/* Read anew; returns the library's status, or PCCD_E_NOMEM. */
int sessions_read(struct pccd_client *client, struct sessions *sessions);
void sessions_deinit(struct sessions *sessions);
/* Return the session of that number; NULL: there is none. */
const struct session_row *sessions_find(const struct sessions *sessions, uint64_t number);

struct scene_row {
    struct pccd_scene_info info;
    char name[SCENE_NAME_BYTES]; /* in the place of info.name */
};

struct scenes {
    struct scene_row *rows;
    uint32_t count;
    size_t capacity;
    bool is_short;
};

int scenes_read(struct pccd_client *client, uint64_t session, struct scenes *scenes);
void scenes_deinit(struct scenes *scenes);

#endif
