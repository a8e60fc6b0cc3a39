/* render.h - what pccdctl render draws, and how. */
#ifndef CTL_RENDER_H
#define CTL_RENDER_H

#include "picture.h"
#include "play_options.h"
#include "snapshot.h"

/* So many contacts are few: a picture shows them close, when the first happens, and as
 * rings where they are hidden. */
#define RENDER_FEW 20u

/* Part of a step that a picture shows. */
enum render_at {
    RENDER_AT_ALL,
    RENDER_AT_FEW, /* the contacts where there are few, else all */
    RENDER_AT_CONTACTS,
    RENDER_AT_ONE
};

struct render {
    struct play_options options;
    const char *path;
    double t;                  /* NAN: not given */
    enum render_at at;
    uint64_t contact;          /* of RENDER_AT_ONE: from 1, or SNAPSHOT_FIRST */
    double azimuth, elevation; /* degrees; NAN: not given */
    double zoom;
    uint32_t up; /* as of struct picture; 0: as play_up says */
    uint32_t width, height;
    bool is_near; /* what is near, and not contacts */
    bool is_thick;
    bool is_film;
    bool marks_first;     /* the earliest contact of each step is drawn larger */
    bool has_first_tries; /* of a film: one step for each place where steps begin */
    double rate;    /* pictures a second of a film, frames of a file; 0: not given */
    uint32_t every; /* a film has each N-th step; 0: not given */
};

/* Draw to `film`, seen within the box `bounds`; or, where there is none, to `file`.
 * Errors: those of picture_write and film_add. */
int render_draw(const struct render *render, const struct snapshot *snapshot, FILE *file,
                struct film *film, const float (*bounds)[3], struct ctl_error *error);

/* Draw a film of the steps that these settings play, one after the other, up to one
 * without a path, seen within one box; *frame_count: how many. Errors: those of
 * render_draw and snapshot_each; E_LIMIT: more than a film has. */
int render_film(const struct render *render, const struct play_settings *parts, FILE *to,
                uint32_t *frame_count, struct play_summary *summary,
                struct ctl_error *error);

#endif
