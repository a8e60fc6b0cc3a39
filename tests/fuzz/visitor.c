/* visitor.c - an honest client among inputs of a fuzzer. */
#include "visitor.h"

#include <stdio.h>
#include <unistd.h>

#include "fuzz_target.h"
#include "life.h"

#define TRIES 50

void fuzz_visit(const char *socket_path)
{
    static struct life life;
    /* Sessions that wait for their clients hold quotas and the recording for a while. */
    for (int tries = 0; tries < TRIES; tries++) {
        life_run(&life, socket_path, LIFE_ONCE);
        if (life.wrong[0] == '\0' && !life.is_lost && life.refusals == 0) {
            return;
        }
        usleep(100000);
    }
    if (life.wrong[0] != '\0') {
        fprintf(stderr, "an honest client: %s\n", life.wrong);
    }
    FUZZ_CHECK(life.wrong[0] == '\0' && !life.is_lost && life.refusals == 0);
}
