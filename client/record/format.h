/* format.h - a recording, byte by byte.
 *
 * Room:     client/record. May include: pccd_types.h.
 * Does:     the layout of what the library writes and pccdctl reads.
 * Does not: write or read it (chunk.h, reader.h).
 * Threads:  [any].
 *
 *     file     "pccdrec\0" | u32 version | u32 0 | chunk | chunk | ...
 *     chunk    struct record_chunk (48 bytes) | stored_bytes | zeros up to 8
 *
 * All words are little-endian. Only appended to: whatever ends the writer, the chunks
 * before stay whole. Each can be read by itself: `encoding` says how its payload is
 * stored, the header has a checksum of its own (XXH3-64 over the 40 bytes before it) and
 * one of the stored bytes. A reader skips kinds that it does not know.
 *
 *     segment  BEGIN snapshot LOG events END?
 *     snapshot MESH* (SCENE (OBJECT PLACE?)*)* MESH_GONE*
 *     events   any of the others, in the order in which requests were sent
 *
 * A file is one segment and can be read without those before it. A step that was in
 * flight when a segment began stands in its log again.
 *
 * | kind | payload: a struct, then |
 * |---|---|
 * | BEGIN | nothing |
 * | MESH | vertices (padded to 8), triangles: made, or replaced if it is known |
 * | SCENE, OBJECT, *_GONE, CANCEL, LOG, END | nothing |
 * | PLACE | double[12], or vertices: where an object of the snapshot is |
 * | FRAME | the slot's payload: segment table, then positions (proto/shm.h) |
 * | ANSWER | nothing |
 * | RECORDS | records of an answer, if these were to be recorded |
 */
#ifndef RECORD_FORMAT_H
#define RECORD_FORMAT_H

#include <stdint.h>

#include "pccd_types.h"

#define RECORD_MAGIC       "pccdrec" /* and its NUL */
#define RECORD_VERSION     1u
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
    X(LOG, 6, "the snapshot ends, the log begins")                                       \
    X(FRAME, 7, "a step was submitted")                                                  \
    X(ANSWER, 8, "a step was answered")                                                  \
    X(RECORDS, 9, "records of an answer")                                                \
    X(CANCEL, 10, "a step was cancelled")                                                \
    X(SCENE_GONE, 11, "a scene was destroyed")                                           \
    X(MESH_GONE, 12, "a mesh was destroyed; its objects stay")                           \
    X(OBJECT_GONE, 13, "an object was removed")                                          \
    X(END, 14, "the segment is whole")
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

struct record_begin {
    uint64_t unix_ns; /* when this segment began */
    uint32_t pid;     /* of the program that records, and of its daemon */
    uint32_t daemon_pid;
    uint32_t segment; /* 0, 1, ... of this recording */
    uint32_t flags;   /* 1: RECORDS are kept */
    char library[16]; /* "0.1.0" */
    char cpu[16];     /* instruction set of the daemon */
};

struct record_mesh {
    uint32_t mesh;
    uint32_t format; /* enum pccd_format */
    uint32_t vertex_count;
    uint32_t triangle_count;
};

struct record_scene {
    uint32_t scene;
    uint32_t quality;
    uint32_t rebuild_triangles_max;
    uint32_t reserved;
    double rebuild_ratio;
};

struct record_object {
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
    uint32_t reserved;
};

enum record_placing { RECORD_PLACED_RIGID = 1, RECORD_PLACED_FREELY = 2 };
struct record_place {
    uint32_t scene;
    uint32_t object;
    uint32_t placing; /* enum record_placing */
    uint32_t format;  /* of the vertices; 1 for a transform */
};

struct record_log {
    uint64_t next_step;
};
struct record_frame {
    uint64_t step;
    uint32_t scene;
    uint32_t segment_count;
    uint32_t mode;
    uint32_t method;
    uint32_t threads;
    uint32_t scheduler;
    uint32_t high_level;
    uint32_t refit;
    double tolerance;
    uint64_t deadline_ns;
};

/* A segment of a FRAME, as in the slot. */
struct record_segment {
    uint32_t object;
    uint16_t kind; /* enum record_segment_kind */
    uint16_t format;
    uint32_t first;
    uint32_t count;
    uint64_t offset0; /* from the start of the slot's payload */
    uint64_t offset1;
};
enum record_segment_kind { RECORD_X1 = 0, RECORD_X0X1 = 1, RECORD_RIGID = 2 };

#define RECORD_TIMES    10u /* in the order of struct pccd_step_times */
#define RECORD_COUNTERS 13u /* in the order of struct pccd_step_counters */

struct record_answer {
    uint64_t step;
    int32_t status; /* enum pccd_status; else than 0: the rest is 0 */
    uint32_t mode;
    uint32_t method;
    uint32_t incomplete;
    uint32_t verdict;
    uint32_t threads;
    uint64_t total;
    uint64_t vf;
    uint64_t ee;
    uint64_t possible;
    uint64_t initial;
    double toi_first;
    uint64_t hash[2];
    uint64_t times[RECORD_TIMES];
    uint64_t counters[RECORD_COUNTERS];
};

struct record_records {
    uint64_t step;
    uint64_t first;
    uint64_t count;
    uint32_t record_bytes; /* 64: struct pccd_contact, 20: struct pccd_pair */
    uint32_t reserved;
};

struct record_gone {
    uint32_t scene; /* SCENE_GONE, OBJECT_GONE */
    uint32_t mesh;  /* MESH_GONE */
    uint32_t object;
    uint32_t reserved;
};

struct record_cancel {
    uint64_t step;
};
enum record_reason {
    RECORD_STOPPED = 0, /* pccd_record_stop or pccd_close */
    RECORD_FULL = 1,    /* max_bytes reached, or no memory, or no room on the disk */
    RECORD_TURNED = 2   /* the next segment follows, in a file of its own */
};

struct record_end {
    uint32_t reason; /* enum record_reason */
    uint32_t reserved;
    uint64_t frames; /* of this segment */
};

#endif
