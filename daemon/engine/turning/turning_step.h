/* turning_step.h - the objects of a step that turn, each with all that it may meet; and,
 * of a step in which all else that moves goes straight by poses, those that do.
 *
 * List the pairs of objects of which one turns, or moves, by boxes and spheres around
 * what each of them sweeps; then have all threads test them (turning.h, straight.h),
 * large ones in tasks. Which are large is a matter of the meshes of all pairs of their
 * kind alone: so are the tasks, and where one of them ends for want of looks, whatever
 * threads there are. The methods leave objects that turn out (masks.h).
 *
 * Threads: prepare, begin: [compute]; perform: [team].
 */
#ifndef ENG_TURNING_STEP_H
#define ENG_TURNING_STEP_H

#include <stdatomic.h>

#include "question.h"
#include "sort.h"
#include "turning.h"
#include "world.h"

/* The boxes of an object, kept from step to step while it stands. */
struct eng_turning_part {
    struct eng_body body;
    uint64_t fitted; /* moving.number of the step for which they were fitted; 0: none */
    bool takes_part; /* in this step */
    bool wants_fit;  /* it may meet one that turns by spans, and has to have all boxes */
    struct eng_turning_bend bend; /* if it turns */
};

/* A sphere that an object stays in at all times of a step: its middle goes straight. */
struct eng_turning_sphere {
    double middle[2][3]; /* at either end of the step */
    double radius;
};

/* An object among those that may meet one that turns, or moves. */
struct eng_turning_item {
    struct eng_bounds box; /* around all places of it in the step, thickness included */
    struct eng_turning_sphere sphere; /* thickness included, too */
    uint32_t object;
    bool is_sought; /* it turns; or goes straight, where the step is about these, too */
};

/* Two of these that may meet. */
struct eng_turning_couple {
    uint32_t a; /* indices of objects */
    uint32_t b;
    uint32_t task_count;
    atomic_bool is_known;   /* nothing is left to be tested */
    atomic_bool is_limited; /* mode first: a task of it met a limit */
};

/* Knowledge of the rest of a step, when turning objects have their turn. */
enum eng_turning_rest { ENG_REST_IS_FREE, ENG_REST_IS_OPEN, ENG_REST_MEETS };

struct eng_turning_step {
    const struct eng_scene *scene;
    struct eng_worker *const *workers; /* [worker_count] those of the step */
    uint32_t worker_count;
    double separation;
    double resolution;
    uint64_t tests_most;
    bool is_test; /* every second couple goes by chords that can, however much it turns */
    enum pccd_mode mode; /* any tries couples by spans */
    struct eng_turning_part *parts; /* [part_capacity] by object */
    uint32_t part_capacity;
    struct eng_turning_item *items; /* [item_capacity] */
    struct eng_radix_key *keys;     /* [2 key_capacity] */
    uint32_t *joining;              /* [item_capacity] objects of couples */
    uint32_t item_count, item_capacity;
    uint32_t joining_count;
    struct eng_turning_couple *couples; /* large ones first */
    uint32_t couple_count, couple_capacity;
    uint32_t divided_count; /* so many of them, the first ones, are divided */
    uint32_t key_capacity;
    uint64_t *tasks; /* [divided_count][ENG_TURNING_TASKS] */
    uint32_t task_capacity;
    bool turns;    /* it is about objects that turn */
    bool by_poses; /* and about those that go straight, all by poses */
    bool is_alone;   /* by one thread: others of its OpenMP team have other steps */
    bool has_failed; /* there was no memory for all couples */
    struct eng_path path;
    atomic_uint next_body;
    atomic_uint next_try;
    atomic_uint next_couple;
    atomic_uint next_task;
    atomic_int rest; /* enum eng_turning_rest */
};

#define ENG_TURNING_TASKS 32u

/* Two objects are tested in tasks if they have so many leaves, and so large a share of
 * all that are tested: 1 / SHARES. Of more couples there are enough for every thread, and
 * each task begins anew at the roots. */
#define ENG_TURNING_LARGE  512u
#define ENG_TURNING_SHARES 32u

void eng_turning_step_deinit(struct eng_turning_step *step);
uint64_t eng_turning_step_bytes(const struct eng_turning_step *step);

/* Do what can fail before anything moves, for a step that is about objects that turn, and
 * may be about those that go straight. PCCD_E_NOMEM. */
int eng_turning_step_prepare(struct eng_turning_step *step, const struct eng_scene *scene,
                             bool turns, bool may_be_by_poses,
                             struct eng_worker *const *workers, uint32_t count);

/* List the pairs of objects, when the positions have moved on. `worker`: the first. */
void eng_turning_step_begin(struct eng_turning_step *step, bool by_poses,
                            struct eng_worker *worker, uint32_t threads);

/* Do a thread's part, when it has done its other tasks; waits for the others before the
 * first pair. */
void eng_turning_step_perform(struct eng_turning_step *step, struct eng_worker *worker);

#endif
