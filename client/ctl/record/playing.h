/* playing.h - a recording that is being played, inside of playing.c and play_open.c.
 *
 * Threads: one.
 */
#ifndef CTL_PLAYING_H
#define CTL_PLAYING_H

#include "answers.h"
#include "drive.h"
#include "play.h"
#include "terminal.h"

struct playing {
    struct play_settings settings;
    struct play_summary *summary;
    play_fn show;
    void *context;
    struct record_reader reader;
    struct record_reader pages; /* the same file, at the records of answers */
    struct answers answers;
    struct registry world;
    struct drive drive;
    struct progress progress;
    struct step_trace trace;
    struct answers_found found; /* recorded ones */
    uint64_t begun_ns;          /* now, and then, of the first step that is repeated */
    uint64_t begun_then_ns;
    uint64_t wanted;            /* steps of the range that the file has */
    uint64_t last_step;         /* read of the log */
    uint64_t place, next_place; /* items read, and the one that is to be shown next */
    int damage;                 /* where reading the answers ended; PCCD_OK: at the end */
    char damage_text[sizeof(((struct record_reader *)0)->text)];
};

/* Go through the log. */
int play_follow(struct playing *playing, struct ctl_error *error);

/* Say what is wrong with the file behind step `last_step`, and that a range may stop
 * before. Returns `status`. */
int play_damaged(const struct playing *playing, int status, const char *text,
                 uint64_t last_step, struct ctl_error *error);

#endif
