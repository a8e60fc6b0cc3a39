/* methods.c - the methods that a step can use, by number. */
#include "methods.h"

#include "paper.h"
#include "wide_method.h"

const struct eng_method_calls *const eng_methods[PCCD_METHOD_COUNT] = {
    [PCCD_METHOD_PAPER] = &eng_method_paper, [PCCD_METHOD_WIDE] = &eng_method_wide};
