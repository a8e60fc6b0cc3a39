/* verify_touching.c - whether an answer says rightly what becomes of features that touch
 * at t = 0, and leaves out no more than what does not enter.
 */
#include "verify.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_touching.h"
#include "registry.h"

#define FATES    (PCCD_ENTERS | PCCD_SLIDES | PCCD_LEAVES)
#define BITS_MAX 500 /* of oracle_touching.h */

/* Leaves that have a vertex of a feature, as an oracle takes them. */
struct around {
    struct oracle_surface surface;
    uint32_t (*leaves)[3]; /* ours: surface.leaves */
    uint32_t room;
    int low, high; /* exponents: of the lowest bit and the highest, of all coordinates */
    bool is_whole; /* there was memory */
};

static bool has(const uint32_t *v, uint32_t count, uint32_t vertex)
{
    bool is_there = false;
    for (uint32_t i = 0; i < count; i++) {
        is_there = is_there || v[i] == vertex;
    }
    return is_there;
}

static void note_bits(struct around *around, const double x[3])
{
    for (int k = 0; k < 3; k++) {
        int exponent;
        (void)frexp(x[k], &exponent);
        if (x[k] != 0) {
            around->high = exponent > around->high ? exponent : around->high;
            around->low = exponent - 53 < around->low ? exponent - 53 : around->low;
        }
    }
}

static void add_leaf(struct around *around, uint32_t a, uint32_t b, uint32_t c)
{
    struct oracle_surface *surface = &around->surface;
    const uint32_t leaf[3] = {a, b, c};
    if (surface->leaf_count == around->room) {
        uint32_t room = around->room > 0 ? 2 * around->room : 16;
        uint32_t(*leaves)[3] = realloc(around->leaves, room * sizeof *leaves);
        around->is_whole = around->is_whole && leaves != NULL;
        if (leaves == NULL) {
            return;
        }
        around->leaves = leaves;
        around->room = room;
    }
    for (int k = 0; k < 3; k++) {
        around->leaves[surface->leaf_count][k] = leaf[k];
        note_bits(around, surface->x[0][leaf[k]]);
        note_bits(around, surface->x[1][leaf[k]]);
    }
    surface->leaf_count++;
}

/* Find the faces, the free edges and the free points that have a vertex of v[count]. */
static void look_around(struct around *around, const struct registry_object *object,
                        const uint32_t *v, uint32_t count)
{
    const struct registry_mesh *mesh = object->mesh;
    *around = (struct around){.low = INT32_MAX, .high = INT32_MIN, .is_whole = true};
    around->surface.x[0] = (const double(*)[3])object->x0;
    around->surface.x[1] = (const double(*)[3])object->x1;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = mesh->triangles[i];
        if (has(v, count, t[0]) || has(v, count, t[1]) || has(v, count, t[2])) {
            add_leaf(around, t[0], t[1], t[2]);
        }
    }
    around->surface.face_count = around->surface.leaf_count;
    for (uint32_t i = 0; i < mesh->edge_count; i++) {
        const uint32_t *e = mesh->edges[i];
        if ((has(v, count, e[0]) || has(v, count, e[1])) &&
            recorded_is_free(mesh, 2, i)) {
            add_leaf(around, e[0], e[1], e[1]);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        if (recorded_is_free(mesh, 1, v[i])) {
            add_leaf(around, v[i], v[i], v[i]);
        }
    }
    around->surface.leaves = (const uint32_t(*)[3])around->leaves;
}

/* Return the flag of what becomes of a pair that touches at t = 0; 0: it cannot be told
 * here. `soon`: the time at which that was looked at. */
static uint32_t fate_of(const struct play_step *step, const struct pccd_pair *pair,
                        mpq_t soon)
{
    static const uint32_t flags[] = {[ORACLE_ENTERS] = PCCD_ENTERS,
                                     [ORACLE_SLIDES] = PCCD_SLIDES,
                                     [ORACLE_LEAVES] = PCCD_LEAVES};
    const uint32_t *points = common_kinds[pair->kind].points;
    const uint32_t handles[2] = {pair->object_a, pair->object_b};
    const uint32_t features[2] = {pair->feature_a, pair->feature_b};
    struct around around[2];
    uint32_t all[4], flag = 0, count = 0;
    if (pair->kind != PCCD_VF && pair->kind != PCCD_EE) {
        return PCCD_ENTERS;
    }
    for (int side = 0; side < 2; side++) {
        const struct registry_object *object =
            registry_object(step->scene, handles[side]);
        const uint32_t *v = recorded_feature(object->mesh, points[side], &features[side]);
        look_around(&around[side], object, v, points[side]);
        for (uint32_t i = 0; i < points[side]; i++) {
            all[count++] = v[i];
        }
    }
    int low = around[0].low < around[1].low ? around[0].low : around[1].low;
    int high = around[0].high > around[1].high ? around[0].high : around[1].high;
    if (around[0].is_whole && around[1].is_whole &&
        (low > high || high - low <= BITS_MAX)) {
        const struct oracle_surface *a = &around[0].surface, *b = &around[1].surface;
        flag = flags[oracle_touching_fate(a, b, (int)points[0], all)];
        oracle_touching_soon(a, b, (int)points[0], all, soon);
    }
    free(around[0].leaves);
    free(around[1].leaves);
    return flag;
}

static bool leave(struct verify_result *result)
{
    return verify_leave(result, "what becomes of a pair that touches is not checked: "
                                "coordinates there have too many bits, or no memory");
}

/* Set q to the motion of one point, p[i], and of two others, as oracle.h has edges. */
static void set_event(const double p[8][3], int i, int j, int k, double q[8][3])
{
    const int of[4] = {i, i, j, k};
    for (int end = 0; end < 8; end += 4) {
        for (int n = 0; n < 4; n++) {
            memcpy(q[end + n], p[end + of[n]], sizeof q[0]);
        }
    }
}

/* Return whether p[i] is on the line through p[j] and p[k] all the time: at three times,
 * of a polynomial of degree 2. */
static bool is_always_on_line(const double p[8][3], int i, int j, int k)
{
    mpq_t to_j[3], to_k[3], x, y;
    bool is = true;
    mpq_inits(x, y, NULL);
    for (int axis = 0; axis < 3; axis++) {
        mpq_inits(to_j[axis], to_k[axis], NULL);
    }
    for (int when = 0; when < 3; when++) { /* 0, 1, and the sum of both: twice 1/2 */
        for (int axis = 0; axis < 3; axis++) {
            mpq_set_ui(to_j[axis], 0, 1);
            mpq_set_ui(to_k[axis], 0, 1);
            for (int end = 0; end < 2; end++) {
                if (when != 1 - end) {
                    const double(*at)[3] = p + 4 * end;
                    mpq_set_d(x, at[i][axis]);
                    mpq_set_d(y, at[j][axis]);
                    mpq_sub(y, x, y);
                    mpq_add(to_j[axis], to_j[axis], y);
                    mpq_set_d(y, at[k][axis]);
                    mpq_sub(y, x, y);
                    mpq_add(to_k[axis], to_k[axis], y);
                }
            }
        }
        for (int axis = 0; axis < 3; axis++) {
            mpq_mul(x, to_j[axis], to_k[(axis + 1) % 3]);
            mpq_mul(y, to_j[(axis + 1) % 3], to_k[axis]);
            is = is && mpq_equal(x, y) != 0;
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        mpq_clears(to_j[axis], to_k[axis], NULL);
    }
    mpq_clears(x, y, NULL);
    return is;
}

static bool is_one_point(const double p[8][3], int i, int j)
{
    return memcmp(p[i], p[j], sizeof p[i]) == 0 &&
           memcmp(p[4 + i], p[4 + j], sizeof p[i]) == 0;
}

/* Return whether p[i] comes to the edge from p[j] to p[k] at a time from lo to hi; along
 * its line, to an end of it. */
static bool comes_to_edge(const double p[8][3], const int of[3], mpq_t lo, mpq_t hi)
{
    const int i = of[0], j = of[1], k = of[2];
    double q[8][3];
    set_event(p, i, j, k, q);
    if (!is_always_on_line(p, i, j, k)) {
        return oracle_contact_in(ORACLE_EE, (const double(*)[3])q, lo, hi);
    }
    bool comes = false;
    for (int n = 1; n < 3 && !comes && !is_one_point(p, i, j) && !is_one_point(p, i, k);
         n++) {
        set_event(p, i, of[n], of[n], q);
        comes = oracle_contact_in(ORACLE_EE, (const double(*)[3])q, lo, hi);
    }
    return comes;
}

/* Return whether a pair that touched at t = 0 meets again at a time from lo to hi. One
 * that slides is in one plane, and does so where a point comes to an edge. */
static bool meets_again(const struct pccd_pair *pair, const double p[8][3], bool slides,
                        mpq_t lo, mpq_t hi)
{
    static const int vf[3][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
    static const int ee[4][3] = {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}};
    bool is_vf = pair->kind == PCCD_VF, meets = false;
    if (!slides) {
        return oracle_contact_in(is_vf ? ORACLE_VF : ORACLE_EE, p, lo, hi);
    }
    for (int i = 0; i < (is_vf ? 3 : 4) && !meets; i++) {
        meets = comes_to_edge(p, is_vf ? vf[i] : ee[i], lo, hi);
    }
    return meets;
}

/* Return whether it does so before `until`, by more than 2^-60. */
static bool meets_before(const struct pccd_pair *pair, const double p[8][3], bool slides,
                         mpq_t soon, double until)
{
    mpq_t end, less;
    mpq_inits(end, less, NULL);
    mpq_set_d(end, until);
    mpq_set_d(less, 0x1p-60);
    if (until < 1) {
        mpq_sub(end, end, less);
    }
    bool meets = mpq_cmp(soon, end) < 0 && meets_again(pair, p, slides, soon, end);
    mpq_clears(end, less, NULL);
    return meets;
}

/* Return whether the pair of a contact meets again within its times, and not before. */
static bool meets_then(const struct pccd_contact *contact, const struct pccd_pair *pair,
                       const struct verify_meeting *meeting, mpq_t soon)
{
    const double(*p)[3] = (const double(*)[3])meeting->p;
    bool slides = (contact->flags & PCCD_SLIDES) != 0;
    mpq_t lo, hi;
    mpq_inits(lo, hi, NULL);
    mpq_set_d(lo, contact->toi);
    mpq_set_d(hi, contact->toi_hi);
    bool meets = meets_again(pair, p, slides, lo, hi) &&
                 !meets_before(pair, p, slides, soon, contact->toi);
    mpq_clears(lo, hi, NULL);
    return meets;
}

const char *verify_touching(const struct play_step *step,
                            const struct pccd_contact *contact,
                            const struct pccd_pair *pair,
                            const struct verify_meeting *meeting,
                            struct verify_result *result)
{
    const uint32_t told = contact->flags & FATES;
    const bool is_initial = (contact->flags & PCCD_INITIAL) != 0;
    const bool is_left_out = step->frame->touching == PCCD_TOUCHING_LEFT_OUT;
    const bool is_told =
        meeting->fate != 0 ||
        (meeting->touches && step->frame->touching != PCCD_TOUCHING_KEPT);
    if (is_told != (told != 0) || (told & (told - 1)) != 0) {
        return "what becomes of what touches is not told, or told unasked, or twice";
    }
    if (!is_told) {
        return NULL;
    }
    mpq_t soon;
    mpq_init(soon);
    const char *what = NULL;
    uint32_t flag = meeting->fate != 0 ? meeting->fate : fate_of(step, pair, soon);
    if (flag == 0) {
        (void)leave(result);
    } else if (flag != told) {
        what = "features that touch at t = 0, or are within their distance, enter, slide "
               "or leave otherwise than is told";
    } else if (meeting->touches && !is_initial && (!is_left_out || told == PCCD_ENTERS)) {
        what = "a contact that is there at t = 0 is at another time";
    } else if (meeting->touches && !is_initial &&
               !meets_then(contact, pair, meeting, soon)) {
        what = "a pair that touched at t = 0 does not meet again then, or did before";
    }
    mpq_clear(soon);
    return what;
}

bool verify_is_left_out(const struct play_step *step, const struct pccd_pair *pair,
                        const struct verify_meeting *meeting, double until,
                        struct verify_result *result)
{
    if (!meeting->touches || step->frame->touching != PCCD_TOUCHING_LEFT_OUT) {
        return false;
    }
    mpq_t soon;
    mpq_init(soon);
    uint32_t flag = fate_of(step, pair, soon);
    bool is = flag == 0 ? leave(result)
                        : flag != PCCD_ENTERS &&
                              !meets_before(pair, (const double(*)[3])meeting->p,
                                            flag == PCCD_SLIDES, soon, until);
    mpq_clear(soon);
    return is;
}
