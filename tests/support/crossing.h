/* crossing.h - the smallest scene with a known answer, and a client that keeps asking
 * for it. */
#ifndef TEST_CROSSING_H
#define TEST_CROSSING_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd.h"

struct test_crossing {
    struct pccd_client *client;
    uint32_t scene;
    uint32_t floor_mesh;
    uint32_t mesh;
    uint32_t floor;
    uint32_t object;
    float z; /* height of the triangle: 1 or -1 */
};

extern const float test_floor_x[3][3];
extern const float test_triangle_x[3][3]; /* at height 1 */
extern const uint32_t test_triangle[1][3];

/* A client of the daemon at `url` with a timeout that a test can wait for; NULL with a
 * message on stderr when it cannot connect. */
struct pccd_client *test_connect(const char *url);

/* The same, to which the loss of the daemon is an error at once. */
struct pccd_client *test_connect_once(const char *url);

/* The same with a single slot, so that the memory it shares is always the same: a slot
 * that nobody needs would be given back after a second. */
struct pccd_client *test_connect_slim(const char *url);

/* Build the scene in a session. Returns a status. */
int test_crossing_make(struct pccd_client *client, struct test_crossing *crossing);

/* Positions of the triangle at height z. */
void test_crossing_positions(float x[3][3], float z);

/* A step in which the triangle goes to x1. Returns a status. */
int test_crossing_step(struct test_crossing *crossing, const void *x1,
                       const struct pccd_step_settings *settings,
                       struct pccd_answer *answer);

/* One turn through the floor. True when the answer is what it must be. */
bool test_crossing_turn(struct test_crossing *crossing);

/* Check an answer to a turn, and release it. */
bool test_crossing_is_right(struct test_crossing *crossing, struct pccd_answer *answer);

/* A counter of the daemon by name; UINT64_MAX when the call fails or there is none. */
uint64_t test_stat(struct pccd_client *client, const char *name);

/* Wait until the counter is `value`, up to 5 s; returns what it was last. */
uint64_t test_stat_await(struct pccd_client *client, const char *name, uint64_t value);

#endif
