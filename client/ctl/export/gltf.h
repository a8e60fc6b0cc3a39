/* gltf.h - writes one step as a binary glTF 2.0 file, which Blender and browsers open.
 *
 * Write a mesh for each object, its triangles, rods and points, with its motion as a
 * morph target and an animation of one second; radii as an attribute _RADIUS of the
 * vertices; contacts as points coloured by time, their normals as lines; what is near as
 * lines coloured by distance.
 *
 * Threads: one.
 */
#ifndef CTL_GLTF_H
#define CTL_GLTF_H

#include <stdio.h>

#include "still.h"

/* PCCD_OK, PCCD_E_NOMEM, PCCD_E_LIMIT (4 GiB), PCCD_E_SYSTEM. */
int gltf_write(const struct still *still, FILE *to, const char *path,
               struct ctl_error *error);

#endif
