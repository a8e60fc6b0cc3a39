/* robot.h - a mechanism: joints, the parts that hang on them, and the parts' shapes.
 *
 * It comes from a URDF file, with what an SRDF file says of its pairs, or from a scene
 * file that has joints. Angles are in radians, lengths in the unit of the file.
 */
#ifndef CTL_ROBOT_H
#define CTL_ROBOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "meshfile.h"
#include "pccd.h"
#include "scene.h"
#include "xml.h"

#define ROBOT_NONE       UINT32_MAX
#define ROBOT_PI         3.14159265358979323846
#define ROBOT_JOINTS_MAX 4096u

/* A pose: x' = R(rotation) x + position. */
struct robot_place {
    double position[3];
    double rotation[4]; /* x y z w, of any length but 0 */
};
#define ROBOT_AT_ORIGIN                                                                  \
    {                                                                                    \
        .rotation = { 0, 0, 0, 1 }                                                       \
    }

struct robot_joint {
    const char *name;
    uint32_t line;
    enum pccd_joint_kind kind; /* FIXED, TURN or SLIDE */
    const char *held; /* it would move in a way that is not swept: its type; or NULL */
    uint32_t parent;  /* the joint that it hangs on; ROBOT_NONE: none does */
    struct robot_place place;
    double axis[3];
    double range[2];         /* of its value, ascending */
    bool is_endless;         /* the range is one turn of a joint without ends */
    const char *leader_name; /* of the joint that it follows; NULL: none */
    uint32_t leader;         /* that one, which follows none; ROBOT_NONE: none */
    double said[2];          /* factor and offset to the joint that it follows */
    double factor, offset;   /* its value is factor times the leader's, plus offset */
};

struct robot_part {
    const char *name; /* of a link, or of an object of the scene */
    uint32_t line;
    uint32_t joint;       /* ROBOT_NONE: it stands */
    bool is_visual_alone; /* a link with a <visual> and no <collision> */
};

enum robot_form { ROBOT_MESH, ROBOT_BOX, ROBOT_CYLINDER, ROBOT_SPHERE, ROBOT_CAPSULE };

struct robot_shape {
    uint32_t part;
    uint32_t line;
    enum robot_form form;
    /* MESH: scale by axes. BOX: lengths. Else radius, length along z: of a capsule
     * without its two halves of a sphere. */
    double size[3];
    struct robot_place place;
    const char *path;     /* of MESH: as the file names it */
    bool is_given;        /* that is where it is */
    struct ctl_mesh mesh; /* in the frame of `place` */
    struct pccd_object_settings settings;
    uint32_t handle;     /* of the object */
    uint32_t registered; /* its mesh in the daemon .. */
    uint32_t edge_count; /* .. and how many edges that has there */
};

#define ROBOT_APART (-1.0)
#define ROBOT_PLAIN (-2.0)

/* Two parts, and what is said of them. */
struct robot_pair {
    uint32_t parts[2];
    double clearance; /* or ROBOT_APART */
};

/* Fill with {0}; robot_close's to give back, also on error. Names are those of the file
 * that was read: of `xml`, or of the scene, which lives as long. */
struct robot {
    const char *path; /* the caller's */
    struct xml xml;
    struct robot_joint *joints;
    struct robot_part *parts;
    struct robot_shape *shapes;
    uint32_t joint_count, part_count, shape_count;
    struct robot_pair *pairs; /* ours: [pair_count] parts of which something is said */
    size_t pair_count, pair_room;
    char *states;  /* ours: names of group_states that were not chosen; NULL: none */
    double *start; /* [joint_count]: values of joints where nothing else is said */
};

/* Settings for reading a robot. */
struct robot_options {
    const char *srdf;          /* NULL: none */
    const char *state;         /* a group_state of it, for `start`; NULL: none */
    struct option_arguments meshes; /* folders where meshes are */
    struct option_arguments with;   /* files of further parts, which stand */
    uint32_t sides;            /* of a cylinder */
};

/* Read a URDF file, then the SRDF file, then the meshes. Errors: those of xml_open,
 * robot_finish and ctl_mesh_read; E_FORMAT, with the line and the name of the link or
 * joint: what is wrong, or not understood; E_SYSTEM: a mesh that is not there. */
int robot_read_urdf(struct robot *robot, const char *path,
                    const struct robot_options *options, struct ctl_error *error);
/* Take a scene that was opened, and whose path lives as long: objects are parts. Errors:
 * those of robot_finish; E_FORMAT: an object of several frames; an object or a joint that
 * hangs on a joint that there is not. */
int robot_take_scene(struct robot *robot, const struct scene *scene,
                     struct ctl_error *error);
void robot_close(struct robot *robot);

/* ---- Puts one together. */

/* Make room for so many; those that are added later, by counting them, are all zero but
 * for turns by nothing and what hangs on nothing. Errors: E_NOMEM. */
int robot_alloc(struct robot *robot, size_t joints, size_t parts, size_t shapes,
                struct ctl_error *error);
/* Return the joint, or the part, of that name; ROBOT_NONE: there is none. */
uint32_t robot_find_joint(const struct robot *robot, const char *name);
uint32_t robot_find_part(const struct robot *robot, const char *name);
/* Set the rotation of a place: roll, pitch, yaw turn about fixed x, then y, then z. */
void robot_turn(struct robot_place *place, const double rpy[3]);
/* Let two parts meet by design (ROBOT_APART), or keep a clearance in the place of their
 * thickness; the radius of a sphere or capsule is no thickness. Of what is said of two
 * the last counts. Errors: E_NOMEM. */
int robot_set_pair(struct robot *robot, uint32_t a, uint32_t b, double clearance,
                   struct ctl_error *error);
/* Sort joints, so that each comes behind its parent; find the leaders of those that
 * follow; judge axes and ranges; set `start`. Errors: E_NOMEM, E_LIMIT; E_FORMAT: joints
 * that hang on each other, or follow each other, in a ring; an axis of length 0; a range
 * that is none. */
int robot_finish(struct robot *robot, struct ctl_error *error);
/* Make the meshes of shapes, and their radii: those of files, a box of 12 triangles, a
 * prism of so many sides around a cylinder, and a sphere and a capsule as a point and an
 * edge with a radius. Errors: those of ctl_mesh_read, E_NOMEM. */
int robot_make_shapes(struct robot *robot, const struct robot_options *options,
                      struct ctl_error *error);
/* Set reach[joint_count]: no point of what hangs on a joint is farther from its origin,
 * while joints have values between `from` and `to`. */
void robot_measure(const struct robot *robot, const double *from, const double *to,
                   double *reach);

/* ---- Uses it. */

/* Set the values of joints that follow others. */
void robot_follow(const struct robot *robot, double *values);
/* Return whether a joint has a value of its own to choose. */
bool robot_is_free(const struct robot *robot, uint32_t joint);
/* Fill joints[joint_count + shape_count] for a motion between these values of all. The
 * object of shape i hangs on joint_count + i. */
void robot_joints(const struct robot *robot, const double *from, const double *to,
                  struct pccd_joint *joints);
/* Return whether the joints between two parts are all FIXED, or whether the two may
 * meet. */
bool robot_never_asks(const struct robot *robot, uint32_t a, uint32_t b);
/* Return the clearance that is said of two parts; ROBOT_APART; ROBOT_PLAIN: nothing. */
double robot_clearance(const struct robot *robot, uint32_t a, uint32_t b);
/* Return whether two parts have a clearance of their own. */
bool robot_has_clearances(const struct robot *robot);

#endif
