/* plural.h - chooses singular or plural: one contact, two contacts.
 *
 * Room:     proto/text. May include: the C library.
 * Does:     choose the form of a word that goes with a number.
 * Does not: print the number.
 * Threads:  [any].
 */
#ifndef PROTO_PLURAL_H
#define PROTO_PLURAL_H

#include <stdint.h>

/* printf("%u %s", n, proto_plural(n, "vertex", "vertices")) */
static inline const char *proto_plural(uint64_t count, const char *one, const char *many)
{
    return count == 1 ? one : many;
}

#endif
