/* play.h - goes through the steps of a recording, and has a daemon compute them again if
 * wanted. */
#ifndef CTL_PLAY_H
#define CTL_PLAY_H

#include "answers.h"
#include "link.h"
#include "pccd.h"
#include "recorded_state.h"

/* ---- Traces what a daemon's threads do during one step. */

/* Shorter events than this part of the step are less than a pixel of any drawing. */
#define STEP_TRACE_PARTS 4000u
#define STEP_TRACE_TEXT  160u

struct step_trace {
    struct pccd_trace_event *events; /* ours; of one thread after those of another */
    uint32_t count, room;
    uint64_t begin_ns, end_ns; /* of the step; both 0: it was not recorded */
    uint64_t lost;             /* events that the daemon had no room for */
    int status;                /* why there are none: of pccd_trace_start, stop or dump */
    char text[STEP_TRACE_TEXT];
};

/* Begin to record what the daemon's threads do, before a step. What fails is kept in
 * `status` and `text`: a step without a trace is still a step. */
void step_trace_begin(struct step_trace *trace, struct pccd_client *client);
/* End the recording after the step, and fetch it. */
void step_trace_end(struct step_trace *trace, struct pccd_client *client);
void step_trace_deinit(struct step_trace *trace);

/* Sources of the answers of steps that are shown. */
enum play_source {
    PLAY_DAEMON,  /* a daemon, every step */
    PLAY_RECORDS, /* a daemon, but for recordings that hold the records of answers */
};

/* A step, or a question about what is near, when it has been answered. */
struct play_step {
    uint64_t number;  /* the client's, from 1 */
    uint64_t time_ns; /* when it was submitted, CLOCK_MONOTONIC of then */
    const struct registry_scene *scene; /* after the movement, if it had one */
    const struct pccd_answer *answer;   /* the daemon's, numbers only; NULL: not asked */
    /* Records: a daemon's, or those that were recorded; NULL: none, or not asked for. */
    struct answers_found found;
    const struct record_frame *frame;     /* as it was asked */
    const struct record_answer *recorded; /* NULL: there was none */
    /* A question. */
    const struct record_frame *asked; /* the frame; NULL: it is a step */
    const struct pccd_near *nears;    /* found.records; NULL of VERTICES */
    const double *bounds; /* found.records; NULL of any other question */
    /* A step. */
    struct recorded_joints joints; /* on which they turn (registry_object: turned) */
    const struct pccd_contact *contacts; /* found.records; NULL in mode pairs */
    const struct pccd_pair *pairs;       /* found.records; NULL in any other mode */
    struct pccd_client
        *client; /* the daemon's, this being its last step; NULL: not asked */
    const struct step_trace *trace; /* what its threads did; NULL: not asked for */
};

/* Return PCCD_OK to go on, PCCD_E_CANCELLED to end well, else an error. */
typedef int (*play_fn)(void *context, const struct play_step *step,
                       struct ctl_error *error);

/* A step or question that is not shown, because it had failed by chance. */
typedef void (*play_skip_fn)(void *context, uint64_t number, bool is_near);

/* Return which item, a step or a question, is to be shown next, where several share the
 * items of a recording: its place in the order of the file, from 1, behind the one
 * before; 0: none of this file. `context` is that of play_run. */
typedef uint64_t (*play_next_fn)(void *context);

struct play_settings {
    const char *path; /* of the file, as it is told of .. */
    const char *from; /* .. and as it is opened; NULL: the same */
    const struct ctl_link *link;
    enum play_source source;
    bool needs_records;
    bool is_traced; /* steps that a daemon answers: with what its threads did */
    bool at_recorded_pace;
    bool only_last;  /* of these steps, or, with shows_near, questions: the last that was
                       answered */
    uint64_t number; /* that steps are told of by; 0: their own */
    uint64_t first, last;    /* steps to show and to repeat; last 0: to the end */
    enum pccd_method method; /* 0: as recorded */
    uint32_t threads;        /* 0: as recorded */
    const char *label;       /* of the progress bar */
    bool shows_near; /* questions about what is near are shown, too; else they are only
                        asked again where they move something */
    play_skip_fn show_skipped; /* NULL: it is not told */
    play_next_fn next;         /* NULL: all steps of the range are shown */
};

/* Contents of the file, in numbers. */
struct play_summary {
    struct record_begin begin;
    enum record_ending ending;
    uint32_t end_reason;    /* enum record_reason */
    uint64_t ending_offset; /* of the first byte that is not part of a whole chunk */
    uint64_t frames, answers, skipped; /* skipped: steps that then failed by chance */
    uint64_t questions;                /* about what is near */
    uint64_t last_step;
    uint32_t daemon_pid; /* 0: none was asked */
    double seconds;      /* spent by the daemon's answers */
};

int play(const struct play_settings *settings, play_fn show, void *context,
         struct play_summary *summary, struct ctl_error *error);

/* Play in parts: open the file and read all answers; go through the steps, once; close,
 * also after an error. `summary` is the caller's until then. */
struct play_reader;
int play_open(const struct play_settings *settings, struct play_summary *summary,
              struct play_reader **reader, struct ctl_error *error);
int play_run(struct play_reader *reader, play_fn show, void *context,
             struct ctl_error *error);
void play_close(struct play_reader *reader);
/* Return what was asked and answered. */
struct answers *play_answers(struct play_reader *reader);
/* Return PCCD_OK, or why reading the answers did not come to the end of the file. */
int play_damage(const struct play_reader *reader, struct ctl_error *error);
/* Return the axis that points up in recordings, one after the other up to one without a
 * path, for whoever shows them: 1 x, 2 y, 3 z. It is the one that the first that has one
 * was given; else the one along which things fall in all steps, if the motion is plain;
 * else y. What cannot be read says nothing. */
uint32_t play_up(const struct play_settings *parts);
/* Return whether a step is of the range that the settings name. */
bool play_is_within(const struct play_settings *settings, uint64_t step);

/* Return whether any pair that is near enough is a right answer, so that there is no
 * hash. */
bool play_has_gap(const struct record_frame *asked);

/* Return whether nothing ended an answer before it was done: only such answers must be
 * equal. */
bool play_is_complete(uint32_t incomplete);

#endif
