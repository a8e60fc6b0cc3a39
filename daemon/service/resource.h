/* resource.h - what a session holds and the compute thread uses.
 *
 * Room:     service. May include: compute.h, handles.h, the engine's and protocol's
 *           headers.
 * Does:     count the references of shapes, scenes and rings; when the last one goes,
 *           free the engine's part on the compute thread and the rest on the loop.
 * Does not: look anything up for a client (session.h).
 * Threads:  members and functions say.
 */
#ifndef SRV_RESOURCE_H
#define SRV_RESOURCE_H

#include <stdatomic.h>
#include <stdint.h>

#include "codec.h"
#include "compute.h"
#include "handles.h"
#include "messages.h"
#include "step.h"

struct srv_diary;
struct srv_held;
struct srv_mesh;
struct srv_seat;
struct srv_session;
struct srv_shared;

/* The common start of a shape, a scene and a ring. */
struct srv_resource {
    struct srv_job reap; /* first: the job is the resource */
    srv_job_fn free_engine;
    bool
        is_ring; /* freed on the thread that makes rings; nothing of it is the engine's */
    struct srv_session *session;
    uint32_t refs; /* [loop] the session's table, and each request in flight */
};

/* One reference. `free_engine` runs on [compute], `free_rest` on [loop]. */
void srv_resource_init(struct srv_resource *resource, struct srv_session *session,
                       srv_job_fn free_engine, srv_job_fn free_rest);
void srv_resource_acquire(struct srv_resource *resource); /* [loop] */
void srv_resource_drop(struct srv_resource *resource);    /* [loop] */

/* Vertices and triangles as they were announced: a mesh, or what will replace one. */
struct srv_shape {
    struct srv_resource resource;
    uint32_t vertex_count;
    uint32_t triangle_count;
    struct eng_mesh *engine; /* [compute]; NULL until the first data arrive */
};

/* A shape of these counts, charged to the session's user as one mesh and its triangles.
 * Returns 0, or PCCD_E_INVAL, PCCD_E_QUOTA or PCCD_E_NOMEM with *error set. [loop] */
int srv_shape_admit(struct srv_session *session, uint32_t vertex_count,
                    uint32_t triangle_count, struct srv_shape **shape,
                    struct proto_error *error);
/* The engine's mesh, made when there is none. Returns a wire status. [compute] */
int srv_shape_engine(struct srv_shape *shape, struct eng_mesh **engine);

/* An object of a scene as the loop sees it. */
struct srv_object {
    uint32_t handle;
    uint64_t charge;             /* triangles, of the owner's user */
    struct srv_session *owner;   /* that added it */
    const struct srv_seat *seat; /* with which it did (shared.h); NULL: its own scene */
    uint64_t group;              /* what it may meet, as was answered last */
    uint64_t mask;
    bool self;
    struct srv_shape *lent;  /* in a scene of another user: kept for as long as the
                                * object, so that each frees what is charged to it */
    struct srv_mesh *mesh;   /* it is made of; NULL: mesh or scene was destroyed since */
    struct srv_object *prev; /* of the same mesh */
    struct srv_object *next;
};

/* The same as the compute thread sees it. */
struct srv_placed {
    uint32_t handle; /* 0: none here */
    uint32_t engine_idx;
    uint32_t vertex_count;
    uint32_t generation; /* of the mesh when the object got this shape */
    uint64_t mesh_number;
    const struct srv_seat *seat; /* as the loop's */
};

struct srv_scene {
    struct srv_resource resource;
    struct srv_handles objects;          /* [loop] of struct srv_object */
    uint32_t freed;                      /* [loop] where in `objects` freeing them is */
    struct eng_scene_settings settings;  /* does not change */
    struct proto_LIST_SCENE_result told; /* [loop] its steps, and the last of them */
    struct srv_shared *shared;           /* likewise; NULL: its session's alone */
    struct srv_claim claim;        /* the compute queue's: one job uses it at a time */
    _Atomic uint32_t ignored_told; /* pairs; stored on [compute], told on [loop] */
    /* [compute], by who has claimed it */
    struct eng_scene *engine;  /* NULL until the first object or step */
    struct srv_placed *placed; /* by index of the object's handle */
    uint32_t placed_count;
    struct proto_error owed;   /* of a step that was answered before; code 0: none. A seat
                              * has its own */
    struct srv_held *held;     /* frames for its next step (held.h), oldest first */
    struct srv_diary *diaries; /* of what is done to it (diary.h) */
    uint64_t changes;          /* objects that went, or got another shape */
    uint64_t number;           /* of its last step */
    uint64_t stepper;          /* number of the session that submitted that */
    bool has_answer;           /* `records` and `answer` are of the last step */
    const void *records;
    struct proto_FRAME_SUBMIT_result answer; /* but for the page */
};

/* NULL: no memory. [loop] */
struct srv_scene *srv_scene_new(struct srv_session *session,
                                const struct eng_scene_settings *settings);
/* The scene has got its handle: from it follow the first handles of its objects. Those of
 * one session's scenes differ; those of a scene that is made again under the same handle
 * are the same again. [loop] */
void srv_scene_name(struct srv_scene *scene, uint32_t handle);
int srv_scene_engine(struct srv_scene *scene, struct eng_scene **engine); /* [compute] */

/* Room for an object with that handle. Returns 0 or PCCD_E_NOMEM. [compute] */
int srv_scene_reserve(struct srv_scene *scene, uint32_t handle);
/* The object, or NULL: never placed, or removed. [compute] */
struct srv_placed *srv_scene_find(struct srv_scene *scene, uint32_t handle);
/* Its ignored pairs have changed in number. [compute] */
void srv_scene_count_ignored(struct srv_scene *scene);
/* Take a placed object out of the engine's scene. [compute] */
void srv_scene_displace(struct srv_scene *scene, struct srv_placed *placed);

/* A handle for a new object made of a mesh of `session`, which takes part with `seat`
 * (NULL: the scene is its own), its quota charged; *object says which is wanted, 0: any.
 * Returns 0, or PCCD_E_QUOTA, PCCD_E_LIMIT, PCCD_E_HANDLE or
 * PCCD_E_NOMEM with *error set. [loop] */
int srv_scene_admit(struct srv_scene *scene, struct srv_session *session,
                    const struct srv_seat *seat, struct srv_mesh *mesh, uint32_t *object,
                    struct proto_error *error);
/* Forget an object, whose handle is known: refund it and free the loop's part. [loop] */
void srv_scene_forget(struct srv_scene *scene, uint32_t object);
/* The same of all that were added with that seat. [loop] */
void srv_scene_forget_of(struct srv_scene *scene, const struct srv_seat *seat);
/* The session's handle of the scene was given back: the objects that it has added with
 * that seat, NULL: its own scene's, are no meshes' any more. [loop] */
void srv_scene_unlink_of(struct srv_scene *scene, const struct srv_seat *seat);

#endif
