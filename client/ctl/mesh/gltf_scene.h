/* client/ctl/mesh/gltf_scene.h - what a glTF file shows.
 *
 * What goes wrong is told as gltf_file.h says, in `gltf`.
 *
 * Source: "glTF 2.0 Specification", 3.5, 3.7, 3.11 and appendix C.
 */
#ifndef CTL_GLTF_SCENE_H
#define CTL_GLTF_SCENE_H

#include "gltf_file.h"
#include "meshfile.h"

/* What moves of a node: the first three are its pose. */
enum gltf_path { GLTF_TRANSLATION, GLTF_ROTATION, GLTF_SCALE, GLTF_WEIGHTS, GLTF_PATHS };
#define GLTF_POSE_PATHS GLTF_WEIGHTS

struct gltf_path_kind {
    const char *name, *instance_name; /* of a node; of instances */
    size_t numbers;                   /* of one value */
    enum gltf_role role;
    double still[4]; /* what it is unless the file says so */
};
extern const struct gltf_path_kind gltf_path_kinds[GLTF_PATHS];

/* Place of something: three rows of its axes and its origin. */
struct gltf_place {
    double m[12];
};

struct gltf_node {
    const json_t *json;
    struct gltf_node *parent; /* NULL: none */
    bool is_listed;
    bool is_hidden; /* once read: or one above it is (KHR_node_visibility) */
    bool moves_mesh; /* it or what is below it has vertices, or is a joint */
    bool has_matrix; /* of these columns, instead of a pose */
    double matrix[16];
    double pose[GLTF_POSE_PATHS][4]; /* now; the rotation of any length but 0 */
    struct gltf_place world;         /* now */
    double *weights; /* [weight_count]: of the morph targets, now; NULL: none */
    size_t weight_count;
    size_t moved_by[GLTF_PATHS]; /* the last animation that does, from 1; 0: none */
};

/* Vertices that primitives share when they have the same attributes. */
struct gltf_run {
    const json_t *primitive; /* the first one */
    uint32_t first;          /* vertex of the mesh */
    struct gltf_accessor positions;
    struct gltf_accessor
        *targets; /* [target_count of the mesh]; count 0: moves nothing */
    struct gltf_accessor *joints, *weights; /* [set_count], four each */
    size_t set_count;
};

/* Object of the scene: the mesh that one node shows, once, or as often as the node has
 * instances (EXT_mesh_gpu_instancing). In an export of pccdctl only its objects are such,
 * not what marks contacts. */
struct gltf_object {
    size_t node;
    uint32_t first; /* vertex */
    long long mesh; /* its number */
    const json_t *primitives;
    size_t target_count, run_count;
    struct gltf_run *runs; /* [run_count] */
    size_t *run_of;        /* [primitives] */
    uint32_t vertex_count; /* of one instance */
    bool has_instances;
    size_t instance_count;
    struct gltf_accessor instances[GLTF_POSE_PATHS]; /* of type 0: not given */
    const json_t *skin, *joints;   /* NULL: none; joints: the numbers of their nodes */
    struct gltf_accessor inverses; /* of type 0: none are given */
    struct gltf_place *places;     /* [joints]: now */
};

struct gltf_animation {
    struct gltf_channel *channels; /* [channel_count]: that are played */
    size_t channel_count;
    double *times; /* [time_count]: of all keys, ascending */
    size_t time_count;
    double rate;          /* frames a second; 0: a frame at each of the times */
    uint32_t frame_count; /* 0: nothing moves */
    /* For the report. */
    size_t moving_count; /* animations of the file that move a mesh, */
    size_t read_count;   /* and that are played, */
    size_t first;        /* of which this is the first one */
    double turn_degrees; /* the greatest of a node between two keyframes */
    bool is_curved;      /* a node moves along a curve between two keys */
};

struct gltf_scene {
    struct gltf gltf;
    struct gltf_node *nodes; /* [node_count] */
    size_t *order;           /* [node_count]: parents first; the first ones are shown */
    size_t node_count, listed_count, shown_count;
    struct gltf_object *objects; /* [object_count] */
    size_t object_count;
    bool is_loaded;
    uint32_t vertex_count;
    struct gltf_animation animation;
};

/* Find positions, morph targets, joints and weights of an object's mesh. */
void gltf_mesh_read(struct gltf *gltf, struct gltf_object *object);
/* Add points, edges and triangles of an instance, whose vertices begin with `first`. */
void gltf_mesh_add(struct gltf *gltf, const struct gltf_object *object, uint32_t first,
                   struct ctl_mesh *to);

/* Choose the animation that has the name, or the number, of the wish; without one all
 * that move a mesh, if no two of them move the same, else the first of these. Make frames
 * of their keyframes or at a rate; what moves no mesh, such as a camera, makes none. */
void gltf_animation_read(struct gltf_scene *scene, const struct ctl_motion_wish *wish);
/* Return when a frame is, in seconds. */
double gltf_animation_time(const struct gltf_animation *animation, uint32_t frame);
/* Write to the nodes what they have at a frame. */
void gltf_animation_pose(struct gltf_scene *scene, uint32_t frame);

#endif
