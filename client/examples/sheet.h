/* sheet.h - a square sheet of triangles for the examples, and what they do about errors.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     number the triangles of a grid of side x side vertices; print the error and
 *           end the program when a call of the library has failed.
 * Threads:  one.
 */
#ifndef EXAMPLE_SHEET_H
#define EXAMPLE_SHEET_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pccd.h"

static inline void ok(const struct pccd_client *client, int status)
{
    if (status != 0) {
        fprintf(stderr, "wrong: %s\n", pccd_error_text(client));
        exit(1);
    }
}

/* 2 (side - 1)^2 triangles; vertex (i, j) is i + j side. */
static inline void sheet_triangles(uint32_t side, uint32_t (*triangles)[3])
{
    for (uint32_t i = 0; i < (side - 1) * (side - 1); i++) {
        uint32_t v = i / (side - 1) * side + i % (side - 1);

        memcpy(triangles[2 * i], (uint32_t[]){v, v + 1, v + side}, 12);
        memcpy(triangles[2 * i + 1], (uint32_t[]){v + 1, v + side + 1, v + side}, 12);
    }
}

#endif
