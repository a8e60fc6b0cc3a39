/* ask_options.h - what pccdctl check and pccdctl near have in common, and what all
 * commands that read mesh files have.
 *
 * Provide the files, --json, --threads, --method, --tuning, --repeat, --deadline,
 * --result-bytes, the options of thickness and of mesh files; say where the report goes,
 * and end the command.
 */
#ifndef CTL_ASK_OPTIONS_H
#define CTL_ASK_OPTIONS_H

#include <stdio.h>

#include "error.h"
#include "link.h"
#include "meshframes.h"
#include "option_table.h"

/* Of all commands that read mesh files, of a struct ctl_frames_options: --weld,
 * --animation and --rate. */
extern const struct option_table frames_table;
/* The same without --rate, for a command that has one of its own, in this range. */
extern const struct option_table frames_without_rate_table;

/* Return whether any of these options was given; a file without frames allows none. */
bool frames_options_are_given(const struct ctl_frames_options *options);

struct ask_options {
    struct ctl_link link;
    enum pccd_method method;
    uint32_t threads; /* 0: the daemon decides */
    uint64_t deadline_ns;
    const char *tuning; /* NULL: the daemon decides; fits into PCCD_TUNING_BYTES */
    struct pccd_object_settings object; /* what --thickness and others set of each */
    struct ctl_frames_options frames;
    bool is_json;
    bool has_repeats;
    uint32_t repeats;
    const char *csv; /* records go there, too; the command's option; NULL: nowhere */
    struct option_arguments files;
};

/* Options that fill a struct ask_options, which takes the arguments, too. The options of
 * `link` are ctl_link_table's. */
extern const struct option_table ask_table;

/* Return where the report goes: to the standard output, unless that is the CSV's; then to
 * stderr. */
FILE *ask_report_to(const struct ask_options *options);
/* Tell what went wrong first: the work, or else the end of the CSV. Returns the exit
 * status; `is_right` says whether what was found is. */
int ask_end(int status, bool is_right, const struct ctl_error *error, int closed,
            const struct ctl_error *close_error);

#endif
