/* region.c - pages of records in the result region. */
#include "ringio.h"

#include "invariant.h"
#include "pccd_types.h"

void srv_region_init(struct srv_region *region, uint64_t capacity)
{
    srv_region_init_sparse(region, capacity, capacity);
}

void srv_region_init_sparse(struct srv_region *region, uint64_t capacity, uint64_t taken)
{
    PCCD_ASSERT(capacity > 0 && capacity % SRV_PAGE_ALIGN == 0);
    PCCD_ASSERT(taken <= capacity);
    *region =
        (struct srv_region){.capacity = capacity, .taken = taken, .limit = capacity};
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* A page at the start may spare memory that one at hand would take. But what is left
 * before the end is lost then until the client has released all that stands there; so the
 * start must have room for more such pages than a client of libpccd holds (192). */
#define PAGES_AT_START 256u

static bool is_start_cheaper(const struct srv_region *region, uint64_t position,
                             uint64_t at_start, uint64_t bytes)
{
    return position + bytes > region->taken && at_start / PAGES_AT_START >= bytes;
}

int srv_region_reserve(struct srv_region *region, uint64_t head, uint32_t item_bytes,
                       uint64_t wanted, struct srv_page *page)
{
    PCCD_ASSERT(item_bytes > 0);
    if (head < region->head || head > region->tail) {
        return PCCD_E_INVAL;
    }
    region->head = head;
    /* Skipping to the start of an empty ring can make the fill exceed the capacity until
     * the client releases: then nothing is free. */
    uint64_t used = region->tail - head;
    uint64_t free_bytes = used < region->capacity ? region->capacity - used : 0;
    uint64_t position = (region->tail - region->origin) % region->capacity;
    /* An empty ring may begin anywhere: where there is memory. */
    if (used == 0 && wanted > 0 &&
        (wanted > region->capacity / item_bytes ||
         position + wanted * item_bytes > region->taken)) {
        region->origin = region->tail;
        position = 0;
    }
    uint64_t to_end = region->capacity - position;
    uint64_t here = free_bytes < to_end ? free_bytes : to_end;
    /* An empty ring is free from its start whatever lies before `position`. */
    uint64_t at_start = used == 0 ? region->capacity : free_bytes - here;
    here = least(here, region->limit > position ? region->limit - position : 0);
    at_start = least(at_start, region->limit);
    uint64_t items_here = here / item_bytes;
    uint64_t items_start = at_start / item_bytes;
    bool skip = items_here < wanted && items_start > items_here;
    if (used > 0 && wanted <= items_start) {
        skip = skip || is_start_cheaper(region, position, at_start, wanted * item_bytes);
    }

    uint64_t count = skip ? items_start : items_here;
    if (count > wanted) {
        count = wanted;
    }
    if (count == 0) {
        *page = (struct srv_page){.release = region->tail};
        return 0;
    }
    if (skip) {
        region->tail += to_end;
        position = 0;
    }
    uint64_t bytes = count * item_bytes;
    bytes += (SRV_PAGE_ALIGN - bytes % SRV_PAGE_ALIGN) % SRV_PAGE_ALIGN;
    region->tail += bytes;
    PCCD_ASSERT(position + bytes <= region->capacity);
    *page =
        (struct srv_page){.position = position, .count = count, .release = region->tail};
    return 0;
}

uint64_t srv_region_used(const struct srv_region *region, uint64_t head)
{
    if (head < region->head || head > region->tail) {
        return region->capacity;
    }
    if (head == region->tail) {
        return 0;
    }
    uint64_t begin = (head - region->origin) % region->capacity;
    uint64_t end = (region->tail - region->origin) % region->capacity;
    bool is_whole =
        head >= region->origin && begin < end && region->tail - head <= region->capacity;
    return is_whole ? end : region->capacity;
}
