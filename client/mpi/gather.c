/* gather.c - the records of all ranks on one of them; what a rank tells of its share. */
#include <stdlib.h>
#include <string.h>

#include "answer.h"

#define CHUNK_RECORDS 4096u
#define TAG_RECORDS   19

/* Records of one rank, as they come in at the root. */
struct stream {
    char *records; /* [CHUNK_RECORDS] */
    uint64_t count, at;
    uint64_t left; /* that the rank has not sent yet */
};

struct merge {
    struct pccd_mpi *world;
    size_t record_bytes;
    struct stream *streams;
    char *out; /* [CHUNK_RECORDS] */
    uint64_t out_count;
    pccd_mpi_records_fn each;
    void *context;
    int verdict; /* of `each` */
};

/* Write the name that the records of this world's last answer are sorted by. */
static void name_of(const struct pccd_mpi *world, const char *record,
                    uint32_t name[RANKS_NAME_WORDS])
{
    if (world->has_bounds) {
        const struct ranks_bound *bound = (const void *)record;
        memset(name, 0, RANKS_NAME_WORDS * sizeof *name);
        name[0] = bound->object;
        name[1] = bound->vertex;
    } else {
        ranks_record_name(record, world->mode, name);
    }
}

static bool is_before(const struct pccd_mpi *world, const char *a, const char *b)
{
    uint32_t one[RANKS_NAME_WORDS], other[RANKS_NAME_WORDS];
    name_of(world, a, one);
    name_of(world, b, other);
    return ranks_name_is_before(one, other);
}

static size_t bytes_of(const struct pccd_mpi *world)
{
    return world->has_bounds ? sizeof(struct ranks_bound)
                             : ranks_record_bytes(world->mode);
}

static char *records_of(const struct pccd_mpi *world)
{
    return world->has_bounds ? (char *)world->bounds : world->records;
}

static uint64_t count_of(const struct pccd_mpi *world)
{
    return world->has_bounds ? world->bound_count : world->record_count;
}

/* Without a bound on the time: the root takes as long as `each` does. */
static int await(struct ranks_link *link, MPI_Request *request)
{
    int status = ranks_wait(link, request, 1);
    while (status == PCCD_E_TIMEOUT) {
        link->broken = PCCD_OK;
        status = ranks_wait(link, request, 1);
    }
    return status;
}

/* ---- the others ------------------------------------------------------------------- */

/* Chunks go as the root receives them. */
static int serve(struct pccd_mpi *world, int root)
{
    size_t record_bytes = bytes_of(world);
    int status = PCCD_OK;
    for (uint64_t sent = 0; sent < count_of(world) && status == PCCD_OK;
         sent += CHUNK_RECORDS) {
        MPI_Request request;
        uint64_t count = count_of(world) - sent;
        count = count < CHUNK_RECORDS ? count : CHUNK_RECORDS;
        status = ranks_mpi(&world->link,
                           MPI_Isend(records_of(world) + sent * record_bytes,
                                     (int)(count * record_bytes), MPI_BYTE, root,
                                     TAG_RECORDS, world->link.comm, &request),
                           "gathering records");
        status = status == PCCD_OK ? await(&world->link, &request) : status;
    }
    return status;
}

/* ---- the root --------------------------------------------------------------------- */

/* Get the next records of rank r, if it has any left. */
static int receive(struct merge *merge, int r)
{
    struct ranks_link *link = &merge->world->link;
    struct stream *stream = &merge->streams[r];
    uint64_t count = stream->left < CHUNK_RECORDS ? stream->left : CHUNK_RECORDS;
    int status = PCCD_OK;
    if (r == link->rank && count > 0) {
        uint64_t at = count_of(merge->world) - stream->left;
        memcpy(stream->records, records_of(merge->world) + at * merge->record_bytes,
               count * merge->record_bytes);
    } else if (count > 0) {
        MPI_Request request;
        status = ranks_mpi(link,
                           MPI_Irecv(stream->records, (int)(count * merge->record_bytes),
                                     MPI_BYTE, r, TAG_RECORDS, link->comm, &request),
                           "gathering records");
        status = status == PCCD_OK ? ranks_wait(link, &request, 1) : status;
    }
    stream->at = 0;
    stream->count = status == PCCD_OK ? count : 0;
    stream->left -= stream->count;
    return status;
}

static void flush(struct merge *merge)
{
    if (merge->out_count > 0 && merge->verdict == 0) {
        merge->verdict = merge->each(merge->context, merge->out, merge->out_count);
    }
    merge->out_count = 0;
}

/* One more record; of bounds without their names. */
static void put(struct merge *merge, const char *record)
{
    size_t bytes = merge->world->has_bounds ? sizeof(double) : merge->record_bytes;
    const struct ranks_bound *bound = (const void *)record;
    memcpy(merge->out + merge->out_count++ * bytes,
           merge->world->has_bounds ? (const char *)&bound->bound : record, bytes);
}

/* The stream with the lowest record; -1: there is none. */
static int lowest(const struct merge *merge)
{
    const char *best = NULL;
    int found = -1;
    for (int r = 0; r < merge->world->link.size; r++) {
        const struct stream *stream = &merge->streams[r];
        const char *record = stream->records + stream->at * merge->record_bytes;
        if (stream->at < stream->count &&
            (best == NULL || is_before(merge->world, record, best))) {
            best = record;
            found = r;
        }
    }
    return found;
}

static int merge_all(struct merge *merge)
{
    int size = merge->world->link.size, status = PCCD_OK;
    for (int r = 0; r < size && status == PCCD_OK; r++) {
        status = receive(merge, r);
    }
    for (int r = lowest(merge); r >= 0 && status == PCCD_OK && merge->verdict == 0;
         r = lowest(merge)) {
        struct stream *stream = &merge->streams[r];
        put(merge, stream->records + stream->at++ * merge->record_bytes);
        if (merge->out_count == CHUNK_RECORDS) {
            flush(merge);
        }
        if (stream->at == stream->count) {
            status = receive(merge, r);
        }
    }
    flush(merge);
    for (int r = 0; r < size; r++) { /* what the caller took no more */
        while (status == PCCD_OK && merge->streams[r].left > 0) {
            status = receive(merge, r);
        }
    }
    return status;
}

static int make_streams(struct merge *merge, const uint64_t *counts)
{
    int size = merge->world->link.size;
    merge->out = ranks_array(CHUNK_RECORDS, merge->record_bytes);
    merge->streams = calloc((size_t)size, sizeof *merge->streams);
    if (merge->out == NULL || merge->streams == NULL) {
        return ranks_no_memory(merge->world);
    }
    for (int r = 0; r < size; r++) {
        merge->streams[r].left = counts[r];
        merge->streams[r].records = ranks_array(CHUNK_RECORDS, merge->record_bytes);
        if (merge->streams[r].records == NULL) {
            return ranks_no_memory(merge->world);
        }
    }
    return PCCD_OK;
}

int pccd_mpi_gather(struct pccd_mpi *world, int root, pccd_mpi_records_fn each,
                    void *context)
{
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct ranks_link *link = &world->link;
    struct merge merge = {.world = world,
                          .record_bytes = bytes_of(world),
                          .each = each,
                          .context = context};
    uint64_t *counts = ranks_array((uint64_t)link->size, sizeof *counts);
    int status = counts == NULL ? ranks_no_memory(world) : PCCD_OK;
    if (root < 0 || root >= link->size) {
        status = ranks_fail(link, PCCD_E_INVAL, "there is no rank %d", root);
    } else if (each == NULL && root == link->rank) {
        status = ranks_missing(link, "each");
    }
    status = ranks_agree(link, RANKS_GATHER, (uint64_t)root, status);
    if (status == PCCD_OK) {
        status = ranks_tell_all(link, count_of(world), counts);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(link, link->rank == root ? make_streams(&merge, counts)
                                                         : PCCD_OK);
    }
    if (status == PCCD_OK) {
        status = link->rank == root ? merge_all(&merge) : serve(world, root);
    }
    if (status == PCCD_OK && merge.verdict != 0) {
        status = ranks_fail(link, PCCD_E_CANCELLED, "rank %d took no more records", root);
    }
    status = link->broken != PCCD_OK ? status : ranks_agree_on(link, status);
    for (int r = 0; merge.streams != NULL && r < link->size; r++) {
        free(merge.streams[r].records);
    }
    free(merge.streams);
    free(merge.out);
    free(counts);
    return status;
}

/* ---- shares ----------------------------------------------------------------------- */

int pccd_mpi_get_share(struct pccd_mpi *world, struct pccd_mpi_share *share)
{
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    struct pccd_mpi_share now = world->share;
    int status =
        ranks_agree(&world->link, RANKS_GET_SHARE, 0,
                    share == NULL ? ranks_missing(&world->link, "share") : PCCD_OK);
    if (status != PCCD_OK) {
        return status;
    }
    now.own = now.ghosts = now.own_vertices = now.ghost_vertices = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        now.own += object->own_count;
        now.ghosts += object->ghost_count;
        now.own_vertices += object->own_vertex_count;
        now.ghost_vertices += object->local.vertex_count - object->own_vertex_count;
    }
    size_t bytes = share->struct_bytes;
    now.struct_bytes = bytes;
    memcpy(share, &now, bytes == 0 || bytes > sizeof now ? sizeof now : bytes);
    return PCCD_OK;
}
