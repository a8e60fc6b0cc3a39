/* near_report.h - prints the answer of `pccdctl near`.
 *
 * Threads: one.
 */
#ifndef CTL_NEAR_REPORT_H
#define CTL_NEAR_REPORT_H

#include <stdio.h>

#include "near_run.h"

/* On the standard error: which files have more frames than the one that is read. */
void near_report_warn(const struct near_run *near);
void near_report_print(FILE *to, const struct near_run *near);
/* False: it could not be written, or without memory. */
bool near_report_json(FILE *to, const struct near_run *near);

#endif
