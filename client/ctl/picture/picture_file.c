/* client/ctl/picture/picture_file.c - a picture becomes a file.
 *
 * Room:     client/ctl.
 * Does:     open, empty, write and close it, as PNG or SVG.
 * Does not: draw; see picture.c.
 * Threads:  one at a time; nothing is shared.
 * Source:   picture.h; libpng's simplified interface.
 */
#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pccd_types.h"
#include "picture_canvas.h"

int picture_open(const char *path, FILE **file, struct ctl_error *error)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    FILE *opened = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (opened == NULL) {
        int status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                                   strerror(errno));
        if (fd >= 0) {
            close(fd);
        }
        return status;
    }
    *file = opened;
    return PCCD_OK;
}

void picture_discard(FILE *file, const char *path)
{
    struct stat info;
    bool is_empty =
        fstat(fileno(file), &info) == 0 && S_ISREG(info.st_mode) && info.st_size == 0;
    fclose(file);
    if (is_empty) {
        unlink(path);
    }
}

int picture_empty(FILE *file, const char *path, struct ctl_error *error)
{
    struct stat info;
    if (fstat(fileno(file), &info) == 0 && S_ISREG(info.st_mode) &&
        ftruncate(fileno(file), 0) != 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot empty: %s", path,
                             strerror(errno));
    }
    return PCCD_OK;
}

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
    if (png_image_write_to_stdio(&image, file, 0, canvas->raster.rgb, 0, NULL) == 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                             image.message);
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
            ? picture_empty(file, path, error)
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
    if (fclose(file) != 0 && status == PCCD_OK) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                               strerror(errno));
    }
    raster_deinit(&canvas.raster);
    return status;
}
