/* sequences.c - random sequences one after the other. */
#include "sequences.h"

#include <stddef.h>
#include <stdlib.h>

#include "clock.h"
#include "prng.h"

void sequences_live(void (*live)(uint64_t seed), uint64_t count, const char *number)
{
    const char *seconds = getenv("PCCD_PROPERTY_SECONDS");
    const char *given = number ? getenv(number) : NULL;
    uint64_t end_ns = common_now_ns();
    struct prng prng = {prng_seed()};
    end_ns += seconds ? (uint64_t)(strtod(seconds, NULL) * 1e9) : 0;
    count = given ? strtoull(given, NULL, 10) : count;
    for (uint64_t i = 0; seconds ? common_now_ns() < end_ns : i < count; i++) {
        live(i == 0 ? prng.state : prng_next(&prng));
    }
}
