/* chunk.h - writes and reads one chunk of a recording.
 *
 * Threads: one thread per writer.
 */
#ifndef RECORD_CHUNK_H
#define RECORD_CHUNK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "format.h"
#include "payload.h"

#define RECORD_KINDS_MAX 32u /* kinds are below */

/* A run of a payload's bytes. */
struct record_part {
    const void *at;
    size_t bytes;
};

struct record_writer {
    int fd;                          /* -1: none */
    int level;                       /* of zstd, 1 .. 19; 0: nothing is compressed */
    uint64_t bytes;                  /* written to this file */
    uint64_t last;                   /* of these, before the last chunk; 0: none */
    uint64_t bytes_max;              /* that it may have; 0: no bound */
    uint64_t raw_bytes;              /* the same before compression */
    void *squeeze;                   /* of zstd; NULL: not needed yet */
    uint32_t dull[RECORD_KINDS_MAX]; /* of each kind: chunks that are not compressed */
    uint8_t *raw;                    /* a payload in one piece */
    size_t raw_room;
    uint8_t *out; /* a chunk as stored */
    size_t out_room;
};

/* Return whether this build can compress and decompress. */
bool record_has_zstd(void);

/* Make the file, which must not exist, and write its head. PCCD_E_SYSTEM: errno says
 * why. */
int record_writer_open(struct record_writer *writer, const char *path);
/* Append one chunk, in one write. After a failure the file ends with the chunk before:
 * PCCD_E_SYSTEM (errno), PCCD_E_NOMEM, PCCD_E_LIMIT (bytes_max, which is judged by what
 * compression has left; a payload beyond RECORD_BYTES_MAX). */
int record_writer_add(struct record_writer *writer, enum record_kind kind,
                      uint64_t time_ns, const struct record_part *parts, size_t count);
/* Take the last chunk back, as room for another one, once; raw_bytes still counts it.
 * PCCD_E_SYSTEM: there is none, or the file cannot be cut. */
int record_writer_take_back(struct record_writer *writer);
/* Return the bytes of a chunk with such a payload, at most. */
uint64_t record_chunk_bytes_max(uint64_t payload_bytes);
/* Close the file; buffers stay for the next. 0 or PCCD_E_SYSTEM. */
int record_writer_close(struct record_writer *writer);
/* Free everything. */
void record_writer_deinit(struct record_writer *writer);

/* ---- reading; text is set on failure ----------------------------------------------- */

#define RECORD_TEXT_BYTES 160u

/* Check the header's own sum and its lengths. PCCD_OK or PCCD_E_FORMAT. */
int record_chunk_judge(const struct record_chunk *chunk, char text[RECORD_TEXT_BYTES]);
/* Check the stored bytes' sum, then unpack the payload to `to`, of chunk->bytes. PCCD_OK,
 * PCCD_E_FORMAT, PCCD_E_NOMEM. */
int record_chunk_unpack(const struct record_chunk *chunk, const void *stored, void *to,
                        char text[RECORD_TEXT_BYTES]);
/* Check whether a payload that is much longer than it is stored can be so long, by its
 * beginning and what that counts, before there is memory for it. PCCD_OK, PCCD_E_FORMAT,
 * PCCD_E_NOMEM. */
int record_chunk_measure(const struct record_chunk *chunk, const void *stored,
                         char text[RECORD_TEXT_BYTES]);
/* Return the most bytes that a payload can have whose first `have` are at `begin`.
 * *wants: as many of them as it takes to know; `have`: these are enough. PLACE: any. */
uint64_t record_payload_most(uint16_t kind, const void *begin, uint64_t have,
                             uint64_t *wants);
/* Check that a payload is what its kind says: lengths, counts, indices, ranges.
 * Everything that a reader of the payload relies on, but for what other chunks say. */
int record_payload_judge(uint16_t kind, const void *payload, uint64_t bytes,
                         char text[RECORD_TEXT_BYTES]);

/* Return the name of a kind, as "FRAME"; NULL: not known. */
const char *record_kind_name(uint16_t kind);

#endif
