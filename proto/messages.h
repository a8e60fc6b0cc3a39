/* messages.h - every message of the protocol as a C struct, generated from
 * messages.def.
 */
#ifndef PROTO_MESSAGES_H
#define PROTO_MESSAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "messages.def"
#include "numbers.h"
#include "object_attributes.h"
#include "pccd_types.h"
#include "proto_limits.h"

#define PROTO_F_BEFORE_HELLO       1u
#define PROTO_F_COMPUTE            2u
#define PROTO_F_REPEAT             4u
#define PROTO_F_HAS_PAGE           8u
#define PROTO_F_PAGE(record_bytes) (PROTO_F_HAS_PAGE | (uint32_t)(record_bytes) << 16)

/* PROTO_METHOD_HELLO, ... then PROTO_NOTE_GOAWAY, ...: one numbering for both. */
enum proto_method {
#define PROTO_ENUM(ID, name, since, flags, text) PROTO_METHOD_##ID,
    PROTO_METHODS(PROTO_ENUM)
#undef PROTO_ENUM
        PROTO_METHOD_COUNT,
#define PROTO_ENUM(ID, name, since, flags, text) PROTO_NOTE_##ID,
    PROTO_NOTE_FIRST_ = PROTO_METHOD_COUNT - 1,
    PROTO_NOTIFICATIONS(PROTO_ENUM)
#undef PROTO_ENUM
        PROTO_MESSAGE_COUNT
};

enum proto_type {
    PROTO_TYPE_u32,
    PROTO_TYPE_u64,
    PROTO_TYPE_f64,
    PROTO_TYPE_bool,
    PROTO_TYPE_str
};
enum proto_need { PROTO_NEED_REQ, PROTO_NEED_OPT };

#define PROTO_CTYPE_u32(name)  uint32_t name
#define PROTO_CTYPE_u64(name)  uint64_t name
#define PROTO_CTYPE_f64(name)  double name
#define PROTO_CTYPE_bool(name) bool name
#define PROTO_CTYPE_str(name)  char name[PROTO_STR_MAX + 1]
/* The name that `bool` has become in a list that another one hands on. */
#define PROTO_CTYPE__Bool                    PROTO_CTYPE_bool
#define PROTO_TYPE__Bool                     PROTO_TYPE_bool
#define PROTO_MEMBER(type, name, need, text) PROTO_CTYPE_##type(name);

#define PROTO_STRUCTS(ID, name, since, flags, text)                                      \
    struct proto_##ID##_request {                                                        \
        PROTO_##ID##_REQUEST(PROTO_MEMBER)                                               \
    };                                                                                   \
    struct proto_##ID##_result {                                                         \
        PROTO_##ID##_RESULT(PROTO_MEMBER)                                                \
    };
PROTO_METHODS(PROTO_STRUCTS)
#undef PROTO_STRUCTS

#define PROTO_STRUCTS(ID, name, since, flags, text)                                      \
    struct proto_##ID##_request {                                                        \
        PROTO_##ID##_REQUEST(PROTO_MEMBER)                                               \
    };
PROTO_NOTIFICATIONS(PROTO_STRUCTS)
#undef PROTO_STRUCTS

/* The result of frame.submit, frame.fetch, scene.near and near.fetch: these four have the
 * same members at the same places. */
struct proto_answer {
    PROTO_ANSWER(PROTO_MEMBER, PROTO_OF_STEP)
};

struct proto_field {
    const char *name;
    size_t name_bytes;
    const char *text;
    enum proto_type type;
    enum proto_need need;
    size_t offset;
};

struct proto_fields {
    const struct proto_field *items;
    uint32_t count;
    size_t struct_bytes;
};

struct proto_message_info {
    const char *id;   /* "FRAME_SUBMIT" */
    const char *name; /* "frame.submit" */
    size_t name_bytes;
    const char *text;
    uint32_t since;
    uint32_t flags;
    struct proto_fields request;
    struct proto_fields result; /* count = 0 for notifications */
};

/* The page of records that an answer brings, in the result region. */
struct proto_page {
    uint64_t offset;
    uint64_t count;
    uint64_t release; /* value of result_head that releases it */
    uint32_t record_bytes;
};

/* Return the page of a result of a method with PROTO_F_PAGE. [any] */
struct proto_page proto_page_of(int method, const void *result);

/* Indexed by enum proto_method, PROTO_MESSAGE_COUNT entries. [any] */
extern const struct proto_message_info proto_messages[PROTO_MESSAGE_COUNT];

#endif
