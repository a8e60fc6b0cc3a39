/* test_zoo_animals.c - hostile clients beside an honest one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "animals.h"
#include "cases.h"
#include "keeper.h"

#define HEAP_MAX  (256u << 10) /* of each, besides what its user's quotas are charged */
#define LOOKS     40
#define LOOKS_MAX 1000
/* Limits on a machine where others build: p99 beside, against alone, and so much on top.
 * The figure for a machine that is left alone is printed with --long. */
#define GENEROUS_TIMES 20.0
#define GENEROUS_MS    100.0

/* With --long: p99 beside, against alone or, where that is more, against processes that
 * burn as much of the processors as the animals themselves, which no daemon can prevent:
 * what is above is the daemon's fault. */
#define FAULT_TIMES 2.0

/* Beside animals that let the daemon compute for seconds an answer may take so much more:
 * what has run for 10 ms is taken for long, and another thread takes the next request. */
#define LONG_MS 20.0

static const struct zoo_animal animals[] = {
    {"says nothing", zoo_says_nothing, true, 0, 0, false},
    {"never reads", zoo_never_reads, false, 0, 0, false},
    {"floods", zoo_floods, false, 0, 0, false},
    {"sends 253 descriptors", zoo_sends_253_descriptors, false, 0, 0, false},
    {"sends wrong lengths", zoo_sends_wrong_lengths, false, 0, 0, false},
    {"uses stale handles", zoo_uses_stale_handles, false, 0, 0, false},
    {"rewrites submitted slots", zoo_rewrites_submitted_slots, false, 0, 0, false},
    {"batches nonsense", zoo_batches_nonsense, false, 0, 0, false},
    {"punches holes", zoo_punches_holes, false, 0, 0, false},
    {"lies about counts", zoo_lies_about_counts, false, 0, 0, false},
    {"sends wrong numbers", zoo_sends_wrong_numbers, false, 0, 0, false},
    {"names wrong indices", zoo_names_wrong_indices, false, 0, 0, false},
    {"submits without end", zoo_submits_without_end, false, 0, 0, false},
    {"cancels everything", zoo_cancels_everything, false, 0, 0, false},
    {"makes tiny scenes", zoo_makes_tiny_scenes, false, 0, 0, false},
    {"dies in the middle", zoo_dies_in_the_middle, false, 0, 0, false},
    {"stops itself", zoo_stops_itself, false, 0, 0, false},
    {"turns about", zoo_turns_about, false, 0, 0, true},
    {"stacks triangles", zoo_stacks_triangles, false, 0, 0, true},
    {"fans triangles out", zoo_fans_triangles_out, false, 0, 0, true},
    {"commits heaps", zoo_commits_heaps, false, 0, 0, true},
    {"asks for everything", zoo_asks_for_everything, false, 0, 0, true},
    {"thickens everything", zoo_thickens_everything, false, 0, 0, true},
    {"fights over a scene", zoo_fights_over_a_scene, false, 0, 0, false},
    {"names scenes", zoo_names_scenes, false, 0, 0, false},
    {"ignores every pair", zoo_ignores_every_pair, false, 0, 0, false},
    {"reads no news", zoo_reads_no_news, false, 0, 0, false},
    {"pries", zoo_pries, false, 0, 0, false},
};
#define ANIMALS (sizeof animals / sizeof animals[0])

static struct zoo_keeper keeper;
static struct zoo_held at_rest; /* before the first animal came */
static bool is_long;
static uint32_t requests = 200;
static unsigned each = 3;
static unsigned pause_ms = 300;

/* Return by how much the daemon's heap has grown for each of them, beyond what is
 * charged. */
static int64_t heap_of_each(const struct zoo_held *before, const struct zoo_held *now)
{
    int64_t heap = (int64_t)(now->heap_bytes - before->heap_bytes);
    int64_t charged = (int64_t)(now->engine_bytes - before->engine_bytes);

    return (heap - (charged > 0 ? charged : 0)) / (int64_t)each;
}

static bool is_light(const struct zoo_held *before, const struct zoo_held *now)
{
#ifdef PCCD_SANITIZED /* red zones and shadows are heap, too */
    (void)before, (void)now;
    return true;
#else
    return heap_of_each(before, now) <= HEAP_MAX;
#endif
}

/* When the heap holds least that nobody is charged for: it keeps what it has had, and
 * both numbers change while they are read. What is charged is seen only while they have
 * it, so where that was missed it is looked longer. */
static void look_while_they_act(const struct zoo_held *before, struct zoo_held *least)
{
    zoo_keeper_look(&keeper, least);
    for (int i = 1; i < LOOKS || (i < LOOKS_MAX && !is_light(before, least)); i++) {
        struct zoo_held now;

        test_sleep_ms(5);
        zoo_keeper_look(&keeper, &now);
        if ((int64_t)(now.heap_bytes - now.engine_bytes) <
            (int64_t)(least->heap_bytes - least->engine_bytes)) {
            *least = now;
        }
    }
}

/* The honest client's latencies of a round. */
struct rounds {
    struct zoo_times alone;
    struct zoo_times beside; /* the animals */
    struct zoo_times burned; /* beside processes that take as much of the processors */
};

static void report(const struct zoo_animal *animal, unsigned acts,
                   const struct rounds *rounds, int64_t heap)
{
    const struct zoo_times *alone = &rounds->alone;
    const struct zoo_times *beside = &rounds->beside;
    const struct zoo_times *burned = &rounds->burned;

    printf("# %-25s %7u acts  p99 %7.2f ms alone %7.2f beside %6.2fx  p50 %5.2fx  "
           "heap %+5lld KiB each",
           animal->name, acts, alone->p99_ms, beside->p99_ms,
           beside->p99_ms / alone->p99_ms, beside->p50_ms / alone->p50_ms,
           (long long)(heap >> 10));
    if (is_long) {
        printf("  against burners: p99 %7.2f ms %6.2fx  p50 %5.2fx", burned->p99_ms,
               beside->p99_ms / burned->p99_ms, beside->p50_ms / burned->p50_ms);
    }
    printf("\n");
    (void)fflush(stdout);
}

/* Work beside others who take as much of the processors as the animals do, which no
 * daemon can prevent. */
static bool work_beside_burners(const struct zoo_den *closed, unsigned acts,
                                struct zoo_times *times)
{
    const struct zoo_animal burner = zoo_burner(closed, acts);
    struct zoo_den den;
    bool worked = zoo_open(&den, &burner, keeper.daemon.socket, each, false, pause_ms) &&
                  zoo_keeper_work(&keeper, requests, times);

    return zoo_close(&den) > 0 && worked;
}

/* If it failed, this client would harm the daemon or those who share it: it would get
 * something else than its due, change or delay the answers of others, or take memory that
 * nobody is charged for. */
static void zoo__animal_gets_its_due_and_harms_nobody(void **state)
{
    const struct zoo_animal *animal = *state;
    struct zoo_den den;
    struct rounds rounds = {.alone = {.p99_ms = 0}};
    struct zoo_held before;
    struct zoo_held during;
    unsigned acts;
    bool worked;
    bool opened;

    assert_true(zoo_keeper_await(&keeper, &at_rest)); /* where the one before failed */
    zoo_keeper_look(&keeper, &before);
    assert_true(zoo_keeper_work(&keeper, requests, &rounds.alone));
    opened = zoo_open(&den, animal, keeper.daemon.socket, each, is_long, pause_ms);
    worked = opened && zoo_keeper_work(&keeper, requests, &rounds.beside);
    look_while_they_act(&before, &during);
    acts = zoo_close(&den);
    zoo_say(&den, animal);
    assert_true(opened);
    assert_true(worked);
    assert_true(acts >= each);
    assert_true(!is_long || work_beside_burners(&den, acts, &rounds.burned));
    report(animal, acts, &rounds, heap_of_each(&before, &during));
    assert_true(rounds.beside.p99_ms <=
                GENEROUS_TIMES * rounds.alone.p99_ms + GENEROUS_MS);
    double more_ms = animal->takes_long ? LONG_MS : 0;
    assert_true(!is_long ||
                rounds.beside.p99_ms <= FAULT_TIMES * rounds.alone.p99_ms + more_ms ||
                rounds.beside.p99_ms <= FAULT_TIMES * rounds.burned.p99_ms + more_ms);
    assert_true(is_light(&before, &during));
    assert_true(zoo_keeper_await(&keeper, &before));
}

static int start(void **state)
{
    (void)state;
    if (!zoo_keeper_start(&keeper, requests)) {
        return -1;
    }
    zoo_keeper_look(&keeper, &at_rest);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    return zoo_keeper_stop(&keeper) ? 0 : -1;
}

static unsigned long option(const char *name, unsigned long otherwise)
{
    const char *text = getenv(name);

    return text != NULL ? strtoul(text, NULL, 10) : otherwise;
}

int main(int argc, char **argv)
{
    struct CMUnitTest tests[ANIMALS];

    is_long = argc > 1 && strcmp(argv[1], "--long") == 0;
    requests = (uint32_t)option("ZOO_REQUESTS", is_long ? 20000 : 200);
    each = (unsigned)option("ZOO_EACH", each);
    pause_ms = (unsigned)option("ZOO_PAUSE_MS", is_long ? 60000 : pause_ms);
    each = each < 1 ? 1 : each > ZOO_EACH_MAX ? ZOO_EACH_MAX : each;
    for (size_t i = 0; i < ANIMALS; i++) {
        tests[i] = (struct CMUnitTest){
            .name = animals[i].name,
            .test_func = zoo__animal_gets_its_due_and_harms_nobody,
            .initial_state = (void *)(uintptr_t)&animals[i],
        };
    }
    if (getenv("ZOO_ONLY") != NULL) {
        cmocka_set_test_filter(getenv("ZOO_ONLY")); /* as "dies*" */
    }
    return cmocka_run_group_tests_name("zoo", tests, start, teardown);
}
