/* check_options.h - what is asked of a check: the options of `pccdctl check` and of
 * `pccd-mpi check`.
 *
 * Threads: one.
 */
#ifndef CTL_CHECK_OPTIONS_H
#define CTL_CHECK_OPTIONS_H

#include "ask_options.h"

struct check_options {
    struct ask_options ask; /* its CSV: of contacts */
    struct pccd_step_settings settings;
};

/* An argp child without a heading; its input is a struct check_options. */
extern const struct argp check_options_argp;

/* All that was said of a step. */
struct pccd_step_settings check_step_settings(const struct check_options *options);

#endif
