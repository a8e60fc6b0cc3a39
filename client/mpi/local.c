/* local.c - an object's mesh in this rank.
 *
 * Room:     client/mpi.
 * Does:     sort what leaves name; a number of the whole is found by its place then.
 * Threads:  one.
 * Source:   local.h.
 */
#include "local.h"

#include <stdlib.h>
#include <string.h>

#include "foreign.h"
#include "places.h"
#include "rank_sort.h"

static void set_bit(uint64_t *bits, uint32_t i)
{
    bits[i / 64] |= 1ull << i % 64;
}

/* Leaf i of an object: first its own, then ghosts. */
static const struct ranks_leaf *leaf_of(const struct ranks_object *object, uint32_t i)
{
    return i < object->own_count ? &object->own[i]
                                 : &object->ghosts[i - object->own_count];
}

/* What the leaves name, each once and ascending: to *numbers. at[3 * leaf + k], unless it
 * is NULL: the place there of what leaf names by k. keys: scratch for six a leaf. */
static uint32_t list(const struct ranks_object *object, uint32_t leaf_count,
                     bool of_sides, struct ranks_key *keys, uint32_t *numbers,
                     uint64_t *bits, uint32_t *at)
{
    uint64_t count = 0;
    uint32_t each = 0;
    for (uint32_t i = 0; i < leaf_count; i++) {
        const struct ranks_leaf *leaf = leaf_of(object, i);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t number = of_sides ? leaf->side[k] : leaf->v[k];
            uint32_t owned = of_sides ? RANKS_OWNS_SIDE(k) : RANKS_OWNS_CORNER(k);
            if (number != RANKS_NONE) {
                bool is_owned = i < object->own_count && (leaf->owns & owned) != 0;
                keys[count++] =
                    (struct ranks_key){number, 2 * (3 * (uint64_t)i + k) + is_owned};
            }
        }
    }
    keys = ranks_sort(keys, keys + count, count);
    for (uint64_t i = 0; i < count; i++) {
        if (i == 0 || keys[i].key != keys[i - 1].key) {
            numbers[each++] = (uint32_t)keys[i].key;
        }
        if (keys[i].value % 2 != 0) {
            set_bit(bits, each - 1);
        }
        if (at != NULL) {
            at[keys[i].value / 2] = each - 1;
        }
    }
    return each;
}

/* Leaves by their numbers: their corners, at[leaf] so far, to local->named, and which of
 * them are triangles. */
static void order_leaves(const struct ranks_object *object, struct ranks_key *keys,
                         const uint32_t (*at)[3], struct ranks_local *local)
{
    for (uint32_t i = 0; i < local->leaf_count; i++) {
        keys[i] = (struct ranks_key){leaf_of(object, i)->number, i};
    }
    keys = ranks_sort(keys, keys + local->leaf_count, local->leaf_count);
    for (uint32_t i = 0; i < local->leaf_count; i++) {
        memcpy(local->named[i], at[keys[i].value], sizeof *at);
        if (keys[i].key < object->mesh->triangle_total) {
            local->triangles[local->triangle_count++] = (uint32_t)keys[i].key;
        }
    }
}

/* Give back what an array has too much. */
static void shrink(uint32_t **array, uint32_t count)
{
    uint32_t *smaller = realloc(*array, ((size_t)count + 1) * sizeof **array);
    *array = smaller != NULL ? smaller : *array;
}

static int fill(const struct ranks_object *object, uint32_t leaf_count,
                struct ranks_key *keys, struct ranks_local *local)
{
    local->leaf_count = leaf_count;
    local->vertices = ranks_array(3 * (uint64_t)leaf_count, sizeof(uint32_t));
    local->edges = ranks_array(3 * (uint64_t)leaf_count, sizeof(uint32_t));
    local->triangles = ranks_array(leaf_count, sizeof(uint32_t));
    local->named = ranks_array(leaf_count, sizeof *local->named);
    uint32_t(*at)[3] = ranks_array(leaf_count, sizeof *at);
    uint64_t words = 3 * (uint64_t)leaf_count / 64 + 1;
    local->owns_vertex = calloc(words, sizeof(uint64_t));
    local->owns_edge = calloc(words, sizeof(uint64_t));
    if (local->vertices == NULL || local->edges == NULL || local->triangles == NULL ||
        local->named == NULL || at == NULL || local->owns_vertex == NULL ||
        local->owns_edge == NULL) {
        free(at);
        return PCCD_E_NOMEM;
    }
    local->vertex_count =
        list(object, leaf_count, false, keys, local->vertices, local->owns_vertex, at[0]);
    local->edge_count =
        list(object, leaf_count, true, keys, local->edges, local->owns_edge, NULL);
    order_leaves(object, keys, (const uint32_t(*)[3])at, local);
    free(at);
    shrink(&local->vertices, local->vertex_count);
    shrink(&local->edges, local->edge_count);
    shrink(&local->triangles, local->triangle_count);
    return PCCD_OK;
}

int ranks_local_make(struct pccd_mpi *world, struct ranks_object *object)
{
    uint64_t leaf_count = (uint64_t)object->own_count + object->ghost_count;
    struct ranks_local local = {.vertex_count = 0};
    struct ranks_key *keys =
        leaf_count < INT32_MAX ? ranks_array(6 * leaf_count, sizeof *keys) : NULL;
    int status =
        keys != NULL ? fill(object, (uint32_t)leaf_count, keys, &local) : PCCD_E_NOMEM;
    free(keys);
    if (status != PCCD_OK) {
        ranks_local_deinit(&local);
        return ranks_no_memory(world);
    }
    ranks_local_deinit(&object->local);
    object->local = local;
    return PCCD_OK;
}

/* Leaves of which the corners are sorted at a time: each time all vertices are gone
 * through, so that it is an eighth of them at least. */
static uint32_t corners_at_a_time(uint32_t count)
{
    uint32_t eighth = count / 8 + 1;
    return eighth < 1u << 14 ? 1u << 14 : eighth;
}

int ranks_local_corners(struct pccd_mpi *world, const struct ranks_local *local,
                        const struct ranks_leaf *leaves, uint32_t count,
                        uint32_t (*at)[3])
{
    uint32_t each = corners_at_a_time(count);
    struct ranks_key *keys =
        ranks_array(6 * (uint64_t)(each < count ? each : count), sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t first = 0; first < count; first += each) {
        uint64_t corners = 3 * (uint64_t)(count - first < each ? count - first : each);
        for (uint64_t i = 0; i < corners; i++) {
            keys[i] = (struct ranks_key){leaves[first + i / 3].v[i % 3], i};
        }
        const struct ranks_key *sorted = ranks_sort(keys, keys + corners, corners);
        uint32_t v = 0;
        for (uint64_t i = 0; i < corners; i++) {
            while (local->vertices[v] != sorted[i].key) {
                v++;
            }
            at[first + sorted[i].value / 3][sorted[i].value % 3] = v;
        }
    }
    free(keys);
    return PCCD_OK;
}

/* ---- for libpccd ------------------------------------------------------------------ */

int ranks_local_put_nothing(struct pccd_mpi *world, uint32_t *mesh)
{
    static const double x[1][3];
    static const uint32_t point[1];
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = x,
                                        .format = PCCD_FORMAT_F64,
                                        .vertex_count = 1,
                                        .points = point,
                                        .point_count = 1};
    int status = pccd_mesh_put(world->client, &data, mesh, NULL);
    return status == PCCD_OK ? PCCD_OK
                             : ranks_fail_local(world, status, "a mesh was not accepted");
}

/* local->named: triangles, then free edges, then points: pack the latter two to arrays of
 * their own, in place behind the triangles. */
static int put(struct pccd_mpi *world, struct ranks_object *object, const double (*x)[3],
               const double *radii, bool is_part)
{
    const struct ranks_local *local = &object->local;
    uint32_t(*corners)[3] = local->named;
    uint32_t count = local->leaf_count, edge_count = 0, point_count = 0;
    uint32_t *packed = (uint32_t *)(corners + local->triangle_count);
    for (uint32_t i = local->triangle_count; i < count; i++) {
        if (corners[i][0] != corners[i][1]) {
            packed[2 * edge_count] = corners[i][0];
            packed[2 * edge_count++ + 1] = corners[i][1];
        } else {
            packed[2 * edge_count + point_count++] = corners[i][0];
        }
    }
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = x,
                                        .format = PCCD_FORMAT_F64,
                                        .vertex_count = local->vertex_count,
                                        .triangle_count = local->triangle_count,
                                        .triangles = (const uint32_t *)corners,
                                        .radii = radii,
                                        .edges = packed,
                                        .points = packed + 2 * (size_t)edge_count,
                                        .edge_count = edge_count,
                                        .point_count = point_count};
    struct pccd_mesh_info info;
    /* The old shape goes first: libpccd holds both for a while otherwise. */
    int status = ranks_local_put_nothing(world, &object->local_mesh);
    if (status != PCCD_OK || count == 0) {
        return status;
    }
    status = pccd_mesh_put(world->client, &data, &object->local_mesh, &info);
    if (status != PCCD_OK) {
        return ranks_fail_local(world, status, "its part of a mesh was not accepted");
    }
    if (info.edge_count != local->edge_count) {
        return ranks_fail(&world->link, PCCD_E_INTERNAL,
                          "rank %d: its part of a mesh has other edges than the whole",
                          world->link.rank);
    }
    if (!is_part) {
        return PCCD_OK;
    }
    status = cli_foreign_own(world->client, object->local_mesh, local->owns_vertex,
                             local->owns_edge);
    return status == PCCD_OK
               ? PCCD_OK
               : ranks_fail_local(world, status, "its part of a mesh was not marked");
}

int ranks_local_show(struct pccd_mpi *world, struct ranks_object *object)
{
    struct pccd_object_settings settings = object->settings;
    settings.struct_bytes = sizeof settings;
    settings.what = PCCD_OBJECT_GROUP | PCCD_OBJECT_MASK | PCCD_OBJECT_SELF |
                    PCCD_OBJECT_RADIUS | PCCD_OBJECT_REST_DISTANCE |
                    PCCD_OBJECT_REST_RINGS;
    if (object->local.leaf_count == 0 || !object->is_built) {
        settings.group = settings.mask = 0;
        settings.self_collision = false;
    }
    int status = pccd_object_set(world->client, world->scene, object->handle, &settings);
    return status == PCCD_OK
               ? PCCD_OK
               : ranks_fail_local(world, status, "an object was not changed");
}

int ranks_local_register(struct pccd_mpi *world, struct ranks_object *object,
                         const double (*x)[3], const double *radii, bool is_part)
{
    int status = put(world, object, x, radii, is_part);
    free(object->local.named);
    object->local.named = NULL;
    return status;
}

int ranks_local_put(struct pccd_mpi *world, struct ranks_object *object)
{
    double(*x)[3] = NULL, *radii = NULL;
    bool is_old = object->is_built; /* here nothing has changed */
    int status =
        ranks_fetch_registered(world, object->mesh, object->local.vertices,
                               is_old ? 0 : object->local.vertex_count, &x, &radii);
    object->is_elsewhere = true;
    if (status == PCCD_OK && !is_old) {
        status = ranks_local_register(world, object, (const double(*)[3])x, radii,
                                      world->link.size > 1);
        if (status == PCCD_OK) {
            object->is_built = true;
            status = ranks_local_show(world, object);
        }
    }
    status = ranks_agree_on(&world->link, status);
    free(x);
    free(radii);
    return status;
}
