/* client/ctl/mesh/weld.c - vertices at one place.
 *
 * Room:     client/ctl.
 * Does:     look for them in a table of cells, each four times the distance wide, so that
 *           most are looked for in one or two.
 * Threads:  one at a time.
 * Source:   weld.h.
 */
#include "weld.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE     UINT32_MAX
#define CELL_MIN 1e-280 /* so that no number of a cell is infinite */

/* A table of vertices that are joined to none. */
struct cells {
    const struct ctl_places *places;
    double distance, width;
    const uint32_t *list;  /* the vertices, or NULL: all */
    const uint32_t *class; /* [entries], before this frame; NULL: all are in one */
    uint32_t *heads;       /* [mask + 1] */
    uint32_t *next;        /* [entries] */
    uint32_t mask;
};

static int no_memory(uint32_t count, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory to join %" PRIu32 " vertices",
                         count);
}

static void place_of(const struct ctl_places *places, uint32_t vertex, double x[3])
{
    for (size_t k = 0; k < 3; k++) {
        size_t index = (size_t)vertex * 3 + k;
        x[k] = places->format == PCCD_FORMAT_F32
                   ? (double)((const float *)places->x)[index]
                   : ((const double *)places->x)[index];
    }
}

static uint32_t vertex_of(const struct cells *cells, uint32_t entry)
{
    return cells->list != NULL ? cells->list[entry] : entry;
}

static bool are_near(const double a[3], const double b[3], double distance)
{
    if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) {
        return true;
    }
    double sum = 0;
    for (int k = 0; k < 3 && distance > 0; k++) {
        double apart = (a[k] - b[k]) / distance;
        sum += apart * apart;
    }
    return distance > 0 && sum <= 1;
}

/* The chain of a cell; 0 and -0 are one number. */
static uint32_t *chain_of(const struct cells *cells, const double cell[3], uint32_t class)
{
    uint64_t hash = class;
    for (int k = 0; k < 3; k++) {
        double number = cell[k] == 0 ? 0 : cell[k];
        uint64_t bits;
        memcpy(&bits, &number, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return &cells->heads[(uint32_t)(hash >> 8) & cells->mask];
}

static double cell_at(const struct cells *cells, double x)
{
    return cells->distance > 0 ? floor(x / cells->width) : x;
}

/* The least entry before this one that it can be joined to; itself: none. */
static uint32_t find(const struct cells *cells, uint32_t entry, const double x[3],
                     uint32_t class)
{
    double ends[2][3], there[3];
    uint32_t best = entry;
    for (int k = 0; k < 3; k++) {
        ends[0][k] = cell_at(cells, x[k] - cells->distance);
        ends[1][k] = cell_at(cells, x[k] + cells->distance);
    }
    for (unsigned corner = 0; corner < 8; corner++) {
        double cell[3];
        bool is_new = true;
        for (unsigned k = 0; k < 3; k++) {
            unsigned end = corner >> k & 1;
            cell[k] = ends[end][k];
            is_new = is_new && (end == 0 || ends[1][k] != ends[0][k]);
        }
        for (uint32_t at = is_new ? *chain_of(cells, cell, class) : NONE; at != NONE;
             at = cells->next[at]) {
            if (at < best && (cells->class == NULL || cells->class[at] == class)) {
                place_of(cells->places, vertex_of(cells, at), there);
                best = are_near(x, there, cells->distance) ? at : best;
            }
        }
    }
    return best;
}

/* Join what the table has: to[] of each entry's vertex; returns how many are joined. */
static uint32_t join(struct cells *cells, uint32_t entries, const bool *is_used,
                     uint32_t *to)
{
    uint32_t joined = 0;
    double x[3], cell[3];
    memset(cells->heads, 0xff, ((size_t)cells->mask + 1) * sizeof *cells->heads);
    for (uint32_t i = 0; i < entries; i++) {
        uint32_t vertex = vertex_of(cells, i);
        uint32_t class = cells->class != NULL ? cells->class[i] : 0;
        if (is_used != NULL && !is_used[vertex]) {
            to[vertex] = vertex;
            continue;
        }
        place_of(cells->places, vertex, x);
        uint32_t best = find(cells, i, x, class);
        to[vertex] = vertex_of(cells, best);
        if (best != i) {
            joined++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            cell[k] = cell_at(cells, x[k]);
        }
        uint32_t *head = chain_of(cells, cell, class);
        cells->next[i] = *head;
        *head = i;
    }
    return joined;
}

static bool reserve(struct cells *cells, uint32_t entries)
{
    cells->mask = 1023;
    while (cells->mask < entries) {
        cells->mask = cells->mask * 2 + 1;
    }
    cells->width = cells->distance > CELL_MIN / 4 ? 4 * cells->distance : CELL_MIN;
    cells->heads = malloc(((size_t)cells->mask + 1) * sizeof *cells->heads);
    cells->next = malloc(((size_t)entries + 1) * sizeof *cells->next);
    return cells->heads != NULL && cells->next != NULL;
}

/* Those that are joined, and those that others are joined to. */
static int make_list(struct ctl_weld *weld, uint32_t count, struct ctl_error *error)
{
    bool *is_in = calloc((size_t)count + 1, sizeof *is_in);
    weld->list = malloc(((size_t)weld->joined * 2 + 1) * sizeof *weld->list);
    if (is_in == NULL || weld->list == NULL) {
        free(is_in);
        return no_memory(count, error);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (weld->to[i] != i) {
            is_in[i] = is_in[weld->to[i]] = true;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (is_in[i]) {
            weld->list[weld->list_count++] = i;
        }
    }
    free(is_in);
    return PCCD_OK;
}

int ctl_weld_begin(struct ctl_weld *weld, double distance,
                   const struct ctl_places *places, const bool *is_used,
                   struct ctl_error *error)
{
    struct cells cells = {.places = places, .distance = distance};
    *weld = (struct ctl_weld){.distance = distance};
    weld->to = malloc(((size_t)places->count + 1) * sizeof *weld->to);
    int status = weld->to == NULL || !reserve(&cells, places->count)
                     ? no_memory(places->count, error)
                     : PCCD_OK;
    if (status == PCCD_OK) {
        weld->first_joined = weld->joined =
            join(&cells, places->count, is_used, weld->to);
        status = make_list(weld, places->count, error);
    }
    free(cells.heads);
    free(cells.next);
    return status;
}

int ctl_weld_begin_joined(struct ctl_weld *weld, uint32_t *to, uint32_t count,
                          struct ctl_error *error)
{
    *weld = (struct ctl_weld){.to = to};
    for (uint32_t i = 0; i < count; i++) {
        weld->joined += to[i] != i;
    }
    weld->first_joined = weld->joined;
    return make_list(weld, count, error);
}

int ctl_weld_frame(struct ctl_weld *weld, const struct ctl_places *places,
                   struct ctl_error *error)
{
    struct cells cells = {
        .places = places, .distance = weld->distance, .list = weld->list};
    uint32_t *class = malloc(((size_t)weld->list_count + 1) * sizeof *class);
    if (class == NULL || !reserve(&cells, weld->list_count)) {
        free(class);
        free(cells.heads);
        free(cells.next);
        return no_memory(weld->list_count, error);
    }
    for (uint32_t i = 0; i < weld->list_count; i++) {
        class[i] = weld->to[weld->list[i]];
    }
    cells.class = class;
    weld->joined = join(&cells, weld->list_count, NULL, weld->to);
    free(class);
    free(cells.heads);
    free(cells.next);
    return PCCD_OK;
}

void ctl_weld_deinit(struct ctl_weld *weld)
{
    free(weld->to);
    free(weld->list);
    *weld = (struct ctl_weld){.to = NULL};
}

/* ---- meshes ------------------------------------------------------------------------ */

bool *ctl_weld_used(const struct ctl_mesh *mesh)
{
    bool *is_used = calloc((size_t)mesh->vertex_count + 1, sizeof *is_used);
    for (size_t kind = 0; kind < CTL_KINDS && is_used != NULL; kind++) {
        for (size_t i = 0; i < mesh->lists[kind].count * (kind + 1); i++) {
            is_used[mesh->lists[kind].vertices[i]] = true;
        }
    }
    return is_used;
}

double ctl_weld_closeness(const struct ctl_places *places, const bool *is_used)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, size = 0;
    double high[3] = {-INFINITY, -INFINITY, -INFINITY}, x[3];
    for (uint32_t v = 0; v < places->count; v++) {
        place_of(places, v, x);
        for (int k = 0; k < 3 && (is_used == NULL || is_used[v]); k++) {
            low[k] = x[k] < low[k] ? x[k] : low[k];
            high[k] = x[k] > high[k] ? x[k] : high[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        size = high[k] - low[k] > size ? high[k] - low[k] : size;
    }
    return size * 0x1p-40;
}

static bool is_flat(const uint32_t corners[3])
{
    return corners[0] == corners[1] || corners[1] == corners[2] ||
           corners[2] == corners[0];
}

int ctl_weld_apply(const struct ctl_weld *weld, const struct ctl_mesh *from,
                   struct ctl_mesh *mesh, uint32_t *flat, struct ctl_error *error)
{
    for (size_t kind = 0; kind < CTL_KINDS; kind++) {
        const struct ctl_list *list = &from->lists[kind];
        const size_t count = list->count * (kind + 1);
        uint32_t *vertices = malloc(count * sizeof *vertices + 1);
        if (vertices == NULL) {
            return no_memory(from->vertex_count, error);
        }
        for (size_t i = 0; i < count; i++) {
            vertices[i] = weld->to[list->vertices[i]];
        }
        mesh->lists[kind] = *list;
        mesh->lists[kind].vertices = vertices;
    }
    *flat = 0;
    for (size_t i = 0; i < (size_t)mesh->triangles.count * 3; i += 3) {
        *flat += is_flat(mesh->triangles.vertices + i) &&
                 !is_flat(from->triangles.vertices + i);
    }
    return PCCD_OK;
}
