/* ingest.c - copy and check what another process may be writing. */
#include "ingest.h"

#include <assert.h>
#include <omp.h>
#include <stdatomic.h>
#include <string.h>

#include "coordinates.h"
#include "kernel.h"
#include "parallel.h"
#include "wait.h"

#define BLOCK 512u /* vertices a block: 12 KiB of doubles, half of a small L1 cache */

/* Positions that a thread of a team takes at a time, some 10 us, and those from which on
 * a team is woken: the step that follows needs it. */
#define TEAM_CHUNK 2048u
#define TEAM_MIN   8192u

/* Copy once: the compiler may not assume that `from` still holds the same bytes. */
static void copy_once(void *to, const void *from, size_t bytes)
{
    memcpy(to, from, bytes);
    __asm__ volatile("" : : : "memory");
}

int eng_ingest_positions(double (*out)[3], enum pccd_format format, uint32_t count,
                         const void *source, struct eng_bounds *bounds)
{
    assert(count == 0 || (out && source));
    const unsigned char *from = source;
    const struct eng_kernels *kernels = eng_kernels();
    float block[BLOCK * 3];
    for (uint32_t done = 0; done < count;) {
        uint32_t n = count - done < BLOCK ? count - done : BLOCK;
        double *to = out[done];
        bool good;
        if (format == PCCD_FORMAT_F64) {
            if (from != (const unsigned char *)to) {
                copy_once(to, from, (size_t)n * 24u);
            }
            from += (size_t)n * 24u;
            good = kernels->all_within(to, n * 3u, PROTO_COORDINATE_MAX);
        } else {
            copy_once(block, from, (size_t)n * 12u);
            from += (size_t)n * 12u;
            good = kernels->widen_within(to, block, n * 3u, PROTO_COORDINATE_MAX);
        }
        if (!good) {
            return PCCD_E_NOTFINITE;
        }
        if (bounds) {
            kernels->bound_positions((const double(*)[3])out + done, n, bounds);
        }
        done += n;
    }
    return PCCD_OK;
}

/* Positions first .. of a team's copy. */
static int ingest_chunk(double (*out)[3], enum pccd_format format, uint32_t count,
                        const void *source, uint32_t first, struct eng_bounds *bounds)
{
    size_t bytes = common_vertex_bytes(format);
    uint32_t n = count - first < TEAM_CHUNK ? count - first : TEAM_CHUNK;
    return eng_ingest_positions(out + first, format, n,
                                (const unsigned char *)source + first * bytes, bounds);
}

int eng_ingest_by_team(double (*out)[3], enum pccd_format format, uint32_t count,
                       const void *source, struct eng_copiers copiers,
                       struct eng_bounds *bounds)
{
    assert(copiers.threads >= 1);
    if (copiers.threads < 2 || count < TEAM_MIN) {
        return eng_ingest_positions(out, format, count, source, bounds);
    }
    uint32_t chunks = (count + TEAM_CHUNK - 1) / TEAM_CHUNK;
    uint32_t threads = copiers.threads;
    atomic_uint next;
    atomic_uint ended;
    atomic_int status;
    atomic_init(&next, 0);
    atomic_init(&ended, 0);
    atomic_init(&status, PCCD_OK);
    struct eng_parallel region = eng_parallel_open();
#pragma omp parallel num_threads((int)threads)
    {
        ENG_PARALLEL_JOIN(region);
        uint32_t thread = (uint32_t)omp_get_thread_num();
        uint32_t team_count = (uint32_t)omp_get_num_threads();
        struct eng_bounds seen = ENG_NO_BOUNDS;
        eng_affinity_bind_thread(copiers.affinity, thread, team_count);
        for (uint32_t i = atomic_fetch_add_explicit(&next, 1, memory_order_relaxed);
             i < chunks; i = atomic_fetch_add_explicit(&next, 1, memory_order_relaxed)) {
            int failed = ingest_chunk(out, format, count, source, i * TEAM_CHUNK, &seen);
            if (failed != PCCD_OK) {
                atomic_store_explicit(&status, failed, memory_order_relaxed);
            }
        }
#pragma omp critical(eng_ingest_bounds)
        eng_bounds_unite(bounds, &seen);
        /* The runtime's barrier would lend nobody a processor: where another burns, the
         * copy of one chunk took up to 7 ms. */
        atomic_fetch_add_explicit(&ended, 1, memory_order_acq_rel);
        eng_wait_plainly(copiers.affinity, thread, &ended, team_count);
    } /* the end of the region orders all copies before what follows */
    eng_parallel_close();
    return atomic_load_explicit(&status, memory_order_relaxed);
}

int eng_ingest_triangles(uint32_t (*out)[3], uint32_t count, uint32_t vertex_count,
                         const void *source, uint32_t *bad_triangle)
{
    assert(count == 0 || (out && source));
    const unsigned char *from = source;
    for (uint32_t done = 0; done < count;) {
        uint32_t n = count - done < BLOCK ? count - done : BLOCK;
        copy_once(out[done], from, (size_t)n * 12u);
        from += (size_t)n * 12u;
        for (uint32_t i = done; i < done + n; i++) {
            if (out[i][0] >= vertex_count || out[i][1] >= vertex_count ||
                out[i][2] >= vertex_count) {
                *bad_triangle = i;
                return PCCD_E_INDEX;
            }
        }
        done += n;
    }
    return PCCD_OK;
}

int eng_ingest_corners(uint32_t (*out)[3], uint32_t points, uint32_t count,
                       uint32_t vertex_count, const void *source, uint32_t *bad)
{
    assert(points >= 1 && points <= 2 && (count == 0 || (out && source)));
    const unsigned char *from = source;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t v[2];
        copy_once(v, from, points * sizeof *v);
        from += points * sizeof *v;
        v[1] = v[points - 1];
        if (v[0] >= vertex_count || v[1] >= vertex_count) {
            *bad = i;
            return PCCD_E_INDEX;
        }
        out[i][0] = v[0];
        out[i][1] = v[1];
        out[i][2] = v[1];
    }
    return PCCD_OK;
}

void eng_ingest_bytes(void *out, const void *source, size_t bytes)
{
    copy_once(out, source, bytes);
}

int eng_ingest_transform(double out[12], const void *source)
{
    assert(out && source);
    copy_once(out, source, 12u * sizeof(double));
    return eng_kernels()->all_within(out, 12, PROTO_COORDINATE_MAX) ? PCCD_OK
                                                                    : PCCD_E_NOTFINITE;
}
