/* replayer.h - makes a daemon repeat what a recorded client did.
 *
 * The recorded state follows the file alone. Before an item is asked again, the daemon is
 * told what it does not know yet: meshes, scenes and objects, under the same handles; and
 * where the objects are, if it has not seen a scene's last step.
 */
#ifndef CTL_REPLAYER_H
#define CTL_REPLAYER_H

#include "recorded_state.h"

struct replayer {
    struct pccd_client *client; /* the caller's; NULL: there is no daemon yet */
    bool is_behind;             /* something was made, replaced or set since */
    struct pccd_answer answer;  /* to the last item: numbers; no records */
    void *records;              /* ours: those that were collected */
    uint64_t record_count;
    size_t record_room;          /* bytes */
    struct pccd_motion *motions; /* ours: of one item */
    size_t motion_room;
    struct recorded_joints joints; /* on which they turn */
};

/* Follow a chunk that is not of an item, and tell the daemon, if there is one, what goes
 * and which pairs are ignored. Errors: those of recorded_state_follow and of the daemon.
 */
int replayer_follow(struct replayer *replayer, struct registry *state,
                    const struct record_view *view, struct ctl_error *error);
/* Ask an item of a state that stands where it begins, and wait for the answer. One that
 * fails in the daemon is an answer: replayer->answer.status. With `collects`, all its
 * records, page by page. */
int replayer_ask(struct replayer *replayer, struct registry *state,
                 const struct recorded_item *item, bool collects,
                 struct ctl_error *error);
void replayer_deinit(struct replayer *replayer);

#endif
