/* srv_scene.h - a scene as the service sees it: the engine's scene, its objects and
 * their handles.
 */
#ifndef SRV_SCENE_H
#define SRV_SCENE_H

#include <stdatomic.h>
#include <stdint.h>

#include "codec.h"
#include "engine.h"
#include "handles.h"
#include "meshes.h"
#include "messages.h"
#include "resource.h"

struct srv_journal;
struct srv_held_frame;
struct srv_session;
struct srv_shared;

/* The part of an object's next step that the engine has before that is submitted:
 * proto_direct.h. */
enum srv_mapped { SRV_MAPPED_NOTHING, SRV_MAPPED_X1, SRV_MAPPED_X0X1 };

/* An object (meshes.h) as the compute thread sees it. */
struct srv_placed {
    uint32_t handle; /* 0: none here */
    uint32_t engine_idx;
    uint32_t vertex_count;
    uint32_t generation; /* of the mesh when the object got this shape */
    uint64_t mesh_number;
    const struct srv_member *member; /* as the loop's */
    struct common_attributes attributes;
    char *name; /* for journals; NULL: it has none */
    enum srv_mapped mapped;
};

/* An answer, whose records the engine keeps until the next one to such a request. */
struct srv_kept {
    bool is_there;
    uint64_t asker; /* number of the session that asked */
    const void *records;
    struct proto_answer answer; /* but for the page */
};

/* The motion of a step, as clients have sent it: for journals. All zero: nothing was
 * sent, and nothing may be. */
struct srv_sent {
    uint8_t *slot; /* the payload of a slot that holds it all */
    uint64_t bytes;
    uint64_t room;
    uint64_t bytes_max;
    uint64_t segments_max; /* its table has room for */
    uint32_t segments;     /* are in there */
    int status;            /* 0, or why not all is here: PCCD_E_LIMIT, PCCD_E_NOMEM */
};

struct srv_scene {
    struct srv_resource resource;
    struct srv_handles objects;           /* [loop] of struct srv_object */
    uint32_t freed;                       /* [loop] where in `objects` freeing them is */
    struct eng_scene_settings settings;   /* does not change */
    struct proto_LIST_SCENE_result stats; /* [loop] its steps, and the last of them */
    struct srv_shared *shared;            /* [loop] NULL: its session's alone */
    uint64_t batch;                 /* [loop] number of the last one that named it */
    struct srv_claim claim;         /* the compute queue's: one job uses it at a time */
    _Atomic uint32_t ignored_pairs; /* stored on [compute], read on [loop] */
    /* [compute], by who has claimed it */
    struct eng_scene *engine;  /* NULL until the first object or step */
    struct srv_placed *placed; /* by index of the object's handle */
    uint32_t placed_count;
    bool has_mapped;         /* some of these are */
    struct proto_error owed; /* of a step that was answered before; code 0: none. A member
                              * has its own */
    struct srv_held_frame *held;  /* frames for its next step (held.h), oldest first */
    struct srv_journal *journals; /* of what is done to it (srv_journal.h) */
    struct srv_sent sent;         /* what the staging that is open moves, for these */
    uint64_t changes;             /* objects that went, or got another shape */
    uint64_t number;              /* of its last step */
    struct srv_kept stepped;      /* its last step's */
    struct srv_kept near;         /* its last scene.near's */
    uint64_t expected; /* records of the next step: as many, or what its client said */
    bool is_placed; /* its last step only brought objects back: where the one began that
                     * had brought them there is not known */
};

/* Forget the answers that the scene keeps, as the engine forgets their records.
 * [compute] */
void srv_scene_forget_answers(struct srv_scene *scene);

/* Make a scene. NULL, with *error set: no memory, or more than its user may have.
 * [loop] */
struct srv_scene *srv_scene_new(struct srv_session *session,
                                const struct eng_scene_settings *settings,
                                struct proto_error *error);
/* Tell a scene the handle that it has got: from it follow the first handles of its
 * objects. Those of one session's scenes differ; those of a scene that is made again
 * under the same handle are the same again. [loop] */
void srv_scene_name(struct srv_scene *scene, uint32_t handle);
int srv_scene_engine(struct srv_scene *scene, struct eng_scene **engine); /* [compute] */

/* Make room for an object with that handle. Returns 0 or PCCD_E_NOMEM. [compute] */
int srv_scene_reserve(struct srv_scene *scene, uint32_t handle);
/* Return the object, or NULL: never placed, or removed. [compute] */
struct srv_placed *srv_scene_find(struct srv_scene *scene, uint32_t handle);
/* Note how many ignored pairs it has, after that has changed. [compute] */
void srv_scene_count_ignored(struct srv_scene *scene);
/* Take a placed object out of the engine's scene, and forget it; journals hear of it from
 * the caller (srv_journal.h). [compute] */
void srv_scene_displace(struct srv_scene *scene, struct srv_placed *placed);

/* Choose a handle for a new object made of a mesh of `session`, which takes part with
 * `member` (NULL: the scene is its own), and charge its quota; *object says which is
 * wanted, 0: any. Returns 0, or PCCD_E_QUOTA, PCCD_E_LIMIT, PCCD_E_HANDLE or PCCD_E_NOMEM
 * with *error set. [loop] */
int srv_scene_admit(struct srv_scene *scene, struct srv_session *session,
                    const struct srv_member *member, struct srv_mesh *mesh,
                    uint32_t *object, struct proto_error *error);
/* Forget an object, whose handle is known: refund it and free the loop's part. [loop] */
void srv_scene_forget(struct srv_scene *scene, uint32_t object);
/* Forget all objects that were added with that member. [loop] */
void srv_scene_forget_of(struct srv_scene *scene, const struct srv_member *member);
/* Unlink from their meshes the objects that a session, which has given back its handle of
 * the scene, has added with that member; NULL: those of its own scene. [loop] */
void srv_scene_unlink_of(struct srv_scene *scene, const struct srv_member *member);

#endif
