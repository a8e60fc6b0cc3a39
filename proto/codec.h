/* codec.h - encodes and decodes messages (MessagePack-RPC).
 *
 * Translate [0,id,method,params], [1,id,error,result] and [2,method,params] to and from
 * the structs of messages.h. params and result are maps from field name to scalar.
 * Unknown fields are skipped, so that newer peers can add some. A field that is given
 * twice, of another type or out of its C type's range is E_BADMSG, with the field's name.
 *
 * Threads: [any], one decoder or encoder per thread at a time.
 */
#ifndef PROTO_CODEC_H
#define PROTO_CODEC_H

#include "messages.h"

enum proto_kind { PROTO_REQUEST = 0, PROTO_RESPONSE = 1, PROTO_NOTIFICATION = 2 };

/* The error of a response: [code, name, text, fatal] on the wire. */
struct proto_error {
    int32_t code; /* enum pccd_status */
    bool fatal;   /* the sender closes the connection after it */
    char text[PROTO_STR_MAX + 1];
};

/* Fill *error: `code` and a printf-style text, cut at PROTO_STR_MAX. Returns `code`. */
int proto_error_set(struct proto_error *error, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Return the name ("E_BADMSG") or the text ("malformed message") of a status; never
 * NULL. */
const char *proto_status_name(int status);
const char *proto_status_text(int status);

/* Return the method of a name on the wire; -1 if there is none. */
int proto_method_by_name(const char *name, size_t bytes);

/* A decoded envelope. `body` points into the decoder and from there into the message: it
 * lives until the decoder's next use, as long as the message's bytes stay. */
struct proto_envelope {
    enum proto_kind kind;
    uint32_t id;              /* 0 for notifications */
    int method;               /* enum proto_method, or -1: unknown; unset for responses */
    bool failed;              /* response: `error` is set instead of `body` */
    struct proto_error error;
    const void *body;         /* params or result: a const msgpack_object * */
};

/* Memory that is used anew for each message. */
struct proto_decoder;
/* Make a decoder. NULL: no memory. */
struct proto_decoder *proto_decoder_new(void);
void proto_decoder_free(struct proto_decoder *decoder);

/* Bound a message before msgpack-c sees it: depth, declared counts against the bytes
 * left, total elements, no ext, exactly one object that fills the message. Allocates
 * nothing. Returns 0 or PCCD_E_BADMSG with *error set. */
int proto_prescan(const void *message, size_t bytes, struct proto_error *error);

/* Prescan and decode one message. Returns 0, PCCD_E_BADMSG or PCCD_E_NOMEM (*error set).
 * An unknown method is not an error here: envelope->method is -1 and envelope->error
 * names it. */
int proto_decode(struct proto_decoder *decoder, const void *message, size_t bytes,
                 struct proto_envelope *envelope, struct proto_error *error);

/* Decode envelope->body into the struct that `fields` describes. Absent optional fields
 * are zero. Returns 0 or PCCD_E_BADMSG. On failure *out is zeroed. */
int proto_decode_body(const struct proto_envelope *envelope,
                      const struct proto_fields *fields, void *out,
                      struct proto_error *error);

/* An encoder writes one message into its own buffer of PROTO_MESSAGE_BYTES_MAX. */
struct proto_encoder {
    size_t bytes;
    uint8_t data[PROTO_MESSAGE_BYTES_MAX];
};

/* Encode one message. Returns 0 or PCCD_E_LIMIT (it would be longer than the maximum). */
int proto_encode_request(struct proto_encoder *encoder, uint32_t id, int method,
                         const void *request);
int proto_encode_result(struct proto_encoder *encoder, uint32_t id, int method,
                        const void *result);
int proto_encode_error(struct proto_encoder *encoder, uint32_t id,
                       const struct proto_error *error);
int proto_encode_notification(struct proto_encoder *encoder, int note,
                              const void *params);

#endif
