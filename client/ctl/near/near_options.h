/* near_options.h - what is asked about what is near: the options of `pccdctl near` and of
 * `pccd-mpi near`.
 *
 * Threads: one.
 */
#ifndef CTL_NEAR_OPTIONS_H
#define CTL_NEAR_OPTIONS_H

#include "ask_options.h"

struct near_options {
    struct ask_options ask;
    struct pccd_near_settings settings; /* PCCD_NEAR_SETTINGS_INIT before */
    bool has_distance, has_gap, has_self;
};

/* An argp child without a heading; its input is a struct near_options. */
extern const struct argp near_options_argp;

/* All that was said of the question. */
struct pccd_near_settings near_options_settings(const struct near_options *options);

#endif
