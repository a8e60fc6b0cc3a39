/* entry.c - libFuzzer's way to a target. */
#include "fuzz_target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fuzz_call(FUZZ_TARGET, data, bytes);
    return 0;
}
