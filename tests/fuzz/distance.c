/* distance.c - exact distances of the engine against the oracle, for as long as wanted.
 */
#include <gmp.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz_distance.h"
#include "fuzz_jobs.h"
#include "fuzz_lanes.h"

#define ROUND 1000000u

/* The oracle makes and forgets some hundred integers a case. They come from a block that
 * begins again whenever none is left: with malloc a case takes a quarter more time. */
#define BLOCK_BYTES (4u << 20)
#define ALIGNMENT   16u

static struct {
    _Alignas(ALIGNMENT) char bytes[BLOCK_BYTES];
    size_t used;
    size_t live; /* numbers */
} block;

static void *take(size_t bytes)
{
    void *taken = block.bytes + block.used;
    block.used += (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    block.live++;
    if (block.used > BLOCK_BYTES) {
        fprintf(stderr, "a case takes more than %u bytes\n", BLOCK_BYTES);
        abort();
    }
    return taken;
}

static void leave(void *taken, size_t bytes)
{
    (void)taken;
    (void)bytes;
    if (--block.live == 0) {
        block.used = 0;
    }
}

static void *take_again(void *taken, size_t old_bytes, size_t bytes)
{
    void *more = take(bytes);
    block.live--;
    return memcpy(more, taken, old_bytes < bytes ? old_bytes : bytes);
}

static void print(const struct fuzz_distance_run *run, uint64_t seed)
{
    static const char *const types[4] = {"VF", "EE", "VE", "VV"};
    printf("seed %" PRIu64 ": %" PRIu64 " cases, %" PRIu64 " failures; %" PRIu64
           " within d, %" PRIu64 " crossings, %" PRIu64 " inside, %" PRIu64
           " on the surface;",
           seed, run->cases, run->failures, run->within, run->crossings, run->inside,
           run->on_surface);
    for (int i = 0; i < 4; i++) {
        printf(" %s %" PRIu64, types[i], run->types[i]);
    }
    printf("\n");
    fflush(stdout);
}

static void print_families(const struct fuzz_distance_run *run)
{
    for (int i = 0; i < FUZZ_DISTANCE_FAMILIES; i++) {
        double percent =
            100.0 / (double)(run->family_cases[i] ? run->family_cases[i] : 1);
        printf("  %-10s %10" PRIu64
               " cases, decided by doubles %5.1f %%, pairs %5.1f %%, integers %5.1f %%\n",
               fuzz_distance_name((enum fuzz_distance_family)i), run->family_cases[i],
               percent * (double)run->stages[i][0], percent * (double)run->stages[i][1],
               percent * (double)run->stages[i][2]);
    }
    fflush(stdout);
}

static void print_lanes(const struct fuzz_lanes_run *run, uint64_t seed)
{
    printf("seed %" PRIu64 ", in lanes: %" PRIu64 " cases, %" PRIu64 " failures; %" PRIu64
           " beyond d, %" PRIu64 " farther, %" PRIu64 " sure, %" PRIu64 " vague, %" PRIu64
           " open; %" PRIu64 " crossings, %" PRIu64 " not, %" PRIu64 " open\n",
           seed, run->cases, run->failures, run->beyond, run->measured, run->sure,
           run->vague, run->open, run->crossings, run->past, run->open_crossings);
    fflush(stdout);
}

/* Cases one at a time, and as many in chunks, by turns, until one has failed. The first
 * job tells of the families. */
static int work(uint64_t seed, uint64_t count, long job)
{
    static struct fuzz_distance_run run;
    static struct fuzz_lanes_run lanes;
    fuzz_distance_init(&run, seed, stdout);
    fuzz_lanes_init(&lanes, seed, stdout);
    while (run.cases < count && run.failures + lanes.failures == 0) {
        uint64_t left = count - run.cases;
        fuzz_distance_more(&run, left < ROUND ? left : ROUND);
        print(&run, seed);
        /* A chunk has FUZZ_LANES_MAX / 2 cases on average. */
        left = run.cases < lanes.cases ? 0 : run.cases - lanes.cases;
        fuzz_lanes_more(&lanes, left * 2 / FUZZ_LANES_MAX + 1);
        print_lanes(&lanes, seed);
    }
    if (job == 0) {
        print_families(&run);
    }
    fuzz_lanes_deinit(&lanes);
    fuzz_distance_deinit(&run);
    return run.failures + lanes.failures > 0;
}

int main(int argc, char **argv)
{
    struct fuzz_jobs jobs = fuzz_jobs_begin();
    bool is_right = true;
    for (int i = 1; i < argc; i++) {
        is_right &= fuzz_jobs_take(&jobs, argc, argv, &i);
    }
    if (!is_right || !fuzz_jobs_are_right(&jobs)) {
        fprintf(stderr, "usage: %s [--cases N] [--seed N] [--jobs 1..%d]\n", argv[0],
                FUZZ_JOBS_MAX);
        return 2;
    }
    mp_set_memory_functions(take, take_again, leave);
    return fuzz_jobs_run(work, &jobs);
}
