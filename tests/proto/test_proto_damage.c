/* test_proto_damage.c - right messages, damaged. */
#include "fixture.h"

/* Message number `which` as the encoder writes it, with all fields set; false: no
 * more. */
static bool encode_nth(struct fixture *fixture, int which, int *method)
{
    uint64_t ones[128]; /* u32 and u64 0x01..01, doubles small, strings of one byte */
    struct proto_error error = {PCCD_E_QUOTA, true, "quota of 64 clients reached"};
    memset(ones, 0, sizeof ones);
    *method = which % PROTO_METHOD_COUNT;
    bool is_result = which / PROTO_METHOD_COUNT == 1;
    if (which >= 2 * PROTO_METHOD_COUNT) {
        *method = 0;
        if (which == 2 * PROTO_METHOD_COUNT) {
            return proto_encode_error(&fixture->encoder, 3, &error) == 0;
        }
        struct proto_GOAWAY_request goaway = {20, "shutting down"};
        return which == 2 * PROTO_METHOD_COUNT + 1 &&
               proto_encode_notification(&fixture->encoder, PROTO_NOTE_GOAWAY, &goaway) ==
                   0;
    }
    const struct proto_fields *fields =
        is_result ? &proto_messages[*method].result : &proto_messages[*method].request;
    for (uint32_t i = 0; i < fields->count; i++) {
        char *member = (char *)ones + fields->items[i].offset;
        switch (fields->items[i].type) {
        case PROTO_TYPE_u32:
            *(uint32_t *)member = 70000 + i;
            break;
        case PROTO_TYPE_u64:
            *(uint64_t *)member = (1ull << 40) + i;
            break;
        case PROTO_TYPE_f64:
            *(double *)member = 0.5;
            break;
        case PROTO_TYPE_bool:
            *(bool *)member = true;
            break;
        case PROTO_TYPE_str:
            strcpy(member, "name");
            break;
        }
    }
    return (is_result ? proto_encode_result(&fixture->encoder, 3, *method, ones)
                      : proto_encode_request(&fixture->encoder, 3, *method, ones)) == 0;
}

/* If this failed, a message cut anywhere would be taken for a whole one. */
CASE(damage__truncated_at_every_byte_is_refused)
{
    struct fixture *fixture = *state;
    int method, which = 0;
    for (; encode_nth(fixture, which, &method); which++) {
        assert_ok(decode(fixture, fixture->encoder.data, fixture->encoder.bytes, method));
        for (size_t count = 0; count < fixture->encoder.bytes; count++) {
            assert_int_equal(decode(fixture, fixture->encoder.data, count, method),
                             PCCD_E_BADMSG);
        }
    }
    assert_int_equal(which, 2 * PROTO_METHOD_COUNT + 2);
}

/* If this failed, one damaged byte could crash the peer. */
CASE(damage__every_byte_to_every_value_is_taken_or_refused)
{
    struct fixture *fixture = *state;
    uint64_t taken = 0, refused = 0;
    int method;
    for (int which = 0; encode_nth(fixture, which, &method); which++) {
        for (size_t at = 0; at < fixture->encoder.bytes; at++) {
            uint8_t right = fixture->encoder.data[at];
            for (unsigned value = 0; value < 256; value++) {
                fixture->encoder.data[at] = (uint8_t)value;
                int status = decode(fixture, fixture->encoder.data,
                                    fixture->encoder.bytes, method);
                if (status == 0) {
                    taken++;
                } else if (status == PCCD_E_BADMSG && fixture->error.text[0] != '\0') {
                    refused++;
                } else {
                    fail_msg("message %d, byte %zu = %u: %d", which, at, value, status);
                }
            }
            fixture->encoder.data[at] = right;
        }
    }
    assert_true(taken > 1000 && refused > taken / 100);
}

/* If this failed, some run of bytes would crash the peer. */
CASE(damage__random_bytes_are_taken_or_refused)
{
    struct fixture *fixture = *state;
    struct prng random = {prng_seed()};
    for (int round = 0; round < 200000; round++) {
        size_t count = prng_below(&random, 40);
        fixture->bytes.count = 0;
        for (size_t i = 0; i < count;
             i++) { /* biased to containers, so that nesting occurs */
            put_byte(&fixture->bytes, prng_below(&random, 3) == 0
                                          ? 0x80 + (unsigned)prng_below(&random, 0x14)
                                          : (unsigned)prng_below(&random, 256));
        }
        int status = decode(fixture, fixture->bytes.data, count, 0);
        assert_true(status == 0 || status == PCCD_E_BADMSG);
    }
}

CASES_WITH(set_up, tear_down);
