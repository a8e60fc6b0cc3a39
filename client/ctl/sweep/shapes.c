/* shapes.c - the meshes of a mechanism's shapes. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "confined.h"
#include "robot.h"
#include "shown.h"

/* ---- files ------------------------------------------------------------------------- */

/* Return "FOLDER/MORE/NAME" if it is there, the caller's to free; else NULL. What is
 * outside of the folder that may be read counts as there, so that its reader refuses it,
 * whether it is there or not; above FOLDER it is not looked for. */
static char *try_file(const char *folder, int folder_bytes, const char *more,
                      const char *name)
{
    char *path = NULL;
    if (asprintf(&path, "%.*s%s%s%s", folder_bytes, folder, folder_bytes > 0 ? "/" : "",
                 more, name) < 0) {
        return NULL;
    }
    int why = tool_is_outside(path, false);
    if (why == 0 ? access(path, F_OK) != 0 : why != EXDEV || more[0] != '\0') {
        free(path);
        path = NULL;
    }
    return path;
}

/* Return where a mesh is, the caller's to free; NULL: nowhere, or no memory. It is looked
 * for by its path, by what is behind the package's name, and by its last name, in the
 * folders that were named; then beside the file that names it, and above. */
static char *find_file(const struct robot *robot, const struct robot_options *options,
                       const char *name)
{
    static const char *const above[] = {"", "../", "../../", "../../../"};
    const char *slash = strrchr(robot->path, '/'), *end = strstr(name, "://");
    const char *path = end != NULL ? end + 3 : name, *behind = strchr(path, '/');
    const char *last = strrchr(path, '/');
    const char *tries[] = {path, behind != NULL ? behind + 1 : path,
                           last != NULL ? last + 1 : path};
    char *found = path[0] == '/' ? try_file("", 0, "", path) : NULL;
    for (size_t i = 0; i < options->meshes.count * 3 && found == NULL; i++) {
        const char *folder = options->meshes.list[i / 3];
        found = try_file(folder, (int)strlen(folder), "", tries[i % 3]);
    }
    /* A package's folder is often one above that of its URDF files. */
    for (size_t i = 0; i < 8 && found == NULL && path[0] != '/'; i++) {
        found = try_file(robot->path, slash != NULL ? (int)(slash - robot->path) : 0,
                         above[i / 2], tries[i % 2]);
    }
    return found != NULL || path[0] == '/'
               ? found
               : try_file(robot->path, slash != NULL ? (int)(slash - robot->path) : 0, "",
                          tries[2]);
}

static int read_file(const struct robot *robot, struct robot_shape *shape,
                     const struct robot_options *options, struct ctl_error *error)
{
    char *path =
        shape->is_given ? strdup(shape->path) : find_file(robot, options, shape->path);
    if (path == NULL) {
        return ctl_error_set(error, PCCD_E_SYSTEM,
                             "%s:%" PRIu32 ": \"%s\": the mesh %s is not there, nor in a "
                             "folder that --meshes names",
                             robot->path, shape->line,
                             tool_shown(robot->parts[shape->part].name),
                             tool_shown(shape->path));
    }
    int status = ctl_mesh_read(path, &shape->mesh, error);
    if (status == PCCD_OK) {
        status = ctl_mesh_promote(&shape->mesh, error);
    }
    double(*x)[3] = shape->mesh.x;
    for (uint32_t v = 0; status == PCCD_OK && v < shape->mesh.vertex_count; v++) {
        for (int c = 0; c < 3; c++) {
            x[v][c] *= shape->size[c];
        }
    }
    shape->mesh.path = NULL;
    free(path);
    return status;
}

/* ---- solids ------------------------------------------------------------------------ */

/* Give a mesh so many vertices and return them; NULL: no memory. */
static double (*make_vertices(struct ctl_mesh *mesh, uint32_t count))[3]
{
    return ctl_mesh_alloc_vertices(mesh, PCCD_FORMAT_F64, count) == PCCD_OK ? mesh->x
                                                                            : NULL;
}

/* Corners by the signs of their coordinates: bit 0 is x. */
static int make_box(struct ctl_mesh *mesh, const double size[3])
{
    static const uint32_t faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                          {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                          {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    double(*x)[3] = make_vertices(mesh, 8);
    int status = x != NULL ? PCCD_OK : PCCD_E_NOMEM;
    for (uint32_t v = 0; x != NULL && v < 8; v++) {
        for (uint32_t c = 0; c < 3; c++) {
            x[v][c] = ((v >> c & 1) != 0 ? 0.5 : -0.5) * size[c];
        }
    }
    for (uint32_t f = 0; f < 12 && status == PCCD_OK; f++) {
        status = ctl_mesh_add(mesh, CTL_TRIANGLES, faces[f]);
    }
    return status;
}

/* Make the prism that a cylinder touches with its sides from within: what it does not
 * meet, the cylinder does not. The last two vertices are the middles of its ends. */
static int make_prism(struct ctl_mesh *mesh, double radius, double length, uint32_t sides)
{
    double(*x)[3] = make_vertices(mesh, 2 * sides + 2);
    double corner = radius / cos(ROBOT_PI / sides) * (1 + 1e-14);
    int status = x != NULL ? PCCD_OK : PCCD_E_NOMEM;
    for (uint32_t v = 0; x != NULL && v < 2 * sides + 2; v++) {
        bool is_middle = v >= 2 * sides;
        double angle = 2 * ROBOT_PI * (v % sides) / sides;
        x[v][0] = is_middle ? 0 : corner * cos(angle);
        x[v][1] = is_middle ? 0 : corner * sin(angle);
        x[v][2] = ((is_middle ? v == 2 * sides : v < sides) ? -0.5 : 0.5) * length;
    }
    for (uint32_t i = 0; i < sides && status == PCCD_OK; i++) {
        uint32_t next = (i + 1) % sides;
        const uint32_t faces[4][3] = {{i, next, sides + next},
                                      {i, sides + next, sides + i},
                                      {2 * sides, next, i},
                                      {2 * sides + 1, sides + i, sides + next}};
        for (int f = 0; f < 4 && status == PCCD_OK; f++) {
            status = ctl_mesh_add(mesh, CTL_TRIANGLES, faces[f]);
        }
    }
    return status;
}

/* Make a point, or an edge along z, with a radius. */
static int make_round(struct robot_shape *shape)
{
    static const uint32_t ends[2] = {0, 1};
    bool is_point = shape->form == ROBOT_SPHERE;
    double(*x)[3] = make_vertices(&shape->mesh, is_point ? 1 : 2);
    if (x == NULL) {
        return PCCD_E_NOMEM;
    }
    memset(x, 0, (is_point ? 1 : 2) * sizeof *x);
    if (!is_point) {
        x[0][2] = -0.5 * shape->size[1];
        x[1][2] = 0.5 * shape->size[1];
    }
    shape->settings.what |= PCCD_OBJECT_RADIUS;
    shape->settings.radius = shape->size[0];
    return ctl_mesh_add(&shape->mesh, is_point ? CTL_POINTS : CTL_EDGES, ends);
}

int robot_make_shapes(struct robot *robot, const struct robot_options *options,
                      struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < options->meshes.count; i++) {
        const char *folder = options->meshes.list[i];
        struct stat of;
        if (tool_is_outside(folder, false) == 0 &&
            (stat(folder, &of) != 0 || !S_ISDIR(of.st_mode))) {
            return ctl_error_set(error, PCCD_E_SYSTEM, "--meshes %s: no such folder",
                                 tool_shown(folder));
        }
    }
    for (uint32_t i = 0; i < robot->shape_count && status == PCCD_OK; i++) {
        struct robot_shape *shape = &robot->shapes[i];
        shape->mesh = (struct ctl_mesh){.error = error};
        switch (shape->form) {
        case ROBOT_MESH:
            status = read_file(robot, shape, options, error);
            break;
        case ROBOT_BOX:
            status = make_box(&shape->mesh, shape->size);
            break;
        case ROBOT_CYLINDER:
            status =
                make_prism(&shape->mesh, shape->size[0], shape->size[1], options->sides);
            break;
        default:
            status = make_round(shape);
            break;
        }
        if (status == PCCD_E_NOMEM) {
            return ctl_error_set(error, status, "no memory for the shapes of %s",
                                 robot->path);
        }
    }
    return status;
}
