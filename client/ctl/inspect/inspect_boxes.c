/* inspect_boxes.c - the hierarchies of a step as sections of data. */
#include <stdlib.h>

#include "inspect.h"

#define LEVELS_MAX 32u

static const char *const names[PCCD_TREE_COUNT] = {"vertices", "edges", "faces",
                                                   "triangles"};

_Static_assert(sizeof(struct pccd_box) == 48, "data.js reads 48 bytes");

static float moved(const struct inspect *inspect, float x, uint32_t k)
{
    return (float)(((double)x - inspect->origin[k]) / inspect->unit);
}

/* Those that are not empty, relative to the origin. */
static json_t *pack_level(struct inspect *inspect, uint32_t count)
{
    size_t offset = 0;
    struct pccd_box *to = bytes_section(&inspect->data, count * sizeof *to, &offset);
    uint32_t packed = 0;
    for (uint32_t i = 0; to != NULL && i < count; i++) {
        const struct pccd_box *from = &inspect->boxes[i];
        if (!(from->low0[0] <= from->high0[0])) {
            continue;
        }
        for (uint32_t k = 0; k < 3; k++) {
            to[packed].low0[k] = moved(inspect, from->low0[k], k);
            to[packed].high0[k] = moved(inspect, from->high0[k], k);
            to[packed].low1[k] = moved(inspect, from->low1[k], k);
            to[packed].high1[k] = moved(inspect, from->high1[k], k);
        }
        packed++;
    }
    return to == NULL ? NULL
                      : json_pack("{s:o, s:I}", "at", inspect_section(inspect, offset),
                                  "count", (json_int_t)packed);
}

/* The levels of a tree, as many as the daemon tells of. */
static json_t *pack_tree(struct inspect *inspect, const struct play_step *step,
                         enum pccd_tree tree)
{
    json_t *levels = json_array();
    for (uint32_t level = 0; level < LEVELS_MAX && levels != NULL; level++) {
        uint32_t count = 0;
        int status =
            pccd_scene_boxes(step->client, step->scene->handle, tree, level,
                             inspect->boxes, inspect->settings.boxes_max, &count);
        if (status != PCCD_OK || count == 0 || count > inspect->settings.boxes_max) {
            break; /* an older daemon does not know them: the page does without */
        }
        if (json_array_append_new(levels, pack_level(inspect, count)) != 0) {
            json_decref(levels);
            return NULL;
        }
    }
    return levels;
}

json_t *inspect_pack_boxes(struct inspect *inspect, const struct play_step *step)
{
    bool is_paper = step->answer->method == PCCD_METHOD_PAPER;
    uint32_t max = inspect->settings.boxes_max;
    json_t *trees = json_object();
    if (inspect->boxes == NULL && max > 0) {
        inspect->boxes = calloc(max, sizeof *inspect->boxes);
    }
    if (trees == NULL || (inspect->boxes == NULL && max > 0)) {
        json_decref(trees);
        return NULL;
    }
    for (uint32_t tree = 0; tree < PCCD_TREE_COUNT && step->client != NULL && max > 0;
         tree++) {
        if (is_paper == (tree == PCCD_TREE_TRIANGLES) &&
            json_object_set_new(trees, names[tree],
                                pack_tree(inspect, step, (enum pccd_tree)tree)) != 0) {
            json_decref(trees);
            return NULL;
        }
    }
    return trees;
}
