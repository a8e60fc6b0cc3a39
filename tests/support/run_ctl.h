/* run_ctl.h - runs pccdctl in a test. */
#ifndef TEST_RUN_CTL_H
#define TEST_RUN_CTL_H

#include <stddef.h>
#include <stdint.h>

/* `pccdctl COMMAND OPTIONS FILE`: its exit status, or -1; the beginning of what it says,
 * to both outputs, in `said`. */
int test_ctl(const char *command, const char *options, const char *file, char *said,
             size_t room);

/* It ends with that status, and says each of these texts; NULL ends them. Else the case
 * fails, and shows what was said. */
void test_ctl_says(int status, const char *command, const char *options, const char *file,
                   ...);

/* Return a number of the JSON object that was said; UINT64_MAX: there is none of that
 * name. */
uint64_t test_ctl_number(const char *said, const char *name);

#endif
