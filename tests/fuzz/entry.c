/* entry.c - libFuzzer's way to a target.
 *
 * Room:     tests/fuzz. May include: fuzz_target.h.
 * Does:     call the target that FUZZ_TARGET names.
 * Threads:  one.
 * Source:   https://llvm.org/docs/LibFuzzer.html
 */
#include "fuzz_target.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
    fuzz_call(FUZZ_TARGET, data, bytes);
    return 0;
}
