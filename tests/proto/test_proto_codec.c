/* test_proto_codec.c - what is encoded is what is decoded. */
#include "cases.h"

#include <float.h>

#include "codec.h"
#include "prng.h"

#define ROUNDS 200

/* Large enough for the struct of any message. */
union any_body {
    uint64_t align;
    char bytes[1024];
};

struct fixture {
    struct proto_decoder *decoder;
    struct proto_encoder encoder;
    struct prng random;
};

static int set_up(void **state)
{
    static struct fixture fixture;
    fixture.decoder = proto_decoder_new();
    fixture.random.state = prng_seed();
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)fixture.random.state);
    *state = &fixture;
    return fixture.decoder == NULL;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    proto_decoder_free(fixture->decoder);
    return 0;
}

/* Return a number of any magnitude, often one of the ends: MessagePack has a form for
 * each width. */
static uint64_t random_magnitude(struct prng *random)
{
    uint64_t value = prng_next(random) >> prng_below(random, 64);
    uint64_t which = prng_below(random, 8);
    return which == 0 ? 0 : which == 1 ? UINT64_MAX : value;
}

/* 0 .. PROTO_STR_MAX bytes of UTF-8 with sequences of every length. */
static void random_text(struct prng *random, char *text)
{
    static const char *const pieces[] = {"a",
                                         "~",
                                         "\x7f",
                                         "\xc2\x80",
                                         "\xe0\xa0\x80",
                                         "\xed\x9f\xbf",
                                         "\xf0\x90\x80\x80",
                                         "\xf4\x8f\xbf\xbf"};
    size_t wanted = prng_below(random, PROTO_STR_MAX + 1), bytes = 0;
    for (;;) {
        const char *piece = pieces[prng_below(random, 8)];
        if (bytes + strlen(piece) > wanted) {
            break;
        }
        memcpy(text + bytes, piece, strlen(piece) + 1);
        bytes += strlen(piece);
    }
    while (bytes < wanted) {
        text[bytes++] = 'z';
    }
    text[bytes] = '\0';
}

static double random_double(struct prng *random)
{
    static const double corners[] = {0.0,      1e-12,        1.0,      DBL_MAX,
                                     -DBL_MAX, DBL_TRUE_MIN, INFINITY, -1e18};
    if (prng_below(random, 2) == 0) {
        return corners[prng_below(random, 8)];
    }
    return ldexp((double)prng_next(random), (int)prng_below(random, 200) - 100);
}

static void random_body(struct prng *random, const struct proto_fields *fields,
                        char *body)
{
    memset(body, 0, fields->struct_bytes);
    for (uint32_t i = 0; i < fields->count; i++) {
        char *member = body + fields->items[i].offset;
        switch (fields->items[i].type) {
        case PROTO_TYPE_u32:
            *(uint32_t *)member = (uint32_t)random_magnitude(random);
            break;
        case PROTO_TYPE_u64:
            *(uint64_t *)member = random_magnitude(random);
            break;
        case PROTO_TYPE_f64:
            *(double *)member = random_double(random);
            break;
        case PROTO_TYPE_bool:
            *(bool *)member = prng_below(random, 2) == 1;
            break;
        case PROTO_TYPE_str:
            random_text(random, member);
            break;
        }
    }
}

/* Field by field, because a string's bytes after its NUL and padding mean nothing. */
static void assert_same_body(const struct proto_fields *fields, const char *a,
                             const char *b)
{
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        const char *in = a + field->offset, *out = b + field->offset;
        switch (field->type) {
        case PROTO_TYPE_u32:
            assert_int_equal(*(const uint32_t *)in, *(const uint32_t *)out);
            break;
        case PROTO_TYPE_u64:
        case PROTO_TYPE_f64:
            assert_memory_equal(in, out, 8);
            break;
        case PROTO_TYPE_bool:
            assert_int_equal(*(const bool *)in, *(const bool *)out);
            break;
        case PROTO_TYPE_str:
            assert_string_equal(in, out);
            break;
        }
    }
}

/* Decode what the encoder holds; the message's bytes end where the allocation ends. */
static void decode(struct fixture *fixture, struct proto_envelope *envelope, void **copy)
{
    struct proto_error error;
    *copy = malloc(fixture->encoder.bytes);
    assert_non_null(*copy);
    memcpy(*copy, fixture->encoder.data, fixture->encoder.bytes);
    assert_ok(
        proto_decode(fixture->decoder, *copy, fixture->encoder.bytes, envelope, &error));
}

static void decode_same(const struct proto_envelope *envelope,
                        const struct proto_fields *fields, const char *sent)
{
    union any_body got;
    struct proto_error error;
    memset(&got, 0xa5, sizeof got);
    assert_int_equal(proto_decode_body(envelope, fields, got.bytes, &error), 0);
    assert_same_body(fields, sent, got.bytes);
}

/* Send random bodies of a message as `kind`, and compare what comes. */
static void send_and_compare(struct fixture *fixture, int kind, int method)
{
    const struct proto_fields *fields = kind == PROTO_RESPONSE
                                            ? &proto_messages[method].result
                                            : &proto_messages[method].request;
    for (int round = 0; round < ROUNDS; round++) {
        union any_body sent;
        struct proto_envelope envelope;
        void *copy;
        uint32_t id =
            kind == PROTO_NOTIFICATION ? 0 : (uint32_t)random_magnitude(&fixture->random);
        assert_true(fields->struct_bytes <= sizeof sent);
        random_body(&fixture->random, fields, sent.bytes);
        assert_int_equal(
            kind == PROTO_REQUEST
                ? proto_encode_request(&fixture->encoder, id, method, &sent)
            : kind == PROTO_RESPONSE
                ? proto_encode_result(&fixture->encoder, id, method, &sent)
                : proto_encode_notification(&fixture->encoder, method, &sent),
            0);
        decode(fixture, &envelope, &copy);
        assert_int_equal(envelope.kind, kind);
        assert_int_equal(envelope.id, id);
        if (kind != PROTO_NOTIFICATION) {
            assert_false(envelope.failed);
        }
        if (kind != PROTO_RESPONSE) {
            assert_int_equal(envelope.method, method);
        }
        decode_same(&envelope, fields, sent.bytes);
        free(copy);
    }
}

/* If this failed, a request would arrive with other values than it was sent with. */
CASE(request__comes_back_with_the_same_fields)
{
    for (int method = 0; method < PROTO_METHOD_COUNT; method++) {
        send_and_compare(*state, PROTO_REQUEST, method);
    }
}

/* If this failed, an answer would arrive with other values than it was sent with. */
CASE(result__comes_back_with_the_same_fields)
{
    for (int method = 0; method < PROTO_METHOD_COUNT; method++) {
        send_and_compare(*state, PROTO_RESPONSE, method);
    }
}

/* If this failed, a goaway would not say why. */
CASE(notification__comes_back_with_the_same_fields)
{
    for (int note = PROTO_METHOD_COUNT; note < PROTO_MESSAGE_COUNT; note++) {
        send_and_compare(*state, PROTO_NOTIFICATION, note);
    }
}

/* If this failed, a client would get another error than the daemon sent. */
CASE(error__comes_back_with_code_text_and_fatal)
{
    struct fixture *fixture = *state;
    static const int codes[] = {
#define CODE(name, value, text) value,
        PCCD_STATUS_LIST(CODE)
#undef CODE
            INT32_MIN};
    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++) {
        struct proto_error sent;
        struct proto_envelope envelope;
        void *copy;
        if (codes[i] == PCCD_OK) {
            continue;
        }
        sent.code = codes[i];
        sent.fatal = prng_below(&fixture->random, 2) == 1;
        random_text(&fixture->random, sent.text);
        assert_int_equal(proto_encode_error(&fixture->encoder, 77, &sent), 0);
        decode(fixture, &envelope, &copy);
        assert_int_equal(envelope.kind, PROTO_RESPONSE);
        assert_int_equal(envelope.id, 77);
        assert_true(envelope.failed);
        assert_null(envelope.body);
        assert_int_equal(envelope.error.code, sent.code);
        assert_int_equal(envelope.error.fatal, sent.fatal);
        assert_string_equal(envelope.error.text, sent.text);
        free(copy);
    }
}

/* If this failed, a failed answer could be read as one full of zeros. */
CASE(error__has_no_fields)
{
    struct fixture *fixture = *state;
    struct proto_error sent = {PCCD_E_BUSY, false, "later"}, error;
    struct proto_envelope envelope;
    struct proto_PING_result result = {1, 2};
    void *copy;
    assert_int_equal(proto_encode_error(&fixture->encoder, 1, &sent), 0);
    decode(fixture, &envelope, &copy);
    assert_int_equal(proto_decode_body(&envelope,
                                       &proto_messages[PROTO_METHOD_PING].result, &result,
                                       &error),
                     PCCD_E_BADMSG);
    assert_int_equal(result.token, 0);
    free(copy);
}

/* If this failed, messages would carry fields that say nothing, or drop some that do. */
CASE(optional__is_left_out_only_when_zero)
{
    struct fixture *fixture = *state;
    struct proto_FRAME_SUBMIT_request request = {.scene = 0, .segments = 0};
    assert_ok(
        proto_encode_request(&fixture->encoder, 1, PROTO_METHOD_FRAME_SUBMIT, &request));
    size_t bare = fixture->encoder.bytes;
    /* [0, 1, "frame.submit", {"scene": 0, "segments": 0}] by hand. */
    static const uint8_t expected[] = "\x94\x00\x01\xac"
                                      "frame.submit"
                                      "\x82\xa5scene\x00\xa8segments";
    assert_int_equal(bare, sizeof expected); /* the string's NUL is the last 0 */
    assert_memory_equal(fixture->encoder.data, expected, sizeof expected);

    request.tolerance = DBL_TRUE_MIN;
    assert_ok(
        proto_encode_request(&fixture->encoder, 1, PROTO_METHOD_FRAME_SUBMIT, &request));
    assert_int_equal(fixture->encoder.bytes, bare + 10 + 9); /* its name and a double */
}

/* If this failed, a file name in Latin-1 would make the peer refuse the whole message. */
CASE(text__that_is_not_utf8_is_cleaned)
{
    static const char *const cases[][2] = {
        {"caf\xe9", "caf?"},      {"\xc0\x80", "??"},
        {"\xed\xa0\x80", "???"},  {"\xf4\x90\x80\x80", "????"},
        {"\xe2\x82", "??"},       {"\xff", "?"},
        {"\xc3\xa9", "\xc3\xa9"}, {"\x80\xc3\xa9", "?\xc3\xa9"}};
    struct fixture *fixture = *state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct proto_error sent = {PCCD_E_INVAL, false, ""};
        struct proto_envelope envelope;
        void *copy;
        strcpy(sent.text, cases[i][0]);
        assert_int_equal(proto_encode_error(&fixture->encoder, 1, &sent), 0);
        decode(fixture, &envelope, &copy);
        assert_string_equal(envelope.error.text, cases[i][1]);
        free(copy);
    }
}

/* If this failed, an error text longer than a field would overflow or be refused. */
CASE(error_set__cuts_the_text)
{
    struct fixture *fixture = *state;
    struct proto_error error = {0, true, ""};
    struct proto_envelope envelope;
    char longer[2 * PROTO_STR_MAX];
    void *copy;
    memset(longer, 'x', sizeof longer);
    memcpy(longer + PROTO_STR_MAX - 1, "\xc3\xa9", 2); /* cut in two */
    longer[sizeof longer - 1] = '\0';
    assert_int_equal(proto_error_set(&error, PCCD_E_INVAL, "%s", longer), PCCD_E_INVAL);
    assert_int_equal(strlen(error.text), PROTO_STR_MAX);
    assert_int_equal(error.code, PCCD_E_INVAL);
    assert_false(error.fatal);
    assert_int_equal(proto_encode_error(&fixture->encoder, 1, &error), 0);
    decode(fixture, &envelope, &copy);
    assert_int_equal(envelope.error.text[PROTO_STR_MAX - 1], '?');
    free(copy);
}

/* If this failed, the example of PROTOCOL.md would mislead who writes a client. */
CASE(example__of_the_document_is_what_is_sent)
{
    static const uint8_t request[] = {0x94, 0x00, 0x07, 0xa4, 0x70, 0x69, 0x6e, 0x67,
                                      0x81, 0xa5, 0x74, 0x6f, 0x6b, 0x65, 0x6e, 0x2a};
    static const uint8_t result[] = {0x94, 0x01, 0x07, 0xc0, 0x82, 0xa5, 0x74, 0x6f, 0x6b,
                                     0x65, 0x6e, 0x2a, 0xa9, 0x75, 0x70, 0x74, 0x69, 0x6d,
                                     0x65, 0x5f, 0x6e, 0x73, 0xcd, 0x30, 0x39};
    struct fixture *fixture = *state;
    struct proto_encoder *encoder = &fixture->encoder;
    struct proto_PING_request ping = {.token = 42};
    struct proto_PING_result pong = {.token = 42, .uptime_ns = 12345};
    assert_int_equal(proto_encode_request(encoder, 7, PROTO_METHOD_PING, &ping), 0);
    assert_int_equal(encoder->bytes, sizeof request);
    assert_memory_equal(encoder->data, request, sizeof request);
    assert_int_equal(proto_encode_result(encoder, 7, PROTO_METHOD_PING, &pong), 0);
    assert_int_equal(encoder->bytes, sizeof result);
    assert_memory_equal(encoder->data, result, sizeof result);
}

/* If this failed, a method could not be called by its name. */
CASE(method__is_found_by_its_whole_name)
{
    for (int i = 0; i < PROTO_MESSAGE_COUNT; i++) {
        const char *name = proto_messages[i].name;
        assert_non_null(name);
        assert_int_equal(proto_method_by_name(name, strlen(name)), i);
        assert_int_equal(proto_method_by_name(name, strlen(name) - 1), -1);
    }
    assert_int_equal(proto_method_by_name("", 0), -1);
    assert_int_equal(proto_method_by_name("helloo", 6), -1);
}

/* If this failed, tools would print a wrong name for a status. */
CASE(status__has_a_name_and_a_text)
{
#define CHECK(name, value, text)                                                         \
    assert_string_equal(proto_status_name(value), #name);                                \
    assert_string_equal(proto_status_text(value), text);
    PCCD_STATUS_LIST(CHECK)
#undef CHECK
    assert_non_null(proto_status_name(1234));
    assert_non_null(proto_status_text(INT32_MIN));
}

/* If this failed, the decoder's bit set of seen fields would be too small, or a
 * message with all its fields longer than what the prescan lets through. */
CASE(manifest__fits_the_decoder)
{
    for (int i = 0; i < PROTO_MESSAGE_COUNT; i++) {
        const struct proto_message_info *message = &proto_messages[i];
        assert_in_range(message->request.count, 1, 96);
        assert_in_range(message->result.count, i < PROTO_METHOD_COUNT ? 1 : 0, 96);
        assert_in_range(message->since, PROTO_VERSION_MIN, PROTO_VERSION_MAX);
        for (uint32_t f = 0; f < message->request.count; f++) {
            for (uint32_t g = 0; g < f; g++) {
                assert_string_not_equal(message->request.items[f].name,
                                        message->request.items[g].name);
            }
        }
    }
}

CASES_WITH(set_up, tear_down);
