/* local.c - an object's mesh in this rank. */
#include "parts.h"

#include <stdlib.h>
#include <string.h>

#include "mpi_hooks.h"
#include "rank_sort.h"

/* Leaf i of an object: first its own, then ghosts. */
static const struct ranks_leaf *leaf_of(const struct ranks_object *object, uint32_t i)
{
    return i < object->own_count ? &object->own[i]
                                 : &object->ghosts[i - object->own_count];
}

/* Numbers of vertices or edges that leaves name, on their way to be listed. */
struct naming {
    uint64_t *words, *other; /* [3 * leaf_count] a number, its place among the words, and
                              * bit 0: it is owned. Most numbers come once or twice. */
    uint32_t *named;         /* [3 * leaf_count] by leaf and corner: the word */
    uint32_t *listed;        /* of each word: the place of its number in the list */
    struct ranks_recent recent;
};

static void naming_free(struct naming *naming)
{
    if (naming != NULL) {
        free(naming->words);
        free(naming->other);
        free(naming->named);
        free(naming->listed);
        free(naming);
    }
}

static struct naming *naming_new(uint64_t leaf_count)
{
    struct naming *naming = calloc(1, sizeof *naming);
    if (naming == NULL) {
        return NULL;
    }
    naming->words = ranks_array(3 * leaf_count, sizeof *naming->words);
    naming->other = ranks_array(3 * leaf_count, sizeof *naming->other);
    naming->named = ranks_array(3 * leaf_count, sizeof *naming->named);
    naming->listed = ranks_array(3 * leaf_count, sizeof *naming->listed);
    if (naming->words == NULL || naming->other == NULL || naming->named == NULL ||
        naming->listed == NULL) {
        naming_free(naming);
        return NULL;
    }
    return naming;
}

/* A number that a leaf names, and whether the leaf owns what it means; behind `count`
 * words, unless it has one that is remembered. Returns the word. */
static inline uint32_t name(struct naming *naming, uint32_t number, uint32_t is_owned,
                            uint32_t *count)
{
    bool is_known;
    uint32_t *word = ranks_recent_value(&naming->recent, number, &is_known);
    if (!is_known) {
        *word = (*count)++;
        naming->words[*word] = (uint64_t)number << 32 | (uint64_t)*word << 1;
    }
    naming->words[*word] |= is_owned;
    return *word;
}

/* The numbers of all words, each once and ascending: to *numbers. */
static uint32_t list(struct naming *naming, uint32_t count, uint32_t *numbers,
                     uint64_t *bits)
{
    const uint64_t *words = ranks_sort_words(naming->words, naming->other, count);
    uint32_t each = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t number = (uint32_t)(words[i] >> 32);
        each += i == 0 || number != (uint32_t)(words[i - 1] >> 32);
        numbers[each - 1] = number;
        bits[(each - 1) / 64] |= (words[i] & 1u) << (each - 1) % 64;
        naming->listed[(uint32_t)words[i] >> 1] = each - 1;
    }
    return each;
}

/* Make the words of the corners of all leaves, or of their sides: to naming->named, but
 * not where there is no side. Return how many words there are. */
static uint32_t name_all(const struct ranks_object *object, uint32_t leaf_count,
                         bool is_of_sides, struct naming *naming)
{
    uint32_t count = 0;
    ranks_recent_begin(&naming->recent);
    for (uint32_t i = 0; i < leaf_count; i++) {
        const struct ranks_leaf *leaf = leaf_of(object, i);
        const uint32_t *numbers = is_of_sides ? leaf->side : leaf->v;
        uint32_t owns = i < object->own_count ? leaf->owns : 0;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t mark = is_of_sides ? RANKS_OWNS_SIDE(k) : RANKS_OWNS_CORNER(k);
            if (numbers[k] != RANKS_NONE) {
                naming->named[3 * (size_t)i + k] =
                    name(naming, numbers[k], (owns & mark) != 0, &count);
            }
        }
    }
    return count;
}

/* List the vertices of all leaves; write the places of leaf i's corners in that list to
 * at[i]. */
static uint32_t list_vertices(const struct ranks_object *object, uint32_t leaf_count,
                              struct naming *naming, struct ranks_local *local,
                              uint32_t (*at)[3])
{
    uint32_t count = name_all(object, leaf_count, false, naming);
    uint32_t each = list(naming, count, local->vertices, local->owns_vertex);
    for (uint32_t i = 0; i < leaf_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            at[i][k] = naming->listed[naming->named[3 * (size_t)i + k]];
        }
    }
    return each;
}

static uint32_t list_edges(const struct ranks_object *object, uint32_t leaf_count,
                           struct naming *naming, struct ranks_local *local)
{
    uint32_t count = name_all(object, leaf_count, true, naming);
    return list(naming, count, local->edges, local->owns_edge);
}

/* Leaves by their numbers: their corners, at[leaf] so far, to local->named, and which of
 * them are triangles. */
static void order_leaves(const struct ranks_object *object, struct naming *naming,
                         const uint32_t (*at)[3], struct ranks_local *local)
{
    for (uint32_t i = 0; i < local->leaf_count; i++) {
        naming->words[i] = (uint64_t)leaf_of(object, i)->number << 32 | i;
    }
    const uint64_t *words =
        ranks_sort_words(naming->words, naming->other, local->leaf_count);
    for (uint32_t i = 0; i < local->leaf_count; i++) {
        uint32_t number = (uint32_t)(words[i] >> 32);
        memcpy(local->named[i], at[(uint32_t)words[i]], sizeof *at);
        if (number < object->mesh->triangle_total) {
            local->triangles[local->triangle_count++] = number;
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
                struct naming *naming, struct ranks_local *local)
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
    local->vertex_count = list_vertices(object, leaf_count, naming, local, at);
    local->edge_count = list_edges(object, leaf_count, naming, local);
    order_leaves(object, naming, (const uint32_t(*)[3])at, local);
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
    struct naming *naming = leaf_count < UINT32_MAX / 6 ? naming_new(leaf_count) : NULL;
    int status = naming != NULL ? fill(object, (uint32_t)leaf_count, naming, &local)
                                : PCCD_E_NOMEM;
    naming_free(naming);
    if (status != PCCD_OK) {
        ranks_local_deinit(&local);
        return ranks_no_memory(world);
    }
    ranks_local_deinit(&object->local);
    object->local = local;
    return PCCD_OK;
}

/* Leaves whose corners are looked for at a time: each time all vertices are gone through,
 * so that it is an eighth of them at least. */
static uint32_t corners_at_a_time(uint32_t count)
{
    uint32_t eighth = count / 8 + 1;
    return eighth < 1u << 14 ? 1u << 14 : eighth;
}

/* Find where the numbers of words are among the local vertices, which have all of
 * them. */
static void find_vertices(const struct ranks_local *local, struct naming *naming,
                          uint32_t count)
{
    const uint64_t *words = ranks_sort_words(naming->words, naming->other, count);
    uint32_t v = 0;
    for (uint32_t i = 0; i < count; i++) {
        while (local->vertices[v] != words[i] >> 32) {
            v++;
        }
        naming->listed[(uint32_t)words[i] >> 1] = v;
    }
}

int ranks_local_corners(struct pccd_mpi *world, const struct ranks_local *local,
                        const struct ranks_leaf *leaves, uint32_t count,
                        uint32_t (*at)[3])
{
    uint32_t each = corners_at_a_time(count);
    struct naming *naming = naming_new(each < count ? each : count);
    if (naming == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t first = 0; first < count; first += each) {
        uint32_t end = count - first < each ? count : first + each, words = 0;
        ranks_recent_begin(&naming->recent);
        for (uint32_t i = first; i < end; i++) {
            for (int k = 0; k < 3; k++) {
                at[i][k] = name(naming, leaves[i].v[k], 0, &words);
            }
        }
        find_vertices(local, naming, words);
        for (uint32_t i = first; i < end; i++) {
            for (int k = 0; k < 3; k++) {
                at[i][k] = naming->listed[at[i][k]];
            }
        }
    }
    naming_free(naming);
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
    return ranks_local_status(world, status, "a mesh was not accepted");
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
        return ranks_local_status(world, status, "its part of a mesh was not accepted");
    }
    if (info.edge_count != local->edge_count) {
        return ranks_fail(&world->link, PCCD_E_INTERNAL,
                          "rank %d: its part of a mesh has other edges than the whole",
                          world->link.rank);
    }
    if (!is_part) {
        return PCCD_OK;
    }
    status = cli_mpi_own(world->client, object->local_mesh, local->owns_vertex,
                         local->owns_edge);
    return ranks_local_status(world, status, "its part of a mesh was not marked");
}

int ranks_local_show(struct pccd_mpi *world, struct ranks_object *object)
{
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                            .what = PCCD_OBJECT_GROUP | PCCD_OBJECT_MASK |
                                                    PCCD_OBJECT_SELF |
                                                    COMMON_OBJECT_THICK};
    COMMON_ATTRIBUTES_COPY(&settings, &object->settings);
    if (object->local.leaf_count == 0 || !object->is_built) {
        settings.group = settings.mask = 0;
        settings.self_collision = false;
    }
    int status = pccd_object_set(world->client, world->scene, object->handle, &settings);
    return ranks_local_status(world, status, "an object was not changed");
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
            object->is_built = status == PCCD_OK;
        }
    }
    status = ranks_agree_on(&world->link, status);
    free(x);
    free(radii);
    return status;
}
