/* must.h - what a client does that must work: what does not fails the case. */
#ifndef TEST_MUST_H
#define TEST_MUST_H

#include <stdint.h>

#include "cases.h"
#include "pccd.h"

/* Connect; what is 0 in the options is as pccd_connect has it. */
struct pccd_client *test_client(const struct pccd_options *options);
struct pccd_client *test_client_at(const char *url); /* as test_connect */

/* Return what pccd_link says. */
struct pccd_link_info test_link(const struct pccd_client *client);

/* Make a scene without settings, a mesh of triangles, uint32_t[][3], and an object of a
 * mesh. Return the handle. */
uint32_t test_scene(struct pccd_client *client);
uint32_t test_mesh(struct pccd_client *client, const void *x, enum pccd_format format,
                   uint32_t vertex_count, const void *triangles, uint32_t triangle_count);
uint32_t test_object(struct pccd_client *client, uint32_t scene, uint32_t mesh);

/* Connect, and make a grid in a session of its own; and end both. */
struct test_grid;
void test_grid_open(struct test_grid *grid, const char *url, uint32_t side);
void test_grid_close(struct test_grid *grid);
/* Wait for a turn of the grid, or take one: its answer is right. */
void test_grid_expect(struct test_grid *grid, uint64_t step);
void test_grid_pass(struct test_grid *grid);

/* Step with nothing moved. */
void test_still(struct pccd_client *client, uint32_t scene,
                const struct pccd_step_settings *settings, struct pccd_answer *answer);

#endif
