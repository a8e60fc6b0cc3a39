/* frames.h - a recording of frames from files, for commands that show recordings. */
#ifndef CTL_FRAMES_H
#define CTL_FRAMES_H

#include "error.h"
#include "link.h"
#include "scene.h"

/* Zero before. The file has no name in any folder once it is begun: however the program
 * ends, it is gone then. */
struct frames_recording {
    bool tells_start; /* set before: ask what intersects at the start of each step, too */
    int fd;           /* of the file, while `from` is not "" */
    char from[32];    /* what opens it, in this process; "": there is none */
    char name[224];   /* what it is told of as */
};

/* Record what the client does from now on, until pccd_record_stop: of steps with the
 * contacts that are fetched. `name` is set before. Errors: those of pccd_record_start;
 * E_INVAL: $TMPDIR; E_SYSTEM. */
int frames_begin(struct frames_recording *recording, struct pccd_client *client,
                 struct ctl_error *error);
/* Record a scene that scene_take has taken from `files`; what has one frame stands still
 * for a step. The file is named after the first and the last. Errors: those of scene_open
 * and player_read; of the daemon; E_CANCELLED: interrupted. */
int frames_record(struct frames_recording *recording, struct scene *scene,
                  const struct option_arguments *files, const struct ctl_link *link,
                  struct ctl_error *error);
/* Let go of the file. */
void frames_forget(struct frames_recording *recording);

#endif
