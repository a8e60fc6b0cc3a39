/* fuzz_spans.h - proves by interval arithmetic that two features do or do not meet. */
#ifndef FUZZ_SPANS_H
#define FUZZ_SPANS_H

#include <stdbool.h>

#include "query.h"

/* Return whether an axis separates the features throughout the step. Comparisons alone,
 * exact. */
bool fuzz_is_apart(const struct eng_query *query);

/* From l to r, 0 <= l < r <= 1, or to what is returned, there is certainly no contact.
 * Looks at `work` spans at most. */
double fuzz_clear_until_double(const struct eng_query *query, double l, double r,
                               int work);
double fuzz_clear_until_long(const struct eng_query *query, double l, double r, int work);

/* Certainly a contact between l < r, if there is none before l? *early: it is before
 * l + *early. */
bool fuzz_is_crossing_double(const struct eng_query *query, double l, double r,
                             double *early);
bool fuzz_is_crossing_long(const struct eng_query *query, double l, double r,
                           double *early);

#endif
