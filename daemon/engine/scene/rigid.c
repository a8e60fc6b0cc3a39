/* rigid.c - objects that poses keep from meeting themselves.
 *
 * Bound from below how much the object shrinks between two poses, and from above by how
 * much its vertices are off. Every margin is derived in elementary/BOUNDS.md, "Objects
 * that move by poses".
 */
#include "rigid.h"

#include <assert.h>

#include "query.h"
#include "thickness.h"

/* ---- two poses --------------------------------------------------------------------- */

/* All that rounding adds to a bound of an eigenvalue, as a part of the sum of the squares
 * of both matrices. */
#define SHRINK_MARGIN (256 * ENG_U)

/* The margin below a guess at an eigenvalue, which is proved or dropped: so far below, it
 * can be proved even where two eigenvalues are equal. */
#define GUESS_MARGIN 0x1p-20

/* Its third power is far above the least number. */
#define SIZE_MIN 0x1p-300

#define PI 3.14159265358979323846

/* A matrix is that of a pose: three rows of three factors, and a shift each. */
static double product(const double *m, const double *n, int i, int j)
{
    return m[i] * n[j] + m[4 + i] * n[4 + j] + m[8 + i] * n[8 + j];
}

/* A symmetric matrix. */
struct symmetric {
    double at[3][3];
};

/* By Gershgorin: no eigenvalue is below that, but for rounding. */
static double below_eigenvalues(const struct symmetric *s)
{
    double below = INFINITY;
    for (int i = 0; i < 3; i++) {
        double others = fabs(s->at[i][(i + 1) % 3]) + fabs(s->at[i][(i + 2) % 3]);
        below = fmin(below, s->at[i][i] - others);
    }
    return below;
}

static double trace(const struct symmetric *s)
{
    return s->at[0][0] + s->at[1][1] + s->at[2][2];
}

/* The sum of the determinants of two of its rows and columns. */
static double minors(const struct symmetric *s)
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        sum += s->at[i][i] * s->at[j][j] - s->at[i][j] * s->at[i][j];
    }
    return sum;
}

static double determinant(const struct symmetric *s)
{
    double sum = 0;
    for (int j = 0; j < 3; j++) {
        int k = (j + 1) % 3;
        int l = (j + 2) % 3;
        sum += s->at[0][j] * (s->at[1][k] * s->at[2][l] - s->at[1][l] * s->at[2][k]);
    }
    return sum;
}

/* s less a multiple of the identity. */
static struct symmetric less(const struct symmetric *s, double multiple)
{
    struct symmetric rest = *s;
    for (int i = 0; i < 3; i++) {
        rest.at[i][i] -= multiple;
    }
    return rest;
}

/* The largest magnitude of an entry. */
static double size_of(const struct symmetric *s)
{
    double size = 0;
    for (int i = 0; i < 9; i++) {
        size = fmax(size, fabs(s->at[i / 3][i % 3]));
    }
    return size;
}

/* Return whether all eigenvalues are greater than 0. They are where all coefficients of
 * the characteristic polynomial have the signs that they then have. */
static bool is_positive(const struct symmetric *s)
{
    double size = size_of(s);
    return size > SIZE_MIN && trace(s) > 8 * ENG_U * size &&
           minors(s) > 64 * ENG_U * size * size &&
           determinant(s) > 64 * ENG_U * size * size * size;
}

/* About the least eigenvalue: the least root of the characteristic polynomial, which has
 * three, by the cosine of a third of an angle. */
static double about_least(const struct symmetric *s)
{
    double mean = trace(s) / 3;
    struct symmetric rest = less(s, mean);
    double spread = sqrt(fmax(-minors(&rest) / 3, 0));
    double cosine = determinant(&rest) / (2 * spread * spread * spread);
    cosine = fmax(fmin(cosine, 1), -1); /* also where the spread is 0 */
    return mean + 2 * spread * cos((acos(cosine) + 2 * PI) / 3);
}

/* Not above the least eigenvalue of transposed(m) n + transposed(n) m, but for rounding.
 * The quick bound is enough for turns by some degrees a step. */
static double least_eigenvalue(const double *m, const double *n)
{
    struct symmetric s;
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) {
            s.at[i][j] = product(m, n, i, j) + product(n, m, i, j);
            s.at[j][i] = s.at[i][j];
        }
    }
    double below = below_eigenvalues(&s);
    if (below > trace(&s) / 6) {
        return below;
    }
    double guess = about_least(&s) - GUESS_MARGIN * size_of(&s);
    struct symmetric rest = less(&s, guess);
    return guess > below && is_positive(&rest) ? guess : below;
}

double eng_pose_shrink(const double m0[12], const double m1[12])
{
    double squares = 0;
    for (int i = 0; i < 3; i++) {
        squares += product(m0, m0, i, i) + product(m1, m1, i, i);
    }
    double ends = fmin(least_eigenvalue(m0, m0), least_eigenvalue(m1, m1)) / 2;
    double both = least_eigenvalue(m0, m1);
    double least = both >= 2 * ends ? ends : (2 * ends + both) / 4;
    least -= SHRINK_MARGIN * squares + ENG_TINY;
    return least > 0 ? sqrt(least) * (1 - 4 * ENG_U) : 0;
}

double eng_rounding_error(const double m[12], const struct eng_bounds *bounds)
{
    assert(bounds->low[0] <= bounds->high[0]);
    double error = 0;
    for (int row = 0; row < 3; row++) {
        const double *r = m + 4 * row;
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            sum += fabs(r[k]) * fmax(fabs(bounds->low[k]), fabs(bounds->high[k]));
        }
        error += 5 * ENG_U * sum + 2 * ENG_U * fabs(r[3]);
    }
    return error + ENG_TINY;
}

double eng_rounding_reach(const double m0[12], const double m1[12],
                          const struct eng_bounds *bounds)
{
    double error = fmax(eng_rounding_error(m0, bounds), eng_rounding_error(m1, bounds));
    double shrink = eng_pose_shrink(m0, m1);
    return shrink > 0 ? 2 * error / shrink * (1 + 0x1p-20) : INFINITY;
}

/* ---- objects ----------------------------------------------------------------------- */

/* Return whether it is to be looked whether its clearance is known by now. Of most
 * objects nothing but these fields is read: what stands costs little. */
static bool may_find_clearance(const struct eng_object *object)
{
    return object->mesh && object->clearance == 0 && (object->is_posed || object->is_new);
}

void eng_rigid_prepare(struct eng_scene *scene)
{
    struct eng_rigid *rigid = &scene->rigid;
    rigid->is_possible = false;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_object *object = &scene->objects[i];
        if (may_find_clearance(object)) {
            object->clearance = eng_mesh_clearance(object->mesh);
            object->has_crowded =
                object->clearance > 0 && object->mesh->clearance.crowded_count > 0;
            rigid->version += object->clearance > 0;
        }
        rigid->is_possible |= object->mesh && object->clearance > 0;
    }
}

void eng_rigid_choose(struct eng_scene *scene, bool may_leave_out)
{
    struct eng_rigid *rigid = &scene->rigid;
    rigid->objects = 0;
    rigid->leaves = 0;
    rigid->apart = 0;
    rigid->wanted = ENG_NO_OBJECT;
    for (uint32_t i = scene->object_capacity; i-- > 0;) {
        const struct eng_object *object = &scene->objects[i];
        bool is_wanted = object->mesh && may_leave_out && scene->masks.entries[i].self &&
                         !eng_thickness_is_within(scene, object);
        enum eng_self self = ENG_SELF_TESTED;
        if (object->mesh && may_leave_out && object->joint != PCCD_NO_JOINT) {
            self = ENG_SELF_APART; /* nor does what turns meet itself */
            rigid->apart++;
        } else if (is_wanted && object->clearance > object->rounding_reach[0]) {
            self = object->has_crowded ? ENG_SELF_CROWDED : ENG_SELF_EXEMPT;
            rigid->objects++;
            rigid->leaves += object->mesh->leaf_count;
        } else if (is_wanted && object->is_posed && object->clearance == 0 &&
                   !eng_mesh_knows_clearance(object->mesh)) {
            rigid->wanted = i;
        }
        eng_masks_leave_out(&scene->masks, i, self);
    }
}

bool eng_rigid_is_settled(const struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (may_find_clearance(object) && eng_mesh_clearance(object->mesh) > 0) {
            return false;
        }
    }
    return scene->rigid.wanted == ENG_NO_OBJECT;
}
