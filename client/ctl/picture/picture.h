/* picture.h - draws meshes and contacts into a PNG or SVG file, or a film.
 *
 * Threads: one at a time; nothing is shared.
 */
#ifndef CTL_PICTURE_H
#define CTL_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "raster.h"
#include "snapshot.h"

/* ---- What a picture shows, and from where: meshes, marked contacts,
 * camera, legend. */

#define PICTURE_WIDTH    1200
#define PICTURE_HEIGHT   900
#define PICTURE_SIDE_MAX 8192
#define PICTURE_COLOURS  64u

/* A contact, or a line. */
struct picture_mark {
    float at[3];
    float to[3]; /* of a line */
    bool is_line;
    uint32_t colour; /* below PICTURE_COLOURS: those of times, from 0 to 1 */
    bool is_chosen;  /* drawn larger, and as a ring where it is hidden */
};

/* Place to look at: a ball that fills the picture's height. */
struct picture_place {
    float at[3];
    float radius;
};

/* Text of the legend: what the first and the last colour mean. */
struct picture_scale {
    char title[48];
    char low[16], high[16];
};

struct picture {
    const struct snapshot *snapshot; /* whose objects are drawn */
    const struct picture_mark *marks;
    uint32_t mark_count;
    float from[3]; /* direction from the middle of the scene to the eye */
    uint32_t up;   /* the axis that points up: 1 x, 2 y, 3 z; 0: y */
    uint32_t width, height; /* 0: PICTURE_WIDTH and PICTURE_HEIGHT */
    float zoom;             /* 0: everything is seen, just so; 2: twice as large */
    bool is_at_marks;       /* the marks are what is to be seen .. */
    float room;             /* .. and so much around their middle, at least */
    /* Low and high corner of the box that is to be seen, so that several pictures are
     * from one place; NULL: that of the objects. */
    const float (*bounds)[3];
    /* Triangles have their radii, and everything half of the separation; rods and points
     * always have their radii. */
    bool is_thick;
    const struct picture_place *place; /* this is, and not the marks; NULL: no place */
    const char *title;
    const char *subtitle;              /* below it; NULL: none */
    const struct picture_scale *scale; /* NULL: none */
    const float (*colours)[3];         /* of the objects; NULL: by their places */
    uint32_t behind_count; /* all other objects are drawn over so many, the first ones */
};

/* Render to `file`, whose name is `path`: a PNG, or, where `path` ends with .svg, that
 * with marks and legend as shapes and text. Whether all was written, output_finish tells.
 * Errors: E_NOMEM;
 * E_LIMIT: what is thick would take more than a minute. */
int picture_write(const struct picture *picture, FILE *file, const char *path,
                  struct ctl_error *error);

/* Make the PNG in memory instead, which is the caller's to free. Errors: those of
 * picture_write, which name `path`. */
int picture_encode(const struct picture *picture, const char *path, void **png,
                   size_t *bytes, struct ctl_error *error);

/* ---- Normals for shading: smooth on a ball, sharp at the edges of a box. */

/* Fill normals[3 * triangle_count]: unit, one for each corner of each triangle. Lengths
 * are taken in units of 2^octave, as squares of squares have no room in a float. False
 * without memory. */
bool picture_normals(const struct snapshot_object *object, int octave,
                     float (*normals)[3]);

/* ---- Pictures one after the other, as an animated PNG. */

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

/* Begin a film of exactly frame_count pictures, 1 .. FILM_FRAMES_MAX, that begins again
 * at its end. */
void film_begin(struct film *film, FILE *to, const char *path, uint32_t frame_count,
                uint32_t frames_a_second);
/* Add the next picture: what picture_encode has made, all of them of one size. E_SYSTEM:
 * it cannot be written. */
int film_add(struct film *film, const void *png, size_t bytes, struct ctl_error *error);
/* End the film, after the last picture. */
void film_end(struct film *film);

/* ---- A picture while it is drawn: camera, canvas and measures. */

#define PICTURE_OVERSAMPLING 2 /* canvas pixels of one picture pixel, each way */

struct picture_canvas {
    uint32_t width, height; /* picture pixels */
    struct raster raster;
    float centre[3];
    float axes[3][3]; /* right, up, away from the eye; unit */
    float distance;   /* from the eye to the centre */
    float focus;      /* canvas pixels per unit at distance 1 */
};

/* Draw the objects, without marks and legend, on a new canvas, whose raster is the
 * caller's to deinit, also on error. PCCD_OK, PCCD_E_NOMEM; PCCD_E_LIMIT: so much is so
 * thick that it would take long. */
int picture_draw(const struct picture *picture, struct picture_canvas *canvas);
/* Find where a point is on the canvas. */
void picture_project(const struct picture_canvas *canvas, const float x[3],
                     struct raster_corner *corner);
/* Average its pixels, in place: rgb[height][width][3] of the picture's size. */
void picture_halve(struct picture_canvas *canvas);

/* ---- Draws what has a thickness: all that is within a radius of a point, an edge
 * or a triangle. */

/* Return how many pixels thick_segment will look at. */
uint64_t thick_pixels(const struct picture_canvas *canvas, const float from[3],
                      const float to[3], double radius);
/* Draw what is within `radius` of the segment between two points, which may be one.
 * Nothing of it is behind the eye. */
void thick_segment(struct picture_canvas *canvas, const float from[3], const float to[3],
                   double radius, const struct raster_surface *surface);
/* Draw what is within `radius` of a triangle. The corners have their normals, for
 * shading. */
void thick_triangle(struct picture_canvas *canvas, const float *const x[3],
                    const float normals[3][3], double radius,
                    const struct raster_surface *surface);

#endif
