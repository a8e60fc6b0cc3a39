/* eng_case.h - checks an elementary test with a known answer in every order, direction
 * and scale.
 */
#ifndef TEST_ENG_CASE_H
#define TEST_ENG_CASE_H

#include "eng_kit.h"
#include "solve.h"

#define CASE_MISS 2.0 /* as a first time: there is none */

/* A scratch for as long as the program runs, and its end, for CASES_WITH. */
struct eng_exact *case_exact(void);
int case_end(void **state);

struct eng_query case_query(enum pccd_kind kind, const double x0[4][3],
                            const double x1[4][3]);

/* The same features with their points in another order: six orders of a face's corners,
 * eight of two edges and their ends. */
unsigned case_order_count(enum pccd_kind kind);
struct eng_query case_order(const struct eng_query *query, unsigned order);

struct eng_query case_reversed(const struct eng_query *query);

/* The solver's answer to a query has a form: proved, bracket within the tolerance,
 * initial iff it begins at once, unit normal or none, and both parameters name one
 * point. */
void case_check_form(const struct eng_query *query, double tolerance,
                     const struct eng_hit *hit);

/* The first contact of `query` is at exactly `t`, or never; whatever the order, scale,
 * place and tolerance, and backwards too if there is none. */
void case_check(const struct eng_query *query, double t);

#endif
