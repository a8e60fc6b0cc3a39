/* shape.h - a small scene for each client, unlike any other's.
 *
 * Room:     client/load. May include: the C library.
 * Does:     make, from a seed and a client's number, a floor and a sheet that goes
 *           through it in LOAD_FRAMES positions, round and round: step n takes it from
 *           position n to n + 1, and answers to n and n + LOAD_FRAMES are the same.
 * Does not: keep positions: each is computed anew, the same bytes every time.
 * Threads:  [any].
 */
#ifndef LOAD_SHAPE_H
#define LOAD_SHAPE_H

#include <stdint.h>

#define LOAD_FRAMES          8u
#define LOAD_SHEET_SIDE      4u
#define LOAD_SHEET_VERTICES  ((LOAD_SHEET_SIDE + 1) * (LOAD_SHEET_SIDE + 1))
#define LOAD_SHEET_TRIANGLES (2 * LOAD_SHEET_SIDE * LOAD_SHEET_SIDE)
#define LOAD_FLOOR_SIDE      2u
#define LOAD_FLOOR_VERTICES  ((LOAD_FLOOR_SIDE + 1) * (LOAD_FLOOR_SIDE + 1))
#define LOAD_FLOOR_TRIANGLES (2 * LOAD_FLOOR_SIDE * LOAD_FLOOR_SIDE)

/* A number for each index, well mixed; the same everywhere. */
uint64_t load_mix(uint64_t seed, uint64_t index);

void load_floor(float (*x)[3], uint32_t (*triangles)[3]);
void load_sheet(uint32_t (*triangles)[3]);

/* The sheet's vertices at a position, 0 .. LOAD_FRAMES - 1. */
void load_sheet_f32(uint64_t seed, uint32_t client, uint32_t frame, float (*x)[3]);
void load_sheet_f64(uint64_t seed, uint32_t client, uint32_t frame, double (*x)[3]);

/* Or a transform that takes its registered vertices there, rows of [R | t]. */
void load_sheet_pose(uint64_t seed, uint32_t client, uint32_t frame, double m[12]);

#endif
