/* settings.h - the command line of pccd-bench. */
#ifndef RUN_SETTINGS_H
#define RUN_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "families.h"
#include "pccd.h"

enum run_via { RUN_VIA_ENGINE, RUN_VIA_DAEMON, RUN_VIA_DIRECT, RUN_VIAS };
/* Form in which the next positions are handed over. */
enum run_sends {
    RUN_SENDS_ALL,   /* every position */
    RUN_SENDS_MOVED, /* those that change (libpccd) */
    RUN_SENDS_POSES, /* poses where there are any, else positions (libpccd) */
    RUN_SENDS
};
enum run_format { RUN_TEXT, RUN_CSV, RUN_JSON, RUN_FORMATS };

#define RUN_SIDES_MAX 16u

/* One way to compute the steps; several take each step by turns. */
struct run_side {
    const char *label; /* the options of --beside */
    char *words;       /* these, apart; what follows points into them */
    enum run_via via;
    struct pccd_step_settings step; /* mode, method, threads, tuning, .. */
    const char *cpu;                /* instruction set; NULL: the best, or $PCCD_CPU */
    double rebuild_ratio;           /* of the scene (eng_scene_settings) */
    double separation;              /* in median edges of the first frame */
    bool is_fresh; /* each step in a scene of its own, which is made and freed with it */
    bool is_team;  /* by all threads also where one would be faster */
    struct bench_moving moving; /* of the scene */
    enum run_sends sends;
};

struct run_settings {
    const char *scene; /* as in the list */
    bool is_small;     /* the small one of that name */
    bool wants_list;   /* only the names of the scenes are wanted */
    enum run_format format;
    struct run_side sides[RUN_SIDES_MAX]; /* the first is asked for without --beside */
    uint32_t side_count;
    bool has_frames;
    bool is_hard;   /* the first step is the scene's hard one; `last` counts from it */
    uint32_t first; /* steps first .. last are timed */
    uint32_t last;
    uint32_t warm_up; /* steps before them */
    uint32_t repeat;  /* passes */
    uint32_t hz;      /* begin a step so many times a second; 0: at once */
    const char *path; /* of the output; NULL: the standard output */
};

/* Ends the program where the command line is wrong (2) or asks for help (0). */
void run_settings_read(struct run_settings *settings, int argc, char **argv);

/* Choose the steps of a scene that has 0 .. step_count - 1, of which `hard_step` stands
 * for it; where each side says what moves, there are any number from the first one on.
 * False: some that were asked for are none of them. */
bool run_settings_fit(struct run_settings *settings, uint32_t step_count,
                      uint32_t hard_step);

const char *run_via_name(enum run_via via);

#endif
