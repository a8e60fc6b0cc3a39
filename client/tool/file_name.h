/* file_name.h - what the name of a file tells. */
#ifndef TOOL_FILE_NAME_H
#define TOOL_FILE_NAME_H

#include <stdbool.h>

/* Whether `path` ends with `ending`, such as ".png", and is more than that. */
bool tool_ends_with(const char *path, const char *ending);
/* `path` from behind its last slash on; all of it, if nothing is there. */
const char *tool_base_name(const char *path);

#endif
