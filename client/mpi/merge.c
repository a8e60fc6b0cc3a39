/* merge.c - closest features that several ranks have found. */
#include "answer.h"

#include <stdlib.h>

/* Take the own ones of the strays of all ranks, in order, to *own. */
static int take_own(struct pccd_mpi *world, struct pccd_near **own, uint64_t *own_count)
{
    struct ranks_link *link = &world->link;
    uint64_t *first = ranks_array((uint64_t)link->size + 1, sizeof *first);
    struct pccd_near *all = NULL;
    int status = ranks_agree_memory(world, first != NULL);
    if (status == PCCD_OK) {
        status = ranks_spread(link, sizeof *all, world->strays, world->stray_count,
                              (void **)&all, first);
    }
    *own_count = 0;
    for (uint64_t i = 0; status == PCCD_OK && i < first[link->size]; i++) {
        if (ranks_record_is_own(world, &all[i])) {
            all[(*own_count)++] = all[i];
        }
    }
    free(first);
    if (status != PCCD_OK) {
        return status;
    }
    ranks_records_sort(all, *own_count);
    *own = all;
    return PCCD_OK;
}

/* Two that are the same features: what they stand for is added up. */
static bool add_same(struct pccd_near *to, const struct pccd_near *from)
{
    if (ranks_record_compare(to, from) != 0) {
        return false;
    }
    to->count += from->count;
    return true;
}

/* Merge the records and more[count], both in order, to merged; returns how many. */
static uint64_t merge(const struct pccd_near *records, uint64_t record_count,
                      const struct pccd_near *more, uint64_t count,
                      struct pccd_near *merged)
{
    uint64_t i = 0, k = 0, each = 0;
    while (i < record_count || k < count) {
        bool takes_record =
            k == count ||
            (i < record_count && ranks_record_compare(&records[i], &more[k]) <= 0);
        const struct pccd_near *next = takes_record ? &records[i++] : &more[k++];
        if (each == 0 || !add_same(&merged[each - 1], next)) {
            merged[each++] = *next;
        }
    }
    return each;
}

int ranks_merge(struct pccd_mpi *world)
{
    struct pccd_near *own = NULL, *merged = NULL;
    uint64_t own_count = 0;
    int status = take_own(world, &own, &own_count);
    if (status == PCCD_OK) {
        merged = ranks_array(world->record_count + own_count, sizeof *merged);
        status = ranks_agree_memory(world, merged != NULL);
    }
    if (status == PCCD_OK) {
        uint64_t room = world->record_count + own_count;
        world->record_count =
            merge(world->records, world->record_count, own, own_count, merged);
        free(world->copied);
        world->records = world->copied = merged;
        world->copied_bytes = room * sizeof *merged;
        merged = NULL;
    }
    free(own);
    free(merged);
    world->stray_count = 0;
    return status;
}
