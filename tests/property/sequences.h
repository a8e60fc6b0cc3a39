/* sequences.h - random sequences one after the other, so many or for so long. */
#ifndef SEQUENCES_H
#define SEQUENCES_H

#include <stdint.h>

/* `count` of them, or as many as the environment variable `number` (NULL: none) says. */
void sequences_live(void (*live)(uint64_t seed), uint64_t count, const char *number);

#endif
