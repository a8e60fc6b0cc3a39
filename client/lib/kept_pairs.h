/* kept_pairs.h - pairs of objects that ignore each other, for another daemon.
 *
 * Room:     client/lib, private. May include: the C library.
 * Does:     remember what was answered, in any number, for a few nanoseconds each; find
 *           out what holds of it when that is needed.
 * Threads:  [owner].
 */
#ifndef CLI_KEPT_PAIRS_H
#define CLI_KEPT_PAIRS_H

#include <stdbool.h>
#include <stdint.h>

struct cli_kept_pair {
    uint32_t a; /* handles, the lesser first */
    uint32_t b;
    uint32_t order; /* in which they were told */
    bool ignored;
};

/* What was said, the last word on a pair counts. All zero: nothing. */
struct cli_kept_pairs {
    struct cli_kept_pair *said; /* [room] */
    uint32_t count;
    uint32_t room;
};

/* Returns 0 or PCCD_E_NOMEM: it has not been noted. */
int cli_kept_pairs_note(struct cli_kept_pairs *pairs, uint32_t a, uint32_t b,
                        bool ignored);
/* The object is gone. O(count). */
void cli_kept_pairs_forget(struct cli_kept_pairs *pairs, uint32_t object);
/* Leave those that ignore each other, each once. O(count log count). */
void cli_kept_pairs_settle(struct cli_kept_pairs *pairs);
void cli_kept_pairs_deinit(struct cli_kept_pairs *pairs);

#endif
