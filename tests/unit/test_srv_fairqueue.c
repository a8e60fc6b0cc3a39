/* test_srv_fairqueue.c - shares, waits and the order of the queue. */
#include "cases.h"
#include "prng.h"
#include "turns.h"

#define ENTRIES 64
#define MS      1000000u

struct server {
    struct srv_fairqueue queue;
    struct srv_fair entries[ENTRIES];
    uint64_t had_ns[ENTRIES]; /* service */
};

/* Serve whoever is next for cost_ns[it]; it asks again at once. Returns who it was. */
static uint32_t serve(struct server *server, const uint64_t *cost_ns)
{
    struct srv_fair *entry = srv_fair_take(&server->queue);
    uint32_t at = (uint32_t)(entry - server->entries);
    srv_fair_charge(&server->queue, entry, cost_ns[at]);
    server->had_ns[at] += cost_ns[at];
    srv_fair_push(&server->queue, entry);
    return at;
}

/* If it failed, whoever asks for much at a time would get more than the others. */
CASE(fairqueue__shares_are_equal_under_skewed_costs)
{
    static struct server server;
    static const uint64_t cost[5] = {20000, 200000, 1 * MS, 10 * MS, 100 * MS};
    server = (struct server){.had_ns = {0}};
    for (uint32_t i = 0; i < 5; i++) {
        srv_fair_push(&server.queue, &server.entries[i]);
    }
    for (uint64_t now_ns = 0; now_ns < 20000ull * MS;) {
        now_ns += cost[serve(&server, cost)];
        for (uint32_t i = 1; i < 5; i++) { /* at any time, not only in the end */
            assert_true(server.had_ns[i] <= server.had_ns[0] + 101 * MS);
            assert_true(server.had_ns[0] <= server.had_ns[i] + 101 * MS);
        }
    }
}

/* If it failed, one who asks for little now and then would wait for a turn of each of
 * those who always ask. */
CASE(fairqueue__one_that_asks_for_little_is_next)
{
    static struct server server;
    static uint64_t cost[ENTRIES];
    server = (struct server){.had_ns = {0}};
    srv_fair_push(&server.queue, &server.entries[0]); /* it has been here before */
    srv_fair_remove(&server.queue, &server.entries[0]);
    for (uint32_t i = 1; i < ENTRIES; i++) {
        cost[i] = 100 * MS + i;
        srv_fair_push(&server.queue, &server.entries[i]);
    }
    for (uint32_t i = 1; i < ENTRIES; i++) {
        serve(&server, cost); /* they came together: the first round is theirs */
    }
    for (uint32_t round = 0; round < 1000; round++) {
        struct srv_fair *entry = &server.entries[0];
        serve(&server, cost); /* somebody: it is not here */
        srv_fair_push(&server.queue, entry);
        assert_ptr_equal(srv_fair_take(&server.queue), entry);
        srv_fair_charge(&server.queue, entry, 50000);
    }
}

/* If it failed, one who was away could come back and keep everybody waiting for as long
 * as that, or one who had all of it while nobody asked would have to pay for it. */
CASE(fairqueue__what_was_before_is_forgotten_when_nobody_waited)
{
    static struct server server;
    static const uint64_t cost[2] = {1 * MS, 1 * MS};
    server = (struct server){.had_ns = {0}};
    srv_fair_push(&server.queue, &server.entries[0]);
    for (uint32_t i = 0; i < 10000; i++) {
        assert_int_equal(serve(&server, cost), 0);
    }
    srv_fair_push(&server.queue, &server.entries[1]);
    server.had_ns[0] = 0;
    for (uint32_t i = 0; i < 100; i++) {
        serve(&server, cost);
    }
    assert_true(server.had_ns[0] >= 49 * MS && server.had_ns[0] <= 51 * MS);
}

/* If it failed, one who was away for long while others waited could come back and keep
 * them waiting for as long as that. */
CASE(fairqueue__little_is_kept_for_who_was_away)
{
    static struct server server;
    static const uint64_t cost[3] = {1 * MS, 1 * MS, 1 * MS};
    uint32_t first = 0;
    server = (struct server){.had_ns = {0}};
    for (uint32_t i = 0; i < 3; i++) {
        srv_fair_push(&server.queue, &server.entries[i]);
    }
    srv_fair_remove(&server.queue, &server.entries[2]);
    for (uint32_t i = 0; i < 10000; i++) {
        serve(&server, cost);
    }
    srv_fair_push(&server.queue, &server.entries[2]);
    while (serve(&server, cost) == 2) {
        first++;
    }
    assert_true(first >= 95 && first <= 105);
}

/* If it failed, newcomers without end - sessions that are opened for one job each - would
 * keep one with a long job from ever being served. */
CASE(fairqueue__newcomers_do_not_starve_who_waits)
{
    static struct srv_fair newcomers[100];
    struct srv_fairqueue queue = {.root = NULL};
    struct srv_fair long_one = {.queued = false};
    uint32_t served = 0;
    srv_fair_push(&queue, &long_one);
    (void)srv_fair_take(&queue);
    srv_fair_push(&queue, &newcomers[served]); /* while it is being served */
    srv_fair_charge(&queue, &long_one, 1 * MS);
    srv_fair_push(&queue, &long_one);
    for (;;) {
        struct srv_fair *entry = srv_fair_take(&queue);
        if (entry == &long_one) {
            break;
        }
        assert_true(++served < 20); /* two are in the queue: the clock goes by a third */
        srv_fair_push(&queue, &newcomers[served]);
        srv_fair_charge(&queue, entry, 200000);
    }
    assert_true(served >= 4);
}

/* If it failed, who is taken out or has come again would be lost or served twice, or the
 * order would be broken for the others. */
CASE(fairqueue__order_holds_whoever_is_taken_out)
{
    static struct srv_fair entries[1000];
    struct srv_fairqueue queue = {.root = NULL};
    struct prng prng = {17};
    uint32_t queued = 0;
    for (uint32_t round = 0; round < 200000; round++) {
        struct srv_fair *entry = &entries[prng_below(&prng, 1000)];
        if (!entry->queued) {
            srv_fair_push(&queue, entry);
            queued++;
        } else if (prng_below(&prng, 2) == 0) {
            srv_fair_remove(&queue, entry);
            queued--;
        } else {
            entry = srv_fair_take(&queue);
            srv_fair_charge(&queue, entry, prng_below(&prng, 1000));
            queued--;
        }
        assert_int_equal(queue.count, queued);
    }
    assert_true(queued > 0);
    for (uint64_t last_ns = 0; queue.count > 0; queued--) { /* nobody comes any more */
        struct srv_fair *first = srv_fair_take(&queue);
        assert_true(first->start_ns >= last_ns);
        last_ns = first->start_ns;
    }
    assert_int_equal(queued, 0);
    for (uint32_t i = 0; i < 1000; i++) {
        assert_false(entries[i].queued);
    }
}
