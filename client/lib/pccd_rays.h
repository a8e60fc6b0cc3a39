/* pccd_rays.h - rays, spheres and capsules that are cast through a scene, many at once.
 *
 * A ray is a point that moves, a sphere one with a radius, a capsule an edge with a
 * radius that moves. A ray passes rods and points without a radius, as any point does
 * (struct pccd_mesh_data): give either one, or the settings of the cast a separation.
 * Casting is a step in which these move and all else stands where the last step left it;
 * so what is hit, and when, is as exact as a contact, and the same bytes everywhere.
 *
 *     struct pccd_rays_settings settings = PCCD_RAYS_SETTINGS_INIT;
 *     settings.count = 2;
 *     struct pccd_rays *rays;
 *     pccd_rays_begin(client, scene, &settings, &rays);
 *     double begin[2][3] = {{0, 0, 9}, {1, 0, 9}}, end[2][3] = {{0, 0, 0}, {1, 0, 0}};
 *     struct pccd_ray_hit hits[2];
 *     pccd_rays_cast(client, rays, begin[0], end[0], NULL, hits);
 *     if (hits[0].t <= 1) {
 *         use(hits[0].object, hits[0].point);
 *     }
 *     pccd_rays_end(client, rays);
 *
 * Give casts a scene of their own, with objects of the same meshes: rays are an object of
 * the scene, which its other steps, and casts of other rays, may meet where it stands;
 * and a cast also pays for what the other objects of its scene do to each other.
 *
 * Threads: as pccd.h, which includes this header.
 */
#ifndef PCCD_RAYS_H
#define PCCD_RAYS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

struct pccd_client;
struct pccd_rays;
struct pccd_step_settings;

struct pccd_rays_settings {
    size_t struct_bytes; /* sizeof(struct pccd_rays_settings); 0 reads as that */
    uint32_t count;      /* of rays, 1 or more */
    uint32_t ends;       /* of each: 0 or 1: a point; 2: a capsule, from one end to the
                            other */
    const double *radii; /* [count], 0 .. 1e18, in the unit of coordinates; NULL: 0 */
    uint32_t pieces;     /* each way is tested in so many, whose boxes hold less than that
                            of the whole; 0 = 8, for ways over a tenth of the level or
                            more; 1 where they are no longer than triangles. t of the same
                            hit may differ by the rounding of where the pieces begin */
    uint64_t group, mask; /* as in struct pccd_object_settings: rays meet the objects with
                             object.group & mask and object.mask & group not 0. 0 = those
                             of a new object */
};

#define PCCD_RAYS_SETTINGS_INIT                                                          \
    {                                                                                    \
        .struct_bytes = sizeof(struct pccd_rays_settings)                                \
    }

/* The first thing that a ray meets. */
struct pccd_ray_hit {
    double t;          /* the part of its way that it has gone then, 0 .. 1, at most
                        settings.tolerance / pieces before they meet; INFINITY: it meets
                        nothing, and all else is 0 */
    double point[3];   /* of the ray: where it is, the centre of a sphere, the point of a
                        capsule's edge. What it meets is the sum of the radii and the
                        step's separation away, against the normal */
    double weights[3]; /* of the feature's vertices, whose sum is 1: where on it */
    float normal[3];   /* unit, from the feature to the ray; zeros: they are at one place
                          that says no direction */
    uint32_t object;   /* handle */
    uint32_t feature;  /* index in that object's mesh: of a vertex, an edge or a face, */
    uint32_t points;   /* which has 1, 2 or 3 vertices */
};

/* Prepare rays for a scene. The daemon is asked by the first cast, which registers a mesh
 * and adds an object. Errors: E_INVAL: a NULL, no ray, more than two ends, a radius below
 * 0 or NaN; E_LIMIT: a radius above 1e18, more rays in pieces than a mesh may have
 * vertices; E_NOMEM. */
int pccd_rays_begin(struct pccd_client *client, uint32_t scene,
                    const struct pccd_rays_settings *settings, struct pccd_rays **rays);

/* Cast all of them, straight from begin to end: [count][3], of capsules [count][2][3], of
 * ways that end where they begin what they meet there. hits[count]. `settings` may be
 * NULL; mode, approach, hold and joints are not for a cast (E_INVAL). Where several
 * things are met at one t, the hit is the first record of them.
 * Errors: those of pccd_mesh_put, pccd_scene_add, pccd_object_set, pccd_step and
 * pccd_fetch; E_NOTFINITE: a coordinate is not finite, or beyond 1e18; E_LIMIT: the
 * answer was cut short by its deadline, or has more records than the daemon keeps. On
 * failure hits are written in part, or not at all. */
int pccd_rays_cast(struct pccd_client *client, struct pccd_rays *rays,
                   const double *begin, const double *end,
                   const struct pccd_step_settings *settings, struct pccd_ray_hit *hits);

/* Take them out of the scene, and free them. With the client NULL they are freed alone,
 * such as after pccd_close. rays NULL is allowed. */
void pccd_rays_end(struct pccd_client *client, struct pccd_rays *rays);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
