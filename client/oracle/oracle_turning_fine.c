/* oracle_turning_fine.c - the search of oracle_turning.c by numbers of 113 bits. */
#include "oracle_turning_parts.h"

#include <float.h>

#if LDBL_MANT_DIG == 113
typedef long double real113;
#else
typedef __float128 real113;
#endif

#define REAL        real113
#define REAL_UNIT   ((REAL)0x1p-112)
#define REAL_CUT    ((REAL)0x1p-120)
#define REAL_TERMS  15
#define REAL_SERIES 22
#define REAL_LEAST  0x1p-50 /* of the width: the shortest span */
#define REAL_SEARCH oracle_turning_search_fine
#include "oracle_turning_search.h"
