/* updates.c - positions of many vertices, from one process to the other.
 *
 * Room:     bench/redis.
 * Does:     a step of many vertices beside a copy of them into shared memory, and beside
 *           Redis's SET of the same bytes.
 *
 *           The client makes its positions in the slot, as pccd_frame_x1 has it, and as
 *           it makes them in a buffer of its own before SET; what it takes to make them
 *           is on neither side. Row 4, publish to private checked copy: from the client's
 *           publishing to where the daemon's step begins, as its recorded trace has it;
 *           both read one clock. It is the way there, with whoever must be woken, and the
 *           copy out of the slot with its checks. Told, too: all of an update but what is
 *           computed with the copy, that is with the answer's way back, by a client that
 *           spins for 50 us and by one that waits in the kernel. Row 5 is the latter
 *           beside SET, which computes nothing either. Told, too: the same where the
 *           client has its positions elsewhere, and copies them into the slot; and the
 *           update with all that the step computes.
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

/* Microseconds since `begin_ns`, and of them what is not computed. */
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

/* `in_place`: the positions are made before the clock runs. Returns when it began. */
static uint64_t update(struct bench_soup *soup, const void *x, bool in_place,
                       double *whole, double *moved)
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
    return begin_ns;
}

/* ---- the way there ----------------------------------------------------------------- */

#define TURNS_MAX 256u

/* When steps began, in order. */
struct begins {
    uint64_t ns[TURNS_MAX];
    uint32_t count;
};

static void add_begins(void *context, const struct pccd_trace_event *events,
                       uint32_t count)
{
    struct begins *begins = context;
    for (uint32_t i = 0; i < count; i++) {
        if (events[i].kind == PCCD_TRACE_STEP && begins->count < TURNS_MAX) {
            begins->ns[begins->count++] = events[i].begin_ns;
        }
    }
}

/* By turns: a copy, and an update of which the daemon tells when it had its copy. It is
 * a daemon of its own, so that no other row is one of a daemon that records, or has. */
static void measure_way(uint32_t vertex_count, unsigned turns, unsigned char *shared,
                        struct pairs *pairs)
{
    static struct begins begins;
    static uint64_t published_ns[TURNS_MAX];
    static double copy_us[TURNS_MAX];
    struct bench_soup traced;
    struct bench_soup *soup = &traced;
    double whole;
    double moved;
    begins.count = 0;
    bench_soup_init(soup, bench_connect(50, NULL), PCCD_FORMAT_F32, vertex_count);
    for (unsigned i = 0; i < 4; i++) { /* every slot has been written */
        (void)update(soup, soup->x[(i + 1) % 2], true, &whole, &moved);
    }
    bench_must(pccd_trace_start(soup->client, 0, UINT64_MAX, NULL), "trace",
               soup->client);
    for (unsigned i = 0; i < turns; i++) {
        uint64_t begin_ns = bench_now_ns();
        memcpy(shared + i % BENCH_SLOTS * soup->bytes, soup->x[0], soup->bytes);
        copy_us[i] = 1e-3 * (double)(bench_now_ns() - begin_ns);
        published_ns[i] = update(soup, soup->x[(i + 1) % 2], true, &whole, &moved);
    }
    bench_must(pccd_trace_stop(soup->client, NULL), "trace", soup->client);
    bench_must(pccd_trace_dump(soup->client, add_begins, &begins), "trace", soup->client);
    bench_check(begins.count == turns, "trace", "it has not every step once");
    for (unsigned i = 0; i < turns && i < begins.count; i++) {
        double kb = 1e-3 * (double)soup->bytes;
        double us = 1e-3 * (double)(begins.ns[i] - published_ns[i]);
        pairs_add(pairs, kb / us, kb / copy_us[i]);
    }
    struct pccd_client *client = soup->client;
    bench_soup_deinit(soup);
    pccd_close(client);
}

/* ---- there and back ---------------------------------------------------------------- */

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
    PUBLISH_SPINNING,
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
    pairs_add(&pairs[PUBLISH_SPINNING], kb / us[SPINNING], kb / us[COPY]);
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
    tell("with the way back, spinning for 50 us", copy, "GB/s", &pairs[PUBLISH_SPINNING]);
    tell("with it, waiting in the kernel", copy, "GB/s", &pairs[PUBLISH_WAITING]);
    tell("with it, copied into the slot", copy, "GB/s", &pairs[PUBLISH_COPIED]);
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
    unsigned turns = rows->smoke ? 3 : size->turns;
    for (unsigned i = 0; i < turns + 4; i++) {
        take_turn(soups, i, shared, rows->least, redis_fd, us);
        if (i >= 4) { /* every slot has been written */
            keep(pairs, kb, us);
        }
    }
    measure_way(vertices, turns, shared, &pairs[PUBLISH]);
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
