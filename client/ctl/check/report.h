/* report.h - prints the results of `pccdctl check`. */
#ifndef CTL_REPORT_H
#define CTL_REPORT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "columns.h"
#include "meshframes.h"
#include "pccd.h"

/* X(name, field of pccd_step_times): the phases in their order, then the whole, then what
 * traversal and tests are otherwise divided into. */
#define REPORT_PHASES(X)                                                                 \
    X(ingest)                                                                            \
    X(refit)                                                                             \
    X(traversal)                                                                         \
    X(tests)                                                                             \
    X(merge)                                                                             \
    X(step)                                                                              \
    X(low)                                                                               \
    X(high)                                                                              \
    X(rebuild)

enum report_phase {
#define REPORT_PHASE_ENUM(name) REPORT_##name,
    REPORT_PHASES(REPORT_PHASE_ENUM)
#undef REPORT_PHASE_ENUM
        REPORT_PHASE_COUNT
};
extern const char *const report_phase_names[REPORT_PHASE_COUNT];

/* Fill ms with the milliseconds of the phases of an answer. */
void report_phases(const struct pccd_step_times *times, double ms[REPORT_PHASE_COUNT]);

struct report_object {
    const char *name;               /* NULL: only its file is told */
    const char *path;               /* of its first file, or a pattern */
    const struct ctl_frames *files; /* or NULL: what has several frames is told */
    struct pccd_mesh_info info;
    struct ctl_welded welded;
};

/* Objects that a report is about, and what is told of all of them. */
struct report_scene {
    struct report_object *objects;
    uint32_t object_count;
    char *const *names;   /* of the parts that meet, by their numbers; or NULL */
    uint32_t object_what; /* that options have set: bits of pccd_object_what */
    double build_ms;      /* edges and feature ownership, then the hierarchy; paid once */
    const char *warning;  /* about all of them; NULL: none */
};

/* Two parts of objects that meet, by the numbers of their names, the lower one first. */
struct report_pair {
    uint32_t a, b;
    uint64_t count; /* records */
};

#define REPORT_NO_PART UINT32_MAX

/* The earliest contact of a step, and where it is. */
struct report_first {
    bool is_known;
    bool is_alone; /* the first feature alone is told */
    uint32_t kind;
    uint32_t part[2];    /* number of the name; REPORT_NO_PART: it has none */
    uint32_t feature[2]; /* vertex, or face; of an edge its lower vertex .. */
    uint32_t other[2];   /* .. and its other one */
    double toi, toi_hi;
    double x, y, z; /* the point of the second feature, then */
};

/* Edges that pass through faces where a step ends. */
struct report_ends {
    bool is_known; /* these are */
    uint64_t crossings;
    uint64_t standing; /* of these, as in the first frame */
    uint64_t fresh;    /* new: neither there nor at its beginning */
    uint64_t gone;     /* at its beginning, and not any more */
};

struct report_step {
    const char *from, *to; /* files */
    struct pccd_answer
        answer;       /* the last repetition's; its record pointers are not used */
    bool is_complete; /* every record was delivered */
    uint32_t repeats; /* timed runs; 0: the first run is the timed one */
    double first_ms;  /* `step` of the first run, which warms up */
    double ms[REPORT_PHASE_COUNT]; /* medians of the timed runs */
    double round_trip_ms; /* the same, from submit to answer as the client sees it */
    struct report_first first;
    struct report_ends ends;
    struct report_pair *pairs; /* whose free() is the caller's; NULL: no objects */
    uint32_t pair_count;
};

/* Print the objects, for people; once, before the steps. */
void report_print_scene(FILE *to, const struct report_scene *scene);
/* Print a line for each object. */
void report_print_objects(FILE *to, const struct report_scene *scene);
/* Print what readers have to say of their frames. */
void report_print_notes(FILE *to, const struct ctl_frames *files);
/* Print a step, long; report_print_line: as one line. */
void report_print_step(FILE *to, const struct report_scene *scene,
                       const struct report_step *step);
/* Print a place that is known, as "HEADvertex 3 of "cloth"VERBface 12 of "ball" at (0.2,
 * 0.2, 0)". */
void report_print_place(FILE *to, const char *head, const char *verb,
                        const struct report_scene *scene,
                        const struct report_first *first);
/* Print the end of the report of any answer: whether it is complete, its hash, work and
 * times. */
void report_print_rest(FILE *to, double build_ms, const struct report_step *step);
void report_print_line(FILE *to, const struct report_scene *scene, uint32_t number,
                       const struct report_step *step);
/* Print which objects meet: at most 10 lines, and how many pairs there are more. */
void report_print_pairs(FILE *to, const struct report_scene *scene,
                        const struct report_step *step);

/* Return whether something meets in a step: it has a contact, or in mode pairs a pair,
 * which may be one; or it begins crossed or inside. */
bool report_meets(const struct report_step *step);

/* Print one JSON object: of one step, the step's values at the top; of several, their
 * sums, an array "steps", and `verdict` (judge_line), which is ours to give back, as
 * "sequence". False: no memory, or it could not be written. */
bool report_json(FILE *to, const struct report_scene *scene,
                 const struct report_step *steps, uint32_t step_count, json_t *verdict);

/* Tell what became of vertices at one place: lines where there is something to tell;
 * members of an object. */
void report_print_welded(FILE *to, const struct ctl_welded *welded);
void report_welded(json_t *object, const struct ctl_welded *welded, bool *ok);

/* Return the objects as an array of files and counts. */
json_t *report_objects(const struct report_scene *scene, bool *ok);

/* Return a place, null if it is not known: of both sides the name of the object, if it
 * has one, the feature and its number, of an edge its vertices; then the point. */
json_t *report_place(const struct report_scene *scene, const struct report_first *first,
                     bool *ok);

/* Set in `object` how many records of each kind there are, under the kind's name. */
void report_kinds(json_t *object, const uint64_t counts[PCCD_KINDS_MAX], bool *ok);

/* Set in an object how the threads of any answer shared the work. */
void report_json_sharing(json_t *object, const struct pccd_answer *answer, bool *ok);
/* Set in an object what ends the report of any answer: whether it is complete, its hash,
 * times and counters. */
void report_json_rest(json_t *object, double build_ms, const struct report_step *step,
                      bool *ok);

/* Return what an answer has counted, as an object. NULL, or *ok false, without memory. */
json_t *report_counters(const struct pccd_answer *answer, bool *ok);

/* Members of a struct report_step: what crosses where it ends. */
extern const struct column report_ends_columns[];

/* ---- A step's report as one JSON object, and back. */

/* Return the report as an object. NULL: no memory. */
json_t *report_line(const struct report_step *step);
/* Read it back. False: it is no such object; then *step is of no use. */
bool report_line_read(const json_t *line, struct report_step *step);

#endif
