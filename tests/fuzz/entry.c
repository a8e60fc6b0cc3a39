/* entry.c - libFuzzer's way to the target that $FUZZ_TARGET names. */
#include <stdio.h>
#include <stdlib.h>

#include "fuzz_target.h"

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static fuzz_function *target;

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    const char *name = getenv("FUZZ_TARGET");

    (void)argc;
    target = name == NULL ? NULL : fuzz_target(name);
    if (target == NULL) {
        fprintf(stderr, "%s: FUZZ_TARGET names no target\n", (*argv)[0]);
        exit(2);
    }
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fuzz_call(target, data, bytes);
    return 0;
}
