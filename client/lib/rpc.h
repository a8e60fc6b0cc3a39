/* rpc.h - requests and their replies.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     send a request, match replies to calls by id in any order, wait with a
 *           deadline.
 * Threads:  [owner].
 */
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

/* Handle one message if one is there: 0, PCCD_E_AGAIN (also when the connection has just
 * been lost and can be made again: link.is_down then) or PCCD_E_DISCONNECTED. */
int cli_receive(struct pccd_client *client);

/* The same, but waits for CLI_AWAIT_NS where no message is there. Not in the process
 * (CLI_WAY_DIRECT). */
int cli_await(struct pccd_client *client);

/* Wait for a message and handle it, or for another connection where it is lost: 0,
 * PCCD_E_TIMEOUT or PCCD_E_DISCONNECTED. */
int cli_progress(struct pccd_client *client, uint64_t deadline_ns);

/* Of the held calls the one that was sent first; NULL: none is held. */
struct cli_call *cli_call_first_held(struct pccd_client *client);

/* Send every held call once more, unchanged, in their order. */
int cli_call_resend_all(struct pccd_client *client, uint64_t deadline_ns);

/* What pccd_want has asked for, once. */
uint32_t cli_take_want(struct pccd_client *client);

/* Requests whose replies have not come. */
uint32_t cli_call_inflight(const struct pccd_client *client);

/* The connection is lost. Calls without an answer are held for another one, or fail where
 * there is to be none. Returns PCCD_E_DISCONNECTED. */
int cli_lose(struct pccd_client *client, const char *why);
/* Have the socket end, so that who watches it sees that there is something to do,
 * whatever the daemon does with its own end. Not by a forked copy, which shares it. */
void cli_hang_up(struct pccd_client *client);
/* For good: client->dead_text says why. Returns PCCD_E_DISCONNECTED. */
int cli_die(struct pccd_client *client);

/* Close descriptors that came with an answer and were not taken. */
void cli_fds_close(struct pccd_client *client);

/* PCCD_E_DISCONNECTED with its text when the connection is lost for good, or another
 * process's, else 0. */
int cli_alive(struct pccd_client *client);

/* How often this process is a copy of a copy, from the first call on. [any] */
uint32_t cli_forks(void);
/* Whether it was forked since the client connected: the socket and the ring are those of
 * the process that did, and must not be touched. Costs no system call. */
bool cli_is_copy(const struct pccd_client *client);

/* Close the socket and forget every call, so that another can be opened. */
void cli_rpc_close(struct pccd_client *client);

#endif
