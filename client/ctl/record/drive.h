/* drive.h - makes a daemon repeat what a recorded client did.
 *
 * Register everything in a daemon as the recorded client had it, under the same handles,
 * and keep it so; submit recorded steps and collect their answers.
 *
 * Threads: one.
 */
#ifndef CTL_DRIVE_H
#define CTL_DRIVE_H

#include "pccd.h"
#include "world.h"

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
