/* first.c - the earliest contact of a step that all ranks compute together. */
#include "part.h"

#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "together.h"

#define COORDINATES 3u

/* A rank's earliest contact, with the vertices of its features. */
struct candidate {
    struct pccd_contact contact;
    uint32_t corners[2][3];
};

/* Return whether a contact comes before another one: by its time, then in the order of
 * the answer. */
static bool is_before(const struct pccd_contact *a, const struct pccd_contact *b)
{
    return a->toi != b->toi               ? a->toi < b->toi
           : a->kind != b->kind           ? a->kind < b->kind
           : a->object_a != b->object_a   ? a->object_a < b->object_a
           : a->feature_a != b->feature_a ? a->feature_a < b->feature_a
           : a->object_b != b->object_b   ? a->object_b < b->object_b
                                          : a->feature_b < b->feature_b;
}

/* Find the earliest of all ranks. */
static int choose(const struct candidate *mine, struct candidate *earliest,
                  struct ctl_error *error)
{
    const size_t count = (size_t)together_size();
    struct candidate *all = malloc(count * sizeof *all);
    int status = together_agree(
        all != NULL ? PCCD_OK
                    : ctl_error_set(error, PCCD_E_NOMEM, "no memory for contacts"),
        error);
    if (status == PCCD_OK &&
        MPI_Allgather(mine, sizeof *mine, MPI_BYTE, all, sizeof *mine, MPI_BYTE,
                      MPI_COMM_WORLD) != MPI_SUCCESS) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "MPI has failed");
    }
    *earliest = *mine;
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        if (is_before(&all[i].contact, &earliest->contact)) {
            *earliest = all[i];
        }
    }
    free(all);
    return status;
}

/* Add the coordinates of a vertex, if this rank has it: of all ranks one does. */
static void add_vertex(const struct ctl_mesh *mesh, uint32_t vertex, double *x)
{
    uint32_t at = vertex - mesh->part.vertex_first;
    for (uint32_t k = 0; k < COORDINATES && at < mesh->vertex_count; k++) {
        size_t i = COORDINATES * (size_t)at + k;
        x[k] = mesh->format == PCCD_FORMAT_F32 ? (double)((const float *)mesh->x)[i]
                                               : ((const double *)mesh->x)[i];
    }
}

/* Gather where the vertices of both features are at both ends of the step. */
static int gather_ends(const struct candidate *candidate,
                       const struct ctl_mesh *const frames[2],
                       struct place_feature ends[2], struct ctl_error *error)
{
    double x[2][2][3][COORDINATES] = {{{{0}}}};
    const uint32_t *points = common_kinds[candidate->contact.kind].points;
    for (uint32_t side = 0; side < 2; side++) {
        for (uint32_t i = 0; i < points[side]; i++) {
            add_vertex(frames[0], candidate->corners[side][i], x[side][0][i]);
            add_vertex(frames[1], candidate->corners[side][i], x[side][1][i]);
        }
    }
    if (MPI_Allreduce(MPI_IN_PLACE, x, sizeof x / sizeof(double), MPI_DOUBLE, MPI_SUM,
                      MPI_COMM_WORLD) != MPI_SUCCESS) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "MPI has failed");
    }
    for (uint32_t side = 0; side < 2; side++) {
        memcpy(ends[side].corners, candidate->corners[side], sizeof ends[side].corners);
        memcpy(ends[side].from, x[side][0], sizeof ends[side].from);
        memcpy(ends[side].to, x[side][1], sizeof ends[side].to);
    }
    return PCCD_OK;
}

int first_find(struct pccd_mpi *world, const struct pccd_contact *mine,
               const struct ctl_mesh *const frames[2], const struct objects *objects,
               struct report_first *first, struct ctl_error *error)
{
    struct candidate own = {.contact = *mine}, earliest;
    struct place_feature ends[2];
    const bool has_one = mine->toi <= 1 && mine->kind < COMMON_KIND_COUNT;
    int status = PCCD_OK;
    for (uint32_t side = 0; side < 2 && has_one && status == PCCD_OK; side++) {
        status = pccd_mpi_feature(world, side == 0 ? mine->object_a : mine->object_b,
                                  common_kinds[mine->kind].points[side],
                                  side == 0 ? mine->feature_a : mine->feature_b,
                                  own.corners[side]);
    }
    if (status != PCCD_OK) {
        (void)ctl_error_set(error, status, "%s", pccd_mpi_error_text(world));
    }
    status = together_agree(status, error);
    status = status == PCCD_OK ? choose(&own, &earliest, error) : status;
    if (status != PCCD_OK || earliest.contact.toi > 1 ||
        earliest.contact.kind >= COMMON_KIND_COUNT) { /* of a newer daemon: no place */
        return status;
    }
    status = gather_ends(&earliest, frames, ends, error);
    if (status == PCCD_OK) {
        check_run_set_first(objects, &earliest.contact, ends, first);
    }
    return status;
}
