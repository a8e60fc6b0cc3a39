/* pccd_batch.h - steps of many scenes by one request: for learners, planners and farms,
 * which have many small worlds.
 *
 * Say once which scenes there are and what moves in each; then, for each step, bring all
 * positions at once and get an array of answers, one a scene. Threads of the daemon take
 * scenes one by one. Each answer is that of a step of the scene by itself (pccd_step),
 * with the same hash.
 *
 * Threads: as pccd.h, which includes this header.
 *
 * A thousand worlds with one body each:
 *
 *     struct pccd_batch_part parts[1000];
 *     for (int i = 0; i < 1000; i++) {
 *         parts[i] = (struct pccd_batch_part){.scene = scenes[i], .object = bodies[i],
 *                                             .count = vertex_count};
 *     }
 *     struct pccd_batch *batch;
 *     pccd_batch_create(client, parts, 1000, &batch);
 *     for (each step) {
 *         struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
 *         pccd_batch_step(batch, NULL, x1, NULL, &answer);
 *         for (uint64_t i = 0; i < answer.count; i++) {
 *             use(answer.scenes[i].toi_first, pccd_batch_contacts(&answer, i));
 *         }
 *         pccd_batch_release(client, &answer);
 *     }
 *     pccd_batch_destroy(batch);
 */
#ifndef PCCD_BATCH_H
#define PCCD_BATCH_H

#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

struct pccd_batch;
struct pccd_client;
struct pccd_step_settings;

/* The way in which a part of a batch moves. */
enum pccd_batch_way {
    PCCD_BATCH_X1 = 0,     /* to x1, from where the last step ended */
    PCCD_BATCH_X0X1 = 1,   /* from x0 to x1 */
    PCCD_BATCH_RIGID = 2,  /* by transforms at both ends, as pccd_frame_rigid says */
    PCCD_BATCH_TURNING = 3 /* on a joint of its scene, as pccd_frame_turning says:
                            * `first` is the joint, `count` all vertices */
};

/* A part of a batch: `count` vertices of an object, from `first` on. */
struct pccd_batch_part {
    uint32_t scene;
    uint32_t object; /* 0: nothing moves in the scene; it has no other part then */
    uint32_t first, count;
    enum pccd_format format; /* of x0 and x1 */
    enum pccd_batch_way way;
};

/* Create a batch of these parts; the array is copied. The parts of one scene stand one
 * behind the other; scenes are numbered from 0 as they come. Handles are looked at by the
 * daemon, at each step: a part may name an object that is made, or replaced, later.
 * Errors: E_INVAL: no parts, or one that says no way to move; E_LIMIT: more than 65 536
 * scenes or parts; E_NOMEM. */
int pccd_batch_create(struct pccd_client *client, const struct pccd_batch_part *parts,
                      uint32_t part_count, struct pccd_batch **batch);
/* Create one in which bodies turn, too (pccd_turning.h): scene i has a table of
 * joint_counts[i] joints, or 0: none, and brings it at each step as the x1 of its parts
 * that turn, struct pccd_joint [joint_counts[i]], the same one for all of them. E_INVAL:
 * also a part on a joint that its scene has not. */
int pccd_batch_create_turning(struct pccd_client *client,
                              const struct pccd_batch_part *parts, uint32_t part_count,
                              const uint32_t *joint_counts, uint32_t scene_count,
                              struct pccd_batch **batch);
/* Free it, before or after pccd_close. One that is begun is aborted; those in flight go
 * on. NULL is allowed. */
void pccd_batch_destroy(struct pccd_batch *batch);
/* Return how many scenes the batch has; its answers have as many entries. */
uint32_t pccd_batch_scenes(const struct pccd_batch *batch);

/* The answer for all scenes. `scenes` lies in memory that the daemon shares: read-only,
 * valid until pccd_batch_release. */
struct pccd_batch_answer {
    size_t struct_bytes; /* as in struct pccd_answer */
    uint64_t step; /* the client's number for the first scene's step, as pccd_batch_submit
                      returned it; scene i has step + i, also for pccd_fetch */
    int status;    /* 0; or why none was stepped: then nothing else is set */
    uint32_t failed, incomplete; /* scenes with a status that is not 0; incomplete ones */
    const struct pccd_scene_answer *scenes; /* [count] */
    uint64_t count;                         /* that of the batch */
    uint64_t total;                         /* records of all scenes */
    uint32_t threads;
    uint64_t queue_ns; /* from arrival to its turn, nanoseconds */
    uint64_t batch_ns; /* from there to the finished answers */
    uint64_t steps_ns; /* sum of the scenes' ns_step */
    enum pccd_mode mode;
    uint64_t offset;      /* of `scenes`, as scenes[i].offset is of the records */
    uint64_t reserved[2]; /* the library's */
};

#define PCCD_BATCH_ANSWER_INIT                                                           \
    {                                                                                    \
        .struct_bytes = sizeof(struct pccd_batch_answer)                                 \
    }

/* Return the records of scene i that came with the answer: [scenes[i].count], sorted.
 * NULL: there are none, or those of mode pairs, or i is not less than count. Further
 * ones: pccd_fetch(client, scenes[i].scene, step + i, scenes[i].count, ...).
 * [any thread] */
const struct pccd_contact *pccd_batch_contacts(const struct pccd_batch_answer *answer,
                                               uint64_t i);
/* Return the same in mode pairs; NULL in other modes. */
const struct pccd_pair *pccd_batch_pairs(const struct pccd_batch_answer *answer,
                                         uint64_t i);

/* Begin a step: take a slot, as pccd_frame_begin does, and get where to write positions:
 * x1[part] is packed [count][3] of the part's format; of a rigid part double[12], of one
 * that turns the table of its scene. x0 has the same of parts with both ends, NULL of
 * others; it may be NULL if there are none.
 * Write before commit; never read. Errors: those of pccd_frame_begin; E_STATE: it is
 * begun. */
int pccd_batch_begin(struct pccd_batch *batch, void **x0, void **x1);
/* Submit what was written. `settings` are those of every scene (no `hold`, no
 * `tells_start`), NULL: the defaults; their deadline is the batch's: a scene that is not
 * done by then is incomplete, and moves behind the answer; if it cannot, also where what
 * it moves makes no sense, its next step says why. The others keep their answers. So it
 * is with one that is cancelled. *step numbers the first scene's step. The batch can be
 * begun again at once. */
int pccd_batch_commit(struct pccd_batch *batch, const struct pccd_step_settings *settings,
                      uint64_t *step);
/* Give the slot back unsent. */
void pccd_batch_abort(struct pccd_batch *batch);

/* Begin, copy and commit in one: x0 and x1 [part], as above; x0 may be NULL if no part
 * has both ends. The arrays may change as soon as it returns. E_INVAL: also parts of one
 * scene whose tables of joints differ. */
int pccd_batch_submit(struct pccd_batch *batch, const void *const *x0,
                      const void *const *x1, const struct pccd_step_settings *settings,
                      uint64_t *step);

/* Take one finished answer to a batch of the client, oldest first, without waiting:
 * E_AGAIN if there is none. pccd_poll leaves them alone, and this one those of steps. */
int pccd_batch_poll(struct pccd_client *client, struct pccd_batch_answer *answer);
/* Wait for that of a batch; timeout_ms as for pccd_wait. Returns 0 also if scenes failed:
 * each says so itself. pccd_cancel and pccd_abandon take the same number. */
int pccd_batch_wait(struct pccd_client *client, uint64_t step, int timeout_ms,
                    struct pccd_batch_answer *answer);
/* Submit and wait in one; one that timed out is abandoned. */
int pccd_batch_step(struct pccd_batch *batch, const void *const *x0,
                    const void *const *x1, const struct pccd_step_settings *settings,
                    struct pccd_batch_answer *answer);
/* Give the answers and their records back, in any order. Safe after a failure. */
void pccd_batch_release(struct pccd_client *client, struct pccd_batch_answer *answer);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
