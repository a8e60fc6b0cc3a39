/* sequence.h - the order of files that are frames.
 *
 * Turn a pattern such as seq%d.obj or seq%04d.obj into the files that are there, by their
 * numbers; notice names whose numbers go down, and files that a pattern leaves out for
 * the zeros before their number.
 *
 * Threads: one at a time.
 */
#ifndef CTL_SEQUENCE_H
#define CTL_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"

struct ctl_sequence {
    uint32_t count;
    char **paths;             /* [count], in the order of the frames; ours */
    struct ctl_stamp *stamps; /* [count], before any of them was read; ours */
    char *warning; /* NULL, or one line: what was named may not be what was meant */
};

/* Return whether a name has one %d or %0Nd, N from 1 to 99, behind its last slash, and no
 * file has that very name. */
bool ctl_sequence_is_pattern(const char *name);
/* Take names and patterns in the order given. `sequence` is to be given back then, also
 * on error. Errors: E_NOMEM; E_SYSTEM for a folder that cannot be read; E_INVAL for a
 * pattern without files, or whose numbers have a gap: the text names the first number
 * that is missing; E_LIMIT for more than 2^20 files. */
int ctl_sequence_expand(struct ctl_sequence *sequence, char *const *names, uint32_t count,
                        struct ctl_error *error);
/* Return the first file that is no longer as it was, or NULL. */
const char *ctl_sequence_changed(const struct ctl_sequence *sequence);
/* Print the warning, if there is one, as a line on stderr. */
void ctl_sequence_warn(const struct ctl_sequence *sequence);
void ctl_sequence_deinit(struct ctl_sequence *sequence);

#endif
