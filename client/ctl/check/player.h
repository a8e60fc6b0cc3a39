/* player.h - moves meshes in a daemon through the frames of files, for `pccdctl load`. */
#ifndef CTL_PLAYER_H
#define CTL_PLAYER_H

#include <stdint.h>

#include "error.h"
#include "meshfile.h"
#include "pccd.h"
#include "scene.h"

#define PLAYER_TIMES_MAX 1000000u /* round trips that are kept */

struct player_settings {
    double hz;      /* 0: as fast as they are answered */
    double seconds; /* 0: `times` decides */
    uint32_t times;
    uint32_t threads;  /* 0: the daemon decides */
    const char *scene; /* name of one that is shared, to take part in; NULL: a new one */
    bool holds;        /* move with the steps of others there */
    bool tells_start;  /* ask what intersects at the start of each step, too */
};

/* All zero before player_read. */
struct player {
    const struct player_settings *settings;
    struct pccd_client *client;  /* the caller's, between reading and playing */
    struct scene *files;         /* the caller's, open */
    struct ctl_mesh *frames;     /* ours, [object_count][frame_count]; of what moves */
    struct pccd_motion *motions; /* ours, [object_count] */
    uint32_t scene;
    double *times_ms; /* ours: round trips; [kept] */
    uint32_t kept;
    uint64_t steps, contacts, incomplete, triangles;
    uint64_t late;  /* steps that began after their time */
    double begin_s; /* of the first step */
    double seconds;
};

/* Read all frames of what moves, each object's of one format. Errors: those of
 * scene_read_object. */
int player_read(struct player *player, struct scene *files,
                const struct player_settings *settings, struct ctl_error *error);
/* Place the objects, and play the frames until the end of the settings, or an
 * interrupt. */
int player_play(struct player *player, struct ctl_error *error);
void player_deinit(struct player *player);

#endif
