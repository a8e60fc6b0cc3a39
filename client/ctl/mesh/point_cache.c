/* client/ctl/mesh/point_cache.c - positions from PC2 and MDD files, which have no faces.
 *
 * PC2: 12 bytes "POINTCACHE2\\0", int32 1, int32 vertices, float32 start, float32 step,
 * int32 frames, float32 x, y, z of each vertex of each frame, the lowest byte first. MDD:
 * int32 frames, int32 vertices, float32 seconds of each frame, then positions as in PC2,
 * the highest byte first.
 *
 * Threads: one at a time.
 */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "meshfile.h"

#define PIECE_BYTES  ((size_t)12 * 5461)
#define VERTEX_BYTES ((uint64_t)12)

/* Where in a header things are. */
struct kind {
    bool is_mdd; /* and so has seconds, and the highest byte first */
    size_t header_bytes, frames_at, vertices_at;
};
static const struct kind pc2 = {false, 32, 28, 16}, mdd = {true, 8, 0, 4};

struct cache {
    struct kind kind;
    struct ctl_file file; /* a large one: its beginning */
    uint64_t first_byte;  /* of the first frame's positions */
    char path[];
};

static uint32_t word_at(const struct cache *cache, const char *at)
{
    uint32_t word = ctl_file_word(at);
    return cache->kind.is_mdd ? __builtin_bswap32(word) : word;
}

static float float_at(const struct cache *cache, const char *at)
{
    uint32_t word = word_at(cache, at);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* Bytes that the file has, or had when it was opened. */
static int read_at(const struct cache *cache, uint64_t offset, char *to, size_t bytes,
                   struct ctl_error *error)
{
    const struct ctl_file *file = &cache->file;
    if (offset + bytes <= file->bytes) {
        memcpy(to, file->data + offset, bytes);
        return PCCD_OK;
    }
    for (size_t have = 0; have < bytes;) {
        ssize_t got = pread(file->fd, to + have, bytes - have, (off_t)(offset + have));
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot read: %s", cache->path,
                                 got == 0 ? "it has become shorter" : strerror(errno));
        }
        have += got > 0 ? (size_t)got : 0;
    }
    return PCCD_OK;
}

/* Whether the first two frames are the same, byte for byte. */
static int compare_frames(const struct cache *cache, uint64_t frame_bytes, bool *is_same,
                          struct ctl_error *error)
{
    char first[4096], second[4096];
    int status = PCCD_OK;
    *is_same = true;
    for (uint64_t at = 0; at < frame_bytes && *is_same && status == PCCD_OK;
         at += sizeof first) {
        uint64_t left = frame_bytes - at, from = cache->first_byte + at;
        size_t now = left < sizeof first ? (size_t)left : sizeof first;
        status = read_at(cache, from, first, now, error);
        if (status == PCCD_OK) {
            status = read_at(cache, from + frame_bytes, second, now, error);
        }
        *is_same = status == PCCD_OK && memcmp(first, second, now) == 0;
    }
    return status;
}

/* The size that the header says is the file's. Blender writes the first frame of an MDD
 * twice, and counts it once. */
static int judge_size(struct cache *cache, uint32_t frames, uint32_t vertices,
                      struct ctl_error *error)
{
    const struct ctl_file *file = &cache->file;
    uint64_t size = ctl_file_size(file), frame_bytes = VERTEX_BYTES * vertices, said;
    bool is_double = false;
    cache->first_byte =
        cache->kind.header_bytes + (cache->kind.is_mdd ? 4 * (uint64_t)frames : 0);
    if (__builtin_mul_overflow(frame_bytes, frames, &said) ||
        __builtin_add_overflow(said, cache->first_byte, &said)) {
        said = UINT64_MAX;
    }
    if (cache->kind.is_mdd && said < size && size - said == frame_bytes) {
        int status = compare_frames(cache, frame_bytes, &is_double, error);
        if (status != PCCD_OK) {
            return status;
        }
    }
    cache->first_byte += is_double ? frame_bytes : 0;
    return said == size || is_double
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_FORMAT,
                               "%s: by its header, %" PRIu32 " frames of %" PRIu32
                               " vertices, it has %" PRIu64 " bytes; it has %" PRIu64,
                               cache->path, frames, vertices, said, size);
}

static int judge(struct cache *cache, struct ctl_motion *motion, struct ctl_error *error)
{
    const char *header = cache->file.data;
    const struct kind *kind = &cache->kind;
    if (cache->file.bytes < kind->header_bytes) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: a header has %zu bytes; the file has %zu", cache->path,
                             kind->header_bytes, cache->file.bytes);
    }
    if (!kind->is_mdd && memcmp(header, "POINTCACHE2", 12) != 0) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: a PC2 file begins with \"POINTCACHE2\" and a byte 0",
                             cache->path);
    }
    if (!kind->is_mdd && word_at(cache, header + 12) != 1) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: version %" PRIu32 " of PC2, and only 1 is read",
                             cache->path, word_at(cache, header + 12));
    }
    uint32_t frames = word_at(cache, header + kind->frames_at);
    uint32_t vertices = word_at(cache, header + kind->vertices_at);
    if (frames == 0 || frames > CTL_MESH_COUNT_MAX || vertices == 0 ||
        vertices > CTL_MESH_COUNT_MAX) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: the header has %" PRId32 " frames of %" PRId32
                             " vertices",
                             cache->path, (int32_t)frames, (int32_t)vertices);
    }
    motion->frame_count = frames;
    motion->vertex_count = vertices;
    return judge_size(cache, frames, vertices, error);
}

static int read_frame(const struct ctl_motion *motion, uint32_t frame, void *x,
                      struct ctl_error *error)
{
    const struct cache *cache = motion->state;
    const uint64_t bytes = VERTEX_BYTES * motion->vertex_count;
    const uint64_t first = cache->first_byte + bytes * frame;
    char piece[PIECE_BYTES];
    float *to = x;
    for (uint64_t at = 0; at < bytes; at += sizeof piece) {
        size_t now = bytes - at < sizeof piece ? (size_t)(bytes - at) : sizeof piece;
        int status = read_at(cache, first + at, piece, now, error);
        if (status != PCCD_OK) {
            return status;
        }
        for (size_t i = 0; i < now; i += 4, to++) {
            *to = float_at(cache, piece + i);
            if (!common_is_coordinate((double)*to)) {
                uint64_t index = (at + i) / 4;
                return ctl_error_set(error, PCCD_E_NOTFINITE,
                                     "%s: byte %" PRIu64 ", frame %" PRIu32
                                     ", vertex %" PRIu64 ": coordinate %c is %g",
                                     cache->path, first + at + i, frame, index / 3,
                                     "xyz"[index % 3], (double)*to);
            }
        }
    }
    return PCCD_OK;
}

static void name_frame(const struct ctl_motion *motion, uint32_t frame, char *text,
                       size_t bytes)
{
    const struct cache *cache = motion->state;
    bool is_mdd = cache->kind.is_mdd;
    uint64_t at = is_mdd ? cache->kind.header_bytes + 4 * (uint64_t)frame : 20;
    struct ctl_error ignored;
    char numbers[8] = {0};
    (void)read_at(cache, at, numbers, is_mdd ? 4 : 8, &ignored);
    double first = (double)float_at(cache, numbers);
    double step = (double)float_at(cache, numbers + 4);
    (void)snprintf(text, bytes, is_mdd ? "%.9g s" : "frame %.9g",
                   is_mdd ? first : first + step * frame);
}

static void close_cache(struct ctl_motion *motion)
{
    struct cache *cache = motion->state;
    ctl_file_deinit(&cache->file);
    free(cache);
    *motion = (struct ctl_motion){.state = NULL};
}

static int open_cache(const char *path, const struct kind *kind,
                      struct ctl_motion *motion, struct ctl_error *error)
{
    struct cache *cache = calloc(1, sizeof *cache + strlen(path) + 1);
    struct ctl_motion opened = {.format = PCCD_FORMAT_F32,
                                .state = cache,
                                .read = read_frame,
                                .name = name_frame,
                                .close = close_cache};
    if (cache == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", path);
    }
    strcpy(cache->path, path);
    cache->kind = *kind;
    int status = ctl_file_open(cache->path, &cache->file, error);
    if (status == PCCD_OK && cache->file.size == 0) {
        status = ctl_file_load(&cache->file, error); /* a pipe */
    }
    if (status == PCCD_OK) {
        status = judge(cache, &opened, error);
    }
    if (status == PCCD_OK) {
        *motion = opened;
    } else {
        close_cache(&opened);
    }
    return status;
}

int ctl_pc2_open(const char *path, const struct ctl_motion_wish *wish,
                 struct ctl_motion *motion, struct ctl_error *error)
{
    (void)wish;
    return open_cache(path, &pc2, motion, error);
}

int ctl_mdd_open(const char *path, const struct ctl_motion_wish *wish,
                 struct ctl_motion *motion, struct ctl_error *error)
{
    (void)wish;
    return open_cache(path, &mdd, motion, error);
}
