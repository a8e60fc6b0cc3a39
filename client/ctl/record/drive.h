/* drive.h - makes a daemon repeat what a recorded client did.
 *
 * Register everything in a daemon as the recorded client had it, under the same handles,
 * and keep it so; submit recorded steps and collect their answers.
 *
 * Threads: one.
 */
#ifndef CTL_DRIVE_H
#define CTL_DRIVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "pccd.h"
#include "world.h"

/* ---- What a recorded step moves, as a frame for a daemon.
 *
 * Copy the recorded segments into a frame of libpccd. For a daemon that has not seen all
 * steps before, the frame also says where everything begins: of the steps 1, 2, 3 it has
 * seen 1, and 3 moves the end of one object; then both ends of that object are told, and
 * of each other one that step 2 may have moved. The answer is the same, bit for bit. */

/* All zero: nothing moves. */
struct drive_pieces {
    struct drive_piece *items; /* ours */
    uint32_t count;
    size_t room;
    uint64_t bytes; /* of their positions in a frame */
};

/* What the `count` segments at the beginning of `slot` move in a scene. `world` NULL: the
 * daemon has seen all steps; else it stands where the step begins. PCCD_E_NOMEM. */
int drive_pieces_make(struct drive_pieces *pieces, const struct registry *world,
                      uint32_t scene, uint32_t count, const uint8_t *slot,
                      struct ctl_error *error);
/* The last movement of a scene once more, for who asks where it began. */
int drive_pieces_repeat(struct drive_pieces *pieces, const struct registry *world,
                        uint32_t scene, struct ctl_error *error);
void drive_pieces_deinit(struct drive_pieces *pieces);

/* A frame with them; there is one at least. Errors: those of pccd_frame_begin and of the
 * functions that add to a frame. */
int drive_pieces_frame(const struct drive_pieces *pieces, struct pccd_client *client,
                       uint32_t scene, const uint8_t *slot, struct pccd_frame *made);

struct drive {
    struct pccd_client *client; /* the caller's */
    bool is_begun;
    char tuning[PCCD_TUNING_BYTES];      /* of the next step; the caller's to set */
    struct record_separation separation; /* likewise */
    bool tells;                          /* what crosses; likewise */
    /* Where everything stands, once the daemon has not seen a step (the caller's to set):
     * then each step says where it begins. NULL: the daemon has seen all. */
    const struct registry *stands;
    bool knows_no_begin;       /* of a scene's last movement; the caller's to set, too */
    struct pccd_answer answer; /* of the last step: numbers; no records */
    void *records;             /* ours: those that were collected */
    uint64_t record_count;
    size_t record_room; /* bytes */
};

/* Tell the daemon of everything in `world`. */
int drive_begin(struct drive *drive, const struct registry *world,
                struct ctl_error *error);
/* Follow a chunk that is not a step, after drive_begin; `world` has followed it. */
int drive_follow(struct drive *drive, const struct registry *world,
                 const struct record_view *view, struct ctl_error *error);
/* Submit a step with these settings, which the caller may have changed, and wait for its
 * answer. A step that fails in the daemon is an answer: drive->answer.status. With
 * `collects`, all its records, page by page. */
int drive_step(struct drive *drive, const struct record_frame *frame, const uint8_t *slot,
               bool collects, struct ctl_error *error);
/* The same of a question about what is near, in a world that stands where it is asked. */
int drive_near(struct drive *drive, const struct registry *world,
               const struct record_near *near, const uint8_t *slot, bool collects,
               struct ctl_error *error);
/* The same of a step of another client: it only moves what it moves. */
int drive_move(struct drive *drive, const struct record_frame *frame, const uint8_t *slot,
               struct ctl_error *error);
void drive_deinit(struct drive *drive);

#endif
