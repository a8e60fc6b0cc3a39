/* client/ctl/export/vtp.h - writes one step as a VTK XML PolyData file, which ParaView
 * opens.
 *
 * Room:     client/ctl. May include: still.h.
 * Does:     write triangles, rods, points and contacts, or lines of what is near, with
 *           their numbers as data of points and cells.
 * Does not: need a library.
 * Threads:  one.
 * Source:   VTK file formats, docs.vtk.org.
 */
#ifndef CTL_VTP_H
#define CTL_VTP_H

#include <stdio.h>

#include "still.h"

/* PCCD_OK, PCCD_E_NOMEM, PCCD_E_SYSTEM. */
int vtp_write(const struct still *still, FILE *to, const char *path,
              struct ctl_error *error);

#endif
