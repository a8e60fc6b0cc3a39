/* snapshot.h - one step of a recording at one moment, ready to be drawn or exported. */
#ifndef CTL_SNAPSHOT_H
#define CTL_SNAPSHOT_H

#include "play.h"

struct snapshot_object {
    char *name; /* NULL: it has none */
    uint32_t handle;
    uint32_t vertex_count, triangle_count;
    uint32_t edge_count, point_count;
    float (*x)[3];      /* at the time that was asked for, less the origin */
    float (*motion)[3]; /* from t = 0 to t = 1 */
    uint32_t (*triangles)[3];
    uint32_t (*edges)[2]; /* of rods: those that no triangle has */
    uint32_t *points;     /* those that no triangle and no edge has */
    float *radii;   /* of its vertices; a feature has the greatest of them; NULL: all 0 */
    uint32_t *hits; /* of each triangle: contacts of it, its edges and its corners */
};

struct snapshot_contact {
    float at[3]; /* where its second feature is touched, then, less the origin */
    float normal[3];
    /* When they meet, from there to the nearest point of its first feature, where the two
     * have a distance to keep; and which part of that is on the side of the second. */
    float reach[3];
    float share;
    float radius; /* to the farthest vertex of its two features, then */
    double toi;
    uint32_t kind, flags;
    uint32_t object_a, feature_a, object_b, feature_b;
    uint32_t corners[2][3]; /* vertices of both features, as many as the kind says */
};

/* The nearest points of two features; of a crossing, the ends of its edge. */
struct snapshot_line {
    float ends[2][3]; /* less the origin */
    double distance;  /* d_lo */
    uint32_t kind;
};

struct snapshot {
    uint64_t step;
    double t;
    double separation; /* of the step */
    struct snapshot_object *objects;
    uint32_t object_count;
    struct snapshot_contact *contacts;
    uint64_t contact_count;
    struct snapshot_line *lines; /* of snapshot_take_near; then there are no contacts */
    uint64_t line_count;
    double extent;    /* largest side of the box around everything */
    double origin[3]; /* zeros but for a scene that is small for how far off it is */
    bool has_origin;
    uint64_t chosen; /* in `contacts`: the one that was asked for, else the earliest */
};

/* Moment of a step. */
struct snapshot_at {
    double t;         /* NAN: when `contact` happens, or the earliest of few; else 1 */
    uint64_t contact; /* from 1, in the order of the answer; 0: none in particular */
    uint64_t few;     /* so many contacts are; 0: none are */
};

#define SNAPSHOT_FIRST UINT64_MAX /* as `contact`: the earliest one */

/* Take the last answered step of `settings`, or the one it names. E_INVAL: it has no such
 * step, or no such contact. */
int snapshot_take(const struct play_settings *settings, const struct snapshot_at *at,
                  struct snapshot *snapshot, struct play_summary *summary,
                  struct ctl_error *error);
/* Taker of the steps of snapshot_each; it returns PCCD_OK to go on. */
typedef int (*snapshot_fn)(void *context, const struct snapshot *snapshot,
                           struct ctl_error *error);
/* Take each answered step of `settings` at t, one after the other, and give it to
 * `show`. */
int snapshot_each(const struct play_settings *settings, double t, snapshot_fn show,
                  void *context, struct play_summary *summary, struct ctl_error *error);
/* Take the last answered question about what is near, at the moment that it asked for.
 * Bounds of vertices are no lines. E_INVAL: there is no such question. */
int snapshot_take_near(const struct play_settings *settings, struct snapshot *snapshot,
                       struct play_summary *summary, struct ctl_error *error);
/* Return the greatest distance of its lines; 0: none. */
double snapshot_greatest(const struct snapshot *snapshot);
/* Print what there is of it in the file `path`, on the standard output. */
void snapshot_report(const struct snapshot *snapshot, const char *path, bool is_json);
/* Print how many steps the file `path` has, on the standard output. */
void snapshot_report_steps(const char *path, uint64_t step_count, bool is_json);
void snapshot_deinit(struct snapshot *snapshot);

#endif
