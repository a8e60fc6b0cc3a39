/* scene.h - several meshes from files, as the objects of one scene.
 *
 * An object has a mesh and its frames (meshframes.h). Those with several frames move
 * together; those with one stand. Where they come from: a scene file (man pccdctl, "Scene
 * files"), or the files of a command line.
 */
#ifndef CTL_SCENE_H
#define CTL_SCENE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "error.h"
#include "meshframes.h"
#include "option_table.h"
#include "pccd.h"
#include "place.h"

#define SCENE_OBJECTS_MAX 4096u
/* Frames that are kept: the ends of a step, and the one that is read meanwhile. */
#define SCENE_FRAMES 3u

/* ---- What a command line says of a scene. */

struct scene_options {
    struct option_arguments with;    /* files of further objects */
    struct option_arguments between; /* "A,B", names of two objects */
    bool has_no_self;
};

/* Take "A,B", two names, as OPTION_TEXTS takes a text. */
void scene_take_pair(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to);

/* Options that fill a struct scene_options: --with, --no-self, --between. */
extern const struct option_table scene_table;

void scene_options_deinit(struct scene_options *options);

/* ---- A scene. */

/* Before scene_open, what is said of an object; all of it is ours. */
struct scene_object {
    char *name;
    char **paths; /* [path_count]: names or patterns, as ctl_frames_open takes them */
    uint32_t path_count;
    uint32_t line;   /* of the scene file that says so; 0: none does */
    double unit;     /* of its files' coordinates, in that of the scene */
    char *animation; /* that frames.wish names; NULL: none is named */
    char *joint;     /* that it hangs on; NULL: none */
    struct ctl_frames_options frames;
    struct pccd_object_settings settings;

    struct ctl_frames files;
    struct ctl_mesh at[SCENE_FRAMES]; /* scene_at() */
    struct pccd_edge *edges; /* ours; NULL unless asked for */
    struct pccd_mesh_info info;
    uint32_t handle, mesh; /* the daemon's */
};

/* A joint of a scene file: how a link moves against the one that it hangs on. What its
 * members mean is in man pccdctl, "Scene files". */
struct scene_joint {
    char *name, *parent, *follows; /* ours; NULL: the scene; none */
    uint32_t line;
    enum scene_joint_type {
        SCENE_FIXED,
        SCENE_REVOLUTE,
        SCENE_CONTINUOUS,
        SCENE_PRISMATIC
    } type;
    double position[3], rpy[3], axis[3], range[2];
    double multiplier, offset;
};

/* Two objects that ignore each other, or have a clearance in the place of their radii. */
struct scene_pair {
    uint32_t objects[2]; /* places */
    bool is_ignored;
    double clearance;
};

/* Fill with {0} but for what is the caller's; scene_close's to give back, also on
 * error. */
struct scene {
    /* The caller's: what an object has where nothing else is said of it. */
    const struct pccd_object_settings *settings; /* NULL: nothing is set */
    const struct ctl_frames_options *frames;
    bool first_alone;  /* the caller's: no later frame is read */
    bool takes_joints; /* the caller's: a file may have joints */
    char *path;        /* ours; of the scene file; NULL: there is none */
    struct scene_object *objects;
    uint32_t object_count;
    size_t object_room;
    struct scene_pair *pairs; /* ours: [pair_count] objects of which something is said */
    size_t pair_count, pair_room;
    struct scene_joint *joints; /* ours: [joint_count] */
    uint32_t joint_count;
    uint32_t first;  /* frame of the files that is frame 0 of the scene */
    uint32_t last;   /* the last one; UINT32_MAX: as many as there are */
    uint32_t count;  /* frames */
    uint32_t mover;  /* an object that moves; object_count: none does */
    double build_ms; /* how long the daemon took for meshes and hierarchies */
};

/* Return where frame `index` of an object is, while it is kept. */
static inline const struct ctl_mesh *scene_at(const struct scene_object *object,
                                              uint32_t index)
{
    return &object->at[object->files.count > 1 ? index % SCENE_FRAMES : 0];
}

/* Return whether a file has the name of a scene file, which ends in ".json". */
bool scene_is_named(const char *path);
/* Read a scene file; files that it names are beside it. Errors: E_SYSTEM, E_NOMEM;
 * E_FORMAT, with the line: what is no JSON, or no scene. */
int scene_read_file(struct scene *scene, const char *path, struct ctl_error *error);
/* Return the format as a JSON Schema. NULL: no memory. */
json_t *scene_schema(void);
/* Return a scene file for these files or patterns, an object each; they are not read.
 * NULL: E_NOMEM; E_LIMIT; E_INVAL: a name that is not UTF-8, which JSON cannot say. */
json_t *scene_new(char *const *files, uint32_t count, struct ctl_error *error);

/* Add an object from files; its name is that of the first, without folder, ending and
 * %d, with "-2", "-3" behind it where there is one of that name. Errors: E_NOMEM,
 * E_LIMIT. */
int scene_add(struct scene *scene, char *const *paths, uint32_t path_count,
              struct ctl_error *error);
/* Make room for another object, which has what all have at first. Errors: E_NOMEM,
 * E_LIMIT. */
int scene_append(struct scene *scene, struct scene_object **object,
                 struct ctl_error *error);
/* Let two objects ignore each other, or have a clearance in the place of their radii. Of
 * two that both are said of, the last counts. Errors: E_NOMEM. */
int scene_ignore(struct scene *scene, uint32_t a, uint32_t b, struct ctl_error *error);
int scene_keep_clearance(struct scene *scene, uint32_t a, uint32_t b, double clearance,
                         struct ctl_error *error);
/* Return the place of the object of that name; object_count: there is none. */
uint32_t scene_find(const struct scene *scene, const char *name);

/* Return whether an object is in a group that another one may meet. */
bool scene_is_met(const struct pccd_object_settings *of,
                  const struct pccd_object_settings *by);
/* Return a sentence where nothing may meet: no two objects, nor, `with_self`, one itself.
 * NULL: something may. */
const char *scene_idle(const struct scene *scene, bool with_self);

/* Take the files of a command line: a scene file alone; or files, which are one object
 * or, with `each`, an object each. Then what `options` says. Errors: those of
 * scene_read_file and scene_add; E_INVAL: a name of --between that no object has. */
int scene_take(struct scene *scene, const struct option_arguments *files, bool each,
               const struct scene_options *options, struct ctl_error *error);
/* Open all files. Errors: those of ctl_frames_open; E_INVAL where two objects that move
 * have other numbers of frames. What files have to say comes on stderr. */
int scene_open(struct scene *scene, struct ctl_error *error);
/* Have frame `index` of all objects beside the two before, each object's all of one
 * format; frame 0 has those that stand, too. Errors: those of ctl_frames_read. */
int scene_read(struct scene *scene, uint32_t index, struct ctl_error *error);
/* Read frame `index` of an object alone, in the scene's unit. Errors: those of
 * ctl_frames_read. */
int scene_read_object(struct scene *scene, struct scene_object *object, uint32_t index,
                      struct ctl_mesh *frame, struct ctl_error *error);
/* Register a mesh that was read: pccd_mesh_put. */
int scene_put_mesh(struct pccd_client *client, const struct ctl_mesh *mesh,
                   uint32_t *handle, struct pccd_mesh_info *info);
/* Register frame 0 of all objects in `handle`, a scene of the client, with their settings
 * and what ignores what; with_edges: get their edges. Errors: those of pccd.h, with the
 * name of the object. */
int scene_place(struct scene *scene, struct pccd_client *client, uint32_t handle,
                bool with_edges, struct ctl_error *error);
/* Get the edges of an object, once. Errors: those of pccd_mesh_edges, E_NOMEM. */
int scene_edges(struct scene_object *object, struct pccd_client *client);
/* Find the vertices of a feature of so many points; edges are got when they are first
 * asked for. Errors: those of pccd_mesh_edges, E_NOMEM; E_FORMAT: there is none. */
int scene_corners(struct scene_object *object, struct pccd_client *client,
                  uint32_t points, uint32_t feature, uint32_t corners[3]);
/* Set `at` to where so many of a frame's vertices are. */
void scene_vertices(const struct ctl_mesh *frame, uint32_t points,
                    const uint32_t corners[3], double (*at)[3]);
/* Do both, for frames index - 1 and `index`, which scene_read has read. Errors: those of
 * scene_corners. */
int scene_feature(struct scene_object *object, struct pccd_client *client, uint32_t index,
                  uint32_t points, uint32_t feature, struct place_feature *ends);
/* Fill `motions`, up to [object_count], with how what moves goes from frame index - 1 to
 * `index`, which scene_read has read; with `is_again` also where it begins. Returns how
 * many. */
uint32_t scene_motions(const struct scene *scene, uint32_t index, bool is_again,
                       struct pccd_motion *motions);
/* Name objects in an error by their first files: the library names them by handles, of
 * which a user of files has never heard. */
void scene_name_objects(const struct scene *scene, struct ctl_error *error);
/* Return the place of the object of that handle; object_count: none. */
uint32_t scene_place_of(const struct scene *scene, uint32_t handle);
/* Return where a frame is from, for reports. */
const char *scene_frame_name(const struct scene *scene, uint32_t index);
void scene_close(struct scene *scene);

#endif
