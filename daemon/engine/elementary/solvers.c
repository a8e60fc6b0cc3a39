/* solvers.c - how the queries of each kind are decided. */
#include "solvers.h"

#include "solve.h"

const struct eng_solver eng_solvers[PCCD_KIND_COUNT] = {
    [PCCD_VF] = {.has_kernels = true, .search = eng_search},
    [PCCD_EE] = {.has_kernels = true, .search = eng_search},
    [PCCD_VE] = {.search = NULL},
    [PCCD_VV] = {.search = NULL},
};
