/* world.c - opening and closing a world. */
#include "world.h"

#include <inttypes.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mpi_hooks.h"
#include "pccd_daemon.h"
#include "proto_limits.h"
#include "rounding.h"

#define TIMEOUT_MS_DEFAULT 60000
#define TIMEOUT_MS_MAX     3600000

static _Thread_local char open_text[RANKS_TEXT_BYTES];

/* ---- small things that all files need --------------------------------------------- */

int ranks_no_memory(struct pccd_mpi *world)
{
    return ranks_link_no_memory(&world->link);
}

int ranks_agree_memory(struct pccd_mpi *world, bool has_memory)
{
    return ranks_agree_on(&world->link, has_memory ? PCCD_OK : ranks_no_memory(world));
}

int ranks_local_status(struct pccd_mpi *world, int status, const char *what)
{
    const char *text = pccd_error_text(world->client);
    if (status == PCCD_OK) {
        return PCCD_OK;
    }
    return ranks_fail(&world->link, status, "rank %d: %s: %.300s", world->link.rank, what,
                      text[0] != '\0' ? text : pccd_status_text(status));
}

/* FNV-1a. From a small number, a first byte that is equal to it would lead to 0, and all
 * zeros behind it would be lost. */
uint64_t ranks_hash(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *at = bytes;
    hash ^= 0xcbf29ce484222325u;
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

uint32_t ranks_place_of_object(const struct pccd_mpi *world, uint32_t handle)
{
    uint32_t from = 0, end = world->object_count;
    while (from < end) {
        uint32_t middle = from + (end - from) / 2;
        if (world->objects[middle]->handle < handle) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from < world->object_count && world->objects[from]->handle == handle
               ? from
               : world->object_count;
}

struct ranks_object *ranks_find_object(const struct pccd_mpi *world, uint32_t handle)
{
    uint32_t at = ranks_place_of_object(world, handle);
    return at < world->object_count ? world->objects[at] : NULL;
}

bool ranks_are_ignored(const struct pccd_mpi *world, uint32_t a, uint32_t b)
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
    return common_attributes_may_meet(&one->settings, &other->settings) &&
           !ranks_are_ignored(world, one->handle, other->handle);
}

void **ranks_room_for_one(void **array, uint32_t count)
{
    return realloc((void *)array, ((size_t)count + 1) * sizeof *array);
}

void ranks_mesh_free(struct ranks_mesh *mesh)
{
    if (mesh != NULL) {
        free(mesh->x);
        free(mesh->radii);
        free(mesh->owners);
        free(mesh->numbers);
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
    free(local->named);
    free(local->ends);
    free(local->corners);
    *local = (struct ranks_local){.vertex_count = 0};
}

void ranks_plan_deinit(struct ranks_plan *plan)
{
    free(plan->out_first);
    free(plan->in_first);
    free(plan->out);
    free(plan->in);
    free(plan->is_run);
    free(plan->out_x);
    free(plan->in_x);
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
        free(object->guess);
        free(object->own);
        free(object->weights);
        free(object->ghosts);
        free(object->neighbours);
        free(object);
    }
}

/* ---- opening ---------------------------------------------------------------------- */

/* The processors that this rank may run on, divided by the ranks of the machine that may
 * run on exactly these. Returns an error of MPI, and what failed. */
static int share_processors(const MPI_Comm machine, uint32_t *threads, const char **what)
{
    cpu_set_t mine;
    int ranks = 0, equal = 0;
    CPU_ZERO(&mine);
    if (sched_getaffinity(0, sizeof mine, &mine) != 0) {
        CPU_SET(0, &mine);
    }
    MPI_Comm_size(machine, &ranks);
    cpu_set_t *all = ranks_array((uint64_t)ranks, sizeof *all);
    *what = "memory for the processors of a machine";
    if (all == NULL) {
        return MPI_ERR_NO_MEM;
    }
    *what = "MPI_Allgather";
    int code = MPI_Allgather(&mine, (int)sizeof mine, MPI_BYTE, all, (int)sizeof mine,
                             MPI_BYTE, machine);
    for (int r = 0; r < ranks; r++) {
        equal += CPU_EQUAL(&all[r], &mine) ? 1 : 0;
    }
    free(all);
    uint32_t count = (uint32_t)CPU_COUNT(&mine) / (uint32_t)(equal > 0 ? equal : 1);
    *threads = count > 0 ? count : 1;
    return code;
}

static int count_threads(MPI_Comm comm, uint32_t *threads, const char **what)
{
    MPI_Comm machine;
    *threads = 1;
    *what = "MPI_Comm_split_type";
    int code =
        MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    if (code == MPI_SUCCESS) {
        code = share_processors(machine, threads, what);
        MPI_Comm_free(&machine);
    }
    return code;
}

int pccd_mpi_threads(MPI_Comm comm, uint32_t *threads)
{
    const char *what;
    if (threads == NULL) {
        return PCCD_E_INVAL;
    }
    return count_threads(comm, threads, &what) == MPI_SUCCESS ? PCCD_OK : PCCD_E_SYSTEM;
}

static int choose_threads(struct pccd_mpi *world)
{
    const char *what;
    uint32_t threads;
    int code = count_threads(world->link.comm, &threads, &what);
    world->threads = world->threads > 0 ? world->threads : threads;
    return ranks_mpi(&world->link, code, what);
}

/* Room for all records that a rank may have, within this: memory comes as they do, so all
 * of an answer is a page, which stays where it is. */
#define RESULT_BYTES_LEAST (64ull << 20)
#define RESULT_BYTES_MOST  (4ull << 30)

static uint64_t result_bytes_of(const struct pccd_mpi *world)
{
    const uint64_t bytes = sizeof(struct pccd_contact);
    uint64_t records = world->record_limit;
    records = records < RESULT_BYTES_MOST / bytes ? records : RESULT_BYTES_MOST / bytes;
    return records * bytes > RESULT_BYTES_LEAST ? records * bytes : RESULT_BYTES_LEAST;
}

static int connect_direct(struct pccd_mpi *world, uint64_t result_bytes)
{
    struct pccd_options options;
    struct pccd_daemon_info info;
    pccd_options_init(&options);
    options.url = "direct:";
    options.slot_count = 1;
    options.result_bytes = result_bytes > 0 ? result_bytes : result_bytes_of(world);
    options.no_keep = true;
    int status = pccd_connect(&options, &world->client);
    if (status == PCCD_OK) {
        status = pccd_scene_create(world->client, NULL, &world->scene);
    }
    if (status == PCCD_OK) {
        status = cli_mpi_watch(world->client, ranks_stop_look, &world->stop);
    }
    if (status == PCCD_OK) { /* ranks that share processors leave some to each other; and
                              * where no thread can be started, libgomp calls exit */
        status = cli_mpi_threads(world->client, world->threads);
    }
    if (status == PCCD_OK) { /* $OMP_NUM_THREADS may say less, and libpccd obeys it */
        status = pccd_daemon(world->client, &info);
    }
    if (status == PCCD_OK && info.threads_max < world->threads) {
        world->threads = info.threads_max;
    }
    return ranks_local_status(world, status, "no scene of libpccd");
}

/* A rank may have all that is kept. */
static int raise_limit(struct pccd_mpi *world)
{
    char text[32];
    snprintf(text, sizeof text, "%" PRIu64, world->record_limit);
    int status = pccd_config_set(world->client, "contacts-max", text);
    return ranks_local_status(world, status, "record_limit is not accepted");
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
        status = ranks_stop_init(&world->stop, link);
    }
    if (status == PCCD_OK) {
        status = connect_direct(world, options->result_bytes);
    }
    if (status == PCCD_OK && world->record_limit > PROTO_CONTACTS_PER_STEP) {
        status = raise_limit(world);
    }
    return ranks_agree(link, RANKS_OPEN, world->record_limit, status);
}

int pccd_mpi_open(MPI_Comm comm, const struct pccd_mpi_options *options,
                  struct pccd_mpi **world)
{
    COMMON_ROUNDING_HERE;
    struct pccd_mpi_options asked = {.struct_bytes = sizeof asked};
    int is_there = 0;
    if (world == NULL) {
        snprintf(open_text, sizeof open_text, "world is NULL");
        return PCCD_E_INVAL;
    }
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
    opened->link.timeout_ms =
        asked.timeout_ms > 0 ? asked.timeout_ms : TIMEOUT_MS_DEFAULT;
    if (opened->link.timeout_ms > TIMEOUT_MS_MAX) {
        opened->link.timeout_ms = TIMEOUT_MS_MAX;
    }
    opened->threads = asked.threads;
    opened->record_limit =
        asked.record_limit > 0 ? asked.record_limit : PROTO_CONTACTS_PER_STEP;
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
    free(world->copied);
    free(world->strays);
    free(world->bounds);
    free(world->bound_values);
    ranks_plan_deinit(&world->plan);
    pccd_answer_release(world->client, &world->page);
    pccd_close(world->client);
    ranks_stop_deinit(&world->stop);
    /* Of a broken one somebody is missing, who would be waited for. */
    if (world->link.comm != MPI_COMM_NULL && world->link.broken == PCCD_OK) {
        MPI_Comm_free(&world->link.comm);
    }
    free(world);
}

void pccd_mpi_cancel(struct pccd_mpi *world)
{
    if (world != NULL) {
        ranks_stop_cancel(&world->stop);
    }
}

const char *pccd_mpi_error_text(const struct pccd_mpi *world)
{
    return world != NULL ? world->link.text : open_text;
}
