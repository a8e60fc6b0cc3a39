/* last_words.h - what a daemon that a program has started said last.
 *
 * Name the file that its messages go to unless PCCD_LOG names another: beside its socket.
 * The daemon keeps it short, and removes it when it ends as it should. Find the last line
 * of such a file that says something.
 */
#ifndef COMMON_LAST_WORDS_H
#define COMMON_LAST_WORDS_H

#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COMMON_OWN_LOG_ENDING ".log"
#define COMMON_OWN_LOG_BYTES  65536 /* then it begins anew */

/* In the environment of a daemon whose log is such a file, "1". */
#define COMMON_OWN_LOG_NAME "PCCD_OWN_LOG"

#define COMMON_LAST_WORDS_BYTES 256

/* Return whether a line says something to a user, as frames of a backtrace do not. */
static inline bool common_line_speaks(const char *line)
{
    return line[0] != '\0' && strstr(line, "[0x") == NULL;
}

/* Write the last line of `path` that speaks, cut to fit, to `words`. "": there is none,
 * or no such file of this user. */
static inline void common_last_words(const char *path,
                                     char words[COMMON_LAST_WORDS_BYTES])
{
    char text[8192];
    struct stat found;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    ssize_t bytes = 0;
    words[0] = '\0';
    if (fd >= 0 && fstat(fd, &found) == 0 && S_ISREG(found.st_mode) &&
        found.st_uid == geteuid()) {
        off_t from = found.st_size - (off_t)sizeof text + 1;
        bytes = pread(fd, text, sizeof text - 1, from > 0 ? from : 0);
    }
    if (fd >= 0) {
        (void)close(fd);
    }
    text[bytes > 0 ? bytes : 0] = '\0';
    for (char *line = text, *end; line != NULL; line = end) {
        end = strchr(line, '\n');
        if (end != NULL) {
            *end++ = '\0';
        }
        if (common_line_speaks(line)) {
            (void)snprintf(words, COMMON_LAST_WORDS_BYTES, "%.*s",
                           COMMON_LAST_WORDS_BYTES - 1, line);
        }
    }
}

#endif
