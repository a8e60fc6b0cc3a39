/* positions.h - remembers the last positions of all objects, in case another daemon must
 * be told.
 *
 * Positions are not copied when a step is answered: its slot is KEPT, and read only when
 * it is needed for another step and still holds the last positions of some object. A
 * client that has more slots than steps in flight, and moves whole objects, never copies.
 */
#ifndef CLI_POSITIONS_H
#define CLI_POSITIONS_H

#include "client.h"

/* The step in a slot has been answered and its positions are the last: the slot is KEPT,
 * or free again when nothing is kept. */
void cli_positions_answered(struct pccd_client *client, uint32_t slot, uint64_t step);

/* Before that, of a batch: scenes that have failed were not moved. */
void cli_positions_leave_out(struct pccd_client *client, uint32_t slot,
                             const struct pccd_scene_answer *scenes);

/* Make a KEPT slot free: copy what only it holds. Slots must be taken in the order of
 * their steps. Returns 0 or PCCD_E_NOMEM. */
int cli_positions_fold(struct pccd_client *client, uint32_t slot);
/* All of them. */
int cli_positions_fold_all(struct pccd_client *client);

#endif
