/* client/ctl/mesh/gltf_scene.h - what a glTF file shows, as vertices at any time.
 *
 * Room:     client/ctl. May include: the headers of gltf_*.c, meshfile.h.
 * Does:     the objects of a scene, one for each node that has a mesh, or each of its
 *           instances (EXT_mesh_gpu_instancing); morph targets, skins, nodes in doubles.
 *           Of an export of pccdctl the objects, not what marks contacts.
 * Does not: choose a time.
 * Threads:  one at a time.
 * Source:   "glTF 2.0 Specification", 3.7.
 */
#ifndef CTL_GLTF_SCENE_H
#define CTL_GLTF_SCENE_H

#include "gltf_animation.h"
#include "gltf_mesh.h"
#include "gltf_node.h"

/* Where the instances of a node are, besides the node's own place. */
struct gltf_instances {
    struct gltf_accessor translations, rotations, scales; /* count 0: not given */
    size_t count;
};

struct gltf_object {
    size_t node, mesh;
    int64_t skin;     /* -1: none */
    int64_t instance; /* of those of its node; -1: the node itself */
    struct gltf_instances instances;
    uint32_t vertex_first;
};

struct gltf_skin {
    bool is_read;
    const json_t *joints; /* the numbers of their nodes */
    size_t joint_count;
    struct gltf_accessor inverses; /* count 0: none are given */
    struct gltf_place *places;     /* [joint_count]: now */
};

struct gltf_scene {
    struct gltf gltf;
    struct gltf_tree tree;
    struct gltf_mesh *meshes; /* [mesh_count] */
    struct gltf_skin *skins;  /* [skin_count] */
    size_t mesh_count, skin_count;
    struct gltf_object *objects;
    size_t object_count, object_room;
    uint32_t vertex_count;
    struct gltf_animation animation;
};

/* Read what a loaded file shows, and of its animations what is wished for
 * (gltf_animation.h). Errors as of the headers above. gltf_scene_close also after an
 * error. */
int gltf_scene_open(struct ctl_file *file, const struct ctl_motion_wish *wish,
                    struct ctl_error *error, struct gltf_scene *scene);
void gltf_scene_close(struct gltf_scene *scene);
/* Add the objects and their features. */
int gltf_scene_add(struct gltf_scene *scene, struct ctl_mesh *to);
/* Put everything where it is at a frame, and fill x[vertex_count][3]. Errors: E_FORMAT,
 * E_INDEX, E_NOTFINITE. */
int gltf_scene_place(struct gltf_scene *scene, uint32_t frame, double (*x)[3]);
/* The time of a frame as text, such as "0.25 s". */
void gltf_scene_name(const struct gltf_scene *scene, uint32_t frame, char *text,
                     size_t bytes);

#endif
