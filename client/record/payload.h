/* payload.h - the contents of each kind of chunk in a recording, byte by byte.
 *
 * All words are little-endian.
 */
#ifndef RECORD_PAYLOAD_H
#define RECORD_PAYLOAD_H

#include <stddef.h>
#include <stdint.h>

#include "object_attributes.h"

/* Flags of a segment. */
enum record_flag { RECORD_HAS_RECORDS = 1 }; /* RECORDS are kept */
/* The axis that points up, in two bits above that: 1 x, 2 y, 3 z; 0: nobody knows. */
#define RECORD_UP_SHIFT 1u
#define RECORD_UP_MASK  3u

struct record_begin {
    uint64_t unix_ns; /* when this segment began */
    uint32_t pid;     /* of the program that records, and of its daemon */
    uint32_t daemon_pid;
    uint32_t segment; /* 0, 1, ... of this recording */
    uint32_t flags;   /* enum record_flag */
    char library[16]; /* "0.1.0" */
    char cpu[16];     /* instruction set of the daemon */
};

/* A MESH; or a GUEST, an object with a mesh that nobody else has. Its shape follows:
 * vertices (padded to 8), radii (double), triangles, edges and points that it names by
 * themselves (uint32_t [3], [2], [1]). */
struct record_mesh {
    uint32_t mesh;   /* GUEST: 0 */
    uint32_t format; /* enum pccd_format */
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    uint32_t point_count;
    uint32_t has_radii;     /* 0, 1: one for each vertex */
    uint32_t scene, object; /* of a GUEST */
    uint32_t reserved;
};

struct record_scene {
    uint32_t scene;
    uint32_t reserved;
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

/* A step, or of NEAR a question about what is near, as it was asked; they are numbered
 * together. What the other one alone has is 0. */
struct record_frame {
    uint64_t step; /* MOVE: 0 */
    uint32_t scene;
    uint32_t segment_count; /* 0: nothing moves */
    uint32_t method;
    uint32_t threads;
    uint32_t tells;      /* 0, 1: how the step begins; of a question what crosses */
    uint32_t mode;       /* of a step, enum pccd_mode */
    uint32_t touching;   /* of a step, enum pccd_touching */
    uint32_t what;       /* of a question, enum pccd_near_what */
    uint32_t end;        /* of a question, 0, 1: of the movement, or of the last one */
    uint32_t objects[2]; /* of a question: handles; 0: any */
    uint32_t reserved;
    double tolerance, separation, approach, resolution; /* of a step */
    double distance, gap;                               /* of a question */
    uint64_t deadline_ns;
    char tuning[PCCD_TUNING_BYTES]; /* with its NUL, filled up with zeros */
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
enum record_segment_kind {
    RECORD_X1 = 0,
    RECORD_X0X1 = 1,
    RECORD_RIGID = 2,
    RECORD_ON_JOINT = 3 /* a table of joints is at offset0, that of the last such segment
                         * or one behind it; `first` is one of them */
};

/* The head of a table of joints in a slot; struct pccd_joint[count] follows. */
struct record_joints {
    uint32_t count;
    uint32_t reserved;
};

/* An answer to a step or a question, without what it took; what the other one alone has
 * is 0. */
struct record_answer {
    uint64_t step;
    int32_t status;   /* enum pccd_status; else than 0: the rest is 0, but is_near */
    uint32_t is_near; /* 0, 1: to a question */
    uint32_t mode;    /* of a step */
    uint32_t what;    /* of a question */
    uint32_t incomplete;
    uint32_t verdict;
    uint64_t total;
    uint64_t counts[PCCD_KINDS_MAX]; /* by enum pccd_kind and enum pccd_near_kind */
    uint64_t possible;               /* of a step, as the next two */
    uint64_t initial;
    double toi_first;
    double distance_min; /* of a question, as the next two */
    double distance_max;
    uint64_t crossings;
    uint64_t hash[2]; /* zeros: with a gap there is none */
};

/* The head of RECORDS. */
struct record_records {
    uint64_t step;
    uint64_t first;
    uint64_t count;
    uint32_t record_bytes; /* 64: struct pccd_contact, 20: struct pccd_pair; of what is
                              near 64: struct pccd_near, 8: double, a vertex's bound */
    uint32_t reserved;
};

struct record_gone {
    uint32_t scene; /* SCENE_GONE, OBJECT_GONE */
    uint32_t mesh;  /* MESH_GONE */
    uint32_t object;
    uint32_t reserved;
};

#define RECORD_FILTER_BYTES 16u /* the least; a longer one has words */
struct record_filter {
    uint32_t scene;
    uint32_t object;
    uint32_t what; /* enum pccd_object_what: which of these are set */
    uint32_t reserved;
    uint64_t words[COMMON_WORDS]; /* attributes (object_attributes.h) */
};

struct record_pairs {
    uint32_t scene;
    uint32_t count;
};
struct record_pair { /* what was said of it before ends */
    uint32_t a, b;   /* two objects */
    uint32_t said;   /* enum record_said */
    uint32_t reserved;
    double clearance; /* 0 .. 1e18, in the place of their radii; of others 0 */
};
enum record_said { RECORD_NOTHING = 0, RECORD_IGNORED = 1, RECORD_CLEARANCE = 2 };

struct record_name { /* and its bytes, without a NUL */
    uint32_t scene;
    uint32_t object;
    uint32_t bytes; /* 0 .. PROTO_STR_MAX */
    uint32_t reserved;
};

enum record_reason {
    RECORD_STOPPED = 0,  /* pccd_record_stop or pccd_close */
    RECORD_FULL = 1,     /* max_bytes reached */
    RECORD_TURNED = 2,   /* the next segment follows, in a file of its own */
    RECORD_APART = 3,    /* what comes next cannot be repeated from a file: it is not this
                         * client's alone, or the daemon does not tell all of it */
    RECORD_UNWRITTEN = 4 /* no memory, or the file could not be written: a full disk */
};

struct record_end {
    uint32_t reason; /* enum record_reason */
    uint32_t reserved;
};

/* ---- shapes ------------------------------------------------------------------------ */

/* Where the parts of a shape begin behind its head, in bytes, and where it ends. */
struct record_shape {
    uint64_t x, radii, triangles, edges, points, end;
};
struct record_shape record_shape_of(const struct record_mesh *head);

/* ---- FILTER ------------------------------------------------------------------------ */

/* Make a filter of those of `given` that `what` names (bits of enum pccd_object_what, or
 * all). */
void record_filter_make(struct record_filter *filter, uint32_t scene, uint32_t object,
                        uint32_t what, const struct common_attributes *given);
/* Read a filter from a payload that was judged. */
void record_filter_read(const void *payload, uint64_t bytes, struct record_filter *filter,
                        struct common_attributes *given);

/* ---- The hash of an answer, from its records, to check the one that a daemon sent
 * (proto/PROTOCOL.md, "The hash of an answer"). */

/* Hash all records of an answer, in their order: hash[0] high, hash[1] low. Not for mode
 * any: its hash is that of the verdict. */
void record_answer_hash(const void *records, uint64_t count, size_t record_bytes,
                        uint64_t hash[2]);
/* Hash the verdict of an answer of mode any. */
void record_verdict_hash(uint32_t verdict, uint64_t hash[2]);
/* The record that record_answer_hash takes of answers about the bounds of vertices, whose
 * records are the bounds alone. */
struct record_bound {
    uint32_t object, vertex;
    double bound;
};

#endif
