/* truth_kit.h - the public scenes, as tests take them. */
#ifndef TRUTH_KIT_H
#define TRUTH_KIT_H

#include "data.h"
#include "oracle_scene.h"
#include "ply.h"

/* Queries of the hand-made collection. */
#define TRUTH_HANDMADE 3779

typedef const double (*truth_points)[3];

/* The path of a file. Skips the test if there is none. */
void truth_find(const char *name, char path[DATA_PATH_MAX]);

/* The frames of a scene, of the same triangles. Skips or fails the test. The caller
 * frees both with ply_deinit. */
void truth_read_frames(const struct data_scene *scene, struct ply frames[2]);

/* Object 0, which moves from the one frame to the other; it is theirs. */
struct oracle_object truth_object(const struct ply frames[2]);

#endif
