/* whole_file.h - writes a file that appears whole or not at all; what its name tells.
 *
 * Write beside the name that was asked for, and give the file that name when all of it is
 * on the disk; until then the old file of that name is untouched. A program that is
 * killed leaves nothing behind, except on file systems that have no files without a name:
 * there FILE.PID-N.part stays.
 *
 * Threads: one for each file.
 */
#ifndef TOOL_WHOLE_FILE_H
#define TOOL_WHOLE_FILE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* It must not move in memory while it is open. */
struct whole_file {
    FILE *to;        /* write here; NULL: not open */
    char *path;      /* of the file, behind all symbolic links */
    char *temporary; /* its name until then; NULL: it has none */
    int fd;
    int error;      /* errno of the first write that failed */
    uint64_t bytes; /* written to the disk so far; fflush(to) for all */
    bool is_direct; /* no regular file, as /dev/stdout: written straight away */
};

/* Open it to be written. 0, or an errno: then the file is not open. What has the name
 * already must allow writing, and keeps its rights and owner. From now on the limit of
 * RLIMIT_FSIZE is an error of writing and no signal. */
int whole_file_open(struct whole_file *file, const char *path);
/* Close it and give it its name. 0, or the errno of whatever failed since it was opened:
 * then nothing has changed under that name. */
int whole_file_finish(struct whole_file *file);
/* Close it and let it go. One that is not open, or all zeros, is left alone. */
void whole_file_discard(struct whole_file *file);

/* ---- What the name of a file tells. */

/* Return whether `path` ends with `ending`, such as ".png", and is more than that. */
bool tool_ends_with(const char *path, const char *ending);
/* Return `path` from behind its last slash on; all of it, if nothing is there. */
const char *tool_base_name(const char *path);

#endif
