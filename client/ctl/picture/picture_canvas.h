/* picture_canvas.h - a picture while it is drawn: camera, canvas and measures.
 *
 * Threads: one at a time.
 */
#ifndef CTL_PICTURE_CANVAS_H
#define CTL_PICTURE_CANVAS_H

#include <stdio.h>

#include "picture_scene.h"
#include "raster.h"

#define PICTURE_OVERSAMPLING 2     /* canvas pixels of one picture pixel, each way */
#define PICTURE_DOT_RADIUS   2.1f  /* picture pixels */
#define PICTURE_LINE_RADIUS  1.1f  /* likewise */
#define PICTURE_DOT_HIDDEN   0.30f /* opacity of marks behind a surface */

struct picture_canvas {
    uint32_t width, height; /* picture pixels */
    struct raster raster;
    float centre[3];
    float axes[3][3]; /* right, up, away from the eye; unit */
    float distance;   /* from the eye to the centre */
    float focus;      /* canvas pixels per unit at distance 1 */
};

/* The meshes, without marks and legend. PCCD_OK, PCCD_E_NOMEM; PCCD_E_LIMIT: so much is
 * so thick that it would take long. */
int picture_draw(const struct picture *picture, struct picture_canvas *canvas);
/* Where a point is on the canvas. */
void picture_project(const struct picture_canvas *canvas, const float x[3],
                     struct raster_corner *corner);
/* The same of a mark. */
void picture_place_mark(const struct picture *picture,
                        const struct picture_canvas *canvas,
                        const struct picture_mark *mark, struct raster_corner *corner);
/* Picture pixels. */
float picture_mark_radius(const struct picture_mark *mark);
/* Marks and legend onto the canvas. */
void picture_draw_marks(const struct picture *picture, struct picture_canvas *canvas);
void picture_draw_legend(const struct picture *picture, struct picture_canvas *canvas);
/* Average its pixels, in place: rgb[height][width][3] of the picture's size. */
void picture_halve(struct picture_canvas *canvas);

/* picture_svg.c: the same as shapes; `png` is the picture of the meshes. False when the
 * file cannot be written. */
bool picture_write_svg(const struct picture *picture, const struct picture_canvas *canvas,
                       const void *png, size_t png_bytes, FILE *file);

extern const float picture_ink[3];

#endif
