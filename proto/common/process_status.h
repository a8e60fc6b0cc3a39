/* process_status.h - what the system says of a process. */
#ifndef COMMON_PROCESS_STATUS_H
#define COMMON_PROCESS_STATUS_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Return the number in the line of a process's status that begins with `name`, as
 * "VmHWM:", the most memory, in KiB, that it has had at a time. 0: there is no such
 * line. */
static inline uint64_t common_process_status(long pid, const char *name)
{
    char line[256];
    uint64_t number = 0;
    snprintf(line, sizeof line, "/proc/%ld/status", pid);
    FILE *file = fopen(line, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, name, strlen(name)) == 0) {
            number = strtoull(line + strlen(name), NULL, 10);
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return number;
}

/* Begin the VmHWM of this process anew: what it had before does not count. */
static inline void common_forget_most_memory(void)
{
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (file != NULL) {
        fputs("5", file);
        fclose(file);
    }
}

#endif
