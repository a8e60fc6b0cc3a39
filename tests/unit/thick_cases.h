/* thick_cases.h - thick features whose first time within a distance was worked out by
 * hand, for the oracle and for the engine.
 */
#ifndef TESTS_THICK_CASES_H
#define TESTS_THICK_CASES_H

#include <stdbool.h>
#include <stddef.h>

struct thick_case {
    const char *name;
    int points_a; /* 1 a vertex, 2 an edge, 3 a face */
    int points_b;
    double p[8][3]; /* at t = 0: those of a, of b; from p[4] on at t = 1 */
    double radius;
    double approach; /* 0: none is asked for */
    bool is_inside;  /* at t = 0 */
    bool hits;
    long num; /* the first time is num / den */
    unsigned long den;
};

extern const struct thick_case thick_cases[];
extern const size_t thick_case_count;

#endif
