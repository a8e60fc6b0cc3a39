/* world.c - opening and closing a world; its meshes and objects.
 *
 * Room:     client/mpi.
 * Does:     the collective calls but steps.
 * Threads:  one.
 * Source:   pccd_mpi.h, world.h.
 */
#include "world.h"

#include <inttypes.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "local.h"
#include "parts.h"

#define TIMEOUT_MS_DEFAULT 60000
#define TIMEOUT_MS_MAX     3600000
#define RINGS_MAX          8u

static _Thread_local char open_text[RANKS_TEXT_BYTES];

/* ---- small things that all files need ------------------------------------------------ */

int ranks_no_memory(struct pccd_mpi *world)
{
    return ranks_fail(&world->link, PCCD_E_NOMEM, "rank %d: out of memory",
                      world->link.rank);
}

int ranks_fail_local(struct pccd_mpi *world, int status, const char *what)
{
    const char *text = pccd_error_text(world->client);
    return ranks_fail(&world->link, status, "rank %d: %s: %.300s", world->link.rank, what,
                      text[0] != '\0' ? text : pccd_status_text(status));
}

/* FNV-1a. */
uint64_t ranks_hash(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < count; i++) {
        hash = (hash ^ at[i]) * 0x100000001b3u;
    }
    return hash;
}

struct ranks_mesh *ranks_find_mesh(const struct pccd_mpi *world, uint32_t handle)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        if (world->meshes[i]->handle == handle && !world->meshes[i]->is_gone) {
            return world->meshes[i];
        }
    }
    return NULL;
}

/* Whoever asks about many goes through them in their order as a rule. */
struct ranks_object *ranks_find_object(struct pccd_mpi *world, uint32_t handle)
{
    uint32_t count = world->object_count;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = (uint32_t)(((uint64_t)world->last_found + i) % count);
        if (world->objects[at]->handle == handle) {
            world->last_found = at;
            return world->objects[at];
        }
    }
    return NULL;
}

static bool are_ignored(const struct pccd_mpi *world, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < world->ignored_count; i++) {
        const struct ranks_pair *pair = &world->ignored[i];
        if ((pair->a == a && pair->b == b) || (pair->a == b && pair->b == a)) {
            return true;
        }
    }
    return false;
}

bool ranks_may_meet(const struct pccd_mpi *world, uint32_t a, uint32_t b)
{
    const struct ranks_object *one = world->objects[a], *other = world->objects[b];
    if (a == b) {
        return one->settings.self_collision;
    }
    return (one->settings.group & other->settings.mask) != 0 &&
           (other->settings.group & one->settings.mask) != 0 &&
           !are_ignored(world, one->handle, other->handle);
}

void ranks_mesh_free(struct ranks_mesh *mesh)
{
    if (mesh != NULL) {
        free(mesh->x);
        free(mesh->radii);
        free(mesh->places);
        free(mesh->leaves);
        free(mesh);
    }
}

void ranks_local_deinit(struct ranks_local *local)
{
    free(local->vertices);
    free(local->edges);
    free(local->triangles);
    free(local->owns_vertex);
    free(local->owns_edge);
    *local = (struct ranks_local){.vertex_count = 0};
}

void ranks_plan_deinit(struct ranks_plan *plan)
{
    free(plan->out_first);
    free(plan->in_first);
    free(plan->out);
    free(plan->in);
    *plan = (struct ranks_plan){.object_count = 0};
}

void ranks_object_free(struct ranks_object *object)
{
    if (object != NULL) {
        ranks_local_deinit(&object->local);
        free(object->x);
        free(object->next);
        free(object->start);
        free(object->written);
        free(object->cover);
        free(object->own);
        free(object->ghosts);
        free(object->neighbours);
        free(object);
    }
}

/* ---- opening ------------------------------------------------------------------------- */

/* The processors that this rank may run on, and how many ranks of the machine may run on
 * exactly these. */
static int share_processors(struct pccd_mpi *world, const MPI_Comm machine,
                            uint32_t *threads)
{
    cpu_set_t mine;
    int ranks = 0, equal = 0;
    CPU_ZERO(&mine);
    if (sched_getaffinity(0, sizeof mine, &mine) != 0) {
        CPU_SET(0, &mine);
    }
    MPI_Comm_size(machine, &ranks);
    cpu_set_t *all = ranks_array((uint64_t)ranks, sizeof *all);
    if (all == NULL) {
        return ranks_no_memory(world);
    }
    int code = MPI_Allgather(&mine, (int)sizeof mine, MPI_BYTE, all, (int)sizeof mine,
                             MPI_BYTE, machine);
    for (int r = 0; r < ranks; r++) {
        equal += CPU_EQUAL(&all[r], &mine) ? 1 : 0;
    }
    free(all);
    uint32_t count = (uint32_t)CPU_COUNT(&mine) / (uint32_t)(equal > 0 ? equal : 1);
    *threads = count > 0 ? count : 1;
    return ranks_mpi(&world->link, code, "MPI_Allgather");
}

static int choose_threads(struct pccd_mpi *world)
{
    MPI_Comm machine;
    uint32_t threads = 1;
    int code = MPI_Comm_split_type(world->link.comm, MPI_COMM_TYPE_SHARED, 0,
                                   MPI_INFO_NULL, &machine);
    int status = ranks_mpi(&world->link, code, "MPI_Comm_split_type");
    if (status == PCCD_OK) {
        status = share_processors(world, machine, &threads);
        MPI_Comm_free(&machine);
    }
    world->threads = world->threads > 0 ? world->threads : threads;
    return status;
}

static int connect_direct(struct pccd_mpi *world, uint64_t result_bytes)
{
    struct pccd_options options;
    pccd_options_init(&options);
    options.url = "direct:";
    options.slot_count = 1;
    options.result_bytes = result_bytes;
    options.no_keep = true;
    int status = pccd_connect(&options, &world->client);
    if (status == PCCD_OK) {
        status = pccd_scene_create(world->client, NULL, &world->scene);
    }
    return status == PCCD_OK ? PCCD_OK
                             : ranks_fail_local(world, status, "no scene of libpccd");
}

static int open_world(struct pccd_mpi *world, MPI_Comm comm,
                      const struct pccd_mpi_options *options)
{
    struct ranks_link *link = &world->link;
    int code = MPI_Comm_dup(comm, &link->comm);
    if (code != MPI_SUCCESS) {
        link->comm = MPI_COMM_NULL;
        return ranks_mpi(link, code, "MPI_Comm_dup");
    }
    MPI_Comm_set_errhandler(link->comm, MPI_ERRORS_RETURN);
    MPI_Comm_rank(link->comm, &link->rank);
    MPI_Comm_size(link->comm, &link->size);
    int status = choose_threads(world);
    if (status == PCCD_OK) {
        status = connect_direct(world, options->result_bytes);
    }
    return ranks_agree_on(link, status);
}

int pccd_mpi_open(MPI_Comm comm, const struct pccd_mpi_options *options,
                  struct pccd_mpi **world)
{
    struct pccd_mpi_options asked = {.struct_bytes = sizeof asked};
    int is_there = 0;
    *world = NULL;
    open_text[0] = '\0';
    if (options != NULL) {
        size_t bytes = options->struct_bytes;
        bytes = bytes == 0 || bytes > sizeof asked ? sizeof asked : bytes;
        memcpy(&asked, options, bytes);
    }
    if (MPI_Initialized(&is_there) != MPI_SUCCESS || !is_there) {
        snprintf(open_text, sizeof open_text, "MPI_Init was not called");
        return PCCD_E_STATE;
    }
    struct pccd_mpi *opened = calloc(1, sizeof *opened);
    if (opened == NULL) {
        snprintf(open_text, sizeof open_text, "out of memory");
        return PCCD_E_NOMEM;
    }
    opened->link.comm = MPI_COMM_NULL;
    opened->link.timeout_ms = asked.timeout_ms > 0 ? asked.timeout_ms : TIMEOUT_MS_DEFAULT;
    if (opened->link.timeout_ms > TIMEOUT_MS_MAX) {
        opened->link.timeout_ms = TIMEOUT_MS_MAX;
    }
    opened->threads = asked.threads;
    opened->share.imbalance = 1;
    int status = open_world(opened, comm, &asked);
    if (status != PCCD_OK) {
        memcpy(open_text, opened->link.text, sizeof open_text);
        pccd_mpi_close(opened);
        return status;
    }
    *world = opened;
    return PCCD_OK;
}

void pccd_mpi_close(struct pccd_mpi *world)
{
    if (world == NULL) {
        return;
    }
    for (uint32_t i = 0; i < world->object_count; i++) {
        ranks_object_free(world->objects[i]);
    }
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        ranks_mesh_free(world->meshes[i]);
    }
    free((void *)world->objects);
    free((void *)world->meshes);
    free(world->ignored);
    free(world->records);
    ranks_plan_deinit(&world->plan);
    pccd_close(world->client);
    /* Of a broken one somebody is missing, who would be waited for. */
    if (world->link.comm != MPI_COMM_NULL && world->link.broken == PCCD_OK) {
        MPI_Comm_free(&world->link.comm);
    }
    free(world);
}

const char *pccd_mpi_error_text(const struct pccd_mpi *world)
{
    return world != NULL ? world->link.text : open_text;
}

/* ---- meshes -------------------------------------------------------------------------- */

/* Room for one more in an array of pointers. */
static void **room_for_one(void **array, uint32_t count)
{
    return realloc((void *)array, ((size_t)count + 1) * sizeof *array);
}

/* The objects of `before` are made of `mesh` from now on, at its registered positions. */
static int change_objects(struct pccd_mpi *world, struct ranks_mesh *before,
                          struct ranks_mesh *mesh)
{
    size_t bytes = ((size_t)mesh->vertex_count + 1) * sizeof *mesh->x;
    for (uint32_t i = 0; i < world->object_count; i++) {
        struct ranks_object *object = world->objects[i];
        if (object->mesh != before) {
            continue;
        }
        double(*x)[3] = malloc(bytes), (*next)[3] = malloc(bytes);
        if (x == NULL || next == NULL) {
            free(x);
            free(next);
            world->link.broken = PCCD_E_NOMEM; /* some have changed already */
            return ranks_no_memory(world);
        }
        memcpy(x, mesh->x, bytes - sizeof *mesh->x);
        struct ranks_object fresh = {.handle = object->handle,
                                     .mesh = mesh,
                                     .local_mesh = object->local_mesh,
                                     .settings = object->settings,
                                     .x = x,
                                     .next = next};
        struct ranks_object *old = malloc(sizeof *old);
        if (old != NULL) {
            *old = *object;
        }
        *object = fresh;
        ranks_object_free(old);
        mesh->objects++;
    }
    return PCCD_OK;
}

static int put_mesh(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                    uint32_t *handle, struct pccd_mesh_info *info)
{
    struct ranks_mesh *mesh = NULL, *before = NULL;
    void **meshes = room_for_one((void **)world->meshes, world->mesh_count);
    int status = meshes == NULL ? ranks_no_memory(world) : PCCD_OK;
    if (meshes != NULL) {
        world->meshes = (struct ranks_mesh **)meshes;
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_mesh_make(world, part, &mesh);
    }
    if (status != PCCD_OK) {
        return status;
    }
    if (*handle == 0) {
        mesh->handle = ++world->mesh_number;
        mesh->info.generation = 1;
        world->meshes[world->mesh_count++] = mesh;
    } else {
        for (uint32_t i = 0; i < world->mesh_count; i++) {
            if (world->meshes[i] == ranks_find_mesh(world, *handle)) {
                before = world->meshes[i];
                mesh->handle = before->handle;
                mesh->info.generation = before->info.generation + 1;
                world->meshes[i] = mesh;
                break;
            }
        }
        status = ranks_agree_on(&world->link, change_objects(world, before, mesh));
        ranks_mesh_free(before);
        world->is_cut = world->is_covered = false;
    }
    *handle = mesh->handle;
    if (info != NULL) {
        *info = mesh->info;
    }
    return status;
}

/* A part as this library knows it. */
static struct pccd_mpi_part read_part(const struct pccd_mpi_part *part)
{
    struct pccd_mpi_part known = {.struct_bytes = sizeof known};
    size_t bytes = part->struct_bytes;
    memcpy(&known, part, bytes == 0 || bytes > sizeof known ? sizeof known : bytes);
    return known;
}

int pccd_mpi_mesh_put(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                      uint32_t *mesh, struct pccd_mesh_info *info)
{
    struct pccd_mpi_part known = read_part(part);
    const uint32_t same[3] = {known.vertex_total, known.triangle_total, *mesh};
    int status = ranks_part_check(world, &known);
    if (status == PCCD_OK && *mesh != 0 && ranks_find_mesh(world, *mesh) == NULL) {
        status = ranks_fail(&world->link, PCCD_E_HANDLE, "there is no mesh %" PRIu32,
                            *mesh);
    }
    status = ranks_agree(&world->link, RANKS_MESH_PUT, ranks_hash(0, same, sizeof same),
                         status);
    return status == PCCD_OK ? put_mesh(world, &known, mesh, info) : status;
}

static void forget_mesh(struct pccd_mpi *world, struct ranks_mesh *mesh)
{
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        if (world->meshes[i] == mesh) {
            world->meshes[i] = world->meshes[--world->mesh_count];
            ranks_mesh_free(mesh);
            return;
        }
    }
}

int pccd_mpi_mesh_destroy(struct pccd_mpi *world, uint32_t mesh)
{
    struct ranks_mesh *found = ranks_find_mesh(world, mesh);
    int status = found != NULL ? PCCD_OK
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no mesh %" PRIu32, mesh);
    status = ranks_agree(&world->link, RANKS_MESH_DESTROY, mesh, status);
    if (status == PCCD_OK) {
        found->is_gone = true;
        if (found->objects == 0) {
            forget_mesh(world, found);
        }
    }
    return status;
}

/* ---- objects ------------------------------------------------------------------------- */

/* The settings that objects begin with. */
static struct pccd_object_settings settings_at_first(void)
{
    return (struct pccd_object_settings){.struct_bytes =
                                             sizeof(struct pccd_object_settings),
                                         .self_collision = true,
                                         .group = 1,
                                         .mask = UINT64_MAX};
}

static int make_object(struct pccd_mpi *world, struct ranks_mesh *mesh,
                       struct ranks_object **object)
{
    struct ranks_object *made = calloc(1, sizeof *made);
    void **objects = room_for_one((void **)world->objects, world->object_count);
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
    made->mesh = mesh;
    made->settings = settings_at_first();
    int status = ranks_local_put_nothing(world, &made->local_mesh);
    if (status == PCCD_OK) {
        status = pccd_scene_add(world->client, world->scene, made->local_mesh,
                                &made->handle);
        if (status != PCCD_OK) {
            status = ranks_fail_local(world, status, "no object");
        }
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
    struct ranks_mesh *found = ranks_find_mesh(world, mesh);
    struct ranks_object *made = NULL;
    int status = found != NULL ? PCCD_OK
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no mesh %" PRIu32, mesh);
    status = ranks_agree(&world->link, RANKS_ADD, mesh, status);
    if (status == PCCD_OK) {
        status = ranks_agree_on(&world->link, make_object(world, found, &made));
        if (status != PCCD_OK && made != NULL) { /* another rank could not */
            (void)pccd_scene_remove(world->client, world->scene, made->handle);
            ranks_object_free(made);
        }
    }
    if (status == PCCD_OK) {
        world->objects[world->object_count++] = made;
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
    uint32_t i = 0;
    while (world->objects[i] != object) {
        i++;
    }
    memmove(world->objects + i, world->objects + i + 1,
            (--world->object_count - i) * sizeof(struct ranks_object *));
    forget_pairs(world, object->handle);
    if (--mesh->objects == 0 && mesh->leaves == NULL) {
        mesh->leaves = object->own; /* for the next object of it */
        mesh->leaf_count = object->own_count;
        object->own = NULL;
    }
    if (mesh->objects == 0 && mesh->is_gone) {
        forget_mesh(world, mesh);
    }
    ranks_object_free(object);
    world->is_cut = world->is_covered = false;
}

int pccd_mpi_remove(struct pccd_mpi *world, uint32_t object)
{
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
                                status == PCCD_OK
                                    ? PCCD_OK
                                    : ranks_fail_local(world, status, "not removed"));
        forget_object(world, found);
    }
    return status;
}

/* Of a radius or a distance. */
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
    struct ranks_object *found = ranks_find_object(world, object);
    struct pccd_object_settings asked = {.struct_bytes = sizeof asked};
    size_t bytes = settings->struct_bytes;
    memcpy(&asked, settings, bytes == 0 || bytes > sizeof asked ? sizeof asked : bytes);
    struct pccd_object_settings now = settings_at_first();
    if (found != NULL) {
        now = found->settings;
    }
    now.self_collision =
        asked.what & PCCD_OBJECT_SELF ? asked.self_collision : now.self_collision;
    now.group = asked.what & PCCD_OBJECT_GROUP ? asked.group : now.group;
    now.mask = asked.what & PCCD_OBJECT_MASK ? asked.mask : now.mask;
    now.radius = asked.what & PCCD_OBJECT_RADIUS ? asked.radius : now.radius;
    now.rest_distance = asked.what & PCCD_OBJECT_REST_DISTANCE ? asked.rest_distance
                                                               : now.rest_distance;
    now.rest_rings =
        asked.what & PCCD_OBJECT_REST_RINGS ? asked.rest_rings : now.rest_rings;
    int status = found != NULL ? check_length(world, now.radius)
                               : ranks_fail(&world->link, PCCD_E_HANDLE,
                                            "there is no object %" PRIu32, object);
    status = status == PCCD_OK ? check_length(world, now.rest_distance) : status;
    if (status == PCCD_OK && now.rest_rings > RINGS_MAX) {
        status = ranks_fail(&world->link, PCCD_E_LIMIT, "rest_rings are at most %u",
                            RINGS_MAX);
    }
    uint64_t hash = ranks_hash(object, &asked.what, sizeof asked.what);
    hash = ranks_hash(hash, &now.self_collision, sizeof now.self_collision);
    hash = ranks_hash(hash, &now.group, sizeof now.group);
    hash = ranks_hash(hash, &now.mask, sizeof now.mask);
    hash = ranks_hash(hash, &now.radius, sizeof now.radius);
    hash = ranks_hash(hash, &now.rest_distance, sizeof now.rest_distance);
    hash = ranks_hash(hash, &now.rest_rings, sizeof now.rest_rings);
    status = ranks_agree(&world->link, RANKS_OBJECT_SET, hash, status);
    if (status == PCCD_OK) {
        struct pccd_object_settings before = found->settings;
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
    status = ranks_agree_on(
        &world->link,
        status == PCCD_OK ? PCCD_OK : ranks_fail_local(world, status, "not ignored"));
    if (status == PCCD_OK && ignored && !are_ignored(world, object_a, object_b)) {
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
