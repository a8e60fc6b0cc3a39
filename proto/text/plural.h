/* plural.h - chooses singular or plural: one contact, two contacts. */
#ifndef PROTO_PLURAL_H
#define PROTO_PLURAL_H

#include <stdint.h>

/* printf("%u %s", n, proto_plural(n, "vertex", "vertices")) */
static inline const char *proto_plural(uint64_t count, const char *one, const char *many)
{
    return count == 1 ? one : many;
}

#endif
