/* reader.c - the chunks of a recording, one after the other. */
#include "reader.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int fail(struct record_reader *reader, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static int fail(struct record_reader *reader, int status, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(reader->text, sizeof reader->text, format, arguments);
    va_end(arguments);
    return status;
}

/* `bytes` from `offset`, or fewer where the file has become shorter: then `*got`. */
static int copy(struct record_reader *reader, uint64_t offset, void *to, size_t bytes,
                size_t *got)
{
    *got = 0;
    if (reader->fd < 0) {
        memcpy(to, (const uint8_t *)reader->memory + offset, bytes);
        *got = bytes;
        return 0;
    }
    while (*got < bytes) {
        ssize_t more =
            pread(reader->fd, (uint8_t *)to + *got, bytes - *got, (off_t)(offset + *got));

        if (more < 0 && errno == EINTR) {
            continue;
        }
        if (more < 0) {
            return fail(reader, PCCD_E_SYSTEM, "at byte %" PRIu64 ": %s", offset,
                        strerror(errno));
        }
        if (more == 0) {
            break;
        }
        *got += (size_t)more;
    }
    return 0;
}

/* The release that wrote the file, which is in its first chunk; else "". BEGIN is never
 * given another layout, and is too short to be compressed. */
static void read_release(struct record_reader *reader, char release[17])
{
    struct {
        struct record_chunk chunk;
        struct record_begin begin;
    } first;
    char why[RECORD_TEXT_BYTES];
    size_t got = 0;

    release[0] = '\0';
    if (reader->bytes < RECORD_HEAD_BYTES + sizeof first ||
        copy(reader, RECORD_HEAD_BYTES, &first, sizeof first, &got) != 0 ||
        got != sizeof first || record_chunk_judge(&first.chunk, why) != 0 ||
        first.chunk.kind != RECORD_BEGIN || first.chunk.encoding != RECORD_STORED ||
        first.chunk.bytes != sizeof first.begin) {
        return;
    }
    memcpy(release, first.begin.library, sizeof first.begin.library);
    release[sizeof first.begin.library] = '\0';
}

static int judge_head(struct record_reader *reader)
{
    struct {
        char magic[8];
        uint32_t version;
        uint32_t reserved;
    } head;
    char release[17];
    size_t got = 0;
    int status = 0;

    if (reader->bytes >= sizeof head) {
        status = copy(reader, 0, &head, sizeof head, &got);
    }
    if (status != 0) {
        return status;
    }
    if (got != sizeof head || memcmp(head.magic, RECORD_MAGIC, sizeof head.magic) != 0) {
        return fail(reader, PCCD_E_FORMAT, "not a recording of pccd");
    }
    if (head.version != RECORD_VERSION) {
        read_release(reader, release);
        return fail(reader, PCCD_E_FORMAT,
                    "a recording of version %" PRIu32 "%s%s, and this program reads %u",
                    head.version, release[0] != '\0' ? " by pccd " : "", release,
                    RECORD_VERSION);
    }
    reader->offset = sizeof head;
    return 0;
}

int record_reader_open(struct record_reader *reader, const char *path)
{
    struct stat info;

    /* A pipe without a writer would not open; it is refused below. */
    *reader = (struct record_reader){.fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    if (reader->fd < 0 || fstat(reader->fd, &info) != 0) {
        return fail(reader, PCCD_E_SYSTEM, "%s", strerror(errno));
    }
    if (!S_ISREG(info.st_mode)) {
        return fail(reader, PCCD_E_FORMAT, "not a file");
    }
    reader->bytes = (uint64_t)info.st_size;
    return judge_head(reader);
}

int record_reader_open_memory(struct record_reader *reader, const void *memory,
                              uint64_t bytes)
{
    *reader = (struct record_reader){.fd = -1, .memory = memory, .bytes = bytes};
    return judge_head(reader);
}

void record_reader_deinit(struct record_reader *reader)
{
    if (reader->fd >= 0) {
        (void)close(reader->fd);
    }
    free(reader->stored);
    free(reader->payload);
    *reader = (struct record_reader){.fd = -1};
}

void record_reader_seek(struct record_reader *reader, uint64_t offset)
{
    reader->offset = offset;
    reader->ending = RECORD_ENDING_UNKNOWN;
}

/* Nothing more can be read, and why. */
static int end(struct record_reader *reader, bool is_cut)
{
    reader->ending = is_cut            ? RECORD_ENDING_CUT
                     : reader->has_end ? RECORD_ENDING_WHOLE
                                       : RECORD_ENDING_OPEN;
    return 0;
}

static int make_room(struct record_reader *reader, uint8_t **buffer, size_t *room,
                     uint64_t bytes)
{
    uint8_t *larger;

    if (bytes <= *room) {
        return 0;
    }
    larger = malloc(bytes);
    if (larger == NULL) {
        return fail(reader, PCCD_E_NOMEM, "at byte %" PRIu64 ": no memory for %" PRIu64,
                    reader->offset, bytes);
    }
    free(*buffer);
    *buffer = larger;
    *room = bytes;
    return 0;
}

static int damaged(struct record_reader *reader, const struct record_chunk *chunk,
                   int status, const char *why)
{
    const char *name = chunk != NULL ? record_kind_name(chunk->kind) : NULL;

    return fail(reader, status, "at byte %" PRIu64 "%s%s: %s", reader->offset,
                name != NULL ? ", " : "", name != NULL ? name : "", why);
}

/* A header whose 48 bytes are zeros is what a machine that lost its power leaves. */
static bool is_empty(const struct record_chunk *chunk)
{
    static const struct record_chunk zeros;

    return memcmp(chunk, &zeros, sizeof zeros) == 0;
}

/* The header at reader->offset: 1, 0 at the end, or a failure. */
static int read_header(struct record_reader *reader, struct record_chunk *chunk)
{
    char why[RECORD_TEXT_BYTES];
    uint64_t left = reader->bytes - reader->offset;
    size_t got = 0;
    int status;

    if (left < sizeof *chunk) {
        return end(reader, left > 0);
    }
    status = copy(reader, reader->offset, chunk, sizeof *chunk, &got);
    if (status != 0) {
        return status;
    }
    if (got != sizeof *chunk || is_empty(chunk)) {
        return end(reader, true);
    }
    status = record_chunk_judge(chunk, why);
    if (status != 0) {
        return damaged(reader, NULL, status, why);
    }
    if (chunk->stored_bytes > left - sizeof *chunk) {
        return end(reader, true);
    }
    return 1;
}

/* Vertices of the largest mesh so far: no place has more. */
static void note_vertices(struct record_reader *reader, uint16_t kind)
{
    struct record_mesh mesh;
    uint32_t count = 0;

    if (kind == RECORD_MESH || kind == RECORD_GUEST) {
        memcpy(&mesh, reader->payload, sizeof mesh);
        count = mesh.vertex_count;
    }
    reader->vertex_count_max =
        count > reader->vertex_count_max ? count : reader->vertex_count_max;
}

static uint64_t place_bytes_max(const struct record_reader *reader)
{
    uint64_t free = reader->vertex_count_max * sizeof(double[3]);

    return sizeof(struct record_place) +
           (free > sizeof(double[12]) ? free : sizeof(double[12]));
}

static int read_payload(struct record_reader *reader, const struct record_chunk *chunk)
{
    char why[RECORD_TEXT_BYTES];
    size_t got = 0;
    int status =
        make_room(reader, &reader->stored, &reader->stored_room, chunk->stored_bytes + 1);

    status = status != 0 ? status
                         : copy(reader, reader->offset + sizeof *chunk, reader->stored,
                                chunk->stored_bytes, &got);
    if (status != 0) {
        return status;
    }
    if (got != chunk->stored_bytes) {
        return end(reader, true);
    }
    status = record_chunk_measure(chunk, reader->stored, why);
    if (status == 0 && chunk->kind == RECORD_PLACE &&
        chunk->bytes > place_bytes_max(reader)) {
        (void)snprintf(why, sizeof why, "a place of more vertices than a mesh has");
        status = PCCD_E_FORMAT;
    }
    if (status != 0) {
        return damaged(reader, chunk, status, why);
    }
    status = make_room(reader, &reader->payload, &reader->payload_room, chunk->bytes + 1);
    if (status != 0) {
        return status;
    }
    status = record_chunk_unpack(chunk, reader->stored, reader->payload, why);
    if (status == 0) {
        status = record_payload_judge(chunk->kind, reader->payload, chunk->bytes, why);
    }
    if (status != 0) {
        return damaged(reader, chunk, status, why);
    }
    note_vertices(reader, chunk->kind);
    return 1;
}

int record_reader_skim(struct record_reader *reader, uint32_t kinds,
                       struct record_view *view)
{
    for (;;) {
        struct record_chunk chunk;
        bool is_wanted = false;
        int status = read_header(reader, &chunk);

        if (status == 1 && record_kind_name(chunk.kind) != NULL &&
            (kinds & 1u << chunk.kind) != 0) {
            is_wanted = true;
            status = read_payload(reader, &chunk);
        }
        if (status != 1) {
            return status;
        }
        *view = (struct record_view){.offset = reader->offset,
                                     .kind = chunk.kind,
                                     .time_ns = chunk.time_ns,
                                     .sum = chunk.header_sum,
                                     .bytes = chunk.bytes,
                                     .payload = is_wanted ? reader->payload : NULL};
        reader->offset += sizeof chunk + (chunk.stored_bytes + 7) / 8 * 8;
        if (reader->offset > reader->bytes) {
            reader->offset = reader->bytes; /* cut in the padding: nothing is lost */
        }
        reader->has_end = chunk.kind == RECORD_END;
        if (reader->has_end && is_wanted) {
            memcpy(&reader->end_reason, reader->payload, sizeof reader->end_reason);
        }
        if (record_kind_name(chunk.kind) != NULL) {
            return 1;
        }
    }
}

int record_reader_next(struct record_reader *reader, struct record_view *view)
{
    return record_reader_skim(reader, UINT32_MAX, view);
}
