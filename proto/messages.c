/* messages.c - the manifest as tables. */
#include "messages.h"

#include <string.h>

#include "pccd_trace.h"

/* A field list of the manifest calls F(type, name, need, text) and does not say whose
 * list it is. So F is passed as two parts: ENTRY(struct), which stands before each field,
 * and FIELD, which takes the arguments. Together they are one initialiser; the null
 * pointer is never followed, this is offsetof() cut in two. */
/* clang-format off */
#define ENTRY(struct_name) {.offset = (size_t) & ((const struct struct_name *)0)
#define FIELD(type_, name_, need_, text_)                                                \
    ->name_, .name = #name_, .name_bytes = sizeof(#name_) - 1, .text = text_,            \
    .type = PROTO_TYPE_##type_, .need = PROTO_NEED_##need_},

#define REQUEST_TABLE(ID, name, since, flags, text)                                      \
    static const struct proto_field ID##_request[] = {                                   \
        PROTO_##ID##_REQUEST(ENTRY(proto_##ID##_request) FIELD)};
#define RESULT_TABLE(ID, name, since, flags, text)                                       \
    static const struct proto_field ID##_result[] = {                                    \
        PROTO_##ID##_RESULT(ENTRY(proto_##ID##_result) FIELD)};

PROTO_METHODS(REQUEST_TABLE)
PROTO_METHODS(RESULT_TABLE)
PROTO_NOTIFICATIONS(REQUEST_TABLE)

#define COUNT(table) ((uint32_t)(sizeof table / sizeof((table)[0])))
#define FIELDS(ID, part)                                                                 \
    {ID##_##part, COUNT(ID##_##part), sizeof(struct proto_##ID##_##part)}

#define METHOD(ID, name, since, flags, text)                                             \
    [PROTO_METHOD_##ID] = {#ID, name, sizeof name - 1, text, since, flags,              \
                           FIELDS(ID, request), FIELDS(ID, result)},
#define NOTIFICATION(ID, name, since, flags, text)                                       \
    [PROTO_NOTE_##ID] = {#ID, name, sizeof name - 1, text, since, flags,                \
                         FIELDS(ID, request), {NULL, 0, 0}},

const struct proto_message_info proto_messages[PROTO_MESSAGE_COUNT] = {
    PROTO_METHODS(METHOD) PROTO_NOTIFICATIONS(NOTIFICATION)};
/* clang-format on */

#define IS_ANSWER(ID)                                                                    \
    _Static_assert(sizeof(struct proto_##ID##_result) == sizeof(struct proto_answer) &&  \
                       offsetof(struct proto_##ID##_result, start_inside) ==             \
                           offsetof(struct proto_answer, start_inside),                  \
                   "an answer")
IS_ANSWER(FRAME_SUBMIT);
IS_ANSWER(FRAME_FETCH);
IS_ANSWER(SCENE_NEAR);
IS_ANSWER(NEAR_FETCH);

/* The value of a field of that name; 0: the result has none. */
static uint64_t number_in(const struct proto_fields *fields, const void *result,
                          const char *name)
{
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        const unsigned char *at = (const unsigned char *)result + field->offset;
        uint64_t wide = 0;
        uint32_t narrow = 0;
        if (strcmp(field->name, name) != 0) {
            continue;
        }
        if (field->type == PROTO_TYPE_u64) {
            memcpy(&wide, at, sizeof wide);
            return wide;
        }
        memcpy(&narrow, at, sizeof narrow);
        return narrow;
    }
    return 0;
}

struct proto_page proto_page_of(int method, const void *result)
{
    const struct proto_message_info *info = &proto_messages[method];
    uint32_t record_bytes = info->flags >> 16;
    return (struct proto_page){
        .offset = number_in(&info->result, result, "offset"),
        .count = number_in(&info->result, result, "count"),
        .release = number_in(&info->result, result, "release"),
        .record_bytes = record_bytes != 0
                            ? record_bytes
                            : (uint32_t)number_in(&info->result, result, "record_bytes")};
}
