/* recording.c - where a test's recordings are, and whether they repeat. */
#include "recording.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"
#include "fixture.h"
#include "run_ctl.h"

#define ANSWERS_MAX 1000000 /* of any test */

char test_recording[96];
char test_forged[96];

static char folder[] = "/tmp/pccd-test-record-XXXXXX";

bool test_recording_begin(void)
{
    if (mkdtemp(folder) == NULL) {
        return false;
    }
    (void)snprintf(test_recording, sizeof test_recording, "%s/session.rec", folder);
    (void)snprintf(test_forged, sizeof test_forged, "%s/forged.rec", folder);
    return true;
}

bool test_recording_end(void)
{
    char command[128];

    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command) == 0;
}

int test_recording_start(void **state)
{
    return test_recording_begin() ? test_shared_start(state) : -1;
}

int test_recording_stop(void **state)
{
    return test_recording_end() ? test_shared_stop(state) : -1;
}

void test_recording_clear(void)
{
    char command[128];

    (void)snprintf(command, sizeof command, "rm -f %s/*", folder);
    assert_int_equal(system(command), 0);
}

uint64_t test_recording_repeats(const char *options, const char *file, uint64_t least)
{
    char said[4096];
    int status = test_ctl("replay", options, file, said, sizeof said);
    /* Of no step nothing is the same, which is no success. */
    int expected = least == 0 && strstr(said, "it holds no step") != NULL ? 4 : 0;

    if (status != expected || test_ctl_number(said, "same") < least) {
        print_message("%s, %s: %s\n", file, options, said);
    }
    assert_int_equal(status, expected);
    assert_int_equal(test_ctl_number(said, "differ"), 0);
    assert_in_range(test_ctl_number(said, "same"), least, ANSWERS_MAX);
    return test_ctl_number(said, "same");
}
