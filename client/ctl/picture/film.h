/* film.h - pictures one after the other, as an animated PNG.
 *
 * Threads: one.
 */
#ifndef CTL_FILM_H
#define CTL_FILM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"

#define FILM_FRAMES_MAX 100000u

/* Set by film_begin. */
struct film {
    FILE *to;
    const char *path;
    uint32_t frame_count, written;
    uint32_t sequence; /* of the chunks that belong to the film */
    uint32_t frames_a_second;
    unsigned char head[13]; /* width, height and format of the first picture */
};

/* A film of exactly frame_count pictures, 1 .. FILM_FRAMES_MAX, that begins again at its
 * end. */
void film_begin(struct film *film, FILE *to, const char *path, uint32_t frame_count,
                uint32_t frames_a_second);
/* The next picture: a PNG file in memory. Errors: E_SYSTEM, E_INVAL (it has another size
 * or format than the first). */
int film_add(struct film *film, const void *png, size_t bytes, struct ctl_error *error);
/* After the last picture. */
int film_end(struct film *film, struct ctl_error *error);

#endif
