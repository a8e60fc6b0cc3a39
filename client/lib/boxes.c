/* boxes.c - what a scene's hierarchies look like.
 *
 * Room:     client/lib. May include: attach.h, page.h, rpc.h.
 * Does:     fetch the boxes of a level, page by page.
 * Does not: interpret them.
 * Threads:  [owner].
 */
#include <string.h>

#include "attach.h"
#include "client.h"
#include "page.h"
#include "rpc.h"

/* One page, from request->first on. */
static int fetch(struct pccd_client *client, struct proto_SCENE_BOXES_request *request,
                 struct pccd_box *boxes, struct proto_SCENE_BOXES_result *result)
{
    uint64_t page;
    int rc = cli_call_page(client, PROTO_METHOD_SCENE_BOXES, request, result,
                           cli_deadline(client, -1), &page);
    if (rc == 0 &&
        (result->count > request->count ||
         (result->count == 0 && request->count > 0 && request->first < result->boxes))) {
        rc = cli_fail(client, PCCD_E_BUSY,
                      "scene.boxes: no room in the result region: release answers first");
    }
    if (rc == 0 && result->count > 0) {
        memcpy(boxes, cli_page_base(client, page) + result->offset,
               result->count * sizeof(*boxes));
    }
    cli_page_release(client, page);
    return rc;
}

int pccd_scene_boxes(struct pccd_client *client, uint32_t scene, enum pccd_tree tree,
                     uint32_t level, struct pccd_box *boxes, uint32_t room,
                     uint32_t *count)
{
    struct proto_SCENE_BOXES_request request = {
        .scene = scene, .tree = (uint32_t)tree, .level = level, .count = room};
    struct proto_SCENE_BOXES_result result = {.boxes = 0};
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (count == NULL || (boxes == NULL && room > 0)) {
        return cli_fail(client, PCCD_E_INVAL, "scene.boxes: boxes or count is NULL");
    }
    rc = cli_alive(client);
    if (rc == 0 && client->ring.upload.base == NULL) {
        rc = cli_ring_reserve(client, PROTO_SLOT_BYTES_MIN, cli_deadline(client, -1));
    }
    while (rc == 0) { /* every page but the last has a box at least */
        rc = fetch(client, &request, boxes, &result);
        request.first += rc == 0 ? result.count : 0;
        request.count = room - request.first;
        boxes = result.count > 0 ? boxes + result.count : boxes;
        if (request.count == 0 || request.first >= result.boxes) {
            break;
        }
    }
    if (rc == 0) {
        *count = result.boxes;
    }
    return rc;
}
