/* client/ctl/check/report_line.h - a step's report as one JSON object, and back.
 *
 * Room:     client/ctl. May include: report.h, jansson.h.
 * Does:     keep all numbers of a step that report.h prints, for a run that goes on.
 * Does not: keep the names of its files, or its records.
 * Threads:  one.
 */
#ifndef CTL_REPORT_LINE_H
#define CTL_REPORT_LINE_H

#include <jansson.h>
#include <stdbool.h>

#include "report.h"

/* NULL: no memory. */
json_t *report_line(const struct report_step *step);
/* False: it is no such object; then *step is of no use. */
bool report_line_read(const json_t *line, struct report_step *step);

#endif
