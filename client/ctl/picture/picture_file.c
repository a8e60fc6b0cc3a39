/* client/ctl/picture/picture_file.c - a picture becomes a file.
 *
 * Room:     client/ctl.
 * Does:     write it, as PNG or SVG.
 * Does not: draw; see picture.c.
 * Threads:  one at a time; nothing is shared.
 * Source:   picture.h; libpng's simplified interface.
 */
#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"
#include "picture.h"
#include "picture_canvas.h"

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

/* The meshes as a PNG within it. */
static int save_svg(const struct picture *picture, const struct picture_canvas *canvas,
                    FILE *file, const char *path, struct ctl_error *error)
{
    png_image image = image_of(canvas);
    png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
    void *png = malloc(bytes);
    int status = PCCD_OK;
    if (png == NULL || png_image_write_to_memory(&image, png, &bytes, 0,
                                                 canvas->raster.rgb, 0, NULL) == 0) {
        status =
            ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for the picture", path);
    } else if (!picture_write_svg(picture, canvas, png, bytes, file)) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                               strerror(errno));
    }
    free(png);
    return status;
}

static bool is_svg(const char *path)
{
    size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".svg") == 0;
}

int picture_write(const struct picture *picture, FILE *file, const char *path,
                  struct ctl_error *error)
{
    struct picture_canvas canvas = {.width = 0};
    int status =
        picture_draw(picture, &canvas)
            ? PCCD_OK
            : ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for the picture", path);
    if (status == PCCD_OK && is_svg(path)) {
        picture_halve(&canvas);
        status = save_svg(picture, &canvas, file, path, error);
    } else if (status == PCCD_OK) {
        picture_draw_marks(picture, &canvas);
        picture_draw_legend(picture, &canvas);
        picture_halve(&canvas);
        status = save_png(&canvas, file, path, error);
    }
    raster_deinit(&canvas.raster);
    return status;
}
