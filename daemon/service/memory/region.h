/* region.h - chooses where in the result region, a ring buffer in shared memory, the next
 * page of records goes.
 *
 * Hand out contiguous pages of a ring of bytes. Positions are counters that never wrap,
 * so that their difference is the fill; a page never wraps around the end of the ring.
 */
#ifndef SRV_REGION_H
#define SRV_REGION_H

#include <stdbool.h>
#include <stdint.h>

#define SRV_PAGE_ALIGN 64u /* pages begin on cache lines */

struct srv_region {
    uint64_t capacity; /* bytes, a multiple of SRV_PAGE_ALIGN */
    uint64_t tail;     /* bytes handed out, skipped ones included */
    uint64_t head;     /* bytes released, as last believed */
    uint64_t origin;   /* where the counters stood when position 0 was handed out last */
    uint64_t taken;    /* bytes from the start that have memory; the owner raises it */
    uint64_t limit;    /* bytes from the start that pages may use: taken .. capacity */
};

struct srv_page {
    uint64_t position; /* bytes from the start of the data */
    uint64_t count;    /* items that fit, 0 .. wanted */
    uint64_t release;  /* the head that releases this page and all before it */
};

void srv_region_init(struct srv_region *region, uint64_t capacity);

/* A ring whose bytes have no memory yet, but for the first `taken`. A page may then end
 * beyond them, and the owner gives it memory, or sets `limit` and reserves anew. */
void srv_region_init_sparse(struct srv_region *region, uint64_t capacity, uint64_t taken);

/* A page for up to `wanted` items of `item_bytes`, given the client's `head`: as many as
 * the longest free stretch holds, the stretch at hand preferred, but for one that has no
 * memory where the start has. An empty page takes no space. Returns 0, or PCCD_E_INVAL
 * when `head` went backwards or beyond what was handed out: then nothing changes. */
int srv_region_reserve(struct srv_region *region, uint64_t head, uint32_t item_bytes,
                       uint64_t wanted, struct srv_page *page);

/* How many bytes from the start the pages that the client has not released reach, given
 * its `head`: what lies behind is not used. All of them when `head` makes no sense. */
uint64_t srv_region_used(const struct srv_region *region, uint64_t head);

#endif
