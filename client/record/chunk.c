/* chunk.c - one chunk of a recording, to and from bytes. */
#include "chunk.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>
#if HAVE_ZSTD
#include <zstd.h>
#endif

#define SMALL_BYTES 256u /* nothing is gained by compressing less */
#define ALIGN       8u
#define DULL        31u        /* chunks of a kind that gained less than an eighth */
#define SHRINK_MAX  65536u     /* zstd's best is half of it */
#define UNMEASURED  (1u << 20) /* a payload that short is unpacked at once */

static size_t padded(size_t bytes)
{
    return (bytes + ALIGN - 1) / ALIGN * ALIGN;
}

static uint64_t header_sum(const struct record_chunk *chunk)
{
    return XXH3_64bits(chunk, offsetof(struct record_chunk, header_sum));
}

bool record_has_zstd(void)
{
#if HAVE_ZSTD
    return true;
#else
    return false;
#endif
}

const char *record_kind_name(uint16_t kind)
{
    switch (kind) {
#define RECORD_NAME(name, number, text)                                                  \
    case number:                                                                         \
        return #name;
        RECORD_KINDS(RECORD_NAME)
#undef RECORD_NAME
    default:
        return NULL;
    }
}

/* ---- writing ----------------------------------------------------------------------- */

/* All of it, or the file as it was. */
static int append(struct record_writer *writer, const void *bytes, size_t count)
{
    size_t done = 0;

    while (done < count) {
        ssize_t more = pwrite(writer->fd, (const uint8_t *)bytes + done, count - done,
                              (off_t)(writer->bytes + done));

        if (more < 0 && errno == EINTR) {
            continue;
        }
        if (more <= 0) {
            int why = more == 0 ? ENOSPC : errno;

            /* Half a chunk would do no harm to a reader, but look like a crash. */
            if (done > 0 && ftruncate(writer->fd, (off_t)writer->bytes) != 0) {
                why = errno;
            }
            errno = why;
            return PCCD_E_SYSTEM;
        }
        done += (size_t)more;
    }
    writer->bytes += count;
    return 0;
}

struct head {
    char magic[8];
    uint32_t version;
    uint32_t reserved;
};
static_assert(sizeof(struct head) == RECORD_HEAD_BYTES, "head of a file");

int record_writer_open(struct record_writer *writer, const char *path)
{
    const struct head head = {RECORD_MAGIC, RECORD_VERSION, 0};
    int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    int status;

    if (fd < 0) {
        return PCCD_E_SYSTEM;
    }
    writer->fd = fd;
    writer->bytes = writer->raw_bytes = writer->bytes_max = writer->last = 0;
    status = append(writer, &head, sizeof head);
    if (status != 0) {
        int why = errno;

        (void)record_writer_close(writer);
        errno = why;
    }
    return status;
}

int record_writer_close(struct record_writer *writer)
{
    int status = writer->fd < 0 || close(writer->fd) == 0 ? 0 : PCCD_E_SYSTEM;

    writer->fd = -1;
    return status;
}

void record_writer_deinit(struct record_writer *writer)
{
    (void)record_writer_close(writer);
#if HAVE_ZSTD
    (void)ZSTD_freeCCtx(writer->squeeze);
#endif
    free(writer->raw);
    free(writer->out);
    writer->squeeze = NULL;
    writer->raw = writer->out = NULL;
    writer->raw_room = writer->out_room = 0;
}

/* Room that stays: after the largest payload nothing is allocated any more. */
static int make_room(uint8_t **buffer, size_t *room, size_t bytes)
{
    uint8_t *larger;

    if (bytes <= *room) {
        return 0;
    }
    bytes += bytes / 8;
    larger = malloc(bytes);
    if (larger == NULL) {
        return PCCD_E_NOMEM;
    }
    free(*buffer);
    *buffer = larger;
    *room = bytes;
    return 0;
}

uint64_t record_chunk_bytes_max(uint64_t payload_bytes)
{
    return sizeof(struct record_chunk) + payload_bytes + ALIGN;
}

/* Compress where it pays. Return false if it is to be stored as it is. `to` has room for
 * `bytes`. */
static bool squeeze(struct record_writer *writer, enum record_kind kind, const void *raw,
                    size_t bytes, void *to, size_t *stored)
{
#if HAVE_ZSTD
    size_t made;

    if (writer->level == 0 || bytes < SMALL_BYTES) {
        return false;
    }
    if (kind < RECORD_KINDS_MAX && writer->dull[kind] > 0) {
        writer->dull[kind]--;
        return false;
    }
    if (writer->squeeze == NULL) {
        writer->squeeze = ZSTD_createCCtx();
        if (writer->squeeze == NULL) {
            return false;
        }
    }
    made = ZSTD_compressCCtx(writer->squeeze, to, bytes, raw, bytes, writer->level);
    /* Positions of cloth are noise to it: of such, only now and then one is tried. */
    if (kind < RECORD_KINDS_MAX && (ZSTD_isError(made) || made > bytes - bytes / 8)) {
        writer->dull[kind] = DULL;
    }
    if (ZSTD_isError(made) || made >= bytes) {
        return false; /* it has become longer */
    }
    *stored = made;
    return true;
#else
    (void)writer;
    (void)kind;
    (void)raw;
    (void)bytes;
    (void)to;
    (void)stored;
    return false;
#endif
}

int record_writer_add(struct record_writer *writer, enum record_kind kind,
                      uint64_t time_ns, const struct record_part *parts, size_t count)
{
    struct record_chunk chunk = {
        .magic = RECORD_CHUNK_MAGIC, .kind = (uint16_t)kind, .time_ns = time_ns};
    size_t bytes = 0;
    size_t stored;
    uint8_t *body;
    int status;

    for (size_t i = 0; i < count; i++) {
        bytes += parts[i].bytes;
    }
    if (bytes > RECORD_BYTES_MAX) {
        return PCCD_E_LIMIT;
    }
    status = make_room(&writer->raw, &writer->raw_room, bytes);
    status = status != 0 ? status
                         : make_room(&writer->out, &writer->out_room,
                                     sizeof chunk + bytes + ALIGN);
    if (status != 0) {
        return status;
    }
    for (size_t i = 0, at = 0; i < count; at += parts[i].bytes, i++) {
        if (parts[i].bytes > 0) { /* else there may be no address */
            memcpy(writer->raw + at, parts[i].at, parts[i].bytes);
        }
    }
    body = writer->out + sizeof chunk;
    stored = bytes;
    if (squeeze(writer, kind, writer->raw, bytes, body, &stored)) {
        chunk.encoding = RECORD_ZSTD;
    } else {
        memcpy(body, writer->raw, bytes);
    }
    if (writer->bytes_max != 0 &&
        writer->bytes + sizeof chunk + padded(stored) > writer->bytes_max) {
        return PCCD_E_LIMIT;
    }
    chunk.bytes = bytes;
    chunk.stored_bytes = stored;
    chunk.stored_sum = XXH3_64bits(body, stored);
    chunk.header_sum = header_sum(&chunk);
    memcpy(writer->out, &chunk, sizeof chunk);
    memset(body + stored, 0, padded(stored) - stored);
    status = append(writer, writer->out, sizeof chunk + padded(stored));
    if (status == 0) {
        writer->raw_bytes += sizeof chunk + bytes;
        writer->last = writer->bytes - (sizeof chunk + padded(stored));
    }
    return status;
}

int record_writer_take_back(struct record_writer *writer)
{
    if (writer->last == 0 || ftruncate(writer->fd, (off_t)writer->last) != 0) {
        return PCCD_E_SYSTEM;
    }
    writer->bytes = writer->last;
    writer->last = 0;
    return 0;
}

/* ---- reading ----------------------------------------------------------------------- */

int record_chunk_judge(const struct record_chunk *chunk, char text[RECORD_TEXT_BYTES])
{
    const char *why = NULL;
    uint64_t wants;

    if (chunk->magic != RECORD_CHUNK_MAGIC) {
        why = "not the beginning of a chunk";
    } else if (chunk->header_sum != header_sum(chunk)) {
        why = "the header's checksum is wrong";
    } else if (chunk->bytes > RECORD_BYTES_MAX || chunk->stored_bytes > chunk->bytes) {
        why = "impossible lengths";
    } else if (chunk->bytes / SHRINK_MAX > chunk->stored_bytes) {
        why = "impossible lengths";
    } else if (chunk->encoding == RECORD_STORED && chunk->stored_bytes != chunk->bytes) {
        why = "impossible lengths";
    } else if (chunk->encoding > RECORD_ZSTD) {
        why = "unknown encoding";
    } else if (record_kind_name(chunk->kind) != NULL &&
               chunk->bytes > record_payload_most(chunk->kind, NULL, 0, &wants)) {
        why = "too long for its kind";
    }
    if (why != NULL) {
        (void)snprintf(text, RECORD_TEXT_BYTES, "%s", why);
        return PCCD_E_FORMAT;
    }
    return PCCD_OK;
}

#if HAVE_ZSTD
/* The first `bytes` of a payload. Takes memory for zstd's window, whatever the payload's
 * length. */
static int unpack_begin(const struct record_chunk *chunk, const void *stored, void *to,
                        size_t bytes, char text[RECORD_TEXT_BYTES])
{
    ZSTD_inBuffer in = {stored, chunk->stored_bytes, 0};
    ZSTD_outBuffer out = {to, bytes, 0};
    ZSTD_DCtx *unpacking = ZSTD_createDCtx();
    size_t left = 1, before;

    if (unpacking == NULL) {
        (void)snprintf(text, RECORD_TEXT_BYTES, "no memory for zstd");
        return PCCD_E_NOMEM;
    }
    do {
        before = in.pos + out.pos;
        left = ZSTD_decompressStream(unpacking, &out, &in);
    } while (!ZSTD_isError(left) && left > 0 && out.pos < out.size &&
             in.pos + out.pos > before);
    (void)ZSTD_freeDCtx(unpacking);
    if (ZSTD_isError(left) || out.pos < out.size) {
        (void)snprintf(text, RECORD_TEXT_BYTES, "zstd: %s",
                       ZSTD_isError(left) ? ZSTD_getErrorName(left) : "another length");
        return PCCD_E_FORMAT;
    }
    return PCCD_OK;
}

int record_chunk_measure(const struct record_chunk *chunk, const void *stored,
                         char text[RECORD_TEXT_BYTES])
{
    uint8_t *begin = NULL, *larger;
    uint64_t most, have = 0, wants = 0;
    int status = PCCD_OK;

    if (chunk->encoding == RECORD_STORED || chunk->bytes <= UNMEASURED) {
        return PCCD_OK; /* the file is as long, or it is little */
    }
    for (;;) {
        most = record_payload_most(chunk->kind, begin, have, &wants);
        if (wants == have || wants > chunk->bytes || status != PCCD_OK) {
            break;
        }
        larger = realloc(begin, wants);
        if (larger == NULL) {
            (void)snprintf(text, RECORD_TEXT_BYTES, "no memory for %llu bytes",
                           (unsigned long long)wants);
            status = PCCD_E_NOMEM;
            break;
        }
        begin = larger;
        status = unpack_begin(chunk, stored, begin, wants, text);
        have = wants;
    }
    free(begin);
    if (status == PCCD_OK && chunk->bytes > most) {
        (void)snprintf(text, RECORD_TEXT_BYTES,
                       "%llu bytes, and what it counts takes %llu at most",
                       (unsigned long long)chunk->bytes, (unsigned long long)most);
        status = PCCD_E_FORMAT;
    }
    return status;
}
#else
int record_chunk_measure(const struct record_chunk *chunk, const void *stored,
                         char text[RECORD_TEXT_BYTES])
{
    (void)chunk, (void)stored, (void)text;
    return PCCD_OK; /* what is compressed is refused */
}
#endif

int record_chunk_unpack(const struct record_chunk *chunk, const void *stored, void *to,
                        char text[RECORD_TEXT_BYTES])
{
    if (XXH3_64bits(stored, chunk->stored_bytes) != chunk->stored_sum) {
        (void)snprintf(text, RECORD_TEXT_BYTES, "the payload's checksum is wrong");
        return PCCD_E_FORMAT;
    }
    if (chunk->encoding == RECORD_STORED) {
        memcpy(to, stored, chunk->bytes);
        return PCCD_OK;
    }
#if HAVE_ZSTD
    size_t made = ZSTD_decompress(to, chunk->bytes, stored, chunk->stored_bytes);

    if (ZSTD_isError(made) || made != chunk->bytes) {
        (void)snprintf(text, RECORD_TEXT_BYTES, "zstd: %s",
                       ZSTD_isError(made) ? ZSTD_getErrorName(made) : "another length");
        return PCCD_E_FORMAT;
    }
    return PCCD_OK;
#else
    (void)snprintf(text, RECORD_TEXT_BYTES, "compressed, and this build has no zstd");
    return PCCD_E_FORMAT;
#endif
}
