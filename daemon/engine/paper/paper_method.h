/* paper_method.h - the functions of the method `paper` that a step calls. */
#ifndef ENG_PAPER_METHOD_H
#define ENG_PAPER_METHOD_H

#include "method.h"

extern const struct eng_method_calls eng_method_paper;

#endif
