/* recorded_state.h - the meshes, scenes and positions at one point of a recording. */
#ifndef CTL_RECORDED_STATE_H
#define CTL_RECORDED_STATE_H

#include "error.h"
#include "pccd.h"
#include "place.h"
#include "reader.h"
#include "registry.h"

/* ---- A step, or a question about what is near, as it was asked. */

struct recorded_item {
    bool is_near;
    struct record_frame frame; /* its step is 0: another client's */
    const uint8_t *slot;       /* the segments, and what they move */
};

/* Take the chunk of an item. False: it is none; the item stays as it was. `slot` is in
 * the view's payload. */
bool recorded_item_take(struct recorded_item *item, const struct record_view *view);

/* The joints on which objects turn in an item: those of all its tables, in their order,
 * with parents among all of them. All zero: none. */
struct recorded_joints {
    struct pccd_joint *items; /* ours: [count] */
    uint32_t count;
    uint32_t base; /* index of the first of the last table */
    uint64_t at;   /* of that in the slot */
};
/* Take the joint that a segment hangs an object on, with its table if that is the next
 * one; *index gets it. False: no memory. */
bool recorded_joints_take(struct recorded_joints *joints, const uint8_t *slot,
                          const struct record_segment *segment, uint32_t *index);
/* Take those of all segments, in the place of what there is. False: no memory. */
bool recorded_joints_of(const struct recorded_item *item, struct recorded_joints *joints);
void recorded_joints_deinit(struct recorded_joints *joints);

/* ---- Everything else, in a registry that follows both ends of the last steps. */

/* Follow a chunk that is not of an item. PCCD_E_FORMAT when it speaks of what there is
 * not; PCCD_E_NOMEM. Kinds that change nothing are let by. */
int recorded_state_follow(struct registry *state, const struct record_view *view,
                          struct ctl_error *error);
/* Return what pair number `i` of a chunk of PAIRS says. */
struct registry_pair recorded_pair(const struct record_view *view, uint32_t i);
/* Move what an item moves, exactly as the daemon computes it: x0 and x1 of the scene's
 * objects. Nothing changes on failure. */
int recorded_state_move(struct registry *state, const struct recorded_item *item,
                        struct ctl_error *error);

/* ---- Features of its meshes. */

/* Make the edges of a mesh as records number them, and find what is free, at the first
 * call. Errors: E_NOMEM. */
int recorded_edges(struct registry_mesh *mesh, struct ctl_error *error);
/* Return whether a vertex (points 1) or an edge (2) is free: an edge that no triangle
 * has, a point that is named and that no triangle and no edge has. The mesh's edges were
 * made. */
bool recorded_is_free(const struct registry_mesh *mesh, uint32_t points,
                      uint32_t feature);
/* Return how many features of a mesh have so many points; then the vertices of one, NULL
 * if there is none of that index. A vertex is its own. The mesh's edges were made. */
uint32_t recorded_feature_count(const struct registry_mesh *mesh, uint32_t points);
const uint32_t *recorded_feature(const struct registry_mesh *mesh, uint32_t points,
                                 const uint32_t *feature);
/* Return the vertices of a feature of an object, NULL if there is none; set *ends to
 * where they are at both ends of the scene's last step. */
const uint32_t *recorded_place(const struct registry_object *object, uint32_t points,
                               const uint32_t *feature, struct place_feature *ends);
/* Return whether two features of one mesh, by their vertices, have a vertex in common. */
bool recorded_share_vertex(const uint32_t *a, uint32_t count_a, const uint32_t *b,
                           uint32_t count_b);
/* Return the radius of a feature that has these vertices: the object's, or, where that is
 * 0, the greatest of theirs. */
double recorded_radius(const struct registry_object *object, const uint32_t *v,
                       uint32_t count);
/* Find the box around all vertices of a scene at a time of its last step; of no object,
 * from INFINITY to -INFINITY. */
void recorded_bounds(const struct registry_scene *scene, double t, double low[3],
                     double high[3]);
/* Find where a record of what is near lies, at the end of the scene's step that was asked
 * about, 0 or 1; edges of its meshes were made. Return false if it names what there is
 * not. */
bool recorded_near_line(const struct registry_scene *scene, const struct pccd_near *near,
                        uint32_t end, double ends[2][3]);

#endif
