/* format.h - the file format of recordings, byte by byte.
 *
 * All words are little-endian. A file is only appended to: whatever ends the writer, the
 * chunks before stay whole. Each chunk can be read by itself: `encoding` says how its
 * payload is stored; the header has a checksum of its own (XXH3-64 over the 40 bytes
 * before it) and one of the stored bytes. A reader skips kinds that it does not know.
 *
 * A reader refuses a file of another version; its message names the release that wrote
 * the file, which the first chunk, BEGIN, tells.
 *
 *     segment  BEGIN snapshot events END?
 *     snapshot MESH* (SCENE (OBJECT PLACE? FILTER? NAME?)* PAIRS?)* MESH_GONE*
 *     events   any of the others, in the order in which requests were sent
 *
 * A file is one segment and can be read without those before it. A step that was in
 * flight when a segment began stands in it again.
 *
 * | kind | payload: a struct of payload.h, then |
 * |---|---|
 * | BEGIN | nothing |
 * | MESH | a shape: made, or replaced if it is known |
 * | SCENE, OBJECT, *_GONE, END | nothing |
 * | PLACE | double[12], or vertices: where an object of the snapshot is |
 * | FRAME | the slot's payload: segment table, then positions (proto/shm.h) |
 * | ANSWER | nothing |
 * | RECORDS | records of an answer, if these were to be recorded |
 * | FILTER | nothing |
 * | PAIRS | a struct record_pair each |
 * | GUEST | a shape: added, or given another one if it is there |
 * | MOVE | as FRAME; it has no number, and no answer |
 * | NEAR | as FRAME, if anything moves; else nothing |
 * | NAME | UTF-8; empty: no name any more. Who does not know it shows none |
 */
#ifndef RECORD_FORMAT_H
#define RECORD_FORMAT_H

#include <stdint.h>

#include "pccd_types.h"

#define RECORD_MAGIC       "pccdrec" /* and its NUL */
#define RECORD_VERSION     3u        /* its first two were never released */
#define RECORD_HEAD_BYTES  16u
#define RECORD_CHUNK_MAGIC 0x68636370u  /* "pcch" */
#define RECORD_BYTES_MAX   (1ull << 32) /* of a payload */
/* X(name, number, "what it says"). Numbers are never given anew. */
#define RECORD_KINDS(X)                                                                  \
    X(BEGIN, 1, "who records what, and when")                                            \
    X(SCENE, 2, "a scene was made")                                                      \
    X(MESH, 3, "a mesh was made or replaced")                                            \
    X(OBJECT, 4, "an object was added")                                                  \
    X(PLACE, 5, "where an object is")                                                    \
    X(FRAME, 7, "a step was submitted")                                                  \
    X(ANSWER, 8, "a step was answered")                                                  \
    X(RECORDS, 9, "records of an answer")                                                \
    X(SCENE_GONE, 11, "a scene was destroyed")                                           \
    X(MESH_GONE, 12, "a mesh was destroyed; its objects stay")                           \
    X(OBJECT_GONE, 13, "an object was removed")                                          \
    X(END, 14, "the segment is whole")                                                   \
    X(FILTER, 15, "what an object may meet")                                             \
    X(PAIRS, 16,                                                                         \
      "pairs of objects that ignore each other, have a clearance, or neither")           \
    X(GUEST, 17, "an object of a shared scene, with a shape of its own")                 \
    X(MOVE, 18, "another client has moved a shared scene on")                            \
    X(NEAR, 20, "it was asked what is near, after a movement or without")                \
    X(NAME, 29, "what an object is called")
enum record_kind {
#define RECORD_ENUM(name, number, text) RECORD_##name = (number),
    RECORD_KINDS(RECORD_ENUM)
#undef RECORD_ENUM
};

enum record_encoding { RECORD_STORED = 0, RECORD_ZSTD = 1 };
struct record_chunk {
    uint32_t magic;
    uint16_t kind;         /* enum record_kind */
    uint16_t encoding;     /* enum record_encoding */
    uint64_t bytes;        /* of the payload */
    uint64_t stored_bytes; /* as stored */
    uint64_t time_ns;      /* CLOCK_MONOTONIC */
    uint64_t stored_sum;   /* XXH3-64 of the stored bytes */
    uint64_t header_sum;   /* XXH3-64 of the 40 bytes before */
};

#endif
