/* ply.h - reads the binary PLY files of the public scenes. */
#ifndef TESTS_PLY_H
#define TESTS_PLY_H

#include <stdbool.h>
#include <stdint.h>

struct ply {
    uint32_t vertex_count;
    uint32_t triangle_count;
    bool is_f32;
    double (*x)[3];
    uint32_t (*triangles)[3];
};

/* False, with a line on stderr, for a file that is not as above. */
bool ply_read(const char *path, struct ply *ply);
void ply_deinit(struct ply *ply);

#endif
