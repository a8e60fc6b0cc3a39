/* picture.h - draws meshes and contacts into a PNG or SVG file.
 *
 * Threads: one at a time; nothing is shared.
 */
#ifndef CTL_PICTURE_H
#define CTL_PICTURE_H

#include <stdio.h>

#include "error.h"
#include "picture_scene.h"

/* Render to `file`, whose name is `path`: a PNG, or, where `path` ends with .svg, that
 * with marks and legend as shapes and text. Errors: E_SYSTEM, E_NOMEM;
 * E_LIMIT: what is thick would take more than a minute. */
int picture_write(const struct picture *picture, FILE *file, const char *path,
                  struct ctl_error *error);

/* The PNG in memory instead, which is the caller's to free. E_NOMEM: it names `path`. */
int picture_encode(const struct picture *picture, const char *path, void **png,
                   size_t *bytes, struct ctl_error *error);

#endif
