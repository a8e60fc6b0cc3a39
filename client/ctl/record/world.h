/* client/ctl/record/world.h - what a recorded session had, and where it was.
 *
 * Room:     client/ctl. May include: error.h, world_pairs.h, client/record/reader.h.
 * Does:     follow the chunks of a recording: meshes, scenes, objects, the positions at
 *           both ends of the last step, exactly as the daemon takes them.
 * Does not: read files (reader.h) or talk to a daemon (drive.h).
 * Threads:  one.
 * Source:   proto/PROTOCOL.md, "A step".
 */
#ifndef CTL_WORLD_H
#define CTL_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"
#include "reader.h"
#include "world_pairs.h"

struct world_mesh {
    struct world_mesh *next;
    uint32_t handle;
    bool is_gone;        /* destroyed, but objects are left */
    uint32_t user_count; /* objects */
    uint32_t format;     /* as registered */
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t edge_count;
    double (*x)[3]; /* as registered */
    uint32_t (*triangles)[3];
    uint32_t (*edges)[2]; /* numbered as in the records; NULL: not asked for yet */
};

struct world_object {
    uint32_t handle;
    struct world_mesh *mesh;
    double (*x0)[3]; /* at the start of the last step, and at its end */
    double (*x1)[3];
    bool has_moved; /* it is not where its mesh was registered */
    bool self;      /* it may meet itself */
    uint64_t group; /* as pccd_object_set says */
    uint64_t mask;
};

struct world_scene {
    struct world_scene *next;
    uint32_t handle;
    struct record_scene settings;
    struct world_object *objects; /* in the order in which they came */
    uint32_t object_count;
    uint32_t object_room;
    struct world_pairs ignored;
};

struct world {
    struct world_mesh *meshes; /* in the order in which they came */
    struct world_scene *scenes;
};

/* Follow a chunk that is not a step. PCCD_E_FORMAT when it speaks of what there is not;
 * PCCD_E_NOMEM. Kinds that change nothing are let by. */
int world_follow(struct world *world, const struct record_view *view,
                 struct ctl_error *error);
/* A step that the daemon took: x0 and x1 of the scene's objects. `slot` is the payload
 * behind `frame`. Nothing changes on failure. */
int world_step(struct world *world, const struct record_frame *frame, const uint8_t *slot,
               struct ctl_error *error);
void world_deinit(struct world *world);

struct world_scene *world_scene(const struct world *world, uint32_t handle);
struct world_object *world_object(const struct world_scene *scene, uint32_t handle);
/* Whether these two objects, or this one and itself, were tested against each other. */
bool world_may_meet(const struct world_scene *scene, const struct world_object *a,
                    const struct world_object *b);
/* The one that is not gone. */
struct world_mesh *world_mesh(const struct world *world, uint32_t handle);
/* Its edges as records number them, made at the first call. */
int world_edges(struct world_mesh *mesh, struct ctl_error *error);

#endif
