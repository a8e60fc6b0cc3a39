/* page.c - pages of records in the result region.
 *
 * A ring of unreleased pages. The daemon writes pages one after the other and its replies
 * keep their order, so the region is free up to the first page that is still held;
 * result_head says how far.
 */
#include <assert.h>
#include <stdlib.h>

#include "rpc.h"

/* An earlier result region, in which the user still reads. */
struct cli_retired {
    struct cli_retired *next;
    struct proto_memory result;
    uint64_t page_end; /* goes when all pages before this serial are released */
};

const uint8_t *cli_page_base(const struct pccd_client *client, uint64_t serial)
{
    /* A page that is released may be another one's entry already. */
    assert(serial >= client->page_first && serial < client->page_end);
    return client->pages[serial % CLI_PAGES].base;
}

const struct pccd_scene_answer *cli_batch_answers(const struct pccd_client *client,
                                                  const struct cli_call *call)
{
    assert(call->method == PROTO_METHOD_BATCH_SUBMIT && call->page != 0);
    return (const void *)(cli_page_base(client, call->page) + call->batch.offset);
}

/* Unmap the retired regions whose last page has been released. */
static void drop_retired(struct pccd_client *client)
{
    while (client->retired != NULL && client->page_first >= client->retired->page_end) {
        struct cli_retired *gone = client->retired;

        client->retired = gone->next;
        proto_memory_deinit(&gone->result);
        free(gone);
    }
}

void cli_page_retire(struct pccd_client *client, struct proto_memory *result)
{
    struct cli_retired **last = &client->retired;
    struct cli_retired *made =
        cli_page_count(client) > 0 && result->base != NULL ? malloc(sizeof *made) : NULL;

    if (cli_page_count(client) == 0 || result->base == NULL) {
        proto_memory_deinit(result);
        return;
    }
    if (made == NULL) { /* rather a leak than a page that is gone under its reader */
        *result = (struct proto_memory)PROTO_MEMORY_NONE;
        return;
    }
    *made = (struct cli_retired){.result = *result, .page_end = client->page_end};
    *result = (struct proto_memory)PROTO_MEMORY_NONE;
    while (*last != NULL) {
        last = &(*last)->next;
    }
    *last = made;
}

void cli_page_deinit(struct pccd_client *client)
{
    client->page_first = client->page_end;
    drop_retired(client);
}

uint32_t cli_page_count(const struct pccd_client *client)
{
    assert(client->page_first <= client->page_end);
    assert(client->page_end - client->page_first <= CLI_PAGES);
    return (uint32_t)(client->page_end - client->page_first);
}

bool cli_pages_have_room(const struct pccd_client *client)
{
    /* Every call in flight may bring a page, and there must be an entry for it. */
    return cli_page_count(client) + CLI_CALLS <= CLI_PAGES;
}

int cli_page_check(struct pccd_client *client)
{
    return cli_pages_have_room(client)
               ? 0
               : cli_fail(client, PCCD_E_BUSY,
                          "%u answers are not released, or wait for an older one that is "
                          "not: the oldest is the answer to step %llu, release it first",
                          cli_page_count(client),
                          (unsigned long long)client
                              ->pages[client->page_first % CLI_PAGES]
                              .step);
}

int cli_page_add(struct pccd_client *client, const struct proto_page *page,
                 uint64_t step, uint64_t *serial)
{
    const struct proto_memory *region = &client->ring.result;

    *serial = 0;
    if (page->count == 0) {
        return 0;
    }
    if (region->base == NULL || page->record_bytes == 0 || page->offset % 8 != 0 ||
        page->offset < PROTO_SHM_PAGE || page->offset > region->bytes ||
        page->count > (region->bytes - page->offset) / page->record_bytes ||
        cli_page_count(client) == CLI_PAGES) {
        return PCCD_E_BADMSG;
    }
    client->pages[client->page_end % CLI_PAGES] =
        (struct cli_page){page->release, region->base, step, false};
    *serial = client->page_end++;
    proto_memory_touch(&client->ring.result,
                       page->offset + page->count * page->record_bytes);
    return 0;
}

void cli_page_release(struct pccd_client *client, uint64_t serial)
{
    struct proto_upload *upload = client->ring.upload.base;
    uint64_t head = 0;
    bool moved = false;

    if (serial < client->page_first || serial >= client->page_end) {
        return;
    }
    client->pages[serial % CLI_PAGES].released = true;
    while (client->page_first < client->page_end &&
           client->pages[client->page_first % CLI_PAGES].released) {
        if (client->page_first >= client->ring.page_first) { /* else another region's */
            head = client->pages[client->page_first % CLI_PAGES].release;
            moved = true;
        }
        client->page_first++;
    }
    drop_retired(client);
    /* Pairs with the daemon's load before it writes the next page: every read of the page
     * by this thread comes before the store. */
    if (moved && upload != NULL && !cli_is_copy(client)) {
        atomic_store(&upload->result_head.value, head);
    }
}
