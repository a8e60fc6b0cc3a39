/* wide_team.h - updates the boxes of the wide trees by all threads of a step. */
#ifndef ENG_WIDE_TEAM_H
#define ENG_WIDE_TEAM_H

#include "team.h"

/* Like eng_refit_by_team (refit.h), with eng_refit_begin before the region and
 * eng_refit_release and eng_refit_await after it: true for the one thread that ended
 * last, and sees every box. [team] */
bool eng_wide_refit_by_team(struct eng_team *team, struct eng_worker *worker);

#endif
