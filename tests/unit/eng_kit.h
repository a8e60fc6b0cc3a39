/* eng_kit.h - small meshes, queries and random numbers for the engine's unit tests. */
#ifndef TEST_ENG_KIT_H
#define TEST_ENG_KIT_H

#include "cases.h"

#include "mesh.h"
#include "near.h"
#include "poly.h"
#include "prng.h"
#include "query.h"
#include "step.h"

/* All that a mesh may have: x and radii of vertices, triangles, edges and points by their
 * vertices; what it has none of may be NULL. */
struct kit_shape {
    struct eng_mesh_counts counts;
    const void *x, *triangles, *edges, *points;
    const double *radii;
};
struct eng_mesh *kit_mesh_of(const struct kit_shape *shape);

/* A committed mesh of x, double[][3], and triangles, uint32_t[][3]; fails the test if it
 * cannot be made. The caller releases it. */
struct eng_mesh *kit_mesh(const void *x, uint32_t vertex_count, const void *triangles,
                          uint32_t triangle_count);
/* The same with radii of its vertices; NULL: none. */
struct eng_mesh *kit_mesh_thick(const void *x, uint32_t vertex_count,
                                const void *triangles, uint32_t triangle_count,
                                const double *radii);

/* `side` x `side` squares of two triangles over 0 .. 1 in x and y, at height z. */
struct eng_mesh *kit_sheet(uint32_t side, double z);

/* An axis-aligned box of 12 triangles whose normals point outward, from its corner `low`
 * to `high`; `inward`: inward. */
struct eng_mesh *kit_box(const double low[3], const double high[3], bool inward);

/* `count` triangles of about the size 1 / count^(1/3) in the unit cube, no vertex
 * shared. */
struct eng_mesh *kit_soup(struct prng *random, uint32_t count);

struct eng_scene *kit_scene(void);

/* Put a mesh into a scene, which alone holds it then. Returns its index. */
uint32_t kit_add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t id);

/* All contacts of a step, in a mode, by a method. */
struct eng_question kit_contacts(enum pccd_mode mode, enum pccd_method method);

/* Answers to a step of what is staged, and to a question; both succeed. */
struct eng_step_result kit_step(struct eng_scene *scene,
                                const struct eng_question *settings);
struct eng_step_result kit_near(struct eng_scene *scene,
                                const struct eng_question *settings);

/* The scene of a case: meshes whose ids are 1, 2, ... in the order in which they are
 * put. */
#define KIT_OBJECTS_MAX 64u
struct kit {
    struct eng_scene *scene;
    uint32_t count;
    uint32_t idx[KIT_OBJECTS_MAX];
};
extern struct kit kit;

/* An empty one in the place of the last. */
void kit_begin(void);
void kit_put(struct eng_mesh *mesh);
void kit_begin_with(struct eng_mesh *a, struct eng_mesh *b);

struct eng_question kit_question(enum pccd_near_what what);

/* Ask by every method with every instruction set by one thread, and by teams of two and
 * three with one set, another one in each question: the same complete answer each time.
 * Records are the last one's. */
struct eng_step_result kit_ask(const struct eng_question *settings);
struct eng_step_result kit_ask_for(enum pccd_near_what what);

/* Record i of an answer. */
static inline const struct pccd_near *kit_record(const struct eng_step_result *result,
                                                 uint64_t i)
{
    return (const struct pccd_near *)result->records + i;
}

/* Whose features it is about. */
void kit_check_names(const struct pccd_near *record, uint32_t kind, uint32_t object_a,
                     uint32_t feature_a, uint32_t object_b, uint32_t feature_b);

/* Return a word of any size, often the least or the greatest. */
uint32_t kit_word(struct prng *random);

/* A polynomial of numbers that GMP makes longer as needed. */
void kit_poly_init(struct eng_poly *poly);
void kit_poly_deinit(struct eng_poly *poly);

/* A query whose features meet at exactly `t` = numerator / 8, and maybe before: every
 * coordinate is a multiple of 2^-9 below 2^9, so no rounding took part in its making. */
void kit_plant(struct prng *random, enum pccd_kind kind, unsigned numerator,
               struct eng_query *query);

/* Times a power of two, then plus an offset along each axis. */
void kit_place(struct eng_query *query, double factor, double offset);

#endif
