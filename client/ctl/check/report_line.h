/* report_line.h - a step's report as one JSON object, and back.
 *
 * Threads: one.
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
