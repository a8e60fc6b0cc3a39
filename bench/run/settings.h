/* bench/run/settings.h - what pccd-bench was asked for.
 *
 * Room:     bench/run. May include: pccd.h.
 * Does:     read the command line; name the choices.
 * Threads:  one.
 */
#ifndef RUN_SETTINGS_H
#define RUN_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd.h"

enum run_via { RUN_VIA_ENGINE, RUN_VIA_DAEMON, RUN_VIA_DIRECT, RUN_VIAS };
enum run_format { RUN_TEXT, RUN_CSV, RUN_JSON, RUN_FORMATS };

struct run_settings {
    const char *scene; /* as in the list */
    bool is_small;     /* the small one of that name */
    bool wants_list;   /* only the names of the scenes are wanted */
    enum run_via via;
    enum run_format format;
    struct pccd_step_settings step; /* mode, method, threads, scheduler, .. */
    const char *cpu;                /* instruction set; NULL: the best, or $PCCD_CPU */
    bool has_frames;
    uint32_t first; /* steps first .. last are timed */
    uint32_t last;
    uint32_t warm_up; /* steps before them */
    uint32_t repeat;  /* passes */
    const char *path; /* of the output; NULL: the standard output */
};

/* Ends the program where the command line is wrong (2) or asks for help (0). */
void run_settings_read(struct run_settings *settings, int argc, char **argv);

/* Of `has_frames` or not: the steps that there are among 0 .. step_count - 1. False:
 * some that were asked for are none of them. */
bool run_settings_fit(struct run_settings *settings, uint32_t step_count);

const char *run_via_name(enum run_via via);
const char *run_mode_name(enum pccd_mode mode);
const char *run_method_name(enum pccd_method method);
const char *run_scheduler_name(enum pccd_scheduler scheduler);
const char *run_high_level_name(enum pccd_high_level high_level);
const char *run_refit_name(enum pccd_refit refit);

#endif
