/* test_proto_malformed.c - messages that a peer in order would never send. */
#include <stdio.h>

#include "fixture.h"

/* The bytes are refused, and the text of the error says `about`. */
static void assert_refused(struct fixture *fixture, const char *about)
{
    int status = decode(fixture, fixture->bytes.data, fixture->bytes.count, 0);
    assert_int_equal(status, PCCD_E_BADMSG);
    assert_int_equal(fixture->error.code, PCCD_E_BADMSG);
    if (strstr(fixture->error.text, about) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", fixture->error.text, about);
    }
}

static void assert_taken(struct fixture *fixture)
{
    int status = decode(fixture, fixture->bytes.data, fixture->bytes.count, 0);
    if (status != 0) {
        fail_msg("refused: %s", fixture->error.text);
    }
}

#define SET(fixture, literal)                                                            \
    do {                                                                                 \
        (fixture)->bytes.count = 0;                                                      \
        put(&(fixture)->bytes, literal, sizeof literal - 1);                             \
    } while (0)

#define REFUSE(literal, about)                                                           \
    do {                                                                                 \
        SET(fixture, literal);                                                           \
        assert_refused(fixture, about);                                                  \
    } while (0)

/* ---- the prescan ------------------------------------------------------------------ */

/* If this failed, five bytes could make msgpack-c allocate gigabytes. */
CASE(prescan__refuses_claims_beyond_the_message)
{
    struct fixture *fixture = *state;
    static const unsigned wide[] = {0xdd, 0xdf, 0xdb, 0xc6}; /* array, map, str, bin 32 */
    static const unsigned middle[] = {0xdc, 0xde, 0xda, 0xc5}; /* 16 */
    for (size_t i = 0; i < 4; i++) {
        for (uint64_t claim = UINT32_MAX; claim > 8; claim /= 3) {
            fixture->bytes.count = 0;
            put_number(&fixture->bytes, wide[i], claim, 4);
            assert_refused(fixture, "claims more");
        }
        fixture->bytes.count = 0;
        put_number(&fixture->bytes, middle[i], 0xffff, 2);
        assert_refused(fixture, "claims more");
    }
    REFUSE("\xc4\xff", "claims more");     /* bin 8 */
    REFUSE("\xd9\xff", "claims more");     /* str 8 */
    REFUSE("\xbf", "claims more");         /* small string */
    REFUSE("\x9f\xc0", "claims more");     /* small array */
    REFUSE("\x88\xc0\xc0", "claims more"); /* small map */
    /* Half of a map's objects are there: each pair needs two. */
    REFUSE("\xde\x00\x02\xc0\xc0", "claims more");
}

/* If this failed, an inner header could claim what only the outer message holds. */
CASE(prescan__refuses_claims_deep_inside)
{
    struct fixture *fixture = *state;
    put_request(&fixture->bytes, 1, "ping");
    put_map(&fixture->bytes, 1);
    put_str(&fixture->bytes, "x");
    put_number(&fixture->bytes, 0xdd, 0x80000000u, 4);
    assert_refused(fixture, "claims more");
}

/* If this failed, a length field cut off by the end of the message would be read past
 * it. */
CASE(prescan__refuses_cut_headers)
{
    struct fixture *fixture = *state;
    static const struct {
        unsigned type;
        int width;
    } headers[] = {{0xc4, 1}, {0xc5, 2}, {0xc6, 4}, {0xca, 4}, {0xcb, 8},
                   {0xcc, 1}, {0xcd, 2}, {0xce, 4}, {0xcf, 8}, {0xd0, 1},
                   {0xd1, 2}, {0xd2, 4}, {0xd3, 8}, {0xd9, 1}, {0xda, 2},
                   {0xdb, 4}, {0xdc, 2}, {0xdd, 4}, {0xde, 2}, {0xdf, 4}};
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
        for (int width = 0; width < headers[i].width; width++) {
            fixture->bytes.count = 0;
            put_number(&fixture->bytes, headers[i].type, 0, width);
            assert_refused(fixture, "claims more");
        }
    }
}

/* If this failed, ext types and the unused 0xc1 would get as far as msgpack-c. */
CASE(prescan__refuses_ext_and_unused_types)
{
    struct fixture *fixture = *state;
    static const unsigned types[] = {0xc1, 0xc7, 0xc8, 0xc9, 0xd4,
                                     0xd5, 0xd6, 0xd7, 0xd8};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        static const uint8_t rest[32] = {0};
        fixture->bytes.count = 0;
        put_array(&fixture->bytes, 2);
        put_byte(&fixture->bytes, types[i]);
        put(&fixture->bytes, rest, sizeof rest);
        assert_refused(fixture, "not allowed");
    }
    REFUSE("\xc9\xff\xff\xff\xff\x01", "not allowed"); /* ext 32 of 4 GiB */
}

/* If this failed, nesting could outgrow the stack of whoever walks the message. */
CASE(prescan__bounds_the_depth)
{
    struct fixture *fixture = *state;
    struct proto_error error;
    fixture->bytes.count = 0;
    for (unsigned i = 0; i < PROTO_DEPTH_MAX; i++) {
        put_array(&fixture->bytes, 1);
    }
    put_byte(&fixture->bytes, 0xc0);
    assert_int_equal(proto_prescan(fixture->bytes.data, fixture->bytes.count, &error), 0);

    fixture->bytes.count = 0;
    for (unsigned i = 0; i < PROTO_DEPTH_MAX + 1; i++) {
        put_array(&fixture->bytes, 1);
    }
    put_byte(&fixture->bytes, 0xc0);
    assert_refused(fixture, "nested deeper");

    /* An empty container opens no level. */
    fixture->bytes.count = 0;
    for (unsigned i = 0; i < PROTO_DEPTH_MAX; i++) {
        put_array(&fixture->bytes, 1);
    }
    put_array(&fixture->bytes, 0);
    assert_int_equal(proto_prescan(fixture->bytes.data, fixture->bytes.count, &error), 0);
}

/* If this failed, a message of 64 KiB could cost 1.5 MB of objects. */
CASE(prescan__bounds_the_number_of_objects)
{
    struct fixture *fixture = *state;
    struct proto_error error;
    for (unsigned extra = 0; extra < 2; extra++) {
        fixture->bytes.count = 0;
        put_number(&fixture->bytes, 0xdc, PROTO_ELEMENTS_MAX - 1 + extra, 2);
        for (unsigned i = 0; i < PROTO_ELEMENTS_MAX - 1 + extra; i++) {
            put_byte(&fixture->bytes, 0xc0);
        }
        if (extra == 0) {
            assert_ok(proto_prescan(fixture->bytes.data, fixture->bytes.count, &error));
        } else {
            assert_refused(fixture, "more than 4096 objects");
        }
    }
}

/* If this failed, what follows a message would be ignored silently. */
CASE(prescan__refuses_empty_and_trailing_bytes)
{
    struct fixture *fixture = *state;
    fixture->bytes.count = 0;
    assert_refused(fixture, "ends at byte 0");
    put_request(&fixture->bytes, 1, "ping");
    put_map(&fixture->bytes, 0);
    assert_taken(fixture);
    put_byte(&fixture->bytes, 0xc0);
    assert_refused(fixture, "1 bytes follow");
}

/* If this failed, a message longer than the limit would be taken where a transport allows
 * it. */
CASE(prescan__bounds_the_bytes)
{
    struct fixture *fixture = *state;
    struct proto_error error;
    static const char zeros[PROTO_MESSAGE_BYTES_MAX];
    for (unsigned extra = 0; extra < 2; extra++) {
        uint64_t body = PROTO_MESSAGE_BYTES_MAX - 5 + extra;
        fixture->bytes.count = 0;
        put_number(&fixture->bytes, 0xc6, body, 4);
        put(&fixture->bytes, zeros, body);
        int status = proto_prescan(fixture->bytes.data, fixture->bytes.count, &error);
        assert_int_equal(status, extra == 0 ? 0 : PCCD_E_BADMSG);
    }
}

/* ---- the envelope ----------------------------------------------------------------- */

/* If this failed, something that is no message would be dispatched. */
CASE(envelope__of_another_shape_is_refused)
{
    struct fixture *fixture = *state;
    REFUSE("\xc0", "an array that begins");                     /* nil */
    REFUSE("\x80", "an array that begins");                     /* {} */
    REFUSE("\x90", "an array that begins");                     /* [] */
    REFUSE("\x92\x00\x01", "an array that begins");             /* [0, 1] */
    REFUSE("\x94\x03\x01\xa4ping\x80", "an array that begins"); /* kind 3 */
    REFUSE("\x94\xff\x01\xa4ping\x80", "an array that begins"); /* kind -1 */
    REFUSE("\x94\xa1"
           "0\x01\xa4ping\x80",
           "an array that begins");                    /* kind "0" */
    REFUSE("\x93\x00\x01\xa4ping", "3 items");         /* a request of 3 */
    REFUSE("\x95\x00\x01\xa4ping\x80\xc0", "5 items"); /* a request of 5 */
    REFUSE("\x94\x02\xa6goaway\x80\xc0", "4 items");   /* a notification of 4 */
}

/* If this failed, an answer could go to another request than the one meant. */
CASE(envelope__id_is_a_u32)
{
    struct fixture *fixture = *state;
    REFUSE("\x94\x00\xff\xa4ping\x80", "message id");  /* -1 */
    REFUSE("\x94\x00\xa1x\xa4ping\x80", "message id"); /* text */
    REFUSE("\x94\x00\xcf\x00\x00\x00\x01\x00\x00\x00\x00\xa4ping\x80",
           "message id");                                             /* 2^32 */
    REFUSE("\x94\x00\xca\x3f\x80\x00\x00\xa4ping\x80", "message id"); /* 1.0 */
    SET(fixture, "\x94\x00\xce\xff\xff\xff\xff\xa4ping\x80");         /* 2^32 - 1 */
    assert_taken(fixture);
    assert_true(fixture->envelope.id == UINT32_MAX);
}

/* If this failed, the daemon could not answer E_NOMETHOD with the name in it. */
CASE(envelope__names_an_unknown_method)
{
    struct fixture *fixture = *state;
    put_request(&fixture->bytes, 9, "no.\x1b[31m\"such");
    put_map(&fixture->bytes, 0);
    assert_taken(fixture);
    assert_int_equal(fixture->envelope.method, -1);
    assert_int_equal(fixture->envelope.id, 9);
    assert_int_equal(fixture->envelope.error.code, PCCD_E_NOMETHOD);
    assert_non_null(strstr(fixture->envelope.error.text, "no.?[31m?such"));

    put_request(&fixture->bytes, 9, "goaway"); /* a notification is no method */
    put_map(&fixture->bytes, 0);
    assert_taken(fixture);
    assert_int_equal(fixture->envelope.method, -1);

    SET(fixture, "\x93\x02\xa4ping\x80"); /* and a method no notification */
    assert_taken(fixture);
    assert_int_equal(fixture->envelope.method, -1);

    put_request(&fixture->bytes, 9, "ping");
    put_array(&fixture->bytes, 0);
    assert_refused(fixture, "params are not a map");
    REFUSE("\x94\x00\x09\xa4ping\xc0", "params are not a map");
    REFUSE("\x94\x00\x01\x07\x80", "method is not a string");
}

/* If this failed, a broken error or result would be taken for an answer. */
CASE(envelope__answer_is_an_error_or_a_result)
{
    struct fixture *fixture = *state;
    REFUSE("\x94\x01\x05\xc0\x90", "result is not a map"); /* a result that is an array */
    REFUSE("\x94\x01\x05\x94\xfb\xa1x\xa1y\xc2\x80", "an error and a result"); /* both */
    REFUSE("\x94\x01\x05\x93\xfb\xa1x\xa1y\xc0",
           "[code, name, text, fatal]");                             /* three items */
    REFUSE("\x94\x01\x05\xa4oops\xc0", "[code, name, text, fatal]"); /* a bare string */
    REFUSE("\x94\x01\x05\x94\x00\xa1x\xa1y\xc2\xc0",
           "not negative"); /* code 0 is success */
    REFUSE("\x94\x01\x05\x94\xd3\xff\xff\xff\xff\x7f\xff\xff\xff\xa1x\xa1y\xc2\xc0",
           "not negative");                                          /* below -2^31 */
    REFUSE("\x94\x01\x05\x94\xfb\x01\xa1y\xc2\xc0", "another type"); /* name 1 */
    REFUSE("\x94\x01\x05\x94\xfb\xa1x\xa2y\x00\xc2\xc0",
           "another type"); /* NUL in the text */
    REFUSE("\x94\x01\x05\x94\xfb\xa1x\xa1y\x00\xc0", "another type"); /* fatal 0 */
    SET(fixture, "\x94\x01\x05\x95\xfb\xa1x\xa1y\xc3\x07\xc0"); /* one item more: newer */
    assert_taken(fixture);
    assert_int_equal(fixture->envelope.error.code, PCCD_E_BADMSG);
    assert_true(fixture->envelope.error.fatal);
}

/* ---- the body --------------------------------------------------------------------- */

/* If this failed, a newer peer could not add a field. */
CASE(body__skips_unknown_fields)
{
    struct fixture *fixture = *state;
    struct proto_PING_request request;
    put_request(&fixture->bytes, 1, "ping");
    put_map(&fixture->bytes, 4);
    put_str(&fixture->bytes, "colour");
    put(&fixture->bytes, "\x92\x01\x81\xa1k\xc0", 6);
    put_str(&fixture->bytes, "token");
    put_byte(&fixture->bytes, 42);
    put_str(&fixture->bytes, "colour"); /* what is unknown may come twice */
    put_byte(&fixture->bytes, 0xc0);
    put_str(&fixture->bytes, "toke");
    put_byte(&fixture->bytes, 7);
    assert_ok(proto_decode(fixture->decoder, fixture->bytes.data, fixture->bytes.count,
                           &fixture->envelope, &fixture->error));
    assert_ok(proto_decode_body(&fixture->envelope,
                                &proto_messages[PROTO_METHOD_PING].request, &request,
                                &fixture->error));
    assert_int_equal(request.token, 42);
}

/* If this failed, two readers of one message could see two values. */
CASE(body__refuses_a_field_given_twice)
{
    struct fixture *fixture = *state;
    put_request(&fixture->bytes, 1, "ping");
    put_map(&fixture->bytes, 2);
    for (int i = 0; i < 2; i++) {
        put_str(&fixture->bytes, "token");
        put_byte(&fixture->bytes, 42);
    }
    assert_refused(fixture, "\"token\" is given twice");
}

/* If this failed, a name that is no string would be compared as one. */
CASE(body__refuses_names_that_are_no_strings)
{
    struct fixture *fixture = *state;
    put_request(&fixture->bytes, 1, "ping");
    put_map(&fixture->bytes, 1);
    put_byte(&fixture->bytes, 1);
    put_byte(&fixture->bytes, 42);
    assert_refused(fixture, "name is not a string");
}

/* If this failed, a handle that was forgotten would read as handle 0. */
CASE(body__needs_every_required_field)
{
    struct fixture *fixture = *state;
    for (int method = 0; method < PROTO_METHOD_COUNT; method++) {
        const struct proto_fields *fields = &proto_messages[method].request;
        for (uint32_t left_out = 0; left_out < fields->count; left_out++) {
            char about[128];
            put_request(&fixture->bytes, 1, proto_messages[method].name);
            put_map(&fixture->bytes, fields->count - 1);
            for (uint32_t i = 0; i < fields->count; i++) {
                if (i == left_out) {
                    continue;
                }
                put_str(&fixture->bytes, fields->items[i].name);
                if (fields->items[i].type == PROTO_TYPE_str) {
                    put_str(&fixture->bytes, "text");
                } else if (fields->items[i].type == PROTO_TYPE_bool) {
                    put_byte(&fixture->bytes, 0xc3);
                } else {
                    put_byte(&fixture->bytes, 1);
                }
            }
            snprintf(about, sizeof about, "\"%s\" is missing",
                     fields->items[left_out].name);
            if (fields->items[left_out].need == PROTO_NEED_REQ) {
                assert_refused(fixture, about);
            } else {
                assert_taken(fixture);
            }
        }
    }
}

/* One field of a request whose other required fields are right, as `value` says. */
static void put_field(struct fixture *fixture, const char *method, const char *field,
                      const char *value, size_t value_bytes)
{
    int found = proto_method_by_name(method, strlen(method));
    const struct proto_fields *fields = &proto_messages[found].request;
    unsigned count = 1;
    for (uint32_t i = 0; i < fields->count; i++) {
        count += fields->items[i].need == PROTO_NEED_REQ &&
                 strcmp(fields->items[i].name, field) != 0;
    }
    put_request(&fixture->bytes, 1, method);
    put_map(&fixture->bytes, count);
    for (uint32_t i = 0; i < fields->count; i++) {
        if (strcmp(fields->items[i].name, field) == 0) {
            put_str(&fixture->bytes, field);
            put(&fixture->bytes, value, value_bytes);
        } else if (fields->items[i].need == PROTO_NEED_REQ) {
            put_str(&fixture->bytes, fields->items[i].name);
            put_byte(&fixture->bytes, 1);
        }
    }
}

#define REFUSED(method, field, literal)                                                  \
    do {                                                                                 \
        put_field(fixture, method, field, literal, sizeof literal - 1);                  \
        assert_refused(fixture, "\"" field "\" is not");                                 \
    } while (0)
#define TAKEN(method, field, literal)                                                    \
    do {                                                                                 \
        put_field(fixture, method, field, literal, sizeof literal - 1);                  \
        assert_taken(fixture);                                                           \
    } while (0)

/* If this failed, a number could change on its way into a C type. */
CASE(integer__of_another_type_or_range_is_refused)
{
    struct fixture *fixture = *state;
    TAKEN("frame.submit", "mode", "\x03");
    TAKEN("frame.submit", "mode", "\xd0\x03"); /* signed, but positive */
    TAKEN("frame.submit", "mode", "\xcf\0\0\0\0\xff\xff\xff\xff"); /* wide, but small */
    REFUSED("frame.submit", "mode", "\xcf\0\0\0\x01\0\0\0\0");     /* 2^32 */
    REFUSED("frame.submit", "mode", "\xff");                       /* -1 */
    REFUSED("frame.submit", "mode", "\xd3\xff\xff\xff\xff\xff\xff\xff\xfe");
    REFUSED("frame.submit", "mode", "\xca\x3f\x80\x00\x00"); /* 1.0 */
    REFUSED("frame.submit", "mode", "\xc0");
    REFUSED("frame.submit", "mode", "\xc3");
    REFUSED("frame.submit", "mode",
            "\xa1"
            "1");
    REFUSED("frame.submit", "mode", "\x91\x01");
    REFUSED("frame.submit", "mode", "\x80");
    TAKEN("frame.submit", "seq", "\xcf\xff\xff\xff\xff\xff\xff\xff\xff");
    REFUSED("frame.submit", "seq", "\xff");
    REFUSED("frame.submit", "seq", "\xcb\x3f\xf0\0\0\0\0\0\0");
    REFUSED("frame.submit", "seq", "\xc2");
}

/* If this failed, peers that write 1 for 1.0 would be refused, or text taken for a
 * number. */
CASE(number__may_be_an_integer_but_no_text)
{
    struct fixture *fixture = *state;
    TAKEN("frame.submit", "tolerance", "\xcb\x3f\xf0\0\0\0\0\0\0");
    TAKEN("frame.submit", "tolerance", "\xca\x3f\x80\x00\x00");
    TAKEN("frame.submit", "tolerance", "\x01");
    TAKEN("frame.submit", "tolerance", "\xff");
    REFUSED("frame.submit", "tolerance",
            "\xa3"
            "1.0");
    REFUSED("frame.submit", "tolerance", "\xc0");
    REFUSED("frame.submit", "tolerance", "\xc3");
}

/* If this failed, a name could hide a NUL, be cut, or not be text. */
CASE(text__is_short_utf8_without_nul)
{
    struct fixture *fixture = *state;
    char longest[2 + PROTO_STR_MAX] = "\xd9\xff";
    char longer[3 + PROTO_STR_MAX + 1] = "\xda\x01\x00";
    memset(longest + 2, 'x', PROTO_STR_MAX);
    memset(longer + 3, 'x', PROTO_STR_MAX + 1);
    put_field(fixture, "hello", "client", longest, sizeof longest);
    assert_taken(fixture);
    put_field(fixture, "hello", "client", longer, sizeof longer);
    assert_refused(fixture, "\"client\" is not");
    TAKEN("hello", "client", "\xa0");
    TAKEN("hello", "client", "\xa4\xf0\x9f\x98\x80");
    REFUSED("hello", "client",
            "\xa3"
            "a\0b");
    REFUSED("hello", "client", "\xa1\x80");
    REFUSED("hello", "client", "\xa2\xc0\xaf");         /* overlong */
    REFUSED("hello", "client", "\xa3\xed\xa0\x80");     /* a surrogate */
    REFUSED("hello", "client", "\xa4\xf4\x90\x80\x80"); /* beyond U+10FFFF */
    REFUSED("hello", "client", "\xa1\xe2");             /* cut */
    REFUSED("hello", "client",
            "\xc4\x01"
            "a"); /* bin */
    REFUSED("hello", "client", "\x07");
    REFUSED("hello", "client", "\xc0");
}

/* If this failed, 0 and 1 would be read as truth values by one peer and not by
 * another. */
CASE(truth__is_a_boolean)
{
    struct fixture *fixture = *state;
    struct proto_CANCEL_result result;
    static const char *const values[] = {"\xc3", "\x01", "\xc0", "\xa4true"};
    for (int i = 0; i < 4; i++) {
        SET(fixture, "\x94\x01\x05\xc0\x81\xa5"
                     "found");
        put(&fixture->bytes, values[i], i == 3 ? 5 : 1);
        assert_ok(proto_decode(fixture->decoder, fixture->bytes.data,
                               fixture->bytes.count, &fixture->envelope,
                               &fixture->error));
        int status = proto_decode_body(&fixture->envelope,
                                       &proto_messages[PROTO_METHOD_CANCEL].result,
                                       &result, &fixture->error);
        assert_int_equal(status, i == 0 ? 0 : PCCD_E_BADMSG);
        assert_int_equal(result.found, i == 0);
    }
}

/* If this failed, half a message could be taken for a whole one by a careless caller. */
CASE(body__is_zeroed_when_refused)
{
    struct fixture *fixture = *state;
    struct proto_SCENE_ADD_request request = {0};
    memset(&request, 0xa5, sizeof request);
    put_request(&fixture->bytes, 1, "scene.add");
    put_map(&fixture->bytes, 1);
    put_str(&fixture->bytes, "scene");
    put_byte(&fixture->bytes, 5);
    assert_ok(proto_decode(fixture->decoder, fixture->bytes.data, fixture->bytes.count,
                           &fixture->envelope, &fixture->error));
    assert_int_equal(proto_decode_body(&fixture->envelope,
                                       &proto_messages[PROTO_METHOD_SCENE_ADD].request,
                                       &request, &fixture->error),
                     PCCD_E_BADMSG);
    assert_int_equal(request.scene, 0);
    assert_int_equal(request.mesh, 0);
}

CASES_WITH(set_up, tear_down);
