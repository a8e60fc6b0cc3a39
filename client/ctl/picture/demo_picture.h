/* demo_picture.h - draws the last step of the demo.
 *
 * Threads: one.
 */
#ifndef CTL_DEMO_PICTURE_H
#define CTL_DEMO_PICTURE_H

#include <stdint.h>
#include <stdio.h>

#include "cloth_scene.h"
#include "error.h"
#include "pccd.h"

/* What a record's handles and feature numbers mean. */
struct demo_object {
    uint32_t object;
    uint32_t vertex_count, triangle_count;
    const float (*x)[3]; /* at the end of the step */
    const uint32_t (*triangles)[3];
    const struct pccd_edge *edges;
};

/* What was met in a frame. */
struct demo_met {
    const struct pccd_contact *contacts;
    uint64_t count, vf, ee;
    uint64_t frame; /* from 1; 0: nothing was met in any */
};

/* Cloth first, then ball. Writes to `file`, whose name is `path`. Errors: E_NOMEM,
 * E_SYSTEM. */
int demo_picture_write(const struct demo_object objects[2], const struct demo_met *met,
                       FILE *file, const char *path, struct ctl_error *error);

#endif
