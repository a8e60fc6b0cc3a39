/* client/ctl/mesh/meshfile.h - a mesh, and how it is read from a file.
 *
 * Vertices and faces are neither merged nor reordered nor dropped: vertex i of one frame
 * stays vertex i of the next (meshframes.h joins them). STL alone has no vertices, and
 * gets them where corners are at the same place.
 */
#ifndef CTL_MESHFILE_H
#define CTL_MESHFILE_H

#include <stdbool.h>
#include <stdint.h>

#include "coordinates.h"
#include "error.h"
#include "motion.h"
#include "pccd_types.h"
#include "text.h"

/* What the daemon accepts: counts up to 2^31 - 1. */
#define CTL_MESH_COUNT_MAX ((uint64_t)INT32_MAX)

/* Rows that name vertices: one of kind k has k + 1 of them. */
enum ctl_kind { CTL_POINTS, CTL_EDGES, CTL_TRIANGLES, CTL_KINDS };

struct ctl_list {
    uint32_t *vertices; /* [count][kind + 1] */
    uint32_t count;
    uint32_t total; /* of the file, of which a part may be kept */
    size_t capacity;
};

/* A part of a file that has a name there. It goes to the first ones of the next object,
 * the last one to the end; counted in the file, also where a part of that is kept. */
struct ctl_mesh_object {
    char *name;     /* never NULL; bytes as the file has them */
    uint32_t whole; /* the first part of the same object, which may be in several */
    uint32_t first[CTL_KINDS];
};

/* A face of four corners and more, which became corner_count - 2 triangles. */
struct ctl_polygon {
    uint32_t triangle_first, corner_count;
    uint64_t
        place; /* for messages: mesh->has_lines, a line; otherwise the face's number */
};

/* Part that one of several processes keeps of a file: piece `number` of `count` of its
 * vertices, of its rows of faces, of edges and of points, each cut into equal runs. A
 * polygon is one row, so pieces may have unequal numbers of triangles. */
struct ctl_part {
    uint32_t number, count; /* count 0: all is kept */
    uint32_t vertex_first;  /* of those that are kept */
    uint32_t vertex_total;  /* of the file */
};

/* Vertices of other parts, which polygons of this one have. */
struct ctl_others {
    uint32_t *vertices; /* [count], ascending */
    size_t count, next;
    double (*x)[3]; /* [count] */
};

/* Fill with {0}. The arrays belong to the mesh, and have what is kept. */
struct ctl_mesh {
    const char *path;        /* the caller's; for messages */
    struct ctl_error *error; /* while it is read; the caller's */
    enum pccd_format format; /* float if the file's coordinates are exact in float */
    uint32_t vertex_count;
    void *x; /* float or double [vertex_count][3] */
    union {
        struct ctl_list lists[CTL_KINDS];
        struct {
            struct ctl_list points, edges, triangles;
        };
    };
    uint32_t object_count; /* 0: all is one, without a name */
    size_t object_capacity;
    struct ctl_mesh_object *objects;
    size_t polygon_count, polygon_capacity;
    struct ctl_polygon *polygons; /* ascending */
    size_t corner_count, corner_capacity;
    uint32_t *corners;  /* of all polygons, then of the face at hand */
    size_t face_corner; /* the first of that */
    bool is_corners;    /* of STL: join no corners */
    bool has_lines;
    bool leaves_out; /* the row that is read now */
    struct ctl_part part;
    struct ctl_others *others; /* while they are read, alone, or used; or NULL */
};

/* Settings of reading a file; {0}: all of it, as a first frame. */
struct ctl_reading {
    /* Keep piece `number` of `count` of it; 0: all. Of PLY and OBJ no more than that is
     * ever in memory, beside a window of the file; of the others all, for a while. All of
     * the file is judged. */
    uint32_t number, count;
    /* Another frame of this one, or of the part that it is: polygons are cut as there,
     * wherever their corners are now. Errors also: E_INVAL where it is no frame of the
     * same mesh, as ctl_mesh_match says. */
    const struct ctl_mesh *like;
    bool is_uncut;   /* polygons are fans, until ctl_mesh_cut */
    bool is_corners; /* of STL: three vertices a triangle, though others are there, too */
};

/* Read `path`; the kind is told by the first bytes "ply" or "glTF", else by the ending
 * .ply, .obj, .stl, .glb or .gltf, else by how OBJ and STL begin.
 * A mesh has at least one vertex and one triangle, edge or point, finite coordinates and
 * valid indices. It keeps `path`.
 * Errors: E_SYSTEM, E_NOMEM, E_FORMAT, E_NOTFINITE, E_INDEX, E_LIMIT; the text names the
 * file, the line or byte, and what was wrong there. */
int ctl_mesh_read(const char *path, struct ctl_mesh *mesh, struct ctl_error *error);
int ctl_mesh_read_as(const char *path, const struct ctl_reading *reading,
                     struct ctl_mesh *mesh, struct ctl_error *error);
void ctl_mesh_deinit(struct ctl_mesh *mesh);
/* Keep the vertices alone. */
void ctl_mesh_drop_shape(struct ctl_mesh *mesh);
/* Return whether a file has the name of a mesh file. */
bool ctl_mesh_is_named(const char *path);

/* Contents of a file, by its first bytes or its name; one that tells neither way counts
 * as a mesh. */
enum ctl_mesh_holds {
    CTL_HOLDS_MESH,      /* one frame */
    CTL_HOLDS_CORNERS,   /* one frame; vertices are corners at one place (STL) */
    CTL_HOLDS_BOTH,      /* a mesh that may move: ctl_mesh_open_motion tells */
    CTL_HOLDS_POSITIONS, /* of frames, and no faces */
};
enum ctl_mesh_holds ctl_mesh_holds(const char *path);
bool ctl_mesh_is_pipe(const char *path);
/* Open a file that does not hold a mesh alone: its frames, those that are wished for
 * (NULL: nothing is). Errors: those of its reader. */
int ctl_mesh_open_motion(const char *path, const struct ctl_motion_wish *wish,
                         struct ctl_motion *motion, struct ctl_error *error);
/* Read the mesh of a motion that has a shape. It keeps `path`. */
int ctl_mesh_read_shape(const struct ctl_motion *motion, const char *path,
                        struct ctl_mesh *mesh, struct ctl_error *error);

/* Another file that a mesh file has some of its numbers in. */
typedef int (*ctl_mesh_file_fn)(void *context, const char *path, struct ctl_error *error);
/* Tell all of those that a mesh file names: the buffers of glTF. Errors: those of reading
 * it; of `each`, which ends it. */
int ctl_mesh_beside(const char *path, ctl_mesh_file_fn each, void *context,
                    struct ctl_error *error);

/* Make the coordinates double; exact. Nothing to do when they are. */
int ctl_mesh_promote(struct ctl_mesh *mesh, struct ctl_error *error);
/* Cut all polygons where their corners are. Errors: E_NOMEM; E_FORMAT and where the file
 * has a polygon that is not simple. */
int ctl_mesh_cut(struct ctl_mesh *mesh, struct ctl_error *error);
/* Find vertices of polygons that are not in this part; free their arrays then. */
int ctl_mesh_find_others(const struct ctl_mesh *mesh, struct ctl_others *others);
/* Compare two meshes, which must have the same number of vertices and the same triangles,
 * edges and points in the same order; otherwise E_INVAL and a text with both file names
 * and the first difference. */
int ctl_mesh_match(const struct ctl_mesh *a, const struct ctl_mesh *b,
                   struct ctl_error *error);
/* Return E_INVAL, with the text that `b` has another count of what is named so. */
int ctl_mesh_other_count(const char *path_a, uint32_t a, const char *names,
                         const char *path_b, uint32_t b, struct ctl_error *error);
/* Cut the polygons of `mesh` as those of `first` are cut, and compare the two. */
int ctl_mesh_cut_like(const struct ctl_mesh *first, struct ctl_mesh *mesh,
                      struct ctl_error *error);

/* Functions for the readers, whose numbers are those of the file: what is not kept of a
 * mesh is judged and counted only. What goes wrong is told to mesh->error. */

/* Allocate room for what is kept of the `count` vertices of the file. */
int ctl_mesh_alloc_vertices(struct ctl_mesh *mesh, enum pccd_format format,
                            uint64_t count);
/* Store one coordinate; the index is vertex * 3 + axis. */
void ctl_mesh_set(struct ctl_mesh *mesh, size_t index, double value);
/* Say that what is added next is of this row, of so many. */
void ctl_mesh_begin_row(struct ctl_mesh *mesh, uint64_t row, uint64_t count);
/* Return whether a triangle has a vertex twice. */
static inline bool ctl_is_flat(const uint32_t vertices[3])
{
    return vertices[0] == vertices[1] || vertices[1] == vertices[2] ||
           vertices[2] == vertices[0];
}
int ctl_mesh_add(struct ctl_mesh *mesh, enum ctl_kind kind, const uint32_t *vertices);
/* Add the next corner of a face, which has three or more; then end the face, with its
 * place (struct ctl_polygon). */
int ctl_mesh_add_corner(struct ctl_mesh *mesh, uint32_t vertex);
int ctl_mesh_end_face(struct ctl_mesh *mesh, uint64_t place);
/* Say that what is added next belongs to an object of this name, of name_bytes bytes,
 * which is copied; an object to which nothing was added is forgotten then. */
int ctl_mesh_add_object(struct ctl_mesh *mesh, const char *name, size_t name_bytes);
/* Keep a piece of a mesh that was read whole. */
void ctl_mesh_keep_part(struct ctl_mesh *mesh, uint32_t number, uint32_t count);

#define CTL_NO_OBJECT UINT32_MAX

/* Return the place in `objects` of the object that a triangle, edge or point belongs to,
 * by its number in the file. CTL_NO_OBJECT: it stands before all. Of an object in parts
 * it is the first part. */
uint32_t ctl_mesh_object_at(const struct ctl_mesh *mesh, enum ctl_kind kind,
                            uint32_t number);
/* Return for each vertex the first object that has it in a triangle, else in an edge,
 * else in a point; CTL_NO_OBJECT: none has. The caller's to free. NULL: no memory. */
uint32_t *ctl_mesh_object_of_vertices(const struct ctl_mesh *mesh);

/* Parse a file of one of the formats. `mesh` is empty before but for path and error, and
 * the caller's to deinit after, also on error. */
int ctl_ply_parse(struct ctl_file *file, struct ctl_mesh *mesh);
int ctl_obj_parse(struct ctl_file *file, struct ctl_mesh *mesh);
/* Return whether a file begins as OBJ does, or as STL, whatever its name. */
bool ctl_obj_begins(const struct ctl_file *file);
bool ctl_stl_begins(const struct ctl_file *file);
int ctl_stl_parse(struct ctl_file *file, struct ctl_mesh *mesh);
int ctl_gltf_parse(struct ctl_file *file, struct ctl_mesh *mesh);
/* Do what ctl_mesh_beside does, of glTF. */
int ctl_gltf_beside(const char *path, ctl_mesh_file_fn each, void *context,
                    struct ctl_error *error);

#endif
