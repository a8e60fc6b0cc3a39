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
static void write_chunk(struct film *film, const char *type, const unsigned char *lead,
                        uint32_t lead_bytes, const unsigned char *data, uint32_t bytes)
{
    unsigned char head[8], tail[4];
    put_number(head, lead_bytes + bytes, 4);
    memcpy(head + 4, type, 4);
    uLong sum = crc32(crc32(0, Z_NULL, 0), head + 4, 4);
    sum = lead_bytes > 0 ? crc32(sum, lead, lead_bytes) : sum;
    sum = bytes > 0 ? crc32(sum, data, bytes) : sum;
    put_number(tail, (uint32_t)sum, 4);
    fwrite(head, sizeof head, 1, film->to);
    if (lead_bytes > 0) {
        fwrite(lead, 1, lead_bytes, film->to);
    }
    if (bytes > 0) {
        fwrite(data, 1, bytes, film->to);
    }
    fwrite(tail, sizeof tail, 1, film->to);
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

/* The next picture takes the place of the last one, all of it. */
static void write_frame(struct film *film)
{
    unsigned char data[26] = {0};
    put_number(data, film->sequence++, 4);
    memcpy(data + 4, film->head, 8); /* width, height; no offset */
    put_number(data + 20, 1, 2);
    put_number(data + 22, film->frames_a_second, 2);
    write_chunk(film, "fcTL", NULL, 0, data, sizeof data);
}

static void write_pixels(struct film *film, const struct chunk *chunk)
{
    unsigned char number[4];
    if (film->written == 0) {
        write_chunk(film, "IDAT", NULL, 0, chunk->data, chunk->bytes);
    } else {
        put_number(number, film->sequence++, 4);
        write_chunk(film, "fdAT", number, sizeof number, chunk->data, chunk->bytes);
    }
}

/* Write a chunk of the first picture, all but pixels and end; behind its head how many
 * pictures there are, and that they begin again without end. */
static void write_head(struct film *film, const unsigned char *png,
                       const struct chunk *chunk)
{
    unsigned char count[8] = {0};
    bool is_head = strcmp(chunk->type, "IHDR") == 0;
    if (is_head) {
        memcpy(film->head, chunk->data, sizeof film->head);
        fwrite(png, SIGNATURE_BYTES, 1, film->to);
    }
    write_chunk(film, chunk->type, NULL, 0, chunk->data, chunk->bytes);
    if (is_head) {
        put_number(count, film->frame_count, 4);
        write_chunk(film, "acTL", NULL, 0, count, sizeof count);
    }
}

int film_add(struct film *film, const void *png, size_t bytes, struct ctl_error *error)
{
    struct chunk chunk;
    size_t at = SIGNATURE_BYTES;
    bool has_pixels = false;
    while (next_chunk(png, bytes, &at, &chunk)) {
        if (strcmp(chunk.type, "IDAT") == 0) {
            if (!has_pixels) {
                write_frame(film);
            }
            write_pixels(film, &chunk);
            has_pixels = true;
        } else if (strcmp(chunk.type, "IEND") != 0 && film->written == 0) {
            write_head(film, png, &chunk);
        }
    }
    film->written++;
    /* A full disk ends a film at once; how else it went is told at its end. */
    return ferror(film->to) == 0
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", film->path,
                               strerror(errno));
}

void film_end(struct film *film)
{
    assert(film->written == film->frame_count);
    write_chunk(film, "IEND", NULL, 0, NULL, 0);
}
