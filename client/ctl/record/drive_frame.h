/* drive_frame.h - what a recorded step moves, as a frame for a daemon.
 *
 * Copy the recorded segments into a frame of libpccd. For a daemon that has not seen all
 * steps before, the frame also says where everything begins: of the steps 1, 2, 3 it has
 * seen 1, and 3 moves the end of one object; then both ends of that object are told, and
 * of each other one that step 2 may have moved. The answer is the same, bit for bit.
 *
 * Threads: one.
 */
#ifndef CTL_DRIVE_FRAME_H
#define CTL_DRIVE_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "pccd.h"
#include "world.h"

/* Some vertices of an object that are told. */
struct drive_piece {
    struct record_segment segment;
    const double (*begin)[3]; /* [count] of the segment: where they begin; NULL: as the
                                 segment says */
    const double (*end)[3];   /* likewise, where they end */
};

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

#endif
