/* schedule_serial.c - all task units by one thread.
 *
 * Source: paper section 4.1, "Serial CCD method".
 */
#include "schedule_paper.h"

#include "taskunit.h"
#include "trees.h"

void eng_schedule_serial(struct eng_worker *worker)
{
    uint32_t root = eng_trees_of(worker->scene)->root;
    struct eng_task_queue *units = &worker->units;
    if (root == ENG_NO_NODE) {
        return;
    }
    eng_taskunit_perform(worker, root, true);
    while (eng_units_count(units) > 0 && !eng_stop_is_set(worker->stop)) {
        eng_taskunit_perform(worker, (uint32_t)eng_units_take_newest(units), true);
    }
    eng_taskunit_flush(worker);
}
