/* paper_work.c - what the method `paper` keeps of each thread. */
#include "paper_work.h"

#include <assert.h>
#include <string.h>

#include "memory.h"
#include "pccd_types.h"

static int make(struct eng_worker *worker)
{
    struct eng_paper_work *work = eng_alloc(1, sizeof *work);
    if (!work) {
        return PCCD_E_NOMEM;
    }
    memset(work, 0, sizeof *work);
    worker->work[PCCD_METHOD_PAPER] = work;
    return PCCD_OK;
}

/* A region has at most as many triangles as the scene. */
static int reserve_split(struct eng_paper_work *work, const struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint32_t leaf_count =
        trees->root == ENG_NO_NODE ? 0 : trees->nodes[trees->root].count;
    uint32_t most = scene->settings.region_triangles;
    uint32_t capacity = leaf_count < most ? leaf_count : most;
    if (scene->settings.rebuild_ratio <= 0 || capacity <= work->split_capacity) {
        return PCCD_OK;
    }
    struct eng_split_item *items = eng_alloc(capacity, sizeof *items);
    if (!items) {
        return PCCD_E_NOMEM;
    }
    eng_free(work->split_items);
    work->split_items = items;
    work->split_capacity = capacity;
    return PCCD_OK;
}

int eng_paper_work_reserve(struct eng_worker *worker, const struct eng_scene *scene)
{
    int status = eng_paper_work_of(worker) ? PCCD_OK : make(worker);
    return status == PCCD_OK ? reserve_split(eng_paper_work_of(worker), scene) : status;
}

void eng_paper_work_free(struct eng_worker *worker)
{
    struct eng_paper_work *work = eng_paper_work_of(worker);
    if (work) {
        eng_free(work->split_items);
        eng_free(work);
        worker->work[PCCD_METHOD_PAPER] = NULL;
    }
}

uint64_t eng_paper_work_bytes(const struct eng_worker *worker)
{
    const struct eng_paper_work *work = eng_paper_work_of(worker);
    return work ? sizeof *work + work->split_capacity * sizeof *work->split_items : 0;
}

void eng_paper_work_begin(struct eng_worker *worker)
{
    assert(eng_paper_work_of(worker)); /* reserved */
    struct eng_paper_work *work = eng_paper_work_of(worker);
    work->units.head = 0;
    work->units.tail = 0;
    work->pairs.count = 0;
    for (unsigned kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        work->chunks[kind].count = 0;
    }
}
