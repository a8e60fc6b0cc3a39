/* judge.h - one verdict on a sequence of frames, from what is known of each step.
 *
 * A step is judged by its contacts and by the edges that pass through faces where it
 * ends. What crosses in the first frame stands; at a later frame a crossing is new if its
 * two features crossed neither in the first frame nor in the one before. So a step is
 * judged by three frames alone, whoever has judged the others.
 */
#ifndef CTL_JUDGE_H
#define CTL_JUDGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "check_run.h"
#include "error.h"
#include "pccd.h"
#include "report.h"

/* ---- Crossings at a frame. */

struct crossing {
    uint32_t object_a, edge, object_b, face; /* objects by their handles */
};

/* {0}: nothing crosses, but that is not known to be all. */
struct crossings {
    struct crossing *of; /* ours: [count], ascending */
    size_t count, room;
    bool is_complete;
    double ms; /* that the daemon took */
};

/* Ask what crosses where the motions lead; NULL, 0: where the objects are. Errors: those
 * of pccd.h, E_NOMEM. */
int crossings_ask(struct crossings *crossings, const struct check_run *run,
                  const struct pccd_motion *motions, uint32_t motion_count,
                  struct ctl_error *error);
/* Return that question as it is asked with the settings of steps. */
struct pccd_near_settings crossings_question(const struct pccd_step_settings *step);
/* Append the records of a page of the answer. False: no memory. */
bool crossings_take(struct crossings *crossings, const struct pccd_answer *page);
/* Copy crossings to `to`, whose own are freed; without memory it stays. Errors:
 * E_NOMEM. */
int crossings_copy(struct crossings *to, const struct crossings *from,
                   struct ctl_error *error);
/* Count those of `a` that are in neither of two others. */
uint64_t crossings_beyond(const struct crossings *a, const struct crossings *b,
                          const struct crossings *c);
/* Sort them, and have each once. */
void crossings_sort(struct crossings *crossings);
void crossings_deinit(struct crossings *crossings);

/* ---- What crosses where a step ends, without asking (follow.c). */

struct follow_mesh;

/* Contacts of a step beyond which to ask takes less time and memory. */
#define FOLLOW_CONTACTS_MAX 65536u

/* {0}; follow_deinit's to give back, also on error. */
struct follow {
    struct scene *scene;        /* the caller's */
    struct follow_mesh *meshes; /* ours: [scene->object_count] */
    struct pccd_pair *pairs;    /* ours: [count], contacts of the step */
    size_t count, room;
    bool is_whole; /* these are all; not, where there are very many */
};

/* Get ready for the steps of a scene. Errors: E_NOMEM. */
int follow_begin(struct follow *follow, struct scene *scene, struct ctl_error *error);
/* Note contacts of a step, a page of mode all; count is 0 and is_whole true before it. */
void follow_note(struct follow *follow, const struct pccd_answer *page);
/* Find what crosses in frame `number`, where the step ends whose contacts, all of them,
 * were noted, and which began with what `before` has. The frame is read. Errors: E_NOMEM,
 * those of pccd_mesh_edges. */
int follow_crossings(struct follow *follow, const struct check_run *run, uint32_t number,
                     const struct crossings *before, struct crossings *to,
                     struct ctl_error *error);
void follow_deinit(struct follow *follow);

/* ---- Crossings where a step begins and ends. */

/* {0} but for what is the caller's; judge_ends_deinit's to give back. */
struct judge_ends {
    bool leaves_out; /* the caller's: what touches and does not enter is no contact */
    struct follow follow; /* the caller's to begin; scene NULL: every end is asked for */
    /* The caller's: set `to` to what crosses where the objects are. */
    int (*ask)(void *context, struct crossings *to, struct ctl_error *error);
    void *context;
    struct crossings first, begin, end; /* of the first frame, and of the last step */
};

/* Return whether what crosses where a step of that mode ends is found without asking; it
 * begins where the one before ended. */
bool judge_ends_follow(const struct judge_ends *ends, enum pccd_mode mode,
                       const struct report_step *step);
/* Find what crosses where a step ends; it begins where the one before ended, and `end`
 * says what crosses there. Sets how the step begins, and step->ends. Errors: those of
 * `ask` and follow_crossings. */
int judge_ends_look(struct judge_ends *ends, const struct check_run *run, uint32_t number,
                    struct report_step *step, struct ctl_error *error);
void judge_ends_deinit(struct judge_ends *ends);

/* ---- A step, and what is said of it. */

#define JUDGE_NAME_BYTES 256 /* of an object; more is cut */

/* The earliest contact of a step, with names of its objects; "": there is but one. */
struct judged_contact {
    struct report_first at; /* of a line that was read without a place */
    char names[2][JUDGE_NAME_BYTES];
};

struct judged {
    uint32_t number;           /* of the step, from 1; 0: the first frame by itself */
    struct report_step report; /* of the first frame: no answer; crossings says it all */
    bool meets;                /* something does, besides what crosses when it begins */
    struct judged_contact first;
};

/* Set whether something meets, and the earliest contact with the names that its parts
 * have, from the report of a step. */
void judged_set(struct judged *judged, char *const *names);
/* Set it to the first frame, of this name, and what crosses there. */
void judged_set_first(struct judged *judged, const char *frame,
                      const struct crossings *first);
/* Return whether a step fails by itself: something meets, or crosses that did not. */
bool judged_fails(const struct judged *judged);
/* Print what is new and what is gone, where there is something. */
void judged_print(FILE *to, const struct judged *judged);
/* Return a step as one JSON object, NULL: no memory; and read it back but for the names
 * of files, false: it is none. */
json_t *judged_line(const struct judged *judged);
bool judged_read(const json_t *line, struct judged *judged);

/* ---- All of them. */

/* The steps that are judged, where they are one of several parts. */
struct judge_part {
    uint32_t number, count; /* count 0: all steps are judged */
    uint32_t first, last;   /* last < first: no step is in it */
};

struct judge {
    struct judge_part part; /* the caller's */
    bool is_thick;          /* the caller's: something meets before it touches */
    bool leaves_out; /* the caller's: what touches and does not enter is no contact */
    uint32_t steps, incomplete;
    uint32_t meeting;             /* steps in which something meets */
    uint32_t meets_at;            /* the first of them */
    struct judged_contact meets;  /* the earliest there, of a mode that tells it */
    bool begins_crossed;          /* some step does */
    uint64_t left_out; /* pairs of all steps that touch, or are within their distance */
    bool knows_standing;          /* these are known: */
    uint64_t crossings, standing; /* in the first frame; of these in the last */
    uint64_t fresh;               /* new ones, of all frames */
    uint32_t fresh_at;            /* the first step that ends with one */
};

/* Take the next step, or the first frame. */
void judge_take(struct judge *judge, const struct judged *judged);
/* Return whether nothing meets or crosses in what was looked at. Errors: E_TIMEOUT where
 * that is so, and something was not. */
int judge_end(const struct judge *judge, bool *is_free, struct ctl_error *error);
/* Print which steps a part has, after `before`; nothing where all are judged. */
void judge_print_part(FILE *to, const struct judge_part *part, const char *before);
/* Print the verdict, on one line that begins with `label`, and what it rests on. */
void judge_print(FILE *to, const struct judge *judge, const char *label);
/* Return the verdict as a JSON object; NULL: no memory. */
json_t *judge_line(const struct judge *judge);
/* Return whether a line is such an object. */
bool judge_is_line(const json_t *line);

#endif
