/* vtp.h - writes one step as a VTK XML PolyData file, which ParaView opens.
 *
 * Threads: one.
 */
#ifndef CTL_VTP_H
#define CTL_VTP_H

#include <stdio.h>

#include "still.h"

/* PCCD_OK, PCCD_E_NOMEM, PCCD_E_SYSTEM. */
int vtp_write(const struct still *still, FILE *to, const char *path,
              struct ctl_error *error);

#endif
