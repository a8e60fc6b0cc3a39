/* bytes.h - writes MessagePack by hand, so that the tests do not trust the encoder. */
#ifndef TEST_PROTO_BYTES_H
#define TEST_PROTO_BYTES_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct bytes {
    size_t count;
    uint8_t data[70000];
};

static inline void put(struct bytes *bytes, const void *from, size_t count)
{
    if (count > sizeof bytes->data - bytes->count) {
        abort();
    }
    memcpy(bytes->data + bytes->count, from, count);
    bytes->count += count;
}

static inline void put_byte(struct bytes *bytes, unsigned value)
{
    uint8_t byte = (uint8_t)value;
    put(bytes, &byte, 1);
}

/* A type byte and a big-endian number of `width` bytes. */
static inline void put_number(struct bytes *bytes, unsigned type, uint64_t value,
                              int width)
{
    put_byte(bytes, type);
    for (int i = width - 1; i >= 0; i--) {
        put_byte(bytes, (unsigned)(value >> (8 * i)) & 0xff);
    }
}

static inline void put_array(struct bytes *bytes, unsigned count)
{
    put_byte(bytes, 0x90 | count);
}

static inline void put_map(struct bytes *bytes, unsigned count)
{
    if (count < 16) {
        put_byte(bytes, 0x80 | count);
    } else {
        put_number(bytes, 0xde, count, 2);
    }
}

static inline void put_str(struct bytes *bytes, const char *text)
{
    size_t count = strlen(text);
    put_number(bytes, 0xd9, count, 1);
    put(bytes, text, count);
}

static inline void put_u32(struct bytes *bytes, uint32_t value)
{
    put_number(bytes, 0xce, value, 4);
}

/* [0, id, method, params...: the caller goes on with the params. */
static inline void put_request(struct bytes *bytes, uint32_t id, const char *method)
{
    bytes->count = 0;
    put_array(bytes, 4);
    put_byte(bytes, 0);
    put_u32(bytes, id);
    put_str(bytes, method);
}

#endif
