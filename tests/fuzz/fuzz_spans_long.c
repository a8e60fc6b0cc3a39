/* fuzz_spans_long.c - what ranges of long doubles prove about an elementary test. */
#define FUZZ_SPANS_LONG
#define FUZZ_REAL    long double
#define FUZZ_EPSILON LDBL_EPSILON

#include "fuzz_spans.c"
