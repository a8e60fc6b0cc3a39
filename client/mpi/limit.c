/* limit.c - answers that are too long. */
#include "limit.h"

#include "records.h"

#define NAME_BITS (32 * RANKS_NAME_WORDS)

/* Of this rank's records, how many come before a name. */
static uint64_t count_before(const struct pccd_mpi *world,
                             const uint32_t name[RANKS_NAME_WORDS])
{
    size_t bytes = ranks_record_bytes(world->mode);
    uint64_t from = 0, end = world->record_count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        uint32_t of_record[RANKS_NAME_WORDS];
        ranks_record_name((const char *)world->records + middle * bytes, world->mode,
                          of_record);
        if (ranks_name_is_before(of_record, name)) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from;
}

int ranks_limit_keep(struct pccd_mpi *world)
{
    uint32_t name[RANKS_NAME_WORDS] = {0};
    int status = PCCD_OK;
    /* The greatest name with at most so many records before it. */
    for (uint32_t bit = 0; bit < NAME_BITS && status == PCCD_OK; bit++) {
        uint32_t *word = &name[bit / 32], mask = UINT32_C(1) << (31 - bit % 32);
        *word |= mask;
        uint64_t before = count_before(world, name);
        status = ranks_sum(&world->link, &before, 1);
        if (before > world->record_limit) {
            *word &= ~mask;
        }
    }
    if (status == PCCD_OK) {
        world->record_count = count_before(world, name);
    }
    return status;
}
