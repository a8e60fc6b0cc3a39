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

/* The same for a method without a page; `result` may be NULL. */
int cli_call_sync(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns);

/* Wait for a message and handle it, or for another connection where it is lost: 0,
 * PCCD_E_TIMEOUT or PCCD_E_DISCONNECTED. */
int cli_progress(struct pccd_client *client, uint64_t deadline_ns);

/* Of the held calls the one that was sent first; NULL: none is held. */
struct cli_call *cli_call_first_held(struct pccd_client *client);

/* Send every held call once more, unchanged, in their order. */
int cli_call_resend_all(struct pccd_client *client, uint64_t deadline_ns);

/* Whether a method is one of those that move a scene, of which a daemon takes only so
 * many of a client at a time. */
bool cli_call_is_step(int method);

/* Requests whose replies have not come. */
uint32_t cli_call_inflight(const struct pccd_client *client);

#endif
