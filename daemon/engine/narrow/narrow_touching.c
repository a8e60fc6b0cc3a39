/* narrow_touching.c - tells what becomes of what touches at t = 0, or is within r then.
 *
 * Of features within r that do not touch, the distance *just after* t = 0 tells: it falls
 * (enters), stays (slides) or rises (leaves). Of those that touch, the surfaces around
 * the two features are looked at just after t = 0 (touching.h):
 *
 *   enters  an edge of the one surface passes through a face of the other; or nothing
 *           tells the sides of the two apart (below)
 *   slides  the features go on touching, and a plane there keeps the surfaces around them
 *           on its two sides, or in it
 *   leaves  the features have parted, and no edge passes through a face
 *
 * Two faces that lie in each other at t = 0 do not show which is on which side. They
 * leave where their fronts face each other and they part to the front; a free edge or a
 * point in a plane of what it touches has no front: it enters.
 *
 * Source: elementary/BOUNDS.md, "Features that touch".
 */
#include <assert.h>
#include <string.h>

#include "narrow.h"
#include "solve.h"
#include "thick.h"
#include "topology.h"

/* Ends of edges around a vertex that are known not to come twice. */
#define SEEN_MAX 48u

/* The part of its first distance at which what began within r and did not approach is a
 * contact again: it has come nearer than it began. */
#define NEARER (1 - 0x1p-20)

/* Leaves around a vertex from one look at the clock to the next: some 100 us. */
#define LEAVES_A_LOOK 32u

/* A vertex, where it is. */
struct corner {
    uint32_t v;
    struct eng_point point; /* its words are not set */
};

/* One side of a pair. */
struct part {
    const struct eng_object *object;
    struct corner corner[3];
};

/* A pair while its surroundings are looked at. */
struct look {
    struct eng_worker *worker;
    struct eng_touching *touching;
    uint32_t leaves; /* looked at */
    bool has_stopped;
    bool is_near; /* within r, and does not touch */
    bool enters;
    bool is_ambiguous;       /* sides that nothing tells apart */
    bool above[2], below[2]; /* edges: the faces at either are beside the plane of both */
};

static struct corner corner_of(const struct look *look, const struct eng_object *object,
                               uint32_t v)
{
    const struct eng_scene *scene = look->worker->scene;
    struct corner corner = {.v = v};
    uint32_t at = object->vertices.first + v;
    memcpy(corner.point.x0, scene->x[1 - scene->now][at], sizeof corner.point.x0);
    memcpy(corner.point.x1, scene->x[scene->now][at], sizeof corner.point.x1);
    return corner;
}

/* Return whether the look goes on. */
static bool goes_on(struct look *look)
{
    if (++look->leaves % LEAVES_A_LOOK == 0) {
        look->has_stopped = look->has_stopped || eng_worker_should_stop(look->worker);
    }
    return !look->has_stopped && !look->enters;
}

/* ---- faces that lie in each other -------------------------------------------------- */

static bool normal_of(struct look *look, const struct eng_point *const f[3],
                      struct eng_axis *normal)
{
    const struct eng_point *const sides[2][2] = {{f[0], f[1]}, {f[0], f[2]}};
    return eng_touching_normal(look->touching, sides[0], sides[1], normal);
}

static bool lies_in_plane(struct look *look, const struct eng_point *const f[3],
                          const struct eng_point *const g[3])
{
    bool lies = true;
    for (int i = 0; i < 3 && lies; i++) {
        lies = eng_touching_side(look->touching, f, g[i]).now == 0;
    }
    return lies;
}

/* Return whether two faces, neither a line, are in one plane and in each other at t = 0;
 * the normals are set then. */
static bool lie_in_each_other(struct look *look, const struct eng_point *const f[3],
                              const struct eng_point *const g[3], struct eng_axis *nf,
                              struct eng_axis *ng)
{
    return normal_of(look, f, nf) && normal_of(look, g, ng) &&
           lies_in_plane(look, f, g) &&
           eng_touching_overlaps(look->touching, f, g, nf, ng);
}

/* ---- a vertex on a face ------------------------------------------------------------ */

/* The edge from the vertex to `end`, which may be a corner of f: then it passes through
 * nothing, and lies in the plane. */
static void look_at_edge(struct look *look, const struct corner *vertex, int side,
                         const struct eng_point *const f[3], const struct corner *end,
                         bool is_free)
{
    const struct eng_point *const edge[2] = {&vertex->point, &end->point};
    struct eng_signs sign = eng_touching_side(look->touching, f, &end->point);
    look->enters = look->enters || eng_touching_passes(look->touching, edge, f,
                                                       (const int[2]){side, sign.next});
    look->is_ambiguous = look->is_ambiguous || (is_free && sign.now == 0);
}

static bool is_seen(uint32_t *seen, uint32_t *count, uint32_t v)
{
    for (uint32_t i = 0; i < *count; i++) {
        if (seen[i] == v) {
            return true;
        }
    }
    if (*count < SEEN_MAX) {
        seen[(*count)++] = v;
    }
    return false;
}

/* The leaves around the vertex; `side`: where that is just after. */
static void look_around_vertex(struct look *look, const struct part *a,
                               const struct eng_point *const f[3], int side)
{
    const struct eng_mesh *mesh = a->object->mesh;
    const struct corner *vertex = &a->corner[0];
    uint32_t seen[SEEN_MAX];
    uint32_t seen_count = 0;
    uint64_t count;
    const uint32_t *leaves = eng_stars_of(mesh, vertex->v, &count);
    for (uint64_t i = 0; i < count && goes_on(look); i++) {
        const struct eng_face *leaf = &mesh->leaves[leaves[i]];
        bool is_face = (leaf->owns & ENG_OWNS_FACE) != 0;
        struct corner corner[3];
        struct eng_axis nf;
        struct eng_axis ng;
        bool is_point = !is_face && leaf->v[0] == leaf->v[1];
        look->is_ambiguous = look->is_ambiguous || is_point;
        for (int k = 0; k < 3; k++) {
            uint32_t v = leaf->v[k];
            corner[k] = corner_of(look, a->object, v);
            if (v != vertex->v && !is_seen(seen, &seen_count, v)) {
                look_at_edge(look, vertex, side, f, &corner[k], !is_face);
            }
        }
        const struct eng_point *const g[3] = {&corner[0].point, &corner[1].point,
                                              &corner[2].point};
        if (is_face && !look->is_ambiguous && lie_in_each_other(look, f, g, &nf, &ng)) {
            look->is_ambiguous = nf.sign == ng.sign || side < 0;
        }
        if (is_face && !look->is_ambiguous && !normal_of(look, g, &ng)) {
            look->is_ambiguous = lies_in_plane(look, f, g); /* it may open to any side */
        }
    }
}

/* Leaves around a place of an object: those at v[0]; of two vertices, those at both. */
struct around {
    const struct eng_object *object;
    uint32_t v[2];
    uint32_t vertices; /* 0: there is but the face that is known */
};

/* Face planes that are tried, around either place: of more, what slides may enter. */
#define PLANES_MAX 64u

/* Leaf i around the place, its corners to corner[3]. False: it is not one, or there are
 * no more (*ends). */
static bool leaf_around(const struct look *look, const struct around *around, uint64_t i,
                        struct corner corner[3], bool *is_face, bool *ends)
{
    uint64_t count;
    const struct eng_mesh *mesh = around->object->mesh;
    const uint32_t *leaves = eng_stars_of(mesh, around->v[0], &count);
    *ends = around->vertices == 0 || i >= count;
    if (*ends) {
        return false;
    }
    const struct eng_face *leaf = &mesh->leaves[leaves[i]];
    const uint32_t *v = leaf->v;
    const uint32_t other = around->v[1];
    *is_face = (leaf->owns & ENG_OWNS_FACE) != 0;
    if (around->vertices == 2 && v[0] != other && v[1] != other && v[2] != other) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        corner[k] = corner_of(look, around->object, v[k]);
    }
    return true;
}

/* Note on which sides of a plane the leaves around a place are. */
static void add_sides(struct look *look, const struct around *around,
                      const struct eng_point *const plane[3], bool sides[2])
{
    bool ends = false;
    for (uint64_t i = 0; !ends && goes_on(look); i++) {
        struct corner corner[3];
        bool is_face;
        if (!leaf_around(look, around, i, corner, &is_face, &ends)) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            int next = eng_touching_side(look->touching, plane, &corner[k].point).next;
            sides[0] = sides[0] || next < 0;
            sides[1] = sides[1] || next > 0;
        }
    }
}

/* Return whether the plane has the leaves around each place on a side of its own. */
static bool plane_separates(struct look *look, const struct around around[2],
                            const struct eng_point *const plane[3])
{
    bool sides[2][2] = {{false, false}, {false, false}};
    add_sides(look, &around[0], plane, sides[0]);
    if (sides[0][0] && sides[0][1]) {
        return false;
    }
    add_sides(look, &around[1], plane, sides[1]);
    return (!sides[0][0] && !sides[1][1]) || (!sides[0][1] && !sides[1][0]);
}

/* Return whether the plane of f, or of a face around either place, separates what is
 * around them. Inside of f there is f alone. */
static bool are_separated(struct look *look, const struct around around[2],
                          const struct eng_point *const f[3])
{
    bool is = plane_separates(look, around, f);
    for (uint32_t which = 0; which < 2 && around[1].vertices > 0; which++) {
        bool ends = false;
        for (uint64_t i = 0; i < PLANES_MAX && !is && !ends && goes_on(look); i++) {
            struct corner corner[3];
            struct eng_axis normal;
            bool is_face;
            if (leaf_around(look, &around[which], i, corner, &is_face, &ends) &&
                is_face) {
                const struct eng_point *const plane[3] = {
                    &corner[0].point, &corner[1].point, &corner[2].point};
                is = normal_of(look, plane, &normal) &&
                     plane_separates(look, around, plane);
            }
        }
    }
    return is;
}

/* Return whether a vertex that goes on touching the face slides on it. */
static bool slides_on(struct look *look, const struct part *a, const struct part *b,
                      const struct eng_point *const f[3], const bool on_side[3])
{
    struct around around[2] = {
        {.object = a->object, .v = {a->corner[0].v}, .vertices = 1},
        {.object = b->object}};
    for (uint32_t k = 0; k < 3; k++) {
        if (on_side[k]) {
            around[1].v[0] = b->corner[k].v;
            around[1].v[1] = b->corner[(k + 1) % 3].v;
            around[1].vertices = 2;
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        if (on_side[k] && on_side[(k + 2) % 3]) {
            around[1].v[0] = b->corner[k].v;
            around[1].vertices = 1;
        }
    }
    return are_separated(look, around, f);
}

static uint32_t judge_vf(struct look *look, const struct part *a, const struct part *b)
{
    const struct eng_point *const f[3] = {&b->corner[0].point, &b->corner[1].point,
                                          &b->corner[2].point};
    const struct eng_point *const points[4] = {&a->corner[0].point, f[0], f[1], f[2]};
    struct eng_axis normal;
    if (!normal_of(look, f, &normal)) {
        return PCCD_ENTERS; /* a face that is a line has no sides */
    }
    int side = eng_touching_side(look->touching, f, points[0]).next;
    look_around_vertex(look, a, f, side);
    if (look->enters) {
        return PCCD_ENTERS;
    }
    bool on_side[3];
    if (side == 0 && eng_touching_vf(look->touching, points, on_side)) {
        return slides_on(look, a, b, f, on_side) ? PCCD_SLIDES : PCCD_ENTERS;
    }
    return look->is_ambiguous ? PCCD_ENTERS : PCCD_LEAVES;
}

/* ---- two edges --------------------------------------------------------------------- */

/* The faces at an edge, one after the other. */
struct faces {
    const struct part *edge;
    const uint32_t *leaves;
    uint64_t count;
    uint64_t next;
    struct corner third; /* of the face at hand; the others are those of the edge */
    const struct eng_point *f[3]; /* its corners, as it goes round them */
};

static struct faces faces_at(const struct part *edge)
{
    struct faces faces = {.edge = edge};
    faces.leaves = eng_stars_of(edge->object->mesh, edge->corner[0].v, &faces.count);
    return faces;
}

/* Go to the next one. False: there is none, or the look ends. */
static bool next_face(struct look *look, struct faces *faces)
{
    const struct part *edge = faces->edge;
    const struct eng_mesh *mesh = edge->object->mesh;
    while (faces->next < faces->count && goes_on(look)) {
        const struct eng_face *leaf = &mesh->leaves[faces->leaves[faces->next++]];
        uint32_t others = 0;
        bool has_end = false;
        for (int k = 0; k < 3; k++) {
            uint32_t v = leaf->v[k];
            has_end = has_end || v == edge->corner[1].v;
            if (v == edge->corner[0].v) {
                faces->f[k] = &edge->corner[0].point;
            } else if (v == edge->corner[1].v) {
                faces->f[k] = &edge->corner[1].point;
            } else {
                faces->third = corner_of(look, edge->object, v);
                faces->f[k] = &faces->third.point;
                others++;
            }
        }
        if (has_end && others == 1 && (leaf->owns & ENG_OWNS_FACE) != 0) {
            return true;
        }
    }
    return false;
}

/* The two edges of a pair, and what was found at each. */
struct edges {
    const struct part *part[2];
    const struct eng_point *ends[2][2];
    uint32_t faces[2]; /* at it; 0: it is free */
    bool has_front[2]; /* one of these is no line at t = 0 .. */
    bool is_flat[2];   /* .. and the other edge lies in the plane of such a one then */
};

/* Look at the faces at edge `which` beside the other one. */
static void look_at_faces(struct look *look, struct edges *edges, uint32_t which)
{
    const struct part *edge = edges->part[which];
    const struct eng_point *const *ends = edges->ends[1 - which];
    struct faces faces = faces_at(edge);
    while (next_face(look, &faces)) {
        const struct eng_signs side[2] = {
            eng_touching_side(look->touching, faces.f, ends[0]),
            eng_touching_side(look->touching, faces.f, ends[1])};
        int beside = eng_touching_along(look->touching, edges->ends[0], edges->ends[1],
                                        edges->ends[which][0], &faces.third.point)
                         .next;
        struct eng_axis normal;
        bool has_front = normal_of(look, faces.f, &normal);
        edges->faces[which]++;
        edges->has_front[which] = edges->has_front[which] || has_front;
        edges->is_flat[which] =
            edges->is_flat[which] || (has_front && side[0].now == 0 && side[1].now == 0);
        look->above[which] = look->above[which] || beside > 0;
        look->below[which] = look->below[which] || beside < 0;
        look->enters = eng_touching_passes(look->touching, ends, faces.f,
                                           (const int[2]){side[0].next, side[1].next});
    }
}

/* Return whether faces f at edge a and g at edge b that lie in each other part to the
 * fronts; `gap`: where b is just after, seen from a along the edges' common normal. */
static bool part_to_front(struct look *look, const struct edges *edges,
                          const struct eng_point *const f[3],
                          const struct eng_point *const g[3], const struct eng_axis *ng,
                          int gap)
{
    struct eng_axis common;
    if (eng_touching_normal(look->touching, edges->ends[0], edges->ends[1], &common)) {
        return gap * common.sign * ng->sign <= 0;
    }
    for (uint32_t i = 0; i < 2; i++) {
        if (eng_touching_side(look->touching, g, edges->ends[0][i]).next < 0 ||
            eng_touching_side(look->touching, f, edges->ends[1][i]).next < 0) {
            return false;
        }
    }
    return true;
}

/* Look for faces at both edges that lie in each other. */
static void look_for_sides(struct look *look, const struct edges *edges, int gap)
{
    struct faces at_a = faces_at(edges->part[0]);
    if ((!edges->has_front[0] && (!edges->has_front[1] || edges->is_flat[1])) ||
        (!edges->has_front[1] && edges->is_flat[0])) {
        look->is_ambiguous = true;
        return;
    }
    while (!look->is_ambiguous && next_face(look, &at_a)) {
        struct faces at_b = faces_at(edges->part[1]);
        while (!look->is_ambiguous && next_face(look, &at_b)) {
            struct eng_axis nf;
            struct eng_axis ng;
            look->is_ambiguous = lie_in_each_other(look, at_a.f, at_b.f, &nf, &ng) &&
                                 (nf.sign == ng.sign ||
                                  !part_to_front(look, edges, at_a.f, at_b.f, &ng, gap));
        }
    }
}

static bool is_a_point(const struct eng_point *const ends[2])
{
    return ends[0]->x0[0] == ends[1]->x0[0] && ends[0]->x0[1] == ends[1]->x0[1] &&
           ends[0]->x0[2] == ends[1]->x0[2];
}

static uint32_t judge_ee(struct look *look, const struct part *a, const struct part *b)
{
    struct edges edges = {.part = {a, b},
                          .ends = {{&a->corner[0].point, &a->corner[1].point},
                                   {&b->corner[0].point, &b->corner[1].point}}};
    const struct eng_point *const points[4] = {edges.ends[0][0], edges.ends[0][1],
                                               edges.ends[1][0], edges.ends[1][1]};
    if (is_a_point(edges.ends[0]) || is_a_point(edges.ends[1])) {
        return PCCD_ENTERS; /* an edge that is a point has no sides */
    }
    look_at_faces(look, &edges, 0);
    look_at_faces(look, &edges, 1);
    int gap = eng_touching_along(look->touching, edges.ends[0], edges.ends[1], points[0],
                                 points[2])
                  .next;
    if (look->enters) {
        return PCCD_ENTERS;
    }
    switch (gap == 0 ? eng_touching_ee(look->touching, points) : ENG_TOUCH_NOT) {
    case ENG_TOUCH_INSIDE: {
        bool is_apart =
            (!look->below[0] && !look->above[1]) || (!look->above[0] && !look->below[1]);
        return is_apart ? PCCD_SLIDES : PCCD_ENTERS;
    }
    case ENG_TOUCH_ENDS:
        /* The end is a vertex on the faces of the other edge: those pairs tell. */
        return (edges.faces[0] == 0) == (edges.faces[1] == 0) ? PCCD_SLIDES : PCCD_ENTERS;
    case ENG_TOUCH_NOT:
        break;
    }
    look_for_sides(look, &edges, gap);
    return look->is_ambiguous ? PCCD_ENTERS : PCCD_LEAVES;
}

/* ---- pairs ------------------------------------------------------------------------- */

static struct part part_of(const struct look *look, const struct eng_pairs *pairs,
                           const uint32_t *quad, uint32_t count)
{
    struct part part = {
        .object = &look->worker->scene->objects[pairs->points[quad[0]].word0 >> 32]};
    for (uint32_t i = 0; i < count; i++) {
        uint32_t v = (uint32_t)pairs->points[quad[i]].word1;
        part.corner[i] = corner_of(look, part.object, v);
    }
    return part;
}

static struct eng_thick_query query_of(const struct eng_pairs *pairs, uint32_t number)
{
    struct eng_thick_query query = {.query.kind = (enum pccd_kind)pairs->kind,
                                    .approach = NEARER};
    for (int i = 0; i < 4; i++) {
        const struct eng_point *point = &pairs->points[pairs->quads[number][i]];
        memcpy(query.query.x[0][i], point->x0, sizeof query.query.x[0][i]);
        memcpy(query.query.x[1][i], point->x1, sizeof query.query.x[1][i]);
    }
    if (pairs->radius) {
        memcpy(query.radius, pairs->radius[number], sizeof query.radius);
    }
    return query;
}

/* Find when a pair that touches at t = 0 does so next. */
static enum eng_again touches_again(struct eng_worker *worker,
                                    const struct eng_query *query, struct eng_hit *hit)
{
    struct eng_batch *batch = &worker->narrow->batch;
    struct eng_exact_interrupt *interrupt = &worker->exact.span.interrupt;
    *interrupt = (struct eng_exact_interrupt){.should_stop = batch->should_stop,
                                              .owner = batch->owner};
    enum eng_again again = eng_search_again(query, batch->tolerance, &worker->exact, hit);
    bool has_stopped = interrupt->has_stopped;
    *interrupt = (struct eng_exact_interrupt){0};
    return has_stopped ? ENG_AGAIN_NEVER : again;
}

/* Find when a pair that does not enter is a contact after all. False: it is none. */
static bool meets_again(const struct look *look, const struct eng_pairs *pairs,
                        const struct eng_thick_query *query, uint32_t flag,
                        struct eng_hit *hit)
{
    const struct eng_question *question = pairs->question;
    struct eng_batch *batch = &look->worker->narrow->batch;
    struct eng_hit next;
    enum eng_again again =
        !look->is_near ? touches_again(look->worker, &query->query, &next)
        : eng_thick_solve(batch->thick, batch->contacts, query, batch->tolerance,
                          batch->t_end, &next)
            ? ENG_AGAIN_MEETS
            : ENG_AGAIN_NEVER;
    if (again == ENG_AGAIN_NEVER) {
        return false;
    }
    if (again == ENG_AGAIN_UNKNOWN) {
        hit->flags |= flag; /* as it is: at t = 0 */
        return true;
    }
    if (next.toi > batch->t_end) {
        return false;
    }
    *hit = next;
    hit->flags |= flag;
    if (eng_asks_part(question)) {
        hit->toi = eng_part_toi(question, hit->toi);
        hit->toi_hi = eng_part_toi_hi(question, hit->toi_hi);
    }
    return true;
}

static uint32_t judge_surfaces(struct look *look, const struct eng_pairs *pairs,
                               const uint32_t *quad)
{
    if (pairs->kind != PCCD_VF && pairs->kind != PCCD_EE) {
        return PCCD_ENTERS; /* points and edges have no sides */
    }
    const uint32_t points_a = pairs->kind == PCCD_VF ? 1 : 2;
    const struct part a = part_of(look, pairs, quad, points_a);
    const struct part b = part_of(look, pairs, quad + points_a, 4 - points_a);
    return pairs->kind == PCCD_VF ? judge_vf(look, &a, &b) : judge_ee(look, &a, &b);
}

/* Return whether the pair, which touches at t = 0 or is within r, is kept. */
static bool judge(struct look *look, const struct eng_pairs *pairs, uint32_t number,
                  struct eng_hit *hit)
{
    struct eng_worker *worker = look->worker;
    const struct eng_thick_query query = query_of(pairs, number);
    uint32_t flag;
    bool touches = true;
    int trend = 0;
    if (pairs->radius) {
        trend =
            eng_thick_exact_trend(&worker->narrow->batch.thick->exact, &query, &touches);
    }
    look->is_near = !touches;
    if (touches) {
        flag = judge_surfaces(look, pairs, pairs->quads[number]);
    } else {
        flag = trend < 0 ? PCCD_ENTERS : trend == 0 ? PCCD_SLIDES : PCCD_LEAVES;
    }
    if (look->has_stopped) {
        return true;
    }
    worker->tally.touching[flag == PCCD_ENTERS ? 0 : flag == PCCD_SLIDES ? 1 : 2]++;
    if (flag == PCCD_ENTERS || pairs->question->touching == PCCD_TOUCHING_TOLD) {
        hit->flags |= flag;
        return true;
    }
    return meets_again(look, pairs, &query, flag, hit);
}

void eng_narrow_touching(struct eng_worker *worker, const struct eng_pairs *pairs)
{
    struct eng_batch *batch = &worker->narrow->batch;
    uint32_t kept = 0;
    assert(worker->narrow->touching);
    for (uint32_t i = 0; i < batch->found; i++) {
        struct look look = {.worker = worker, .touching = worker->narrow->touching};
        bool stays = (batch->hits[i].flags & PCCD_INITIAL) == 0 ||
                     judge(&look, pairs, batch->index[i], &batch->hits[i]);
        if (stays) {
            batch->index[kept] = batch->index[i];
            batch->hits[kept++] = batch->hits[i];
        }
        if ((batch->hits[i].flags & PCCD_INITIAL) != 0 &&
            eng_worker_should_stop(worker)) {
            batch->found = i + 1; /* the rest is left out: the answer says so */
        }
    }
    batch->found = kept;
}
