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

#define VERTEX_BYTES ((uint64_t)12)
/* A header that has more frames than the file is wrong, rather than the file cut off. */
#define CUT_FRAMES_MAX ((uint32_t)1 << 20)

/* Where in a header things are. */
struct kind {
    bool is_mdd; /* and so has seconds, and the highest byte first */
    size_t header_bytes, frames_at, vertices_at;
};
static const struct kind pc2 = {false, 32, 28, 16}, mdd = {true, 8, 0, 4};

struct cache {
    struct kind kind;
    uint64_t first_byte; /* of the first frame's positions */
    uint64_t bytes;      /* of the file, by its header */
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
static int read_at(const struct ctl_file *file, uint64_t offset, char *to, size_t bytes,
                   struct ctl_error *error)
{
    if (offset + bytes <= file->bytes) {
        memcpy(to, file->data + offset, bytes);
        return PCCD_OK;
    }
    for (size_t have = 0; have < bytes;) {
        ssize_t got = pread(file->fd, to + have, bytes - have, (off_t)(offset + have));
        if (got == 0 || (got < 0 && errno != EINTR)) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot read: %s", file->path,
                                 got == 0 ? "it has become shorter" : strerror(errno));
        }
        have += got > 0 ? (size_t)got : 0;
    }
    return PCCD_OK;
}

/* Return whether two frames are the same, byte for byte; false also after an error. */
static bool is_same(struct ctl_file *file, uint64_t first_byte, uint64_t frame_bytes)
{
    char first[4096], second[4096];
    bool is_same = true;
    for (uint64_t at = first_byte, end = at + frame_bytes; at < end && is_same;
         at += sizeof first) {
        size_t now = end - at < sizeof first ? (size_t)(end - at) : sizeof first;
        file->status = read_at(file, at, first, now, file->error);
        if (file->status == PCCD_OK) {
            file->status = read_at(file, at + frame_bytes, second, now, file->error);
        }
        is_same = file->status == PCCD_OK && memcmp(first, second, now) == 0;
    }
    return is_same;
}

/* Refuse a file of another size than its header says; `before`: what that is about. */
static int refuse_size(const struct ctl_file *file, const char *before, uint32_t frames,
                       uint32_t vertices, uint64_t said, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_FORMAT,
                         "%s: %sby its header, %" PRIu32 " frames of %" PRIu32
                         " vertices, it has %" PRIu64 " bytes; it has %" PRIu64,
                         file->path, before, frames, vertices, said, ctl_file_size(file));
}

/* The size that the header says is the file's. Blender writes the first frame of an MDD
 * twice, and counts it once; of a file that is cut off, it is taken to be there twice if
 * the first two frames are the same. */
static int judge_size(struct ctl_file *file, struct cache *cache, uint32_t frames,
                      uint32_t vertices, bool takes_cut)
{
    uint64_t size = ctl_file_size(file), frame_bytes = VERTEX_BYTES * vertices, said;
    cache->first_byte =
        cache->kind.header_bytes + (cache->kind.is_mdd ? 4 * (uint64_t)frames : 0);
    if (__builtin_mul_overflow(frame_bytes, frames, &said) ||
        __builtin_add_overflow(said, cache->first_byte, &said)) {
        said = UINT64_MAX;
    }
    bool is_whole = said < size && size - said == frame_bytes;
    bool may_be_cut = takes_cut && frames <= CUT_FRAMES_MAX && said != UINT64_MAX &&
                      said != size && (size < said || size - said < frame_bytes) &&
                      size >= cache->first_byte + 2 * frame_bytes;
    bool is_double = cache->kind.is_mdd && (is_whole || may_be_cut) &&
                     is_same(file, cache->first_byte, frame_bytes);
    cache->first_byte += is_double ? frame_bytes : 0;
    cache->bytes = said + (is_double ? frame_bytes : 0);
    bool is_cut =
        may_be_cut && cache->bytes > size && size >= cache->first_byte + 2 * frame_bytes;
    return file->status != PCCD_OK || said == size || cache->bytes == size || is_cut
               ? file->status
               : refuse_size(file, "", frames, vertices, cache->bytes, file->error);
}

/* Return whether all are far below what no coordinate may exceed, by their bits without
 * the sign, four at a time: a cache is read as fast as a disk, and compilers leave the
 * plain loop as it is. */
static bool are_small(const float *x, uint64_t count)
{
    typedef int32_t words __attribute__((vector_size(16)));
    const float most = (float)(PROTO_COORDINATE_MAX / 2);
    int32_t bits;
    memcpy(&bits, &most, sizeof bits);
    words now, large = {0};
    uint64_t i = 0;
    for (; i + 4 <= count; i += 4) {
        memcpy(&now, x + i, sizeof now);
        large |= (now & INT32_MAX) > bits;
    }
    now = (words){0};
    memcpy(&now, x + i, (count - i) * sizeof *x);
    large |= (now & INT32_MAX) > bits;
    return (large[0] | large[1] | large[2] | large[3]) == 0;
}

static int read_frame(const struct ctl_motion *motion, uint32_t frame, void *x,
                      struct ctl_error *error)
{
    const struct ctl_file *file = &motion->file;
    const struct cache *cache = motion->state;
    const uint64_t bytes = VERTEX_BYTES * motion->vertex_count;
    const uint64_t first = cache->first_byte + bytes * frame;
    const uint64_t count = bytes / sizeof(float);
    float *to = x;
    if (first + bytes > ctl_file_size(file)) {
        char before[40];
        (void)snprintf(before, sizeof before, "frame %" PRIu32 " is cut off: ", frame);
        return refuse_size(file, before, motion->frame_count, motion->vertex_count,
                           cache->bytes, error);
    }
    int status = read_at(file, first, x, bytes, error);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint64_t i = 0; i < count && cache->kind.is_mdd; i++) {
        to[i] = float_at(cache, (const char *)&to[i]);
    }
    uint64_t index = are_small(to, count) ? count : 0;
    while (index < count && common_is_coordinate((double)to[index])) {
        index++;
    }
    return index == count ? PCCD_OK
                          : ctl_error_set(error, PCCD_E_NOTFINITE,
                                          "%s: byte %" PRIu64 ", frame %" PRIu32
                                          ", vertex %" PRIu64 ": coordinate %c is %g",
                                          file->path, first + 4 * index, frame, index / 3,
                                          "xyz"[index % 3], (double)to[index]);
}

static void name_frame(const struct ctl_motion *motion, uint32_t frame, char *text,
                       size_t bytes)
{
    const struct cache *cache = motion->state;
    bool is_mdd = cache->kind.is_mdd;
    uint64_t at = is_mdd ? cache->kind.header_bytes + 4 * (uint64_t)frame : 20;
    struct ctl_error ignored;
    char numbers[8] = {0};
    (void)read_at(&motion->file, at, numbers, is_mdd ? 4 : 8, &ignored);
    double first = (double)float_at(cache, numbers);
    double step = (double)float_at(cache, numbers + 4);
    (void)snprintf(text, bytes, is_mdd ? "%.9g s" : "frame %.9g",
                   is_mdd ? first : first + step * frame);
}

static int open_cache(struct ctl_motion *motion, const struct kind *kind, bool takes_cut)
{
    struct ctl_file *file = &motion->file;
    const char *header = file->data;
    struct cache *cache = motion->state = malloc(sizeof *cache);
    if (cache == NULL) {
        return ctl_error_set(file->error, PCCD_E_NOMEM, "%s: no memory", file->path);
    }
    *cache = (struct cache){.kind = *kind};
    if (file->bytes < kind->header_bytes) {
        return ctl_error_set(file->error, PCCD_E_FORMAT,
                             "%s: a header has %zu bytes; the file has %zu", file->path,
                             kind->header_bytes, file->bytes);
    }
    if (!kind->is_mdd && memcmp(header, "POINTCACHE2", 12) != 0) {
        return ctl_error_set(file->error, PCCD_E_FORMAT,
                             "%s: a PC2 file begins with \"POINTCACHE2\" and a byte 0",
                             file->path);
    }
    if (!kind->is_mdd && word_at(cache, header + 12) != 1) {
        return ctl_error_set(file->error, PCCD_E_FORMAT,
                             "%s: version %" PRIu32 " of PC2, and only 1 is read",
                             file->path, word_at(cache, header + 12));
    }
    uint32_t frames = word_at(cache, header + kind->frames_at);
    uint32_t vertices = word_at(cache, header + kind->vertices_at);
    if (frames == 0 || frames > CTL_MESH_COUNT_MAX || vertices == 0 ||
        vertices > CTL_MESH_COUNT_MAX) {
        return ctl_error_set(file->error, PCCD_E_FORMAT,
                             "%s: the header has %" PRId32 " frames of %" PRId32
                             " vertices",
                             file->path, (int32_t)frames, (int32_t)vertices);
    }
    motion->frame_count = frames;
    motion->vertex_count = vertices;
    motion->format = PCCD_FORMAT_F32;
    motion->read = read_frame;
    motion->name = name_frame;
    return judge_size(file, cache, frames, vertices, takes_cut);
}

int ctl_pc2_open(struct ctl_motion *motion, const struct ctl_motion_wish *wish)
{
    return open_cache(motion, &pc2, wish != NULL && wish->takes_cut);
}

int ctl_mdd_open(struct ctl_motion *motion, const struct ctl_motion_wish *wish)
{
    return open_cache(motion, &mdd, wish != NULL && wish->takes_cut);
}
