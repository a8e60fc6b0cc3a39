/* recording.h - gives each test a folder for its recordings, and checks that they
 * repeat. */
#ifndef TEST_RECORDING_H
#define TEST_RECORDING_H

#include <stdbool.h>
#include <stdint.h>

/* The file to record to, in a folder of its own; and one beside it, for a copy in which
 * something was changed (forge.h). */
extern char test_recording[96];
extern char test_forged[96];

/* Make the folder of a group; remove it and all in it. */
bool test_recording_begin(void);
bool test_recording_end(void);
/* Set up and tear down a group that has a shared daemon, too (fixture.h). */
int test_recording_start(void **state);
int test_recording_stop(void **state);
/* Remove the files of the last test. */
void test_recording_clear(void);

/* `pccdctl replay OPTIONS FILE` ends well, `least` answers or more are the same, and none
 * differs; with `least` 0 it may hold no step; options have --json. Returns how many
 * there are. */
uint64_t test_recording_repeats(const char *options, const char *file, uint64_t least);

#endif
