/* check_run.h - runs `pccdctl check`: gives the frames of a mesh to a daemon and collects
 * its contacts.
 *
 * Threads: one.
 */
#ifndef CTL_CHECK_RUN_H
#define CTL_CHECK_RUN_H

#include <stdbool.h>
#include <stdint.h>

#include "ask_options.h"
#include "contacts_csv.h"
#include "error.h"
#include "meshfile.h"
#include "objects.h"
#include "pccd.h"
#include "report.h"

struct check_run {
    struct pccd_client *client; /* the caller's */
    struct pccd_step_settings settings;
    const struct ask_options *ask; /* the caller's: what to set of objects */
    uint32_t repeats;              /* timed runs after the first; 0: only the first */
    bool is_apart; /* steps do not follow each other: each says where it begins */
    uint32_t scene, object;
    struct pccd_edge *edges; /* ours, of the registered mesh; NULL unless asked for */
    struct report_mesh mesh;
    struct progress *progress; /* the caller's, of all runs of all steps; or NULL */
    struct objects *objects;   /* the caller's, or NULL: of each step, which ones meet */
    double *times; /* ours: [REPORT_PHASE_COUNT + 1][repeats], scratch for medians */
};

/* Register a mesh that was read: pccd_mesh_put. */
int check_run_put_mesh(struct pccd_client *client, const struct ctl_mesh *mesh,
                       uint32_t *handle, struct pccd_mesh_info *info);

/* Register `mesh` and place it; with_edges: get its edges too. client, settings
 * and repeats are set before. Errors: those of pccd.h, E_NOMEM. */
int check_run_begin(struct check_run *run, const struct ctl_mesh *mesh, bool with_edges,
                    struct ctl_error *error);
/* One step from `before`, where the object stands now, to `after`: once, then `repeats`
 * times the same again. Both frames must have the same format. The last run's records go
 * to `csv` unless that has no file. Fills all of `step` but the names of files. */
int check_run_step(struct check_run *run, const struct ctl_mesh *before,
                   const struct ctl_mesh *after, uint32_t number,
                   const struct contacts_csv *csv, struct report_step *step,
                   struct ctl_error *error);

/* What check_run_repeat asks, and where the pages of the last answer go. */
struct check_ask {
    int (*once)(void *context, bool is_again, struct pccd_answer *answer);
    void (*page)(void *context, const struct pccd_answer *page); /* NULL: nowhere */
    const char *failed; /* what to say when that failed */
    void *context;
};
/* Ask once and `repeats` times more; all complete answers must be the same. Fills all of
 * `step` but the names of files. run->times is there. */
int check_run_repeat(struct check_run *run, const struct check_ask *ask, uint32_t number,
                     struct report_step *step, struct ctl_error *error);
/* Whether nothing meets in any step. Errors: E_TIMEOUT where nothing does in what was
 * looked at, and an answer is incomplete. */
int check_run_judge(const struct report_step *steps, uint32_t step_count, bool *is_free,
                    struct ctl_error *error);
/* Make run->times. */
int check_run_times(struct check_run *run, struct ctl_error *error);
/* `what`, and the library's own words about a failed call. Returns `status`. */
int check_run_fail(const struct check_run *run, int status, const char *what,
                   struct ctl_error *error);
void check_run_deinit(struct check_run *run);

#endif
