/* world.h - the fields of a scene: its objects and where they are.
 *
 * Threads: [compute]; inside a step the team reads it.
 *
 * The vertices of all objects lie in one array; an object owns a range of it. Indices
 * into this array ("global") name vertices inside the engine; records carry object id and
 * local index. So an object comes or goes without touching the others.
 */
#ifndef ENG_WORLD_H
#define ENG_WORLD_H

#include <stdint.h>

#include "box_frame.h"
#include "ingest.h"
#include "masks.h"
#include "pccd_types.h"
#include "scene.h"
#include "topology.h"

/* ---- ranges of consecutive indices ------------------------------------------------- */

struct eng_range {
    uint32_t first;
    uint32_t count;
};

struct eng_ranges {
    struct eng_range *holes; /* free, sorted by first, never adjacent, all below end */
    uint32_t hole_count;
    uint32_t hole_capacity;
    uint32_t taken; /* ranges handed out and not given back */
    uint32_t end;   /* first index never handed out, or handed back at the end */
    uint32_t limit; /* end never passes it */
};

void eng_ranges_init(struct eng_ranges *ranges, uint32_t limit);
void eng_ranges_deinit(struct eng_ranges *ranges);

/* Take a range of count >= 1: the first hole that it fits in, else from the end.
 * PCCD_E_LIMIT: would pass the limit; PCCD_E_NOMEM. */
int eng_ranges_take(struct eng_ranges *ranges, uint32_t count, uint32_t *first);

/* Give a taken range back; merges with neighbouring holes. Cannot fail: take reserves the
 * room that the list of holes may need. */
void eng_ranges_give(struct eng_ranges *ranges, uint32_t first, uint32_t count);

/* ---- which object has an id -------------------------------------------------------- */

#define ENG_NO_OBJECT UINT32_MAX

struct eng_ids_entry {
    uint32_t id;
    uint32_t object; /* index; ENG_NO_OBJECT: a free place */
};

/* Zeroed: there is none. */
struct eng_ids {
    struct eng_ids_entry *table; /* [size], a power of two; at least half is free */
    uint32_t size;
};

void eng_ids_deinit(struct eng_ids *ids);
uint64_t eng_ids_bytes(const struct eng_ids *ids);

/* Make room for `count` ids in all. PCCD_OK or PCCD_E_NOMEM. */
int eng_ids_reserve(struct eng_ids *ids, uint32_t count);

/* Add one that is not there; there is room. */
void eng_ids_add(struct eng_ids *ids, uint32_t id, uint32_t object);
/* Remove one that is there. */
void eng_ids_remove(struct eng_ids *ids, uint32_t id);

/* Index of the object with that id; ENG_NO_OBJECT: there is none. */
uint32_t eng_ids_find(const struct eng_ids *ids, uint32_t id);

/* ---- objects and the scene --------------------------------------------------------- */

/* The part of an object that moves in a step (moving.h). */
enum eng_movement { ENG_STANDS, ENG_MOVES_SOME, ENG_MOVES_ALL };

/* Methods, and the step itself, keep something of a scene and of each of its objects. It
 * is theirs alone: the scene has a slot for each of them, and tells them what happens. */
enum eng_slot { ENG_SLOT_PAPER, ENG_SLOT_WIDE, ENG_SLOT_STEP, ENG_SLOTS };

struct eng_object;

/* Two poses of a whole mesh (coordinates.h): where it is at both ends of the last step,
 * and where the one that is staged takes it. */
struct eng_object_poses {
    double last[2][12];
    double staged[2][12];
};

/* The calls by which the owner of a slot is told. NULL: it does not care. [compute] */
struct eng_slot_calls {
    /* A scene is made: fill the slot. PCCD_E_NOMEM. Before it is freed, also if create
     * failed: empty it. */
    int (*create)(struct eng_scene *scene);
    void (*destroy)(struct eng_scene *scene);
    uint64_t (*bytes)(const struct eng_scene *scene);
    /* An object has its mesh, and its range of vertices: fill the object's slot.
     * PCCD_E_NOMEM. Before it goes, also if add failed: empty it. */
    int (*add)(struct eng_scene *scene, struct eng_object *object);
    void (*drop)(struct eng_scene *scene, struct eng_object *object);
    /* Objects came, went or have another mesh since the last step. */
    void (*changed)(struct eng_scene *scene);
    /* Nearly all leaves that the scene had are gone: give back what was for them. What
     * the last answer holds stays. */
    void (*emptied)(struct eng_scene *scene);
};

/* Vertices first .. end - 1 of an object; none: first >= end. */
struct eng_span {
    uint32_t first;
    uint32_t end;
};

/* An object. What every step reads of every object comes first. */
struct eng_object {
    struct eng_mesh *mesh; /* NULL: this index is free */
    uint32_t id;           /* what records carry */
    struct eng_range vertices;
    double clearance;    /* of the mesh, as the step goes by it; 0: not known (rigid.h) */
    bool has_crowded;    /* as the step goes by it: some features are closer */
    bool is_posed;       /* the rounding reach is that of poses, not of where it was
                       * registered */
    bool has_poses; /* its positions are where `poses` take the mesh, at both ends */
    bool is_new;         /* it was in no step yet */
    bool ends_are_equal; /* x[0] and x[1] hold the same positions of this object */
    /* x[1 - now] has been written to since the last step. */
    bool is_previous_overwritten;
    /* Points of the mesh that are farther apart than that do not meet: in the step, and
     * in later ones until something is written to it (rigid.h). */
    double rounding_reach[2];
    uint64_t staged;                   /* stage number that last wrote to it */
    uint64_t moved_number;             /* moving.number when it came, or moved last */
    enum eng_movement moves;           /* in the last step, and .. */
    enum eng_movement moved_last_step; /* .. in it without the one before */
    struct eng_span marked;            /* if it is some: what has marks (moving.h), .. */
    struct eng_span moved_span;        /* .. and without the step before */
    void *slots[ENG_SLOTS];            /* what the owners of the slots keep of it */
    struct eng_bounds bounds[2];       /* of its triangles, in x[0] and in x[1] */
    struct eng_box_frame frame; /* of its boxes; not in use while framing.number is 0 */
    uint32_t joint; /* of the last step, on which it turned; PCCD_NO_JOINT: none */
    struct eng_object_thickness thickness;
    double half_clearance; /* half of the largest that it has with another object */
    struct eng_object_poses *poses; /* NULL: no pose has moved all of it yet */
};

/* The motion of the last step that was committed (moving.h). */
struct eng_moving {
    uint64_t number;   /* of the step; boxes say by it how old they are */
    uint64_t vertices; /* that move, of .. */
    uint64_t all;      /* .. those of all objects */
    uint32_t objects;  /* that have such */
    bool is_spread;    /* so evenly that what stands is not worth it (method.h, survey) */
    unsigned char
        *moves; /* [vertex_capacity] not 0: it moves; of an object of which some do */
};

/* Objects that need not be tested against themselves in a step (rigid.h). */
struct eng_rigid {
    uint32_t version; /* goes on, and round, with the clearances that the step goes by */
    bool is_possible; /* some have a clearance */
    uint32_t objects; /* that are left out, but for what is crowded */
    uint64_t leaves;  /* of these */
    uint32_t apart;   /* that turn: others see to all of their pairs */
    uint32_t wanted;  /* the first whose clearance is to be found; ENG_NO_OBJECT */
};

/* Which pairs meet at a distance (thickness.h). */
struct eng_thickness {
    bool is_on;          /* some do, in the step */
    bool may_have_radii; /* an object has one, or had */
    bool may_rest;       /* an object leaves pairs thin for their rest, or did */
    double most;         /* the largest radius of all objects */
    double half_clearance;  /* the largest of all objects */
    uint32_t masks_version; /* .. when these were found */
    bool has_changed;    /* a radius has, since the last step */
    double separation;   /* of the step */
    uint64_t number;     /* goes on with radii and separation; boxes and records say by it
                          * what they were made for */
};

/* One object along one axis, while frames are chosen. */
struct eng_box_frame_item {
    double low[2]; /* at both ends */
    double high[2];
    double next_low[2]; /* the least of this object and all behind it */
    uint32_t object;
};

/* The frames of a scene (box_frames.h). */
struct eng_framing {
    /* Which frames the boxes are measured in: the number of the choice, which shows
     * whether boxes are older; 0: in coordinates as they are. */
    uint64_t number;
    uint64_t chosen;  /* the last number */
    uint64_t of;      /* moving.number of the step that they are for; 0: none */
    double scale;     /* of all frames; 1 if there are none */
    bool keeps_order; /* chosen so that nothing seems farther away than it is */
    /* Of number 0: how far from the origin objects are, and how small the features of
     * one, at most and at least since that was chosen. */
    double far;
    double least;
    unsigned ends[2];                 /* of x[]: the ends of the step that they are for */
    struct eng_box_frame_item *items; /* [object_capacity] scratch to choose them */
};

/* A part of the last step in the place of the whole one's (stage.h). */
struct eng_part {
    double (*x[2])[3];
    uint32_t capacity;              /* of positions */
    struct eng_bounds (*bounds)[2]; /* [object_capacity] what the objects' were */
    uint32_t bound_capacity;
};

/* A range written by the step being staged. */
struct eng_write {
    uint32_t object;
    uint32_t first; /* local vertex */
    uint32_t count;
    bool has_start;              /* x0 waits in scene->start */
    bool has_poses;              /* it is by two poses, of all vertices of the object */
    struct eng_bounds bounds[2]; /* of x0, if there is one, and of x1 */
    double rounding_reach[2]; /* as that of an object: INFINITY unless these are poses of
                               * it all */
    uint32_t joint; /* index of the step's, on which it turns; PCCD_NO_JOINT: none */
    bool waits;     /* eng_stage_commit finds out where it is */
};

/* Joints of a step, checked. Their parents are indices among all of them. */
struct eng_joints {
    struct pccd_joint *items; /* [capacity] */
    uint32_t count;
    uint32_t capacity;
};

struct eng_scene {
    struct eng_scene_settings settings;
    struct eng_object *objects;
    uint32_t object_capacity; /* indices 0 .. capacity-1; free ones have mesh = NULL */
    uint32_t object_count;
    uint32_t object_free;          /* the lowest index that may be free */
    struct eng_ids ids;            /* of objects */
    uint64_t leaf_count;           /* of all objects */
    uint64_t leaf_most;            /* that it was since the slots were told `emptied` */
    struct eng_replaced *replaced; /* not settled yet */
    uint32_t replaced_count, replaced_capacity;

    struct eng_ranges vertex_ranges;
    uint32_t vertex_capacity; /* of positions */

    /* x[now] holds the positions that the scene stands at. A step writes its end
     * positions to x[1 - now] and then flips `now`; during and after the step, x[1 - now]
     * is t = 0 and x[now] is t = 1. */
    double (*x[2])[3];
    unsigned now;
    double (*start)[3]; /* x0 of the step being staged, where given */
    uint32_t start_capacity;
    struct eng_part part;

    uint32_t step; /* number of the step; goes round */

    struct eng_moving moving;
    struct eng_rigid rigid;
    struct eng_thickness thickness;
    struct eng_framing framing;
    struct eng_masks masks;

    /* Staging. */
    bool staging;
    bool has_moved_without_answer; /* the last step has moved it, and given up */
    bool is_trial;       /* staging that will be aborted: it writes to `start` alone */
    bool has_lost_start; /* staging was aborted: where the last step began is not known of
                          * what was written to, which stands where it is */
    uint64_t stage;
    uint64_t stage_ns;
    struct eng_copiers copiers; /* of its writes */
    struct eng_write *writes;   /* [write_capacity] */
    uint32_t write_count, write_capacity;
    struct eng_stage_fault twice;    /* the vertex that was written twice last */
    struct eng_joints joints;        /* of the last step, .. */
    uint32_t turning_count;          /* .. in which so many objects turned */
    struct eng_joints staged_joints; /* of the step being staged */

    const struct eng_slot_calls *const *owners; /* [ENG_SLOTS] */
    void *slots[ENG_SLOTS];
    uint64_t builds; /* hierarchies built since the scene was made */
};

/* Stage all of an object as hanging on a staged joint, as eng_stage_turning (turning/)
 * says. Its positions are made by eng_stage_commit, as those of eng_stage_rigid. */
int eng_stage_on_joint(struct eng_scene *scene, uint32_t object_idx, uint32_t joint);

/* Return the object that staged or stands at `object_idx`, or NULL. */
struct eng_object *eng_scene_object(const struct eng_scene *scene, uint32_t object_idx);

/* Return whether an object turns in the step that is staged or, if none is, in the last
 * one. */
static inline bool eng_scene_turns(const struct eng_scene *scene)
{
    return scene->staging ? scene->staged_joints.count > 0 : scene->turning_count > 0;
}

/* Make an empty scene whose slots have these owners. PCCD_E_INVAL, PCCD_E_NOMEM. */
int eng_world_new(const struct eng_scene_settings *settings,
                  const struct eng_slot_calls *const owners[ENG_SLOTS],
                  struct eng_scene **scene);

/* Make room for the positions up to the end of the vertex ranges. PCCD_E_NOMEM:
 * unchanged. */
int eng_world_reserve(struct eng_scene *scene);

/* Close the staging (if none is open: an empty one) and move the scene on: x[1 - now] is
 * then t = 0 and x[now] t = 1. PCCD_E_SEGMENT: two writes to one vertex; the scene stands
 * where it stood and the staging is gone. */
int eng_stage_commit(struct eng_scene *scene);

/* Make the step that the scene has moved on by, between enter and leave, that part of it:
 * x[1 - now] and x[now] are where its vertices are at span[0] and span[1], which is x0 +
 * t (x1 - x0), each operation rounded to the nearest double, and not beyond x0 and x1; x1
 * itself at 1. So two parts that follow each other share their positions. Boxes, and
 * records of what stands, are of no step before or behind it. PCCD_E_NOMEM: reserve. */
int eng_part_reserve(struct eng_scene *scene);
void eng_part_enter(struct eng_scene *scene, const double span[2]);
void eng_part_leave(struct eng_scene *scene);

#endif
