/* client/ctl/mesh/meshcut.h - polygons of a mesh, which become triangles.
 *
 * Room:     client/ctl. May include: meshfile.h.
 * Does:     cut them where their corners are, or as another frame was cut; compare two
 *           frames.
 * Does not: cut by itself (polygon.h).
 * Threads:  [any]; nothing is shared.
 */
#ifndef CTL_MESHCUT_H
#define CTL_MESHCUT_H

#include "meshfile.h"

/* What only the reading of a part needs: vertices of other parts, which polygons of this
 * one have. */
struct ctl_wanted {
    uint32_t *vertices; /* [count], ascending */
    uint32_t count, next;
    double (*x)[3]; /* [count] */
};

/* For the readers: the last corner_count - 2 triangles that were added, a fan, are one
 * face, of which `place` tells where the file has it: mesh->has_lines, a line, otherwise
 * the face's number. */
int ctl_mesh_end_polygon(struct ctl_mesh *mesh, uint64_t corner_count, uint64_t place,
                         const char *path, struct ctl_error *error);

/* Cut all polygons by the positions of the mesh, and of `wanted` (NULL: there are none).
 * Errors: E_NOMEM; E_FORMAT and where the file has a polygon that is not simple. */
int ctl_mesh_cut(struct ctl_mesh *mesh, const struct ctl_wanted *wanted, const char *path,
                 struct ctl_error *error);
/* Vertices of polygons that are not in this part. Errors: E_NOMEM. */
int ctl_mesh_want(const struct ctl_mesh *mesh, struct ctl_wanted *wanted,
                  const char *path, struct ctl_error *error);
void ctl_wanted_deinit(struct ctl_wanted *wanted);

/* Cut the polygons of `mesh` as those of `first` are cut, and compare the two as
 * ctl_mesh_match does. */
int ctl_mesh_cut_like(const struct ctl_mesh *first, const char *first_path,
                      struct ctl_mesh *mesh, const char *path, struct ctl_error *error);

#endif
