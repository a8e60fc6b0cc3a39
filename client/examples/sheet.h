/* sheet.h - a square sheet of triangles for the examples, and what they do about errors.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     number the triangles of a grid of side x side vertices, and let it fall as a
 *           cloth that keeps its size; print the error and end the program when a call of
 *           the library has failed.
 * Threads:  one.
 */
#ifndef EXAMPLE_SHEET_H
#define EXAMPLE_SHEET_H

#include <math.h>
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

/* A sheet of side 1 a little above the upper sixth of a ball, a face of a cube that is
 * brought to its radius: 2 side^2 vertices, those of the sheet first, and twice the
 * triangles of a sheet. */
static inline void sheet_and_ball(uint32_t side, double radius, double (*x)[3],
                                  uint32_t (*triangles)[3])
{
    uint32_t count = side * side, faces = 2 * (side - 1) * (side - 1);

    sheet_triangles(side, triangles);
    sheet_triangles(side, triangles + faces);
    for (uint32_t i = 0; i < 3 * faces; i++) {
        triangles[faces + i / 3][i % 3] += count;
    }
    for (uint32_t i = 0; i < count; i++) {
        double u = (i % side) / (side - 1.0), v = (i / side) / (side - 1.0);
        double cube[3] = {2 * u - 1, 2 * v - 1, 1};
        double length = sqrt(cube[0] * cube[0] + cube[1] * cube[1] + 1);
        memcpy(x[i], (double[]){u - 0.47, v - 0.52, radius + 0.02}, sizeof x[i]);
        for (int k = 0; k < 3; k++) {
            x[count + i][k] = radius * cube[k] / length;
        }
    }
}

/* Bring two vertices to where the sheet has its length again. */
static inline void sheet_relax(uint32_t side, double (*end)[3], uint32_t a, uint32_t b)
{
    double d[3] = {end[b][0] - end[a][0], end[b][1] - end[a][1], end[b][2] - end[a][2]};
    double stretch = 1 - 1 / ((side - 1) * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));

    for (int k = 0; k < 3; k++) {
        end[a][k] += 0.5 * stretch * d[k];
        end[b][k] -= 0.5 * stretch * d[k];
    }
}

/* Where a sheet of side 1 goes in a frame, if it meets nothing: to `end`, from x, where
 * it is, and `was` the frame before. */
static inline void sheet_predict(uint32_t side, double (*x)[3], double (*was)[3],
                                 double (*end)[3], double fall)
{
    for (uint32_t i = 0; i < 3 * side * side; i++) {
        uint32_t v = i / 3, k = i % 3;
        end[v][k] = x[v][k] + 0.98 * (x[v][k] - was[v][k]) - (k == 2 ? fall : 0);
    }
    for (uint32_t i = 0; i < 10 * side * side; i++) {
        uint32_t v = i % (side * side);
        sheet_relax(side, end, v, v % side + 1 < side ? v + 1 : v - 1);
        sheet_relax(side, end, v, v + side < side * side ? v + side : v - side);
    }
}

#endif
