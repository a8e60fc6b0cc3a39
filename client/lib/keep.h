/* keep.h - what another daemon would have to be told.
 *
 * Room:     client/lib, private. May include: client.h, kept_pairs.h.
 * Does:     keep scenes, meshes and objects as they were registered, and where the
 *           vertices of each object were at the end of its last answered step.
 * Does not: talk to a daemon (restore.c), or keep anything when the user wants it so.
 * Threads:  [owner].
 *
 * Positions are not copied when a step is answered: its slot is KEPT, and read only when
 * it is needed for another step and still holds the last positions of some object. A
 * client that has more slots than steps in flight, and moves whole objects, never copies.
 */
#ifndef CLI_KEEP_H
#define CLI_KEEP_H

#include "client.h"
#include "kept_pairs.h"

/* Vertices and triangles as they were registered. */
struct cli_kept_mesh {
    struct cli_kept_mesh *next; /* registered later */
    uint32_t handle;
    uint32_t made_handle;  /* while it is told anew: that the new daemon gave */
    uint32_t object_count; /* made of it */
    bool is_destroyed;     /* but objects are left */
    uint32_t format;       /* enum pccd_format */
    uint32_t vertex_count;
    uint32_t triangle_count;
    void *x;
    uint32_t (*triangles)[3];
};

enum cli_placing {
    CLI_PLACED_REGISTERED = 0, /* where the mesh was registered */
    CLI_PLACED_RIGID,          /* the same, transformed by `m` */
    CLI_PLACED_FREELY          /* at `x` */
};

struct cli_kept_object {
    uint32_t handle;
    struct cli_kept_mesh *mesh;
    enum cli_placing placing;
    uint32_t format; /* of x */
    void *x;         /* [vertex_count][3]; NULL: none yet */
    double m[12];
    uint64_t since; /* segments of earlier steps have been overwritten by later ones */
    uint32_t what;  /* enum pccd_object_what: that was ever set, of the next three */
    uint64_t group;
    uint64_t mask;
    bool self;
};

struct cli_kept_scene {
    struct cli_kept_scene *next; /* made later */
    uint32_t handle;
    struct proto_SCENE_CREATE_request settings;
    struct cli_kept_object *objects; /* in the order of their handles */
    uint32_t object_count;
    uint32_t object_room;
    struct cli_kept_pairs ignored;
};

/* A copy of a mesh that is about to be registered; NULL: no memory. */
struct cli_kept_mesh *cli_keep_copy(const void *x, uint32_t format, uint32_t vertex_count,
                                    const uint32_t (*triangles)[3],
                                    uint32_t triangle_count);
void cli_keep_copy_free(struct cli_kept_mesh *copy); /* NULL is allowed */
/* The mesh `handle` has been committed, or replaced, with what is in `copy`, which is
 * taken over. */
void cli_keep_mesh(struct pccd_client *client, uint32_t handle,
                   struct cli_kept_mesh *copy);

/* A request has been answered with success: note what it has changed. */
void cli_keep_answer(struct pccd_client *client, struct cli_call *call);

/* Whether anything was ever set of what its objects may meet, and not taken back; the
 * pairs may have to be settled before. */
bool cli_keep_is_filtered(const struct cli_kept_scene *scene);

/* Make a KEPT slot free: copy what only it holds. Slots must be taken in the order of
 * their steps. Returns 0 or PCCD_E_NOMEM. */
int cli_keep_fold(struct pccd_client *client, uint32_t slot);
/* All of them. */
int cli_keep_fold_all(struct pccd_client *client);

void cli_keep_deinit(struct pccd_client *client);

#endif
