/* journal.h - the layout of a journal, byte by byte: everything that was done to a shared
 * scene.
 *
 * A run of entries in the order in which the daemon did what they say. Each begins with
 * struct proto_journal_entry and is a multiple of 8 bytes long; a page may end within
 * one. All words are little-endian; positions are double[3]. A reader skips kinds that it
 * does not know. An object stands where its mesh was registered until a step moves it.
 *
 * | kind | behind the entry |
 * |---|---|
 * | OBJECT | struct proto_journal_object, vertices, triangles (u32[3] each), zeros |
 * | GONE | nothing |
 * | FILTER | u64 each: the attributes, in the order of object_attributes.h |
 * | PAIRS | struct proto_journal_pairs, u32[2] each: handles of two objects |
 * | STEP | struct proto_journal_step, then what could have stood in a slot: a segment |
 * |      | table (shm.h), all of it x0x1 and double, and positions |
 * | SEPARATION | struct proto_journal_separation; before a STEP, unless both are 0 |
 * | TELLS | nothing: the STEP behind it tells how it begins |
 * | RADII | struct proto_journal_radii, double each; before an OBJECT that has any |
 * | FREE | struct proto_journal_free, edges (u32[2] each), points (u32 each), zeros; |
 * |      | before an OBJECT that has any |
 * | NEAR | struct proto_journal_near, then the same; of this session alone: what others |
 * |      | ask is not noted, and what they move at that is a STEP |
 */
#ifndef PROTO_JOURNAL_H
#define PROTO_JOURNAL_H

#include <assert.h>
#include <stdint.h>

#include "pccd_types.h"

enum proto_journal_kind {
    PROTO_JOURNAL_OBJECT = 1,     /* was added, or got another shape */
    PROTO_JOURNAL_GONE = 2,       /* was removed, or its session has left */
    PROTO_JOURNAL_FILTER = 3,     /* has these attributes from now on */
    PROTO_JOURNAL_PAIRS = 4,      /* ignore each other from now on, or not any more */
    PROTO_JOURNAL_STEP = 5,       /* the scene was moved on */
    PROTO_JOURNAL_NEAR = 6,       /* this session has asked what is near */
    PROTO_JOURNAL_SEPARATION = 7, /* at which distance pairs meet in the step behind it */
    PROTO_JOURNAL_RADII = 8,      /* of the vertices of the object behind it */
    PROTO_JOURNAL_FREE = 9,       /* edges and points by themselves, likewise */
    PROTO_JOURNAL_TELLS = 10      /* the step behind it tells how it begins */
};

struct proto_journal_entry {
    uint64_t bytes;  /* of all of it */
    uint32_t kind;   /* enum proto_journal_kind */
    uint32_t object; /* handle; PAIRS, STEP: 0 */
};

struct proto_journal_object {
    uint32_t vertex_count;
    uint32_t triangle_count;
};

struct proto_journal_pairs {
    uint32_t count;
    uint32_t ignored;
};

struct proto_journal_step {
    uint64_t step;   /* of the session that keeps the journal: that it has submitted, or
                        that went along; 0: none of either, or objects were placed */
    uint64_t number; /* of the scene; 0: objects were placed, or moved by scene.near */
    double tolerance;
    uint32_t mode;
    uint32_t method;
    uint32_t threads;
    uint32_t segments;
    char tuning[PCCD_TUNING_BYTES]; /* filled up with zeros */
};

struct proto_journal_radii {
    uint32_t vertex_count;
    uint32_t reserved;
};

struct proto_journal_free {
    uint32_t vertex_count;
    uint32_t edge_count;
    uint32_t point_count;
    uint32_t reserved;
};

struct proto_journal_separation { /* as frame.submit has them */
    double separation;
    double approach;
};

/* As it was asked. */
struct proto_journal_near {
    uint64_t step;
    double distance;
    double gap;
    uint32_t what;
    uint32_t end;
    uint32_t object_a;
    uint32_t object_b;
    uint32_t method;
    uint32_t threads;
    uint32_t segments;
    uint32_t tells_crossings;
    char tuning[PCCD_TUNING_BYTES]; /* filled up with zeros */
};

static_assert(sizeof(struct proto_journal_entry) == 16, "entry");
static_assert(sizeof(struct proto_journal_object) == 8, "object");
static_assert(sizeof(struct proto_journal_pairs) == 8, "pairs");
static_assert(sizeof(struct proto_journal_step) == 104, "step");
static_assert(sizeof(struct proto_journal_free) == 16, "free");
static_assert(sizeof(struct proto_journal_separation) == 16, "separation");
static_assert(sizeof(struct proto_journal_near) == 120, "near");

#endif
