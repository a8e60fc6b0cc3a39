/* proto_limits.h - every limit of the protocol, by name. */
#ifndef PROTO_LIMITS_H
#define PROTO_LIMITS_H

#define PROTO_VERSION_MIN 1u /* oldest protocol version this build speaks */
#define PROTO_VERSION_MAX 1u /* newest */

/* Messages. */
#define PROTO_MESSAGE_BYTES_MAX  65536u /* one SEQPACKET datagram */
#define PROTO_DEPTH_MAX          16u    /* nesting of MessagePack containers */
#define PROTO_ELEMENTS_MAX       4096u  /* MessagePack objects in one message */
#define PROTO_STR_MAX            255u   /* bytes of a string field */
#define PROTO_MESSAGES_PER_TURN  4u     /* read from one client before the others' turn */
#define PROTO_REPLIES_QUEUED_MAX 16u    /* then the client is not read until it reads */
#define PROTO_REPLIES_KEPT       32u    /* of a resumable session, to be sent again */
#define PROTO_LINGER_S           5u     /* that such a session waits for its client */

/* Steps that may wait for a client that watches; more are lost, and counted. */
#define PROTO_WATCH_ROOM 128u

/* Upload ring and result region. */
#define PROTO_SLOTS_MAX        16u
#define PROTO_INFLIGHT_MAX     16u
#define PROTO_SEGMENTS_MAX     65536u /* segments of one step, or of one batch */
#define PROTO_BATCH_MAX        65536u /* scenes of one batch */
#define PROTO_JOINTS_MAX       65536u /* joints of one table */
#define PROTO_SLOT_BYTES_MIN   4096u
#define PROTO_RESULT_BYTES_MIN 65536u

/* Recordings: events of each thread, and of the loop. */
#define PROTO_TRACE_EVENTS     65536u
#define PROTO_TRACE_EVENTS_MAX (1u << 20)
#define PROTO_TRACE_BYTES_MAX  (256ull << 20) /* of all of them */

/* Geometry. */
#define PROTO_COUNT_MAX      2147483647u /* vertices, triangles or edges of a scene */
#define PROTO_COORDINATE_MAX 1e18        /* |x| <= this; radii and distances, too */
#define PROTO_REST_RINGS_MAX 8u

/* Default quotas of one uid, charged before allocation; options change them. */
#define PROTO_CLIENTS_PER_UID   64u
#define PROTO_SHM_BYTES_PER_UID (512ull << 20) /* or an eighth of the machine's memory */
#define PROTO_MESHES_PER_UID    131072u        /* two for each scene of a batch */
#define PROTO_TRIANGLES_PER_UID 256000000ull   /* of meshes */
#define PROTO_SCENES_PER_CLIENT 65536u /* as many as a batch has */
#define PROTO_SHARED_PER_CLIENT 64u    /* of these, shared with others */
#define PROTO_OBJECTS_PER_SCENE 65536u
#define PROTO_IGNORED_PER_SCENE                                                          \
    (1u << 18)                              /* pairs of objects that ignore each other,
                                             or have a clearance */
#define PROTO_STEP_MAX_MS       86400000u   /* that a step may be let compute: a day */
#define PROTO_CONTACTS_PER_STEP (16u << 20) /* records the daemon keeps for one answer */

#endif
