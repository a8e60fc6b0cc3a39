/* objects.c - the objects of a world. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "parts.h"
#include "proto_limits.h"
#include "rounding.h"

static int make_object(struct pccd_mpi *world, struct ranks_mesh *mesh,
                       struct ranks_object **object)
{
    struct ranks_object *made = calloc(1, sizeof *made);
    void **objects = ranks_room_for_one((void **)world->objects, world->object_count);
    if (objects != NULL) {
        world->objects = (struct ranks_object **)objects;
    }
    size_t bytes = ((size_t)mesh->vertex_count + 1) * sizeof *mesh->x;
    if (made == NULL || objects == NULL || (made->x = malloc(bytes)) == NULL ||
        (made->next = malloc(bytes)) == NULL) {
        ranks_object_free(made);
        return ranks_no_memory(world);
    }
    memcpy(made->x, mesh->x, bytes - sizeof *mesh->x);
    made->begun = (const double(*)[3])made->x;
    made->mesh = mesh;
    made->settings = (struct common_attributes)COMMON_ATTRIBUTES_AT_FIRST;
    int status = ranks_local_put_nothing(world, &made->local_mesh);
    if (status == PCCD_OK) {
        status =
            pccd_scene_add(world->client, world->scene, made->local_mesh, &made->handle);
        status = ranks_local_status(world, status, "no object");
    }
    if (status == PCCD_OK) {
        status = ranks_local_show(world, made);
    }
    if (status != PCCD_OK) {
        ranks_object_free(made);
        return status;
    }
    *object = made;
    return PCCD_OK;
}

int pccd_mpi_add(struct pccd_mpi *world, uint32_t mesh, uint32_t *object)
{
    COMMON_ROUNDING_HERE;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct ranks_mesh *found = ranks_find_mesh(world, mesh);
    struct ranks_object *made = NULL;
    int status = found != NULL ? PCCD_OK
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no mesh %" PRIu32, mesh);
    if (object == NULL) {
        status = ranks_missing(&world->link, "object");
    }
    status = ranks_agree(&world->link, RANKS_ADD, mesh, status);
    if (status == PCCD_OK) {
        status = ranks_agree_on(&world->link, make_object(world, found, &made));
        if (status != PCCD_OK && made != NULL) { /* another rank could not */
            (void)pccd_scene_remove(world->client, world->scene, made->handle);
            ranks_object_free(made);
        }
    }
    if (status == PCCD_OK) {
        uint32_t at = world->object_count++;
        for (; at > 0 && world->objects[at - 1]->handle > made->handle; at--) {
            world->objects[at] = world->objects[at - 1];
        }
        world->objects[at] = made;
        found->objects++;
        world->is_cut = world->is_covered = false;
        *object = made->handle;
    }
    return status;
}

static void forget_pairs(struct pccd_mpi *world, uint32_t object)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < world->ignored_count; i++) {
        if (world->ignored[i].a != object && world->ignored[i].b != object) {
            world->ignored[kept++] = world->ignored[i];
        }
    }
    world->ignored_count = kept;
}

static void forget_object(struct pccd_mpi *world, struct ranks_object *object)
{
    struct ranks_mesh *mesh = object->mesh;
    uint32_t i = ranks_place_of_object(world, object->handle);
    memmove(world->objects + i, world->objects + i + 1,
            (--world->object_count - i) * sizeof(struct ranks_object *));
    forget_pairs(world, object->handle);
    if (--mesh->objects == 0 && mesh->leaves == NULL) {
        mesh->leaves = object->own; /* for the next object of it */
        mesh->leaf_count = object->own_count;
        object->own = NULL;
    }
    if (mesh->objects == 0 && mesh->is_gone) {
        ranks_forget_mesh(world, mesh);
    }
    ranks_object_free(object);
    world->is_cut = world->is_covered = false;
}

int pccd_mpi_remove(struct pccd_mpi *world, uint32_t object)
{
    COMMON_ROUNDING_HERE;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct ranks_object *found = ranks_find_object(world, object);
    int status = found != NULL ? PCCD_OK
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no object %" PRIu32, object);
    status = ranks_agree(&world->link, RANKS_REMOVE, object, status);
    if (status == PCCD_OK) {
        status = pccd_scene_remove(world->client, world->scene, object);
        if (status == PCCD_OK) {
            status = pccd_mesh_destroy(world->client, found->local_mesh);
        }
        status = ranks_agree_on(&world->link,
                                ranks_local_status(world, status, "not removed"));
        forget_object(world, found);
    }
    return status;
}

/* Check a radius or a distance. */
static int check_length(struct pccd_mpi *world, double length)
{
    if (!(length >= 0) || length > 1e308) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "a radius or distance is negative or not finite");
    }
    return length <= 1e18 ? PCCD_OK
                          : ranks_fail(&world->link, PCCD_E_LIMIT,
                                       "a radius or distance is beyond 1e18");
}

int pccd_mpi_object_set(struct pccd_mpi *world, uint32_t object,
                        const struct pccd_object_settings *settings)
{
    COMMON_ROUNDING_HERE;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct ranks_object *found = ranks_find_object(world, object);
    struct pccd_object_settings asked = {.struct_bytes = sizeof asked};
    if (settings != NULL) {
        size_t bytes = settings->struct_bytes;
        memcpy(&asked, settings,
               bytes == 0 || bytes > sizeof asked ? sizeof asked : bytes);
    }
    struct common_attributes now = COMMON_ATTRIBUTES_AT_FIRST, given;
    uint64_t words[COMMON_WORDS];
    COMMON_ATTRIBUTES_COPY(&given, &asked);
    if (found != NULL) {
        now = found->settings;
    }
    common_attributes_set(&now, asked.what, &given);
    int status = found != NULL ? check_length(world, now.radius)
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no object %" PRIu32, object);
    status = status == PCCD_OK ? check_length(world, now.rest_distance) : status;
    if (settings == NULL) {
        status = ranks_missing(&world->link, "settings");
    } else if (status == PCCD_OK && asked.what == 0) {
        status =
            ranks_fail(&world->link, PCCD_E_INVAL, "what is 0, it names nothing to set");
    }
    if (status == PCCD_OK && now.rest_rings > PROTO_REST_RINGS_MAX) {
        status = ranks_fail(&world->link, PCCD_E_LIMIT, "rest_rings are at most %u",
                            PROTO_REST_RINGS_MAX);
    }
    uint64_t hash = ranks_hash(object, &asked.what, sizeof asked.what);
    common_attributes_pack(&now, words);
    status = ranks_agree(&world->link, RANKS_OBJECT_SET,
                         ranks_hash(hash, words, sizeof words), status);
    if (status == PCCD_OK) {
        struct common_attributes before = found->settings;
        found->settings = now;
        status = ranks_agree_on(&world->link, ranks_local_show(world, found));
        if (status != PCCD_OK) {
            found->settings = before;
            (void)ranks_local_show(world, found);
        }
        world->is_covered = false;
    }
    return status;
}

int pccd_mpi_pair_ignore(struct pccd_mpi *world, uint32_t object_a, uint32_t object_b,
                         bool ignored)
{
    COMMON_ROUNDING_HERE;
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    const uint32_t same[3] = {object_a, object_b, ignored};
    uint32_t missing = ranks_find_object(world, object_a) == NULL   ? object_a
                       : ranks_find_object(world, object_b) == NULL ? object_b
                                                                    : 0;
    int status = missing == 0 ? PCCD_OK
                              : ranks_fail(&world->link, PCCD_E_HANDLE,
                                           "there is no object %" PRIu32, missing);
    struct ranks_pair *pairs =
        realloc(world->ignored, ((size_t)world->ignored_count + 1) * sizeof *pairs);
    if (pairs != NULL) {
        world->ignored = pairs;
    } else {
        status = ranks_no_memory(world);
    }
    status = ranks_agree(&world->link, RANKS_PAIR_IGNORE,
                         ranks_hash(0, same, sizeof same), status);
    if (status != PCCD_OK) {
        return status;
    }
    status = pccd_pair_ignore(world->client, world->scene, object_a, object_b, ignored);
    status =
        ranks_agree_on(&world->link, ranks_local_status(world, status, "not ignored"));
    if (status == PCCD_OK && ignored && !ranks_are_ignored(world, object_a, object_b)) {
        world->ignored[world->ignored_count++] = (struct ranks_pair){object_a, object_b};
    }
    for (uint32_t i = 0; status == PCCD_OK && !ignored && i < world->ignored_count; i++) {
        const struct ranks_pair *pair = &world->ignored[i];
        if ((pair->a == object_a && pair->b == object_b) ||
            (pair->a == object_b && pair->b == object_a)) {
            world->ignored[i--] = world->ignored[--world->ignored_count];
        }
    }
    world->is_covered = false;
    return status;
}
