/* raster.h - draws triangles, dots and text on a canvas with depth.
 *
 * Threads: one per canvas.
 * Source: edge functions (Pineda 1988).
 */
#ifndef CTL_RASTER_H
#define CTL_RASTER_H

#include <stdbool.h>
#include <stdint.h>

/* Colours are red, green, blue in 0 .. 1 as they are shown. */
struct raster {
    uint32_t width, height;
    uint8_t *rgb;    /* [height][width][3] */
    float *nearness; /* [height][width]: 1 / distance; 0 = nothing there */
};

/* A corner on the canvas: place, nearness, and the direction of the surface there. */
struct raster_corner {
    float x, y;
    float nearness;
    float normal[3];
};

/* Directions are unit, in the frame of the normals. */
struct raster_surface {
    float front[3], back[3]; /* colours of the two sides */
    float light[3];          /* to the light */
    float eye[3];            /* to the eye */
    float line_width;        /* of the triangles' borders, canvas pixels; 0 = none */
};

/* Return a share of a colour as a byte, 0 .. 255. */
uint8_t raster_byte(float share);
/* Allocate the canvas. False without memory. */
bool raster_init(struct raster *raster, uint32_t width, uint32_t height);
void raster_deinit(struct raster *raster);

/* Forget all depths: what is drawn from now on is over all that was. */
void raster_forget(struct raster *raster);
/* Fill with a vertical run from one colour to another; forget all depths. */
void raster_clear(struct raster *raster, const float top[3], const float bottom[3]);
void raster_triangle(struct raster *raster, const struct raster_corner corners[3],
                     const struct raster_surface *surface);
/* Draw a pixel of a surface whose front is seen, unless something nearer is there. */
void raster_pixel(struct raster *raster, uint32_t x, uint32_t y, float nearness,
                  const float normal[3], const struct raster_surface *surface);
/* Draw a line with a dark rim, `radius` to either side: full where nothing nearer is,
 * `hidden` (0 .. 1) opaque elsewhere. A dot is one without length. */
void raster_line(struct raster *raster, const struct raster_corner ends[2], float radius,
                 const float colour[3], float hidden);
void raster_dot(struct raster *raster, const struct raster_corner *at, float radius,
                const float colour[3], float hidden);
/* Return whether something nearer is at the middle of a dot; true if that is off the
 * canvas. */
bool raster_is_hidden(const struct raster *raster, const struct raster_corner *at);
/* Draw a ring, opaque over all that is there, with a dark rim on either side. */
void raster_ring(struct raster *raster, const struct raster_corner *at, float radius,
                 const float colour[3]);
/* Draw white over a rectangle, so opaque (0 .. 1) that words can be read there; draw a
 * rectangle; then ASCII text, a font pixel being `scale` canvas pixels. The corner (x, y)
 * is the upper left one; what is off the canvas is left out. */
void raster_lighten(struct raster *raster, const uint32_t corner[2],
                    const uint32_t size[2], float opacity);
void raster_box(struct raster *raster, uint32_t x, uint32_t y, uint32_t width,
                uint32_t height, const float colour[3]);
void raster_text(struct raster *raster, uint32_t x, uint32_t y, uint32_t scale,
                 const float colour[3], const char *text);

#endif
