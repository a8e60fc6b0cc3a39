/* player.h - moves a mesh in a daemon through the frames of files, for `pccdctl load`.
 *
 * Threads: one.
 */
#ifndef CTL_PLAYER_H
#define CTL_PLAYER_H

#include <stdint.h>

#include "error.h"
#include "meshfile.h"
#include "meshframes.h"
#include "pccd.h"

#define PLAYER_TIMES_MAX 1000000u /* round trips that are kept */

struct player_settings {
    char *const *files; /* of the frames; the caller's */
    uint32_t file_count;
    char *const *still; /* files of meshes that stand still */
    uint32_t still_count;
    struct ctl_frames_options frames;
    double hz;      /* 0: as fast as they are answered */
    double seconds; /* 0: `times` decides */
    uint32_t times;
    uint32_t threads;  /* 0: the daemon decides */
    const char *scene; /* name of one that is shared, to take part in; NULL: a new one */
    bool holds;        /* move with the steps of others there */
};

/* All zero before player_read. */
struct player {
    const struct player_settings *settings;
    struct pccd_client *client; /* the caller's, between reading and playing */
    struct ctl_frames files;
    struct ctl_mesh *frames; /* ours, [files.count], all of one format */
    struct ctl_mesh *still;  /* ours */
    uint32_t scene, object;
    double *times_ms; /* ours: round trips; [kept] */
    uint32_t kept;
    uint64_t steps, contacts, incomplete, triangles;
    uint64_t late;  /* steps that began after their time */
    double begin_s; /* of the first step */
    double seconds;
};

/* Errors: those of ctl_frames_open and ctl_frames_read. */
int player_read(struct player *player, const struct player_settings *settings,
                struct ctl_error *error);
/* Until the end of the settings, or an interrupt. */
int player_play(struct player *player, struct ctl_error *error);
void player_deinit(struct player *player);

#endif
