/* fault.c - a world that fails on order: the orders. */
#include "fault.h"

static const char *const names[] = {"none",
#define FAULT_NAME(name) #name,
                                    FAULT_CALLS(FAULT_NAME)
#undef FAULT_NAME
};

const char *fault_name(enum fault_call call)
{
    return names[call];
}

void fault_order(struct fault_page *page, enum fault_call call, uint64_t first,
                 uint64_t length, int error)
{
    atomic_store(&page->call, FAULT_NONE);
    atomic_store(&page->first, first);
    atomic_store(&page->length, length);
    atomic_store(&page->error, error);
    atomic_store(&page->seen, 0);
    atomic_store(&page->hits, 0);
    atomic_store(&page->call, call);
}

uint64_t fault_recall(struct fault_page *page)
{
    atomic_store(&page->call, FAULT_NONE);
    return atomic_load(&page->hits);
}
