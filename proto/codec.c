/* codec.c - MessagePack-RPC messages to structs of messages.h; names and errors. */
#include <assert.h>
#include <msgpack.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "utf8.h"

#define FIELDS_MAX 96u /* of one message */

/* ---- names and errors ---------------------------------------------------------------
 */

struct status_entry {
    int value;
    const char *name;
    const char *text;
};

static const struct status_entry statuses[] = {
#define STATUS_ENTRY(name, value, text) {value, #name, text},
    PCCD_STATUS_LIST(STATUS_ENTRY)
#undef STATUS_ENTRY
};

static const struct status_entry *find_status(int status)
{
    static const struct status_entry unknown = {0, "E_UNKNOWN", "unknown status"};
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; i++) {
        if (statuses[i].value == status) {
            return &statuses[i];
        }
    }
    return &unknown;
}

const char *proto_status_name(int status)
{
    return find_status(status)->name;
}

const char *proto_status_text(int status)
{
    return find_status(status)->text;
}

int proto_error_set(struct proto_error *error, int code, const char *format, ...)
{
    va_list arguments;
    error->code = code;
    error->fatal = false;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return code;
}

int proto_method_by_name(const char *name, size_t bytes)
{
    for (int i = 0; i < PROTO_MESSAGE_COUNT; i++) {
        if (proto_messages[i].name_bytes == bytes &&
            memcmp(proto_messages[i].name, name, bytes) == 0) {
            return i;
        }
    }
    return -1;
}

/* ---- the decoder --------------------------------------------------------------------
 */

struct proto_decoder {
    msgpack_zone *zone; /* cleared, not freed, between messages */
};

struct proto_decoder *proto_decoder_new(void)
{
    struct proto_decoder *decoder = malloc(sizeof *decoder);
    if (decoder == NULL) {
        return NULL;
    }
    decoder->zone = msgpack_zone_new(MSGPACK_ZONE_CHUNK_SIZE);
    if (decoder->zone == NULL) {
        free(decoder);
        return NULL;
    }
    return decoder;
}

void proto_decoder_free(struct proto_decoder *decoder)
{
    if (decoder == NULL) {
        return;
    }
    msgpack_zone_free(decoder->zone);
    free(decoder);
}

/* ---- scalars ------------------------------------------------------------------------
 */

static bool read_unsigned(const msgpack_object *object, uint64_t max, uint64_t *value)
{
    if (object->type != MSGPACK_OBJECT_POSITIVE_INTEGER || object->via.u64 > max) {
        return false;
    }
    *value = object->via.u64;
    return true;
}

static bool read_double(const msgpack_object *object, double *value)
{
    switch (object->type) {
    case MSGPACK_OBJECT_FLOAT32:
    case MSGPACK_OBJECT_FLOAT64:
        *value = object->via.f64;
        return true;
    case MSGPACK_OBJECT_POSITIVE_INTEGER:
        *value = (double)object->via.u64;
        return true;
    case MSGPACK_OBJECT_NEGATIVE_INTEGER:
        *value = (double)object->via.i64;
        return true;
    default:
        return false;
    }
}

/* Copy a string of at most PROTO_STR_MAX bytes of UTF-8 without NUL, and terminate it. */
static bool read_text(const msgpack_object *object, char *text)
{
    if (object->type != MSGPACK_OBJECT_STR || object->via.str.size > PROTO_STR_MAX) {
        return false;
    }
    size_t bytes = object->via.str.size;
    const uint8_t *from = (const uint8_t *)object->via.str.ptr;
    for (size_t at = 0; at < bytes;) {
        size_t step = proto_utf8_sequence(from + at, bytes - at);
        if (step == 0) {
            return false;
        }
        at += step;
    }
    if (bytes > 0) {
        memcpy(text, from, bytes);
    }
    text[bytes] = '\0';
    return true;
}

/* ---- the envelope -------------------------------------------------------------------
 */

/* A name for an error text: what is printable of it, cut. */
static void quote(const char *name, size_t bytes, char quoted[64])
{
    size_t count = bytes < 63 ? bytes : 63;
    for (size_t i = 0; i < count; i++) {
        quoted[i] = name[i] > ' ' && name[i] < 0x7f && name[i] != '"' ? name[i] : '?';
    }
    quoted[count] = '\0';
}

/* Method and params of a request or notification. */
static int decode_call(const msgpack_object *method, const msgpack_object *params,
                       struct proto_envelope *envelope, struct proto_error *error)
{
    char quoted[64];
    if (method->type != MSGPACK_OBJECT_STR) {
        return proto_error_set(error, PCCD_E_BADMSG, "the method is not a string");
    }
    if (params->type != MSGPACK_OBJECT_MAP) {
        return proto_error_set(error, PCCD_E_BADMSG, "the params are not a map");
    }
    envelope->body = params;
    envelope->method = proto_method_by_name(method->via.str.ptr, method->via.str.size);
    bool is_note = envelope->method >= PROTO_METHOD_COUNT;
    if (envelope->method >= 0 && is_note == (envelope->kind == PROTO_NOTIFICATION)) {
        return 0;
    }
    envelope->method = -1;
    quote(method->via.str.ptr, method->via.str.size, quoted);
    proto_error_set(&envelope->error, PCCD_E_NOMETHOD, "there is no %s \"%s\"",
                    envelope->kind == PROTO_REQUEST ? "method" : "notification", quoted);
    return 0;
}

/* [code, name, text, fatal], or longer from a newer peer. */
static int decode_error(const msgpack_object *object, struct proto_envelope *envelope,
                        struct proto_error *error)
{
    const msgpack_object *items = object->via.array.ptr;
    if (object->type != MSGPACK_OBJECT_ARRAY || object->via.array.size < 4) {
        return proto_error_set(error, PCCD_E_BADMSG,
                               "an error is [code, name, text, fatal]");
    }
    if (items[0].type != MSGPACK_OBJECT_NEGATIVE_INTEGER ||
        items[0].via.i64 < INT32_MIN) {
        return proto_error_set(error, PCCD_E_BADMSG, "an error's code is not negative");
    }
    if (items[1].type != MSGPACK_OBJECT_STR ||
        !read_text(&items[2], envelope->error.text) ||
        items[3].type != MSGPACK_OBJECT_BOOLEAN) {
        return proto_error_set(error, PCCD_E_BADMSG,
                               "an error's name, text or fatal has another type");
    }
    envelope->failed = true;
    envelope->error.code = (int32_t)items[0].via.i64;
    envelope->error.fatal = items[3].via.boolean;
    return 0;
}

/* Error and result of a response. */
static int decode_answer(const msgpack_object *failure, const msgpack_object *result,
                         struct proto_envelope *envelope, struct proto_error *error)
{
    envelope->method = -1;
    if (failure->type != MSGPACK_OBJECT_NIL) {
        if (result->type != MSGPACK_OBJECT_NIL) {
            return proto_error_set(error, PCCD_E_BADMSG, "an error and a result");
        }
        return decode_error(failure, envelope, error);
    }
    if (result->type != MSGPACK_OBJECT_MAP) {
        return proto_error_set(error, PCCD_E_BADMSG, "the result is not a map");
    }
    envelope->body = result;
    return 0;
}

static int decode_envelope(const msgpack_object *object, struct proto_envelope *envelope,
                           struct proto_error *error)
{
    const msgpack_object *items = object->via.array.ptr;
    uint64_t kind, id = 0;
    if (object->type != MSGPACK_OBJECT_ARRAY || object->via.array.size < 3 ||
        !read_unsigned(&items[0], PROTO_NOTIFICATION, &kind)) {
        return proto_error_set(error, PCCD_E_BADMSG,
                               "a message is an array that begins with 0, 1 or 2");
    }
    envelope->kind = (enum proto_kind)kind;
    if (object->via.array.size != (envelope->kind == PROTO_NOTIFICATION ? 3u : 4u)) {
        return proto_error_set(error, PCCD_E_BADMSG, "%u items in a message of kind %u",
                               object->via.array.size, (unsigned)kind);
    }
    if (envelope->kind == PROTO_NOTIFICATION) {
        return decode_call(&items[1], &items[2], envelope, error);
    }
    if (!read_unsigned(&items[1], UINT32_MAX, &id)) {
        return proto_error_set(error, PCCD_E_BADMSG, "the message id is not 0 .. 2^32-1");
    }
    envelope->id = (uint32_t)id;
    if (envelope->kind == PROTO_REQUEST) {
        return decode_call(&items[2], &items[3], envelope, error);
    }
    return decode_answer(&items[2], &items[3], envelope, error);
}

int proto_decode(struct proto_decoder *decoder, const void *message, size_t bytes,
                 struct proto_envelope *envelope, struct proto_error *error)
{
    size_t offset = 0;
    memset(envelope, 0, sizeof *envelope);
    int status = proto_prescan(message, bytes, error);
    if (status != 0) {
        return status;
    }

    msgpack_zone_clear(decoder->zone);
    msgpack_object *root = msgpack_zone_malloc(decoder->zone, sizeof *root);
    if (root == NULL) {
        return proto_error_set(error, PCCD_E_NOMEM, "no memory to decode a message");
    }
    switch (msgpack_unpack(message, bytes, &offset, decoder->zone, root)) {
    case MSGPACK_UNPACK_SUCCESS:
        return decode_envelope(root, envelope, error);
    case MSGPACK_UNPACK_NOMEM_ERROR:
        return proto_error_set(error, PCCD_E_NOMEM, "no memory to decode a message");
    default:
        return proto_error_set(error, PCCD_E_BADMSG, "the message is not MessagePack");
    }
}

/* ---- the body -----------------------------------------------------------------------
 */

/* Index of the field named by `key`, looking first where the last one was found plus one:
 * an encoder that keeps the manifest's order costs one comparison a field. -1: unknown.
 */
static int find_field(const struct proto_fields *fields, const msgpack_object_str *key,
                      uint32_t guess)
{
    for (uint32_t i = 0; i < fields->count; i++) {
        uint32_t at = (guess + i) % fields->count;
        const struct proto_field *field = &fields->items[at];
        if (field->name_bytes == key->size &&
            memcmp(field->name, key->ptr, key->size) == 0) {
            return (int)at;
        }
    }
    return -1;
}

/* Returns what the field should have been, or NULL: stored. */
static const char *read_field(const struct proto_field *field,
                              const msgpack_object *value, char *member)
{
    uint64_t number;
    switch (field->type) {
    case PROTO_TYPE_u32:
        if (!read_unsigned(value, UINT32_MAX, &number)) {
            return "an integer 0 .. 2^32-1";
        }
        *(uint32_t *)member = (uint32_t)number;
        return NULL;
    case PROTO_TYPE_u64:
        return read_unsigned(value, UINT64_MAX, (uint64_t *)member)
                   ? NULL
                   : "an integer 0 .. 2^64-1";
    case PROTO_TYPE_f64:
        return read_double(value, (double *)member) ? NULL : "a number";
    case PROTO_TYPE_bool:
        if (value->type != MSGPACK_OBJECT_BOOLEAN) {
            return "true or false";
        }
        *(bool *)member = value->via.boolean;
        return NULL;
    case PROTO_TYPE_str:
        return read_text(value, member) ? NULL : "a string of at most 255 bytes of UTF-8";
    }
    return "of a known type";
}

static int read_fields(const msgpack_object_map *map, const struct proto_fields *fields,
                       char *out, struct proto_error *error)
{
    bool seen[FIELDS_MAX] = {false};
    uint32_t guess = 0;
    for (uint32_t i = 0; i < map->size; i++) {
        const msgpack_object_kv *pair = &map->ptr[i];
        if (pair->key.type != MSGPACK_OBJECT_STR) {
            return proto_error_set(error, PCCD_E_BADMSG,
                                   "a field's name is not a string");
        }
        int found = find_field(fields, &pair->key.via.str, guess);
        if (found < 0) {
            continue;
        }
        const struct proto_field *field = &fields->items[found];
        if (seen[found]) {
            return proto_error_set(error, PCCD_E_BADMSG, "field \"%s\" is given twice",
                                   field->name);
        }
        seen[found] = true;
        guess = (uint32_t)found + 1;
        const char *wanted = read_field(field, &pair->val, out + field->offset);
        if (wanted != NULL) {
            return proto_error_set(error, PCCD_E_BADMSG, "field \"%s\" is not %s",
                                   field->name, wanted);
        }
    }
    for (uint32_t i = 0; i < fields->count; i++) {
        if (fields->items[i].need == PROTO_NEED_REQ && !seen[i]) {
            return proto_error_set(error, PCCD_E_BADMSG, "field \"%s\" is missing",
                                   fields->items[i].name);
        }
    }
    return 0;
}

int proto_decode_body(const struct proto_envelope *envelope,
                      const struct proto_fields *fields, void *out,
                      struct proto_error *error)
{
    const msgpack_object *body = envelope->body;
    assert(fields->count > 0 && fields->count <= FIELDS_MAX);
    memset(out, 0, fields->struct_bytes);
    if (body == NULL) { /* a response that failed has none */
        return proto_error_set(error, PCCD_E_BADMSG, "the message has no fields");
    }
    int status = read_fields(&body->via.map, fields, out, error);
    if (status != 0) {
        memset(out, 0, fields->struct_bytes);
    }
    return status;
}
