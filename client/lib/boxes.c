/* boxes.c - what a scene's hierarchies look like. */
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
    int status = cli_call_page(client, PROTO_METHOD_SCENE_BOXES, request, result,
                               cli_deadline(client, -1), &page);
    if (status == 0 &&
        (result->count > request->count ||
         (result->count == 0 && request->count > 0 && request->first < result->boxes))) {
        status =
            cli_fail(client, PCCD_E_BUSY,
                     "scene.boxes: no room in the result region: release answers first");
    }
    if (status == 0 && result->count > 0) {
        memcpy(boxes, cli_page_base(client, page) + result->offset,
               result->count * sizeof *boxes);
    }
    cli_page_release(client, page);
    return status;
}

int pccd_scene_boxes(struct pccd_client *client, uint32_t scene, enum pccd_tree tree,
                     uint32_t level, struct pccd_box *boxes, uint32_t room,
                     uint32_t *count)
{
    struct proto_SCENE_BOXES_request request = {
        .scene = scene, .tree = (uint32_t)tree, .level = level, .count = room};
    struct proto_SCENE_BOXES_result result = {.boxes = 0};
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (count == NULL || (boxes == NULL && room > 0)) {
        return cli_fail(client, PCCD_E_INVAL, "scene.boxes: boxes or count is NULL");
    }
    status = cli_ring_ensure(client);
    while (status == 0) { /* every page but the last has a box at least */
        status = fetch(client, &request, boxes, &result);
        request.first += status == 0 ? result.count : 0;
        request.count = room - request.first;
        boxes = result.count > 0 ? boxes + result.count : boxes;
        if (request.count == 0 || request.first >= result.boxes) {
            break;
        }
    }
    if (status == 0) {
        *count = result.boxes;
    }
    return status;
}
