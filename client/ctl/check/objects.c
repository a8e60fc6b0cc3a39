/* objects.c - records by the objects that they are of. */
#include "check_run.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define PAIRS_MIN 64u /* of the table at first; a power of 2 */

/* ---- the object of a feature ------------------------------------------------------- */

bool objects_are_one(const struct ctl_mesh *mesh)
{
    bool is_one = mesh->object_count == 1;
    for (int kind = 0; kind < CTL_KINDS && is_one; kind++) {
        is_one = mesh->objects->first[kind] == 0;
    }
    return is_one;
}

uint32_t objects_part(const struct objects_of *object, uint32_t points, uint32_t feature)
{
    uint32_t part = object->of_vertex == NULL ? 0
                    : points == 1             ? object->of_vertex[feature]
                    : points == 2
                        ? object->of_edge[feature]
                        : ctl_mesh_object_at(object->mesh, CTL_TRIANGLES, feature);
    return object->first + (part == CTL_NO_OBJECT ? object->mesh->object_count : part);
}

const struct objects_of *objects_find(const struct objects *objects, uint32_t handle)
{
    uint32_t low = 0, high = objects->count;
    while (high - low > 1) { /* those before `high` may have it */
        uint32_t middle = (low + high) / 2;
        if (objects->of[middle].handle <= handle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return &objects->of[low];
}

/* Edges are in this order, as pccd_mesh_edges has them. */
static int compare_edges(const void *a, const void *b)
{
    const struct pccd_edge *left = a, *right = b;
    return left->b != right->b   ? (left->b < right->b ? -1 : 1)
           : left->a != right->a ? (left->a < right->a ? -1 : 1)
                                 : 0;
}

/* A side from p to q is of this object, unless another one had it before. */
static void take_side(const struct objects_of *object, uint32_t p, uint32_t q,
                      uint32_t part)
{
    const struct pccd_edge wanted = {.a = p < q ? p : q, .b = p < q ? q : p};
    const struct pccd_edge *edge =
        bsearch(&wanted, object->edges, object->edge_count, sizeof *edge, compare_edges);
    if (edge != NULL && object->of_edge[edge - object->edges] == CTL_NO_OBJECT) {
        object->of_edge[edge - object->edges] = part;
    }
}

static void number_edges(const struct objects_of *object)
{
    const struct ctl_mesh *mesh = object->mesh;
    for (uint32_t i = 0; i < mesh->triangles.count; i++) {
        const uint32_t *corners = mesh->triangles.vertices + 3 * (size_t)i;
        uint32_t part = ctl_mesh_object_at(mesh, CTL_TRIANGLES, i);
        for (uint32_t k = 0; k < 3; k++) {
            take_side(object, corners[k], corners[(k + 1) % 3], part);
        }
    }
    for (uint32_t i = 0; i < mesh->edges.count; i++) {
        const uint32_t *ends = mesh->edges.vertices + 2 * (size_t)i;
        take_side(object, ends[0], ends[1], ctl_mesh_object_at(mesh, CTL_EDGES, i));
    }
}

/* "body", "body/arm" or "arm"; NULL: no memory. */
static char *join_names(const char *object, const char *part)
{
    char *both = malloc(strlen(object) + strlen(part) + 2);
    if (both != NULL) {
        const char *between = object[0] != '\0' && part[0] != '\0' ? "/" : "";
        sprintf(both, "%s%s%s", object, between, part);
    }
    return both;
}

/* Name the parts of an object; one that has a name and is one part is called by that. */
static bool name_parts(struct objects *objects, const struct objects_of *object,
                       const char *name)
{
    const struct ctl_mesh *mesh = object->mesh;
    char **names = realloc(
        objects->names, (objects->part_count + mesh->object_count + 1) * sizeof *names);
    if (names == NULL) {
        return false;
    }
    objects->names = names;
    for (uint32_t i = 0; i <= mesh->object_count; i++) {
        bool is_inner =
            i < mesh->object_count && (name[0] == '\0' || object->of_vertex != NULL);
        char *joined = join_names(name, is_inner ? mesh->objects[i].name : "");
        if (joined == NULL) {
            return false;
        }
        names[objects->part_count++] = joined;
    }
    return true;
}

int objects_add(struct objects *objects, const char *name, const struct objects_of *added,
                struct ctl_error *error)
{
    const struct ctl_mesh *mesh = added->mesh;
    const size_t edge_bytes = ((size_t)added->edge_count + 1) * sizeof(uint32_t);
    const bool is_one = mesh->object_count == 0 || objects_are_one(mesh);
    struct objects_of *of =
        realloc(objects->of, (objects->count + 1u) * sizeof *objects->of);
    if (objects->pairs == NULL) {
        objects->pairs = calloc(PAIRS_MIN, sizeof *objects->pairs);
        objects->capacity = PAIRS_MIN;
    }
    objects->of = of != NULL ? of : objects->of;
    bool has_room = of != NULL && objects->pairs != NULL;
    if (has_room) {
        uint32_t at = objects->count++;
        for (; at > 0 && of[at - 1].handle > added->handle; at--) {
            of[at] = of[at - 1];
        }
        struct objects_of *object = &of[at];
        *object = *added;
        object->first = objects->part_count;
        if (!is_one) {
            object->of_vertex = ctl_mesh_object_of_vertices(mesh);
            object->of_edge = malloc(edge_bytes);
            has_room = object->of_vertex != NULL && object->of_edge != NULL;
        }
        has_room = has_room && name_parts(objects, object, name);
        if (has_room && !is_one) {
            memset(object->of_edge, 0xff, edge_bytes);
            number_edges(object);
        }
    }
    return has_room ? PCCD_OK
                    : ctl_error_set(error, PCCD_E_NOMEM,
                                    "no memory for the objects of %" PRIu32 " edges",
                                    added->edge_count);
}

/* ---- counting ---------------------------------------------------------------------- */

/* Return where a pair is in a table, or would be; a free place has no records. */
static struct report_pair *find(struct report_pair *pairs, uint32_t capacity, uint32_t a,
                                uint32_t b)
{
    uint64_t key = ((uint64_t)a << 32 | b) * 0x9e3779b97f4a7c15u;
    uint32_t at = (uint32_t)(key >> 32) & (capacity - 1);
    while (pairs[at].count > 0 && (pairs[at].a != a || pairs[at].b != b)) {
        at = (at + 1) & (capacity - 1);
    }
    return &pairs[at];
}

static bool grow(struct objects *objects)
{
    uint32_t capacity = 2 * objects->capacity;
    struct report_pair *grown = calloc(capacity, sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    for (uint32_t i = 0; i < objects->capacity; i++) {
        const struct report_pair *pair = &objects->pairs[i];
        if (pair->count > 0) {
            *find(grown, capacity, pair->a, pair->b) = *pair;
        }
    }
    free(objects->pairs);
    objects->pairs = grown;
    objects->capacity = capacity;
    return true;
}

static bool add(struct objects *objects, uint32_t kind, const uint32_t handles[2],
                const uint32_t features[2])
{
    if (kind >= PCCD_KIND_COUNT) {
        return true; /* of a newer daemon */
    }
    const uint32_t *points = common_kinds[kind].points;
    uint32_t a = objects_part(objects_find(objects, handles[0]), points[0], features[0]);
    uint32_t b = objects_part(objects_find(objects, handles[1]), points[1], features[1]);
    struct report_pair *pair =
        find(objects->pairs, objects->capacity, a < b ? a : b, a < b ? b : a);
    if (pair->count == 0) {
        *pair = (struct report_pair){.a = a < b ? a : b, .b = a < b ? b : a, .count = 1};
        objects->pair_count++;
        return objects->pair_count <= objects->capacity / 2 || grow(objects);
    }
    pair->count++;
    return true;
}

bool objects_count(struct objects *objects, const struct pccd_answer *page)
{
    bool ok = true;
    for (uint64_t i = 0; i < page->count && page->contacts != NULL && ok; i++) {
        const struct pccd_contact *contact = &page->contacts[i];
        ok = add(objects, contact->kind,
                 (uint32_t[]){contact->object_a, contact->object_b},
                 (uint32_t[]){contact->feature_a, contact->feature_b});
    }
    for (uint64_t i = 0; i < page->count && page->pairs != NULL && ok; i++) {
        const struct pccd_pair *pair = &page->pairs[i];
        ok = add(objects, pair->kind, (uint32_t[]){pair->object_a, pair->object_b},
                 (uint32_t[]){pair->feature_a, pair->feature_b});
    }
    return ok;
}

/* Most first, then in the order of the file. */
static int compare_pairs(const void *a, const void *b)
{
    const struct report_pair *left = a, *right = b;
    return left->count != right->count ? (left->count > right->count ? -1 : 1)
           : left->a != right->a       ? (left->a < right->a ? -1 : 1)
           : left->b != right->b       ? (left->b < right->b ? -1 : 1)
                                       : 0;
}

int objects_take(struct objects *objects, struct report_step *step,
                 struct ctl_error *error)
{
    struct report_pair *taken = malloc((objects->pair_count + 1u) * sizeof *taken);
    if (taken == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the pairs of objects");
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < objects->capacity; i++) {
        if (objects->pairs[i].count > 0) {
            taken[count++] = objects->pairs[i];
        }
    }
    qsort(taken, count, sizeof *taken, compare_pairs);
    step->pairs = taken;
    step->pair_count = count;
    memset(objects->pairs, 0, objects->capacity * sizeof *objects->pairs);
    objects->pair_count = 0;
    return PCCD_OK;
}

void objects_deinit(struct objects *objects)
{
    for (uint32_t i = 0; i < objects->count; i++) {
        free(objects->of[i].of_vertex);
        free(objects->of[i].of_edge);
    }
    for (uint32_t i = 0; i < objects->part_count; i++) {
        free(objects->names[i]);
    }
    free(objects->of);
    free(objects->names);
    free(objects->pairs);
    *objects = (struct objects){.of = NULL};
}
