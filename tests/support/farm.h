/* farm.h - many small scenes, as a batch has them.
 *
 * Put a wavy grid above a floor into each of many scenes, all of one pair of meshes, and
 * move the grid through the floor and back, in each scene in another way.
 */
#ifndef TEST_FARM_H
#define TEST_FARM_H

#include <stdint.h>

#include "pccd.h"

struct test_world {
    uint32_t scene;
    uint32_t floor;
    uint32_t body;
};

struct test_farm {
    struct pccd_client *client;
    uint32_t side; /* of the grid: side x side vertices, 2 (side - 1)^2 triangles */
    uint32_t vertex_count;
    uint32_t mesh;
    uint32_t floor_mesh;
    uint32_t count;
    struct test_world *worlds; /* [count] */
    float (*x)[3];             /* [vertex_count] scratch: positions */
    struct pccd_batch *batch;  /* of all worlds: the body of each moves to x1 */
    void **x1;                 /* [count] */
};

/* Build it, in the same order each time: so handles of two sessions are the same. Returns
 * a status. */
int test_farm_make(struct pccd_client *client, uint32_t count, uint32_t side,
                   struct test_farm *farm);
/* Before the client is closed. */
void test_farm_free(struct test_farm *farm);

/* Find where the body of world `i` goes in turn `turn`: [vertex_count][3]. */
void test_farm_positions(const struct test_farm *farm, uint32_t i, uint32_t turn,
                         float (*x)[3]);

/* Submit a turn of all worlds by the batch. Returns a status. */
int test_farm_submit(struct test_farm *farm, uint32_t turn,
                     const struct pccd_step_settings *settings, uint64_t *step);
/* The same, and wait. */
int test_farm_turn(struct test_farm *farm, uint32_t turn,
                   const struct pccd_step_settings *settings,
                   struct pccd_batch_answer *answer);
/* A turn of one world by itself. */
int test_farm_alone(struct test_farm *farm, uint32_t i, uint32_t turn,
                    const struct pccd_step_settings *settings,
                    struct pccd_answer *answer);

#endif
