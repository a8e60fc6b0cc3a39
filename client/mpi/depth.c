/* depth.c - how deep the vertices of closed meshes are in others.
 *
 * Find out whether meshes are closed; send the faces that a ray from any vertex may pass
 * through, and edges, and then those that may be nearest to a vertex inside, to the rank
 * that has it.
 *
 * How often a surface winds around a vertex is a sum over its faces. Only those add to it
 * that a ray along +x passes through. So the rank that owns a vertex needs those alone,
 * wherever the other faces are.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "near_objects.h"
#include "rank_sort.h"

/* ---- closed meshes ----------------------------------------------------------------- */

/* A face runs through an edge. */
struct run {
    uint32_t edge;
    uint32_t vertex[2]; /* from, to */
};

/* The runs of own faces, by the rank that counts an edge. */
static void list_runs(const struct ranks_object *object, int size, struct run *runs,
                      uint64_t *first)
{
    uint64_t count = 0;
    for (int r = 0; r < size; r++) {
        first[r] = count;
        for (uint32_t i = 0; i < 3 * object->own_count; i++) {
            const struct ranks_leaf *leaf = &object->own[i / 3];
            uint32_t edge = leaf->side[i % 3];
            if (edge != RANKS_NONE && (int)(edge % (uint32_t)size) == r) {
                runs[count++] =
                    (struct run){edge, {leaf->v[i % 3], leaf->v[(i + 1) % 3]}};
            }
        }
    }
    first[size] = count;
}

static int compare_runs(const void *a, const void *b)
{
    const struct run *one = a, *other = b;
    return one->edge < other->edge ? -1 : one->edge > other->edge;
}

/* The first edge here that is not run through equally often: open[] are its ends, the
 * lower first, and how often from that and back. RANKS_NONE: there is none. */
static uint32_t find_open(struct run *runs, uint64_t count, uint64_t open[4])
{
    if (count > 1) {
        qsort(runs, count, sizeof *runs, compare_runs);
    }
    for (uint64_t begin = 0, end; begin < count; begin = end) {
        uint64_t up = 0;
        const uint32_t *v = runs[begin].vertex;
        for (end = begin; end < count && runs[end].edge == runs[begin].edge; end++) {
            up += runs[end].vertex[0] < runs[end].vertex[1];
        }
        if (2 * up != end - begin) {
            open[0] = v[0] < v[1] ? v[0] : v[1];
            open[1] = v[0] < v[1] ? v[1] : v[0];
            open[2] = up;
            open[3] = end - begin - up;
            return runs[begin].edge;
        }
    }
    return RANKS_NONE;
}

/* Collective: mesh->closed, by the leaves of an object of that mesh. */
static int find_out(struct pccd_mpi *world, const struct ranks_object *object)
{
    struct ranks_link *link = &world->link;
    uint64_t open[4] = {0};
    uint64_t *first = ranks_array(2 * ((uint64_t)link->size + 1), sizeof *first);
    struct run *out = ranks_array(3 * (uint64_t)object->own_count, sizeof *out);
    struct run *in = NULL;
    double least = RANKS_NONE;
    int status = ranks_agree_on(
        link, first == NULL || out == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        list_runs(object, link->size, out, first);
        status = ranks_deal(link, sizeof *out, out, first, (void **)&in,
                            first + link->size + 1);
    }
    if (status == PCCD_OK) {
        uint32_t mine = find_open(in, first[2 * link->size + 1], open);
        least = mine;
        status = ranks_min_doubles(link, &least, 1);
        for (int i = 0; i < 4; i++) {
            open[i] = (double)mine > least ? 0 : open[i];
        }
    }
    if (status == PCCD_OK) { /* one rank knows of that edge */
        status = ranks_sum(link, open, 4);
    }
    if (status == PCCD_OK) {
        struct ranks_mesh *mesh = object->mesh;
        mesh->closed = least < RANKS_NONE ? RANKS_OPEN_MESH : RANKS_CLOSED_MESH;
        for (int i = 0; i < 4; i++) {
            mesh->open[i] = (uint32_t)open[i];
        }
    }
    free(first);
    free(out);
    free(in);
    return status;
}

/* Collective. Of several meshes that are open, that of the lowest handle is named. */
static int check_closed(const struct ranks_pairing *pairing)
{
    struct pccd_mpi *world = pairing->world;
    const struct ranks_object *wrong = NULL;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        if (!ranks_is_asked_with_any(pairing, o)) {
            continue;
        }
        if (object->mesh->closed == RANKS_MESH_NOT_KNOWN) {
            status = find_out(world, object);
        }
        if (object->mesh->closed == RANKS_OPEN_MESH &&
            (wrong == NULL || object->handle < wrong->handle)) {
            wrong = object;
        }
    }
    if (status != PCCD_OK || wrong == NULL) {
        return status;
    }
    const uint32_t *open = wrong->mesh->open;
    return ranks_fail(&world->link, PCCD_E_INVAL,
                      "the mesh of object 0x%" PRIx32 " is not closed: %" PRIu32
                      " of its faces run along the edge from vertex %" PRIu32
                      " to %" PRIu32 ", and %" PRIu32 " back",
                      wrong->handle, open[2], open[0], open[1], open[3]);
}

/* ---- who needs which faces --------------------------------------------------------- */

/* A box of a rank: faces of the object that meet it are needed there. */
struct need {
    double low[3], high[3];
    uint32_t object;
};

static bool meets(const struct need *need, const double low[3], const double high[3])
{
    return low[0] <= need->high[0] && low[1] <= need->high[1] &&
           low[2] <= need->high[2] && need->low[0] <= high[0] &&
           need->low[1] <= high[1] && need->low[2] <= high[2];
}

/* Does any of needs[count] want the leaf? */
static bool is_needed(const struct need *needs, uint64_t count,
                      const struct ranks_visitor *leaf)
{
    double low[3], high[3];
    ranks_leaf_bounds(leaf, low, high);
    for (uint64_t i = 0; i < count; i++) {
        if (needs[i].object == leaf->object && meets(&needs[i], low, high)) {
            return true;
        }
    }
    return false;
}

/* What the two questions share. */
struct search {
    const struct ranks_pairing *pairing;
    struct ranks_spot *spots;
    uint32_t spot_count;
    double (*boxes)[6]; /* of all objects: low, and high with the other sign */
    struct ranks_visitor *leaves;
    uint64_t leaf_count;
};

/* Own leaves that go to a rank: counts, or with out != NULL writes them. near[] is
 * scratch for as many needs. */
static uint64_t choose_for(const struct search *search, const struct need *needs,
                           uint64_t need_count, struct need *near,
                           struct ranks_visitor *out)
{
    const struct ranks_spot *spots = search->spots;
    uint64_t count = 0;
    for (uint32_t s = 0; s < search->spot_count; s++) {
        uint64_t near_count = 0;
        for (uint64_t i = 0; i < need_count; i++) {
            if (needs[i].object == spots[s].object &&
                meets(&needs[i], spots[s].low, spots[s].high)) {
                near[near_count++] = needs[i];
            }
        }
        for (uint32_t k = 0; k < spots[s].count && near_count > 0; k++) {
            struct ranks_visitor leaf;
            ranks_visitor_make(search->pairing, spots[s].object, spots[s].begin + k,
                               &leaf);
            leaf.is_ghost = true;
            if (is_needed(near, near_count, &leaf)) {
                if (out != NULL) {
                    out[count] = leaf;
                }
                count++;
            }
        }
    }
    return count;
}

/* Two lists, one behind the other, in *to. */
static int append(struct pccd_mpi *world, struct ranks_visitor **to, uint64_t *count,
                  const struct ranks_visitor *more, uint64_t more_count)
{
    struct ranks_visitor *all = realloc(*to, (*count + more_count + 1) * sizeof **to);
    if (all == NULL) {
        return ranks_no_memory(world);
    }
    memcpy(all + *count, more, more_count * sizeof *more);
    *to = all;
    *count += more_count;
    return PCCD_OK;
}

/* The leaves that go to each rank, to *out; first[size + 1]. */
static int choose(const struct search *search, const struct need *needs,
                  const uint64_t *first_need, struct ranks_visitor **out, uint64_t *first)
{
    struct pccd_mpi *world = search->pairing->world;
    int size = world->link.size;
    struct need *near = ranks_array(first_need[size], sizeof *near);
    for (int pass = 0; pass < 2 && near != NULL; pass++) {
        uint64_t count = 0;
        for (int r = 0; r < size; r++) {
            first[r] = count;
            count += choose_for(search, needs + first_need[r],
                                first_need[r + 1] - first_need[r], near,
                                *out != NULL ? *out + count : NULL);
        }
        first[size] = count;
        if (pass == 0) {
            *out = ranks_array(count, sizeof **out);
        }
        if (*out == NULL) {
            break;
        }
    }
    free(near);
    return *out == NULL ? ranks_no_memory(world) : PCCD_OK;
}

/* Collective: own leaves that meet what other ranks need, and what meets what this one
 * needs; it is behind the leaves of the search, and does not belong to this rank. */
static int exchange(struct search *search, const struct need *needs, uint64_t need_count)
{
    struct pccd_mpi *world = search->pairing->world;
    struct ranks_link *link = &world->link;
    uint64_t cells = (uint64_t)link->size + 1;
    uint64_t *first = ranks_array(3 * cells, sizeof *first);
    struct need *all = NULL;
    struct ranks_visitor *out = NULL, *came = NULL;
    int status = ranks_agree_on(link, first == NULL ? ranks_no_memory(world) : PCCD_OK);
    if (status == PCCD_OK) {
        status =
            ranks_spread(link, sizeof *needs, needs, need_count, (void **)&all, first);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(link, choose(search, all, first, &out, first + cells));
    }
    if (status == PCCD_OK) {
        status = ranks_deal(link, sizeof *out, out, first + cells, (void **)&came,
                            first + 2 * cells);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(link, append(world, &search->leaves, &search->leaf_count,
                                             came, first[3 * cells - 1]));
    }
    free(first);
    free(all);
    free(out);
    free(came);
    return status;
}

/* ---- the first question: who is inside --------------------------------------------- */

/* Collective: boxes of all objects. */
static int bound_objects(const struct search *search)
{
    struct pccd_mpi *world = search->pairing->world;
    const struct ranks_spot *spots = search->spots;
    double(*boxes)[6] = search->boxes;
    for (uint32_t o = 0; o < world->object_count; o++) {
        for (int k = 0; k < 6; k++) {
            boxes[o][k] = INFINITY;
        }
    }
    for (uint32_t s = 0; s < search->spot_count; s++) {
        double *box = boxes[spots[s].object];
        for (int k = 0; k < 3; k++) {
            box[k] = fmin(box[k], spots[s].low[k]);
            box[k + 3] = fmin(box[k + 3], -spots[s].high[k]);
        }
    }
    return ranks_min_doubles(&world->link, boxes[0], (int)(6 * world->object_count));
}

/* Own spots that may have a vertex inside another object, or an edge through a face: what
 * is needed of that object is what a ray from the spot meets. Their own leaves go to
 * those of the search. */
static int need_rays(struct search *search, struct need **needs, uint64_t *need_count)
{
    const struct ranks_pairing *pairing = search->pairing;
    double(*boxes)[6] = search->boxes;
    uint32_t objects = pairing->world->object_count;
    for (uint32_t s = 0; s < search->spot_count; s++) {
        const struct ranks_spot *spot = &search->spots[s];
        struct need *more = realloc(*needs, (*need_count + objects + 1) * sizeof **needs);
        struct ranks_visitor *room = realloc(
            search->leaves, (search->leaf_count + spot->count + 1) * sizeof *room);
        *needs = more != NULL ? more : *needs;
        search->leaves = room != NULL ? room : search->leaves;
        if (more == NULL || room == NULL) {
            return ranks_no_memory(pairing->world);
        }
        uint64_t before = *need_count;
        for (uint32_t b = 0; b < objects; b++) {
            struct need ray = {.object = b};
            double high[3] = {-boxes[b][3], -boxes[b][4], -boxes[b][5]};
            memcpy(ray.low, spot->low, sizeof ray.low);
            memcpy(ray.high, spot->high, sizeof ray.high);
            if (meets(&ray, boxes[b], high) && ranks_is_asked(pairing, spot->object, b)) {
                ray.high[0] = INFINITY;
                (*needs)[(*need_count)++] = ray;
            }
        }
        uint32_t asked = *need_count > before ? spot->count : 0;
        for (uint32_t k = 0; k < asked; k++) {
            ranks_visitor_make(pairing, spot->object, spot->begin + k,
                               &search->leaves[search->leaf_count++]);
        }
    }
    return PCCD_OK;
}

/* ---- the second one: how deep ------------------------------------------------------ */

#define RECORDS_OF_NEED 16u

/* What may be as near to vertices inside as the face that is known, some of them at a
 * time. */
static int need_balls(struct pccd_mpi *world, const struct ranks_apart *inside,
                      struct need **needs, uint64_t *count)
{
    *needs = ranks_array(inside->count, sizeof **needs);
    *count = 0;
    if (*needs == NULL) {
        return ranks_no_memory(world);
    }
    const struct pccd_near *last = NULL;
    for (uint64_t i = 0, of_need = 0; i < inside->count; i++, of_need++) {
        const struct pccd_near *record = &inside->records[i];
        double x[3];
        ranks_apart_vertex(world, inside, record->object_a, record->feature_a, x);
        if (last == NULL || of_need == RECORDS_OF_NEED ||
            last->object_a != record->object_a || last->object_b != record->object_b) {
            struct need *need = &(*needs)[(*count)++];
            need->object = ranks_place_of_object(world, record->object_b);
            for (int k = 0; k < 3; k++) {
                need->low[k] = INFINITY;
                need->high[k] = -INFINITY;
            }
            of_need = 0;
        }
        struct need *need = &(*needs)[*count - 1];
        for (int k = 0; k < 3; k++) { /* rounded by less than the next double */
            need->low[k] = fmin(need->low[k], nextafter(x[k] - record->d_hi, -INFINITY));
            need->high[k] = fmax(need->high[k], nextafter(x[k] + record->d_hi, INFINITY));
        }
        last = record;
    }
    return PCCD_OK;
}

/* Collective: all faces that may be the nearest to a vertex inside are among the leaves
 * now; *any: there are such on any rank. */
static int add_balls(struct search *search, const struct ranks_apart *inside, bool *any)
{
    struct pccd_mpi *world = search->pairing->world;
    struct need *needs = NULL;
    uint64_t count = 0;
    uint8_t has_any = inside->count > 0;
    int status = ranks_agree_on(&world->link, need_balls(world, inside, &needs, &count));
    if (status == PCCD_OK) {
        status = ranks_max_bytes(&world->link, &has_any, 1);
    }
    *any = has_any;
    if (status == PCCD_OK && has_any) {
        status = exchange(search, needs, count);
    }
    free(needs);
    return status;
}

/* ---- all of it --------------------------------------------------------------------- */

static int begin(struct search *search)
{
    struct pccd_mpi *world = search->pairing->world;
    search->boxes = ranks_array(world->object_count, sizeof *search->boxes);
    int status = search->boxes == NULL ? ranks_no_memory(world)
                                       : ranks_spots_make(search->pairing, &search->spots,
                                                          &search->spot_count);
    status = ranks_agree_on(&world->link, status);
    return status == PCCD_OK ? bound_objects(search) : status;
}

/* Collective: the own leaves that matter, and all that the first question needs. */
static int gather_rays(struct search *search)
{
    struct pccd_mpi *world = search->pairing->world;
    struct need *needs = NULL;
    uint64_t count = 0;
    int status = ranks_agree_on(&world->link, need_rays(search, &needs, &count));
    if (status == PCCD_OK) {
        status = exchange(search, needs, count);
    }
    free(needs);
    return status;
}

/* A vertex outside of another object's box is not inside of that, and nobody has sent all
 * faces that its ray meets. */
static void drop_outside(const struct search *search, struct ranks_apart *apart)
{
    const struct pccd_mpi *world = search->pairing->world;
    uint64_t kept = 0;
    for (uint64_t i = 0; i < apart->count; i++) {
        const struct pccd_near *record = &apart->records[i];
        const double *box = search->boxes[ranks_place_of_object(world, record->object_b)];
        double x[3];
        bool is_within = true;
        ranks_apart_vertex(world, apart, record->object_a, record->feature_a, x);
        for (int k = 0; k < 3; k++) {
            is_within = is_within && x[k] >= box[k] && x[k] <= -box[k + 3];
        }
        if (is_within) {
            apart->records[kept++] = *record;
        }
    }
    apart->count = kept;
}

static int ask(const struct search *search, struct ranks_apart *apart)
{
    struct pccd_near_settings near;
    ranks_ask_rest(search->pairing, &near);
    int status = ranks_apart_ask(search->pairing->world, search->leaves,
                                 search->leaf_count, &near, apart);
    if (status == PCCD_OK) {
        drop_outside(search, apart);
    }
    return status;
}

/* Is anything known to be around a vertex? */
static bool is_inside(const struct ranks_apart *inside, uint32_t handle, uint32_t vertex)
{
    uint64_t from = 0, end = inside->count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        const struct pccd_near *record = &inside->records[middle];
        if (record->object_a < handle ||
            (record->object_a == handle && record->feature_a < vertex)) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from < inside->count && inside->records[from].object_a == handle &&
           inside->records[from].feature_a == vertex;
}

/* The second question is about vertices that are inside; edges have been counted. */
static void leave_out_answered(struct search *search, const struct ranks_apart *inside)
{
    uint64_t kept = 0;
    for (uint64_t i = 0; i < search->leaf_count; i++) {
        struct ranks_visitor leaf = search->leaves[i];
        uint32_t handle = search->pairing->world->objects[leaf.object]->handle;
        uint32_t owns = 0;
        for (uint32_t k = 0; k < 3 && !leaf.is_ghost; k++) {
            uint32_t bit = leaf.leaf.owns & RANKS_OWNS_CORNER(k);
            owns |= bit != 0 && is_inside(inside, handle, leaf.leaf.v[k]) ? bit : 0;
        }
        leaf.leaf.owns = owns;
        if (leaf.is_ghost || owns != 0) {
            search->leaves[kept++] = leaf;
        }
    }
    search->leaf_count = kept;
}

int ranks_depth(const struct ranks_pairing *pairing, struct ranks_apart *apart)
{
    struct pccd_mpi *world = pairing->world;
    struct search search = {.pairing = pairing};
    struct ranks_apart inside = {.count = 0};
    bool any = false;
    int status = ranks_agree_on(&world->link, check_closed(pairing));
    if (status == PCCD_OK) {
        status = begin(&search);
    }
    if (status == PCCD_OK) {
        status = gather_rays(&search);
    }
    if (status == PCCD_OK) {
        status = ask(&search, &inside);
    }
    if (status == PCCD_OK) {
        status = add_balls(&search, &inside, &any);
    }
    if (status == PCCD_OK && any) {
        leave_out_answered(&search, &inside);
        status = ask(&search, apart);
        if (status == PCCD_OK) {
            ranks_apart_add(apart, &inside);
            apart->answer.crossings = inside.answer.crossings;
        }
    } else if (status == PCCD_OK) {
        *apart = inside;
        inside = (struct ranks_apart){.count = 0};
    }
    ranks_apart_deinit(world, &inside);
    free(search.spots);
    free(search.boxes);
    free(search.leaves);
    return status;
}
