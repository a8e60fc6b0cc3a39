/* film.c - an animated PNG. */
#include "picture.h"

#include <assert.h>
#include <errno.h>
#include <string.h>
#include <zlib.h>

#include "pccd_types.h"

#define SIGNATURE_BYTES 8u
#define CHUNK_BYTES     12u /* length, type and checksum of a chunk */

/* A chunk of a PNG in memory. */
struct chunk {
    const unsigned char *data;
    uint32_t bytes;
    char type[5];
};

static void put_number(unsigned char *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        to[i] = (unsigned char)(value >> 8 * (bytes - 1 - i));
    }
}

/* The chunk at *at, which moves behind it; false at the end, or where it is none. */
static bool next_chunk(const unsigned char *png, size_t bytes, size_t *at,
                       struct chunk *chunk)
{
    if (bytes - *at < CHUNK_BYTES) {
        return false;
    }
    const unsigned char *head = png + *at;
    chunk->bytes = (uint32_t)head[0] << 24 | (uint32_t)head[1] << 16 |
                   (uint32_t)head[2] << 8 | head[3];
    memcpy(chunk->type, head + 4, 4);
    chunk->type[4] = '\0';
    chunk->data = head + 8;
    if (chunk->bytes > bytes - *at - CHUNK_BYTES) {
        return false;
    }
    *at += CHUNK_BYTES + chunk->bytes;
    return true;
}

/* A chunk of `lead` and `data`, one behind the other. */
static int write_chunk(struct film *film, const char *type, const unsigned char *lead,
                       uint32_t lead_bytes, const unsigned char *data, uint32_t bytes,
                       struct ctl_error *error)
{
    unsigned char head[8], tail[4];
    put_number(head, lead_bytes + bytes, 4);
    memcpy(head + 4, type, 4);
    uLong sum = crc32(crc32(0, Z_NULL, 0), head + 4, 4);
    sum = lead_bytes > 0 ? crc32(sum, lead, lead_bytes) : sum;
    sum = bytes > 0 ? crc32(sum, data, bytes) : sum;
    put_number(tail, (uint32_t)sum, 4);
    if (fwrite(head, sizeof head, 1, film->to) != 1 ||
        (lead_bytes > 0 && fwrite(lead, lead_bytes, 1, film->to) != 1) ||
        (bytes > 0 && fwrite(data, bytes, 1, film->to) != 1) ||
        fwrite(tail, sizeof tail, 1, film->to) != 1) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", film->path,
                             strerror(errno));
    }
    return PCCD_OK;
}

void film_begin(struct film *film, FILE *to, const char *path, uint32_t frame_count,
                uint32_t frames_a_second)
{
    assert(frame_count >= 1 && frame_count <= FILM_FRAMES_MAX && frames_a_second >= 1);
    *film = (struct film){.to = to,
                          .path = path,
                          .frame_count = frame_count,
                          .frames_a_second = frames_a_second};
}

/* How many pictures there are, and that they begin again without end. */
static int write_count(struct film *film, struct ctl_error *error)
{
    unsigned char data[8] = {0};
    put_number(data, film->frame_count, 4);
    return write_chunk(film, "acTL", NULL, 0, data, sizeof data, error);
}

/* The next picture takes the place of the last one, all of it. */
static int write_frame(struct film *film, struct ctl_error *error)
{
    unsigned char data[26] = {0};
    put_number(data, film->sequence++, 4);
    memcpy(data + 4, film->head, 8); /* width, height; no offset */
    put_number(data + 20, 1, 2);
    put_number(data + 22, film->frames_a_second, 2);
    return write_chunk(film, "fcTL", NULL, 0, data, sizeof data, error);
}

static int write_pixels(struct film *film, const struct chunk *chunk,
                        struct ctl_error *error)
{
    unsigned char number[4];
    if (film->written == 0) {
        return write_chunk(film, "IDAT", NULL, 0, chunk->data, chunk->bytes, error);
    }
    put_number(number, film->sequence++, 4);
    return write_chunk(film, "fdAT", number, sizeof number, chunk->data, chunk->bytes,
                       error);
}

/* Of the first picture all but pixels and end; of the others nothing but that they are
 * like it. */
static int take_head(struct film *film, const unsigned char *png,
                     const struct chunk *chunk, struct ctl_error *error)
{
    bool is_head = strcmp(chunk->type, "IHDR") == 0;
    int status = PCCD_OK;
    if (film->written > 0) {
        return is_head && (chunk->bytes != sizeof film->head ||
                           memcmp(chunk->data, film->head, sizeof film->head) != 0)
                   ? ctl_error_set(error, PCCD_E_INVAL,
                                   "%s: picture %u has another size than the first",
                                   film->path, film->written + 1)
                   : PCCD_OK;
    }
    if (is_head && chunk->bytes == sizeof film->head) {
        memcpy(film->head, chunk->data, sizeof film->head);
        if (fwrite(png, SIGNATURE_BYTES, 1, film->to) != 1) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", film->path,
                                 strerror(errno));
        }
    }
    status = write_chunk(film, chunk->type, NULL, 0, chunk->data, chunk->bytes, error);
    return status == PCCD_OK && is_head ? write_count(film, error) : status;
}

int film_add(struct film *film, const void *png, size_t bytes, struct ctl_error *error)
{
    struct chunk chunk;
    size_t at = SIGNATURE_BYTES;
    bool has_pixels = false;
    int status = PCCD_OK;
    while (status == PCCD_OK && bytes >= at && next_chunk(png, bytes, &at, &chunk)) {
        bool is_pixels = strcmp(chunk.type, "IDAT") == 0;
        if (is_pixels && !has_pixels) {
            status = write_frame(film, error);
        }
        if (status == PCCD_OK && is_pixels) {
            status = write_pixels(film, &chunk, error);
        } else if (status == PCCD_OK && strcmp(chunk.type, "IEND") != 0) {
            status = take_head(film, png, &chunk, error);
        }
        has_pixels = has_pixels || is_pixels;
    }
    film->written += status == PCCD_OK;
    return status;
}

int film_end(struct film *film, struct ctl_error *error)
{
    assert(film->written == film->frame_count);
    return write_chunk(film, "IEND", NULL, 0, NULL, 0, error);
}
