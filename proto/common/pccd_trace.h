/* pccd_trace.h - what a daemon shows of its work: the events of a trace, and boxes of the
 * trees.
 *
 * Room:     common; installed beside pccd.h. May include: the C library. Compiles as C++.
 * Does:     define kinds and layout of what trace.dump and scene.boxes write to the
 *           result region.
 * Does not: declare functions.
 */
#ifndef PCCD_TRACE_H
#define PCCD_TRACE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The subject of an event. Times nest or are disjoint among the events of one thread of
 * the team (the threads that share a step), and among RECEIVE and ANSWER; requests of a
 * client may overlap. */
enum pccd_trace_kind {
    /* thread: of the team, from 0, the one that computes */
    PCCD_TRACE_STEP = 0,    /* a whole step; a: triangles, b: threads */
    PCCD_TRACE_REFIT = 1,   /* a thread's part of it */
    PCCD_TRACE_UNIT = 2,    /* self-CD task unit; a: node, b: triangles below it */
    PCCD_TRACE_SUBTREE = 3, /* all units below a node; a: node, b: triangles */
    PCCD_TRACE_PAIRS = 4,   /* what a pair of nodes leads to; a, b: nodes */
    PCCD_TRACE_HIGH = 5,    /* a thread's part of a high-level node; a: node, b: pairs */
    PCCD_TRACE_TESTS = 6,   /* elementary tests; a: enum pccd_kind, b: candidates */
    PCCD_TRACE_REBUILD = 7, /* reconstruction; a: node, b: triangles */
    PCCD_TRACE_BACKGROUND =
        8, /* a share of a subtree built in the background; a: node, b: triangles */
    PCCD_TRACE_WAIT = 9,   /* without work */
    PCCD_TRACE_MERGE = 10, /* sort, gather, hash */
    /* thread: number of the session, a: number of the method, UINT32_MAX: none of
     * these, b: id of the message */
    PCCD_TRACE_REQUEST = 11, /* a client's request, from its arrival to its answer */
    PCCD_TRACE_RECEIVE = 12, /* the loop reads it */
    PCCD_TRACE_ANSWER = 13,  /* the loop sends the answer */
    PCCD_TRACE_KIND_COUNT = 14
};

/* One event of a trace. */
struct pccd_trace_event {
    uint64_t begin_ns; /* CLOCK_MONOTONIC */
    uint64_t end_ns;
    uint32_t kind; /* enum pccd_trace_kind */
    uint32_t thread;
    uint32_t a;
    uint32_t b;
};

/* A tree of a scene's hierarchies. */
enum pccd_tree {
    PCCD_TREE_VERTICES = 0, /* of the method wide: up to 16 children a node */
    PCCD_TREE_EDGES = 1,
    PCCD_TREE_FACES = 2,
    PCCD_TREE_TRIANGLES = 3, /* of the method paper: binary */
    PCCD_TREE_COUNT = 4
};

/* A box of such a tree at the start and at the end of a step: it contains what is below
 * it at both, and in between the box in between. One with low0 > high0 is empty. */
struct pccd_box {
    float low0[3];
    float high0[3];
    float low1[3];
    float high1[3];
};

#ifdef __cplusplus
}
#endif

#endif
