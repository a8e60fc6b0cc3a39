/* hash_text.h - writes a hash as people and scripts read it: "2:" and 32 hexadecimal
 * digits.
 *
 * Source: proto/PROTOCOL.md, "The hash of an answer".
 */
#ifndef PROTO_HASH_TEXT_H
#define PROTO_HASH_TEXT_H

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>

#define PROTO_HASH_BYTES 40u /* of the text and its NUL, for versions up to 99999 */

/* hash[0] high, hash[1] low. Returns `text`. */
static inline const char *proto_hash_text(uint32_t version, const uint64_t hash[2],
                                          char text[PROTO_HASH_BYTES])
{
    (void)snprintf(text, PROTO_HASH_BYTES, "%" PRIu32 ":%016" PRIx64 "%016" PRIx64,
                   version % 100000u, hash[0], hash[1]);
    return text;
}

#endif
