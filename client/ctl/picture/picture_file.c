/* picture_file.c - a picture becomes a file. */
#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"
#include "picture.h"
#include "whole_file.h"

static png_image image_of(const struct picture_canvas *canvas)
{
    return (png_image){.version = PNG_IMAGE_VERSION,
                       .width = canvas->width,
                       .height = canvas->height,
                       .format = PNG_FORMAT_RGB};
}

static int save_png(const struct picture_canvas *canvas, FILE *file, const char *path,
                    struct ctl_error *error)
{
    png_image image = image_of(canvas);
    errno = 0;
    if (png_image_write_to_stdio(&image, file, 0, canvas->raster.rgb, 0, NULL) == 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                             errno != 0 ? strerror(errno) : image.message);
    }
    return PCCD_OK;
}

/* The picture as a file in memory; NULL: no memory. */
static void *encode(const struct picture_canvas *canvas, size_t *bytes)
{
    png_image image = image_of(canvas);
    png_alloc_size_t room = PNG_IMAGE_PNG_SIZE_MAX(image);
    void *png = malloc(room);
    if (png != NULL && png_image_write_to_memory(&image, png, &room, 0,
                                                 canvas->raster.rgb, 0, NULL) == 0) {
        free(png);
        png = NULL;
    }
    *bytes = room;
    return png;
}

static int no_memory(const char *path, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for the picture", path);
}

/* The meshes as a PNG within it. */
static int save_svg(const struct picture *picture, const struct picture_canvas *canvas,
                    FILE *file, const char *path, struct ctl_error *error)
{
    size_t bytes;
    void *png = encode(canvas, &bytes);
    int status = PCCD_OK;
    if (png == NULL) {
        status = no_memory(path, error);
    } else if (!picture_write_svg(picture, canvas, png, bytes, file)) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                               strerror(errno));
    }
    free(png);
    return status;
}

/* Marks and legend over the meshes, as pixels. */
static void finish(const struct picture *picture, struct picture_canvas *canvas)
{
    picture_draw_marks(picture, canvas);
    picture_draw_legend(picture, canvas);
    picture_halve(canvas);
}

/* The meshes; status and words. */
static int draw(const struct picture *picture, struct picture_canvas *canvas,
                const char *path, struct ctl_error *error)
{
    int status = picture_draw(picture, canvas);
    return status == PCCD_E_LIMIT
               ? ctl_error_set(error, status,
                               "%s: too many features that are so thick: they fill the "
                               "picture many times over (--size makes it smaller)",
                               path)
           : status != PCCD_OK ? no_memory(path, error)
                               : PCCD_OK;
}

int picture_write(const struct picture *picture, FILE *file, const char *path,
                  struct ctl_error *error)
{
    struct picture_canvas canvas = {.width = 0};
    int status = draw(picture, &canvas, path, error);
    if (status == PCCD_OK && tool_ends_with(path, ".svg")) {
        picture_halve(&canvas);
        status = save_svg(picture, &canvas, file, path, error);
    } else if (status == PCCD_OK) {
        finish(picture, &canvas);
        status = save_png(&canvas, file, path, error);
    }
    raster_deinit(&canvas.raster);
    return status;
}

int picture_encode(const struct picture *picture, const char *path, void **png,
                   size_t *bytes, struct ctl_error *error)
{
    struct picture_canvas canvas = {.width = 0};
    int status = draw(picture, &canvas, path, error);
    *png = NULL;
    if (status == PCCD_OK) {
        finish(picture, &canvas);
        *png = encode(&canvas, bytes);
        status = *png != NULL ? PCCD_OK : no_memory(path, error);
    }
    raster_deinit(&canvas.raster);
    return status;
}
