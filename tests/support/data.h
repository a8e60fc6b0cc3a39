/* data.h - finds the public scenes that tests use, and reads their lists of pairs. */
#ifndef TESTS_DATA_H
#define TESTS_DATA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DATA_PATH_MAX 1024

/* The path of `name` in the folder $PCCD_DATA. False if there is no such file, or nobody
 * said where the scenes are: the caller skips. */
bool data_find(const char *name, char path[DATA_PATH_MAX]);

/* The public scenes, as names for data_find. Index 0 of the pairs is VF, 1 is EE. */
enum data_scene_name { DATA_CLOTH_BALL, DATA_N_BODY, DATA_CLOTH_FUNNEL, DATA_SCENES };

struct data_scene {
    const char *name;
    const char *frames[2]; /* t = 0, t = 1 */
    const char *ids[2];
    const char *truth[2];
    const char *queries[2]; /* NULL: not published */
};
extern const struct data_scene data_scenes[DATA_SCENES];

/* [[a, b], ...] and [true, false, ...] of the same length. */
struct data_pairs {
    size_t count;
    uint32_t (*ids)[2];
    bool *truth;
};
bool data_pairs_read(const char *ids_path, const char *truth_path,
                     struct data_pairs *pairs);
void data_pairs_deinit(struct data_pairs *pairs);

/* Eight points a query: four at t = 0, then the same at t = 1. */
struct data_queries {
    size_t count;
    double (*p)[8][3];
    bool *truth; /* only meaningful if has_truth */
    bool has_truth;
};
/* False, with a line on stderr, if a number is not exactly a double. */
bool data_queries_read(const char *path, struct data_queries *queries);
void data_queries_deinit(struct data_queries *queries);

/* All hand-made queries, in the order of their paths. `use` is called once a file.
 * Returns the number of files; 0 if the folder is absent. */
typedef void data_use_t(void *context, bool is_vf, const char *path,
                        const struct data_queries *queries);
size_t data_handmade(data_use_t *use, void *context);

#endif
