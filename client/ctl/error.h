/* error.h - an error: a status and a sentence for the user, written where the fault is
 * found.
 */
#ifndef CTL_ERROR_H
#define CTL_ERROR_H

#define CTL_ERROR_TEXT_BYTES 1024

struct ctl_error {
    char text[CTL_ERROR_TEXT_BYTES]; /* one line without a newline; "" = no error */
};

/* Write the text (cut to fit) and return `status`, so that a fault is one statement. */
int ctl_error_set(struct ctl_error *error, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
