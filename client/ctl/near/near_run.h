/* near_run.h - `pccdctl near`: its options, what it asks, and how the answer is told. */
#ifndef CTL_NEAR_RUN_H
#define CTL_NEAR_RUN_H

#include <stdio.h>

#include "ask_options.h"
#include "check_run.h"
#include "error.h"
#include "meshfile.h"
#include "meshframes.h"
#include "pccd.h"
#include "scene.h"
#include "whole_file.h"

/* ---- What is asked about what is near: the options of `pccdctl near` and of
 * `pccd-mpi near`. */

struct near_options {
    struct ask_options ask;
    struct pccd_near_settings settings; /* PCCD_NEAR_SETTINGS_INIT before */
    bool has_distance, has_gap, has_self;
};

/* Options that fill a struct near_options. */
extern const struct option_table near_table;

/* Return all that was said of the question. */
struct pccd_near_settings near_options_settings(const struct near_options *options);
/* Leave out the pairs of one of several objects with itself, unless they are asked for
 * or its settings speak of them. */
void near_options_leave_out_self(const struct near_options *options, uint32_t objects,
                                 struct pccd_object_settings *settings);

/* All zero, but for what is the caller's, before the scene is read. */
struct near_run {
    struct check_run run;               /* client and repeats are the caller's */
    struct pccd_near_settings settings; /* the caller's */
    struct scene scene;                 /* ours; first_alone */
    char **names;                       /* ours: of the scene's objects; or NULL */
    struct report_step step;            /* the answer, and the place of the nearest
                                           record, or of the deepest; no names of files */
    bool has_touching;           /* asked for crossings, and something intersects .. */
    struct report_step touching; /* .. the pairs at distance 0 then */
};

/* Return whether a question about crossings has to be followed by one about what touches,
 * and set *settings to it: what intersects has a record in one of them. All that is no
 * edge through a face (edges that cut edges, corners that touch, faces that overlap) is a
 * pair at distance 0 (pccd_near.h). Objects then have no thickness, which does not enter
 * into crossings either. */
bool near_asks_touching(const struct near_run *near, struct pccd_near_settings *settings);
extern const struct pccd_object_settings near_without_thickness;

/* Ask. The pages of the last answer go to `page`, unless that is NULL. */
int near_run_ask(struct near_run *near,
                 void (*page)(void *context, const struct pccd_answer *page),
                 void *context, struct ctl_error *error);
void near_run_deinit(struct near_run *near);

/* ---- Prints the answer of `pccdctl near`. */

/* Tell on stderr which files have more frames than the one that is read. */
void near_report_warn(const struct near_run *near);
void near_report_print(FILE *to, const struct near_run *near);
/* Print the answer as one JSON object. False: it could not be written, or without
 * memory. */
bool near_report_json(FILE *to, const struct near_run *near);

/* ---- Writes what is near as CSV (`pccdctl near --csv FILE`).
 *
 * Write kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz,x,y,z; of vertices:
 * object,vertex,bound. Objects are numbers of files, from 1; vertices are numbered from 0
 * in file order; u and v are the record's param, nx, ny and nz its direction; x, y and z
 * are the point of b, which has_place false leaves out. */

struct near_csv {
    const char *path; /* "-": the standard output; NULL: nothing is to be written */
    struct near_run *near;
    bool has_place; /* positions are here */
    struct whole_file whole;
    uint32_t *order; /* ours: places of objects, by handle; of vertices */
};

/* Open and write the header. Errors: E_SYSTEM, E_NOMEM. */
int near_csv_open(struct near_csv *csv, struct ctl_error *error);
/* Append a page of the answer; `context` is the struct near_csv. */
void near_csv_page(void *context, const struct pccd_answer *page);
/* Close the file: it appears only now, and only if it `is_whole`. Errors: E_SYSTEM. */
int near_csv_close(struct near_csv *csv, bool is_whole, struct ctl_error *error);

#endif
