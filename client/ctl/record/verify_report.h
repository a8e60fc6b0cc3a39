/* client/ctl/record/verify_report.h - tells what came of verify.h, as text and as JSON.
 *
 * Room:     client/ctl. May include: verify.h, jansson.h.
 * Does:     write the report of pccdctl verify and pccd-mpi verify.
 * Threads:  one.
 */
#ifndef CTL_VERIFY_REPORT_H
#define CTL_VERIFY_REPORT_H

#include <jansson.h>
#include <stdbool.h>

#include "verify.h"

/* PCCD_OK, or PCCD_E_STATE: none of the answers could be checked. */
int verify_judge_counts(const struct verify_counts *counts, const char *path,
                        struct ctl_error *error);

/* On the standard output; `witness` NULL: nothing is wrong. False: no memory, or it could
 * not be written. */
void verify_print_text(const struct verify_counts *counts,
                       const struct verify_witness *witness);
bool verify_print_json(const struct verify_counts *counts,
                       const struct verify_witness *witness);

/* What is wrong, as an object, NULL without memory; and back: false if it is none. */
json_t *verify_witness_json(const struct verify_witness *witness);
bool verify_witness_read(const json_t *object, struct verify_witness *witness);
/* The counts, to an object. False without memory. */
bool verify_counts_json(json_t *object, const struct verify_counts *counts);
bool verify_counts_read(const json_t *object, struct verify_counts *counts);

#endif
