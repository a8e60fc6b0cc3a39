/* inspect_data.h - the layout of the data in the page of `pccdctl inspect`.
 *
 * Threads: one.
 *
 * Numbers in the data are little-endian. A section is [blob, offset] in JSON; arrays:
 *     triangles  u32[3], or u16[3] of a mesh with at most 65536 vertices
 *     edges      u32[2] of rods, points u32: what nothing else of the mesh has
 *     radii      f32 of vertices, in the page's unit
 *     positions  f32[3] relative to the page's origin, in its unit; or, rounded,
 *                f32[3] low, f32[3] step, then u16[3] in which x = low + step * number
 *     contacts   struct inspect_contact; boxes: struct pccd_box, in the same way
 *     lines      struct inspect_line; events: struct inspect_event
 */
#ifndef CTL_INSPECT_DATA_H
#define CTL_INSPECT_DATA_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "bytes.h"
#include "page_file.h"
#include "pccd.h"
#include "step_trace.h"

struct inspect_settings {
    uint64_t every;     /* of the steps that are played, one in so many; >= 1 */
    uint64_t bytes_max; /* of the file */
    uint32_t boxes_max; /* of a level of a hierarchy that is shown; 0: none is */
    bool is_rounded;    /* positions in 16 bits each */
};

/* 24 bytes. */
struct inspect_contact {
    uint32_t feature_a, feature_b;
    uint16_t object_a, object_b; /* places in the step's list of objects */
    float toi;
    uint16_t param[2]; /* 0 .. 65535 for 0 .. 1 */
    int8_t normal[3];  /* -127 .. 127 for -1 .. 1 */
    uint8_t flags;     /* enum pccd_contact_flag | enum pccd_kind << INSPECT_KIND_SHIFT */
};
#define INSPECT_KIND_SHIFT 6u

/* 32 bytes: of what is near, the nearest points; of a crossing, the ends of its edge. */
struct inspect_line {
    float ends[2][3]; /* relative to the page's origin, in its unit */
    float distance;   /* d_lo */
    uint32_t kind;    /* enum pccd_kind, enum pccd_near_kind */
};

/* 20 bytes. */
struct inspect_event {
    uint32_t begin_ns, duration_ns; /* from the step's begin */
    uint32_t kind_thread;           /* enum pccd_trace_kind | thread << 8 */
    uint32_t a, b;
};

/* Where an object was last, so that what stands still is written once. */
struct inspect_place {
    uint32_t scene, object;
    uint64_t hash[2]; /* XXH3-128 of the section */
    uint32_t blob;
    size_t offset;
};

/* A mesh that is in the file. */
struct inspect_mesh {
    uint64_t hash[2]; /* XXH3-128 of those of its triangles, rods, points and radii */
    uint32_t vertex_count, triangle_count;
};

struct inspect {
    struct inspect_settings settings;
    struct page_file *page; /* the caller's, begun */
    json_t *steps, *meshes; /* ours: arrays */
    uint64_t meta_bytes;    /* of both, in the file */
    uint64_t first, last;   /* steps in the file; 0: none */
    uint64_t seen, kept;
    uint64_t left_out; /* steps of `seen` that --every leaves out */
    uint64_t differ;   /* answers other than the recorded ones */
    uint64_t lost;     /* events */
    bool is_full;      /* steps are missing: there was no room */
    bool has_origin;
    double origin[3]; /* the middle of the first step */
    double unit;      /* of lengths: 1, or the size of what is very small or large */
    struct bytes data;
    struct pccd_box *boxes; /* [boxes_max] of a level; NULL: not needed yet */
    struct inspect_place *places;
    uint32_t place_count;
    size_t place_room;
    struct inspect_mesh *known;
    uint32_t known_count;
    size_t known_room;
    char no_lanes[STEP_TRACE_TEXT]; /* why there are none; "" */
};

#endif
