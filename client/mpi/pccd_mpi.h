/* pccd_mpi.h - one scene over the ranks of an MPI program: every collision, with the same
 * bytes for any number of ranks.
 *
 * A mesh is given in parts: each rank brings some of its triangles and the positions of
 * the vertices that it owns, with the numbers that they have in the whole mesh. Each rank
 * gets some of the contacts. All of them together are the records that one process would
 * get for the whole scene, bit for bit, and so is the hash.
 *
 * Room:     client/mpi; installed. May include: mpi.h, pccd.h. Compiles as C++.
 * Does:     cut the scene into parts of its own along a curve through space, send
 *           positions to where they are needed, compute in each rank by libpccd with the
 *           url direct:, keep each contact once, and add up.
 * Does not: start ranks or carry bytes: MPI does.
 * Threads:  one thread of a rank at a time, the one that may call MPI: with more than one
 *           rank in a program, MPI_Init_thread must have given MPI_THREAD_FUNNELED. Any
 *           other thread may call pccd_mpi_cancel meanwhile, which does not call MPI.
 *
 * Every function with a world is collective: all ranks call it, in the same order; but
 * for pccd_mpi_cancel, pccd_mpi_error_text and pccd_mpi_feature. What is "the same on
 * every rank" is compared first. All ranks get the same status; after an error nothing
 * has changed, but objects that were to move count as if they had stood still in the last
 * step. pccd_mpi_error_text names the rank and what was wrong. Three errors end a world:
 * every later call but pccd_mpi_close is E_STATE. They are E_TIMEOUT, a rank did not
 * come; E_SYSTEM, MPI itself failed; E_NOMEM, where it left things half done. When a rank
 * dies, MPI ends the others as well, as a rule. As with direct:, any rounding will do.
 *
 *     struct pccd_mpi *world;
 *     pccd_mpi_open(MPI_COMM_WORLD, NULL, &world);
 *     pccd_mpi_mesh_put(world, &part, &mesh, NULL);      (this rank's part)
 *     pccd_mpi_add(world, mesh, &object);
 *     for (each step) {
 *         struct pccd_motion motion = {.object = object, .count = part.vertex_count,
 *                                      .format = PCCD_FORMAT_F64, .x1 = x1};
 *         pccd_mpi_step(world, &motion, 1, NULL, &answer);
 *         use(answer.contacts, answer.count);            (this rank's share)
 *     }
 *     pccd_mpi_close(world);
 */
#ifndef PCCD_MPI_H
#define PCCD_MPI_H

#include "pccd.h"
#include <mpi.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default) /* the library is built with hidden visibility */
#endif

struct pccd_mpi;

struct pccd_mpi_options {
    size_t struct_bytes;   /* sizeof(struct pccd_mpi_options); 0 reads as that */
    int timeout_ms;        /* how long to wait for another rank; 0 = 60000 */
    uint32_t threads;      /* of a rank's steps; 0: its processors, divided by the ranks
                              of the machine that may run on the same ones */
    uint64_t result_bytes; /* most memory for a page of records, taken as they come;
                              0: for record_limit, but 4 GiB at most */
    uint64_t record_limit; /* records of an answer that are kept, of all ranks together,
                              the first in order; 0 = 16 Mi, as in one process. The same
                              on every rank */
};

/* Open a world for the ranks of `comm`, of which the library makes a communicator of its
 * own. `options` NULL: the defaults; timeout_ms is the same on every rank. MPI must be
 * initialised. Errors, with *world = NULL: those of pccd_connect for direct:, E_STATE
 * (MPI is not initialised), E_INVAL, E_NOMEM. */
int pccd_mpi_open(MPI_Comm comm, const struct pccd_mpi_options *options,
                  struct pccd_mpi **world);
/* Free it; NULL is allowed. */
void pccd_mpi_close(struct pccd_mpi *world);

/* Set *threads to how many threads the steps of a rank have unless the options say so:
 * the processors that it was started on, divided by the ranks of its machine that were
 * started on the same ones; 1 at least. Collective, without a world. E_SYSTEM: MPI has
 * failed. */
int pccd_mpi_threads(MPI_Comm comm, uint32_t *threads);

/* Return a sentence about the last call that failed, the same on every rank; "" when none
 * has. With NULL: about the last pccd_mpi_open of this thread. */
const char *pccd_mpi_error_text(const struct pccd_mpi *world);

/* Part of a mesh that a rank gives. All numbers are those of the whole mesh, from 0. A
 * rank may have nothing; one may have all. */
struct pccd_mpi_part {
    size_t struct_bytes; /* sizeof(struct pccd_mpi_part); 0 reads as that */
    /* Of the whole mesh; the same on every rank. */
    uint32_t vertex_total, triangle_total;
    /* Vertices that this rank owns. Each vertex of the mesh has exactly one owner, who
     * gives its positions in all steps. */
    uint32_t vertex_count;
    const uint32_t *vertices; /* [vertex_count]; NULL: those after the ranks before */
    enum pccd_format format;  /* of x */
    const void *x;            /* [vertex_count][3] registered positions */
    const double *radii;      /* [vertex_count], as in struct pccd_mesh_data. NULL: 0 */
    /* Triangles, edges and points of this rank, with any vertices. Each triangle is in
     * one part. An edge or point may be in several. */
    uint32_t triangle_count, edge_count, point_count;
    const uint32_t *triangles;        /* [triangle_count][3] */
    const uint32_t *triangle_numbers; /* NULL: those after the ranks before */
    const uint32_t *edges;            /* [edge_count][2] */
    const uint32_t *points;           /* [point_count] */
};

/* Put a mesh in parts, as pccd_mesh_put puts one: *mesh 0 makes one, another handle
 * replaces it. `info`, which may be NULL, tells of the whole mesh. Errors: those of
 * pccd_mesh_put; E_INVAL: a vertex has two owners or none, a triangle is in two parts or
 * none. */
int pccd_mpi_mesh_put(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                      uint32_t *mesh, struct pccd_mesh_info *info);
int pccd_mpi_mesh_destroy(struct pccd_mpi *world, uint32_t mesh);

/* Do as pccd_scene_add, pccd_scene_remove, pccd_object_set and pccd_pair_ignore do, with
 * the same arguments on every rank. A world has one scene. Its objects have the handles
 * that they would have in a scene of one process. */
int pccd_mpi_add(struct pccd_mpi *world, uint32_t mesh, uint32_t *object);
int pccd_mpi_remove(struct pccd_mpi *world, uint32_t object);
int pccd_mpi_object_set(struct pccd_mpi *world, uint32_t object,
                        const struct pccd_object_settings *settings);
int pccd_mpi_pair_ignore(struct pccd_mpi *world, uint32_t object_a, uint32_t object_b,
                         bool ignored);

/* Step the whole scene, as pccd_step does one. motions[]: of this rank's vertices, none
 * on some ranks perhaps; `first` and `count` are places in the order of its part.
 * Vertices that no motion has stand still. `settings`, which may be NULL, is the same on
 * every rank; `threads` 0 means what the options say; `hold` must be off.
 *
 * answer: contacts, pairs and count are this rank's records, in canonical order, valid
 * until the next call with the world, and not to be released. All other numbers are of
 * the whole answer, the same on every rank: total, counts, possible, initial, inside,
 * toi_first, safe_step, verdict, hash. Times are those of the slowest rank; counters and
 * threads are sums. A record is kept by the rank that has its first feature.
 *
 * Mode first-per-pair is refused (E_INVAL): no rank knows all contacts of two objects.
 * In mode any the first rank that proves a contact ends the step of all. deadline_ns
 * begins when the last rank has come. To cut the scene, and to choose ghosts and make
 * meshes of them, cannot end early: the ranks look at the deadline after each. When a
 * step has ended early, everything has moved. Errors: those of pccd_step. */
int pccd_mpi_step(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_step_settings *settings,
                  struct pccd_answer *answer);

/* Ask about the whole scene, as pccd_ask_near does of one: where its last step ended or
 * began; if any rank gives motions, the objects move first, and it is answered for where
 * they begin or end. `settings` (NULL: the defaults) is the same on every rank. answer:
 * near and count are this rank's records, by the ranks that have their first features;
 * all other numbers are of the whole, as for a step. Of VERTICES vertex_bounds[count] are
 * those of the vertices that this rank owns: of all objects by increasing handle (or of
 * object_a), each in the order of its part. The last step's answer is gone. Errors: those
 * of pccd_ask_near; E_INVAL: NEAREST or DEPTH of an object that has free edges or points.
 */
int pccd_mpi_near(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_near_settings *settings,
                  struct pccd_answer *answer);

/* End the pccd_mpi_step or pccd_mpi_near that this rank is in, on all ranks, as soon as a
 * deadline would; one rank is enough. If anything was left to do, the answer is
 * incomplete: PCCD_INCOMPLETE_CANCELLED. While this rank is in no such call, nothing
 * happens, nor to a later one; nor to NULL. Any thread, while another is in the call,
 * also in a signal handler; it does not wait. The world must not be closed meanwhile. */
void pccd_mpi_cancel(struct pccd_mpi *world);

/* Hand all records of the last answer, in canonical order, to `each` on rank `root`, some
 * thousands at a time: of struct pccd_pair in mode pairs, of struct pccd_near for what is
 * near, of double for bounds of vertices, else of struct pccd_contact. `each` is called
 * on `root` alone, and returns 0 to go on; with another value: E_CANCELLED. */
typedef int (*pccd_mpi_records_fn)(void *context, const void *records, uint64_t count);
int pccd_mpi_gather(struct pccd_mpi *world, int root, pccd_mpi_records_fn each,
                    void *context);

/* Get the vertices, by their numbers in the whole mesh, of a feature in one of this
 * rank's records: of `points` vertices, as kinds say: 1 itself, 2 the ends of an edge,
 * the lower first, 3 the corners of a triangle. Not collective. E_HANDLE, E_INVAL,
 * E_INDEX: the rank knows nothing of the feature; E_NOMEM. */
int pccd_mpi_feature(struct pccd_mpi *world, uint32_t object, uint32_t points,
                     uint32_t feature, uint32_t vertices[3]);

/* Share that a rank has of the last step. */
struct pccd_mpi_share {
    size_t struct_bytes;   /* sizeof(struct pccd_mpi_share); 0 reads as that */
    uint64_t own;          /* triangles, free edges and points of this rank */
    uint64_t ghosts;       /* those of others that it has to know */
    uint64_t own_vertices; /* vertices of its own triangles, edges and points */
    uint64_t ghost_vertices;
    uint64_t sent_bytes; /* by this rank, in the last step */
    uint64_t work;       /* counted, of this rank, in the last step */
    double imbalance;    /* largest work of a rank over the mean, of the last step
                            that did not end early; 1: none since the last cut */
    uint64_t cuts;       /* how often the scene was cut anew so far */
    uint64_t searches;   /* how often ghosts were chosen so far */
};
int pccd_mpi_get_share(struct pccd_mpi *world, struct pccd_mpi_share *share);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
