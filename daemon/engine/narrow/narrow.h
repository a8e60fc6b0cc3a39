/* narrow.h - the narrow phase: what becomes of the candidates that a method has found.
 *
 *     method      fills struct eng_pairs: points, and which of them each pair has
 *     narrow.c    contacts, and mode pairs
 *                 -> narrow_thick.c   takes those apart that meet at a distance
 *                 -> narrow_touching.c   tells what becomes of those that touch
 *     narrow_near.c    what is near
 *     -> elementary/batch.c   decides, by the row of the question
 *     -> result/              records
 *
 * Threads: [team]; what a worker has belongs to one thread.
 */
#ifndef ENG_NARROW_H
#define ENG_NARROW_H

#include "batch.h"
#include "distance.h"
#include "thick.h"
#include "thickness.h"
#include "touching.h"
#include "worker.h"
#include "world.h"

/* A thread's memory for pairs that meet at a distance. */
struct eng_narrow_thick {
    struct eng_thick thick;
    struct eng_thick_lanes lanes;
    struct eng_distances distances; /* of registered positions */
    uint64_t candidates;            /* tested in this step */
    uint64_t survivors;
    uint32_t number[2][ENG_CHUNK_MAX]; /* of the pairs of either part, among all */
    uint32_t quads[2][ENG_CHUNK_MAX][4];
    double radius[ENG_CHUNK_MAX][3]; /* of the first part, which is thick */
    bool is_thin[ENG_CHUNK_MAX];
};

/* Records of the last features, by key, to each of which others of its name are added
 * where it is: most of them follow soon. record NULL: none. */
#define ENG_NEAR_RECENT_BITS 10
#define ENG_NEAR_RECENT      (1u << ENG_NEAR_RECENT_BITS)

struct eng_near_recent {
    uint64_t key;
    struct pccd_near *record;
};

/* Edges that were looked up, each at a place of its ends': most are asked for again soon.
 * All zeros: none. */
#define ENG_EDGES_KNOWN 4096u

struct eng_edges_known {
    struct eng_edge_known {
        const struct eng_mesh *mesh;
        uint32_t low_end;
        uint32_t high_end;
        uint32_t edge;
    } at[ENG_EDGES_KNOWN];
};

/* A thread's memory for what is near. */
struct eng_narrow_near {
    struct eng_distances distances;
    struct pccd_pair names[ENG_CHUNK_MAX]; /* of what the batch has found */
    bool has_recent;                       /* there is any */
    struct eng_near_recent recent[ENG_NEAR_RECENT];
    struct eng_edges_known edges;
    double least;    /* d_lo of what was found; 2e18: nothing was */
    double greatest; /* d_hi of what was found; 0: nothing was */
    uint64_t pairs;  /* that were found, but for crossings */
    uint64_t crossings;
};

struct eng_narrow {
    struct eng_batch batch;
    struct eng_narrow_thick *thick; /* NULL: no step has asked for it yet */
    struct eng_narrow_near *near;   /* NULL: no question has asked for it yet */
    struct eng_touching *touching;  /* the same */
};

static inline struct eng_narrow *eng_narrow_of(const struct eng_worker *worker)
{
    return worker->narrow;
}

/* Reserve memory for what is asked of the scene, once. PCCD_E_NOMEM. [compute] */
int eng_narrow_reserve(struct eng_worker *worker, const struct eng_scene *scene,
                       const struct eng_question *question);
void eng_narrow_free(struct eng_worker *worker);
uint64_t eng_narrow_bytes(const struct eng_worker *worker);

/* Get ready: what was counted is 0. [compute] */
void eng_narrow_begin(struct eng_worker *worker);

/* Test candidates of one kind, of which the method sets kind, known, count, points, quads
 * or fives, and keep what is found as the question wants it. Words of the points: word0
 * is the index of the object << 32 | the vertex's in the scene's arrays, word1 the id of
 * the object << 32 | the vertex's in its mesh. `names`: of the candidates, by number. */
void eng_narrow_test(struct eng_worker *worker, struct eng_pairs *pairs,
                     eng_names_fn names);

/* ---- within this folder ------------------------------------------------------------ */

/* So many bytes behind a record that is written the list is fetched: when those of the
 * next chunk come, it is not in the near caches any more. */
#define ENG_FETCHED_AHEAD 4096u

/* Divide the pairs of a step with thickness: those that meet at a distance go to
 * parts[0], the others, and those that are left thin for their rest, to parts[1]. Where
 * pairs may rest, those that certainly stay beyond r may be in neither. */
void eng_narrow_split(struct eng_worker *worker, const struct eng_pairs *pairs,
                      struct eng_pairs parts[2]);

/* Tell what becomes of contacts that the batch has found and that are there at t = 0, or
 * leave them out, as question->touching wants it. */
void eng_narrow_touching(struct eng_worker *worker, const struct eng_pairs *pairs);

/* Return whether a pair whose distance is *found is within that of the question and its
 * radii, and not left out for its rest, exactly. VERTICES: found->lo becomes its bound,
 * and what is left thin has no radii. */
bool eng_narrow_is_within(struct eng_worker *worker, const struct eng_pairs *pairs,
                          uint32_t number, struct eng_distance *found);

/* Return the range of all names in a scene; get ready for names within it. [compute] */
struct eng_name_range eng_near_range(const struct eng_scene *scene);
void eng_near_begin(struct eng_worker *worker, const struct eng_name_range *range);

/* Change names and distances of what the batch has found to those of the features between
 * which the distance is, functions of their own points. An edge that ends above a face is
 * near it: the two are the vertex and the face, and each other edge that ends there leads
 * to them, too. */
void eng_closest_features(struct eng_worker *worker, const struct eng_pairs *pairs);

/* Test and keep, as eng_narrow_test, in a question about what is near. */
void eng_near_test(struct eng_worker *worker, struct eng_pairs *pairs,
                   eng_names_fn names);

#endif
