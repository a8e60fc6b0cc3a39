/* prescan.c - bounds a message before msgpack-c sees it. */
#include "codec.h"

/* The contents of one header. */
struct header {
    size_t bytes; /* the header and the scalar's body */
    uint64_t
        children; /* objects that follow inside; 0 for scalars and empty containers */
};

static uint64_t big_endian(const uint8_t *at, unsigned bytes)
{
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes; i++) {
        value = value << 8 | at[i];
    }
    return value;
}

/* A header with a length field of `width` bytes after the type byte, in front of a body
 * of that length, or of that many times `per_item` objects when per_item > 0. */
static int read_counted(const uint8_t *at, size_t left, unsigned width, unsigned per_item,
                        struct header *header)
{
    if (left < 1 + (size_t)width) {
        return PCCD_E_BADMSG;
    }
    uint64_t length = big_endian(at + 1, width);
    header->bytes = 1 + (size_t)width;
    left -= header->bytes;
    if (per_item > 0) {
        header->children = length * per_item;
        return header->children > left ? PCCD_E_BADMSG : 0;
    }
    if (length > left) {
        return PCCD_E_BADMSG;
    }
    header->bytes += (size_t)length;
    return 0;
}

static int read_fixed(size_t left, size_t bytes, struct header *header)
{
    header->bytes = bytes;
    return bytes > left ? PCCD_E_BADMSG : 0;
}

/* Read the header at at[left], left >= 1. PCCD_E_BADMSG: it claims more than there is, or
 * is an ext or the unused 0xc1. */
static int read_header(const uint8_t *at, size_t left, struct header *header)
{
    uint8_t type = at[0];
    *header = (struct header){1, 0};
    if (type <= 0x7f || type >= 0xe0) { /* small integer */
        return 0;
    }
    if (type <= 0x8f) { /* small map */
        header->children = 2u * (type & 0x0fu);
        return header->children > left - 1 ? PCCD_E_BADMSG : 0;
    }
    if (type <= 0x9f) { /* small array */
        header->children = type & 0x0fu;
        return header->children > left - 1 ? PCCD_E_BADMSG : 0;
    }
    if (type <= 0xbf) { /* small string */
        return read_fixed(left, 1u + (type & 0x1fu), header);
    }
    switch (type) {
    case 0xc0: /* nil */
    case 0xc2: /* false */
    case 0xc3: /* true */
        return 0;
    case 0xc4: /* bin */
    case 0xd9: /* str */
        return read_counted(at, left, 1, 0, header);
    case 0xc5:
    case 0xda:
        return read_counted(at, left, 2, 0, header);
    case 0xc6:
    case 0xdb:
        return read_counted(at, left, 4, 0, header);
    case 0xcc: /* integers of 1, 2, 4, 8 bytes */
    case 0xd0:
        return read_fixed(left, 2, header);
    case 0xcd:
    case 0xd1:
        return read_fixed(left, 3, header);
    case 0xca: /* float */
    case 0xce:
    case 0xd2:
        return read_fixed(left, 5, header);
    case 0xcb: /* double */
    case 0xcf:
    case 0xd3:
        return read_fixed(left, 9, header);
    case 0xdc: /* array */
        return read_counted(at, left, 2, 1, header);
    case 0xdd:
        return read_counted(at, left, 4, 1, header);
    case 0xde: /* map */
        return read_counted(at, left, 2, 2, header);
    case 0xdf:
        return read_counted(at, left, 4, 2, header);
    default: /* 0xc1, ext */
        return PCCD_E_BADMSG;
    }
}

int proto_prescan(const void *message, size_t bytes, struct proto_error *error)
{
    const uint8_t *data = message;
    uint64_t open[PROTO_DEPTH_MAX]; /* objects still to come in each open container */
    uint32_t depth = 0;
    uint32_t elements = 0;
    size_t at = 0;

    if (bytes > PROTO_MESSAGE_BYTES_MAX) {
        return proto_error_set(error, PCCD_E_BADMSG,
                               "%zu bytes; a message has at most %u", bytes,
                               PROTO_MESSAGE_BYTES_MAX);
    }
    do {
        struct header header;
        if (at == bytes) {
            return proto_error_set(error, PCCD_E_BADMSG,
                                   "the message ends at byte %zu, "
                                   "inside an object",
                                   at);
        }
        if (++elements > PROTO_ELEMENTS_MAX) {
            return proto_error_set(error, PCCD_E_BADMSG,
                                   "more than %u objects in a message",
                                   PROTO_ELEMENTS_MAX);
        }
        if (read_header(data + at, bytes - at, &header) != 0) {
            return proto_error_set(error, PCCD_E_BADMSG,
                                   "byte %zu: type 0x%02x is not "
                                   "allowed or claims more than the message holds",
                                   at, data[at]);
        }
        at += header.bytes;
        if (depth > 0) {
            open[depth - 1]--;
        }
        if (header.children > 0) {
            if (depth == PROTO_DEPTH_MAX) {
                return proto_error_set(error, PCCD_E_BADMSG, "nested deeper than %u",
                                       PROTO_DEPTH_MAX);
            }
            open[depth++] = header.children;
        }
        while (depth > 0 && open[depth - 1] == 0) {
            depth--;
        }
    } while (depth > 0);
    if (at != bytes) {
        return proto_error_set(error, PCCD_E_BADMSG, "%zu bytes follow the message",
                               bytes - at);
    }
    return 0;
}
