/* verify_touching.c - whether an answer says rightly what becomes of features that touch
 * at t = 0, and leaves out no more than what does not enter.
 */
#include "verify.h"

#include <math.h>
#include <stdlib.h>

#include "kinds.h"
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

/* Return whether the pair of a contact meets within its times. */
static bool meets_then(const struct pccd_contact *contact,
                       const struct verify_meeting *meeting)
{
    mpq_t lo, hi;
    mpq_inits(lo, hi, NULL);
    mpq_set_d(lo, contact->toi);
    mpq_set_d(hi, contact->toi_hi);
    bool meets = oracle_contact_in((enum oracle_kind)contact->kind,
                                   (const double(*)[3])meeting->p, lo, hi);
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
    const bool is_left_out = step->touching == PCCD_TOUCHING_LEFT_OUT;
    const bool is_told = meeting->touches && step->touching != PCCD_TOUCHING_KEPT;
    if (is_told != (told != 0) || (told & (told - 1)) != 0) {
        return "what becomes of what touches is not told, or told unasked, or twice";
    }
    if (!is_told) {
        return NULL;
    }
    mpq_t soon;
    mpq_init(soon);
    uint32_t flag = fate_of(step, pair, soon);
    mpq_clear(soon);
    if (flag == 0) {
        (void)leave(result);
    } else if (flag != told) {
        return "features that touch at t = 0 enter, slide or leave otherwise than is "
               "told";
    }
    if (!is_initial && (!is_left_out || told == PCCD_ENTERS)) {
        return "a contact that is there at t = 0 is at another time";
    }
    return is_initial || meets_then(contact, meeting)
               ? NULL
               : "a pair that has parted does not meet again then";
}

bool verify_is_left_out(const struct play_step *step, const struct pccd_pair *pair,
                        const struct verify_meeting *meeting,
                        struct verify_result *result)
{
    if (!meeting->touches || step->touching != PCCD_TOUCHING_LEFT_OUT) {
        return false;
    }
    mpq_t soon, end;
    mpq_inits(soon, end, NULL);
    mpq_set_ui(end, 1, 1);
    uint32_t flag = fate_of(step, pair, soon);
    /* What slides goes on to touch: whether it should be told again is not checked. */
    bool is = flag == 0
                  ? leave(result)
                  : flag == PCCD_SLIDES ||
                        (flag == PCCD_LEAVES &&
                         !oracle_contact_in((enum oracle_kind)pair->kind,
                                            (const double(*)[3])meeting->p, soon, end));
    mpq_clears(soon, end, NULL);
    return is;
}
