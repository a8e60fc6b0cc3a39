/* printable.h - text for people: what may go to a terminal, plurals, hashes.
 *
 * Write bytes that could control a terminal or its reader as \xNN: control characters of
 * seven and eight bits, those that turn the direction of text or are not seen (Unicode's
 * format characters), and whatever is not UTF-8.
 */
#ifndef PROTO_PRINTABLE_H
#define PROTO_PRINTABLE_H

#include <inttypes.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Write text so that it can control nothing: "a\033[2J" becomes "a\x1b[2J". At most
 * room - 1 bytes and a NUL are written to `to`, never a part of an \xNN or of a
 * character. Returns how many bytes all of it takes without the NUL, as snprintf does.
 * `bytes` may include NULs: they become \x00. */
size_t proto_printable(const char *text, size_t bytes, char *to, size_t room);

/* ---- Chooses singular or plural: one contact, two contacts. */

/* Return one word or the other: printf("%u %s", n, proto_plural(n, "vertex",
 * "vertices")) */
static inline const char *proto_plural(uint64_t count, const char *one, const char *many)
{
    return count == 1 ? one : many;
}

/* ---- Writes a hash as people and scripts read it: "2:" and 32 hexadecimal
 * digits. */

#define PROTO_HASH_BYTES 40u /* of the text and its NUL, for versions up to 99999 */

/* Write a hash, hash[0] high, hash[1] low. Returns `text`. */
static inline const char *proto_hash_text(uint32_t version, const uint64_t hash[2],
                                          char text[PROTO_HASH_BYTES])
{
    (void)snprintf(text, PROTO_HASH_BYTES, "%" PRIu32 ":%016" PRIx64 "%016" PRIx64,
                   version % 100000u, hash[0], hash[1]);
    return text;
}

#endif
