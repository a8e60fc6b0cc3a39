/* export.h - writes one step as a file of other programs, glTF 2.0 or VTP.
 *
 * Write a mesh for each object, its triangles, rods and points, with its motion as a
 * morph target and an animation of one second; radii as an attribute _RADIUS of the
 * vertices; contacts as points coloured by time, their normals as lines; what is near as
 * lines coloured by distance.
 */
#ifndef CTL_EXPORT_H
#define CTL_EXPORT_H

#include <stdint.h>
#include <stdio.h>

#include "snapshot.h"

/* ---- The colours that pictures and exported files give to times and to
 * objects. */

/* Set the colour of a time of impact: dark blue at 0, yellow at 1; linear between nine
 * colours. */
void colour_of_time(double toi, float colour[3]);
/* Set the colours of both sides of the i-th object of a scene. */
void colour_of_object(uint32_t i, float front[3], float back[3]);

/* Write one step as a binary glTF file; `path` is its name in errors. PCCD_OK,
 * PCCD_E_NOMEM, PCCD_E_LIMIT (4 GiB), PCCD_E_SYSTEM. */
int gltf_write(const struct snapshot *snapshot, FILE *to, const char *path,
               struct ctl_error *error);

/* ---- Writes one step as a VTK XML PolyData file, which ParaView opens. */

/* Write the step. PCCD_OK, PCCD_E_NOMEM, PCCD_E_LIMIT (more than 32-bit indices name),
 * PCCD_E_SYSTEM. */
int vtp_write(const struct snapshot *snapshot, FILE *to, const char *path,
              struct ctl_error *error);

#endif
