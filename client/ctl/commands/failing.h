/* failing.h - shows the steps of a check that fail: as a page, and as a film.
 *
 * Each of them is made once more, while it is recorded in a file without a name, which
 * `inspect` and `render` then show.
 */
#ifndef CTL_FAILING_H
#define CTL_FAILING_H

#include <stdint.h>
#include <stdio.h>

#include "check_run.h"
#include "frames.h"
#include "link.h"
#include "option_table.h"

struct failing_options {
    const char *page, *film; /* files; NULL: none */
    uint32_t most;           /* steps that are shown; 0: the default */
    uint64_t page_bytes;     /* at most; 0: the default */
};

/* Options that fill a struct failing_options: --page, --film, --failing,
 * --max-size. */
extern const struct option_table failing_table;

/* Before, {0} but for the options. */
struct failing {
    const struct failing_options *options;
    const struct scene_options *scene; /* which pairs are asked about */
    struct failing_step *steps; /* ours */
    uint32_t count;
    uint64_t left_out; /* of the steps that fail: those behind the first ones */
};

/* Try, before the first step of a run whose scene is there, whether what will be wanted
 * can be had. Errors: those of frames_begin; E_STATE: direct: has no daemon that records;
 * E_SYSTEM: there is no page; E_NOMEM. */
int failing_begin(struct failing *failing, const struct ctl_link *link,
                  struct check_run *run, struct ctl_error *error);
/* Keep a step that fails, right after check_run_step. Nothing where nothing is asked
 * for. */
int failing_keep(struct failing *failing, struct check_run *run,
                 const struct scene *files, uint32_t number, struct ctl_error *error);
/* Write what was asked for, and say so; where nothing fails, say that there is none. A
 * page asks a daemon. Errors: those of inspect and of render. */
int failing_write(const struct failing *failing, const struct ctl_link *link,
                  FILE *report, struct ctl_error *error);
void failing_deinit(struct failing *failing);

#endif
