/* methods.h - the list of methods by which a step can find candidates: `paper` and
 * `wide`.
 *
 * Threads: [any]; constant.
 */
#ifndef ENG_METHODS_H
#define ENG_METHODS_H

#include "method.h"
#include "question.h"

/* NULL for PCCD_METHOD_DEFAULT, which is none of its own. */
extern const struct eng_method_calls *const eng_methods[PCCD_METHOD_COUNT];

#endif
