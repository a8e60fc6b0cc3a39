/* replica.h - what another daemon would have to be told, after a crash.
 *
 * Positions are not copied when a step is answered: its slot is KEPT, and read only when
 * it is needed for another step and still holds the last positions of some object. A
 * client that has more slots than steps in flight, and moves whole objects, never copies.
 */
#ifndef CLI_REPLICA_H
#define CLI_REPLICA_H

#include "client.h"

struct cli_pipeline;

/* The mesh `handle` has been committed, or replaced, with what is in `copy`, which is
 * taken over. */
void cli_replica_mesh(struct pccd_client *client, uint32_t handle,
                      struct registry_mesh *copy);

/* A request has been answered with success: note what it has changed. */
void cli_replica_answer(struct pccd_client *client, struct cli_call *call);

/* scene.near has been answered: its pages are those of the scene from now on. */
void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request);
/* The scene is gone. */
void cli_near_forget(struct pccd_client *client, uint32_t scene);
/* Return whether `step` numbers the last answered question about the scene. */
bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step);

/* ---- positions --------------------------------------------------------------------- */

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

/* Send all that announces, uploads and commits a mesh with the arrays of `copy`, under
 * the handle `want`, or under any when that is 0: then the announcement alone is waited
 * for. */
int cli_mesh_send(struct cli_pipeline *pipeline, const struct registry_mesh *copy,
                  uint32_t want, uint32_t *handle);

#endif
