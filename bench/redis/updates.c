/* updates.c - positions of many vertices, from one process to the other.
 *
 * Room:     bench/redis.
 * Does:     a step of many vertices beside a copy of them into shared memory, and beside
 *           Redis's SET of the same bytes.
 *
 *           Row 4, publish to private checked copy: the client's copy into the slot, the
 *           message, the daemon's copy out of it with its checks, and the answer's way
 *           back, which is no part of it but cannot be told apart: all of an update but
 *           what is computed with the copy. Row 5 is the same beside SET, which computes
 *           nothing either. Told, too: the same where the client makes its positions in
 *           the slot, as it would in a buffer of its own before SET, which saves its
 *           copy; and the update with all that the step computes.
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

/* MOVED: an update without what is computed. */
enum quantity { COPY, SET, MOVED, MOVED_IN_PLACE, WHOLE, QUANTITIES };

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

static void take_turn(struct bench_soup *soup, unsigned i, unsigned char *shared,
                      int redis_fd, double us[QUANTITIES])
{
    double whole;
    uint64_t t0 = bench_now_ns();
    memcpy(shared + i % BENCH_SLOTS * soup->bytes, soup->x[1], soup->bytes);
    uint64_t t1 = bench_now_ns();
    bench_check(redis_set(redis_fd, soup->x[1], soup->bytes), "redis", "SET is not OK");
    uint64_t t2 = bench_now_ns();
    us[COPY] = 1e-3 * (double)(t1 - t0);
    us[SET] = 1e-3 * (double)(t2 - t1);
    update(soup, soup->x[1], false, &us[WHOLE], &us[MOVED]);
    update(soup, soup->x[0], true, &whole, &us[MOVED_IN_PLACE]);
}

static void print(const struct size *size, struct pairs pairs[5])
{
    char name[64];
    snprintf(name, sizeof name, "%s to a checked copy", size->name);
    pairs_print(&(struct pairs_row){"4", name, "memcpy into shared", "GB/s",
                                    PAIRS_AT_LEAST, size->share},
                &pairs[0]);
    pairs_print(&(struct pairs_row){"", "the same, made in the slot",
                                    "memcpy into shared", "GB/s", PAIRS_TOLD, 0},
                &pairs[1]);
    snprintf(name, sizeof name, "%s, update", size->name);
    pairs_print(&(struct pairs_row){"5", name, "SET of the bytes", "us", PAIRS_AT_MOST,
                                    size->set},
                &pairs[2]);
    pairs_print(&(struct pairs_row){"", "the same, made in the slot", "SET of the bytes",
                                    "us", PAIRS_TOLD, 0},
                &pairs[3]);
    pairs_print(&(struct pairs_row){"", "the same, with all that is computed",
                                    "SET of the bytes", "us", PAIRS_TOLD, 0},
                &pairs[4]);
}

static void measure(const struct rows *rows, const struct size *size, int redis_fd)
{
    struct pairs pairs[5] = {0};
    struct bench_soup soup;
    double us[QUANTITIES];
    bench_soup_init(&soup, rows->blocking, PCCD_FORMAT_F32,
                    rows->smoke ? 300 : size->vertex_count);
    unsigned char *shared = bench_shared_new(BENCH_SLOTS * soup.bytes);
    double kb = 1e-3 * (double)soup.bytes; /* KB a us are GB/s */
    for (unsigned i = 0, turns = rows->smoke ? 3 : size->turns; i < turns + 4; i++) {
        take_turn(&soup, i, shared, redis_fd, us);
        if (i >= 4) { /* every slot has been written */
            pairs_add(&pairs[0], kb / us[MOVED], kb / us[COPY]);
            pairs_add(&pairs[1], kb / us[MOVED_IN_PLACE], kb / us[COPY]);
            pairs_add(&pairs[2], us[MOVED], us[SET]);
            pairs_add(&pairs[3], us[MOVED_IN_PLACE], us[SET]);
            pairs_add(&pairs[4], us[WHOLE], us[SET]);
        }
    }
    print(size, pairs);
    munmap(shared, BENCH_SLOTS * soup.bytes);
    bench_soup_deinit(&soup);
}

void rows_updates(const struct rows *rows)
{
    static const struct size sizes[] = {
        {"46 K vertices", 46000, 200, 0.35, 1.4},
        {"250 K vertices", 250000, 60, 0.45, 0.7},
        {"1 M vertices", 1000000, 20, 0.45, 0.25},
    };
    int redis_fd = redis_connect(rows->redis);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        measure(rows, &sizes[i], redis_fd);
    }
    close(redis_fd);
}
