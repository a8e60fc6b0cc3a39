/* updates.c - positions of many vertices, from one process to the other.
 *
 * Room:     bench/redis.
 * Does:     a step of many vertices beside a copy of them into shared memory, and beside
 *           Redis's SET of the same bytes.
 *
 *           The client makes its positions in the slot, as pccd_frame_x1 has it, and as
 *           it makes them in a buffer of its own before SET; what it takes to make them
 *           is on neither side. Row 4, publish to private checked copy: the message, the
 *           daemon's copy out of the slot with its checks, and the answer's way back,
 *           which is no part of it but cannot be told apart: all of an update but what is
 *           computed with the copy. A client that spins for 50 us is judged, as its
 *           wake-up is not the copy's; one that waits in the kernel is told. Row 5 is the
 *           same beside SET, which computes nothing either, the client waiting in the
 *           kernel. Told, too: the same where the client has its positions elsewhere, and
 *           copies them into the slot; and the update with all that the step computes.
 * Threads:  one.
 */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "asker.h"
#include "pairs.h"
#include "rows.h"

struct size {
    const char *name;
    uint32_t vertex_count;
    unsigned turns;
    double share; /* of memcpy's bandwidth */
    double set;   /* of SET's time */
};

/* The copy by a process that sleeps and does nothing else (least.h), for a client that
 * waits in the kernel; updates without what is computed, of positions made in the slot
 * (SPINNING, WAITING) and of those copied into it; and one with it. */
enum quantity { COPY, LEAST, SET, SPINNING, WAITING, COPIED, WHOLE, QUANTITIES };

/* Microseconds of the step, and of it what is computed. */
static void take(struct bench_soup *soup, uint64_t begin_ns, uint64_t step, double *whole,
                 double *moved)
{
    struct pccd_answer answer;
    bench_must(pccd_wait(soup->client, step, -1, &answer), "wait", soup->client);
    *whole = 1e-3 * (double)(bench_now_ns() - begin_ns);
    *moved = *whole - 1e-3 * (double)(answer.times.step - answer.times.ingest);
    bench_check(answer.total == BENCH_SOUP_CONTACTS && answer.vf == BENCH_SOUP_CONTACTS,
                "update", "the positions did not arrive");
    pccd_answer_release(soup->client, &answer);
}

/* `in_place`: the positions are made before the clock runs. */
static void update(struct bench_soup *soup, const void *x, bool in_place, double *whole,
                   double *moved)
{
    struct pccd_frame frame;
    uint64_t step;
    void *slot;
    uint64_t begin_ns = bench_now_ns();
    bench_must(pccd_frame_begin(soup->client, soup->scene, 1, soup->bytes, &frame),
               "begin", soup->client);
    bench_must(
        pccd_frame_x1(&frame, soup->object, soup->format, 0, soup->vertex_count, &slot),
        "x1", soup->client);
    memcpy(slot, x, soup->bytes);
    begin_ns = in_place ? bench_now_ns() : begin_ns;
    bench_must(pccd_frame_commit(&frame, NULL, &step), "commit", soup->client);
    take(soup, begin_ns, step, whole, moved);
}

/* The blocking client's scene, and the other's. */
static void take_turn(struct bench_soup soups[2], unsigned i, unsigned char *shared,
                      const struct least *servers, int redis_fd, double us[QUANTITIES])
{
    const struct bench_soup *soup = &soups[0];
    double whole;
    uint64_t t0 = bench_now_ns();
    memcpy(shared + i % BENCH_SLOTS * soup->bytes, soup->x[1], soup->bytes);
    uint64_t t1 = bench_now_ns();
    bench_check(redis_set(redis_fd, soup->x[1], soup->bytes), "redis", "SET is not OK");
    uint64_t t2 = bench_now_ns();
    memcpy(servers->shared, soup->x[1], soup->bytes);
    uint64_t t3 = bench_now_ns();
    least_ask(servers, soup->bytes);
    us[COPY] = 1e-3 * (double)(t1 - t0);
    us[SET] = 1e-3 * (double)(t2 - t1);
    us[LEAST] = 1e-3 * (double)(bench_now_ns() - t3);
    update(&soups[0], soup->x[1], false, &us[WHOLE], &us[COPIED]);
    update(&soups[0], soup->x[0], true, &whole, &us[WAITING]);
    update(&soups[1], soup->x[(i + 1) % 2], true, &whole, &us[SPINNING]);
}

/* Rows, in their order; of those of copies the unit is GB/s. */
enum row {
    PUBLISH,
    PUBLISH_WAITING,
    PUBLISH_COPIED,
    PUBLISH_LEAST,
    UPDATE,
    UPDATE_COPIED,
    UPDATE_WHOLE,
    ROWS
};

static void keep(struct pairs pairs[ROWS], double kb, const double us[QUANTITIES])
{
    pairs_add(&pairs[PUBLISH], kb / us[SPINNING], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_WAITING], kb / us[WAITING], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_COPIED], kb / us[COPIED], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_LEAST], kb / us[LEAST], kb / us[COPY]);
    pairs_add(&pairs[UPDATE], us[WAITING], us[SET]);
    pairs_add(&pairs[UPDATE_COPIED], us[COPIED], us[SET]);
    pairs_add(&pairs[UPDATE_WHOLE], us[WHOLE], us[SET]);
}

static void tell(const char *what, const char *anchor, const char *unit,
                 struct pairs *pairs)
{
    pairs_print(&(struct pairs_row){"", what, anchor, unit, PAIRS_TOLD, 0}, pairs);
}

static void print(const struct size *size, struct pairs pairs[ROWS])
{
    char name[64];
    const char *copy = "memcpy into shared";
    const char *set = "SET of the bytes";
    snprintf(name, sizeof name, "%s to a checked copy", size->name);
    pairs_print(&(struct pairs_row){"4", name, copy, "GB/s", PAIRS_AT_LEAST, size->share},
                &pairs[PUBLISH]);
    tell("the same, waiting in the kernel", copy, "GB/s", &pairs[PUBLISH_WAITING]);
    tell("the same, copied into the slot", copy, "GB/s", &pairs[PUBLISH_COPIED]);
    tell("the least: a message, the copy, a message", copy, "GB/s",
         &pairs[PUBLISH_LEAST]);
    snprintf(name, sizeof name, "%s, update", size->name);
    pairs_print(&(struct pairs_row){"5", name, set, "us", PAIRS_AT_MOST, size->set},
                &pairs[UPDATE]);
    tell("the same, copied into the slot", set, "us", &pairs[UPDATE_COPIED]);
    tell("the same, with all that is computed", set, "us", &pairs[UPDATE_WHOLE]);
}

static void measure(const struct rows *rows, const struct size *size, int redis_fd)
{
    struct pairs pairs[ROWS] = {0};
    struct bench_soup soups[2];
    double us[QUANTITIES];
    uint32_t vertices = rows->smoke ? 300 : size->vertex_count;
    bench_soup_init(&soups[0], rows->blocking, PCCD_FORMAT_F32, vertices);
    bench_soup_init(&soups[1], rows->spinning, PCCD_FORMAT_F32, vertices);
    unsigned char *shared = bench_shared_new(BENCH_SLOTS * soups[0].bytes);
    double kb = 1e-3 * (double)soups[0].bytes; /* KB a us are GB/s */
    for (unsigned i = 0, turns = rows->smoke ? 3 : size->turns; i < turns + 4; i++) {
        take_turn(soups, i, shared, rows->least, redis_fd, us);
        if (i >= 4) { /* every slot has been written */
            keep(pairs, kb, us);
        }
    }
    print(size, pairs);
    munmap(shared, BENCH_SLOTS * soups[0].bytes);
    bench_soup_deinit(&soups[1]);
    bench_soup_deinit(&soups[0]);
}

void rows_updates(const struct rows *rows)
{
    static const struct size sizes[] = {
        {"46 K vertices", 46000, 200, 0.35, 1.4},
        {"250 K vertices", 250000, 60, 0.45, 0.7},
        {"1 M vertices", ROWS_VERTICES_MAX, 20, 0.45, 0.25},
    };
    int redis_fd = redis_connect(rows->redis);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        measure(rows, &sizes[i], redis_fd);
    }
    close(redis_fd);
}
