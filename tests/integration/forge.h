/* forge.h - copies of recordings in which something was changed; names that they have. */
#ifndef TEST_FORGE_H
#define TEST_FORGE_H

#include <stdbool.h>
#include <stdint.h>

#include "reader.h"

/* A chunk of the copy, to be changed in its place. */
struct forge_chunk {
    uint16_t kind;
    uint8_t *payload; /* of malloc; it may be made longer */
    uint64_t bytes;
};

/* Returns whether the chunk is in the copy. */
typedef bool (*forge_fn)(void *context, struct forge_chunk *chunk);

void forge_recording(const char *from, const char *to, forge_fn change, void *context);

/* Return what a recording calls an object at last: a static text; "": nothing. */
const char *forge_name(const char *path, uint32_t object);

#endif
