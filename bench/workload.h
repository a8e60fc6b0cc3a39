/* workload.h - the list of benchmark scenes. */
#ifndef BENCH_WORKLOAD_H
#define BENCH_WORKLOAD_H

#include "bench_scene.h"
#include "report.h"

/* Turn a number of an object of a scene into its name in records, as a daemon's first
 * handles are, so that hashes can be compared, whoever has computed them; and back. */
#define BENCH_OBJECT_ID(i)  ((1u << 20) + (i))
#define BENCH_OBJECT_OF(id) ((id) - (1u << 20))

/* Scenes 0 .. bench_scene_total() - 1. */
unsigned bench_scene_total(void);
const char *bench_scene_name(unsigned index);

/* Make a scene; `small` for a run that only asks whether everything works. False: its
 * frames are not there (recorded scenes; none of them is small). */
bool bench_scene_make(unsigned index, bool small, struct bench_scene *scene);

/* Make the next scene from *index on that `options` want and, unless it is NULL, the list
 * `names`, which NULL ends; small ones in a smoke run, and those of gigabytes only where
 * a name is wanted. The caller frees it. Those that
 * cannot be made are reported as skipped. False: there are no more. */
bool bench_next_scene(const struct bench_options *options, const char *const *names,
                      unsigned *index, struct bench_scene *scene);

#endif
