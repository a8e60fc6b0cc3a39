/* object_attributes.h - the list of what a client can set of an object (group, mask,
 * ...), and the code that copies it.
 */
#ifndef COMMON_OBJECT_ATTRIBUTES_H
#define COMMON_OBJECT_ATTRIBUTES_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "pccd_types.h"

/* X(F, type, member, NAME, at first, meaning), in the order of the bits PCCD_OBJECT_NAME
 * of enum pccd_object_what. `type` is a number of messages.def: u32, u64, f64 or bool;
 * `member` is called so in struct pccd_object_settings and struct pccd_object_info, too.
 * F is handed through. New ones go to the end: recordings have them in this order. */
#define COMMON_OBJECT_ATTRIBUTES(X, F)                                                   \
    X(F, u64, group, GROUP, 1, "bits: the groups that it is in; at first 1")             \
    X(F, u64, mask, MASK, UINT64_MAX, "bits: the groups that it may meet; at first all") \
    X(F, bool, self_collision, SELF, true, "whether it may meet itself; at first true")  \
    X(F, f64, radius, RADIUS, 0,                                                         \
      "half the thickness of its features, 0 .. 1e18; at first 0: the radii of the "     \
      "mesh's vertices, if it has any")                                                  \
    X(F, f64, rest_distance, REST_DISTANCE, 0,                                           \
      "pairs within it that are nearer than this as registered have no thickness, 0 "    \
      ".. 1e18; at first 0")                                                             \
    X(F, u32, rest_rings, REST_RINGS, 0,                                                 \
      "pairs within it with a vertex each that so many edges or fewer join have no "     \
      "thickness, 0 .. 8; at first 0")                                                   \
    X(F, u64, user_data, USER_DATA, 0,                                                   \
      "a number of the user's, which means nothing to the daemon; at first 0")

typedef uint32_t common_attribute_u32;
typedef uint64_t common_attribute_u64;
typedef double common_attribute_f64;
typedef bool common_attribute_bool;

struct common_attributes {
#define COMMON_MEMBER(F, type, member, name, at_first, meaning)                          \
    common_attribute_##type member;
    COMMON_OBJECT_ATTRIBUTES(COMMON_MEMBER, )
#undef COMMON_MEMBER
};

/* Number of a word of a recording: COMMON_WORD_GROUP. */
enum {
#define COMMON_NUMBER(F, type, member, name, at_first, meaning) COMMON_WORD_##name,
    COMMON_OBJECT_ATTRIBUTES(COMMON_NUMBER, )
#undef COMMON_NUMBER
        COMMON_WORDS
};

#define COMMON_BIT(F, type, member, name, at_first, meaning)                             \
    static_assert((uint32_t)PCCD_OBJECT_##name == 1u << COMMON_WORD_##name,              \
                  "bits are in the order of the list");
COMMON_OBJECT_ATTRIBUTES(COMMON_BIT, )
#undef COMMON_BIT

/* As an object is made. */
#define COMMON_AT_FIRST(F, type, member, name, at_first, meaning) .member = (at_first),
#define COMMON_ATTRIBUTES_AT_FIRST                                                       \
    {                                                                                    \
        COMMON_OBJECT_ATTRIBUTES(COMMON_AT_FIRST, )                                      \
    }

/* Bits of enum pccd_object_what that this release knows, and those that `what` stands
 * for: PCCD_OBJECT_ALL is every bit that the daemon knows, be it newer or older than a
 * client. */
#define COMMON_OBJECT_KNOWN ((1u << COMMON_WORDS) - 1u)
#define COMMON_OBJECT_BITS(what)                                                         \
    ((what) == (uint32_t)PCCD_OBJECT_ALL ? COMMON_OBJECT_KNOWN : (uint32_t)(what))

/* Those that say how thick an object is. */
#define COMMON_OBJECT_THICK                                                              \
    ((uint32_t)PCCD_OBJECT_RADIUS | (uint32_t)PCCD_OBJECT_REST_DISTANCE |                \
     (uint32_t)PCCD_OBJECT_REST_RINGS)

/* All of them from one struct to another: of messages, settings, or the one above. */
#define COMMON_ATTRIBUTE_COPY(F, type, member, name, at_first, meaning)                  \
    common_to_->member = common_from_->member;
#define COMMON_ATTRIBUTES_COPY(to, from)                                                 \
    do {                                                                                 \
        __typeof__(to) common_to_ = (to);                                                \
        __typeof__(from) common_from_ = (from);                                          \
        COMMON_OBJECT_ATTRIBUTES(COMMON_ATTRIBUTE_COPY, )                                \
    } while (0)

/* Set those that `what` names. */
static inline void common_attributes_set(struct common_attributes *to, uint32_t what,
                                         const struct common_attributes *from)
{
#define COMMON_SET(F, type, member, name, at_first, meaning)                             \
    to->member = (what & (uint32_t)PCCD_OBJECT_##name) != 0 ? from->member : to->member;
    COMMON_OBJECT_ATTRIBUTES(COMMON_SET, )
#undef COMMON_SET
}

/* Return whether two different objects may meet, by their groups and masks. */
static inline bool common_attributes_may_meet(const struct common_attributes *a,
                                              const struct common_attributes *b)
{
    return (a->group & b->mask) != 0 && (b->group & a->mask) != 0;
}

/* Return a number as a word of a recording: a double as its bits. The four that follow
 * turn it back. */
static inline uint64_t common_word_of_u32(uint32_t number)
{
    return number;
}

static inline uint64_t common_word_of_u64(uint64_t number)
{
    return number;
}

static inline uint64_t common_word_of_f64(double number)
{
    uint64_t word;
    memcpy(&word, &number, sizeof word);
    return word;
}

static inline uint64_t common_word_of_bool(bool number)
{
    return number;
}

static inline uint32_t common_u32_of_word(uint64_t word)
{
    return (uint32_t)word;
}

static inline uint64_t common_u64_of_word(uint64_t word)
{
    return word;
}

static inline double common_f64_of_word(uint64_t word)
{
    double number;
    memcpy(&number, &word, sizeof number);
    return number;
}

static inline bool common_bool_of_word(uint64_t word)
{
    return word != 0;
}

static inline void common_attributes_pack(const struct common_attributes *from,
                                          uint64_t words[COMMON_WORDS])
{
#define COMMON_PACK(F, type, member, name, at_first, meaning)                            \
    words[COMMON_WORD_##name] = common_word_of_##type(from->member);
    COMMON_OBJECT_ATTRIBUTES(COMMON_PACK, )
#undef COMMON_PACK
}

/* Set attributes from `count` words. Whoever wrote fewer did not know the rest, which
 * stays as it is. */
static inline void common_attributes_unpack(struct common_attributes *to,
                                            const uint64_t *words, uint64_t count)
{
#define COMMON_UNPACK(F, type, member, name, at_first, meaning)                          \
    if (count > COMMON_WORD_##name) {                                                    \
        to->member = common_##type##_of_word(words[COMMON_WORD_##name]);                 \
    }
    COMMON_OBJECT_ATTRIBUTES(COMMON_UNPACK, )
#undef COMMON_UNPACK
}

/* Return whether it says anything about thickness. */
static inline bool common_attributes_are_thick(const struct common_attributes *is)
{
    return is->radius != 0 || is->rest_distance != 0 || is->rest_rings != 0;
}

/* Return whether nothing is else than when the object was made. */
static inline bool common_attributes_are_at_first(const struct common_attributes *is)
{
    bool same = true;
#define COMMON_SAME(F, type, member, name, at_first, meaning)                            \
    same = same && is->member == (at_first);
    COMMON_OBJECT_ATTRIBUTES(COMMON_SAME, )
#undef COMMON_SAME
    return same;
}

#endif
