/* recorder_shared.h - records shared scenes, in which other clients move things, too.
 *
 * Fetch the daemon's journals of the shared scenes of a recorded client and write them
 * into the recording: otherwise the client would not know what others move.
 *
 * What anybody does to a shared scene is in the recording as the journal says, and in its
 * order: objects as GUEST; steps that this client has submitted, or that its frames went
 * along with, as FRAME; those of others as MOVE.
 */
#ifndef CLI_RECORDER_SHARED_H
#define CLI_RECORDER_SHARED_H

#include "recorder.h"

/* Begin the journal of a scene, and write what is in it; waits. 0, or why not: the
 * recording has ended then. */
int cli_journal_begin(struct pccd_client *client, uint32_t scene);
/* Write all that has been done in the scene until now; waits. Nothing without a
 * journal. */
void cli_journal_settle(struct pccd_client *client, uint32_t scene);
/* Write what has been done in all such scenes until now, and end their journals;
 * waits. */
void cli_journal_stop(struct pccd_client *client);
/* Forget the journal of a scene that is gone. */
void cli_journal_end(struct pccd_client *client, uint32_t scene);

/* Return whether what this client does in a scene is not written when it is done. */
bool cli_journal_has(const struct pccd_client *client, uint32_t scene);
/* Note that something has been done in the scene: there may be more to fetch. */
void cli_journal_note(struct pccd_client *client, uint32_t scene);
/* Ask for what is due, where that can be sent at once. From public functions only: not
 * while a message is being taken in. */
void cli_journal_pump(struct pccd_client *client);
/* Write what the answer to a scene.journal brings. */
void cli_journal_take(struct pccd_client *client, const struct cli_call *call);
/* Note that a step of this client in the scene was answered: the client's number for it,
 * and the scene's; 0: it has failed. */
void cli_journal_answered(struct pccd_client *client, uint32_t scene, uint64_t step,
                          uint64_t number);
/* Return the client's number for step `number` of the scene, its last one there; 0: it is
 * another client's. */
uint64_t cli_journal_step(const struct pccd_client *client, uint32_t scene,
                          uint64_t number);
/* End the recording if it has journals: another daemon has taken the place of the one
 * that kept them. */
void cli_journal_lost(struct pccd_client *client);

#endif
