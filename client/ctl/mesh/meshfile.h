/* client/ctl/mesh/meshfile.h - reads a mesh from a PLY, OBJ, STL or glTF file.
 *
 * Room:     client/ctl. May include: error.h, motion.h, text.h, pccd_types.h.
 * Does:     read PLY (ascii, binary of both byte orders), OBJ, STL (ascii, binary) and
 *           glTF; polygons are cut into triangles (polygon.h). Edges and points by
 *           themselves are PLY's element edge, l and p of OBJ, lines and points of glTF;
 *           of a PLY without faces and edges all vertices are points.
 * Does not: merge, reorder or drop vertices or faces: vertex i of one frame stays vertex
 *           i of the next (meshframes.h joins them). STL alone has no vertices, and gets
 *           them where corners are at the same place.
 * Threads:  [any]; nothing is shared.
 * Source:   "The PLY Polygon File Format" (Turk 1994); Wavefront OBJ, appendix B1;
 *           StereoLithography Interface Specification; glTF 2.0.
 */
#ifndef CTL_MESHFILE_H
#define CTL_MESHFILE_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"
#include "motion.h"
#include "pccd_types.h"
#include "text.h"

/* What the daemon accepts: counts up to 2^31 - 1, coordinates up to this size. */
#define CTL_MESH_COUNT_MAX      ((uint64_t)INT32_MAX)
#define CTL_MESH_COORDINATE_MAX 1e18

/* What is kept of a file of which several processes keep a part each: piece `number` of
 * `count` of its vertices, of its rows of faces, of edges and of points, each cut into
 * equal runs. A polygon is one row, so pieces may have unequal numbers of triangles. */
struct ctl_part {
    uint32_t number, count; /* count 0: all is kept */
    uint32_t vertex_first;  /* of those that are kept */
    uint32_t vertex_total, triangle_total, edge_total, point_total; /* of the file */
    bool leaves_out;           /* the row that is read now */
    struct ctl_wanted *wanted; /* not NULL: of these vertices the positions alone */
};

/* A face of four corners and more, which became triangles (meshcut.h). */
struct ctl_polygon {
    uint32_t triangle_first;
    uint32_t corner_count : 31, is_recut : 1; /* is_recut: its corners are kept */
    uint64_t place;
};

/* A part of a file that has a name there. It goes to the first ones of the next object,
 * the last one to the end; counted in the file, also where a part of that is kept. */
struct ctl_mesh_object {
    char *name; /* never NULL; bytes as the file has them */
    uint32_t triangle_first, edge_first, point_first;
};

/* Fill with {0}. The arrays belong to the mesh, and have what is kept. */
struct ctl_mesh {
    enum pccd_format
        format; /* of x: float if the file's coordinates are exact in float */
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t triangle_capacity;
    void *x; /* float or double [vertex_count][3] */
    uint32_t (*triangles)[3];
    uint32_t edge_count, edge_capacity;
    uint32_t point_count, point_capacity;
    uint32_t (*edges)[2];
    uint32_t *points;
    uint32_t object_count, object_capacity; /* 0: all is one, without a name */
    struct ctl_mesh_object *objects;
    uint32_t polygon_count, polygon_capacity;
    struct ctl_polygon *polygons; /* ascending */
    uint32_t corner_count, corner_capacity;
    uint32_t *corners; /* of those that are no fan, one polygon after the other */
    bool is_corners;   /* of STL: join no corners */
    bool has_lines;    /* place of a polygon: its line; otherwise the face's number */
    struct ctl_part part;
};

/* Read `path`; the kind is told by the first bytes "ply" or "glTF", else by the ending
 * .ply, .obj, .stl, .glb or .gltf.
 * A mesh has at least one vertex and one triangle, edge or point, finite coordinates and
 * valid indices.
 * Errors: E_SYSTEM, E_NOMEM, E_FORMAT, E_NOTFINITE, E_INDEX, E_LIMIT; the text names the
 * file, the line or byte, and what was wrong there. */
int ctl_mesh_read(const char *path, struct ctl_mesh *mesh, struct ctl_error *error);
/* The same, but polygons are fans still, until ctl_mesh_cut (meshcut.h). */
int ctl_mesh_read_uncut(const char *path, struct ctl_mesh *mesh, struct ctl_error *error);
/* Of STL: three vertices of each triangle, though others are at the same place. */
int ctl_mesh_read_corners(const char *path, struct ctl_mesh *mesh,
                          struct ctl_error *error);
/* Another frame of `first`, which is of first_path, or the part of one that `first` is
 * of its file: polygons are cut as there, wherever their corners are now. Errors also:
 * E_INVAL where it is no frame of the same mesh, as ctl_mesh_match says. */
int ctl_mesh_read_like(const char *path, const struct ctl_mesh *first,
                       const char *first_path, struct ctl_mesh *mesh,
                       struct ctl_error *error);
/* As ctl_mesh_read, and keep piece `number` of `count` of it. Of PLY and OBJ no more
 * than that is ever in memory, beside a window of the file; of the others all, for a
 * while. All of the file is judged. */
int ctl_mesh_read_part(const char *path, uint32_t number, uint32_t count,
                       struct ctl_mesh *mesh, struct ctl_error *error);
void ctl_mesh_deinit(struct ctl_mesh *mesh);
/* Keep the vertices alone. */
void ctl_mesh_drop_shape(struct ctl_mesh *mesh);
/* Whether a file has the name of a mesh file. */
bool ctl_mesh_is_named(const char *path);

/* What a file has, by its first bytes or its name; what it is not known, is a mesh. */
enum ctl_mesh_holds {
    CTL_HOLDS_MESH,      /* one frame */
    CTL_HOLDS_CORNERS,   /* one frame; vertices are corners at one place (STL) */
    CTL_HOLDS_BOTH,      /* a mesh that may move: ctl_mesh_open_motion tells */
    CTL_HOLDS_POSITIONS, /* of frames, and no faces */
};
enum ctl_mesh_holds ctl_mesh_holds(const char *path);
/* Open a file that does not hold a mesh alone: its frames, those that are wished for
 * (NULL: nothing is), and its shape to `mesh`, which is empty (NULL: not wanted), if it
 * has one. Errors: those of its reader. */
int ctl_mesh_open_motion(const char *path, const struct ctl_motion_wish *wish,
                         struct ctl_mesh *mesh, struct ctl_motion *motion,
                         struct ctl_error *error);
/* How many frames a file has that holds a mesh: those of its animation, or one. Errors:
 * likewise. */
int ctl_mesh_count_frames(const char *path, uint32_t *count, struct ctl_error *error);

/* Make the coordinates double; exact. Nothing to do when they are. */
int ctl_mesh_promote(struct ctl_mesh *mesh, struct ctl_error *error);
/* Same number of vertices and the same triangles, edges and points in the same order;
 * otherwise E_INVAL and a text with both file names and the first difference. */
int ctl_mesh_match(const struct ctl_mesh *a, const char *path_a, const struct ctl_mesh *b,
                   const char *path_b, struct ctl_error *error);

/* For the readers, whose numbers are those of the file: what is not kept of a mesh is
 * judged and counted only. `count` is of all vertices. */
int ctl_mesh_alloc_vertices(struct ctl_mesh *mesh, enum pccd_format format,
                            uint64_t count, const char *path, struct ctl_error *error);
bool ctl_mesh_coordinate_ok(double value);
/* Store one coordinate; the index is vertex * 3 + axis. */
void ctl_mesh_set(struct ctl_mesh *mesh, size_t index, double value);
/* Count one more item of `bytes`, of *total in the file, and make room for it in *items,
 * a pointer to an array of `count` of them, if it is kept. */
int ctl_mesh_grow(void *items, size_t bytes, uint32_t count, uint32_t *capacity,
                  uint32_t *total, bool is_kept, const char *names, const char *path,
                  struct ctl_error *error);
/* Of a mesh that was read whole, keep piece `number` of `count`. */
void ctl_mesh_keep_part(struct ctl_mesh *mesh, uint32_t number, uint32_t count);
/* Of what a part wants of others (meshcut.h), the coordinate of one, if it is that. */
void ctl_wanted_set(struct ctl_wanted *wanted, size_t index, double value);
/* What is added next is of this row, of so many. */
void ctl_mesh_begin_row(struct ctl_mesh *mesh, uint64_t row, uint64_t count);
int ctl_mesh_add_triangle(struct ctl_mesh *mesh, const uint32_t corners[3],
                          const char *path, struct ctl_error *error);
int ctl_mesh_add_edge(struct ctl_mesh *mesh, const uint32_t ends[2], const char *path,
                      struct ctl_error *error);
int ctl_mesh_add_point(struct ctl_mesh *mesh, uint32_t vertex, const char *path,
                       struct ctl_error *error);
/* What is added next belongs to an object of this name, of name_bytes bytes, which is
 * copied; one to which nothing was added is forgotten then. */
int ctl_mesh_add_object(struct ctl_mesh *mesh, const char *name, size_t name_bytes,
                        const char *path, struct ctl_error *error);

#define CTL_NO_OBJECT UINT32_MAX

/* Where in `objects` that of a triangle, edge or point (3, 2 or 1 points) is, by its
 * number in the file. CTL_NO_OBJECT: it stands before all. */
uint32_t ctl_mesh_object_at(const struct ctl_mesh *mesh, uint32_t points,
                            uint32_t number);
/* The first object that has each vertex; the caller's to free. NULL: no memory. */
uint32_t *ctl_mesh_object_of_vertices(const struct ctl_mesh *mesh);

/* The formats. `mesh` is empty before and the caller's to deinit after, also on
 * error. */
int ctl_ply_parse(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error);
/* Of the beginning of a file: whether its header can be true; and whether it is ascii. */
int ctl_ply_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error);
int ctl_obj_parse(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error);
int ctl_stl_parse(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error);
int ctl_stl_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error);
int ctl_gltf_parse(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error);
int ctl_gltf_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error);
/* All frames of a glTF file: `mesh` gets the shape, the names of the nodes as objects,
 * and the positions of the first one, in the format of `motion`. What does not move is
 * one frame, float if that is exact; else they are double. Without a wish for one all
 * animations that move a mesh are played at once, if no two of them move the same
 * thing; else the first of them. E_INVAL: there is no animation that is wished for. */
int ctl_gltf_open(const char *path, const struct ctl_motion_wish *wish,
                  struct ctl_mesh *mesh, struct ctl_motion *motion,
                  struct ctl_error *error);
/* Point caches have positions alone, and leave `mesh` as it is; nothing is wished for
 * of them. Of a file a piece of 64 KiB is in memory, of a pipe all. Where the size is
 * not that of the header, the text names both. */
int ctl_pc2_open(const char *path, const struct ctl_motion_wish *wish,
                 struct ctl_mesh *mesh, struct ctl_motion *motion,
                 struct ctl_error *error);
int ctl_mdd_open(const char *path, const struct ctl_motion_wish *wish,
                 struct ctl_mesh *mesh, struct ctl_motion *motion,
                 struct ctl_error *error);

#endif
