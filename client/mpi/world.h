/* world.h - what a rank keeps of a world: its meshes, its objects, and who needs what.
 *
 * Three parts of a mesh lie on different ranks as a rule:
 * - the vertices that the caller gave to this rank, with their positions: *given*;
 * - the numbers of a run of vertices, with who was given each: the *directory*;
 * - the leaves (triangles, free edges, free points) whose contacts this rank computes:
 *   *own*, which the library has dealt out; beside them, of other ranks, *ghosts*.
 * Leaves have numbers: a triangle its own, then come free edges, then free points. Each
 * feature belongs to the lowest leaf that has it, and so to a rank, wherever it moves.
 *
 * In each rank libpccd has, of each object, a mesh of the own leaves and the ghosts, all
 * sorted by the numbers of the whole. So what is lower there is lower in the whole, and
 * orientation, order and numbers of a record are those of one process.
 */
#ifndef RANKS_WORLD_H
#define RANKS_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "moving_boxes.h"
#include "object_attributes.h"
#include "pccd_mpi.h"
#include "rank_link.h"
#include "rank_stop.h"

#define RANKS_NONE UINT32_MAX

/* Bit k of `owns`: corner k belongs to this leaf; bit 3 + k: the side from corner k. */
#define RANKS_OWNS_CORNER(k) (1u << (k))
#define RANKS_OWNS_SIDE(k)   (8u << (k))

struct ranks_leaf {
    uint32_t number;
    uint32_t v[3];    /* of a free edge the last two are the same, of a point all */
    uint32_t side[3]; /* number of the edge from corner k; RANKS_NONE: there is none */
    uint32_t owns;
};

/* Owner of a vertex: the rank that was given it. */
struct ranks_vertex_owner {
    int32_t rank; /* -1: nowhere */
    uint32_t index;
};

enum ranks_closed { RANKS_MESH_NOT_KNOWN, RANKS_CLOSED_MESH, RANKS_OPEN_MESH };

struct ranks_mesh {
    uint32_t handle;
    bool is_gone; /* destroyed; kept while objects are made of it */
    uint32_t objects;
    struct pccd_mesh_info info; /* of the whole */
    uint32_t vertex_total, triangle_total;
    uint32_t edge_leaves; /* numbers below triangle_total + edge_leaves: no points */
    bool has_radii;       /* any rank gave some */
    double radius_max;    /* of all ranks */
    /* given */
    uint32_t vertex_count;
    double (*x)[3];
    double *radii; /* NULL unless has_radii */
    /* the directory of vertices span * rank to span * (rank + 1) - 1 */
    uint32_t span;
    struct ranks_vertex_owner *owners;
    uint32_t *numbers;        /* of given vertices */
    enum ranks_closed closed; /* depth.c */
    uint32_t open[4]; /* the first edge that shows that it is not: its ends, and how often
                         faces run from the first to the second and back */
    /* As they were given. The first object takes them, the last one gives its own
     * back. */
    struct ranks_leaf *leaves;
    uint32_t leaf_count;
};

/* An object's mesh in this rank's libpccd: numbers of the whole, ascending. */
struct ranks_local {
    uint32_t vertex_count, edge_count, triangle_count, leaf_count;
    uint32_t *vertices;
    uint32_t *edges;
    uint32_t *triangles;
    uint64_t *owns_vertex, *owns_edge; /* a bit for each: it belongs to this rank */
    /* Local vertices of each leaf's corners, by its number, until libpccd has them. */
    uint32_t (*named)[3];
    /* Numbers of the whole; NULL until somebody asks (features.c). */
    uint32_t (*ends)[2];
    uint32_t (*corners)[3];
};

struct ranks_object {
    uint32_t handle;
    struct ranks_mesh *mesh;
    uint32_t local_mesh; /* handle in libpccd */
    struct common_attributes settings;
    /* Given vertices: at the end of the last step; memory for the ends of the next one,
     * `start` only if it was needed; the ends of the step that is being made. */
    double (*x)[3];
    double (*next)[3];
    double (*start)[3];
    const double (*from)[3];
    const double (*to)[3];
    /* Where the last step began: x where it stood still, else `start` or `next`. */
    const double (*begun)[3];
    uint64_t
        *written; /* a bit for each given vertex that the step moves; NULL: none yet */
    /* Where each given vertex may be, in the margin that was there when ghosts were
     * chosen (boxes.h): they are right while both ends of a step are. NULL: none were
     * yet. */
    float (*cover)[6];
    struct ranks_margin margin;
    /* Of some given vertices, when ghosts were chosen: where they were, and their way in
     * that step (margins.c). */
    double (*guess)[6];
    bool has_guess;
    struct ranks_leaf *own; /* along the curve */
    uint32_t *weights;      /* of own leaves (balance.c); NULL: each weighs the same */
    /* While they are weighed: pairs that begin with each local vertex, or edge. */
    uint32_t *vertex_pairs, *edge_pairs;
    uint32_t own_count;
    uint32_t own_vertex_count;
    struct ranks_leaf *ghosts;
    uint32_t ghost_count;
    struct ranks_leaf
        *neighbours; /* ghosts for rest_rings (neighbours.c); not each once */
    uint64_t neighbour_count;
    uint32_t neighbour_rings; /* for which they are right */
    struct ranks_local local;
    bool is_built;     /* libpccd has the mesh of `own` and `ghosts` */
    bool is_unsent;    /* on some rank libpccd has not got the last `local` yet */
    bool is_elsewhere; /* libpccd has it elsewhere than at x, on every rank */
};

/* Plan of who gets what: given vertices that go to each rank, and local ones that come.
 * Sorted by (rank, object): those of rank r and object o are first[r * object_count + o]
 * up. */
struct ranks_plan {
    uint32_t object_count;
    uint64_t *out_first, *in_first; /* [size * object_count + 1] */
    uint32_t *out;                  /* given vertex of that object */
    uint32_t *in;                   /* local vertex of that object */
    /* [size] What comes from a rank is of one object, of which it is one run of local
     * vertices: so it is received where it goes. That is so of what ranks were given one
     * run of a mesh each. */
    bool *is_run;
    /* Positions on their way to other ranks, and from them unless they are runs, at one
     * end of a step: memory that steps do not ask for again. */
    double (*out_x)[3], (*in_x)[3];
};

struct ranks_pair {
    uint32_t a, b; /* objects that ignore each other */
};

/* The bound of a vertex, as it is hashed. */
struct ranks_bound {
    uint32_t object; /* handle */
    uint32_t vertex; /* number of the whole */
    double bound;
};

struct pccd_mpi {
    struct ranks_link link;
    struct ranks_stop stop; /* of steps and of what is near */
    struct pccd_client *client;
    uint32_t scene;
    uint32_t threads; /* of its steps, unless they say so */
    uint32_t team;    /* of the call that is being made: as many as libpccd's (team.h) */
    struct ranks_mesh **meshes;
    uint32_t mesh_count, mesh_number; /* the latter: made so far */
    struct ranks_object **objects;    /* by increasing handles */
    uint32_t object_count;
    struct ranks_pair *ignored;
    uint32_t ignored_count;
    struct ranks_plan plan;
    bool is_cut;          /* each object's `own` is what the curve says */
    bool is_covered;      /* ghosts were chosen for these objects, settings and reach */
    double reach;         /* separation for which they were */
    bool is_for_pairs;    /* they do for mode `pairs`, too, which asks for whole steps */
    bool is_once;         /* they do for that step alone, made again or backwards, too */
    uint32_t gone, lasts; /* steps since then; for how many, at most, they are right */
    /* the last answer */
    enum pccd_mode mode;
    void *records; /* in `copied`, or in the page that is held */
    uint64_t record_count;
    uint64_t found;        /* by the last step, of all ranks together */
    uint64_t page_hash[4]; /* of contacts and pairs, as in struct ranks_sums */
    struct pccd_answer page;
    void *written; /* where records of the page that comes next were; NULL: nowhere yet */
    void *copied;
    uint64_t copied_bytes;
    uint64_t record_limit; /* of all ranks together */
    bool is_merged; /* it has features that other ranks may have found, too (merge.c) */
    struct pccd_near *strays; /* what was found here and is not this rank's */
    uint64_t stray_count, stray_capacity;
    bool has_bounds; /* it has bounds of vertices in the place of records (bounds.c) */
    struct ranks_bound *bounds;
    double *bound_values;
    uint64_t bound_count;
    struct pccd_mpi_share share;
    uint64_t weighings; /* steps of libpccd that nobody has asked for */
    /* How long the last cut took, and what was lost since because some ranks waited. */
    uint64_t cut_ns;
    double lost_ns;
    /* In the unit of share.work: what the last choice of ghosts took, and the steps since
     * then. How many ghosts all ranks have beside what they own. */
    double choice_work, right_work, ghost_part;
    /* How much margin ghosts.c leaves around what moves (margins.c): so many steps of
     * what is fast, so many times as much as at first of what is slow. */
    double fast_steps, slow_margin;
};

/* Return what has a handle; NULL: there is none. */
struct ranks_mesh *ranks_find_mesh(const struct pccd_mpi *world, uint32_t handle);
struct ranks_object *ranks_find_object(const struct pccd_mpi *world, uint32_t handle);
/* Return the place of an object in world->objects; object_count: there is none. */
uint32_t ranks_place_of_object(const struct pccd_mpi *world, uint32_t handle);

/* Make room for one more in an array of pointers; NULL: no memory, and it stays as it
 * was. */
void **ranks_room_for_one(void **array, uint32_t count);

/* Return `status`, of the last call of libpccd; if it has failed, set the error to that
 * and why. */
int ranks_local_status(struct pccd_mpi *world, int status, const char *what);
/* Set the error to "out of memory". Returns PCCD_E_NOMEM. */
int ranks_no_memory(struct pccd_mpi *world);
/* Collective. Return the status of the lowest rank that has no memory, or PCCD_OK. */
int ranks_agree_memory(struct pccd_mpi *world, bool has_memory);

/* Hash arguments that have to be the same; goes on from `hash`. */
uint64_t ranks_hash(uint64_t hash, const void *bytes, size_t count);

void ranks_mesh_free(struct ranks_mesh *mesh);
/* Free a mesh, of which no object is made, and take it out of world->meshes. */
void ranks_forget_mesh(struct pccd_mpi *world, struct ranks_mesh *mesh);
void ranks_local_deinit(struct ranks_local *local);
void ranks_plan_deinit(struct ranks_plan *plan);
void ranks_object_free(struct ranks_object *object);

bool ranks_are_ignored(const struct pccd_mpi *world, uint32_t handle_a,
                       uint32_t handle_b);
/* Return whether features of the two objects may meet, in a step of the scene. a, b:
 * places in world->objects. */
bool ranks_may_meet(const struct pccd_mpi *world, uint32_t a, uint32_t b);

#endif
