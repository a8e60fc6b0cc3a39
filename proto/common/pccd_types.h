/* pccd_types.h - the types that users, the library, the protocol and the engine share:
 * statuses, modes, contacts.
 *
 * Room:     common; installed beside pccd.h. May include: the C library. Compiles as C++.
 * Does:     define status codes, modes, formats and the records of an answer, with their
 *           layout.
 * Does not: declare functions.
 *
 * More than 200 lines: all that is one vocabulary, to be read from top to bottom.
 */
#ifndef PCCD_TYPES_H
#define PCCD_TYPES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Every status of the wire, the library and the tools: X(name, value, text).
 * A value is never renumbered; new ones go at the end. */
#define PCCD_STATUS_LIST(X)                                                              \
    X(OK, 0, "success")                                                                  \
    X(E_NOMEM, -1, "out of memory")                                                      \
    X(E_INVAL, -2, "invalid argument")                                                   \
    X(E_QUOTA, -3, "quota reached")                                                      \
    X(E_LIMIT, -4, "limit of the format or of this build reached")                       \
    X(E_BADMSG, -5, "malformed message")                                                 \
    X(E_VERSION, -6, "no common protocol version")                                       \
    X(E_NOHELLO, -7, "hello must come first")                                            \
    X(E_NOMETHOD, -8, "unknown method")                                                  \
    X(E_HANDLE, -9, "unknown or stale handle")                                           \
    X(E_STATE, -10, "not possible in this state")                                        \
    X(E_BUSY, -11, "too many requests in flight")                                        \
    X(E_SLOT_STALE, -12, "the slot does not hold the submitted step")                    \
    X(E_SLOT_TORN, -13, "the slot was written while it was read")                        \
    X(E_SEGMENT, -14, "malformed segment table")                                         \
    X(E_NOTFINITE, -15, "a coordinate is not finite or beyond 1e18")                     \
    X(E_INDEX, -16, "a vertex index is out of range")                                    \
    X(E_DISCONNECTED, -17, "the daemon is gone")                                         \
    X(E_TIMEOUT, -18, "timed out")                                                       \
    X(E_NODAEMON, -19, "no daemon could be reached or started")                          \
    X(E_SHUTDOWN, -20, "the daemon is shutting down")                                    \
    X(E_CANCELLED, -21, "cancelled")                                                     \
    X(E_SYSTEM, -22, "the operating system refused")                                     \
    X(E_AGAIN, -23, "not there yet")                                                     \
    X(E_FORMAT, -24, "file format not understood")                                       \
    X(E_INTERNAL, -25, "internal error")                                                 \
    X(E_ACCESS, -26, "not allowed to this user")

enum pccd_status {
#define PCCD_STATUS_ENUM(name, value, text) PCCD_##name = (value),
    PCCD_STATUS_LIST(PCCD_STATUS_ENUM)
#undef PCCD_STATUS_ENUM
};

/* The question of a step. */
enum pccd_mode {
    PCCD_MODE_ALL = 0,   /* every contact */
    PCCD_MODE_FIRST = 1, /* the contacts that may attain the scene's earliest time */
    PCCD_MODE_ANY = 2,   /* yes, no or possible; no records */
    /* The pairs that neither x, y nor z separates. A pair is left out if along one of
     * them each point of one feature is more than r above each point of the other, at
     * both ends of the step; r: the exact sum of both radii and the separation, or 0. */
    PCCD_MODE_PAIRS = 3,
    /* For each two objects that meet, and for each that meets itself, the contact of the
     * least toi among those of mode all; of several the first in canonical order. */
    PCCD_MODE_FIRST_PER_PAIR = 4,
    PCCD_MODE_COUNT = 5
};

/* Methods by which an answer is computed. All give the same bytes. */
enum pccd_method {
    PCCD_METHOD_DEFAULT = 0, /* wide; paper where its scheduler is asked for */
    PCCD_METHOD_PAPER = 1, /* binary trees of boxes over triangles (PCCD, sections 3-6) */
    PCCD_METHOD_WIDE = 2,  /* trees of 16 children over vertices, edges and faces */
    PCCD_METHOD_COUNT = 3
};

/* Bytes, with its NUL, of the text that says how the threads of a step share its work,
 * such as "scheduler=paper,refit=paper" (pccd.h). */
#define PCCD_TUNING_BYTES 64

/* Coordinates in a slot: x, y, z per vertex, tightly packed, little-endian IEEE 754. */
enum pccd_format {
    PCCD_FORMAT_F32 = 0, /* float[3], 12 bytes a vertex */
    PCCD_FORMAT_F64 = 1, /* double[3], 24 bytes a vertex */
    PCCD_FORMAT_COUNT = 2
};

/* Kinds of joint. R(u, q) turns about the unit vector u by q radians, right-handed. */
enum pccd_joint_kind {
    PCCD_JOINT_FIXED = 0, /* x' = x */
    PCCD_JOINT_TURN = 1,  /* x' = R(u, q) x, u = axis / |axis| (revolute) */
    PCCD_JOINT_SLIDE = 2, /* x' = x + q u, u = axis / |axis| (prismatic) */
    PCCD_JOINT_SHIFT = 3, /* x' = x + d: by a vector that goes straight */
    PCCD_JOINT_VECTOR = 4, /* x' = R(w / |w|, |w|) x: a rotation vector w that does */
    PCCD_JOINT_KIND_COUNT = 5
};

#define PCCD_NO_JOINT UINT32_MAX /* the world */

/* A joint: how a link moves against the link that it hangs on, while t goes from 0 to 1.
 * A point x of the link is at position + R(rotation) x' in the frame of the joint's
 * parent, where x' is what the kind makes of x. Its value goes straight from `from` to
 * `to`: q of TURN and SLIDE is the first of the three, d of SHIFT and w of VECTOR are all
 * three; FIXED and what is left are zeros. All of this is meant exactly, by the doubles
 * as they are: `rotation` is that of the quaternion divided by its length, axes are
 * divided by theirs. Numbers are finite, of magnitude at most 1e18; lengths of axes and
 * quaternions 1e-9 .. 1e9; angles at most 2^20 turns. */
struct pccd_joint {
    uint32_t kind;      /* enum pccd_joint_kind */
    uint32_t parent;    /* index of a joint before this one, or PCCD_NO_JOINT */
    double position[3]; /* of the joint in the frame of its parent */
    double rotation[4]; /* x y z w; 0 0 0 1: none */
    double axis[3];     /* of TURN and SLIDE, in the frame of the joint */
    double from[3];     /* at t = 0 */
    double to[3];       /* at t = 1 */
};

/* The settings of an object that are set: bits. */
enum pccd_object_what {
    PCCD_OBJECT_GROUP = 1,
    PCCD_OBJECT_MASK = 2,
    PCCD_OBJECT_SELF = 4,
    PCCD_OBJECT_RADIUS = 8,
    PCCD_OBJECT_REST_DISTANCE = 16,
    PCCD_OBJECT_REST_RINGS = 32,
    PCCD_OBJECT_USER_DATA = 64,
    PCCD_OBJECT_ALL = 2147483647 /* whatever there is to set */
};

/* The kinds of pairs that contacts and candidates are: X(NAME, value, name, points of a,
 * points of b, text). A feature of one point is a vertex, of two an edge, of three a
 * face. A value is never renumbered; new ones go at the end. VE and VV are of free
 * points: with a free edge, and with another free point; in steps only where the two
 * have a distance to keep. An edge is free if no triangle has it, a point if no triangle
 * and no edge has it. */
#define PCCD_KIND_LIST(X)                                                                \
    X(VF, 0, vf, 1, 3, "a vertex of object a, a face of object b")                       \
    X(EE, 1, ee, 2, 2, "an edge of object a, an edge of object b; (object, edge) a < b") \
    X(VE, 2, ve, 1, 2, "a vertex of object a, an edge of object b")                      \
    X(VV, 3, vv, 1, 1, "two vertices; (object, vertex) a < b")

/* Kinds of contact and candidate. */
enum pccd_kind {
#define PCCD_KIND_ENUM(NAME, value, name, points_a, points_b, text) PCCD_##NAME = (value),
    PCCD_KIND_LIST(PCCD_KIND_ENUM)
#undef PCCD_KIND_ENUM
        PCCD_KIND_COUNT /* of them, without gaps */
};

/* Kinds that only answers about what is near have, at one moment; as PCCD_KIND_LIST. Of
 * FEATURES they may also have VE and VV of other vertices and edges. */
#define PCCD_NEAR_KIND_LIST(X)                                                           \
    X(EF, 4, ef, 2, 3, "an edge of object a that passes through a face of object b")

enum pccd_near_kind {
#define PCCD_NEAR_KIND_ENUM(NAME, value, name, points_a, points_b, text)                 \
    PCCD_##NAME = (value),
    PCCD_NEAR_KIND_LIST(PCCD_NEAR_KIND_ENUM)
#undef PCCD_NEAR_KIND_ENUM
};

/* The question about the scene at one moment. */
enum pccd_near_what {
    PCCD_NEAR_PAIRS = 0,     /* VF and EE within the distance; of free points VE and VV */
    PCCD_NEAR_FEATURES = 1,  /* the closest features of these pairs, each once */
    PCCD_NEAR_VERTICES = 2,  /* for each vertex its bound: the least distance of the pairs
                                that it is part of, also as a corner or an end */
    PCCD_NEAR_NEAREST = 3,   /* for each two objects the nearest pair; at distance 0 if
                                they cross: EF, unless something touches, too */
    PCCD_NEAR_CROSSINGS = 4, /* each edge that passes through a face */
    PCCD_NEAR_DEPTH = 5,     /* how deep vertices are in closed meshes of others */
    PCCD_NEAR_COUNT = 6
};

/* Flags of what is near. */
enum pccd_near_flag {
    PCCD_NEAR_GAP = 4u /* NEAREST with a gap: another pair may be nearer by that much */
};

/* Between which parts of its two features the distance of a record is: PCCD_VF, PCCD_EE,
 * PCCD_VE or PCCD_VV. A vertex and a face whose nearest point is a corner have VV. */
#define PCCD_NEAR_TYPE(flags) ((flags) >> 8 & 0xffu)

/* Two features at one moment. Records are sorted by (kind, object_a, feature_a, object_b,
 * feature_b); 64 bytes, as those of contacts.
 *
 * d_lo, d_hi  the exact distance, rounded down and up to 33 significant bits: both are
 *             equal if it has no more bits. EF: 0.
 * param       where the nearest points are, by kind:
 *             VF  weights of the face's second and third vertex
 *             EE  positions along edge a and edge b, 0 at the lower vertex index
 *             VE  0, then the position along the edge
 *             VV  zeros
 *             EF  where along edge a it passes through the face, then 0
 *             They are rounded to multiples of 2^-32, then to floats.
 * direction   unit, from feature b to feature a; zeros at distance 0, and of EF. */
struct pccd_near {
    uint32_t kind;      /* enum pccd_kind or enum pccd_near_kind */
    uint32_t flags;     /* enum pccd_near_flag; bits 8 .. 15: PCCD_NEAR_TYPE */
    uint32_t object_a;  /* handle given by scene.add */
    uint32_t feature_a; /* vertex or edge index in that object's mesh */
    uint32_t object_b;
    uint32_t feature_b; /* vertex, edge or face index */
    double d_lo;
    double d_hi;
    float param[2];
    float direction[3];
    uint32_t count; /* FEATURES: how many records of PAIRS it stands for (those found so
                       far, if a deadline or a cancel ended the answer); else 1 */
};

/* Flags of a contact. */
enum pccd_contact_flag {
    PCCD_PROVED = 1u,  /* it begins in [toi, toi_hi]: all but some that turn */
    PCCD_INITIAL = 2u, /* the features already touch at t = 0, or are within the distance
                          at which they meet (then toi = toi_hi = 0) */
    PCCD_INSIDE = 4u,  /* of a step with approach: at t = 0 they are within that distance;
                          they meet where they come nearer than the part of their first
                          distance that the step allows */
    /* Of a step that tells what becomes of what touches (enum pccd_touching), one of
     * these: just after t = 0 .. */
    PCCD_ENTERS = 8u, /* they approach: the surfaces pass through each other there, or
                         nothing tells their sides apart; or their distance falls */
    PCCD_SLIDES = 16u, /* they go on touching, on two sides of a plane, or as far apart */
    PCCD_LEAVES = 32u  /* they separate */
};

/* The fate of two features that touch at t = 0, or are as near as they meet. */
enum pccd_touching {
    PCCD_TOUCHING_KEPT = 0, /* a contact at t = 0, and no more is said */
    PCCD_TOUCHING_TOLD = 1, /* the same, with PCCD_ENTERS, PCCD_SLIDES or PCCD_LEAVES */
    /* What slides or leaves is no contact then. It is one, with its flag, when it next
     * meets, or is nearer than it began. */
    PCCD_TOUCHING_LEFT_OUT = 2,
    PCCD_TOUCHING_COUNT = 3
};

/* Says if a named scene is made. */
enum pccd_share {
    PCCD_SHARE_CREATE = 0, /* there must be none of that name */
    PCCD_SHARE_OPEN = 1,   /* made unless there is one */
    PCCD_SHARE_ATTACH = 2, /* there must be one */
    PCCD_SHARE_OTHER = 3,  /* there must be one of another user, who is named */
    PCCD_SHARE_COUNT = 4
};

/* Reasons why an answer is not complete. */
enum pccd_incomplete {
    PCCD_COMPLETE = 0,
    PCCD_INCOMPLETE_RESULT_FULL = 1,  /* page ended; go on with the cursor */
    PCCD_INCOMPLETE_DEADLINE = 2,     /* the deadline passed; these records were found */
    PCCD_INCOMPLETE_CANCELLED = 3,    /* cancelled; so were these */
    PCCD_INCOMPLETE_CONTACT_LIMIT = 4, /* more than the daemon keeps: the first of all */
    /* Too much work for pairs of what turns, or too much memory. What is too much work is
     * the same by any number of threads, and so are the records. */
    PCCD_INCOMPLETE_UNDECIDED = 5
};

/* Room for kinds in what counts by kind: kinds that come later need no other struct. */
#define PCCD_KINDS_MAX 8

/* Times of the parts of a step, nanoseconds. By several threads a part ends with the last
 * of them; only `rebuild` is the sum over all threads. */
struct pccd_step_times {
    uint64_t queue;     /* from the request's arrival to its turn */
    uint64_t ingest;    /* copy and check of the positions */
    uint64_t refit;     /* of all boxes */
    uint64_t traversal; /* box tests */
    uint64_t tests;     /* elementary tests: filter and solver */
    uint64_t merge;     /* sort, hash and copy of the records */
    uint64_t step;      /* the whole step, from ingest to merge and what lies between */
    uint64_t low;       /* of traversal + tests: low-level nodes; with stealing: all */
    uint64_t high;      /* of traversal + tests: high-level nodes */
    uint64_t rebuild;   /* reconstruction of subtrees, in the background too */
};

/* Counters of the work of a step. */
struct pccd_step_counters {
    uint64_t task_units; /* tasks; paper: self-CD task units (PCCD, section 4) */
    uint64_t box_tests;  /* pairs of nodes tested */
    uint64_t leaf_pairs; /* pairs of leaves that overlap */
    /* Pairs of features whose boxes overlap, by enum pccd_kind. Except in mode pairs, the
     * method wide may count others: fewer, because it leaves out what lies below nodes
     * that are never together, and a few more, because its boxes are in whole numbers. */
    uint64_t candidates[PCCD_KINDS_MAX];
    uint64_t survivors;         /* candidates that the filter could not reject */
    uint64_t exact;             /* elementary tests that needed exact arithmetic */
    uint64_t builds;            /* hierarchies built during the step */
    uint64_t allocs;            /* allocations made during the step */
    uint64_t rebuilds;          /* subtrees reconstructed during the traversal */
    uint64_t rebuilt_triangles; /* in these; above the objects: objects */
    uint64_t swaps; /* large subtrees and orders of features, made in the background over
                     * several steps, that were put in place */
    uint64_t swapped_triangles; /* in these */
    /* Something stands still if no vertex of it has moved, neither in this step nor in
     * the one before. */
    uint64_t still_features; /* whose boxes were kept from the step before */
    uint64_t still_pairs;    /* pairs of nodes or features left out: neither moves */
    uint64_t kept_records;   /* of pairs that stand, from the last answer of this mode */
    uint64_t rigid_objects;  /* whose poses prove that they do not meet themselves */
    /* Of the candidates, those that meet at a distance above 0; how many of these were
     * asked one by one; how many of these needed exact arithmetic. */
    uint64_t thick_candidates;
    uint64_t thick_survivors;
    uint64_t thick_exact;
};

/* The answer for one scene of a batch (batch.submit, pccd_batch_step). Its numbers are
 * those that a step of the scene by itself answers. */
struct pccd_scene_answer {
    uint32_t scene;      /* handle */
    int32_t status;      /* 0, or why its step failed (enum pccd_status): then the scene
                            stands where it stood, `why` says more, and all else is 0 */
    uint32_t incomplete; /* enum pccd_incomplete */
    uint32_t verdict;    /* enum pccd_verdict */
    uint64_t number;     /* of the step in its scene, from 1; 0: told before its turn */
    uint64_t total;      /* records of the whole answer */
    uint64_t counts[PCCD_KINDS_MAX]; /* records by enum pccd_kind; in mode any 0 */
    uint64_t possible, initial, inside;
    double toi_first; /* smallest toi; 2: no record, or mode any or pairs */
    double safe_step; /* from t = 0 to it no pair meets; 0 where it is not known */
    uint64_t hash[2]; /* of all records: high, low */
    uint64_t count;   /* records that were written to the result region: the first ones;
                           frame.fetch has the others, from `count` on */
    uint64_t offset;  /* of these, bytes from the start of the result region */
    uint64_t ns_step; /* the whole step, nanoseconds */
    uint32_t threads; /* that computed it */
    uint32_t crowded; /* 1: more than half of the records begin at their distance */
    char why[136];    /* "", or a sentence that says why it failed */
};

#define PCCD_HASH_VERSION 2u /* of answers: PROTOCOL.md, "The hash of an answer" */
/* The answer of mode `any`. */
enum pccd_verdict {
    PCCD_VERDICT_NO = 0,
    PCCD_VERDICT_POSSIBLE = 1, /* nothing proved, something undecided */
    PCCD_VERDICT_YES = 2,
    PCCD_VERDICT_NONE = 3 /* other modes, or incomplete before a decision */
};

/* One contact. Records are sorted by (kind, object_a, feature_a, object_b, feature_b).
 *
 * toi, toi_hi  parameter of the step, 0 .. 1. `toi` is never after the first contact.
 *              All are proved but some of bodies that turn: the first contact is in
 *              [toi, toi_hi] and toi_hi - toi <= tolerance; of bodies that turn it may be
 *              more where they come within `resolution` before they are proved to meet:
 *              toi is when they first do. Thick features, those with a radius or a
 *              separation, meet where their distance is at most r, the sum of both radii
 *              and the separation; param and normal are then those of the nearest points
 *              at toi.
 * param        VF: barycentric weights of the face's second and third vertex.
 *              EE: position along edge a and along edge b, 0 at the lower vertex index.
 *              VE: 0, then the position along the edge. VV: zeros.
 * normal       unit, pointing from feature b to feature a as they lie at t = 0; zeros
 *              where the configuration has no direction (coincident features). Of VF a
 *              is the vertex, whichever object has it; manifolds (pccd_points.h) point
 *              from the lower object to the other. */
struct pccd_contact {
    uint32_t kind;      /* enum pccd_kind */
    uint32_t flags;     /* enum pccd_contact_flag */
    uint32_t object_a;  /* handle given by scene.add */
    uint32_t feature_a; /* vertex or edge index in that object's mesh */
    uint32_t object_b;
    uint32_t feature_b; /* vertex, edge or face index */
    double toi;
    double toi_hi;
    float param[2];
    float normal[3];
    uint32_t reserved; /* 0 */
};

/* One candidate of mode `pairs`, in the same order. */
struct pccd_pair {
    uint32_t kind;
    uint32_t object_a;
    uint32_t feature_a;
    uint32_t object_b;
    uint32_t feature_b;
};

/* An edge of a mesh: vertex indices, a < b. Edges are numbered by (b, a). */
struct pccd_edge {
    uint32_t a;
    uint32_t b;
};

#ifdef __cplusplus
}
#endif

#endif
