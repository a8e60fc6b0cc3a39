/* picture_file.c - marks and legend over the meshes, as pixels or as shapes of an SVG. */
#include "picture.h"

#include <inttypes.h>
#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "base64.h"
#include "export.h"
#include "pccd_types.h"
#include "whole_file.h"

#define DOT_RADIUS  2.1f  /* picture pixels */
#define LINE_RADIUS 1.1f  /* picture pixels */
#define DOT_CHOSEN  3     /* times as large */
#define RING        5     /* times as large as a dot */
#define DOT_HIDDEN  0.30f /* opacity of marks behind a surface */
#define PLATE_SOLID 0.85f /* opacity of what is behind words */
#define SMALL       640u  /* a picture is, if it has fewer pixels from side to side */
#define LETTER_WIDE 12u   /* units */
#define LETTER_HIGH 14u
#define LINE_HIGH   30u /* from one to the next */
#define LEFT        28u /* of the border */
#define LINE_BYTES  256u
#define LINES_MAX   8u /* of the legend; what is longer is cut */

static const float ink[3] = {0.13f, 0.16f, 0.21f};

/* Shows what is over the meshes. Places are those of the canvas. */
struct sink {
    void (*dot)(const struct sink *sink, const struct raster_corner *at, float radius,
                const float colour[3]);
    void (*ring)(const struct sink *sink, const struct raster_corner *at, float radius,
                 const float colour[3]);
    void (*line)(const struct sink *sink, const struct raster_corner ends[2],
                 const float colour[3]);
    /* Lighten what is behind words, so that they can be read. */
    void (*plate)(const struct sink *sink, uint32_t x, uint32_t y, uint32_t wide,
                  uint32_t high);
    /* `x` is its left end, or its right one; `y` is above it. */
    void (*text)(const struct sink *sink, uint32_t x, uint32_t y, bool is_right,
                 const char *text);
    /* All colours, from the first to the last. */
    void (*bar)(const struct sink *sink, uint32_t x, uint32_t y, uint32_t wide,
                uint32_t high);
    struct picture_canvas *canvas;
    uint32_t unit; /* of the legend, canvas pixels */
    FILE *file;    /* of an SVG */
};

static void colour_of(uint32_t i, float colour[3])
{
    colour_of_time(((double)i + 0.5) / PICTURE_COLOURS, colour);
}

static void show_marks(const struct picture *picture, const struct sink *sink)
{
    for (uint32_t i = 0; i < picture->mark_count; i++) {
        const struct picture_mark *mark = &picture->marks[i];
        struct raster_corner ends[2] = {{.x = 0}, {.x = 0}};
        float colour[3];
        colour_of(mark->colour, colour);
        picture_project(sink->canvas, mark->at, &ends[0]);
        if (mark->is_line) {
            picture_project(sink->canvas, mark->to, &ends[1]);
            sink->line(sink, ends, colour);
            continue;
        }
        if (picture->is_thick && mark->is_chosen) {
            ends[0].nearness = INFINITY; /* between two that touch it would be hidden */
        }
        bool is_ring =
            mark->is_chosen && raster_is_hidden(&sink->canvas->raster, &ends[0]);
        (is_ring ? sink->ring : sink->dot)(sink, &ends[0],
                                           is_ring           ? RING * DOT_RADIUS
                                           : mark->is_chosen ? DOT_CHOSEN * DOT_RADIUS
                                                             : DOT_RADIUS,
                                           colour);
    }
}

/* Take the next line of a text: as many words as have room. False: none is left. */
static bool take_line(const struct sink *sink, const char **text, char line[LINE_BYTES])
{
    const uint32_t wide = sink->canvas->raster.width - 2 * LEFT * sink->unit;
    size_t most = wide / (LETTER_WIDE * sink->unit);
    size_t letters = *text != NULL ? strlen(*text) : 0;
    if (letters == 0) {
        return false;
    }
    most = most < LINE_BYTES ? most : LINE_BYTES - 1;
    if (letters > most) {
        letters = most;
        while (letters > 0 && ((*text)[letters] != ' ' || (*text)[letters - 1] == ',')) {
            letters--; /* coordinates stay together */
        }
        letters = letters > 0 ? letters : most; /* a word that is longer is cut */
    }
    snprintf(line, LINE_BYTES, "%.*s", (int)letters, *text);
    *text += letters + ((*text)[letters] == ' ');
    return true;
}

static void show_legend(const struct picture *picture, const struct sink *sink)
{
    const uint32_t unit = sink->unit, left = LEFT * unit, bar = 200 * unit;
    uint32_t y = 26 * unit, wide = picture->scale != NULL ? bar : 0, count = 0;
    const char *texts[] = {picture->title, picture->subtitle,
                           picture->scale != NULL ? picture->scale->title : NULL};
    char lines[LINES_MAX][LINE_BYTES];
    for (uint32_t i = 0; i < 3; i++) {
        while (count < LINES_MAX && take_line(sink, &texts[i], lines[count])) {
            uint32_t own = (uint32_t)strlen(lines[count++]) * LETTER_WIDE * unit;
            wide = own > wide ? own : wide;
        }
    }
    uint32_t high = (picture->scale != NULL ? 34 * unit : 0) + count * LINE_HIGH * unit;
    sink->plate(sink, left - 12 * unit, y - 12 * unit, wide + 24 * unit,
                high + 10 * unit);
    for (uint32_t i = 0; i < count; i++) {
        sink->text(sink, left, y, false, lines[i]);
        y += LINE_HIGH * unit;
    }
    if (picture->scale != NULL) {
        sink->bar(sink, left, y -= 8 * unit, bar, 12 * unit);
        sink->text(sink, left, y += 18 * unit, false, picture->scale->low);
        sink->text(sink, left + bar, y, true, picture->scale->high);
    }
}

/* ---- pixels ------------------------------------------------------------------------ */

static void paint_dot(const struct sink *sink, const struct raster_corner *at,
                      float radius, const float colour[3])
{
    raster_dot(&sink->canvas->raster, at, radius * PICTURE_OVERSAMPLING, colour,
               DOT_HIDDEN);
}

static void paint_ring(const struct sink *sink, const struct raster_corner *at,
                       float radius, const float colour[3])
{
    raster_ring(&sink->canvas->raster, at, radius * PICTURE_OVERSAMPLING, colour);
}

static void paint_plate(const struct sink *sink, uint32_t x, uint32_t y, uint32_t wide,
                        uint32_t high)
{
    raster_lighten(&sink->canvas->raster, (const uint32_t[]){x, y},
                   (const uint32_t[]){wide, high}, PLATE_SOLID);
}

/* Its ends are larger, or it would not be seen where it is short. */
static void paint_line(const struct sink *sink, const struct raster_corner ends[2],
                       const float colour[3])
{
    raster_line(&sink->canvas->raster, ends, LINE_RADIUS * PICTURE_OVERSAMPLING, colour,
                DOT_HIDDEN);
    paint_dot(sink, &ends[0], DOT_RADIUS, colour);
    paint_dot(sink, &ends[1], DOT_RADIUS, colour);
}

static void paint_text(const struct sink *sink, uint32_t x, uint32_t y, bool is_right,
                       const char *text)
{
    uint32_t wide = (uint32_t)strlen(text) * LETTER_WIDE * sink->unit;
    raster_text(&sink->canvas->raster, is_right ? x - wide : x, y, 2 * sink->unit, ink,
                text);
}

static void paint_bar(const struct sink *sink, uint32_t x, uint32_t y, uint32_t wide,
                      uint32_t high)
{
    for (uint32_t i = 0; i < wide; i++) {
        float colour[3];
        colour_of(i * PICTURE_COLOURS / wide, colour);
        raster_box(&sink->canvas->raster, x + i, y, 1, high, colour);
    }
}

/* ---- shapes ------------------------------------------------------------------------ */

static double place_of(float canvas_pixels)
{
    return (double)canvas_pixels / PICTURE_OVERSAMPLING;
}

static double opacity_of(const struct sink *sink, const struct raster_corner *at)
{
    return raster_is_hidden(&sink->canvas->raster, at) ? (double)DOT_HIDDEN : 1.0;
}

static void put_colour(const struct sink *sink, const char *name, const float colour[3])
{
    fprintf(sink->file, " %s=\"#", name);
    for (uint32_t k = 0; k < 3; k++) {
        fprintf(sink->file, "%02x", raster_byte(colour[k]));
    }
    fputs("\"", sink->file);
}

/* Begin a circle; false if its middle is off the canvas. */
static bool begin_circle(const struct sink *sink, const struct raster_corner *at,
                         float radius)
{
    const struct raster *raster = &sink->canvas->raster;
    bool is_on = at->x >= 0 && at->y >= 0 && at->x < (float)raster->width &&
                 at->y < (float)raster->height;
    if (is_on) {
        fprintf(sink->file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%g\"", place_of(at->x),
                place_of(at->y), (double)radius);
    }
    return is_on;
}

static void put_dot(const struct sink *sink, const struct raster_corner *at, float radius,
                    const float colour[3])
{
    if (begin_circle(sink, at, radius)) {
        fprintf(sink->file, " opacity=\"%g\"", opacity_of(sink, at));
        put_colour(sink, "fill", colour);
        fputs("/>\n", sink->file);
    }
}

static void put_ring(const struct sink *sink, const struct raster_corner *at,
                     float radius, const float colour[3])
{
    if (begin_circle(sink, at, 0.8f * radius)) {
        fprintf(sink->file, " fill=\"none\" stroke-opacity=\"1\" stroke-width=\"%g\"",
                0.3 * (double)radius);
        put_colour(sink, "stroke", colour);
        fputs("/>\n", sink->file);
    }
}

static void put_plate(const struct sink *sink, uint32_t x, uint32_t y, uint32_t wide,
                      uint32_t high)
{
    fprintf(sink->file,
            "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" fill=\"#fff\" "
            "fill-opacity=\"%g\"/>\n",
            place_of((float)x), place_of((float)y), place_of((float)wide),
            place_of((float)high), (double)PLATE_SOLID);
}

static void put_line(const struct sink *sink, const struct raster_corner ends[2],
                     const float colour[3])
{
    fprintf(sink->file,
            "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" stroke-opacity=\"%g\" "
            "stroke-width=\"2\" stroke-linecap=\"round\"",
            place_of(ends[0].x), place_of(ends[0].y), place_of(ends[1].x),
            place_of(ends[1].y), opacity_of(sink, &ends[0]));
    put_colour(sink, "stroke", colour);
    fputs("/>\n", sink->file);
}

/* Write a text; characters that mean something to XML are escaped. */
static void put_text(const struct sink *sink, uint32_t x, uint32_t y, bool is_right,
                     const char *text)
{
    fprintf(sink->file, "<text x=\"%g\" y=\"%g\" text-anchor=\"%s\">", place_of((float)x),
            place_of((float)(y + LETTER_HIGH * sink->unit)), is_right ? "end" : "start");
    for (const char *at = text; *at != '\0'; at++) {
        if (*at == '&' || *at == '<' || *at == '>') {
            fputs(*at == '&' ? "&amp;" : *at == '<' ? "&lt;" : "&gt;", sink->file);
        } else {
            putc(*at, sink->file);
        }
    }
    fputs("</text>\n", sink->file);
}

static void put_bar(const struct sink *sink, uint32_t x, uint32_t y, uint32_t wide,
                    uint32_t high)
{
    fputs("<defs><linearGradient id=\"scale\">", sink->file);
    for (uint32_t i = 0; i < PICTURE_COLOURS; i++) {
        float colour[3];
        colour_of(i, colour);
        fprintf(sink->file, "<stop offset=\"%g\"", (double)i / (PICTURE_COLOURS - 1));
        put_colour(sink, "stop-color", colour);
        fputs("/>", sink->file);
    }
    fprintf(sink->file,
            "</linearGradient></defs>\n<rect x=\"%g\" y=\"%g\" width=\"%g\" "
            "height=\"%g\" fill=\"url(#scale)\"/>\n",
            place_of((float)x), place_of((float)y), place_of((float)wide),
            place_of((float)high));
}

/* ---- files ------------------------------------------------------------------------- */

/* In a small picture the words would hide what it is of. */
static uint32_t unit_of(const struct picture_canvas *canvas)
{
    return canvas->width < SMALL ? PICTURE_OVERSAMPLING / 2 : PICTURE_OVERSAMPLING;
}

/* The meshes, and what is over them if `is_whole`, as a PNG in memory. */
static int make_png(const struct picture *picture, bool is_whole,
                    struct picture_canvas *canvas, void **png, size_t *bytes)
{
    int status = picture_draw(picture, canvas);
    *png = NULL;
    if (status == PCCD_OK) {
        const struct sink sink = {.dot = paint_dot,
                                  .ring = paint_ring,
                                  .line = paint_line,
                                  .plate = paint_plate,
                                  .text = paint_text,
                                  .bar = paint_bar,
                                  .canvas = canvas,
                                  .unit = unit_of(canvas)};
        if (is_whole) {
            show_marks(picture, &sink);
            show_legend(picture, &sink);
        }
        picture_halve(canvas);
        png_image image = {.version = PNG_IMAGE_VERSION,
                           .width = canvas->width,
                           .height = canvas->height,
                           .format = PNG_FORMAT_RGB};
        *bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
        *png = malloc(*bytes);
        if (*png != NULL && png_image_write_to_memory(&image, *png, bytes, 0,
                                                      canvas->raster.rgb, 0, NULL) == 0) {
            free(*png);
            *png = NULL;
        }
    }
    return *png != NULL || status == PCCD_E_LIMIT ? status : PCCD_E_NOMEM;
}

/* Say why there is no picture, if there is none. */
static int complain(int status, const char *path, struct ctl_error *error)
{
    return status == PCCD_E_LIMIT
               ? ctl_error_set(error, status,
                               "%s: too many features that are so thick: they fill the "
                               "picture many times over (--size makes it smaller)",
                               path)
           : status != PCCD_OK
               ? ctl_error_set(error, status, "%s: no memory for the picture", path)
               : PCCD_OK;
}

static void write_svg(const struct picture *picture, struct picture_canvas *canvas,
                      const void *png, size_t bytes, FILE *file)
{
    const struct sink sink = {.dot = put_dot,
                              .ring = put_ring,
                              .line = put_line,
                              .plate = put_plate,
                              .text = put_text,
                              .bar = put_bar,
                              .canvas = canvas,
                              .unit = unit_of(canvas),
                              .file = file};
    fprintf(file,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "
            "xmlns=\"http://www.w3.org/2000/svg\" "
            "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"%" PRIu32
            "\" height=\"%" PRIu32 "\" viewBox=\"0 0 %" PRIu32 " %" PRIu32
            "\">\n<image width=\"%" PRIu32 "\" height=\"%" PRIu32
            "\" xlink:href=\"data:image/png;base64,",
            canvas->width, canvas->height, canvas->width, canvas->height, canvas->width,
            canvas->height);
    (void)base64_write(png, bytes, file);
    fputs("\"/>\n<g stroke=\"#000\" stroke-opacity=\"0.4\" stroke-width=\"0.4\">\n",
          file);
    show_marks(picture, &sink);
    fprintf(file, "</g>\n<g font-family=\"monospace\" font-size=\"%" PRIu32 "\"",
            8 * sink.unit);
    put_colour(&sink, "fill", ink);
    fputs(">\n", file);
    show_legend(picture, &sink);
    fputs("</g>\n</svg>\n", file);
}

int picture_write(const struct picture *picture, FILE *file, const char *path,
                  struct ctl_error *error)
{
    struct picture_canvas canvas = {.width = 0};
    bool is_svg = tool_ends_with(path, ".svg");
    void *png;
    size_t bytes;
    int status = make_png(picture, !is_svg, &canvas, &png, &bytes);
    if (status == PCCD_OK && is_svg) {
        write_svg(picture, &canvas, png, bytes, file);
    } else if (status == PCCD_OK) {
        fwrite(png, bytes, 1, file);
    }
    free(png);
    raster_deinit(&canvas.raster);
    return complain(status, path, error);
}

int picture_encode(const struct picture *picture, const char *path, void **png,
                   size_t *bytes, struct ctl_error *error)
{
    struct picture_canvas canvas = {.width = 0};
    int status = make_png(picture, true, &canvas, png, bytes);
    raster_deinit(&canvas.raster);
    return complain(status, path, error);
}
