/* inspect.h - packs the steps of a recording into the page of `pccdctl inspect`. */
#ifndef CTL_INSPECT_H
#define CTL_INSPECT_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "option_table.h"
#include "pccd.h"
#include "play.h"
#include "whole_file.h"

/* ---- A growing array of bytes, divided into sections. */

#define BYTES_ALIGN 4u /* of the arrays of a script */

struct bytes {
    uint8_t *at; /* ours */
    size_t used, room;
    bool is_short; /* there was no memory: what is here is not all */
};

/* Begin a section of `count` bytes, zeros, at *offset. Returns its memory, valid until
 * the next call, or NULL without memory. */
void *bytes_section(struct bytes *bytes, size_t count, size_t *offset);
void bytes_empty(struct bytes *bytes);
/* Make `packed`, in the place of what it held, the bytes compressed as browsers unpack
 * them: a stream of zlib. False without memory. */
bool bytes_pack(const struct bytes *bytes, struct bytes *packed);
void bytes_deinit(struct bytes *bytes);

/* ---- Writes an HTML page with binary data inside. */

#define PAGE_FILE_MARK "<!--pccd:data-->"

struct page_file {
    FILE *to;         /* the caller's */
    const char *path; /* for messages */
    const char *rest; /* of the template, behind the mark */
    size_t rest_bytes;
    uint64_t bytes; /* of the file, with the rest but without the JSON text */
    uint32_t blob_count;
};

/* Write the template up to its mark. E_FORMAT: it has none; E_SYSTEM. */
int page_file_begin(struct page_file *page, FILE *to, const char *path,
                    const char *template, size_t template_bytes, struct ctl_error *error);
/* Write one more piece of data, as base64 of what bytes_pack has packed; the first is
 * number 0. */
int page_file_blob(struct page_file *page, const void *bytes, size_t count,
                   struct ctl_error *error);
/* Write the JSON text, and the rest of the template; the file is flushed, not closed. */
int page_file_finish(struct page_file *page, const json_t *meta, struct ctl_error *error);

/* Return how many bytes of the file a blob, or a JSON value, takes. */
uint64_t page_file_blob_bytes(size_t count);
uint64_t page_file_json_bytes(const json_t *value);

/* ---- The layout of the data in the page of `pccdctl inspect`.
 *
 * Numbers in the data are little-endian. A section is [blob, offset] in JSON; arrays:
 *     triangles  u32[3], or u16[3] of a mesh with at most 65536 vertices
 *     edges      u32[2] of rods, points u32: what nothing else of the mesh has
 *     radii      f32 of vertices, in the page's unit
 *     positions  f32[3] relative to the page's origin, in its unit; or, rounded,
 *                f32[3] low, f32[3] step, then u16[3] in which x = low + step * number
 *     joints     struct pccd_joint, as recorded
 *     contacts   of each column all: toi f64, u and v f32[2], feature_a u32, feature_b
 *                u32, object_a u16, object_b u16 (places in the step's list of objects),
 *                normal i16[3] (-32767 .. 32767 for -1 .. 1), flags u8
 *                (enum pccd_contact_flag | enum pccd_kind << INSPECT_KIND_SHIFT)
 *     boxes      struct pccd_box, in the same way as positions
 *     lines      struct inspect_line; events: struct inspect_event */

struct inspect_settings {
    uint64_t every;     /* of the steps that are played, one in so many; >= 1 */
    uint64_t bytes_max; /* of the file */
    uint32_t boxes_max; /* of a level of a hierarchy that is shown; 0: none is */
    bool is_rounded;    /* positions in 16 bits each */
    uint32_t up;        /* 1 x, 2 y, 3 z (play_up) */
    bool is_of_files;   /* and not of a recording */
    struct option_arguments between; /* --between; the caller's */
    bool has_no_self;                /* --no-self */
};

#define INSPECT_KIND_SHIFT 6u

struct inspect {
    struct inspect_settings settings;
    struct page_file *page; /* the caller's, begun */
    json_t *steps, *meshes; /* ours: arrays */
    json_t *left_out;       /* ours: what is told of steps that --every leaves out */
    uint64_t meta_bytes;    /* of these, in the file */
    uint64_t pairs_bytes;   /* of them, counts of pairs of objects */
    uint64_t first, last;   /* steps in the file; 0: none */
    uint64_t seen, kept;
    uint64_t differ;   /* answers other than the recorded ones */
    uint64_t lost;     /* events */
    bool is_full;      /* steps are missing: there was no room */
    bool has_origin;
    double origin[3]; /* the middle of the first step */
    double unit;      /* of lengths: 1, or the size of what is very small or large */
    struct bytes data, packed;
    struct pccd_box *boxes; /* [boxes_max] of a level; NULL: not needed yet */
    struct inspect_place *places;
    uint32_t place_count;
    size_t place_room;
    struct inspect_mesh *known;
    uint32_t known_count;
    size_t known_room;
    char no_lanes[STEP_TRACE_TEXT]; /* why there are none; "" */
};

/* ---- Packs one part of a step (positions, contacts, boxes, events) for the
 * page of `pccdctl inspect`.
 *
 * All append to inspect->data and return a new reference, or NULL without memory. */

/* Ends of a step at which inspect_pack_objects packs objects. */
enum inspect_moment { INSPECT_BEGIN, INSPECT_END, INSPECT_BOTH };
/* Return [{"handle", "number", "name", "mesh", "x0", "x1", "radius", "joint"}] of a
 * scene; x0 and x1 are at both ends of its step, or both at one of them; "name" is null
 * of what has none, "joint" of what goes straight.
 * `meshes` gets those that are not in the file yet. Edges of the scene's meshes are
 * known. */
json_t *inspect_pack_objects(struct inspect *inspect, const struct registry_scene *scene,
                             enum inspect_moment moment, json_t *meshes);
/* Return {"at", "count"} of the joints of a step. */
json_t *inspect_pack_joints(struct inspect *inspect,
                            const struct recorded_joints *joints);
/* Return {"at", "count"} of the contacts, or of the pairs of mode pairs, as contacts at
 * t = 0. */
json_t *inspect_pack_contacts(struct inspect *inspect, const struct play_step *step);
/* Return [a, b, count, ..]: how many records each two objects have, by their "number".
 * null: that is not known, or the page has no room for it. */
json_t *inspect_pack_pairs(struct inspect *inspect, const struct play_step *step);
/* Return "vertex 17 of ball meets face 3 of cloth", of the contact of a step that comes
 * first; null: it has none. */
json_t *inspect_first_pair(const struct play_step *step);
/* Return {"at", "count"} of what is near, or of the vertices that have something near. */
json_t *inspect_pack_lines(struct inspect *inspect, const struct play_step *near);
/* Return {"at", "count", "threads", "ns", "lost"}, or null: it was not recorded. */
json_t *inspect_pack_events(struct inspect *inspect, const struct step_trace *trace);
/* Return {TREE: [{"at", "count"}], ..} of what the step used, each level, the root
 * first. */
json_t *inspect_pack_boxes(struct inspect *inspect, const struct play_step *step);

/* Return [blob, offset] of a section of the step that is being packed. */
json_t *inspect_section(const struct inspect *inspect, size_t offset);

/* ---- The HTML page of `pccdctl inspect`, without data. */

/* Return the page, *bytes long. NULL: this program was built without it. */
const char *page_template(size_t *bytes);

/* Return PCCD_OK if there is one. Errors: E_SYSTEM, which says how to get it. */
int inspect_has_page(struct ctl_error *error);

#define INSPECT_BOXES_DEFAULT 512u
#define INSPECT_BYTES_DEFAULT (64u << 20)
#define INSPECT_MIB           (1u << 20)
#define INSPECT_MIB_MAX       2048u /* browsers do not open much more */

/* Begin the page `path` with it, written to `to`; as page_file_begin. */
int inspect_begin_page(struct page_file *page, FILE *to, const char *path,
                       struct ctl_error *error);
int inspect_init(struct inspect *inspect, const struct inspect_settings *settings,
                 struct page_file *page, struct ctl_error *error);
/* Add a step or a question about what is near to the page, as a play_fn whose context is
 * the inspect. Ends the playing when the file is full. */
int inspect_step(void *inspect, const struct play_step *step, struct ctl_error *error);
/* Write the rest of the file. `name`: of the recording; any bytes. */
int inspect_finish(struct inspect *inspect, const char *name,
                   const struct play_summary *summary, struct ctl_error *error);
void inspect_deinit(struct inspect *inspect);

/* Adds the steps of a page to it, by inspect_step; *all: how many they are, if there were
 * room. Called once more where there was not. */
typedef int (*inspect_fill_fn)(void *context, struct inspect *inspect,
                               struct play_summary *summary, uint64_t *all,
                               struct ctl_error *error);
struct inspect_source {
    const char *path; /* of the page */
    const char *name; /* of what is shown; any bytes */
    inspect_fill_fn fill;
    void *context;
};
/* Write the page of all that the source adds to it. If not all of it has room, one step
 * in so many is shown, evenly, and settings.every says so: a page that ended early would
 * hide what comes then. A file that is written straight away is written once. `file`,
 * before {NULL}, is the caller's to finish; so is the inspect, also after an error. */
int inspect_write(struct inspect *inspect, const struct inspect_settings *settings,
                  const struct inspect_source *source, struct whole_file *file,
                  struct play_summary *summary, struct ctl_error *error);

#endif
