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

/* Keep `copy`, which is taken over: what the mesh `handle` was made of, or replaced
 * with. */
void cli_replica_mesh(struct pccd_client *client, uint32_t handle,
                      struct registry_mesh *copy);

/* Note what a request that was answered with success has changed. */
void cli_replica_answer(struct pccd_client *client, struct cli_call *call);

/* Note that a scene.near was answered: its pages are those of the scene from now on. */
void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request);
/* Forget the question about a scene that is gone. */
void cli_near_forget(struct pccd_client *client, uint32_t scene);
/* Return whether `step` numbers the last answered question about the scene. */
bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step);

/* ---- positions --------------------------------------------------------------------- */

/* Keep the slot of a step that was answered, as its positions are the last. Slots that no
 * object needs any more, this one perhaps, are free again. */
void cli_positions_answered(struct pccd_client *client, uint32_t slot, uint64_t step);

/* Leave out the scenes of a batch that have failed, before cli_positions_answered: they
 * were not moved. */
void cli_positions_leave_out(struct pccd_client *client, uint32_t slot,
                             const struct pccd_scene_answer *scenes);

/* Make a KEPT slot free: copy what only it holds. Slots must be taken in the order of
 * their steps. Returns 0 or PCCD_E_NOMEM. */
int cli_positions_fold(struct pccd_client *client, uint32_t slot);
/* Make every KEPT slot free. */
int cli_positions_fold_all(struct pccd_client *client);

/* Send all that announces, uploads and commits a mesh with the arrays of `copy`, under
 * the handle `want`, or under any when that is 0: then the announcement alone is waited
 * for. */
int cli_mesh_send(struct cli_pipeline *pipeline, const struct registry_mesh *copy,
                  uint32_t want, uint32_t *handle);

#endif
