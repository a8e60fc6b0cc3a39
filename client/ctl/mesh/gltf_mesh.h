/* client/ctl/mesh/gltf_mesh.h - a mesh of a glTF file: its vertices and features.
 *
 * Room:     client/ctl. May include: gltf_accessor.h, meshfile.h.
 * Does:     judge primitives; make points, edges and triangles of their seven modes; find
 *           positions, morph targets, joints and weights of each run of vertices.
 * Does not: place vertices.
 * Threads:  one at a time.
 * Source:   "glTF 2.0 Specification", 3.7.
 */
#ifndef CTL_GLTF_MESH_H
#define CTL_GLTF_MESH_H

#include "gltf_accessor.h"
#include "meshfile.h"

/* Joints and weights of a run of vertices, four each. */
struct gltf_influence {
    struct gltf_accessor joints, weights;
};

/* Vertices that primitives share when they have the same attributes. */
struct gltf_run {
    const json_t *primitive; /* the first one */
    uint32_t first;          /* vertex of the mesh */
    struct gltf_accessor positions;
    struct gltf_accessor
        *targets; /* [target_count of the mesh]; count 0: moves nothing */
    struct gltf_influence *influences; /* [influence_count] */
    size_t influence_count;
};

struct gltf_mesh {
    bool is_read;
    const json_t *primitives;
    struct gltf_run *runs;
    size_t run_count;
    size_t *run_of; /* [primitives] */
    size_t target_count;
    uint64_t vertex_count;
};

/* Errors: E_FORMAT, E_INDEX, E_LIMIT, E_NOMEM. gltf_mesh_deinit also after an error. */
int gltf_mesh_read(struct gltf *gltf, int64_t index, struct gltf_mesh *mesh);
void gltf_mesh_deinit(struct gltf_mesh *mesh);
/* Add its features; its vertices begin with `first` in `to`. */
int gltf_mesh_add(struct gltf *gltf, const struct gltf_mesh *mesh, uint32_t first,
                  struct ctl_mesh *to);

#endif
