/* target_decoder.c - messages, against msgpack-c and against themselves.
 *
 * The pre-scan must accept exactly what msgpack-c reads within our limits; what is
 * decoded, encoded and decoded again must be the same.
 */
#include <msgpack.h>
#include <string.h>

#include "codec.h"
#include "fault.h"
#include "fuzz_target.h"

#define BODY_BYTES    8192u
#define REFERENCE_MAX (1u << 20) /* no object within our limits needs more at once */

/* Return whether an object is within our limits of depth and number, `depth` containers
 * deep. msgpack-c bounds the recursion: it reads at most 32 deep. */
static bool is_within(const msgpack_object *object, uint32_t depth, uint32_t *elements)
{
    uint32_t size = 0;
    if (++*elements > PROTO_ELEMENTS_MAX || object->type == MSGPACK_OBJECT_EXT) {
        return false;
    }
    if (object->type == MSGPACK_OBJECT_ARRAY) {
        size = object->via.array.size;
    } else if (object->type == MSGPACK_OBJECT_MAP) {
        size = object->via.map.size;
    }
    if (size > 0 && depth == PROTO_DEPTH_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < size; i++) {
        bool is_map = object->type == MSGPACK_OBJECT_MAP;
        if (is_map && (!is_within(&object->via.map.ptr[i].key, depth + 1, elements) ||
                       !is_within(&object->via.map.ptr[i].val, depth + 1, elements))) {
            return false;
        }
        if (!is_map && !is_within(&object->via.array.ptr[i], depth + 1, elements)) {
            return false;
        }
    }
    return true;
}

/* Return whether msgpack-c reads it all, and what it reads is within our limits. */
static bool reference_accepts(const uint8_t *data, size_t bytes)
{
    msgpack_zone zone;
    msgpack_object root;
    size_t offset = 0;
    uint32_t elements = 0;
    if (bytes == 0 || bytes > PROTO_MESSAGE_BYTES_MAX) {
        return false;
    }
    FUZZ_CHECK(msgpack_zone_init(&zone, MSGPACK_ZONE_CHUNK_SIZE));
    atomic_store(&fault_page->bytes_max, REFERENCE_MAX);
    bool accepts = msgpack_unpack((const char *)data, bytes, &offset, &zone, &root) ==
                       MSGPACK_UNPACK_SUCCESS &&
                   offset == bytes && is_within(&root, 0, &elements);
    atomic_store(&fault_page->bytes_max, 0);
    msgpack_zone_destroy(&zone);
    return accepts;
}

static bool is_same_field(const struct proto_field *field, const char *a, const char *b)
{
    a += field->offset;
    b += field->offset;
    switch (field->type) {
    case PROTO_TYPE_u32:
        return memcmp(a, b, sizeof(uint32_t)) == 0;
    case PROTO_TYPE_u64:
        return memcmp(a, b, sizeof(uint64_t)) == 0;
    case PROTO_TYPE_f64: { /* -0 may come back as 0, which is left out */
        double x;
        double y;
        memcpy(&x, a, sizeof x);
        memcpy(&y, b, sizeof y);
        return x == y || (x != x && y != y);
    }
    case PROTO_TYPE_bool:
        return memcmp(a, b, sizeof(bool)) == 0;
    case PROTO_TYPE_str:
        return strcmp(a, b) == 0;
    }
    return false;
}

static int encode(struct proto_encoder *encoder, const struct proto_envelope *envelope,
                  int method, const void *body)
{
    if (envelope->kind == PROTO_RESPONSE) {
        return envelope->failed
                   ? proto_encode_error(encoder, envelope->id, &envelope->error)
                   : proto_encode_result(encoder, envelope->id, method, body);
    }
    return envelope->kind == PROTO_REQUEST
               ? proto_encode_request(encoder, envelope->id, method, body)
               : proto_encode_notification(encoder, method, body);
}

/* Encode what was decoded, decode that, and compare. */
static void check_round_trip(const struct proto_envelope *envelope, int method,
                             const struct proto_fields *fields, const char *body)
{
    static struct proto_encoder encoder;
    static char again[BODY_BYTES];
    struct proto_decoder *decoder = proto_decoder_new();
    struct proto_envelope second;
    struct proto_error error;
    FUZZ_CHECK(decoder != NULL);
    FUZZ_CHECK(encode(&encoder, envelope, method, body) == 0);
    FUZZ_CHECK(proto_decode(decoder, encoder.data, encoder.bytes, &second, &error) == 0);
    FUZZ_CHECK(second.kind == envelope->kind && second.id == envelope->id &&
               second.failed == envelope->failed);
    if (envelope->failed) {
        FUZZ_CHECK(second.error.code == envelope->error.code &&
                   second.error.fatal == envelope->error.fatal &&
                   strcmp(second.error.text, envelope->error.text) == 0);
    } else {
        FUZZ_CHECK(envelope->kind == PROTO_RESPONSE || second.method == method);
        FUZZ_CHECK(proto_decode_body(&second, fields, again, &error) == 0);
        for (uint32_t i = 0; i < fields->count; i++) {
            FUZZ_CHECK(is_same_field(&fields->items[i], body, again));
        }
    }
    proto_decoder_free(decoder);
}

/* A message that was decoded: its body, as of each method for an answer, which does not
 * say whose it is. */
static void check_body(const struct proto_envelope *envelope, uint8_t choice)
{
    static char body[BODY_BYTES];
    struct proto_error error;
    int method =
        envelope->kind == PROTO_RESPONSE ? choice % PROTO_METHOD_COUNT : envelope->method;
    if (envelope->failed) {
        check_round_trip(envelope, method, NULL, NULL);
        return;
    }
    if (method < 0) {
        return;
    }
    const struct proto_fields *fields = envelope->kind == PROTO_RESPONSE
                                            ? &proto_messages[method].result
                                            : &proto_messages[method].request;
    FUZZ_CHECK(fields->struct_bytes <= BODY_BYTES);
    int status = proto_decode_body(envelope, fields, body, &error);
    FUZZ_CHECK(status == 0 || status == PCCD_E_BADMSG);
    if (status == 0) {
        check_round_trip(envelope, method, fields, body);
    }
}

/* The first byte chooses whose answer an answer is. */
void fuzz_decoder(const uint8_t *data, size_t bytes)
{
    struct fuzz_input input = {data, bytes};
    struct proto_envelope envelope;
    struct proto_error error;
    uint8_t choice = fuzz_take_u8(&input);
    bool accepted = proto_prescan(input.at, input.left, &error) == 0;
    struct proto_decoder *decoder = proto_decoder_new();
    int status = PCCD_E_NOMEM;
    if (decoder != NULL) {
        status = proto_decode(decoder, input.at, input.left, &envelope, &error);
    }
    fuzz_scarcity_pause();
    FUZZ_CHECK(accepted == reference_accepts(input.at, input.left));
    FUZZ_CHECK(status == 0 || status == PCCD_E_BADMSG ||
               (status == PCCD_E_NOMEM && fuzz_scarcity_hits() > 0));
    FUZZ_CHECK(accepted || status != 0);
    if (status == 0) {
        check_body(&envelope, choice);
    }
    proto_decoder_free(decoder);
}
