/* confined.h - keeps what a process reads within one folder.
 *
 * A program that opens files for somebody whom it does not trust opens them by what is
 * here. Nothing is kept from it before tool_confine: then tool_open is open().
 *
 * What is written, and recordings and certificates that are read, are opened by their
 * name after tool_is_outside has looked at it: that holds against whoever names files,
 * and not against a process that changes links within the folder in between.
 *
 * Threads: one, as far as tool_confine; then any.
 */
#ifndef TOOL_CONFINED_H
#define TOOL_CONFINED_H

#include <stdbool.h>

/* Let tool_open open files of this folder alone from now on; it becomes the working
 * directory. 0, or an errno. */
int tool_confine(const char *folder);
/* Open it to be read: as open(path, O_RDONLY | O_CLOEXEC). After tool_confine, EXDEV: it
 * is outside of the folder, or a symbolic link on its way leads there; ENXIO: it is
 * neither a file nor a folder, but a pipe, which might never have a byte, or a device. */
int tool_open(const char *path);
/* Return 0 if a path is within the folder, also one of which the last name is not there
 * yet and may be given to a file. EXDEV: it is not; EEXIST: `is_new`, and it is there; or
 * what else is in the way. */
int tool_is_outside(const char *path, bool is_new);
/* Return `path` as it counts from the folder, if it begins with the folder's name. */
const char *tool_from_folder(const char *path);
/* Return what strerror() says, and of EXDEV, ENXIO and ENOSYS what they mean here. */
const char *tool_why(int error);

#endif
