/* shape.c - a small scene for each client, unlike any other's.
 *
 * Room:     client/load.
 * Does:     see shape.h.
 * Threads:  [any].
 */
#include "shape.h"

uint64_t load_mix(uint64_t seed, uint64_t index)
{
    uint64_t z = seed + (index + 1) * 0x9e3779b97f4a7c15ull; /* splitmix64 */
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ z >> 27) * 0x94d049bb133111ebull;
    return z ^ z >> 31;
}

/* Between -1 and 1. */
static double noise(uint64_t seed, uint32_t client, uint32_t frame, uint32_t index)
{
    uint64_t bits = load_mix(load_mix(seed, client), (uint64_t)frame << 32 | index);
    return (double)(bits >> 11) * 0x1p-52 - 1;
}

static void grid(uint32_t side, uint32_t (*triangles)[3])
{
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t corner = i / side * (side + 1) + i % side;
        triangles[2 * i][0] = corner;
        triangles[2 * i][1] = corner + 1;
        triangles[2 * i][2] = corner + side + 1;
        triangles[2 * i + 1][0] = corner + 1;
        triangles[2 * i + 1][1] = corner + side + 2;
        triangles[2 * i + 1][2] = corner + side + 1;
    }
}

void load_floor(float (*x)[3], uint32_t (*triangles)[3])
{
    for (uint32_t i = 0; i < LOAD_FLOOR_VERTICES; i++) {
        x[i][0] = 3.0f * (float)(i % (LOAD_FLOOR_SIDE + 1)) - 1.0f;
        x[i][1] = 3.0f * (float)(i / (LOAD_FLOOR_SIDE + 1)) - 1.0f;
        x[i][2] = 0.0f;
    }
    grid(LOAD_FLOOR_SIDE, triangles);
}

void load_sheet(uint32_t (*triangles)[3])
{
    grid(LOAD_SHEET_SIDE, triangles);
}

/* Above the floor and below it by turns, crumpled so that some of it touches always. */
void load_sheet_f64(uint64_t seed, uint32_t client, uint32_t frame, double (*x)[3])
{
    for (uint32_t i = 0; i < LOAD_SHEET_VERTICES; i++) {
        x[i][0] = i % (LOAD_SHEET_SIDE + 1) + 0.3 * noise(seed, client, frame, 3 * i);
        x[i][1] = i / (LOAD_SHEET_SIDE + 1) + 0.3 * noise(seed, client, frame, 3 * i + 1);
        x[i][2] = (frame % 2 ? -0.4 : 0.4) + 0.6 * noise(seed, client, frame, 3 * i + 2);
    }
}

void load_sheet_f32(uint64_t seed, uint32_t client, uint32_t frame, float (*x)[3])
{
    double exact[LOAD_SHEET_VERTICES][3];
    load_sheet_f64(seed, client, frame, exact);
    for (uint32_t i = 0; i < 3 * LOAD_SHEET_VERTICES; i++) {
        x[i / 3][i % 3] = (float)exact[i / 3][i % 3];
    }
}

void load_sheet_pose(uint64_t seed, uint32_t client, uint32_t frame, double m[12])
{
    for (uint32_t i = 0; i < 12; i++) {
        m[i] = (i % 5 == 0 ? 1.0 : 0.0) + 0.2 * noise(seed, client, frame, i);
    }
    m[11] = (frame % 2 ? -0.4 : 0.4) + 0.3 * noise(seed, client, frame, 12);
}
