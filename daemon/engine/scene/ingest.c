/* daemon/engine/scene/ingest.c - copy and check what another process may be writing.
 *
 * Room:     engine.
 * Does:     memcpy a block into cache-resident private memory, then convert and check
 *           that copy. The compiler barrier after the memcpy forbids re-reading the
 *           source.
 * Threads:  [any].
 */
#include "ingest.h"

#include <string.h>

#include "kernel.h"

#define BLOCK 512u /* vertices a block: 12 KiB of doubles, half of a small L1 cache */

/* Copy once: the compiler may not assume that `from` still holds the same bytes. */
static void copy_once(void *to, const void *from, size_t bytes)
{
    memcpy(to, from, bytes);
    __asm__ volatile("" : : : "memory");
}

int eng_ingest_positions(double (*out)[3], enum eng_format format, uint32_t count,
                         const void *source)
{
    const unsigned char *from = source;
    const struct eng_kernels *kernels = eng_kernels();
    float block[BLOCK * 3];
    for (uint32_t done = 0; done < count;) {
        uint32_t n = count - done < BLOCK ? count - done : BLOCK;
        double *to = out[done];
        bool good;
        if (format == ENG_F64) {
            copy_once(to, from, (size_t)n * 24u);
            from += (size_t)n * 24u;
            good = kernels->all_within(to, n * 3u, ENG_COORDINATE_MAX);
        } else {
            copy_once(block, from, (size_t)n * 12u);
            from += (size_t)n * 12u;
            good = kernels->widen_within(to, block, n * 3u, ENG_COORDINATE_MAX);
        }
        if (!good) {
            return ENG_E_NOTFINITE;
        }
        done += n;
    }
    return ENG_OK;
}

int eng_ingest_triangles(uint32_t (*out)[3], uint32_t count, uint32_t vertex_count,
                         const void *source, uint32_t *bad_triangle)
{
    const unsigned char *from = source;
    for (uint32_t done = 0; done < count;) {
        uint32_t n = count - done < BLOCK ? count - done : BLOCK;
        copy_once(out[done], from, (size_t)n * 12u);
        from += (size_t)n * 12u;
        for (uint32_t i = done; i < done + n; i++) {
            if (out[i][0] >= vertex_count || out[i][1] >= vertex_count ||
                out[i][2] >= vertex_count) {
                *bad_triangle = i;
                return ENG_E_INDEX;
            }
        }
        done += n;
    }
    return ENG_OK;
}

int eng_ingest_transform(double out[12], const void *source)
{
    copy_once(out, source, 12u * sizeof(double));
    return eng_kernels()->all_within(out, 12, ENG_COORDINATE_MAX) ? ENG_OK
                                                                  : ENG_E_NOTFINITE;
}
