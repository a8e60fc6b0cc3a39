/* setup.h - the conditions of a measurement: build, machine, settings.
 *
 * Threads: one.
 */
#ifndef RUN_SETUP_H
#define RUN_SETUP_H

#include "play.h"

/* Of the sources that were built, with "-dirty" where they were changed; "unknown"
 * outside of a repository. Generated (local.mk). */
extern const char run_commit[];

/* Tell `each` of every item in a fixed order: as a text, or if that is NULL, as the
 * number. `name` is a word; both texts are gone when it returns. */
typedef void (*run_item_fn)(void *context, const char *name, const char *text,
                            uint64_t number);
void run_setup_each(const struct run_play *play, run_item_fn each, void *context);

#endif
