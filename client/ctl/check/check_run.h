/* check_run.h - `pccdctl check`: its options, its run, and its CSV. */
#ifndef CTL_CHECK_RUN_H
#define CTL_CHECK_RUN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "ask_options.h"
#include "error.h"
#include "meshfile.h"
#include "pccd.h"
#include "report.h"
#include "scene.h"
#include "whole_file.h"

/* ---- Which objects meet, by their names. */

/* An object, and the parts of its file that have names. */
struct objects_of {
    uint32_t handle;
    const struct ctl_mesh *mesh;
    const struct pccd_edge *edges;
    uint32_t edge_count;
    uint32_t *of_vertex, *of_edge; /* ours: places in mesh->objects; NULL: it is one */
    uint32_t first; /* number of its first part; the last one is what stands before it */
};

struct objects {
    struct objects_of *of; /* ours: [count], by increasing handles */
    uint32_t count;
    char **names; /* ours: [part_count], of parts with their objects' names before */
    uint32_t part_count;
    struct report_pair *pairs;     /* of this step; a table by a hash of both numbers */
    uint32_t pair_count, capacity; /* a power of 2, more than there are pairs */
};

/* Return whether all of a mesh is of one part. */
bool objects_are_one(const struct ctl_mesh *mesh);
/* Add an object, of which no numbers are ours yet, to `objects`, {0} at first. Its name,
 * "" if its parts alone have names, is copied; its mesh and edges (as they were
 * registered; needed for several parts) stay as they are until objects_deinit, which is
 * called also on error. Errors: E_NOMEM. */
int objects_add(struct objects *objects, const char *name, const struct objects_of *added,
                struct ctl_error *error);
/* Return the object of a handle; of one that no object has, any. */
const struct objects_of *objects_find(const struct objects *objects, uint32_t handle);
/* Return the number of the part that has a feature of so many points (1 a vertex, 2 an
 * edge, 3 a face). */
uint32_t objects_part(const struct objects_of *object, uint32_t points, uint32_t feature);
/* Count the records of a page. False: no memory. */
bool objects_count(struct objects *objects, const struct pccd_answer *page);
/* Move what was counted, most first, to `step`, whose pairs its owner free()s; then begin
 * anew. Errors: E_NOMEM. */
int objects_take(struct objects *objects, struct report_step *step,
                 struct ctl_error *error);
void objects_deinit(struct objects *objects);

/* ---- Writes contacts as CSV (`pccdctl check --contacts FILE`). */

struct contacts_csv {
    const char *path;              /* "-": the standard output */
    struct whole_file whole;       /* `to` NULL: nothing is to be written */
    bool has_step;                 /* a first column "step" */
    bool has_names;                /* two more columns with names of objects */
    bool has_touching;             /* a last column: what becomes of what touches */
    const struct objects *objects; /* the caller's; with edges of each */
    struct scene *scene; /* the caller's, its edges fetched; NULL: no columns of places */
    bool has_geometry; /* both points and the normal, in the place of one point */
};

/* Write the vertices of a feature of so many points (1 a vertex, 2 an edge, 3 a face), as
 * ",3,4". Returns how many. */
uint32_t csv_vertices(FILE *to, uint32_t points, uint32_t feature,
                      const struct pccd_edge *edges, const uint32_t (*triangles)[3]);

/* Write a comma, and the shortest decimals that are read as the same number. */
void csv_number(FILE *to, double x);

/* Open and write the header. Errors: E_SYSTEM. */
int contacts_csv_open(struct contacts_csv *csv, struct ctl_error *error);
/* Append the records of a page; `step` counts from 1. vf: the vertex, then the triangle's
 * three as in the file; ee: the first edge's two, ascending, then the second's. Records
 * of mode pairs have empty times and proved = 0. Places are those of frames step - 1 and
 * `step`, which are read; pairs have none. */
void contacts_csv_page(const struct contacts_csv *csv, uint32_t step,
                       const struct pccd_answer *page);
struct check_run {
    struct pccd_client *client; /* the caller's */
    struct pccd_step_settings settings;
    uint32_t repeats; /* timed runs after the first; 0: only the first */
    uint32_t scene;
    struct report_scene told;
    struct progress *progress; /* the caller's, of all runs of all steps; or NULL */
    struct objects *objects;   /* the caller's, or NULL: of each step, which ones meet */
    /* Called once in each step while the daemon computes. Then: may the next one begin,
     * whose frame is read by that? If so, with the answer to this one: was that right, as
     * nobody asks where the objects are before the next step? And with each page that is
     * shown. Or NULL. */
    void (*meanwhile)(void *owner);
    bool (*goes_on)(void *owner);
    bool (*may_stay)(void *owner, const struct pccd_answer *answer);
    void (*note)(void *owner, const struct pccd_answer *page);
    void *owner;
    uint32_t begun; /* this step was begun early; 0: none was */
    uint64_t begun_step;
    double begun_ms; /* when the answer before it came */
    double *times; /* ours: [REPORT_PHASE_COUNT + 1][repeats], scratch for medians */
};

/* Register the first frame of all objects; with_edges: get their edges too. client,
 * settings and repeats are set before. Then do as check_run_tell. Errors: those of
 * pccd.h, E_NOMEM. */
int check_run_begin(struct check_run *run, struct scene *files, bool with_edges,
                    struct ctl_error *error);
/* Fill `told`: of each object what its files are, and what the daemon has said of it.
 * Errors: E_NOMEM. */
int check_run_tell(struct check_run *run, const struct scene *files,
                   struct ctl_error *error);
/* Make one step to frame `number`, which was read beside the one before, where the
 * objects stand now: once, then `repeats` times the same again. The last run's records go
 * to `csv` unless that has no file. Fills all of `step` but the names of files. */
int check_run_step(struct check_run *run, const struct scene *files, uint32_t number,
                   const struct contacts_csv *csv, struct report_step *step,
                   struct ctl_error *error);

/* Say where a record lies, with the numbers of its parts if run->objects is there. One of
 * a newer daemon, of another kind, has no place. Errors: those of pccd_mesh_edges. */
int check_run_place(struct check_run *run, const struct scene *files, uint32_t number,
                    const struct pccd_contact *contact, struct report_first *first,
                    struct ctl_error *error);

/* Make once more the step that was made last, whose frames are still read: all its
 * records are fetched, and given back. */
int check_run_again(struct check_run *run, const struct scene *files, uint32_t number,
                    struct ctl_error *error);

/* Question that check_run_repeat asks, and where the pages of the last answer go. */
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
/* Set `first` to the earliest contact of a page, unless it is as early already: of
 * several it is the first in the order of the answer. */
void check_run_find_first(const struct pccd_answer *page, struct pccd_contact *first);
/* Set `first` to where a contact of a known kind is, given the `ends` of its features,
 * and to the parts of `objects` (NULL: without) that have them. */
void check_run_set_first(const struct objects *objects,
                         const struct pccd_contact *contact,
                         const struct place_feature ends[2], struct report_first *first);
/* Make run->times. */
int check_run_times(struct check_run *run, struct ctl_error *error);
/* Set the error to `what`, and the library's own words about a failed call. Returns
 * `status`. */
int check_run_fail(const struct check_run *run, int status, const char *what,
                   struct ctl_error *error);
void check_run_deinit(struct check_run *run);

/* ---- What is asked of a check: the options of `pccdctl check` and of
 * `pccd-mpi check`. */

struct check_options {
    struct ask_options ask; /* its CSV: of contacts */
    struct pccd_step_settings settings;
};

/* Options that fill a struct check_options. */
extern const struct option_table check_table;

/* Return all that was said of a step. */
struct pccd_step_settings check_step_settings(const struct check_options *options);

#endif
