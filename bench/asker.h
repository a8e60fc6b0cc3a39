/* asker.h - the client with which the benchmarks ask a private daemon. */
#ifndef BENCH_ASKER_H
#define BENCH_ASKER_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "pccd.h"

#define BENCH_SLOTS 4u /* of the upload ring */

/* Contacts that a step of a soup finds: the vertices of the triangle that passes
 * another. */
#define BENCH_SOUP_CONTACTS 3u

void bench_must(int status, const char *what, struct pccd_client *client);

/* url NULL: start a daemon that goes with this client. */
struct pccd_client *bench_connect(uint32_t spin_us, const char *url);

/* A process or thread to one processor; < 0: to all. */
void bench_pin(pid_t pid, int cpu);

double bench_ping_us(struct pccd_client *client);

/* A triangle by itself, and a step in which it stands still; its answer is checked. */
uint32_t bench_tiny_scene(struct pccd_client *client);
double bench_empty_step_us(struct pccd_client *client, uint32_t scene);

struct bench_soup {
    struct pccd_client *client;
    enum pccd_format format;
    uint32_t vertex_count;
    size_t bytes; /* of the positions */
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
    void *x[2]; /* the positions of even and odd steps */
};

void bench_soup_init(struct bench_soup *soup, struct pccd_client *client,
                     enum pccd_format format, uint32_t vertex_count);
void bench_soup_deinit(struct bench_soup *soup);

/* Shared memory as the daemon makes it: every page is there before it is used. */
unsigned char *bench_shared_new(size_t bytes);

#endif
