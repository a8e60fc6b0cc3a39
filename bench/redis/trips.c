/* trips.c - one client, one message at a time.
 *
 * Ping and empty steps beside Redis's PING, fifty of each a turn.
 *
 * Where the two ends run decides most: a wake-up across processors takes some forty
 * microseconds, one on the same processor two. Left to itself the kernel keeps a pair
 * wherever it has begun. So pings are put on two processors, then on one. Steps are left
 * alone: they need threads of the daemon that have places of their own; they are judged
 * by what two processors take.
 */
#include <unistd.h>

#include "asker.h"
#include "rows.h"

#define TURN 50u

enum side {
    REDIS_TWO,
    PING_TWO,
    LEAST_TWO,
    REDIS_ONE,
    PING_ONE,
    LEAST_ONE,
    BLOCKING,
    SPINNING,
    SIDES
};

struct trips {
    const struct rows *rows;
    int redis_fd;
    pid_t daemon; /* its thread that talks */
    uint32_t scenes[2];
};

static void place(const struct trips *trips, int client, int server)
{
    bench_pin(0, client);
    if (trips->rows->redis) {
        bench_pin(trips->rows->redis->pid, server);
    }
    bench_pin(trips->daemon, server);
    bench_pin(trips->rows->least->pid, server);
}

static double trip_us(const struct trips *trips, enum side side)
{
    uint64_t begin_ns;
    switch (side) {
    case REDIS_TWO:
    case REDIS_ONE:
        if (!trips->rows->redis) {
            return 0;
        }
        begin_ns = common_now_ns();
        bench_check(redis_ping(trips->redis_fd), "redis", "PING without PONG");
        return 1e-3 * (double)(common_now_ns() - begin_ns);
    case LEAST_TWO:
    case LEAST_ONE:
        begin_ns = common_now_ns();
        (void)least_ask(trips->rows->least, 0);
        return 1e-3 * (double)(common_now_ns() - begin_ns);
    case BLOCKING:
        return bench_empty_step_us(trips->rows->blocking, trips->scenes[0]);
    case SPINNING:
        return bench_empty_step_us(trips->rows->spinning, trips->scenes[1]);
    default:
        return bench_ping_us(trips->rows->blocking);
    }
}

/* Measure each side in one turn, to medians. */
static void take_turn(const struct trips *trips, double medians[SIDES])
{
    struct bench_samples samples = {0};
    bool has_two = sysconf(_SC_NPROCESSORS_ONLN) > 1;
    for (enum side side = 0; side < SIDES; side++) {
        if (side == REDIS_TWO) {
            place(trips, 0, has_two ? 1 : 0);
        } else if (side == REDIS_ONE) {
            place(trips, 0, 0);
        } else if (side == BLOCKING) {
            place(trips, -1, -1);
        }
        for (unsigned i = 0; i < TURN; i++) {
            bench_add(&samples, trip_us(trips, side));
        }
        medians[side] = bench_take_median(&samples);
    }
    bench_free(&samples);
}

/* Without Redis the least server stands in its place. */
static enum side anchor_of(const struct rows *rows, enum side anchor)
{
    return rows->redis ? anchor : anchor == REDIS_TWO ? LEAST_TWO : LEAST_ONE;
}

void rows_trips(const struct rows *rows)
{
    static const struct {
        enum side ours, anchor;
        struct pairs_row row;
    } table[] = {
        {PING_TWO,
         REDIS_TWO,
         {"1", "ping, two processors", "PING, two", "us", PAIRS_AT_MOST, 1.15}},
        {LEAST_TWO, REDIS_TWO, {"", "the least", "PING, two", "us", PAIRS_TOLD, 0}},
        {PING_ONE,
         REDIS_ONE,
         {"1", "ping, one processor", "PING, one", "us", PAIRS_AT_MOST, 1.0}},
        {LEAST_ONE, REDIS_ONE, {"", "the least", "PING, one", "us", PAIRS_TOLD, 0}},
        {BLOCKING,
         REDIS_TWO,
         {"3", "empty step, blocking", "PING, two", "us", PAIRS_AT_MOST, 1.5}},
        {SPINNING,
         REDIS_TWO,
         {"3", "empty step, 50 us spin", "PING, two", "us", PAIRS_AT_MOST, 0.6}},
    };
    enum { ROWS = sizeof table / sizeof table[0] };
    struct trips trips = {
        .rows = rows,
        .redis_fd = rows->redis ? redis_connect(rows->redis) : -1,
        .daemon = (pid_t)pccd_daemon_pid(rows->blocking),
        .scenes = {bench_tiny_scene(rows->blocking), bench_tiny_scene(rows->spinning)}};
    struct pairs pairs[ROWS] = {0};
    double medians[SIDES];
    for (unsigned turn = 0, turns = rows->smoke ? 2 : 100; turn <= turns; turn++) {
        take_turn(&trips, medians);
        for (size_t i = 0; i < ROWS && turn > 0; i++) {
            enum side anchor = anchor_of(rows, table[i].anchor);
            if (table[i].ours != anchor) {
                pairs_add(&pairs[i], medians[table[i].ours], medians[anchor]);
            }
        }
    }
    for (size_t i = 0; i < ROWS; i++) {
        struct pairs_row row = table[i].row;
        if (!rows->redis) {
            row.anchor = "the least";
            row.want = PAIRS_TOLD;
        }
        pairs_print(&row, &pairs[i]);
    }
    bench_must(pccd_scene_destroy(rows->blocking, trips.scenes[0]), "scene",
               rows->blocking);
    bench_must(pccd_scene_destroy(rows->spinning, trips.scenes[1]), "scene",
               rows->spinning);
    if (rows->redis) {
        close(trips.redis_fd);
    }
}
