/* verify.h - checks the answer of a recorded step against exact arithmetic (`pccdctl
 * verify`).
 *
 * Recompute every record and every number of an answer, and a sample of pairs that were
 * not reported, by exact rational arithmetic that shares nothing with the engine; say of
 * what else it was not checked.
 */
#ifndef CTL_VERIFY_H
#define CTL_VERIFY_H

#include <jansson.h>
#include <stdbool.h>

#include "answers.h"
#include "option_table.h"
#include "oracle.h"
#include "play.h"

/* ---- How much of each answer is checked. */

struct verify_settings {
    uint64_t seed;
    uint64_t contacts_max; /* of a step that are checked, a sample; 0: all */
    uint64_t sample;       /* pairs of a step that are near, and not in the answer */
    bool repeats; /* the steps are computed again even if the contacts are recorded */
};
#define VERIFY_SETTINGS_INIT                                                             \
    {                                                                                    \
        .seed = 1, .sample = 1000                                                        \
    }
extern const struct option_table verify_table;

struct verify_counts {
    uint64_t steps;
    uint64_t contacts;     /* proved ones, and right */
    uint64_t possible;     /* not proved, and not contradicted */
    uint64_t non_contacts; /* of the sample, and right */
    uint64_t unchecked;    /* steps of which nothing could be checked */
    uint64_t nears;        /* questions about what is near */
    uint64_t near_records; /* of them, and right, with all else that is near left out */
    uint64_t nears_unchecked;
    uint64_t turning; /* pairs of bodies that turn of which intervals do not tell all */
};

#define VERIFY_NAME_BYTES 64

/* Proof of a fault: the step, what is wrong there, and with which pair. */
struct verify_witness {
    uint64_t step;
    char what[200];
    bool has_pair;
    struct pccd_pair pair;
    char names[2][VERIFY_NAME_BYTES]; /* of its objects, cut; "": it has none */
    double p[8][3];                   /* as oracle.h orders them */
    bool has_claim;                   /* toi and toi_hi of the record */
    double toi, toi_hi;
    bool has_contact; /* exact: the first contact lies in [lo, hi] */
    double lo, hi;
};

#define VERIFY_WHY_BYTES 160

/* Outcome of a step or a question; without pointers, so that other processes can be
 * told. */
struct verify_result {
    uint64_t step;
    bool is_near;
    bool is_wrong; /* `witness` says how */
    /* Why it, or a part of its answer, could not be checked; "": all of it was, but for
     * what the settings leave out. */
    char unchecked[VERIFY_WHY_BYTES];
    struct verify_counts counts;
    struct verify_witness witness;
};

/* Check a step or a question, all of its answer. PCCD_OK with *result, else an error. */
int verify_step(const struct play_step *step, const struct verify_settings *settings,
                struct verify_result *result, struct ctl_error *error);
/* Say that a step or question was not checked: it was not repeated, because it had failed
 * by chance. */
void verify_skip(uint64_t step, bool is_near, struct verify_result *result);

/* Exact begin of a step: edges that pass through faces and, with an approach, pairs
 * within their distance. */
struct verify_start {
    bool is_known; /* it was asked, and is not too much to decide */
    uint64_t crossings, inside;
};

/* ---- parts of it; false: wrong, and the result says how ---------------------------- */

/* Check an answer about what is near, for verify_step (verify_distance.c). */
int verify_distances(const struct play_step *near, struct verify_result *result,
                     struct ctl_error *error);
/* Check the numbers of an answer against its records (verify_numbers.c). */
bool verify_numbers(const struct play_step *step, struct verify_result *result);
/* Check a sample of pairs near each other that are not in the answer (verify_near.c). */
bool verify_near(const struct play_step *step, const struct verify_settings *settings,
                 struct verify_result *result);
/* Check what a step says of how it begins, and find what is true of that. After an error,
 * which *status gets, true (verify_distance.c). */
bool verify_start(const struct play_step *step, struct verify_result *result,
                  struct verify_start *start, struct ctl_error *error, int *status);
/* Check that the verdict of mode any is that of all pairs and of the start. After an
 * error, which *status gets, true (verify_any.c). */
bool verify_any(const struct play_step *step, const struct verify_start *start,
                struct verify_result *result, struct ctl_error *error, int *status);
/* Return why the parameters or the normal of a contact whose times are right cannot be;
 * NULL: they can. Of a thick pair r > 0 (verify_place.c). */
const char *verify_place(const struct pccd_contact *contact, const double p[8][3],
                         double r);

/* ---- what they use ----------------------------------------------------------------- */

/* Return whether the answer holds the pair. */
bool verify_has(const struct play_step *step, const struct pccd_pair *pair);

/* Return the first contact of two objects, in either order; NULL: there is none. */
const struct pccd_contact *verify_of_objects(const struct play_step *step, uint32_t a,
                                             uint32_t b);
/* Return which number of a recorded answer is not what it must be; NULL: none. `must`
 * takes from it how it ended; all else is compared, so that a number which comes later is
 * not let by (verify_numbers.c). */
const char *verify_recorded(const struct record_answer *then, struct record_answer must);
/* Return whether an answer has its status alone, as one of what has failed must. */
bool verify_is_bare(const struct record_answer *answer);
/* Return whether nothing ended the step before it was done. */
bool verify_is_complete(const struct play_step *step);
/* Mix x into a number that looks random (splitmix64); for the next one x grows by the
 * step. */
#define VERIFY_MIX_STEP 0x9e3779b97f4a7c15u
uint64_t verify_mix(uint64_t x);
/* Say that the result is wrong, with the exact time of the pair's contact if it has one;
 * pair NULL: it is of no pair. Returns false. */
bool verify_wrong(struct verify_result *result, const struct play_step *step,
                  const struct pccd_pair *pair, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Say that something was not checked; what was said first stays. Returns true. */
bool verify_leave(struct verify_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Return a number of a step's answer: the daemon's, or what was recorded. */
uint32_t verify_mode(const struct play_step *step);
double verify_toi_first(const struct play_step *step);
uint32_t verify_verdict(const struct play_step *step);
uint32_t verify_incomplete(const struct play_step *step);

/* ---- When the features of a pair meet first in a recorded step, by exact
 * arithmetic. */

struct verify_meeting {
    double p[8][3];             /* of the pair, as oracle.h orders them */
    double r;                   /* above 0: they are thick, and meet about there */
    struct oracle_first *first; /* NULL: they never meet; the caller's to free */
    uint32_t flags;             /* PCCD_INITIAL and PCCD_INSIDE, as a record of it has */
    bool touches;               /* at t = 0 */
    uint32_t fate; /* of a thick pair that is within r then, and does not touch: the flag
                      of what its distance does; 0: it is none, or nothing is told */
};

/* Find when the features of a pair are a contact first; where what does not approach is
 * left out, a thick one when it is nearer than it began. The meshes of both objects have
 * their edges (recorded_edges). */
void verify_meet(const struct play_step *step, const struct pccd_pair *pair,
                 struct verify_meeting *meeting);
/* Return what is wrong with what a contact says about its features where they touch at
 * t = 0; NULL: nothing. What cannot be told here is said to be unchecked. The meshes have
 * their edges (verify_touching.c). */
const char *verify_touching(const struct play_step *step,
                            const struct pccd_contact *contact,
                            const struct pccd_pair *pair,
                            const struct verify_meeting *meeting,
                            struct verify_result *result);
/* Return whether an answer that leaves out what touches and does not enter may lack the
 * pair for that: it is no contact before the time `until` either. */
bool verify_is_left_out(const struct play_step *step, const struct pccd_pair *pair,
                        const struct verify_meeting *meeting, double until,
                        struct verify_result *result);
/* Set the radii of a pair, and the separation: zeros where rest leaves it thin. Return
 * whether it is thick. */
bool verify_radii(const struct play_step *step, const struct pccd_pair *pair,
                  double radius[3]);
/* Return whether mode pairs has the pair: no axis separates it, by the given coordinates,
 * and its kind has a meaning where it is thin. The meshes have their edges. */
bool verify_is_beside(const struct play_step *step, const struct pccd_pair *pair);

/* ---- Bodies that turn, by intervals (verify_turning.c). */

/* Return whether an object of the pair turns in the step, or any object of its scene:
 * verify_meet and verify_is_beside have nothing to say of it then. */
bool verify_turns(const struct play_step *step, const struct pccd_pair *pair);
bool verify_has_turning(const struct play_step *step);
/* Check a contact of bodies of which one turns, or that a pair of such may be missing in
 * the answer, as one may from the time `from` on; count what intervals tell, and what
 * they cannot. */
bool verify_turning(const struct play_step *step, const struct pccd_contact *contact,
                    const struct pccd_pair *pair, struct verify_result *result);
bool verify_turning_missing(const struct play_step *step, const struct pccd_pair *pair,
                            double from, struct verify_result *result);
/* Check the places at t = 0 of all that turns, which are computed as the daemon does,
 * against where intervals have it. */
bool verify_turning_places(const struct play_step *step, struct verify_result *result);
/* Tell where such a pair begins and ends, and when it meets if that is known. */
void verify_turning_tell(const struct play_step *step, const struct pccd_pair *pair,
                         struct verify_witness *witness);

/* Where a vertex of an object is at so many times of the step, from its begin to its
 * end, about: for who looks what comes near what. */
#define VERIFY_TIMES 17u
struct verify_path {
    double m[VERIFY_TIMES][12]; /* transforms of what was registered */
};
/* Make one for each object of the step's scene that turns; NULL: none does, or no
 * memory. The caller frees it. */
struct verify_path *verify_paths(const struct play_step *step);
/* Set `place` to where a registered point is at time number `at`. */
void verify_path_place(const struct verify_path *path, const double x[3], uint32_t at,
                       double place[3]);

/* ---- What came of it, as text and as JSON. */

/* Outcome of all that was looked at, in its order, up to the first that is wrong; zero
 * before. */
struct verify_report {
    struct verify_counts counts;
    const struct verify_witness *witness; /* NULL: nothing is wrong */
    struct verify_unchecked {
        uint64_t step;
        bool is_near;
        char why[VERIFY_WHY_BYTES];
    } * unchecked; /* what was not checked, or not all of it */
    size_t unchecked_count, unchecked_room;
};
/* Add what came of one, which stays where it is if it is wrong. PCCD_OK or
 * PCCD_E_NOMEM. */
int verify_report_add(struct verify_report *report, const struct verify_result *result,
                      struct ctl_error *error);
/* Add answers that belong to no step of the recording. */
int verify_report_strays(struct verify_report *report, struct answers *answers,
                         struct ctl_error *error);
void verify_report_deinit(struct verify_report *report);

/* Return PCCD_OK, or PCCD_E_STATE: none of the answers could be checked, and none is
 * wrong. The report says so, too, and why. */
int verify_report_judge(const struct verify_report *report, const char *path,
                        struct ctl_error *error);

/* Print the report on the standard output, as text or as JSON. False: no memory, or it
 * could not be written. */
void verify_print_text(const struct verify_report *report);
bool verify_print_json(const struct verify_report *report);

/* Return what is wrong as an object, NULL without memory; and read it back: false if it
 * is none. */
json_t *verify_witness_json(const struct verify_witness *witness);
bool verify_witness_read(const json_t *object, struct verify_witness *witness);
/* Set the counts in an object, false without memory; and read them back: false if it has
 * none. */
bool verify_counts_json(json_t *object, const struct verify_counts *counts);
bool verify_counts_read(const json_t *object, struct verify_counts *counts);

#endif
