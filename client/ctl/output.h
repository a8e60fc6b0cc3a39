/* output.h - the files that commands write.
 *
 * Threads: one.
 */
#ifndef CTL_OUTPUT_H
#define CTL_OUTPUT_H

#include "error.h"
#include "whole_file.h"

/* Before the work, so that a name which cannot be written is told at once. `path` may be
 * "-", the standard output, where `takes_stdout`. Errors: E_SYSTEM. */
int output_open(struct whole_file *file, const char *path, bool takes_stdout,
                struct ctl_error *error);
/* Give it its name; after an error there is none. Errors: E_SYSTEM. */
int output_finish(struct whole_file *file, const char *path, struct ctl_error *error);
/* What a write that failed says. */
int output_failed(const struct whole_file *file, const char *path,
                  struct ctl_error *error);

#endif
