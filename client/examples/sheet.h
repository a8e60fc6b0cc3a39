/* sheet.h - what examples have in common: sheets and balls of triangles, the points of
 * a contact, and what to do about errors.
 *
 * Room:     client/examples. May include: pccd.h.
 * Does:     number the triangles of a grid of side x side vertices, and let it fall as a
 *           cloth that keeps its size; make balls and boxes; say where a contact's points
 *           are; print the error and end the program when a call has failed.
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

/* Make 2 (side - 1)^2 triangles; vertex (i, j) is i + j side. */
static inline void sheet_triangles(uint32_t side, uint32_t (*triangles)[3])
{
    for (uint32_t i = 0; i < (side - 1) * (side - 1); i++) {
        uint32_t v = i / (side - 1) * side + i % (side - 1);

        memcpy(triangles[2 * i], (uint32_t[]){v, v + 1, v + side}, 12);
        memcpy(triangles[2 * i + 1], (uint32_t[]){v + 1, v + side + 1, v + side}, 12);
    }
}

/* Make a flat sheet of side 1 whose first corner is at (x, y, z). */
static inline void sheet_flat(uint32_t side, double x, double y, double z,
                              double (*at)[3])
{
    for (uint32_t i = 0; i < side * side; i++) {
        at[i][0] = (i % side) / (side - 1.0) + x;
        at[i][1] = (i / side) / (side - 1.0) + y;
        at[i][2] = z;
    }
}

/* Make a sheet of side 1 a little above the upper sixth of a ball, a face of a cube
 * that is brought to its radius: 2 side^2 vertices, those of the sheet first, and twice
 * the triangles of a sheet. */
static inline void sheet_and_ball(uint32_t side, double radius, double (*x)[3],
                                  uint32_t (*triangles)[3])
{
    uint32_t count = side * side, faces = 2 * (side - 1) * (side - 1);

    sheet_triangles(side, triangles);
    sheet_triangles(side, triangles + faces);
    for (uint32_t i = 0; i < 3 * faces; i++) {
        triangles[faces + i / 3][i % 3] += count;
    }
    sheet_flat(side, -0.47, -0.52, radius + 0.02, x);
    for (uint32_t i = 0; i < count; i++) {
        double u = (i % side) / (side - 1.0), v = (i / side) / (side - 1.0);
        double cube[3] = {2 * u - 1, 2 * v - 1, 1};
        double length = sqrt(cube[0] * cube[0] + cube[1] * cube[1] + 1);
        for (int k = 0; k < 3; k++) {
            x[count + i][k] = radius * cube[k] / length;
        }
    }
}

/* Make a ball as a globe: rings x round + 2 vertices, the poles first and last, and
 * 2 rings x round triangles. */
static inline void ball_make(uint32_t rings, uint32_t round, double radius,
                             const double centre[3], double (*x)[3],
                             uint32_t (*triangles)[3])
{
    const double pi = 3.14159265358979;
    uint32_t last = rings * round + 1;

    for (uint32_t v = 0; v <= last; v++) {
        double up = pi * ((v + round - 1) / round) / (rings + 1);
        double around = 2 * pi * ((v + round - 1) % round) / round;
        x[v][0] = centre[0] + radius * sin(up) * cos(around);
        x[v][1] = centre[1] + radius * sin(up) * sin(around);
        x[v][2] = centre[2] - radius * cos(up);
    }
    for (uint32_t v = 1; v < last; v++) { /* below the edge to the next, and above it */
        uint32_t next = v % round == 0 ? v + 1 - round : v + 1;
        uint32_t below = v <= round ? 0 : next - round;
        uint32_t above = v + round < last ? v + round : last;
        memcpy(triangles[2 * v - 2], (uint32_t[]){v, below, next}, 12);
        memcpy(triangles[2 * v - 1], (uint32_t[]){v, next, above}, 12);
    }
}

/* Make a box around the origin, as far as `half` in each direction. */
static inline void box_make(const double half[3], double (*x)[3],
                            uint32_t (*triangles)[3])
{
    static const uint32_t faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                          {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                          {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    memcpy(triangles, faces, sizeof faces);
    for (int i = 0; i < 24; i++) {
        x[i / 3][i % 3] = i / 3 >> i % 3 & 1 ? half[i % 3] : -half[i % 3];
    }
}

static inline void cross(const double a[3], const double b[3], double to[3])
{
    for (int k = 0; k < 3; k++) {
        to[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

/* Return the points of a contact as sums: that of side a less that of side b is the sum
 * of w[i] x[v[i]]. Returns how many of the four vertices are of side a. */
static inline int contact_corners(const struct pccd_contact *c,
                                  const struct pccd_edge *edges_a,
                                  const struct pccd_edge *edges_b,
                                  uint32_t (*triangles_b)[3], uint32_t v[4], double w[4])
{
    double p = (double)c->param[0], q = (double)c->param[1];

    if (c->kind == PCCD_VF) {
        const uint32_t *b = triangles_b[c->feature_b];
        memcpy(v, (uint32_t[]){c->feature_a, b[0], b[1], b[2]}, 4 * sizeof v[0]);
        memcpy(w, (double[]){1, p + q - 1, -p, -q}, 4 * sizeof w[0]);
        return 1;
    }
    const struct pccd_edge *a = &edges_a[c->feature_a], *b = &edges_b[c->feature_b];
    memcpy(v, (uint32_t[]){a->a, a->b, b->a, b->b}, 4 * sizeof v[0]);
    memcpy(w, (double[]){1 - p, p, q - 1, -q}, 4 * sizeof w[0]);
    return 2;
}

/* End the program if anything is nearer than the thicknesses say, or crosses. */
static inline void nothing_is_near(struct pccd_client *client, uint32_t scene)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    for (int k = 0; k < 2; k++) {
        settings.what = k == 0 ? PCCD_NEAR_PAIRS : PCCD_NEAR_CROSSINGS;
        ok(client, pccd_ask_near(client, scene, NULL, 0, &settings, &answer));
        ok(client, answer.incomplete != 0 || answer.total > 0);
        pccd_answer_release(client, &answer);
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

/* Predict where a sheet of side 1 goes in a frame, if it meets nothing: to `end`, from x,
 * where it is, and `was` the frame before. */
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
