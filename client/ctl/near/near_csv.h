/* near_csv.h - writes what is near as CSV (`pccdctl near --csv FILE`).
 *
 * Write kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz; of vertices:
 * object,vertex,bound. Objects are numbers of files, from 1; vertices are numbered from 0
 * in file order; u and v are the record's param, nx, ny and nz its direction.
 *
 * Threads: one.
 */
#ifndef CTL_NEAR_CSV_H
#define CTL_NEAR_CSV_H

#include "error.h"
#include "near_run.h"
#include "pccd.h"
#include "whole_file.h"

struct near_csv {
    const char *path; /* "-": the standard output; NULL: nothing is to be written */
    const struct near_run *near;
    struct whole_file whole;
    uint32_t *order; /* ours: places of objects, by handle; of vertices */
};

/* Open and write the header. Errors: E_SYSTEM, E_NOMEM. */
int near_csv_open(struct near_csv *csv, struct ctl_error *error);
/* Append a page of the answer; `context` is the struct near_csv. */
void near_csv_page(void *context, const struct pccd_answer *page);
/* The file appears only now, and only if it `is_whole`. Errors: E_SYSTEM. */
int near_csv_close(struct near_csv *csv, bool is_whole, struct ctl_error *error);

#endif
