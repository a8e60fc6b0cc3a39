/* bounds.c - bounds of vertices.
 *
 * Source: proto/PROTOCOL.md, "The hash of an answer".
 */
#include "answer.h"

#include <math.h>
#include <stdlib.h>

#include "parts.h"
#include "rank_sort.h"

/* ---- back to where they were given ------------------------------------------------ */

/* Count how many bounds are in the cells of each rank: first[size + 1]. */
static void count_cells(const struct pccd_mpi *world, const uint64_t *cells,
                        uint64_t *first)
{
    for (int r = 0; r <= world->link.size; r++) {
        first[r] = cells[(uint64_t)r * world->plan.object_count];
    }
}

/* local[o][local.vertex_count] to given[o][vertex_count], the least of all ranks. */
static int bring_back(struct pccd_mpi *world, const double *const *local, double **given)
{
    struct ranks_link *link = &world->link;
    const struct ranks_plan *plan = &world->plan;
    uint64_t cells = (uint64_t)link->size * plan->object_count;
    uint64_t *first = ranks_array(2 * ((uint64_t)link->size + 1), sizeof *first);
    double *out = ranks_array(plan->in_first[cells], sizeof *out);
    double *in = ranks_array(plan->out_first[cells], sizeof *in);
    int status = ranks_agree_memory(world, first != NULL && out != NULL && in != NULL);
    if (status == PCCD_OK) {
        for (uint64_t cell = 0; cell < cells; cell++) {
            const double *from = local[cell % plan->object_count];
            for (uint64_t i = plan->in_first[cell]; i < plan->in_first[cell + 1]; i++) {
                out[i] = from[plan->in[i]];
            }
        }
        count_cells(world, plan->in_first, first);
        count_cells(world, plan->out_first, first + link->size + 1);
        status = ranks_swap(link, sizeof *out, out, first, in, first + link->size + 1);
    }
    for (uint64_t cell = 0; cell < cells && status == PCCD_OK; cell++) {
        double *to = given[cell % plan->object_count];
        for (uint64_t i = plan->out_first[cell]; i < plan->out_first[cell + 1]; i++) {
            to[plan->out[i]] = fmin(to[plan->out[i]], in[i]);
        }
    }
    free(first);
    free(out);
    free(in);
    return status;
}

/* ---- the answer ------------------------------------------------------------------- */

/* Find where the bounds of each object begin in libpccd's answer, which has one for an
 * object that has nothing here; PCCD_E_INTERNAL: they are not those. */
static int find_local(struct pccd_mpi *world, const double **local)
{
    uint64_t at = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_local *of = &world->objects[o]->local;
        local[o] = (const double *)world->records + at;
        at += of->leaf_count > 0 ? of->vertex_count : 1;
    }
    return at == world->record_count
               ? PCCD_OK
               : ranks_fail(&world->link, PCCD_E_INTERNAL,
                            "rank %d: bounds of other vertices than it has",
                            world->link.rank);
}

/* Those of one object, to world->bound_values in the order of its part, and to
 * world->bounds by number; they are added to *sums. */
static int keep(struct pccd_mpi *world, const struct ranks_object *object,
                const double *given, double distance, struct ranks_sums *sums)
{
    uint32_t count = object->mesh->vertex_count;
    struct ranks_key *keys = ranks_array(2 * (uint64_t)count, sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    double *values = world->bound_values + world->bound_count;
    for (uint32_t i = 0; i < count; i++) {
        values[i] = fmin(given[i], distance);
        keys[i] = (struct ranks_key){object->mesh->numbers[i], i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    for (uint32_t i = 0; i < count; i++) {
        struct ranks_bound *bound = &world->bounds[world->bound_count++];
        *bound = (struct ranks_bound){object->handle, (uint32_t)sorted[i].key,
                                      values[sorted[i].value]};
    }
    ranks_bounds_sum(world->bounds + world->bound_count - count, count, sums);
    free(keys);
    return PCCD_OK;
}

static int reserve(struct pccd_mpi *world, double **given)
{
    uint64_t total = 0;
    bool is_short = false;
    for (uint32_t o = 0; o < world->object_count; o++) {
        uint32_t count = world->objects[o]->mesh->vertex_count;
        given[o] = ranks_array(count, sizeof **given);
        is_short = is_short || given[o] == NULL;
        for (uint32_t i = 0; i < count && given[o] != NULL; i++) {
            given[o][i] = INFINITY;
        }
        total += count;
    }
    free(world->bounds);
    free(world->bound_values);
    world->bounds = ranks_array(total, sizeof *world->bounds);
    world->bound_values = ranks_array(total, sizeof *world->bound_values);
    is_short = is_short || world->bounds == NULL || world->bound_values == NULL;
    return is_short ? ranks_no_memory(world) : PCCD_OK;
}

/* The greatest of all that a pair has, in the whole scene. */
static double greatest(const struct pccd_mpi *world, double *const *given)
{
    double most = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        for (uint32_t i = 0; i < world->objects[o]->mesh->vertex_count; i++) {
            most = given[o][i] < INFINITY ? fmax(most, given[o][i]) : most;
        }
    }
    return most;
}

static int sum_up(struct pccd_mpi *world, struct ranks_sums *sums, double *most)
{
    int status = ranks_max_doubles(&world->link, most, 1);
    return status == PCCD_OK
               ? ranks_sum(&world->link, (uint64_t *)(void *)sums,
                           (int)(offsetof(struct ranks_sums, toi_first) / 8))
               : status;
}

/* given[o] are memory for bounds of given vertices, local[o] scratch. */
static int make(struct pccd_mpi *world, const struct pccd_near_settings *near,
                double **given, const double **local, struct pccd_answer *answer)
{
    struct ranks_sums sums = {.total = 0};
    int status = find_local(world, local);
    status = status == PCCD_OK ? reserve(world, given) : status;
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = bring_back(world, local, given);
    }
    if (status != PCCD_OK) {
        return status;
    }
    if (world->link.size > 1) { /* one rank alone does not know who has no pair */
        answer->distance_max = greatest(world, given);
    }
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        if (near->object_a == 0 || near->object_a == object->handle) {
            status = keep(world, object, given[o], near->distance, &sums);
        }
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = sum_up(world, &sums, &answer->distance_max);
    }
    answer->total = sums.total;
    ranks_records_hash(&sums, answer->hash);
    return status;
}

int ranks_bounds_make(struct pccd_mpi *world, const struct pccd_near_settings *near,
                      struct pccd_answer *answer)
{
    size_t objects = (size_t)world->object_count + 1;
    double **given = calloc(objects, sizeof *given);
    const double **local = calloc(objects, sizeof *local);
    int status = ranks_agree_memory(world, given != NULL && local != NULL);
    if (status == PCCD_OK) {
        status = make(world, near, given, local, answer);
    }
    for (uint32_t o = 0; o < world->object_count && given != NULL; o++) {
        free(given[o]);
    }
    free((void *)given);
    free((void *)local);
    world->record_count = 0;
    return status;
}
