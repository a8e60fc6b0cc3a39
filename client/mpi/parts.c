/* parts.c - a mesh in parts. */
#include "parts.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT_MAX      INT32_MAX
#define COORDINATE_MAX 1e18

/* ---- this rank alone -------------------------------------------------------------- */

static int check_numbers(struct pccd_mpi *world, const uint32_t *numbers, uint64_t count,
                         uint32_t width, uint32_t total, const char *what)
{
    for (uint64_t i = 0; i < count * width; i++) {
        if (numbers[i] >= total) {
            return ranks_fail(&world->link, PCCD_E_INDEX,
                              "rank %d: %s %" PRIu64 " names vertex %" PRIu32
                              ", the mesh has %" PRIu32,
                              world->link.rank, what, i / width, numbers[i], total);
        }
    }
    return PCCD_OK;
}

static double coordinate(const struct pccd_mpi_part *part, uint64_t at)
{
    return part->format == PCCD_FORMAT_F32 ? (double)((const float *)part->x)[at]
                                           : ((const double *)part->x)[at];
}

static int check_positions(struct pccd_mpi *world, const struct pccd_mpi_part *part)
{
    for (uint64_t i = 0; i < 3 * (uint64_t)part->vertex_count; i++) {
        if (!(fabs(coordinate(part, i)) <= COORDINATE_MAX)) {
            return ranks_fail(&world->link, PCCD_E_NOTFINITE,
                              "rank %d: vertex %" PRIu64 " of its part: a coordinate is "
                              "not finite or beyond 1e18",
                              world->link.rank, i / 3);
        }
    }
    for (uint32_t i = 0; part->radii != NULL && i < part->vertex_count; i++) {
        double radius = part->radii[i];
        if (!(radius >= 0 && radius < INFINITY) || radius > COORDINATE_MAX) {
            return ranks_fail(&world->link,
                              radius > 0 && radius < INFINITY ? PCCD_E_LIMIT
                                                              : PCCD_E_INVAL,
                              "rank %d: vertex %" PRIu32 " of its part: a radius is "
                              "negative, not finite or beyond 1e18",
                              world->link.rank, i);
        }
    }
    return PCCD_OK;
}

int ranks_part_check(struct pccd_mpi *world, const struct pccd_mpi_part *part)
{
    struct ranks_link *link = &world->link;
    bool lacks = (part->vertex_count > 0 && part->x == NULL) ||
                 (part->triangle_count > 0 && part->triangles == NULL) ||
                 (part->edge_count > 0 && part->edges == NULL) ||
                 (part->point_count > 0 && part->points == NULL);
    if (lacks || (unsigned)part->format >= PCCD_FORMAT_COUNT) {
        return ranks_fail(link, PCCD_E_INVAL,
                          "rank %d: its part lacks an array, or its format is unknown",
                          link->rank);
    }
    if (part->vertex_total > COUNT_MAX || part->triangle_total > COUNT_MAX) {
        return ranks_fail(link, PCCD_E_LIMIT,
                          "a mesh has at most %d vertices and triangles", COUNT_MAX);
    }
    uint32_t total = part->vertex_total;
    int status =
        check_numbers(world, part->triangles, part->triangle_count, 3, total, "triangle");
    if (status == PCCD_OK) {
        status = check_numbers(world, part->edges, part->edge_count, 2, total, "edge");
    }
    if (status == PCCD_OK) {
        status = check_numbers(world, part->points, part->point_count, 1, total, "point");
    }
    for (uint32_t i = 0; status == PCCD_OK && part->vertices && i < part->vertex_count;
         i++) {
        if (part->vertices[i] >= total) {
            status = ranks_fail(link, PCCD_E_INDEX,
                                "rank %d owns vertex %" PRIu32
                                ", but the mesh has only %" PRIu32,
                                link->rank, part->vertices[i], total);
        }
    }
    return status == PCCD_OK ? check_positions(world, part) : status;
}

/* ---- numbers that each rank has some of ------------------------------------------- */

/* Count how many of a thing the ranks before have, and all of them. */
static int count_before(struct pccd_mpi *world, uint32_t count, uint64_t *before,
                        uint64_t *total)
{
    struct ranks_link *link = &world->link;
    uint64_t *counts = ranks_array((uint64_t)link->size, sizeof *counts);
    int status = ranks_agree_memory(world, counts != NULL);
    if (status == PCCD_OK) {
        status = ranks_tell_all(link, count, counts);
    }
    *before = *total = 0;
    for (int r = 0; r < link->size && status == PCCD_OK; r++) {
        *before += r < link->rank ? counts[r] : 0;
        *total += counts[r];
    }
    free(counts);
    return status;
}

/* Each number 0 .. total - 1 is to be in exactly one part. */
struct claim {
    const char *what;        /* it is a number of */
    const uint32_t *numbers; /* of this rank's part; NULL: those after the ranks before */
    uint32_t count;          /* of these */
    uint32_t total, span;
    struct ranks_vertex_owner *owners; /* [span] of the directory, which are written */
    uint32_t *known;                   /* [count] the numbers, written; or NULL */
};

/* A number, and where it lies in whose part. */
struct named {
    uint32_t number;
    struct ranks_vertex_owner place;
};

/* In this rank alone. PCCD_E_INVAL: it has two owners or none. */
static int note_owners(struct pccd_mpi *world, const struct claim *claim,
                       const struct named *in, uint64_t in_count)
{
    struct ranks_link *link = &world->link;
    uint32_t base = (uint32_t)link->rank * claim->span;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < claim->span; i++) {
        claim->owners[i].rank = -1;
    }
    for (uint64_t i = 0; i < in_count; i++) {
        struct ranks_vertex_owner *place = &claim->owners[in[i].number - base];
        if (place->rank >= 0 && status == PCCD_OK) {
            status = ranks_fail(link, PCCD_E_INVAL,
                                "two owners of %s %" PRIu32 ": ranks %d and %d",
                                claim->what, in[i].number, place->rank, in[i].place.rank);
        }
        *place = in[i].place;
    }
    uint64_t end = (uint64_t)base + claim->span;
    end = end < claim->total ? end : claim->total;
    for (uint64_t i = base; i < end && status == PCCD_OK; i++) {
        if (claim->owners[i - base].rank < 0) {
            status = ranks_fail(link, PCCD_E_INVAL, "%s %" PRIu64 " is in no rank's part",
                                claim->what, i);
        }
    }
    return status;
}

/* Collective: the numbers of all parts to their directories. */
static int make_claim(struct pccd_mpi *world, const struct claim *claim)
{
    struct ranks_link *link = &world->link;
    const uint32_t *numbers = claim->numbers;
    uint64_t before, all, in_count;
    int status = count_before(world, claim->count, &before, &all);
    if (status == PCCD_OK && numbers == NULL && before + claim->count > claim->total) {
        status = ranks_fail(link, PCCD_E_INVAL,
                            "the parts have more than the %" PRIu32 " %s of the mesh",
                            claim->total, claim->what);
    }
    status = ranks_agree_on(link, status);
    if (status != PCCD_OK) {
        return status;
    }
    struct named *in = NULL;
    struct ranks_post post;
    ranks_post_begin(&post, sizeof *in, claim->count);
    for (uint32_t i = 0; i < claim->count; i++) {
        uint32_t number = numbers ? numbers[i] : (uint32_t)(before + i);
        if (claim->known != NULL) {
            claim->known[i] = number;
        }
        ranks_post_add(&post, number / claim->span,
                       &(struct named){number, {link->rank, i}});
    }
    status = ranks_post_deal(link, &post, (void **)&in, &in_count);
    if (status == PCCD_OK) {
        status = ranks_agree_on(link, note_owners(world, claim, in, in_count));
    }
    free(in);
    return status;
}

/* ---- the parts -------------------------------------------------------------------- */

static uint32_t span_of(uint32_t total, int size)
{
    uint32_t span = (total + (uint32_t)size - 1) / (uint32_t)size;
    return span > 0 ? span : 1;
}

static int copy_positions(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                          struct ranks_mesh *mesh)
{
    uint32_t count = part->vertex_count;
    mesh->vertex_count = count;
    mesh->x = ranks_array(count, sizeof *mesh->x);
    mesh->radii = mesh->has_radii ? ranks_array(count, sizeof *mesh->radii) : NULL;
    mesh->owners = ranks_array(mesh->span, sizeof *mesh->owners);
    mesh->numbers = ranks_array(count, sizeof *mesh->numbers);
    if (mesh->x == NULL || mesh->owners == NULL || mesh->numbers == NULL ||
        (mesh->has_radii && mesh->radii == NULL)) {
        return ranks_no_memory(world);
    }
    double *x = (double *)mesh->x;
    for (uint64_t i = 0; i < 3 * (uint64_t)count; i++) {
        x[i] = coordinate(part, i);
    }
    for (uint32_t i = 0; i < count && mesh->has_radii; i++) {
        mesh->radii[i] = part->radii != NULL ? part->radii[i] : 0;
    }
    return PCCD_OK;
}

/* Copy what is named: edges whose ends are the same are points. Numbers of edges and
 * points are written later. */
static int copy_named(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                      struct ranks_named *named)
{
    uint64_t count =
        (uint64_t)part->triangle_count + part->edge_count + part->point_count;
    struct ranks_leaf *leaf =
        count <= COUNT_MAX ? ranks_array(count, sizeof *leaf) : NULL;
    named->leaves = leaf;
    if (leaf == NULL) {
        return ranks_no_memory(world);
    }
    memset(leaf, 0, count * sizeof *leaf);
    for (uint32_t t = 0; t < part->triangle_count; t++, leaf++) {
        memcpy(leaf->v, part->triangles + 3 * (size_t)t, sizeof leaf->v);
        leaf->number = part->triangle_numbers ? part->triangle_numbers[t] : t;
    }
    named->triangle_count = part->triangle_count;
    for (uint32_t pass = 0; pass < 2; pass++) {
        for (uint32_t e = 0; e < part->edge_count; e++) {
            const uint32_t *ends = part->edges + 2 * (size_t)e;
            if ((ends[0] == ends[1]) == (pass == 1)) {
                *leaf++ = (struct ranks_leaf){.v = {ends[0], ends[1], ends[1]}};
                named->edge_count += pass == 0;
                named->point_count += pass == 1;
            }
        }
    }
    for (uint32_t i = 0; i < part->point_count; i++) {
        uint32_t v = part->points[i];
        *leaf++ = (struct ranks_leaf){.v = {v, v, v}};
        named->point_count++;
    }
    return PCCD_OK;
}

/* The numbers of all that is named here. */
static int number_named(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                        struct ranks_mesh *mesh, struct ranks_named *named)
{
    uint64_t triangles_before, edges_before, points_before, total, edges, points;
    int status = count_before(world, named->triangle_count, &triangles_before, &total);
    if (status == PCCD_OK) {
        status = count_before(world, named->edge_count, &edges_before, &edges);
    }
    if (status == PCCD_OK) {
        status = count_before(world, named->point_count, &points_before, &points);
    }
    if (status != PCCD_OK) {
        return status;
    }
    if (mesh->triangle_total + edges + points > COUNT_MAX ||
        mesh->triangle_total + edges + points == 0 || mesh->vertex_total == 0) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "a mesh has 1 to %d vertices, and as many triangles, edges and "
                          "points together",
                          COUNT_MAX);
    }
    mesh->edge_leaves = (uint32_t)edges;
    struct ranks_leaf *leaf = named->leaves;
    for (uint32_t t = 0; t < named->triangle_count; t++, leaf++) {
        leaf->number += part->triangle_numbers ? 0 : (uint32_t)triangles_before;
    }
    for (uint32_t e = 0; e < named->edge_count; e++, leaf++) {
        leaf->number = (uint32_t)(mesh->triangle_total + edges_before + e);
    }
    for (uint32_t p = 0; p < named->point_count; p++, leaf++) {
        leaf->number = (uint32_t)(mesh->triangle_total + edges + points_before + p);
    }
    return PCCD_OK;
}

/* Each triangle is in one part. */
static int claim_triangles(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                           uint32_t total)
{
    struct ranks_link *link = &world->link;
    uint32_t span = span_of(total, link->size);
    struct ranks_vertex_owner *owners = ranks_array(span, sizeof *owners);
    int status = owners == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t t = 0; part->triangle_numbers && t < part->triangle_count; t++) {
        if (status == PCCD_OK && part->triangle_numbers[t] >= total) {
            status = ranks_fail(link, PCCD_E_INDEX,
                                "rank %d has triangle %" PRIu32
                                ", but the mesh has only %" PRIu32,
                                link->rank, part->triangle_numbers[t], total);
        }
    }
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        const struct claim claim = {.what = "triangle",
                                    .numbers = part->triangle_numbers,
                                    .count = part->triangle_count,
                                    .total = total,
                                    .span = span,
                                    .owners = owners};
        status = make_claim(world, &claim);
    }
    free(owners);
    return status;
}

static int make(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                struct ranks_mesh *mesh, struct ranks_named *named)
{
    struct ranks_link *link = &world->link;
    uint8_t has_radii = part->radii != NULL && part->vertex_count > 0;
    int status = ranks_max_bytes(link, &has_radii, 1);
    if (status != PCCD_OK) {
        return status;
    }
    mesh->has_radii = has_radii;
    for (uint32_t i = 0; part->radii != NULL && i < part->vertex_count; i++) {
        mesh->radius_max = fmax(mesh->radius_max, part->radii[i]);
    }
    status = ranks_max_doubles(link, &mesh->radius_max, 1);
    if (status != PCCD_OK) {
        return status;
    }
    mesh->vertex_total = part->vertex_total;
    mesh->triangle_total = part->triangle_total;
    mesh->span = span_of(mesh->vertex_total, link->size);
    status = copy_positions(world, part, mesh);
    if (status == PCCD_OK) {
        status = copy_named(world, part, named);
    }
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = number_named(world, part, mesh, named);
    }
    if (status == PCCD_OK) {
        const struct claim claim = {.what = "vertex",
                                    .numbers = part->vertices,
                                    .count = part->vertex_count,
                                    .total = mesh->vertex_total,
                                    .span = mesh->span,
                                    .owners = mesh->owners,
                                    .known = mesh->numbers};
        status = make_claim(world, &claim);
    }
    if (status == PCCD_OK) {
        status = claim_triangles(world, part, mesh->triangle_total);
    }
    return status == PCCD_OK ? ranks_sides_find(world, mesh, named) : status;
}

int ranks_mesh_make(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                    struct ranks_mesh **mesh)
{
    struct ranks_mesh *made = calloc(1, sizeof *made);
    struct ranks_named named = {.leaves = NULL};
    int status = ranks_agree_memory(world, made != NULL);
    if (status == PCCD_OK) {
        status = make(world, part, made, &named);
    }
    if (status != PCCD_OK) {
        free(named.leaves);
        ranks_mesh_free(made);
        return status;
    }
    made->leaves = named.leaves;
    made->leaf_count = named.triangle_count + named.edge_count + named.point_count;
    *mesh = made;
    return PCCD_OK;
}
