/* daemon/engine/paper/paper_method.h - the functions of the method `paper` that a step
 * calls.
 *
 * Room:     engine. May include: method.h.
 * Does:     declare the method's table for methods.h.
 * Threads:  method.h.
 */
#ifndef ENG_PAPER_METHOD_H
#define ENG_PAPER_METHOD_H

#include "method.h"

extern const struct eng_method_calls eng_method_paper;

#endif
