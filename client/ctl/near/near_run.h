/* near_run.h - runs `pccdctl near`: puts meshes into a scene, and asks what is near
 * there.
 *
 * Threads: one.
 */
#ifndef CTL_NEAR_RUN_H
#define CTL_NEAR_RUN_H

#include "check_run.h"
#include "error.h"
#include "meshfile.h"
#include "meshframes.h"
#include "pccd.h"

/* A file, which is an object of the scene. */
struct near_object {
    const char *path; /* the caller's */
    struct ctl_welded welded;
    struct ctl_mesh mesh; /* ours; its positions are given back when it is registered */
    struct pccd_edge *edges; /* ours; NULL unless asked for */
    struct pccd_mesh_info info;
    uint32_t handle;
    uint32_t frame_count; /* of the file, of which the first is read */
};

/* All zero, but for what is the caller's, before near_run_read. */
struct near_run {
    struct check_run run;               /* client and repeats are the caller's */
    struct pccd_near_settings settings; /* the caller's */
    struct near_object *objects;        /* ours, in the order of the files */
    uint32_t object_count;
    struct report_step step; /* the answer; no names of files */
};

/* Read the files, and join vertices as run.ask says. Errors: those of ctl_frames_open. */
int near_run_read(struct near_run *near, char *const *paths, uint32_t path_count,
                  struct ctl_error *error);
/* Register all; with_edges: get their edges, too. */
int near_run_begin(struct near_run *near, bool with_edges, struct ctl_error *error);
/* Ask. The pages of the last answer go to `page`, unless that is NULL. */
int near_run_ask(struct near_run *near,
                 void (*page)(void *context, const struct pccd_answer *page),
                 void *context, struct ctl_error *error);
/* The library names objects by handles, of which a user of files has never heard: by the
 * names of their files instead. */
void near_run_name_files(const struct near_run *near, struct ctl_error *error);
/* The object of that handle: its place among the files; object_count: none. */
uint32_t near_run_place(const struct near_run *near, uint32_t handle);
void near_run_deinit(struct near_run *near);

#endif
