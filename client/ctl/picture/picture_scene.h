/* picture_scene.h - what a picture shows, and from where: meshes, marked contacts,
 * camera, legend.
 *
 * Threads: [any]; data only.
 */
#ifndef CTL_PICTURE_SCENE_H
#define CTL_PICTURE_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#define PICTURE_WIDTH    1200
#define PICTURE_HEIGHT   900
#define PICTURE_SIDE_MAX 8192

struct picture_mesh {
    const float (*x)[3];
    const uint32_t (*triangles)[3];
    const uint32_t (*edges)[2]; /* of rods */
    const uint32_t *points;     /* of clouds: vertices */
    const float *radii; /* of the vertices; a feature has the greatest of them; NULL: 0 */
    uint32_t vertex_count;
    uint32_t triangle_count, edge_count, point_count;
    float front[3], back[3]; /* colours of the sides, 0 .. 1 */
};

/* A contact: where, and which of the groups it belongs to; or a line. */
struct picture_mark {
    float at[3];
    float to[3]; /* of a line */
    bool is_line;
    uint32_t group;
    bool is_chosen; /* drawn larger */
};

/* What is to be seen: a ball that fills the picture's height. */
struct picture_place {
    float at[3];
    float radius;
};

struct picture_group {
    char label[48]; /* "": not in the legend */
    float colour[3];
};

/* A run of colours in the legend: those of the groups, from the first to the last. */
struct picture_scale {
    char title[48];
    char low[16], high[16];
};

enum picture_up { PICTURE_UP_Y = 0, PICTURE_UP_Z, PICTURE_UP_X };

struct picture {
    const struct picture_mesh *meshes;
    const struct picture_mark *marks;
    const struct picture_group *groups;
    uint32_t mesh_count, mark_count, group_count;
    float from[3]; /* direction from the middle of the scene to the eye */
    enum picture_up up;
    uint32_t width, height; /* 0: PICTURE_WIDTH and PICTURE_HEIGHT */
    float zoom;             /* 0: everything is seen, just so; 2: twice as large */
    bool is_at_marks;       /* the marks are what is to be seen */
    /* Low and high corner of the box that is to be seen, so that several pictures are
     * from one place; NULL: that of the meshes. */
    const float (*bounds)[3];
    bool is_thick;          /* triangles have their radii; rods and points always have */
    float gap;              /* with is_thick: added to every radius */
    const struct picture_place *place; /* this is, and not the marks; NULL: no place */
    const char *title;
    const struct picture_scale *scale; /* NULL: none */
};

#endif
