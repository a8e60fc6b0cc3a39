/* fixture.h - decodes bytes that a peer could send, for the tests of the codec. */
#ifndef TEST_PROTO_FIXTURE_H
#define TEST_PROTO_FIXTURE_H

#include "bytes.h"
#include "cases.h"
#include "codec.h"
#include "prng.h"

struct fixture {
    struct proto_decoder *decoder;
    struct proto_encoder encoder;
    struct bytes bytes;
    struct proto_envelope envelope;
    struct proto_error error;
};

static inline int set_up(void **state)
{
    static struct fixture fixture;
    fixture.decoder = proto_decoder_new();
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)prng_seed());
    *state = &fixture;
    return fixture.decoder == NULL;
}

static inline int tear_down(void **state)
{
    struct fixture *fixture = *state;
    proto_decoder_free(fixture->decoder);
    return 0;
}

/* Decode `count` bytes that end where an allocation ends, so that a read past them is
 * seen by the address sanitiser. The body is decoded too when there is one; for an
 * answer as the result of `method`. */
static inline int decode(struct fixture *fixture, const uint8_t *data, size_t count,
                         int method)
{
    char body[1024];
    uint8_t *copy = malloc(count > 0 ? count : 1);
    const struct proto_fields *fields;
    assert_non_null(copy);
    memcpy(copy, data, count);
    memset(&fixture->error, 0, sizeof fixture->error);
    int status =
        proto_decode(fixture->decoder, copy, count, &fixture->envelope, &fixture->error);
    if (status == 0 && fixture->envelope.body != NULL) {
        if (fixture->envelope.kind == PROTO_RESPONSE) {
            fields = &proto_messages[method].result;
        } else if (fixture->envelope.method >= 0) {
            fields = &proto_messages[fixture->envelope.method].request;
        } else {
            fields = NULL;
        }
        if (fields != NULL) {
            status = proto_decode_body(&fixture->envelope, fields, body, &fixture->error);
        }
    }
    free(copy);
    return status;
}

#endif
