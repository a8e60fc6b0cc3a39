/* sweep.h - `pccdctl sweep`: what meets while the joints of a mechanism move. */
#ifndef CTL_SWEEP_H
#define CTL_SWEEP_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "pccd.h"
#include "robot.h"

#define SWEEP_AXES_MAX  3u  /* joints of a range that move by themselves */
#define SWEEP_GAPS_KEPT 64u /* parts of one motion that stay undecided */

/* ---- One motion. */

/* A mechanism in a daemon. */
struct sweep {
    struct pccd_client *client; /* the caller's */
    const struct robot *robot;  /* the caller's */
    struct ctl_error *error;    /* the caller's; has the text of all that goes wrong */
    double clearance; /* a distance that parts keep which have none of their own; 0: they
                       * may not touch */
    double bracket;             /* of a jam, at most, in radians or the file's unit */
    double least;        /* find the least distance to this part of the size; 0: do not */
    uint32_t limit;      /* of motions for a range of several joints */
    uint32_t threads;    /* at most; 0: the daemon decides */
    uint32_t scene;      /* ours, as is what follows */
    uint64_t pair_count; /* of parts that may meet */
    double separation;   /* of motions: the clearance, unless pairs have their own */
    uint64_t asked;      /* motions */
    bool is_open; /* not all shapes are closed: those within others are not looked for */
    struct pccd_joint *joints;
    struct pccd_motion *motions; /* [shape_count] */
};

/* Register all shapes, and what may meet; sweep_end also after an error. Errors: those of
 * pccd.h. */
int sweep_begin(struct sweep *sweep);
void sweep_end(struct sweep *sweep);

/* A meeting: shapes, and a bracket of when they first meet. */
struct sweep_hit {
    bool is_there, is_proved;
    bool is_unknown; /* the answer is not complete: there may be none */
    double t[2];
    uint32_t shapes[2];
};

/* Ask what first meets between these values of all joints, at `distance` more than the
 * radii, with a bracket of `tolerance` of the motion. hit->t[0] is where it is proved
 * free to; not proved: hit->t[1] is where it may be free again. Errors: those of pccd.h;
 * an answer that is not complete is a hit of all of it, not proved. */
int sweep_ask(struct sweep *sweep, const double *from, const double *to, double distance,
              double tolerance, struct sweep_hit *hit);

/* Look for edges that pass through faces where the last motion began, and for what is
 * within something closed: both may go on without a meeting of features. If there is one,
 * *hit becomes a proved one at 0. Errors: those of pccd_near.h. */
int sweep_look(struct sweep *sweep, struct sweep_hit *hit);

/* Set m to where a shape is, in rows of [R | t], at these values of all joints. */
void sweep_pose(struct sweep *sweep, const double *values, uint32_t shape, double m[12]);

/* Find the nearest points of two shapes at these values of all joints, on what the radii
 * are around; of all that may meet where shapes[0] is shapes[1], which become those, of
 * the least distance above what they keep. *is_found: there are such points. Errors:
 * those of sweep_ask, pccd_near.h and pccd_points.h. */
int sweep_nearest(struct sweep *sweep, const double *values, uint32_t shapes[2],
                  double points[2][3], bool *is_found);

/* Ask for the motions of a file, {"from": VALUES, "to": VALUES} a line, in which all
 * joints move at once; VALUES: a list of all that have their own, or an object of some.
 * Each is told with its line and the values of all joints at its ends, in order. Errors:
 * those of sweep_ask, sweep_look and ctl_file_open; E_FORMAT, with the line. */
typedef void (*sweep_edge_fn)(void *context, uint64_t line, double *const ends[2],
                              const struct sweep_hit *hit);
int sweep_edges(struct sweep *sweep, const char *path, sweep_edge_fn each, void *context);

/* ---- A range of joints. */

/* An interval of each joint that moves by itself; the first one is swept. */
struct sweep_range {
    uint32_t count;
    uint32_t joints[SWEEP_AXES_MAX];
    double ends[SWEEP_AXES_MAX][2];
};

struct sweep_box {
    double ends[SWEEP_AXES_MAX][2];
};

enum sweep_verdict { SWEEP_FREE, SWEEP_JAMS, SWEEP_UNDECIDED };

/* A configuration where two shapes meet: intervals, at whose end they are proved to. */
struct sweep_jam {
    struct sweep_box at;
    uint32_t shapes[2];
    bool is_at_begin; /* they meet there already */
};

struct sweep_answer {
    enum sweep_verdict verdict;
    /* Of one joint: from its begin, then from its end. Of several: the one that was
     * found. */
    struct sweep_jam jams[2];
    uint32_t jam_count;
    /* Ours: all parts that meet where jams[0] is, if that is_at_begin. */
    struct robot_pair *meeting;
    size_t meeting_count, meeting_room;
    double undecided;       /* part of the range, 0 .. 1 */
    struct sweep_box *gaps; /* ours: [gap_count], where that is */
    size_t gap_count, gap_room;
    /* Least distance of the parts over the range, a bracket; [1] INFINITY: not asked.
     * Where pairs have a clearance of their own: above that of each. */
    double least[2];
    struct sweep_jam nearest; /* where they are as near as least[1] */
};

/* Set answer->meeting to all parts that meet at these values of all joints, those of the
 * first jam among them. Errors: those of sweep_ask and sweep_look; E_NOMEM. */
int sweep_meeting(struct sweep *sweep, const double *values, struct sweep_answer *answer);
/* Tell what meets in a range, while all other joints stay at `values`, or follow. Errors:
 * those of sweep_ask; E_NOMEM. sweep_answer_deinit also after an error. */
int sweep_try(struct sweep *sweep, const struct sweep_range *range, const double *values,
              struct sweep_answer *answer);
void sweep_answer_deinit(struct sweep_answer *answer);

/* ---- What came of it. */

/* Print what is swept, before it is. */
void sweep_report_begin(FILE *to, const struct sweep *sweep);
/* Print joints that do not move by themselves, and why. */
void sweep_report_still(FILE *to, const struct robot *robot);
/* Print what came of a range; all other joints were at `values`. */
void sweep_report_range(FILE *to, const struct sweep *sweep,
                        const struct sweep_range *range, const double *values,
                        const struct sweep_answer *answer);
/* Return the same as JSON. NULL: no memory. */
json_t *sweep_report_json(const struct sweep *sweep, const struct sweep_range *range,
                          const double *values, const struct sweep_answer *answer);
/* Print what came of a motion between two configurations; return it as JSON. */
void sweep_report_edge(FILE *to, const struct robot *robot, uint64_t line,
                       double *const ends[2], const struct sweep_hit *hit);
json_t *sweep_report_edge_json(const struct robot *robot, uint64_t line,
                               double *const ends[2], const struct sweep_hit *hit);
/* Return what a motion between two configurations is. */
enum sweep_verdict sweep_hit_verdict(const struct sweep_hit *hit);
/* Return the word for a verdict. */
const char *sweep_verdict_name(enum sweep_verdict verdict);

#endif
