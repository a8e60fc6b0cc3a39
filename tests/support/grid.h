/* grid.h - a scene of any size with a known answer.
 *
 * Move a wavy square grid of side x side vertices back and forth through a large floor:
 * in every turn each of its vertices meets the floor's face once, and nothing else
 * happens.
 */
#ifndef TEST_GRID_H
#define TEST_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd.h"

struct test_grid {
    struct pccd_client *client;
    uint32_t side;
    uint32_t vertex_count;
    uint32_t scene;
    uint32_t mesh;
    uint32_t floor;
    uint32_t object;
    float z;       /* height of its middle: 1 or -1 */
    float (*x)[3]; /* scratch: positions */
};

/* Build the scene; grid->x is allocated. Returns a status. */
int test_grid_make(struct pccd_client *client, uint32_t side, struct test_grid *grid);
void test_grid_free(struct test_grid *grid);

/* The grid's 2 (side - 1)^2 triangles; the caller frees them. NULL: no memory. */
uint32_t (*test_grid_triangles(const struct test_grid *grid))[3];

/* Replace the mesh by the same one, at the same place as in the beginning. Returns a
 * status. */
int test_grid_replace(struct test_grid *grid);

/* Positions at height z, in grid->x. */
void test_grid_positions(struct test_grid *grid, float z);

/* Submit one turn. Returns a status. */
int test_grid_submit(struct test_grid *grid, const struct pccd_step_settings *settings,
                     uint64_t *step);

/* The same, and wait for its answer. */
int test_grid_turn(struct test_grid *grid, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer);

/* Wait for a turn's answer, whatever it is. Returns a status. */
int test_grid_await(struct test_grid *grid, uint64_t step);

/* Return whether an answer holds every contact of a turn, with the right times. Only for
 * whole answers (one page). */
bool test_grid_is_right(const struct test_grid *grid, const struct pccd_answer *answer);

#endif
