/* encode.c - structs of messages.h to MessagePack-RPC messages. */
#include <assert.h>
#include <msgpack.h>
#include <string.h>

#include "codec.h"
#include "utf8.h"

/* msgpack-c's way to a buffer. Nothing is written past the end; the packer's caller sees
 * the refusal as a return value other than 0. */
static int append(void *context, const char *bytes, size_t count)
{
    struct proto_encoder *encoder = context;
    if (count > sizeof encoder->data - encoder->bytes) {
        return -1;
    }
    memcpy(encoder->data + encoder->bytes, bytes, count);
    encoder->bytes += count;
    return 0;
}

static int pack_method(msgpack_packer *packer, int method)
{
    const struct proto_message_info *info = &proto_messages[method];
    return msgpack_pack_str_with_body(packer, info->name, info->name_bytes);
}

/* Pack at most PROTO_STR_MAX bytes of `text`. A byte that is not UTF-8 (of a file name,
 * or of a text that was cut) becomes '?', so that the peer never refuses the message for
 * it. */
static int pack_text(msgpack_packer *packer, const char *text)
{
    uint8_t clean[PROTO_STR_MAX];
    size_t bytes = strnlen(text, PROTO_STR_MAX);
    memcpy(clean, text, bytes);
    for (size_t at = 0; at < bytes;) {
        size_t step = proto_utf8_sequence(clean + at, bytes - at);
        if (step == 0) {
            clean[at] = '?';
            step = 1;
        }
        at += step;
    }
    return msgpack_pack_str_with_body(packer, clean, bytes);
}

/* Whether the field holds what an absent one reads as. */
/* By its bits: a caller may compute so that a subnormal number equals 0. */
static bool is_zero(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits << 1 == 0;
}

static bool is_default(const struct proto_field *field, const char *member)
{
    switch (field->type) {
    case PROTO_TYPE_u32:
        return *(const uint32_t *)member == 0;
    case PROTO_TYPE_u64:
        return *(const uint64_t *)member == 0;
    case PROTO_TYPE_f64:
        return is_zero(*(const double *)member);
    case PROTO_TYPE_bool:
        return !*(const bool *)member;
    case PROTO_TYPE_str:
        return member[0] == '\0';
    }
    return false;
}

static int pack_value(msgpack_packer *packer, const struct proto_field *field,
                      const char *member)
{
    switch (field->type) {
    case PROTO_TYPE_u32:
        return msgpack_pack_uint32(packer, *(const uint32_t *)member);
    case PROTO_TYPE_u64:
        return msgpack_pack_uint64(packer, *(const uint64_t *)member);
    case PROTO_TYPE_f64:
        return msgpack_pack_double(packer, *(const double *)member);
    case PROTO_TYPE_bool:
        return *(const bool *)member ? msgpack_pack_true(packer)
                                     : msgpack_pack_false(packer);
    case PROTO_TYPE_str:
        return pack_text(packer, member);
    }
    return -1;
}

static bool is_left_out(const struct proto_field *field, const char *body)
{
    return field->need == PROTO_NEED_OPT && is_default(field, body + field->offset);
}

static int pack_body(msgpack_packer *packer, const struct proto_fields *fields,
                     const void *body)
{
    size_t count = 0;
    int status = 0;
    for (uint32_t i = 0; i < fields->count; i++) {
        count += is_left_out(&fields->items[i], body) ? 0 : 1;
    }
    status |= msgpack_pack_map(packer, count);
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        if (is_left_out(field, body)) {
            continue;
        }
        status |= msgpack_pack_str_with_body(packer, field->name, field->name_bytes);
        status |= pack_value(packer, field, (const char *)body + field->offset);
    }
    return status;
}

static void begin(struct proto_encoder *encoder, msgpack_packer *packer)
{
    encoder->bytes = 0;
    msgpack_packer_init(packer, encoder, append);
}

int proto_encode_request(struct proto_encoder *encoder, uint32_t id, int method,
                         const void *request)
{
    msgpack_packer packer;
    assert(method >= 0 && method < PROTO_METHOD_COUNT);
    begin(encoder, &packer);
    int status = msgpack_pack_array(&packer, 4);
    status |= msgpack_pack_uint8(&packer, PROTO_REQUEST);
    status |= msgpack_pack_uint32(&packer, id);
    status |= pack_method(&packer, method);
    status |= pack_body(&packer, &proto_messages[method].request, request);
    return status == 0 ? 0 : PCCD_E_LIMIT;
}

int proto_encode_result(struct proto_encoder *encoder, uint32_t id, int method,
                        const void *result)
{
    msgpack_packer packer;
    assert(method >= 0 && method < PROTO_METHOD_COUNT);
    begin(encoder, &packer);
    int status = msgpack_pack_array(&packer, 4);
    status |= msgpack_pack_uint8(&packer, PROTO_RESPONSE);
    status |= msgpack_pack_uint32(&packer, id);
    status |= msgpack_pack_nil(&packer);
    status |= pack_body(&packer, &proto_messages[method].result, result);
    return status == 0 ? 0 : PCCD_E_LIMIT;
}

int proto_encode_error(struct proto_encoder *encoder, uint32_t id,
                       const struct proto_error *error)
{
    msgpack_packer packer;
    const char *name = proto_status_name(error->code);
    assert(error->code < 0);
    begin(encoder, &packer);
    int status = msgpack_pack_array(&packer, 4);
    status |= msgpack_pack_uint8(&packer, PROTO_RESPONSE);
    status |= msgpack_pack_uint32(&packer, id);
    status |= msgpack_pack_array(&packer, 4);
    status |= msgpack_pack_int32(&packer, error->code);
    status |= msgpack_pack_str_with_body(&packer, name, strlen(name));
    status |= pack_text(&packer, error->text);
    status |= error->fatal ? msgpack_pack_true(&packer) : msgpack_pack_false(&packer);
    status |= msgpack_pack_nil(&packer);
    return status == 0 ? 0 : PCCD_E_LIMIT;
}

int proto_encode_notification(struct proto_encoder *encoder, int note, const void *params)
{
    msgpack_packer packer;
    assert(note >= PROTO_METHOD_COUNT && note < PROTO_MESSAGE_COUNT);
    begin(encoder, &packer);
    int status = msgpack_pack_array(&packer, 3);
    status |= msgpack_pack_uint8(&packer, PROTO_NOTIFICATION);
    status |= pack_method(&packer, note);
    status |= pack_body(&packer, &proto_messages[note].request, params);
    return status == 0 ? 0 : PCCD_E_LIMIT;
}
