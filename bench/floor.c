/* floor.c - what this machine cannot do faster. */
#include "floor.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

#define ROUNDS   9u
#define CHAIN    200000u
#define LEAST_NS 2000000u

double bench_clock_ghz(void)
{
    double best = 0;
    for (unsigned round = 0; round < ROUNDS; round++) {
        uint64_t x = round + 3;
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < CHAIN; i++) {
            x *= x;
            __asm__ volatile("" : "+r"(x));
        }
        double ghz = 3.0 * CHAIN / (double)(common_now_ns() - begin_ns);
        best = ghz > best ? ghz : best;
    }
    return best;
}

/* `to` NULL: read `from`. Bytes are those of `from`. */
static double fastest_gbps(const char *from, char *to, size_t bytes)
{
    size_t times = ((size_t)8 << 20) / bytes + 1;
    double best = 0;
    uint64_t end_ns = common_now_ns() + LEAST_NS;
    for (unsigned round = 0; round < ROUNDS || common_now_ns() < end_ns; round++) {
        uint64_t begin_ns = common_now_ns();
        for (size_t i = 0; i < times; i++) {
            const void *done = to ? memcpy(to, from, bytes) : memchr(from, 2, bytes);
            __asm__ volatile("" : : "r"(done) : "memory");
        }
        double gbps = (double)(bytes * times) / (double)(common_now_ns() - begin_ns);
        best = gbps > best ? gbps : best;
    }
    return best;
}

double bench_copy_gbps(size_t bytes)
{
    size_t half = bytes / 2 + 64;
    char *from = bench_alloc(half, 1);
    char *to = bench_alloc(half, 1);
    memset(from, 1, half);
    memset(to, 1, half);
    double gbps = 2 * fastest_gbps(from, to, half);
    free(from);
    free(to);
    return gbps;
}

double bench_read_gbps(size_t bytes)
{
    char *from = bench_alloc(bytes, 1);
    memset(from, 1, bytes);
    double gbps = fastest_gbps(from, NULL, bytes);
    free(from);
    return gbps;
}

double bench_floor_ns(struct bench_cost cost, double ghz, double gbps)
{
    double compute = cost.operations / 2 / ghz;
    double memory = cost.bytes / gbps;
    return compute > memory ? compute : memory;
}
