/* part_weld.c - vertices at one place, of which each rank has a part.
 *
 * Find those that have another one near, by a table of bits that all ranks mark: each is
 * of a cell, in which mostly one vertex is. All ranks get these few, and join them as
 * pccdctl joins all.
 */
#include "part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "pccd.h"
#include "together.h"

#define CELLS    9u                  /* of a vertex, at most: around it, and its own */
#define CELL_MIN 1e-280              /* so that no number of a cell is infinite */
#define BITS_MAX ((uint64_t)1 << 33) /* MPI counts bytes by an int */

/* Vertices that have another one near, and where they are. */
struct search {
    struct part *part;
    double distance;             /* that is near */
    bool *is_used;               /* [vertices of the mesh] */
    unsigned char *once, *twice; /* bits: cells of one vertex, and of two */
    unsigned char *before;       /* those of one, in the ranks before */
    uint64_t mask;               /* how many bits, a power of two, less one */
    uint32_t *mine, mine_count;  /* of this rank's part, by their numbers in the mesh */
    double (*mine_x)[3];
    uint32_t *all, count; /* of all ranks, ascending */
    double (*x)[3];
    int *counts, *firsts;          /* of each rank's in all */
    MPI_Datatype place;            /* of one of them */
    struct pccd_weld *near, *same; /* within the distance; at one place, or NULL */
};

static int no_memory(const struct search *search, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory to join vertices",
                         search->part->files.mesh.path);
}

static void place_of(const struct ctl_mesh *mesh, uint32_t vertex, double x[3])
{
    const uint64_t first = (uint64_t)(vertex - mesh->part.vertex_first) * 3;
    for (uint64_t k = 0; k < 3; k++) {
        x[k] = common_coordinate(mesh->x, mesh->format, first + k);
    }
}

/* Unite on all ranks the bits that one of them has; or find the largest of numbers. Of
 * each there are fewer than 2^31, which MPI can count: bits are bytes of a table, or
 * vertices of a mesh (CTL_MESH_COUNT_MAX). */
static void unite(void *what, uint64_t count, MPI_Datatype type, MPI_Op op)
{
    MPI_Request request;
    MPI_Iallreduce(MPI_IN_PLACE, what, (int)count, type, op, MPI_COMM_WORLD, &request);
    together_wait(&request);
}

/* ---- what is near ------------------------------------------------------------------ */

static int begin(struct search *search, struct ctl_error *error)
{
    const struct ctl_mesh *shape = &search->part->files.mesh;
    const uint64_t total = shape->part.vertex_total;
    const size_t ranks = (size_t)together_size();
    const size_t own = (size_t)shape->vertex_count + 1;
    uint64_t bits = 64;
    while (bits < total * 8 && bits < BITS_MAX) {
        bits *= 2;
    }
    search->mask = bits - 1;
    search->is_used = calloc(total, sizeof *search->is_used);
    search->once = calloc(bits / 8, 1);
    search->twice = calloc(bits / 8, 1);
    search->before = calloc(bits / 8, 1);
    search->mine = malloc(own * sizeof *search->mine);
    search->mine_x = malloc(own * sizeof *search->mine_x);
    search->counts = calloc(ranks, sizeof *search->counts);
    search->firsts = calloc(ranks, sizeof *search->firsts);
    bool ok = search->is_used != NULL && search->once != NULL && search->twice != NULL &&
              search->before != NULL && search->mine != NULL && search->mine_x != NULL &&
              search->counts != NULL && search->firsts != NULL;
    return together_agree(ok ? PCCD_OK : no_memory(search, error), error);
}

/* Find the vertices that any rank's rows name; return 2^-40 of the size of their box. */
static double look_at_used(const struct search *search)
{
    const struct ctl_mesh *shape = &search->part->files.mesh;
    const uint32_t first = shape->part.vertex_first;
    double ends[2][3], x[3], size = 0; /* the highest, and the lowest times -1 */
    for (size_t kind = 0; kind < CTL_KINDS; kind++) {
        for (size_t i = 0; i < shape->lists[kind].count * (kind + 1); i++) {
            search->is_used[shape->lists[kind].vertices[i]] = true;
        }
    }
    unite(search->is_used, shape->part.vertex_total, MPI_BYTE, MPI_BOR);
    for (int k = 0; k < 3; k++) {
        ends[0][k] = ends[1][k] = -INFINITY;
    }
    for (uint32_t v = first; v < first + shape->vertex_count; v++) {
        place_of(shape, v, x);
        for (int k = 0; k < 3 && search->is_used[v]; k++) {
            ends[0][k] = x[k] > ends[0][k] ? x[k] : ends[0][k];
            ends[1][k] = -x[k] > ends[1][k] ? -x[k] : ends[1][k];
        }
    }
    unite(ends, 6, MPI_DOUBLE, MPI_MAX);
    for (int k = 0; k < 3; k++) {
        size = ends[0][k] + ends[1][k] > size ? ends[0][k] + ends[1][k] : size;
    }
    return size * 0x1p-40;
}

/* Bits of the cells that a vertex is in or near to. Two that are near have one in
 * common; others may, too, which does no harm. */
static uint32_t cells_of(const struct search *search, const double x[3],
                         uint64_t cells[CELLS])
{
    double distance = search->distance, ends[3][3];
    double width = distance > CELL_MIN / 4 ? 4 * distance : CELL_MIN;
    uint32_t count = 0;
    for (int k = 0; k < 3; k++) {
        for (int end = 0; end < 3; end++) {
            double at = x[k] + (end - 1) * distance;
            at = distance > 0 ? floor(at / width) : at;
            ends[end][k] = at == 0 ? 0 : at; /* -0 is 0 */
        }
    }
    for (unsigned corner = 0; corner < CELLS; corner++) {
        uint64_t hash = 0, word;
        bool is_new = true;
        for (unsigned k = 0; k < 3; k++) {
            unsigned end = corner == CELLS - 1 ? 1 : 2 * (corner >> k & 1);
            memcpy(&word, &ends[end][k], sizeof word);
            hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
            hash ^= hash >> 29;
        }
        for (uint32_t i = 0; i < count; i++) {
            is_new = is_new && cells[i] != (hash & search->mask);
        }
        if (is_new) {
            cells[count++] = hash & search->mask;
        }
    }
    return count;
}

/* Mark the cells of this rank's vertices; then, in another visit, list those vertices
 * that have a cell of two. */
static void visit(struct search *search, bool is_marking)
{
    const struct ctl_mesh *shape = &search->part->files.mesh;
    const uint32_t first = shape->part.vertex_first;
    for (uint32_t v = first; v < first + shape->vertex_count; v++) {
        uint64_t cells[CELLS];
        double x[3];
        bool is_near = false;
        place_of(shape, v, x);
        uint32_t count = search->is_used[v] ? cells_of(search, x, cells) : 0;
        for (uint32_t i = 0; i < count; i++) {
            const uint64_t at = cells[i] >> 3;
            const unsigned char bit = (unsigned char)(1u << (cells[i] & 7));
            is_near = is_near || (search->twice[at] & bit) != 0;
            if (is_marking) {
                search->twice[at] |= search->once[at] & bit;
                search->once[at] |= bit;
            }
        }
        if (is_near && !is_marking) {
            search->mine[search->mine_count++] = v;
        }
    }
}

/* Find the vertices that have another one near, of this rank or another. */
static void find_near(struct search *search)
{
    const uint64_t bytes = (search->mask + 1) / 8;
    MPI_Request request;
    visit(search, true);
    MPI_Iexscan(search->once, search->before, (int)bytes, MPI_BYTE, MPI_BOR,
                MPI_COMM_WORLD, &request);
    together_wait(&request);
    for (uint64_t i = 0; i < bytes && !together_is_root(); i++) {
        search->twice[i] |= search->once[i] & search->before[i];
    }
    unite(search->twice, bytes, MPI_BYTE, MPI_BOR);
    visit(search, false);
}

/* ---- where they are ---------------------------------------------------------------- */

/* Gather on all ranks what each has of these vertices. */
static void gather(const struct search *search, const void *mine, void *all,
                   MPI_Datatype type)
{
    MPI_Request request;
    MPI_Iallgatherv(mine, (int)search->mine_count, type, all, search->counts,
                    search->firsts, type, MPI_COMM_WORLD, &request);
    together_wait(&request);
}

static int gather_vertices(struct search *search, struct ctl_error *error)
{
    const int mine_count = (int)search->mine_count;
    MPI_Request request;
    MPI_Iallgather(&mine_count, 1, MPI_INT, search->counts, 1, MPI_INT, MPI_COMM_WORLD,
                   &request);
    together_wait(&request);
    for (int r = 0; r < together_size(); r++) {
        search->firsts[r] = (int)search->count;
        search->count += (uint32_t)search->counts[r];
    }
    search->all = malloc(((size_t)search->count + 1) * sizeof *search->all);
    search->x = malloc(((size_t)search->count + 1) * sizeof *search->x);
    bool ok = search->all != NULL && search->x != NULL;
    int status = together_agree(ok ? PCCD_OK : no_memory(search, error), error);
    if (status == PCCD_OK) {
        gather(search, search->mine, search->all, MPI_UINT32_T);
    }
    return status;
}

/* Join them as they are in the first frame, or part those that another one parts.
 * *joined: how many are yet, within the distance. */
static int look_at(struct search *search, const struct ctl_mesh *frame, uint32_t *joined,
                   struct ctl_error *error)
{
    struct pccd_weld_counts counts = {.joined = 0};
    for (uint32_t i = 0; i < search->mine_count; i++) {
        place_of(frame, search->mine[i], search->mine_x[i]);
    }
    gather(search, search->mine_x, search->x, search->place);
    int status = pccd_weld_frame(search->near, search->x, PCCD_FORMAT_F64);
    if (status == PCCD_OK && search->same != NULL) {
        status = pccd_weld_frame(search->same, search->x, PCCD_FORMAT_F64);
    }
    (void)pccd_weld_read(search->near, &counts);
    *joined = counts.joined;
    return together_agree(status == PCCD_OK ? status : no_memory(search, error), error);
}

static int look_at_all(struct search *search, double distance, struct ctl_error *error)
{
    struct part *part = search->part;
    const struct pccd_mesh_data all = {.vertex_count = search->count};
    uint32_t joined = 0;
    int status = pccd_weld_begin(&all, search->distance, false, &search->near);
    if (status == PCCD_OK && distance == 0) {
        status = pccd_weld_begin(&all, 0, false, &search->same);
    }
    status = together_agree(status == PCCD_OK ? status : no_memory(search, error), error);
    if (status == PCCD_OK) {
        status = look_at(search, &part->files.mesh, &joined, error);
    }
    for (uint32_t i = 1;
         i < part->files.welded.frame_count && status == PCCD_OK && joined > 0; i++) {
        struct ctl_mesh frame = {0};
        status = together_agree(part_read(part, i, &frame, error), error);
        if (status == PCCD_OK) {
            status = look_at(search, &frame, &joined, error);
        }
        ctl_mesh_deinit(&frame);
    }
    return status;
}

/* The least vertex that each of the mesh is joined to, if any is to another. */
static int take(struct search *search, uint32_t **to, struct ctl_error *error)
{
    const struct pccd_weld *chosen = search->same != NULL ? search->same : search->near;
    const uint32_t total = search->part->files.mesh.part.vertex_total;
    struct pccd_weld_counts counts = {.joined = 0}, near = {.joined = 0};
    const uint32_t *found = pccd_weld_read(chosen, &counts);
    (void)pccd_weld_read(search->near, &near);
    struct ctl_welded *welded = &search->part->files.welded;
    welded->joined = counts.joined;
    welded->apart = counts.apart;
    welded->more = near.joined - counts.joined;
    if (counts.joined == 0) {
        return PCCD_OK;
    }
    *to = malloc((size_t)total * sizeof **to);
    for (uint32_t i = 0; i < total && *to != NULL; i++) {
        (*to)[i] = i;
    }
    for (uint32_t i = 0; i < search->count && *to != NULL; i++) {
        (*to)[search->all[i]] = search->all[found[i]];
    }
    return together_agree(*to != NULL ? PCCD_OK : no_memory(search, error), error);
}

int part_weld(struct part *part, double distance, uint32_t **to, struct ctl_error *error)
{
    struct search search = {.part = part};
    int status = begin(&search, error);
    MPI_Type_contiguous(3, MPI_DOUBLE, &search.place);
    MPI_Type_commit(&search.place);
    if (status == PCCD_OK) {
        const double closeness = look_at_used(&search);
        search.distance = distance > 0 ? distance : closeness;
        part->files.welded.distance = closeness;
        find_near(&search);
        status = gather_vertices(&search, error);
    }
    if (status == PCCD_OK && search.count > 0) {
        status = look_at_all(&search, distance, error);
        status = status == PCCD_OK ? take(&search, to, error) : status;
    }
    MPI_Type_free(&search.place);
    free(search.is_used);
    free(search.once);
    free(search.twice);
    free(search.before);
    free(search.mine);
    free(search.mine_x);
    free(search.all);
    free(search.x);
    free(search.counts);
    free(search.firsts);
    pccd_weld_end(search.near);
    pccd_weld_end(search.same);
    return status;
}
