/* step.h - what is asked of scenes, and what comes of it.
 *
 * A step, a question about what is near and a batch are one thing: a verb, asked of one
 * scene or of several, with a slot of positions. The verb is the method of its message:
 * FRAME_SUBMIT, SCENE_NEAR or BATCH_SUBMIT. All are numbered among the steps, and the
 * answer to each waits in the table of calls until it is taken.
 *
 *     the caller's array
 *     |  frame.c, batch.c   write it into a slot, which attach.c finds: the only copy
 *     |  step.c             settings, slot and number make a message
 *     |  rpc.c              is encoded and sent; a call waits for the answer
 *     v
 *     the daemon
 *     |  receive.c          decodes the answer into the call
 *     v  answer.c           hands it out; its records stay where they lie
 *     the caller's struct
 */
#ifndef CLI_STEP_H
#define CLI_STEP_H

#include "client.h"

/* ---- positions: frame.c ------------------------------------------------------------ */

/* Layout of the payload of a slot. */
#define CLI_PAYLOAD_ALIGN 64u /* of the first range: a cache line */
#define CLI_RANGE_ALIGN   8u  /* of every range: the protocol's */

static inline uint64_t cli_round_up(uint64_t bytes, uint64_t unit)
{
    return (bytes + unit - 1) / unit * unit;
}

/* Let its ends begin at byte `used` of the payload. Returns the byte behind them. */
uint64_t cli_segment_place(struct proto_segment *segment, uint64_t used);
/* Copy its ends there. Of one that is as PROTO_SEGMENT_X1, x0 is not read. */
void cli_segment_write(uint8_t *payload, const struct proto_segment *segment,
                       const void *x0, const void *x1);

/* Begin a slot of so many bytes, if another step can be submitted. */
int cli_step_slot(struct pccd_client *client, uint64_t bytes, uint32_t *slot);

/* The joints of a step, of which motions turn; none: count 0. */
struct cli_joints {
    const struct pccd_joint *items;
    uint32_t count;
};

/* Begin a slot and write all motions into it. The slot is the caller's, to be sent or
 * aborted; on failure there is none. */
int cli_frame_write(struct pccd_client *client, uint32_t scene,
                    const struct pccd_motion *motions, uint32_t motion_count,
                    struct cli_joints joints, uint32_t *slot);

/* Take the slot of a frame that is to be sent now, which the frame gives up also on
 * failure: it is aborted then. `step` is only looked at: NULL is refused. */
int cli_frame_take(struct pccd_frame *frame, const uint64_t *step, uint32_t *scene,
                   uint32_t *slot);

/* Leave the client's batches nothing but to be destroyed: the client goes. */
void cli_batch_forget_all(struct pccd_client *client);

/* ---- asking: step.c ---------------------------------------------------------------- */

/* Check whether another step can be submitted: 0, or PCCD_E_BUSY when CLI_STEPS answers
 * wait to be taken, or too many pages wait to be released; or PCCD_E_DISCONNECTED. */
int cli_step_check(struct pccd_client *client);

/* Fill in the message of a verb with the caller's settings, which may be of a program
 * that knows a later struct; NULL: the defaults. `scene` is not of a batch. Slot and
 * number are left to cli_step_send. Returns 0, or E_INVAL with a text. */
int cli_step_describe(struct pccd_client *client, int verb, const void *settings,
                      uint32_t scene, union cli_params *message);

/* Send it, which cli_step_check allows. A `slot` that is begun is published with it, and
 * comes back with the answer, or at once on failure; CLI_SLOT_NONE: nothing moves. */
int cli_step_send(struct pccd_client *client, int verb, union cli_params *message,
                  uint32_t slot, uint64_t *step);

/* ---- answers: answer.c ------------------------------------------------------------- */

/* Return a step's call, until its answer is taken; NULL: there is none. */
struct cli_call *cli_step_find(struct pccd_client *client, uint64_t step);

/* Take in what has arrived, without waiting. */
void cli_step_drain(struct pccd_client *client);

/* An answer is a struct pccd_answer, or, where `is_batch`, a struct pccd_batch_answer. */

/* Check that it may be filled in. E_INVAL: it is NULL, or of a length that no release
 * has. */
int cli_answer_check(struct pccd_client *client, const void *answer, bool is_batch);
/* Take the oldest that has come: E_AGAIN: there is none. */
int cli_answer_poll(struct pccd_client *client, bool is_batch, void *answer);
/* Wait for that of `step`: E_INVAL: it is not pending, or of the other kind; E_AGAIN
 * (timeout_ms 0), E_TIMEOUT. */
int cli_answer_wait(struct pccd_client *client, uint64_t step, bool is_batch,
                    int timeout_ms, void *answer);
/* Wait for it by the client's timeout; what times out is abandoned. */
int cli_answer_finish(struct pccd_client *client, uint64_t step, bool is_batch,
                      void *answer);
/* Get a further page, by frame.fetch or near.fetch, as `method` says. */
int cli_answer_fetch(struct pccd_client *client, int method, const void *request,
                     struct pccd_answer *answer);
/* Give its page back, if `reserved` of the answer says that it has one. */
void cli_answer_release(struct pccd_client *client, uint64_t reserved[2]);

#endif
