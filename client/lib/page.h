/* page.h - the pages of records that the user has not released yet. */
#ifndef CLI_PAGE_H
#define CLI_PAGE_H

#include "client.h"

/* Enter a page of `count` records of record_bytes at `offset` of the result region, given
 * back by storing `release`. *serial = 0 when count is 0. Returns 0 or PCCD_E_BADMSG: the
 * page does not lie inside the mapping, then it is not entered. */
int cli_page_add(struct pccd_client *client, uint64_t offset, uint64_t count,
                 uint32_t record_bytes, uint64_t release, uint64_t *serial);

/* Release the page of that serial; one that is released already, or never was, is
 * ignored. */
void cli_page_release(struct pccd_client *client, uint64_t serial);

/* Before something is asked for that brings a page: 0 or PCCD_E_BUSY, when so many are
 * not released that those in flight might find no entry. */
int cli_page_check(struct pccd_client *client);
bool cli_page_has_room(const struct pccd_client *client);

/* Pages that are not released, and those behind them that are. */
uint32_t cli_page_count(const struct pccd_client *client);

/* The first byte of the region in which a page that is not released lies. */
const uint8_t *cli_page_base(const struct pccd_client *client, uint64_t serial);

/* The answers to the scenes of a batch, which has succeeded: [count]. */
const struct pccd_scene_answer *cli_batch_answers(const struct pccd_client *client,
                                                  const struct cli_call *call);

/* The ring is about to go: keep `result` mapped as long as pages of it are not released,
 * or unmap it. Takes it over. */
void cli_page_retire(struct pccd_client *client, struct proto_memory *result);
void cli_page_deinit(struct pccd_client *client);

#endif
