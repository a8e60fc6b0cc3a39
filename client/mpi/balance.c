/* balance.c - work of the ranks. */
#include "cut.h"

#include <math.h>
#include <stdlib.h>

/* Beyond this the scene is cut anew, as soon as what was lost by it since the last cut is
 * as long as a cut takes. At once after a cut that knew nothing of work, and as long as
 * there were fewer than three cuts, as weights are a guess before work was counted. */
#define IMBALANCE_MAX 1.05

/* What passes the filter takes some times as long as a box test: in one process 102 and
 * 14 ns, of cloth-ball as of n-body. All other candidates together take less. */
#define SURVIVOR_WORK 8u

/* Positions and boxes take 40 ns for each leaf and ghost, in both. */
#define LEAF_WORK 3u

void balance_note(struct pccd_mpi *world, const struct pccd_step_counters *counters)
{
    uint64_t leaves = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        leaves += (uint64_t)object->own_count + object->ghost_count;
    }
    world->share.work = counters->box_tests + LEAF_WORK * leaves +
                        SURVIVOR_WORK * (counters->survivors + counters->thick_survivors);
}

/* The most of all ranks, and what that is beside the mean. */
static int compare(struct pccd_mpi *world, uint64_t mine, double *most, double *imbalance)
{
    struct ranks_link *link = &world->link;
    uint64_t *all = ranks_array((uint64_t)link->size, sizeof *all);
    int status = ranks_agree_on(link, all == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        status = ranks_tell_all(link, mine, all);
    }
    double sum = 0;
    *most = 0;
    for (int r = 0; r < link->size && status == PCCD_OK; r++) {
        sum += (double)all[r];
        *most = fmax(*most, (double)all[r]);
    }
    *imbalance = sum > 0 ? *most * link->size / sum : 1;
    free(all);
    return status;
}

int balance_guess(struct pccd_mpi *world, uint64_t weight, bool *is_uneven)
{
    double most, imbalance;
    int status = compare(world, weight, &most, &imbalance);
    *is_uneven = imbalance > IMBALANCE_MAX;
    return status;
}

int balance_tell(struct pccd_mpi *world)
{
    double most;
    int status = compare(world, world->share.work, &most, &world->share.imbalance);
    world->known_work = world->share.work;
    world->right_work += most;
    return status;
}

void balance_note_times(struct pccd_mpi *world, uint64_t step_ns, uint64_t cut_ns)
{
    if (cut_ns > 0) {
        world->cut_ns = cut_ns;
        world->lost_ns = 0;
        return;
    }
    world->lost_ns += (1 - 1 / world->share.imbalance) * (double)step_ns;
}

bool balance_wants_cut(const struct pccd_mpi *world)
{
    return world->link.size > 1 &&
           world->is_covered && /* else leaves cannot be weighed */
           world->share.imbalance > IMBALANCE_MAX &&
           (world->share.cuts < 3 || world->lost_ns > (double)world->cut_ns);
}
