/* answer_cache.h - keeps the records of what stands still from one answer to the next.
 *
 * Know the last complete answer. A pair of features of which neither moves (moving.h) has
 * the record that it had there, so the methods search for other pairs only; put both
 * parts together.
 *
 * A step: begin says whether the last answer serves; then the records that stand are
 * taken out of it (select), and what the step found is merged into them (merge); finish
 * notes the new answer.
 */
#ifndef ENG_ANSWER_CACHE_H
#define ENG_ANSWER_CACHE_H

#include "merge.h"
#include "question.h"
#include "result.h"
#include "step_result.h"
#include "world.h"

struct eng_answer_cache {
    /* The last complete answer, whose records are the step memory's. */
    bool is_valid;
    uint64_t number; /* of the motion (moving.h) */
    enum pccd_mode mode;
    double tolerance;
    uint32_t masks_version;
    uint64_t thickness; /* scene->thickness.number */
    double separation;
    double approach;
    bool no_hash;
    uint64_t count;
    struct eng_counts counts;
    enum pccd_verdict verdict;
    struct pccd_pair proof; /* mode any, verdict yes: a pair that meets */

    bool objects_changed;  /* since it was last asked whether that answer serves */
    bool has_all;          /* the objects of the last answer are all there */
    unsigned char *stands; /* [stands_size] of the records: 1, it stays */
    uint64_t stands_size;
};

void eng_answer_cache_deinit(struct eng_answer_cache *cache);
uint64_t eng_answer_cache_bytes(const struct eng_answer_cache *cache);

/* Return whether the last answer is one to a step with these settings, by which the scene
 * came to where it was at this number of the motion (moving.h). */
bool eng_answer_cache_fits(const struct eng_answer_cache *cache,
                           const struct eng_scene *scene,
                           const struct eng_question *question, uint64_t number);

/* Return whether its records are so few that a brief step (step.h) may look at all, and
 * copy them. */
bool eng_answer_cache_is_brief(const struct eng_answer_cache *cache);

/* Return, when the positions have moved on, whether the last answer, `records`, serves a
 * step with these settings, and it is worth it; it always is where what moves is tested
 * apart. Reserves memory; without it, false. */
bool eng_answer_cache_begin(struct eng_answer_cache *cache, const struct eng_scene *scene,
                            const struct eng_question *question, bool is_apart,
                            const struct eng_records *records);

/* Return, if it does, in mode any, whether the pair that met has neither moved nor gone.
 * Then the answer is yes again. */
bool eng_answer_cache_decides(const struct eng_answer_cache *cache,
                              const struct eng_scene *scene);

/* Leave in `records`, if it does, in modes other than any, those that stand, in their
 * order, and count them, *counts. Returns their earliest toi_hi of a proved contact, 1
 * without. */
double eng_answer_cache_select(struct eng_answer_cache *cache,
                               const struct eng_scene *scene, struct eng_records *records,
                               struct eng_counts *counts);

/* Return whether more than half of an answer's records begin within the distance of their
 * objects, of which one is thick. */
bool eng_answer_cache_is_crowded(const struct eng_scene *scene,
                                 const struct eng_records *records,
                                 const struct eng_counts *counts);

/* Count records anew. */
void eng_answer_cache_count(const struct eng_records *records, struct eng_counts *counts);

/* Merge `found`, in order and none of them in `records`, into these. PCCD_E_NOMEM: they
 * are as they were. */
int eng_answer_cache_merge(struct eng_records *records, const struct eng_records *found);

/* Note a step's answer; `proof` of mode any with a contact. */
void eng_answer_cache_finish(struct eng_answer_cache *cache,
                             const struct eng_scene *scene,
                             const struct eng_question *question,
                             const struct eng_step_result *result,
                             const struct eng_counts *counts,
                             const struct pccd_pair *proof);

#endif
