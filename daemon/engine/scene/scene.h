/* scene.h - a scene: its objects, where they are, and where the next step moves them.
 *
 * Threads: [compute]; one thread at a time for one scene.
 * Source: paper sections 3.2 and 7 (merged hierarchies), design of the ingest: every byte
 * of a foreign memory is read once, the copy is checked.
 */
#ifndef ENG_SCENE_H
#define ENG_SCENE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "mesh.h"

struct eng_affinity;
struct eng_scene;

struct eng_scene_settings {
    /* Of the trees of `paper`. A node whose volume is less than this times the sum of its
     * children's, which overlap then, is reconstructed (paper section 6.2). 0: never; at
     * most 1. */
    double rebuild_ratio;
    /* A subtree of up to so many triangles is reconstructed at once when the traversal
     * touches it; larger ones are built in the background, a share in every step. */
    uint32_t region_triangles;
    /* That put an added object's features in order; 0: one. Changes nothing else. */
    uint32_t threads;
};

#define ENG_SCENE_SETTINGS_DEFAULT                                                       \
    {                                                                                    \
        0.9, 1024, 1                                                                     \
    }

/* Free a scene, which eng_scene_new (step.h) made. NULL is allowed. */
void eng_scene_free(struct eng_scene *scene);

/* Add an instance of a committed mesh at its registered positions, build its hierarchy,
 * and merge it in. `object_id` is the number that records carry; it must be new to the
 * scene. *object_idx stays valid until removal and may be reused after it.
 * Errors: PCCD_E_STATE (not committed), PCCD_E_INVAL (id in use), PCCD_E_LIMIT,
 * PCCD_E_NOMEM; the scene is unchanged then. */
int eng_scene_add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t object_id,
                  uint32_t *object_idx);

/* Remove an object. PCCD_E_INVAL if there is none. The other hierarchies stay as
 * they are. */
int eng_scene_remove(struct eng_scene *scene, uint32_t object_idx);

/* Give an object another committed mesh: it stands still at the new mesh's registered
 * positions, with a hierarchy of its own, under the same index and id; the other objects
 * are not touched. Errors as eng_scene_add, and PCCD_E_INVAL if there is no object; the
 * scene is unchanged then. */
int eng_scene_replace(struct eng_scene *scene, uint32_t object_idx,
                      struct eng_mesh *mesh);

/* Replace many objects, of any scenes, all or none: try each, once; then settle every
 * scene that was tried, or take all of it back. Neither can fail. Until then what the
 * objects were before is kept aside, and the scene must not be stepped or changed
 * otherwise. Errors as eng_scene_replace; earlier tries stand. */
int eng_scene_try_replace(struct eng_scene *scene, uint32_t object_idx,
                          struct eng_mesh *mesh);
void eng_scene_settle(struct eng_scene *scene);
void eng_scene_take_back(struct eng_scene *scene);

/* Which objects are tested against each other: a and b if a.group & b.mask and b.group &
 * a.mask have a bit in common each, unless the pair is ignored; an object against itself
 * if `self`. From the next step on; what an object is replaced with changes nothing. */
struct eng_object_filter {
    uint64_t group;
    uint64_t mask;
    bool self;
};

#define ENG_OBJECT_FILTER_DEFAULT                                                        \
    {                                                                                    \
        1, UINT64_MAX, true                                                              \
    }

/* Set, or get, which objects an object is tested against. PCCD_E_INVAL: there is no such
 * object. */
int eng_scene_set_filter(struct eng_scene *scene, uint32_t object_idx,
                         const struct eng_object_filter *filter);
int eng_scene_get_filter(const struct eng_scene *scene, uint32_t object_idx,
                         struct eng_object_filter *filter);
/* The thickness of an object: its features meet others that come within the sum of both
 * radii and the separation of the step (question.h); two of its own count both of their
 * radii. From the next step on; it stays when the object is replaced. */
struct eng_object_thickness {
    bool has_radius; /* else its radii are those of the mesh (eng_mesh_write_radii) */
    double radius;   /* of all features; 0 .. 1e18 */
    /* Pairs within the object that are left thin, as if all radii and the separation were
     * 0: those nearer to each other than rest_distance, 0 .. 1e18, in the registered
     * positions of the mesh, and those with a vertex each that at most rest_rings edges
     * join, 0 .. 8. */
    double rest_distance;
    uint32_t rest_rings;
};

/* Set the thickness of an object. PCCD_E_INVAL: no such object; a number that is negative
 * or not finite. PCCD_E_LIMIT: one beyond 1e18, or more than 8 rings; or vertices of the
 * mesh have so many others in that many rings, more than 256 on average, that the lists
 * of them would be too long (to replace the mesh may fail for it, too). PCCD_E_NOMEM. As
 * before then. */
int eng_scene_set_thickness(struct eng_scene *scene, uint32_t object_idx,
                            const struct eng_object_thickness *thickness);
/* Do what takes longest of that, and of replacing an object that has rings: find out
 * which vertices of a mesh (of the object's; of `mesh`, if it is not NULL) so many edges
 * join. It is kept with the mesh. PCCD_E_CANCELLED: *cancel became true. Else as
 * above. */
int eng_scene_prepare_rings(struct eng_scene *scene, uint32_t object_idx,
                            struct eng_mesh *mesh, uint32_t rings,
                            const atomic_bool *cancel);
int eng_scene_get_thickness(const struct eng_scene *scene, uint32_t object_idx,
                            struct eng_object_thickness *thickness);

/* Exclude an object that will be removed: from now on it meets nothing. PCCD_E_INVAL:
 * there is none. */
int eng_scene_exclude(struct eng_scene *scene, uint32_t object_idx);
/* Remove the pairs that excluded objects are part of: once for all of these. */
void eng_scene_purge_excluded(struct eng_scene *scene);
/* Ignore a pair of two different objects from the next step on, or have its radii count
 * if `ignored` is false; it goes with either object. A pair that is as it should be stays
 * so. PCCD_E_INVAL: there are no such two; PCCD_E_LIMIT: something is
 * said of PROTO_IGNORED_PER_SCENE; PCCD_E_NOMEM. As before then. */
int eng_scene_ignore(struct eng_scene *scene, uint32_t a_idx, uint32_t b_idx,
                     bool ignored);
uint32_t eng_scene_ignored_count(const struct eng_scene *scene);
/* Have a pair of two different objects meet within a clearance, 0 .. 1e18, and the
 * separation of the step, in the place of their radii: from the next step on, and until
 * either is removed or eng_scene_ignore is told of the pair. Errors as above, and
 * PCCD_E_INVAL, PCCD_E_LIMIT: no such clearance. */
int eng_scene_set_pair_clearance(struct eng_scene *scene, uint32_t a_idx, uint32_t b_idx,
                                 double clearance);

/* Find the next pair that is ignored, or has a clearance, after *from, which is 0 first;
 * false: there are no more. */
bool eng_scene_next_pair(const struct eng_scene *scene, uint32_t *from,
                         uint32_t pair_idx[2], bool *ignored, double *clearance);

/* Read an object that there is. Its id and mesh; its vertices where the last step began
 * (0) and ended (1). They lie in the scene until it is staged or changed. */
uint32_t eng_scene_object_id(const struct eng_scene *scene, uint32_t object_idx);
const struct eng_mesh *eng_scene_mesh(const struct eng_scene *scene, uint32_t object_idx);
const double (*eng_scene_positions(const struct eng_scene *scene, uint32_t object_idx,
                                   unsigned end))[3];

uint32_t eng_scene_object_count(const struct eng_scene *scene);
uint32_t eng_scene_vertex_count(const struct eng_scene *scene, uint32_t object_idx);
uint64_t eng_scene_bytes(const struct eng_scene *scene);

/* Begin staging, or abort it. begin; any number of writes; then eng_step (step.h) makes
 * the move, or abort forgets it, and with it where the last step began, of objects that
 * were written. Objects without a write stand still at their last end positions. A failed
 * write leaves the staging open for abort only.
 *
 * Ranges first .. first+count-1 of the object's vertices, count >= 1 (PCCD_E_INVAL); two
 * writes to one vertex in one step are PCCD_E_SEGMENT; coordinates PCCD_E_NOTFINITE.
 * Sources may be memory that another process writes: each byte is read once. */
void eng_stage_begin(struct eng_scene *scene);
void eng_stage_abort(struct eng_scene *scene);
/* Begin staging of writes that are only to be found good or bad: abort must end it, and
 * then nothing has changed, not even where the last step began. */
void eng_stage_validate(struct eng_scene *scene);
/* Return whether a vertex is written twice: the step would be refused. */
bool eng_stage_overlaps(struct eng_scene *scene);

/* A vertex of an object with which staging has found fault. */
struct eng_stage_fault {
    uint32_t object_idx;
    uint32_t vertex;
    uint32_t end, axis; /* of a coordinate: at t = 0 or 1, 2: either; x, y or z */
    double x;
};

/* Return the first vertex that was written twice, after a step with PCCD_E_SEGMENT or
 * eng_stage_overlaps. */
struct eng_stage_fault eng_stage_twice(const struct eng_scene *scene);
/* Find what a write has found that is no coordinate (PCCD_E_NOTFINITE), before abort.
 * False: a transform is bad, and nothing was written. */
bool eng_stage_stray(const struct eng_scene *scene, struct eng_stage_fault *stray);

/* Let, after begin, `threads` copy what follows, placed as those of a step are (step.h);
 * 1 and NULL unless this is called. */
void eng_stage_share(struct eng_scene *scene, uint32_t threads,
                     const struct eng_affinity *affinity);

/* Stage end positions; the start is the last end. `x1`: packed [count][3] in `format`. */
int eng_stage_x1(struct eng_scene *scene, uint32_t object_idx, enum pccd_format format,
                 uint32_t first, uint32_t count, const void *x1);
/* Stage the positions of both ends, as eng_stage_x1 those of one. */
int eng_stage_x0x1(struct eng_scene *scene, uint32_t object_idx, enum pccd_format format,
                   uint32_t first, uint32_t count, const void *x0, const void *x1);
/* Say, before begin, where all end positions of an object can be written, and, unless x0
 * is NULL, its start positions. Nothing else happens to the scene until they are there
 * (eng_stage_mapped, after begin); or it is told, then or after begin, to forget them,
 * and where the last step began is not known any more. PCCD_E_INVAL: no such object.
 * PCCD_E_NOMEM. */
int eng_stage_map(struct eng_scene *scene, uint32_t object_idx, double (**x0)[3],
                  double (**x1)[3]);
/* Say that they were written there. */
int eng_stage_mapped(struct eng_scene *scene, uint32_t object_idx, bool has_start);
/* Forget positions that were to be written there; also called of any object of a step
 * that is aborted before it was staged: it began where it is. */
void eng_stage_unmap(struct eng_scene *scene, uint32_t object_idx);
/* Stage both ends as transforms m0, m1 of the registered positions: double[12], rows of
 * [R | t]; x' = ((m0*x + m1*y) + m2*z) + m3 per row, each operation rounded once (no
 * fma): the result of that computation is the exact input of the step. */
int eng_stage_rigid(struct eng_scene *scene, uint32_t object_idx, uint32_t first,
                    uint32_t count, const void *m0, const void *m1);

#endif
