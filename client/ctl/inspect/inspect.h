/* inspect.h - packs the steps of a recording as data for the page of `pccdctl inspect`.
 *
 * Threads: one.
 */
#ifndef CTL_INSPECT_H
#define CTL_INSPECT_H

#include "inspect_data.h"
#include "play.h"

int inspect_init(struct inspect *inspect, const struct inspect_settings *settings,
                 struct page_file *page, struct ctl_error *error);
/* A play_fn; its context is the inspect. Ends the playing when the file is full. */
int inspect_step(void *inspect, const struct play_step *step, struct ctl_error *error);
/* The same of a question about what is near, a play_near_fn. */
int inspect_near(void *inspect, const struct play_near *near, struct ctl_error *error);
/* The rest of the file. `name`: of the recording; any bytes. */
int inspect_finish(struct inspect *inspect, const char *name,
                   const struct play_summary *summary, struct ctl_error *error);
void inspect_deinit(struct inspect *inspect);

#endif
