/* wide_method.h - the functions of the method `wide` that a step calls. */
#ifndef ENG_WIDE_METHOD_H
#define ENG_WIDE_METHOD_H

#include "method.h"

extern const struct eng_method_calls eng_method_wide;

#endif
