/* updates.c - positions of many vertices, from one process to the other.
 *
 * A step of many vertices beside a copy of them into shared memory, and beside Redis's
 * SET of the same bytes.
 *
 * The client makes its positions in the slot, as pccd_frame_x1 has it, and as it makes
 * them in a buffer of its own before SET; what it takes to make them is on neither side.
 * Row 4, publish to private checked copy: from the client's publishing to where the
 * daemon's step begins, as the recorded trace of a daemon that serves no other row has
 * it; both read one clock. It is the way there, with whoever must be woken, and the copy
 * out of the slot with its checks. Told, too: the same of floats by the least server,
 * which copies them as they are; and all of an update but what is computed with the copy,
 * that is with the answer's way back, by a client that spins for 50 us and by one that
 * waits in the kernel. Row 5 is the latter beside SET, which computes nothing either.
 * Told, too: the same where the client has its positions elsewhere, and copies them into
 * the slot; and the update with all that the step computes.
 */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "asker.h"
#include "rows.h"

struct size {
    const char *name;
    uint32_t vertex_count;
    unsigned turns;
    double share; /* of memcpy's bandwidth */
    double set;   /* of SET's time */
};

/* Copies into shared memory; the way to a private copy, ours and of a process that sleeps
 * and does nothing else (least.c), of a client that waits in the kernel; updates without
 * what is computed, of positions made in the slot (SPINNING, WAITING) and of those copied
 * into it; and one with it. */
enum quantity {
    COPY,
    COPY_DOUBLE,
    PUBLISHED,
    PUBLISHED_DOUBLE,
    LEAST,
    SET,
    SPINNING,
    WAITING,
    COPIED,
    WHOLE,
    QUANTITIES
};

/* Microseconds since `begin_ns`, and of them what is not computed. */
static void take(struct bench_soup *soup, uint64_t begin_ns, uint64_t step, double *whole,
                 double *moved)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    bench_must(pccd_wait(soup->client, step, -1, &answer), "wait", soup->client);
    *whole = 1e-3 * (double)(common_now_ns() - begin_ns);
    *moved = *whole - 1e-3 * (double)(answer.times.step - answer.times.ingest);
    bench_check(answer.total == BENCH_SOUP_CONTACTS &&
                    answer.counts[PCCD_VF] == BENCH_SOUP_CONTACTS,
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
    uint64_t begin_ns = common_now_ns();
    bench_must(pccd_frame_begin(soup->client, soup->scene, 1, soup->bytes, &frame),
               "begin", soup->client);
    bench_must(
        pccd_frame_x1(&frame, soup->object, soup->format, 0, soup->vertex_count, &slot),
        "x1", soup->client);
    memcpy(slot, x, soup->bytes);
    begin_ns = in_place ? common_now_ns() : begin_ns;
    bench_must(pccd_frame_commit(&frame, NULL, &step), "commit", soup->client);
    take(soup, begin_ns, step, whole, moved);
    return begin_ns;
}

/* ---- the way there ----------------------------------------------------------------- */

#define TURNS_MAX 256u

/* In a turn of steps, one of each. */
#define WAYS 2u
static const enum pccd_format way_formats[WAYS] = {PCCD_FORMAT_F32, PCCD_FORMAT_F64};

/* When steps were published, and when they began, in order. */
struct way {
    struct bench_soup soups[WAYS]; /* of a daemon that records, and serves no other row */
    uint64_t published_ns[TURNS_MAX * WAYS];
    uint64_t begin_ns[TURNS_MAX * WAYS];
    uint32_t count; /* of begin_ns */
};

static void way_begin(struct way *way, uint32_t vertex_count)
{
    struct pccd_client *client = bench_connect(0, NULL);
    way->count = 0;
    for (unsigned at = 0; at < WAYS; at++) {
        bench_soup_init(&way->soups[at], client, way_formats[at], vertex_count);
    }
    bench_must(pccd_trace_start(client, 0, UINT64_MAX, NULL), "trace", client);
}

static void add_begins(void *context, const struct pccd_trace_event *events,
                       uint32_t count)
{
    struct way *way = context;
    for (uint32_t i = 0; i < count; i++) {
        if (events[i].kind == PCCD_TRACE_STEP && way->count < TURNS_MAX * WAYS) {
            way->begin_ns[way->count++] = events[i].begin_ns;
        }
    }
}

/* Stop the trace, which must have every step of `turns` turns once, and close. */
static void way_end(struct way *way, unsigned turns)
{
    struct pccd_client *client = way->soups[0].client;
    bench_must(pccd_trace_stop(client, NULL), "trace", client);
    bench_must(pccd_trace_dump(client, add_begins, way), "trace", client);
    bench_check(way->count == turns * WAYS, "trace", "it has not every step once");
    for (unsigned at = 0; at < WAYS; at++) {
        bench_soup_deinit(&way->soups[at]);
    }
    pccd_close(client);
}

/* Step `turn` of each. */
static void way_publish(struct way *way, unsigned turn)
{
    double whole;
    double moved;
    for (unsigned at = 0; at < WAYS; at++) {
        struct bench_soup *soup = &way->soups[at];
        way->published_ns[turn * WAYS + at] =
            update(soup, soup->x[(turn + 1) % 2], true, &whole, &moved);
    }
}

static double way_us(const struct way *way, unsigned turn, unsigned at)
{
    unsigned step = turn * WAYS + at;
    return 1e-3 * (double)(way->begin_ns[step] - way->published_ns[step]);
}

/* ---- a turn ------------------------------------------------------------------------ */

struct asked {
    struct bench_soup soups[2]; /* the blocking client's scene, and the spinning one's */
    struct way way;
    unsigned char *shared; /* what memcpy writes: as many slots as the ring has */
    const struct least *least;
    int redis_fd;
};

static double copy_us(const struct asked *asked, const struct bench_soup *soup,
                      unsigned i)
{
    uint64_t begin_ns = common_now_ns();
    memcpy(asked->shared + i % BENCH_SLOTS * soup->bytes, soup->x[1], soup->bytes);
    return 1e-3 * (double)(common_now_ns() - begin_ns);
}

static void take_turn(struct asked *asked, unsigned i, double us[QUANTITIES])
{
    struct bench_soup *soup = &asked->soups[0];
    size_t bytes = soup->bytes;
    double whole;
    us[COPY] = copy_us(asked, soup, i);
    uint64_t set_ns = common_now_ns();
    if (asked->redis_fd >= 0) {
        bench_check(redis_set(asked->redis_fd, soup->x[1], bytes), "redis",
                    "SET is not OK");
    }
    us[SET] = 1e-3 * (double)(common_now_ns() - set_ns);
    memcpy(asked->least->shared, soup->x[1], bytes);
    uint64_t least_ns = common_now_ns();
    us[LEAST] = 1e-3 * (double)(least_ask(asked->least, bytes) - least_ns);
    us[COPY_DOUBLE] = copy_us(asked, &asked->way.soups[1], i);
    way_publish(&asked->way, i);
    update(soup, soup->x[1], false, &us[WHOLE], &us[COPIED]);
    update(soup, soup->x[0], true, &whole, &us[WAITING]);
    update(&asked->soups[1], asked->soups[1].x[(i + 1) % 2], true, &whole, &us[SPINNING]);
}

/* Rows, in their order; of those of copies the unit is GB/s. */
enum row {
    PUBLISH,
    PUBLISH_DOUBLE,
    PUBLISH_LEAST,
    PUBLISH_SPINNING,
    PUBLISH_WAITING,
    PUBLISH_COPIED,
    UPDATE,
    UPDATE_COPIED,
    UPDATE_WHOLE,
    ROWS
};

static void keep(struct pairs pairs[ROWS], double kb, bool has_redis,
                 const double us[QUANTITIES])
{
    pairs_add(&pairs[PUBLISH], kb / us[PUBLISHED], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_DOUBLE], 2 * kb / us[PUBLISHED_DOUBLE],
              2 * kb / us[COPY_DOUBLE]);
    pairs_add(&pairs[PUBLISH_LEAST], kb / us[LEAST], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_SPINNING], kb / us[SPINNING], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_WAITING], kb / us[WAITING], kb / us[COPY]);
    pairs_add(&pairs[PUBLISH_COPIED], kb / us[COPIED], kb / us[COPY]);
    if (has_redis) {
        pairs_add(&pairs[UPDATE], us[WAITING], us[SET]);
        pairs_add(&pairs[UPDATE_COPIED], us[COPIED], us[SET]);
        pairs_add(&pairs[UPDATE_WHOLE], us[WHOLE], us[SET]);
    }
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
    snprintf(name, sizeof name, "%s to a checked copy, float", size->name);
    pairs_print(&(struct pairs_row){"4", name, copy, "GB/s", PAIRS_AT_LEAST, size->share},
                &pairs[PUBLISH]);
    snprintf(name, sizeof name, "%s to a checked copy, double", size->name);
    pairs_print(&(struct pairs_row){"4", name, copy, "GB/s", PAIRS_AT_LEAST, size->share},
                &pairs[PUBLISH_DOUBLE]);
    tell("the least: a message, and a copy of floats", copy, "GB/s",
         &pairs[PUBLISH_LEAST]);
    tell("floats with the way back, 50 us spin", copy, "GB/s", &pairs[PUBLISH_SPINNING]);
    tell("with it, waiting in the kernel", copy, "GB/s", &pairs[PUBLISH_WAITING]);
    tell("with it, copied into the slot", copy, "GB/s", &pairs[PUBLISH_COPIED]);
    snprintf(name, sizeof name, "%s, update", size->name);
    pairs_print(&(struct pairs_row){"5", name, set, "us", PAIRS_AT_MOST, size->set},
                &pairs[UPDATE]);
    tell("the same, copied into the slot", set, "us", &pairs[UPDATE_COPIED]);
    tell("the same, with all that is computed", set, "us", &pairs[UPDATE_WHOLE]);
}

#define WARM_TURNS 4u /* every slot has been written */

static void measure(const struct rows *rows, const struct size *size, int redis_fd)
{
    static struct asked asked;
    static double us[TURNS_MAX][QUANTITIES];
    struct pairs pairs[ROWS] = {0};
    uint32_t vertices = rows->smoke ? 300 : size->vertex_count;
    unsigned turns = WARM_TURNS + (rows->smoke ? 3 : size->turns);
    asked.least = rows->least;
    asked.redis_fd = redis_fd;
    bench_soup_init(&asked.soups[0], rows->blocking, PCCD_FORMAT_F32, vertices);
    bench_soup_init(&asked.soups[1], rows->spinning, PCCD_FORMAT_F32, vertices);
    size_t bytes = asked.soups[0].bytes;
    asked.shared = bench_shared_new(BENCH_SLOTS * 2 * bytes);
    way_begin(&asked.way, vertices);
    for (unsigned i = 0; i < turns; i++) {
        take_turn(&asked, i, us[i]);
    }
    way_end(&asked.way, turns);
    for (unsigned i = WARM_TURNS; i < turns; i++) {
        us[i][PUBLISHED] = way_us(&asked.way, i, 0);
        us[i][PUBLISHED_DOUBLE] = way_us(&asked.way, i, 1);
        keep(pairs, 1e-3 * (double)bytes, redis_fd >= 0, us[i]); /* KB a us are GB/s */
    }
    print(size, pairs);
    munmap(asked.shared, BENCH_SLOTS * 2 * bytes);
    bench_soup_deinit(&asked.soups[1]);
    bench_soup_deinit(&asked.soups[0]);
}

void rows_updates(const struct rows *rows)
{
    static const struct size sizes[] = {
        {"46 K vertices", 46000, 200, 0.35, 1.4},
        {"250 K vertices", 250000, 60, 0.45, 0.7},
        {"1 M vertices", ROWS_VERTICES_MAX, 20, 0.45, 0.25},
    };
    int redis_fd = rows->redis ? redis_connect(rows->redis) : -1;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        measure(rows, &sizes[i], redis_fd);
    }
    if (redis_fd >= 0) {
        close(redis_fd);
    }
}
