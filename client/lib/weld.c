/* weld.c - vertices at one place. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client.h"
#include "coordinates.h"
#include "rounding.h"

#define NONE       UINT32_MAX
#define CELL_MIN   1e-280 /* so that no number of a cell is infinite */
#define MASK_MIN   1023u
#define MORE_RATIO 0x1p-40

struct places {
    const void *x;
    enum pccd_format format;
};

/* The vertices that are joined at one distance. */
struct joining {
    double distance;
    uint32_t *to; /* [vertex_count]: the least vertex that each is one with */
    uint32_t
        *list; /* those that may be parted yet, and from which; ascending; behind `to`.
                       Before the first frame: what is named, and `to` of each is 0 */
    uint32_t list_count;
    float *reach; /* [vertex_count], behind the list: how far each has been, in units of
                     the distance and rounded up, from the one that it is one with */
    uint32_t first_joined, joined; /* in the first frame; in all so far */
};

struct pccd_weld {
    uint32_t vertex_count;
    bool tells_more;
    double more_distance; /* 0: nothing is told of it */
    uint32_t
        joining_count; /* 0 before the first frame; the last is what was asked for, */
    struct joining joins[2]; /* and before it there may be one at more_distance */
};

/* The vertices of a list that are joined to none in this frame, by where they are and
 * what they were one with before. */
struct cells {
    const struct joining *joining;
    const struct places *places;
    double width;
    uint32_t mask;
    uint32_t *heads; /* [mask + 1]: places in the list; NONE: none */
    uint32_t *next;  /* [list_count] */
    uint32_t *group; /* [list_count]: `to` before this frame */
};

static int no_memory(size_t count)
{
    return cli_fail(NULL, PCCD_E_NOMEM, "no memory to join %zu vertices", count);
}

static void place_of(const struct places *places, uint32_t vertex, double x[3])
{
    for (size_t k = 0; k < 3; k++) {
        size_t index = (size_t)vertex * 3 + k;
        x[k] = places->format == PCCD_FORMAT_F32
                   ? (double)((const float *)places->x)[index]
                   : ((const double *)places->x)[index];
    }
}

/* Return the square of how far two places are apart, in units of the distance. With the
 * distance 0 it is infinite, or no number, unless they are equal. */
static double apart(const double a[3], const double b[3], double distance)
{
    double sum = 0;
    if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) {
        return 0;
    }
    for (int k = 0; k < 3; k++) {
        double way = (a[k] - b[k]) / distance;
        sum += way * way;
    }
    return sum;
}

/* Return how far two vertices have been apart at most in the frames before this one: both
 * were one with the same vertex. */
static float reach_of(const struct joining *joining, uint32_t a, uint32_t b)
{
    return joining->reach[a] + joining->reach[b];
}

/* The chain of a cell; 0 and -0 are one number. */
static uint32_t *chain_of(const struct cells *cells, const double cell[3], uint32_t group)
{
    uint64_t hash = group;
    for (int k = 0; k < 3; k++) {
        double number = cell[k] == 0 ? 0 : cell[k];
        uint64_t bits;
        memcpy(&bits, &number, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return &cells->heads[(uint32_t)(hash >> 8) & cells->mask];
}

static void cell_at(const struct cells *cells, const double x[3], double shift,
                    double cell[3])
{
    for (int k = 0; k < 3; k++) {
        cell[k] =
            cells->joining->distance > 0 ? floor((x[k] + shift) / cells->width) : x[k];
    }
}

/* The first of the list that the one at `at` can be joined to; itself: none before it. */
static uint32_t find(const struct cells *cells, uint32_t at, const double x[3])
{
    const struct joining *joining = cells->joining;
    uint32_t group = cells->group[at], best = at;
    double ends[2][3], cell[3], there[3];
    cell_at(cells, x, -joining->distance, ends[0]);
    cell_at(cells, x, joining->distance, ends[1]);
    for (unsigned corner = 0; corner < 8; corner++) {
        bool is_new = true;
        for (unsigned k = 0; k < 3; k++) {
            unsigned end = corner >> k & 1;
            cell[k] = ends[end][k];
            is_new = is_new && (end == 0 || ends[1][k] != ends[0][k]);
        }
        for (uint32_t other = is_new ? *chain_of(cells, cell, group) : NONE;
             other != NONE; other = cells->next[other]) {
            if (other < best && cells->group[other] == group &&
                reach_of(joining, joining->list[at], joining->list[other]) <= 1) {
                place_of(cells->places, joining->list[other], there);
                best = apart(x, there, joining->distance) <= 1 ? other : best;
            }
        }
    }
    return best;
}

/* Keep how far a vertex, which is at x, has been from the one that it is joined to. */
static void keep_reach(struct joining *joining, const struct cells *cells,
                       uint32_t vertex, const double x[3])
{
    double there[3];
    uint32_t to = joining->to[vertex];
    place_of(cells->places, to, there);
    float now = (float)sqrt(apart(x, there, joining->distance));
    now = now > 0 ? nextafterf(now, 2) : 0;
    now = fmaxf(now, reach_of(joining, vertex, to));
    joining->reach[vertex] = fminf(now, 1); /* they are near */
}

static void join(struct joining *joining, const struct cells *cells)
{
    double x[3], cell[3];
    joining->joined = 0;
    for (uint32_t i = 0; i < joining->list_count; i++) {
        uint32_t vertex = joining->list[i];
        place_of(cells->places, vertex, x);
        uint32_t best = find(cells, i, x);
        joining->to[vertex] = joining->list[best];
        if (best == i) {
            cell_at(cells, x, 0, cell);
            uint32_t *head = chain_of(cells, cell, cells->group[i]);
            cells->next[i] = *head;
            *head = i;
        } else {
            cells->group[i] = best; /* it is in no cell */
            keep_reach(joining, cells, vertex, x);
            joining->joined++;
        }
    }
}

/* Leave in the list those that are joined, and those that others are joined to. */
static void shorten(struct joining *joining, const struct cells *cells)
{
    uint32_t *is_in = cells->next, count = joining->list_count;
    memset(is_in, 0, count * sizeof *is_in);
    for (uint32_t i = 0; i < count; i++) {
        if (joining->to[joining->list[i]] != joining->list[i]) {
            is_in[i] = is_in[cells->group[i]] = true;
        } else {
            joining->reach[joining->list[i]] = 0;
        }
    }
    joining->list_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        joining->list[joining->list_count] = joining->list[i];
        joining->list_count += is_in[i];
    }
}

/* Join in this frame what was one until now. */
static int go_on(struct joining *joining, const struct places *places)
{
    size_t count = joining->list_count;
    struct cells cells = {.joining = joining, .places = places, .mask = MASK_MIN};
    cells.width = joining->distance > CELL_MIN / 4 ? 4 * joining->distance : CELL_MIN;
    while (cells.mask < count) {
        cells.mask = cells.mask * 2 + 1;
    }
    size_t head_count = (size_t)cells.mask + 1;
    cells.heads = malloc((head_count + 2 * count) * sizeof *cells.heads);
    if (cells.heads == NULL) {
        return no_memory(count);
    }
    cells.next = cells.heads + head_count;
    cells.group = cells.next + count;
    memset(cells.heads, 0xff, head_count * sizeof *cells.heads);
    for (uint32_t i = 0; i < count; i++) {
        cells.group[i] = joining->to[joining->list[i]];
    }
    join(joining, &cells);
    shorten(joining, &cells);
    free(cells.heads);
    return PCCD_OK;
}

/* ---- the library's functions ------------------------------------------------------- */

/* List the vertices that are named. */
static int list_named(struct joining *joining, const struct pccd_mesh_data *mesh)
{
    static const char *const names[3] = {"triangles", "edges", "points"};
    const uint32_t *all[3] = {mesh->triangles, mesh->edges, mesh->points};
    const size_t counts[3] = {(size_t)mesh->triangle_count * 3,
                              (size_t)mesh->edge_count * 2, mesh->point_count};
    bool are_all = counts[0] + counts[1] + counts[2] == 0;
    for (int kind = 0; kind < 3; kind++) {
        if (all[kind] == NULL && counts[kind] > 0) {
            return cli_fail(NULL, PCCD_E_INVAL, "the %s are NULL", names[kind]);
        }
        for (size_t i = 0; i < counts[kind]; i++) {
            if (all[kind][i] >= mesh->vertex_count) {
                return cli_fail(NULL, PCCD_E_INDEX,
                                "the %s name vertex %" PRIu32 " of %" PRIu32, names[kind],
                                all[kind][i], mesh->vertex_count);
            }
            joining->to[all[kind][i]] = true;
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        bool is_named = are_all || joining->to[i];
        joining->to[i] = is_named ? 0 : i;
        joining->list[joining->list_count] = i;
        joining->list_count += is_named;
    }
    return PCCD_OK;
}

static int reserve(struct joining *joining, size_t vertex_count)
{
    joining->to = calloc(vertex_count, 2 * sizeof *joining->to + sizeof *joining->reach);
    joining->list = joining->to + vertex_count;
    joining->reach = (float *)(void *)(joining->list + vertex_count);
    return joining->to != NULL ? PCCD_OK : no_memory(vertex_count);
}

int pccd_weld_begin(const struct pccd_mesh_data *mesh, double distance, bool tells_more,
                    struct pccd_weld **weld)
{
    struct pccd_mesh_data data;
    if (mesh == NULL || weld == NULL || !(distance >= 0 && isfinite(distance))) {
        return cli_fail(NULL, PCCD_E_INVAL, "mesh is %p, weld %p, distance %g",
                        (const void *)mesh, (void *)weld, distance);
    }
    int status = cli_struct_read(NULL, "mesh", mesh, &data, sizeof data);
    if (status == PCCD_OK && data.vertex_count == 0) {
        status = cli_fail(NULL, PCCD_E_INVAL, "the mesh has no vertices");
    }
    struct pccd_weld *made = status == PCCD_OK ? calloc(1, sizeof *made) : NULL;
    if (made == NULL) {
        return status != PCCD_OK ? status : no_memory(data.vertex_count);
    }
    made->vertex_count = data.vertex_count;
    made->tells_more = tells_more;
    made->joins[0].distance = distance;
    status = reserve(&made->joins[0], data.vertex_count);
    status = status == PCCD_OK ? list_named(&made->joins[0], &data) : status;
    if (status != PCCD_OK) {
        pccd_weld_end(made);
        return status;
    }
    *weld = made;
    return PCCD_OK;
}

static double more_distance_of(const struct joining *joining, const struct places *places)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, size = 0, x[3];
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < joining->list_count; i++) {
        place_of(places, joining->list[i], x);
        for (int k = 0; k < 3; k++) {
            low[k] = x[k] < low[k] ? x[k] : low[k];
            high[k] = x[k] > high[k] ? x[k] : high[k];
            size = high[k] - low[k] > size ? high[k] - low[k] : size;
        }
    }
    return size * MORE_RATIO;
}

/* Most meshes have no two vertices that are nearly at one place: one search tells. */
static int begin(struct pccd_weld *weld, const struct places *places)
{
    struct joining *first = &weld->joins[0], *second = &weld->joins[1];
    if (weld->tells_more && first->distance == 0) {
        first->distance = weld->more_distance = more_distance_of(first, places);
    }
    int status = go_on(first, places);
    weld->joining_count = 1;
    if (status == PCCD_OK && weld->more_distance > 0 && first->joined > 0) {
        weld->joining_count = 2;
        status = reserve(second, weld->vertex_count);
        if (status == PCCD_OK) { /* what is equal is near */
            memcpy(second->to, first->to, 2ul * weld->vertex_count * sizeof *first->to);
            second->list_count = first->list_count;
            status = go_on(second, places);
        }
    }
    first->first_joined = first->joined;
    second->first_joined = second->joined;
    return status;
}

int pccd_weld_frame(struct pccd_weld *weld, const void *x, enum pccd_format format)
{
    COMMON_ROUNDING_HERE;
    const struct places places = {x, format};
    if (weld == NULL || x == NULL ||
        (format != PCCD_FORMAT_F32 && format != PCCD_FORMAT_F64)) {
        return cli_fail(NULL, PCCD_E_INVAL, "weld is %p, x %p, format %d", (void *)weld,
                        x, (int)format);
    }
    uint64_t stray = common_first_stray(x, (uint32_t)format, weld->vertex_count);
    if (stray < weld->vertex_count) {
        return cli_fail(NULL, PCCD_E_NOTFINITE,
                        "vertex %" PRIu64 ": a coordinate is not finite or beyond 1e18",
                        stray);
    }
    if (weld->joining_count == 0) {
        return begin(weld, &places);
    }
    int status = PCCD_OK;
    for (uint32_t i = 0; i < weld->joining_count && status == PCCD_OK; i++) {
        status = go_on(&weld->joins[i], &places);
    }
    return status;
}

const uint32_t *pccd_weld_read(const struct pccd_weld *weld,
                               struct pccd_weld_counts *counts)
{
    if (weld == NULL || weld->joining_count == 0) {
        return NULL;
    }
    const struct joining *chosen = &weld->joins[weld->joining_count - 1];
    if (counts != NULL) {
        *counts = (struct pccd_weld_counts){
            .joined = chosen->joined,
            .apart = chosen->first_joined - chosen->joined,
            .more = weld->joins[0].joined - chosen->joined,
            .more_distance = weld->more_distance,
        };
    }
    return chosen->to;
}

void pccd_weld_end(struct pccd_weld *weld)
{
    if (weld != NULL) {
        free(weld->joins[0].to);
        free(weld->joins[1].to);
        free(weld);
    }
}
