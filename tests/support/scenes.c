/* scenes.c - generated meshes with motion, small enough for brute force. */
#include "scenes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static void *get(size_t count, size_t bytes)
{
    void *block = calloc(count + 1, bytes);
    if (!block) {
        abort();
    }
    return block;
}

static void allocate(struct scenes_mesh *mesh, uint32_t vertex_count,
                     uint32_t triangle_count)
{
    memset(mesh, 0, sizeof *mesh);
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    mesh->x0 = get(vertex_count, sizeof *mesh->x0);
    mesh->x1 = get(vertex_count, sizeof *mesh->x1);
    mesh->triangles = get(triangle_count, sizeof *mesh->triangles);
}

void scenes_deinit(struct scenes_mesh *mesh)
{
    free(mesh->x0);
    free(mesh->x1);
    free(mesh->triangles);
    free(mesh->vertex_of);
    free(mesh->triangle_of);
    memset(mesh, 0, sizeof *mesh);
}

const char *scenes_name(enum scenes_kind kind)
{
    static const char *const names[SCENES_KINDS] = {
        "soup",    "cloth",      "sphere", "two-spheres", "snapped", "fast",
        "sliding", "duplicates", "still",  "slivers",     "far",     "tiny"};
    return names[kind];
}

static double lattice(struct prng *prng, uint32_t side, double step)
{
    return step * (double)prng_below(prng, (uint64_t)side + 1);
}

/* x1 = x0 moved by up to `reach` along each axis. */
static void jitter(struct scenes_mesh *mesh, struct prng *prng, double reach)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            mesh->x1[i][k] = mesh->x0[i][k] + prng_between(prng, -reach, reach);
        }
    }
}

/* Triangles of about unit size, as many to a unit of volume as there are contacts to
 * find. */
static void make_soup(struct scenes_mesh *mesh, uint32_t count, struct prng *prng,
                      double reach)
{
    double side = 0.9 * cbrt((double)count);
    allocate(mesh, 3 * count, count);
    for (uint32_t t = 0; t < count; t++) {
        double centre[3];
        for (int k = 0; k < 3; k++) {
            centre[k] = prng_between(prng, 0, side);
        }
        for (uint32_t i = 0; i < 3; i++) {
            mesh->triangles[t][i] = 3 * t + i;
            for (int k = 0; k < 3; k++) {
                mesh->x0[3 * t + i][k] = centre[k] + prng_between(prng, -0.5, 0.5);
            }
        }
    }
    jitter(mesh, prng, reach);
}

/* Indices of a grid of `columns` by `rows` squares, from `first` on. Returns the vertices
 * used. */
static uint32_t grid_triangles(struct scenes_mesh *mesh, uint32_t first_triangle,
                               uint32_t first, uint32_t columns, uint32_t rows)
{
    for (uint32_t i = 0; i < columns * rows; i++) {
        uint32_t corner = first + i / columns * (columns + 1) + i % columns;
        uint32_t above = corner + columns + 1;
        uint32_t *lower = mesh->triangles[first_triangle + 2 * i];
        uint32_t *upper = mesh->triangles[first_triangle + 2 * i + 1];
        lower[0] = corner;
        lower[1] = corner + 1;
        lower[2] = above;
        upper[0] = corner + 1;
        upper[1] = above + 1;
        upper[2] = above;
    }
    return (columns + 1) * (rows + 1);
}

/* A position on a sheet that is rolled up by `turns`, at (u, v) in 0 .. 1. */
static void rolled(double x[3], double u, double v, double turns)
{
    double angle = 2 * PI * turns * u;
    if (turns == 0) {
        x[0] = 4 * u;
        x[1] = 4 * v;
        x[2] = 0;
    } else {
        double radius = 4 / (2 * PI * turns) * (1.1 - 0.2 * u);
        x[0] = radius * sin(angle);
        x[1] = 4 * v;
        x[2] = radius * (1 - cos(angle));
    }
}

static void make_cloth(struct scenes_mesh *mesh, uint32_t count, struct prng *prng)
{
    uint32_t side = (uint32_t)ceil(sqrt((double)count / 2));
    double from = prng_between(prng, 0, 1.2);
    allocate(mesh, (side + 1) * (side + 1), 2 * side * side);
    grid_triangles(mesh, 0, 0, side, side);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        double u = (double)(i % (side + 1)) / side;
        double v = (double)(i / (side + 1)) / side;
        rolled(mesh->x0[i], u, v, from);
        rolled(mesh->x1[i], u, v, from + 0.9);
        for (int k = 0; k < 3; k++) {
            mesh->x0[i][k] += prng_between(prng, -0.02, 0.02);
            mesh->x1[i][k] += prng_between(prng, -0.02, 0.02);
        }
    }
}

/* A sphere of radius 1 around `centre`: poles and rings. Fills x0 and the triangles from
 * the given numbers on. */
static void place_sphere(struct scenes_mesh *mesh, uint32_t vertex, uint32_t triangle,
                         uint32_t rings, double centre)
{
    uint32_t around = 2 * rings;
    uint32_t south = vertex + rings * around;
    for (uint32_t i = 0; i < rings * around + 2; i++) {
        double polar = PI * (1.0 + i / around) / (1.0 + rings);
        double azimuth = 2 * PI * (i % around) / around;
        polar = vertex + i == south ? PI : vertex + i > south ? 0 : polar;
        mesh->x0[vertex + i][0] = centre + sin(polar) * cos(azimuth);
        mesh->x0[vertex + i][1] = sin(polar) * sin(azimuth);
        mesh->x0[vertex + i][2] = cos(polar);
    }
    for (uint32_t i = 0; i < (rings + 1) * around; i++) {
        uint32_t j = i % around;
        uint32_t next = (j + 1) % around;
        uint32_t ring = i / around; /* the ring below, if ring < rings */
        if (ring > 0) {
            uint32_t above = vertex + (ring - 1) * around;
            uint32_t *t = mesh->triangles[triangle++];
            t[0] = above + j;
            t[1] = ring < rings ? vertex + ring * around + j : south;
            t[2] = above + next;
        }
        if (ring < rings) {
            uint32_t here = vertex + ring * around;
            uint32_t *t = mesh->triangles[triangle++];
            t[0] = here + j;
            t[1] = here + next;
            t[2] = ring > 0 ? vertex + (ring - 1) * around + next : south + 1;
        }
    }
}

static void make_spheres(struct scenes_mesh *mesh, uint32_t count, struct prng *prng,
                         uint32_t spheres)
{
    uint32_t rings = (uint32_t)ceil(sqrt((double)count / (4 * spheres)));
    uint32_t vertices = 2 * rings * rings + 2;
    uint32_t triangles = 4 * rings * rings;
    allocate(mesh, spheres * vertices, spheres * triangles);
    for (uint32_t s = 0; s < spheres; s++) {
        place_sphere(mesh, s * vertices, s * triangles, rings, 2.5 * s);
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        double scale = spheres == 1 ? prng_between(prng, -0.4, 0.8) : 1;
        double shift = i < vertices ? 0 : prng_between(prng, -1.5, -1.4);
        for (int k = 0; k < 3; k++) {
            mesh->x1[i][k] = scale * mesh->x0[i][k] + (k == 0 ? shift : 0);
        }
    }
}

/* Triangles between random vertices; `chance` of 4 that a coordinate moves at all. */
static void make_snapped(struct scenes_mesh *mesh, uint32_t count, struct prng *prng,
                         uint32_t chance)
{
    uint32_t side = 2 + prng_u32(prng, 4);
    allocate(mesh, 5 + count, count);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            mesh->x0[i][k] = lattice(prng, side, 0.25);
            mesh->x1[i][k] = mesh->x0[i][k];
            if (prng_below(prng, 4) < chance) {
                mesh->x1[i][k] = lattice(prng, side, 0.25);
            }
        }
    }
    for (uint32_t t = 0; t < count; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = prng_u32(prng, mesh->vertex_count);
        }
    }
}

/* Grids in the plane z = 0 or z = x + y, moved by multiples of 1/8 within it. */
static void make_sliding(struct scenes_mesh *mesh, uint32_t count, struct prng *prng)
{
    uint32_t patches = 3;
    uint32_t side = (uint32_t)ceil(sqrt((double)count / (2 * patches)));
    uint32_t vertices = (side + 1) * (side + 1);
    bool is_oblique = prng_below(prng, 2) == 1;
    allocate(mesh, patches * vertices, patches * 2 * side * side);
    for (uint32_t p = 0; p < patches; p++) {
        double shift[4];
        for (int k = 0; k < 4; k++) {
            shift[k] = lattice(prng, 16 * side, 0.125);
        }
        grid_triangles(mesh, p * 2 * side * side, p * vertices, side, side);
        for (uint32_t i = 0; i < vertices; i++) {
            double *x0 = mesh->x0[p * vertices + i];
            double *x1 = mesh->x1[p * vertices + i];
            x0[0] = (double)(i % (side + 1)) + shift[0];
            x0[1] = (double)(i / (side + 1)) + shift[1];
            x1[0] = x0[0] + (p == 0 ? 0 : shift[2] - (double)side);
            x1[1] = x0[1] + (p == 0 ? 0 : shift[3] - (double)side);
            x0[2] = is_oblique ? x0[0] + x0[1] : 0;
            x1[2] = is_oblique ? x1[0] + x1[1] : 0;
        }
    }
}

/* Spoil a mesh: triangles that occur twice, repeat a vertex, or have no area or
 * length. */
static void spoil(struct scenes_mesh *mesh, struct prng *prng)
{
    for (uint32_t i = 0; i < 1 + mesh->triangle_count / 8; i++) {
        uint32_t *t = mesh->triangles[prng_below(prng, mesh->triangle_count)];
        const uint32_t *other = mesh->triangles[prng_below(prng, mesh->triangle_count)];
        switch (prng_below(prng, 5)) {
        case 0:
            memmove(t, other, sizeof mesh->triangles[0]);
            break;
        case 1:
            t[1] = t[0];
            break;
        case 2:
            t[1] = t[2] = t[0];
            break;
        case 3: /* a corner in the middle of the opposite side, at t = 0 */
            for (int k = 0; k < 3; k++) {
                mesh->x0[t[0]][k] = 0.5 * (mesh->x0[t[1]][k] + mesh->x0[t[2]][k]);
            }
            break;
        default: /* two vertices at one place for the whole step */
            memcpy(mesh->x0[t[0]], mesh->x0[t[1]], sizeof mesh->x0[0]);
            memcpy(mesh->x1[t[0]], mesh->x1[t[1]], sizeof mesh->x1[0]);
            break;
        }
    }
}

/* Needles: two corners far apart, the third beside one of them, all in about one
 * direction. */
static void make_slivers(struct scenes_mesh *mesh, uint32_t count, struct prng *prng)
{
    allocate(mesh, 3 * count, count);
    for (uint32_t t = 0; t < count; t++) {
        double width = ldexp(1, -(int)prng_below(prng, 40));
        double start[3];
        for (int k = 0; k < 3; k++) {
            start[k] = prng_between(prng, 0, k == 0 ? 1 : 0.05 * (double)count);
        }
        for (uint32_t i = 0; i < 3; i++) {
            double *x0 = mesh->x0[3 * t + i];
            mesh->triangles[t][i] = 3 * t + i;
            for (int k = 0; k < 3; k++) {
                x0[k] = start[k] + (i == 1 && k == 0 ? 3 : 0) +
                        prng_between(prng, -width, width);
            }
        }
    }
    jitter(mesh, prng, 1);
}

/* The nearest float if asked. Through memory, because gcc 12 at -O3 was seen to drop the
 * conversion here (not with -fno-tree-partial-pre). */
static double rounded(bool is_f32, double x)
{
    volatile float nearest = (float)x;
    return is_f32 ? (double)nearest : x;
}

/* x -> factor x + offset, then to float if asked. Lattices stay lattices with 1 and 0. */
static void finish(struct scenes_mesh *mesh, double factor, double offset)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        for (int k = 0; k < 6; k++) {
            double *x = k < 3 ? &mesh->x0[i][k] : &mesh->x1[i][k - 3];
            *x = rounded(mesh->is_f32, factor * *x + offset);
        }
    }
}

static void scale_and_offset(enum scenes_kind kind, double *factor, double *offset)
{
    *factor = kind == SCENES_TINY ? 1e-30 : 1;
    *offset = kind == SCENES_FAR ? 1e6 : 0;
}

void scenes_make(struct scenes_mesh *mesh, enum scenes_kind kind, uint32_t triangle_count,
                 bool is_f32, uint64_t seed)
{
    struct prng prng = {seed};
    double factor;
    double offset;
    uint32_t count = triangle_count > 0 ? triangle_count : 1;
    switch (kind) {
    case SCENES_CLOTH:
    case SCENES_DUPLICATES:
        make_cloth(mesh, count, &prng);
        break;
    case SCENES_SPHERE:
        make_spheres(mesh, count, &prng, 1);
        break;
    case SCENES_TWO_SPHERES:
        make_spheres(mesh, count, &prng, 2);
        break;
    case SCENES_SNAPPED:
        make_snapped(mesh, count, &prng, 4);
        break;
    case SCENES_STILL:
        make_snapped(mesh, count, &prng, 1);
        break;
    case SCENES_SLIDING:
        make_sliding(mesh, count, &prng);
        break;
    case SCENES_SLIVERS:
        make_slivers(mesh, count, &prng);
        break;
    default:
        make_soup(mesh, count, &prng, kind == SCENES_FAST ? 20 : 0.6);
        break;
    }
    if (kind == SCENES_DUPLICATES) {
        spoil(mesh, &prng);
    }
    mesh->is_f32 = is_f32;
    scale_and_offset(kind, &factor, &offset);
    finish(mesh, factor, offset);
}

void scenes_move_on(struct scenes_mesh *mesh, enum scenes_kind kind, struct prng *prng)
{
    double factor;
    double offset;
    bool is_lattice = kind == SCENES_SNAPPED || kind == SCENES_STILL;
    double slide[2] = {lattice(prng, 8, 0.125) - 0.5, lattice(prng, 8, 0.125) - 0.5};
    scale_and_offset(kind, &factor, &offset);
    memcpy(mesh->x0, mesh->x1, mesh->vertex_count * sizeof *mesh->x0);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            double move = prng_between(prng, -0.3, 0.3);
            if (is_lattice) {
                move = prng_below(prng, 2) ? 0 : lattice(prng, 4, 0.25) - 0.5;
            } else if (kind == SCENES_SLIDING) {
                /* Every other vertex, in its plane. */
                move = i % 2 ? 0 : k < 2 ? slide[k] : 0;
                if (k == 2 && mesh->x0[i][2] != 0 && i % 2 == 0) {
                    move = slide[0] + slide[1];
                }
            }
            double x = mesh->x0[i][k] + factor * move;
            mesh->x1[i][k] = rounded(mesh->is_f32, x);
        }
    }
}

/* The least vertex that `v` is connected with; shortens the way for the next question. */
static uint32_t find(uint32_t *least, uint32_t v)
{
    while (least[v] != v) {
        least[v] = least[least[v]];
        v = least[v];
    }
    return v;
}

static uint32_t *connected_pieces(const struct scenes_mesh *mesh)
{
    uint32_t *least = get(mesh->vertex_count, sizeof *least);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        least[i] = i;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 1; k < 3; k++) {
            uint32_t a = find(least, mesh->triangles[t][0]);
            uint32_t b = find(least, mesh->triangles[t][k]);
            least[a < b ? b : a] = a < b ? a : b;
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        least[i] = find(least, i);
    }
    return least;
}

/* Copy the triangles of one part and the vertices in use. */
static void cut_part(const struct scenes_mesh *mesh, const uint32_t *part_of,
                     uint32_t number, struct scenes_mesh *part)
{
    uint32_t *local = get(mesh->vertex_count, sizeof *local);
    uint32_t triangles = 0;
    uint32_t vertices = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles[t];
        if (part_of[v[0]] == number) {
            triangles++;
            local[v[0]] = local[v[1]] = local[v[2]] = 1;
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        vertices += local[i];
    }
    allocate(part, vertices, triangles);
    part->is_f32 = mesh->is_f32;
    part->vertex_of = get(vertices, sizeof *part->vertex_of);
    part->triangle_of = get(triangles, sizeof *part->triangle_of);
    vertices = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        if (local[i]) {
            memcpy(part->x0[vertices], mesh->x0[i], sizeof *part->x0);
            memcpy(part->x1[vertices], mesh->x1[i], sizeof *part->x1);
            part->vertex_of[vertices] = i;
            local[i] = vertices++;
        }
    }
    triangles = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (part_of[mesh->triangles[t][0]] == number) {
            for (int k = 0; k < 3; k++) {
                part->triangles[triangles][k] = local[mesh->triangles[t][k]];
            }
            part->triangle_of[triangles++] = t;
        }
    }
    free(local);
}

uint32_t scenes_split(const struct scenes_mesh *mesh, uint32_t count,
                      struct scenes_mesh *parts)
{
    uint32_t *part_of = connected_pieces(mesh);
    uint32_t *piece = get(mesh->vertex_count, sizeof *piece); /* 1 + number of a piece */
    uint32_t pieces = 0;
    /* Pieces are numbered by their first triangle and dealt out in turn. */
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t *number = &piece[part_of[mesh->triangles[t][0]]];
        *number = *number ? *number : ++pieces;
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        uint32_t number = piece[part_of[i]];
        part_of[i] = number ? (number - 1) % count : count;
    }
    uint32_t made = pieces < count ? pieces : count;
    for (uint32_t i = 0; i < made; i++) {
        cut_part(mesh, part_of, i, &parts[i]);
    }
    free(piece);
    free(part_of);
    return made;
}
