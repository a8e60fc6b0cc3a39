/* verify_options.h - how much of each answer is checked.
 *
 * Threads: one.
 */
#ifndef CTL_VERIFY_OPTIONS_H
#define CTL_VERIFY_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "verify.h"

/* An argp child; its input is a struct verify_options. */
struct verify_options {
    struct verify_settings settings;
    bool repeats; /* the steps are computed again even if the contacts are recorded */
};
#define VERIFY_OPTIONS_INIT                                                              \
    {                                                                                    \
        .settings = {.seed = 1, .sample = 1000 }                                         \
    }
extern const struct argp verify_options_argp;

#endif
