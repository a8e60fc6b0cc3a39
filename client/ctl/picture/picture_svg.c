/* picture_svg.c - marks and legend as shapes and text. */
#include <inttypes.h>
#include <string.h>

#include "base64.h"
#include "picture.h"

#define LEFT 28

static unsigned byte_of(float share)
{
    float value = share * 255.0f + 0.5f;
    return value < 0 ? 0 : value > 255 ? 255 : (unsigned)value;
}

static void put_colour(const float colour[3], FILE *file)
{
    fprintf(file, "#%02x%02x%02x", byte_of(colour[0]), byte_of(colour[1]),
            byte_of(colour[2]));
}

/* Text, with what means something to XML written otherwise. */
static void put_text(const char *text, double x, double y, const char *anchor, FILE *file)
{
    fprintf(file, "<text x=\"%g\" y=\"%g\" text-anchor=\"%s\">", x, y, anchor);
    for (const char *at = text; *at != '\0'; at++) {
        if (*at == '&' || *at == '<' || *at == '>') {
            fputs(*at == '&' ? "&amp;" : *at == '<' ? "&lt;" : "&gt;", file);
        } else {
            putc(*at, file);
        }
    }
    fputs("</text>\n", file);
}

static void put_line(const struct picture *picture, const struct picture_canvas *canvas,
                     const struct picture_mark *mark, FILE *file)
{
    struct raster_corner ends[2] = {{.x = 0}, {.x = 0}};
    picture_project(canvas, mark->at, &ends[0]);
    picture_project(canvas, mark->to, &ends[1]);
    const double scale = 1.0 / PICTURE_OVERSAMPLING;
    fprintf(file,
            "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" stroke-opacity=\"%g\" "
            "stroke-width=\"2\" stroke-linecap=\"round\" stroke=\"",
            scale * (double)ends[0].x, scale * (double)ends[0].y,
            scale * (double)ends[1].x, scale * (double)ends[1].y,
            raster_is_hidden(&canvas->raster, &ends[0]) ? (double)PICTURE_DOT_HIDDEN
                                                        : 1.0);
    put_colour(picture->groups[mark->group].colour, file);
    fputs("\"/>\n", file);
}

static void put_marks(const struct picture *picture, const struct picture_canvas *canvas,
                      FILE *file)
{
    fprintf(file, "<g stroke=\"#000\" stroke-opacity=\"0.4\" stroke-width=\"0.4\">\n");
    for (uint32_t i = 0; i < picture->mark_count; i++) {
        struct raster_corner corner = {0};
        if (picture->marks[i].is_line) {
            put_line(picture, canvas, &picture->marks[i], file);
            continue;
        }
        picture_place_mark(picture, canvas, &picture->marks[i], &corner);
        if (!(corner.x >= 0 && corner.y >= 0 && corner.x < (float)canvas->raster.width &&
              corner.y < (float)canvas->raster.height)) {
            continue;
        }
        fprintf(file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%g\" opacity=\"%g\" fill=\"",
                (double)corner.x / PICTURE_OVERSAMPLING,
                (double)corner.y / PICTURE_OVERSAMPLING,
                (double)picture_mark_radius(&picture->marks[i]),
                raster_is_hidden(&canvas->raster, &corner) ? (double)PICTURE_DOT_HIDDEN
                                                           : 1.0);
        put_colour(picture->groups[picture->marks[i].group].colour, file);
        fputs("\"/>\n", file);
    }
    fputs("</g>\n", file);
}

static void put_scale(const struct picture *picture, double y, FILE *file)
{
    put_text(picture->scale->title, LEFT, y, "start", file);
    fputs("<defs><linearGradient id=\"scale\">", file);
    for (uint32_t i = 0; i < picture->group_count; i++) {
        fprintf(file, "<stop offset=\"%g\" stop-color=\"",
                picture->group_count > 1 ? (double)i / (picture->group_count - 1) : 0.0);
        put_colour(picture->groups[i].colour, file);
        fputs("\"/>", file);
    }
    fprintf(file,
            "</linearGradient></defs>\n<rect x=\"%d\" y=\"%g\" width=\"200\" "
            "height=\"12\" fill=\"url(#scale)\"/>\n",
            LEFT, y + 8);
    put_text(picture->scale->low, LEFT, y + 36, "start", file);
    put_text(picture->scale->high, LEFT + 200, y + 36, "end", file);
}

static void put_legend(const struct picture *picture, FILE *file)
{
    double y = 40;
    fputs("<g font-family=\"monospace\" font-size=\"16\" fill=\"", file);
    put_colour(picture_ink, file);
    fputs("\">\n", file);
    put_text(picture->title, LEFT, y, "start", file);
    for (uint32_t i = 0; i < picture->group_count; i++) {
        if (picture->groups[i].label[0] == '\0') {
            continue;
        }
        y += 26;
        fprintf(file, "<circle cx=\"%d\" cy=\"%g\" r=\"6\" fill=\"", LEFT + 6, y - 5);
        put_colour(picture->groups[i].colour, file);
        fputs("\"/>\n", file);
        put_text(picture->groups[i].label, LEFT + 18, y, "start", file);
    }
    if (picture->scale != NULL && picture->group_count > 0) {
        put_scale(picture, y + 30, file);
    }
    fputs("</g>\n", file);
}

bool picture_write_svg(const struct picture *picture, const struct picture_canvas *canvas,
                       const void *png, size_t png_bytes, FILE *file)
{
    fprintf(file,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg "
            "xmlns=\"http://www.w3.org/2000/svg\" "
            "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"%" PRIu32
            "\" height=\"%" PRIu32 "\" viewBox=\"0 0 %" PRIu32 " %" PRIu32
            "\">\n<image width=\"%" PRIu32 "\" height=\"%" PRIu32
            "\" xlink:href=\"data:image/png;base64,",
            canvas->width, canvas->height, canvas->width, canvas->height, canvas->width,
            canvas->height);
    bool is_ok = base64_write(png, png_bytes, file);
    fputs("\"/>\n", file);
    put_marks(picture, canvas, file);
    put_legend(picture, file);
    fputs("</svg>\n", file);
    return is_ok && ferror(file) == 0;
}
