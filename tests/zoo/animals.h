/* animals.h - the misdeeds of hostile clients, and what the daemon must answer to
 * each. */
#ifndef ZOO_ANIMALS_H
#define ZOO_ANIMALS_H

#include "cage.h"

/* animals_talk.c: messages and descriptors */
bool zoo_says_nothing(struct zoo_cage *cage);
bool zoo_never_reads(struct zoo_cage *cage);
bool zoo_floods(struct zoo_cage *cage);
bool zoo_sends_253_descriptors(struct zoo_cage *cage);
bool zoo_sends_wrong_lengths(struct zoo_cage *cage);
bool zoo_uses_stale_handles(struct zoo_cage *cage);

/* animals_data.c: what is in the shared memory */
bool zoo_rewrites_submitted_slots(struct zoo_cage *cage);
bool zoo_punches_holes(struct zoo_cage *cage);
bool zoo_batches_nonsense(struct zoo_cage *cage);
bool zoo_lies_about_counts(struct zoo_cage *cage);
bool zoo_sends_wrong_numbers(struct zoo_cage *cage);
bool zoo_names_wrong_indices(struct zoo_cage *cage);

/* animals_work.c: what is asked to be computed */
bool zoo_submits_without_end(struct zoo_cage *cage);
bool zoo_cancels_everything(struct zoo_cage *cage);
bool zoo_makes_tiny_scenes(struct zoo_cage *cage);
bool zoo_dies_in_the_middle(struct zoo_cage *cage);
bool zoo_stops_itself(struct zoo_cage *cage);
bool zoo_turns_about(struct zoo_cage *cage);

/* animals_long.c: what takes seconds */
bool zoo_stacks_triangles(struct zoo_cage *cage);
bool zoo_fans_triangles_out(struct zoo_cage *cage);
bool zoo_commits_heaps(struct zoo_cage *cage);
bool zoo_asks_for_everything(struct zoo_cage *cage);
bool zoo_thickens_everything(struct zoo_cage *cage);

/* animals_share.c: scenes that are shared, and what is told of them */
bool zoo_fights_over_a_scene(struct zoo_cage *cage);
bool zoo_names_scenes(struct zoo_cage *cage);
bool zoo_ignores_every_pair(struct zoo_cage *cage);
bool zoo_reads_no_news(struct zoo_cage *cage);
bool zoo_pries(struct zoo_cage *cage);

#endif
