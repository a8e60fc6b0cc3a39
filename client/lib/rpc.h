/* rpc.h - sends requests and waits for their replies. */
#ifndef CLI_RPC_H
#define CLI_RPC_H

#include "client.h"

/* Send a request and take an entry of the table for its reply. `slot` (or CLI_SLOT_NONE)
 * comes back with the reply. Waits for room in the socket and below the daemon's limit of
 * requests in flight. Returns 0 with *call in state SENT, PCCD_E_BUSY (the table is
 * full), PCCD_E_TIMEOUT, PCCD_E_DISCONNECTED; nothing was sent then. */
int cli_call_send(struct pccd_client *client, int method, const void *request,
                  uint32_t slot, uint64_t deadline_ns, struct cli_call **call);

/* Wait until `call` is DONE: 0, PCCD_E_TIMEOUT or PCCD_E_DISCONNECTED. */
int cli_call_wait(struct pccd_client *client, struct cli_call *call,
                  uint64_t deadline_ns);

/* Take a DONE call's status, with its text as the client's error, and free the entry. */
int cli_call_finish(struct pccd_client *client, struct cli_call *call);

/* Give up on a call in any state: a reply that is still to come will be dropped, and the
 * page it brings released. */
void cli_call_drop(struct pccd_client *client, struct cli_call *call);

/* Send, wait and finish in one, if there is room for another page (cli_page_check); *page
 * is the serial of the page that the answer brought, to be released also on failure, or
 * 0. */
int cli_call_page(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns, uint64_t *page);

/* Send, wait and finish in one, for a method without a page; `result` may be NULL. */
int cli_call_sync(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns);

/* Wait for a message and handle it, or for another connection where it is lost: 0,
 * PCCD_E_TIMEOUT or PCCD_E_DISCONNECTED. */
int cli_progress(struct pccd_client *client, uint64_t deadline_ns);

/* Return the held call that was sent first; NULL: none is held. */
struct cli_call *cli_call_first_held(struct pccd_client *client);

/* Send every held call once more, unchanged, in their order. */
int cli_call_resend_all(struct pccd_client *client, uint64_t deadline_ns);

/* Return whether a method is one of those that move a scene, of which a daemon takes only
 * so many of a client at a time. */
bool cli_call_is_step(int method);

/* Return how many requests wait for their replies. */
uint32_t cli_call_inflight(const struct pccd_client *client);

/* ---- messages that come ------------------------------------------------------------ */

/* Handle one message if one is there: 0, PCCD_E_AGAIN (also when the connection has just
 * been lost and can be made again: link.is_down then) or PCCD_E_DISCONNECTED. */
int cli_receive(struct pccd_client *client);

/* Handle one message, as cli_receive does, but wait for CLI_AWAIT_NS where none is there.
 * Not in the process (CLI_WAY_DIRECT). */
int cli_await(struct pccd_client *client);

/* ---- pages of records -------------------------------------------------------------- */

/* Enter a page of the answer to `step`, 0: of another one. *serial = 0 when it has no
 * records. Returns 0 or PCCD_E_BADMSG: it does not lie inside the mapping, and is not
 * entered. */
int cli_page_add(struct pccd_client *client, const struct proto_page *page,
                 uint64_t step, uint64_t *serial);

/* Release the page of that serial; one that is released already, or never was, is
 * ignored. */
void cli_page_release(struct pccd_client *client, uint64_t serial);

/* Check whether there is an entry for another page, before one is asked for: 0 or
 * PCCD_E_BUSY, when so many are not released that those in flight might find none. */
int cli_page_check(struct pccd_client *client);
bool cli_pages_have_room(const struct pccd_client *client);

/* Return how many pages are not released, with those behind them that are. */
uint32_t cli_page_count(const struct pccd_client *client);

/* Return the first byte of the region in which a page that is not released lies. */
const uint8_t *cli_page_base(const struct pccd_client *client, uint64_t serial);

/* Return the answers to the scenes of a batch, which has succeeded: [count]. */
const struct pccd_scene_answer *cli_batch_answers(const struct pccd_client *client,
                                                  const struct cli_call *call);

/* Keep `result`, of a ring that is about to go, mapped as long as pages of it are not
 * released, or unmap it. Takes it over. */
void cli_page_retire(struct pccd_client *client, struct proto_memory *result);
void cli_page_deinit(struct pccd_client *client);

/* ---- several requests at once ------------------------------------------------------ */

#define CLI_PIPELINE_MAX 16u /* as many as wait at the daemon before it reads no more */
/* Computed calls among these: four thousand clients that come back at once find room in
 * the daemon's queue, which takes 32768 unless it is told otherwise. */
#define CLI_PIPELINE_COMPUTED 8u

struct cli_pipeline {
    struct pccd_client *client;
    bool is_careful; /* the last try has failed, perhaps for want of room: one by one */
    uint32_t computed;
    struct cli_call *calls[CLI_PIPELINE_MAX];
    uint32_t first; /* free-running: the oldest that is not finished */
    uint32_t end;
};

/* Send one more, with `slot` or CLI_SLOT_NONE; when there are too many the oldest are
 * finished first. Its answer goes to `result`, which may be NULL and stays the caller's
 * until the pipeline has ended. Not sent on failure: the slot is the caller's still. */
int cli_pipeline_send(struct cli_pipeline *pipeline, int method, const void *request,
                      uint32_t slot, void *result);

/* End the pipeline that has come to `status`: wait for all answers, or drop them once
 * something has failed. Returns what failed first, or 0. Each wait has a deadline of its
 * own: much may take long, a silent daemon may not. */
int cli_pipeline_end(struct cli_pipeline *pipeline, int status);

#endif
