/* viewpoint.c - from where a contact can be seen.
 *
 * Source: Moeller and Trumbore 1997.
 */
#include "picture.h"

#include <math.h>
#include <string.h>

#define TURNS 16u  /* directions around the normal */
#define NEAR  1e-3 /* of the contact's radius: what it lies on is not in front of it */
#define STEEP 0.3  /* what a steeper view costs, beside how far it is turned away */

/* Sines of angles to the plane in which the surfaces touch. */
static const double tilts[] = {0.3, -0.3, 0.8, -0.8};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* False for a vector without length. */
static bool normalize(double x[3])
{
    double length = sqrt(dot(x, x));
    for (int k = 0; k < 3; k++) {
        x[k] /= length > 0 ? length : 1;
    }
    return length > 0;
}

/* Whether the ray meets the triangle farther than `near` away. */
static bool meets(const double at[3], const double way[3], double near,
                  const float (*x)[3], const uint32_t v[3])
{
    double a[3], b[3], from[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)x[v[1]][k] - (double)x[v[0]][k];
        b[k] = (double)x[v[2]][k] - (double)x[v[0]][k];
        from[k] = at[k] - (double)x[v[0]][k];
    }
    cross(way, b, p);
    double area = dot(a, p);
    if (area == 0) {
        return false;
    }
    cross(from, a, q);
    double u = dot(from, p) / area, w = dot(way, q) / area;
    return u >= 0 && w >= 0 && u + w <= 1 && dot(b, q) / area > near;
}

static bool is_free(const struct still *still, const double at[3], const double way[3],
                    double near)
{
    for (uint32_t o = 0; o < still->object_count; o++) {
        const struct still_object *object = &still->objects[o];
        for (uint32_t i = 0; i < object->triangle_count; i++) {
            if (meets(at, way, near, (const float(*)[3])object->x,
                      object->triangles[i])) {
                return false;
            }
        }
    }
    return true;
}

void viewpoint_choose(const struct still *still, float from[3])
{
    const struct still_contact *contact = &still->contacts[still->chosen];
    const double wanted[3] = {from[0], from[1], from[2]};
    double at[3], normal[3], side[3], other[3], least = INFINITY;
    for (int k = 0; k < 3; k++) {
        at[k] = contact->at[k];
        normal[k] = contact->normal[k];
    }
    if (!normalize(normal)) {
        return;
    }
    cross(normal, wanted, side);
    if (!normalize(side)) { /* seen along the normal: any side will do */
        const double axes[2][3] = {{1, 0, 0}, {0, 1, 0}};
        cross(normal, axes[fabs(normal[0]) > 0.9], side);
        normalize(side);
    }
    cross(side, normal, other); /* of the plane, towards the eye that is wanted */
    for (uint32_t i = 0; i < TURNS * sizeof tilts / sizeof tilts[0]; i++) {
        double tilt = tilts[i / TURNS], flat = sqrt(1 - tilt * tilt);
        double turn = 2 * M_PI * (i % TURNS) / TURNS;
        double way[3];
        for (int k = 0; k < 3; k++) {
            way[k] =
                flat * (cos(turn) * other[k] + sin(turn) * side[k]) + tilt * normal[k];
        }
        double cost = 1 - dot(way, wanted) + STEEP * fabs(tilt);
        if (cost < least && is_free(still, at, way, NEAR * (double)contact->radius)) {
            least = cost;
            for (int k = 0; k < 3; k++) {
                from[k] = (float)way[k];
            }
        }
    }
}
