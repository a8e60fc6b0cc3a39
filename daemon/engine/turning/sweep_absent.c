/* sweep_absent.c - in the place of a set that was not built, as kernel/absent.c. */
#include "passage.h"
#include "straight.h"
#include "sweep.h"

const struct eng_sweep_calls ENG_SWEEP(ENG_ISA) = {.init = NULL};
const struct eng_straight_calls ENG_STRAIGHT(ENG_ISA) = {.make = NULL};
const struct eng_passage_calls ENG_PASSAGE(ENG_ISA) = {.look = NULL};
