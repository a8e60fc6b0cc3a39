/* names.h - names of modes, methods and questions; what questions have. */
#ifndef COMMON_NAMES_H
#define COMMON_NAMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

/* By value; the last is NULL. */
static const char *const common_mode_names[PCCD_MODE_COUNT + 1] = {
    "all", "first", "any", "pairs", "first-per-pair"};
static const char *const common_method_names[PCCD_METHOD_COUNT + 1] = {"default", "paper",
                                                                       "wide"};
static const char *const common_near_names[PCCD_NEAR_COUNT + 1] = {
    "pairs", "features", "vertices", "nearest", "crossings", "depth"};

static const char *const common_verdict_names[] = {"no", "possible", "yes", "none"};

/* Return the name of a value; NULL if it has none, as one that a newer daemon sends
 * may. */
static inline const char *common_mode_name(uint32_t mode)
{
    return mode < PCCD_MODE_COUNT ? common_mode_names[mode] : NULL;
}

static inline const char *common_method_name(uint32_t method)
{
    return method < PCCD_METHOD_COUNT ? common_method_names[method] : NULL;
}

static inline const char *common_near_name(uint32_t what)
{
    return what < PCCD_NEAR_COUNT ? common_near_names[what] : NULL;
}

static inline const char *common_verdict_name(uint32_t verdict)
{
    return verdict <= PCCD_VERDICT_NONE ? common_verdict_names[verdict] : NULL;
}

/* Return whether the question goes by a distance: a new one does, unless it stands
 * here. */
static inline bool common_near_has_distance(uint32_t what)
{
    return what != PCCD_NEAR_CROSSINGS && what != PCCD_NEAR_DEPTH;
}

/* Return whether the question is about objects two by two. Else about pairs of
 * features. */
static inline bool common_near_is_of_objects(uint32_t what)
{
    return what == PCCD_NEAR_NEAREST || what == PCCD_NEAR_DEPTH;
}

/* Return how many objects a question may name; of the others all are meant. */
static inline int common_near_names_objects(uint32_t what)
{
    return common_near_is_of_objects(what) ? 2 : what == PCCD_NEAR_VERTICES ? 1 : 0;
}

/* Return whether it is about all pairs within the distance; these tell crossings, too. */
static inline bool common_near_has_all_pairs(uint32_t what)
{
    return common_near_has_distance(what) && !common_near_is_of_objects(what);
}

/* Return whether the question, at this end, reads where the last step began. A question
 * about both ends would read it whatever `end` is. */
static inline bool common_near_reads_begin(uint32_t what, uint32_t end)
{
    (void)what;
    return end == 0;
}

#endif
