/* daemon/engine/scene/feature.c - unique edges and who owns which feature.
 *
 * Room:     engine.
 * Does:     sort the sides of all triangles by (higher, lower) vertex; runs of equal
 *           sides are one edge, owned by the first triangle of the run.
 * Threads:  one thread for one mesh.
 * Source:   paper section 3.1; Curtis 2008 (representative triangles).
 */
#include "feature.h"

#include <math.h>
#include <string.h>

#include "memory.h"
#include "radix.h"

static uint64_t side_key(const uint32_t *corners, unsigned k)
{
    uint32_t a = corners[k];
    uint32_t b = corners[(k + 1) % 3];
    return a < b ? (uint64_t)b << 32 | a : (uint64_t)a << 32 | b;
}

/* Zero area: all three 2x2 minors of the edge vectors vanish. Each minor is compared
 * through its two products, exactly (product and its rounding error); the edge vectors
 * themselves are rounded differences, exact whenever the corners are within a factor of
 * two or on a common grid. The count is a report to the user, not a predicate of the
 * engine. */
static bool has_zero_area(const double (*x)[3], const uint32_t *v)
{
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        return true;
    }
    double b[3];
    double c[3];
    for (int k = 0; k < 3; k++) {
        b[k] = x[v[1]][k] - x[v[0]][k];
        c[k] = x[v[2]][k] - x[v[0]][k];
    }
    for (int k = 0; k < 3; k++) {
        int j = (k + 1) % 3;
        double p = b[k] * c[j];
        double q = b[j] * c[k];
        if (p != q || fma(b[k], c[j], -p) != fma(b[j], c[k], -q)) {
            return false;
        }
    }
    return true;
}

/* Sort items for all sides that are edges. Returns their number. */
static size_t collect_sides(const struct eng_mesh *mesh, struct eng_radix_item *items)
{
    size_t count = 0;
    for (uint32_t t = 0; t < mesh->info.triangle_count; t++) {
        const uint32_t *corners = mesh->corners[t];
        for (unsigned k = 0; k < 3; k++) {
            if (corners[k] != corners[(k + 1) % 3]) {
                items[count].hi = 0;
                items[count].lo = side_key(corners, k);
                items[count].index = 3ull * t + k;
                count++;
            }
        }
    }
    return count;
}

static void init_triangles(const struct eng_mesh *mesh, struct eng_face *triangles)
{
    for (uint32_t t = 0; t < mesh->info.triangle_count; t++) {
        memcpy(triangles[t].v, mesh->corners[t], sizeof triangles[t].v);
        triangles[t].owns = 0;
    }
}

static uint64_t count_runs(const struct eng_radix_item *sides, size_t count)
{
    uint64_t runs = 0;
    for (size_t i = 0; i < count; i++) {
        runs += i == 0 || sides[i].lo != sides[i - 1].lo;
    }
    return runs;
}

/* Number the edges and let the first triangle of each run own its edge (the sort is
 * stable, so that is the lowest triangle). */
static void assign_edges(struct eng_face *triangles, uint32_t (*edges)[2],
                         const struct eng_radix_item *sides, size_t count)
{
    uint32_t edge = 0;
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || sides[i].lo != sides[i - 1].lo) {
            edges[edge][0] = (uint32_t)sides[i].lo;
            edges[edge][1] = (uint32_t)(sides[i].lo >> 32);
            triangles[sides[i].index / 3].owns |= ENG_OWNS_EDGE(sides[i].index % 3);
            edge++;
        }
    }
}

/* First come, first owned. Returns the number of vertices that nobody owns. `seen` is
 * scratch of vertex_count bytes. */
static uint32_t assign_vertices(const struct eng_mesh *mesh, struct eng_face *triangles,
                                uint8_t *seen)
{
    uint32_t isolated = mesh->info.vertex_count;
    memset(seen, 0, mesh->info.vertex_count);
    for (uint32_t t = 0; t < mesh->info.triangle_count; t++) {
        for (unsigned k = 0; k < 3; k++) {
            uint32_t v = triangles[t].v[k];
            if (!seen[v]) {
                seen[v] = 1;
                triangles[t].owns |= ENG_OWNS_VERTEX(k);
                isolated--;
            }
        }
    }
    return isolated;
}

/* Sort the triangles by their sorted corners and count repetitions. */
static uint32_t count_duplicates(const struct eng_mesh *mesh,
                                 struct eng_radix_item *items,
                                 struct eng_radix_item *spare)
{
    uint32_t n = mesh->info.triangle_count;
    for (uint32_t t = 0; t < n; t++) {
        uint32_t a = mesh->corners[t][0];
        uint32_t b = mesh->corners[t][1];
        uint32_t c = mesh->corners[t][2];
        uint32_t low = a < b ? (a < c ? a : c) : (b < c ? b : c);
        uint32_t high = a > b ? (a > c ? a : c) : (b > c ? b : c);
        uint32_t middle = a ^ b ^ c ^ low ^ high;
        items[t].hi = high;
        items[t].lo = (uint64_t)middle << 32 | low;
        items[t].index = t;
    }
    const struct eng_radix_item *sorted = eng_radix_sort(items, spare, n);
    uint32_t duplicates = 0;
    for (uint32_t t = 1; t < n; t++) {
        duplicates +=
            sorted[t].hi == sorted[t - 1].hi && sorted[t].lo == sorted[t - 1].lo;
    }
    return duplicates;
}

int eng_feature_derive(struct eng_mesh *mesh)
{
    uint32_t n = mesh->info.triangle_count;
    int status = ENG_E_NOMEM;
    uint32_t(*edges)[2] = NULL;
    struct eng_face *triangles = eng_alloc(n, sizeof *triangles);
    struct eng_radix_item *items = eng_alloc((size_t)n * 3, sizeof *items);
    struct eng_radix_item *spare = eng_alloc((size_t)n * 3, sizeof *spare);
    uint8_t *seen = eng_alloc(mesh->info.vertex_count, 1);
    if (!triangles || !items || !spare || !seen) {
        goto out;
    }
    struct eng_mesh_info info = mesh->info;
    info.duplicate_count = count_duplicates(mesh, items, spare);
    for (uint32_t t = 0; t < n; t++) {
        info.degenerate_count +=
            has_zero_area((const double(*)[3])mesh->x, mesh->corners[t]);
    }
    init_triangles(mesh, triangles);
    info.isolated_count = assign_vertices(mesh, triangles, seen);
    size_t side_count = collect_sides(mesh, items);
    const struct eng_radix_item *sides = eng_radix_sort(items, spare, side_count);
    uint64_t edge_count = count_runs(sides, side_count);
    if (edge_count > ENG_COUNT_MAX) {
        status = ENG_E_LIMIT;
        goto out;
    }
    info.edge_count = (uint32_t)edge_count;
    edges = eng_alloc(info.edge_count, sizeof *edges);
    if (!edges) {
        goto out;
    }
    assign_edges(triangles, edges, sides, side_count);
    mesh->triangles = triangles;
    mesh->edges = edges;
    mesh->info = info;
    triangles = NULL;
    status = ENG_OK;
out:
    eng_free(triangles);
    eng_free(items);
    eng_free(spare);
    eng_free(seen);
    return status;
}

void eng_feature_index(const struct eng_mesh *mesh, uint32_t *first)
{
    uint32_t v = 0;
    for (uint32_t e = 0; e < mesh->info.edge_count; e++) {
        for (; v <= mesh->edges[e][1]; v++) {
            first[v] = e;
        }
    }
    for (; v <= mesh->info.vertex_count; v++) {
        first[v] = mesh->info.edge_count;
    }
}

uint32_t eng_feature_edge(const struct eng_mesh *mesh, const uint32_t *first, uint32_t a,
                          uint32_t b)
{
    if (a == b) {
        return ENG_NO_EDGE;
    }
    uint32_t high = a > b ? a : b;
    uint32_t low = a > b ? b : a;
    uint32_t from = first[high];
    uint32_t end = first[high + 1];
    while (end - from > 1) {
        uint32_t middle = from + (end - from) / 2;
        if (mesh->edges[middle][0] <= low) {
            from = middle;
        } else {
            end = middle;
        }
    }
    return from;
}

bool eng_feature_validate(const struct eng_mesh *mesh)
{
    const struct eng_mesh_info *info = &mesh->info;
    size_t bytes = (size_t)info->vertex_count + info->edge_count;
    uint8_t *owners = eng_alloc(bytes, 1);
    uint32_t *first = eng_alloc((size_t)info->vertex_count + 1, sizeof *first);
    if (!owners || !first) {
        eng_free(owners);
        eng_free(first);
        return true;
    }
    memset(owners, 0, bytes);
    eng_feature_index(mesh, first);
    bool valid = true;
    uint64_t owned_vertices = 0;
    uint64_t owned_edges = 0;
    for (uint32_t t = 0; t < info->triangle_count; t++) {
        const struct eng_face *triangle = &mesh->triangles[t];
        for (unsigned k = 0; k < 3; k++) {
            if (triangle->owns & ENG_OWNS_VERTEX(k)) {
                valid &= owners[triangle->v[k]]++ == 0;
                owned_vertices++;
            }
            if (triangle->owns & ENG_OWNS_EDGE(k)) {
                uint32_t edge = eng_feature_edge(mesh, first, triangle->v[k],
                                                 triangle->v[(k + 1) % 3]);
                valid &= edge < info->edge_count;
                valid = valid && owners[info->vertex_count + edge]++ == 0;
                owned_edges++;
            }
        }
    }
    eng_free(owners);
    eng_free(first);
    return valid && owned_edges == info->edge_count &&
           owned_vertices == info->vertex_count - info->isolated_count;
}
