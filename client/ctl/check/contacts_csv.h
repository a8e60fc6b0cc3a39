/* contacts_csv.h - writes contacts as CSV (`pccdctl check --contacts FILE`).
 *
 * Threads: one.
 */
#ifndef CTL_CONTACTS_CSV_H
#define CTL_CONTACTS_CSV_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "pccd.h"
#include "whole_file.h"

struct objects;

/* The arrays are the caller's and stay as they are until close. */
struct contacts_csv {
    const char *path; /* "-": the standard output */
    FILE *file;       /* NULL: nothing is to be written */
    struct whole_file whole; /* what it goes to */
    const uint32_t (*triangles)[3];
    const struct pccd_edge *edges;
    bool has_step; /* a first column "step" */
    const struct objects *objects; /* NULL, or two last columns with their names */
};

/* Open and write the header. Errors: E_SYSTEM. */
int contacts_csv_open(struct contacts_csv *csv, struct ctl_error *error);
/* Append the records of a page; `step` counts from 1. vf: the vertex, then the triangle's
 * three as in the file; ee: the first edge's two, ascending, then the second's. Records
 * of mode pairs have empty times and proved = 0. */
void contacts_csv_page(const struct contacts_csv *csv, uint32_t step,
                       const struct pccd_answer *page);
/* The file appears only now, and only if it `is_whole`. Errors: E_SYSTEM, also when an
 * earlier line could not be written. */
int contacts_csv_close(struct contacts_csv *csv, bool is_whole, struct ctl_error *error);

#endif
