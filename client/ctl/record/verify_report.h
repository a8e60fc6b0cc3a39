/* verify_report.h - tells what came of verify.h, as text and as JSON.
 *
 * Threads: one.
 */
#ifndef CTL_VERIFY_REPORT_H
#define CTL_VERIFY_REPORT_H

#include <jansson.h>
#include <stdbool.h>

#include "answers.h"
#include "verify.h"

/* What came of all that was looked at, in its order, up to the first that is wrong; zero
 * before. */
struct verify_report {
    struct verify_counts counts;
    const struct verify_witness *witness; /* NULL: nothing is wrong */
    struct verify_unchecked {
        uint64_t step;
        bool is_near;
        char why[VERIFY_WHY_BYTES];
    } * unchecked; /* what was not checked, or not all of it */
    size_t unchecked_count, unchecked_room;
};
/* Add what came of one, which stays where it is if it is wrong. PCCD_OK or
 * PCCD_E_NOMEM. */
int verify_report_add(struct verify_report *report, const struct verify_result *result,
                      struct ctl_error *error);
/* Add answers that belong to no step of the recording. */
int verify_report_strays(struct verify_report *report, struct answers *answers,
                         struct ctl_error *error);
void verify_report_deinit(struct verify_report *report);

/* PCCD_OK, or PCCD_E_STATE: none of the answers could be checked, and none is wrong. The
 * report says so, too, and why. */
int verify_report_judge(const struct verify_report *report, const char *path,
                        struct ctl_error *error);

/* On the standard output. False: no memory, or it could not be written. */
void verify_print_text(const struct verify_report *report);
bool verify_print_json(const struct verify_report *report);

/* What is wrong, as an object, NULL without memory; and back: false if it is none. */
json_t *verify_witness_json(const struct verify_witness *witness);
bool verify_witness_read(const json_t *object, struct verify_witness *witness);
/* The counts, to an object. False without memory. */
bool verify_counts_json(json_t *object, const struct verify_counts *counts);
bool verify_counts_read(const json_t *object, struct verify_counts *counts);

#endif
