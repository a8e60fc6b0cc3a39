/* balance.c - how evenly the work lies on the ranks, and what each leaf adds to it. */
#include "cut.h"

#include <math.h>
#include <stdlib.h>

#include "kinds.h"
#include "mpi_hooks.h"
#include "parts.h"

/* Beyond this the scene is cut anew, as soon as what was lost by it since the last cut is
 * as long as a cut takes. */
#define IMBALANCE_MAX 1.05

/* A new scene is cut beyond less than that, as it lasts: by its first step, and once more
 * by its second, as a cut changes what is to be done. */
#define IMBALANCE_NEW 1.02
#define CUTS_AT_ONCE  (1 + RANKS_CUTS_BY_WORK + 1)

/* Work of a pair that passes the filter, in box tests: in one process 102 and 14 ns, of
 * cloth-ball as of n-body. All other candidates together take less. */
#define SURVIVOR_WORK 8u

/* Positions and boxes take 40 ns for each leaf and ghost, in both. */
#define LEAF_WORK 3u

/* Where a pair passes the filter, more boxes are tested than elsewhere: by least squares
 * two, in cloth-ball over 8 ranks. With 1, 2 and 3 the recorded scenes over 8 ranks have
 * 1.093, 1.012 and 1.059 times the mean at most, over 2 ranks 1.004, 1.008 and 1.012. */
#define PAIR_WORK (SURVIVOR_WORK + 2u)

/* Weights are whole numbers; so much is one unit of work. */
#define WEIGHT_UNITS 16

static uint64_t work_of(const struct pccd_mpi *world,
                        const struct pccd_step_counters *counters)
{
    uint64_t leaves = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        leaves += (uint64_t)object->own_count + object->ghost_count;
    }
    return counters->box_tests + LEAF_WORK * leaves +
           SURVIVOR_WORK * (counters->survivors + counters->thick_survivors);
}

/* The most of all ranks, and what that is beside the mean. */
static int compare(struct pccd_mpi *world, uint64_t mine, double *most, double *imbalance)
{
    struct ranks_link *link = &world->link;
    uint64_t *all = ranks_array((uint64_t)link->size, sizeof *all);
    int status = ranks_agree_memory(world, all != NULL);
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

/* ---- weights of leaves ------------------------------------------------------------ */

/* For cli_mpi_weigh. The first feature of each pair is this rank's own. [team] */
static void count_pairs(void *weigher, const struct pccd_pair *pairs, uint32_t count)
{
    const struct pccd_mpi *world = weigher;
    for (uint32_t i = 0; i < count; i++) {
        const struct ranks_object *object = ranks_find_object(world, pairs[i].object_a);
        bool is_vertex = common_kinds[pairs[i].kind].points[0] == 1;
        uint32_t *pairs_of = is_vertex ? object->vertex_pairs : object->edge_pairs;
#pragma omp atomic
        pairs_of[pairs[i].feature_a]++;
    }
}

static void forget_pairs(struct pccd_mpi *world)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        free(object->vertex_pairs);
        free(object->edge_pairs);
        object->vertex_pairs = object->edge_pairs = NULL;
    }
}

int ranks_pairs_count_begin(struct pccd_mpi *world)
{
    bool is_short = false;
    for (uint32_t o = 0; o < world->object_count; o++) {
        struct ranks_object *object = world->objects[o];
        size_t vertices = (size_t)object->local.vertex_count + 1;
        size_t edges = (size_t)object->local.edge_count + 1;
        object->vertex_pairs = calloc(vertices, sizeof *object->vertex_pairs);
        object->edge_pairs = calloc(edges, sizeof *object->edge_pairs);
        is_short |= object->vertex_pairs == NULL || object->edge_pairs == NULL;
    }
    if (is_short) {
        forget_pairs(world);
        return ranks_no_memory(world);
    }
    cli_mpi_weigh(world->client, count_pairs, world);
    return PCCD_OK;
}

void ranks_pairs_count_end(struct pccd_mpi *world)
{
    cli_mpi_weigh(world->client, NULL, NULL);
}

/* Return how many pairs begin with features of an own leaf; corners: its local
 * vertices. */
static uint32_t pairs_of(const struct ranks_object *object, uint32_t leaf,
                         const uint32_t corners[3])
{
    const struct ranks_leaf *own = &object->own[leaf];
    const struct ranks_local *local = &object->local;
    uint32_t pairs = 0;
    for (uint32_t k = 0; k < 3; k++) {
        if (own->owns & RANKS_OWNS_CORNER(k)) {
            pairs += object->vertex_pairs[corners[k]];
        }
        if (own->owns & RANKS_OWNS_SIDE(k)) {
            pairs += object->edge_pairs[ranks_place_of(local->edges, local->edge_count,
                                                       own->side[k])];
        }
    }
    return pairs;
}

/* object->weights are the pairs of each own leaf, for now; they are added to *sum. */
static int sum_pairs(struct pccd_mpi *world, struct ranks_object *object, uint64_t *sum)
{
    uint32_t count = object->own_count;
    uint32_t(*corners)[3] = ranks_array(count, sizeof *corners);
    object->weights = ranks_array(count, sizeof *object->weights);
    int status =
        corners == NULL || object->weights == NULL
            ? ranks_no_memory(world)
            : ranks_local_corners(world, &object->local, object->own, count, corners);
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        object->weights[i] = pairs_of(object, i, corners[i]);
        *sum += object->weights[i];
    }
    free(corners);
    return status;
}

/* Make weights, `work` together, of the pairs of own leaves. Pairs have their
 * part; the rest, of leaves and ghosts and of boxes that are tested in vain, is even. */
static void scale(struct pccd_mpi *world, double leaves, double pairs, double work)
{
    double alone = fmax((work - PAIR_WORK * pairs) / fmax(leaves, 1), LEAF_WORK);
    double meeting = fmax(work - alone * leaves, 0) / fmax(pairs, 1);
    for (uint32_t o = 0; o < world->object_count; o++) {
        uint32_t *weights = world->objects[o]->weights;
        for (uint32_t i = 0; i < world->objects[o]->own_count; i++) {
            double weight = WEIGHT_UNITS * (alone + meeting * weights[i]);
            weights[i] = (uint32_t)fmin(ceil(weight), UINT32_MAX);
        }
    }
}

int ranks_leaves_weigh(struct pccd_mpi *world, const struct pccd_step_counters *counters,
                       bool *is_uneven)
{
    const uint64_t work = work_of(world, counters);
    uint64_t leaves = 0, pairs = 0;
    double most, imbalance = 1;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        leaves += world->objects[o]->own_count;
        status = sum_pairs(world, world->objects[o], &pairs);
    }
    forget_pairs(world);
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        scale(world, (double)leaves, (double)pairs, (double)work);
        status = compare(world, work, &most, &imbalance);
    }
    *is_uneven = imbalance > IMBALANCE_NEW;
    return status;
}

void ranks_weights_forget(struct pccd_mpi *world)
{
    forget_pairs(world);
    for (uint32_t o = 0; o < world->object_count; o++) {
        free(world->objects[o]->weights);
        world->objects[o]->weights = NULL;
    }
}

/* ---- balance ----------------------------------------------------------------------- */

void ranks_work_note(struct pccd_mpi *world, const struct pccd_step_counters *counters)
{
    world->share.work = work_of(world, counters);
}

int ranks_work_compare(struct pccd_mpi *world)
{
    double most;
    int status = compare(world, world->share.work, &most, &world->share.imbalance);
    world->right_work += most;
    return status;
}

void ranks_times_note(struct pccd_mpi *world, uint64_t step_ns, uint64_t cut_ns)
{
    if (cut_ns > 0) {
        world->cut_ns = cut_ns;
        world->lost_ns = 0;
        return;
    }
    world->lost_ns += (1 - 1 / world->share.imbalance) * (double)step_ns;
}

bool ranks_cut_is_due(const struct pccd_mpi *world)
{
    double imbalance = world->share.imbalance;
    if (world->link.size == 1) {
        return false;
    }
    return world->share.cuts < CUTS_AT_ONCE
               ? imbalance > IMBALANCE_NEW
               : imbalance > IMBALANCE_MAX && world->lost_ns > (double)world->cut_ns;
}
