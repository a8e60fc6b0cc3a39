/* masks.h - decides which objects of a scene are tested against each other: groups, masks
 * and ignored pairs; and which two have a clearance in the place of their radii.
 *
 * Threads: changed by [compute] between steps; read by the [team].
 *
 * Two objects may meet if a.group & b.mask and b.group & a.mask, and the pair is not
 * ignored. An object may meet itself if its self-collision is on. This takes two ands of
 * words in two cache lines. The set of pairs is asked only about two objects that are
 * both part of one. So nothing is precomputed for pairs of objects, of which there may be
 * 2^32, and any setting may change with every step.
 */
#ifndef ENG_MASKS_H
#define ENG_MASKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene.h"

/* ---- pairs ------------------------------------------------------------------------- */

struct eng_pairset {
    struct eng_pairset_slot *slots; /* [capacity] */
    uint64_t factor;   /* of the hash, odd: who chooses the pairs does not know it */
    uint32_t capacity; /* a power of two; 0: no memory is held */
    uint32_t count;    /* at most half of the capacity */
};

/* No pair has this key: of two different numbers, the lesser is never 2^32 - 1. */
#define ENG_PAIRSET_EMPTY UINT64_MAX

void eng_pairset_deinit(struct eng_pairset *set);
size_t eng_pairset_bytes(const struct eng_pairset *set);

/* Add a pair, a != b, if the set has it not yet; it has that value then. PCCD_E_NOMEM:
 * the set is as before. */
int eng_pairset_add(struct eng_pairset *set, uint32_t a, uint32_t b, double value);

/* Remove a pair, if the set has it. The memory goes with the last one. */
void eng_pairset_remove(struct eng_pairset *set, uint32_t a, uint32_t b);
/* Return whether the set has the pair. */
bool eng_pairset_has(const struct eng_pairset *set, uint32_t a, uint32_t b);
/* Return the value of a pair; `other`: the set has it not. */
double eng_pairset_value(const struct eng_pairset *set, uint32_t a, uint32_t b,
                         double other);

/* Find the next pair after *from, which is 0 first; false: there are no more. */
bool eng_pairset_next(const struct eng_pairset *set, uint32_t *from, uint32_t pair[2],
                      double *value);

/* Take a pair out that has `a`; *other is the other number, *value what it had. False:
 * there is none. A search for all of them goes on at *from, which is 0 first. */
bool eng_pairset_take(struct eng_pairset *set, uint32_t a, uint32_t *from,
                      uint32_t *other, double *value);

/* The value of a pair of objects is their clearance, at least 0, or one of these. */
#define ENG_PAIR_IGNORED (-1.0)
#define ENG_PAIR_PLAIN   (-2.0) /* their radii count; no pair of the set has it */

/* ---- masks ------------------------------------------------------------------------- */

/* Which pairs of an object are tested in a step, those within it if its self-collision is
 * on. What is left out within it is known to have no contact. */
enum eng_self {
    ENG_SELF_TESTED,
    ENG_SELF_CROWDED, /* only those of two features that are crowded (wide_crowded.h) */
    ENG_SELF_EXEMPT,  /* none */
    ENG_SELF_APART    /* nor any with other objects: it turns, and others see to it */
};

struct eng_masks_entry {
    uint64_t group;
    uint64_t mask;
    uint32_t pairs; /* of which something is said, that it is part of */
    bool self;
    bool is_changed;        /* not as an object begins */
    bool is_excluded;       /* about to go away */
    enum eng_self left_out; /* in this step */
};

struct eng_masks {
    struct eng_masks_entry *entries; /* [capacity] by object index */
    uint32_t capacity;
    uint32_t changed_count;  /* entries that are changed */
    uint32_t left_out_count; /* entries of which anything is left out in this step */
    struct eng_pairset pairs; /* of which something is said */
    uint32_t ignored_count;   /* of these */
    uint32_t version; /* goes on with every change, and round */
};

void eng_masks_init(struct eng_masks *masks);
void eng_masks_deinit(struct eng_masks *masks);
uint64_t eng_masks_bytes(const struct eng_masks *masks);

/* Make room for objects 0 .. capacity - 1; new ones are as objects begin.
 * PCCD_E_NOMEM. */
int eng_masks_reserve(struct eng_masks *masks, uint32_t capacity);

/* Exclude an object that is about to go away: it meets nothing any more. */
void eng_masks_exclude(struct eng_masks *masks, uint32_t object);
/* Remove the pairs of all objects that are excluded, at once: to search for those of each
 * takes up to a millisecond. */
void eng_masks_purge_excluded(struct eng_masks *masks);
/* Forget an object that went away: its pairs go, its place is as objects begin. */
void eng_masks_forget(struct eng_masks *masks, uint32_t object);

void eng_masks_set(struct eng_masks *masks, uint32_t object,
                   const struct eng_object_filter *bits);
/* Set which pairs within the object the step does not test. The version stays: this is
 * asked of the entry, pair by pair. */
void eng_masks_leave_out(struct eng_masks *masks, uint32_t object,
                         enum eng_self left_out);
/* Have a pair of two different objects ignored, or plain, or with a clearance.
 * PCCD_E_LIMIT, PCCD_E_NOMEM: as before. */
int eng_masks_set_pair(struct eng_masks *masks, uint32_t a, uint32_t b, double value);

/* Return whether there is anything that may be left out. If not, nobody needs to ask. */
static inline bool eng_masks_is_on(const struct eng_masks *masks)
{
    return masks->changed_count > 0 || masks->ignored_count > 0 ||
           masks->left_out_count > 0;
}

/* Return what is said of a pair of two different objects. */
static inline double eng_masks_pair(const struct eng_masks *masks, uint32_t a, uint32_t b)
{
    return masks->entries[a].pairs > 0 && masks->entries[b].pairs > 0
               ? eng_pairset_value(&masks->pairs, a, b, ENG_PAIR_PLAIN)
               : ENG_PAIR_PLAIN;
}

/* Return whether a pair of objects is ignored. */
static inline bool eng_masks_ignores(const struct eng_masks *masks, uint32_t a,
                                     uint32_t b)
{
    return eng_masks_pair(masks, a, b) == ENG_PAIR_IGNORED;
}

/* Return whether some pairs have a clearance. */
static inline bool eng_masks_have_clearances(const struct eng_masks *masks)
{
    return masks->pairs.count > masks->ignored_count;
}

/* Return whether the step looks for no pair of two different objects. */
static inline bool eng_masks_keep_apart(const struct eng_masks *masks, uint32_t a,
                                        uint32_t b)
{
    return masks->entries[a].left_out == ENG_SELF_APART ||
           masks->entries[b].left_out == ENG_SELF_APART;
}

/* Return whether object a may meet object b, whoever finds that out. Of one that may meet
 * itself only where it is crowded, anything may. */
static inline bool eng_masks_allows(const struct eng_masks *masks, uint32_t a, uint32_t b)
{
    const struct eng_masks_entry *of_a = &masks->entries[a];
    const struct eng_masks_entry *of_b = &masks->entries[b];
    if (a == b) {
        return of_a->self && of_a->left_out < ENG_SELF_EXEMPT;
    }
    return (of_a->group & of_b->mask) != 0 && (of_b->group & of_a->mask) != 0 &&
           !eng_masks_ignores(masks, a, b);
}

#endif
