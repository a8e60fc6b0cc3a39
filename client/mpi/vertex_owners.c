/* vertex_owners.c - where vertices were given, and how their positions travel. */
#include "parts.h"

#include <stdlib.h>
#include <string.h>

#include "rank_sort.h"
#include "team.h"

/* The directory of this rank. */
struct directory {
    const struct ranks_mesh *mesh;
    uint32_t base; /* the first vertex in it */
};

static int answer_places(void *context, const void *items, uint64_t count, void *answers)
{
    const struct directory *directory = context;
    const uint32_t *vertices = items;
    struct ranks_vertex_owner *found = answers;
    for (uint64_t i = 0; i < count; i++) {
        found[i] = directory->mesh->owners[vertices[i] - directory->base];
    }
    return PCCD_OK;
}

/* Collective: where each of vertices[count], ascending, was given, to owners[count]. */
static int find_places(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                       const uint32_t *vertices, uint32_t count,
                       struct ranks_vertex_owner *owners)
{
    struct ranks_link *link = &world->link;
    struct directory directory = {mesh, (uint32_t)link->rank * mesh->span};
    const struct ranks_question question = {sizeof *vertices, sizeof *owners,
                                            answer_places, &directory};
    uint64_t *first = calloc((size_t)link->size + 1, sizeof *first);
    int status = ranks_agree_memory(world, first != NULL);
    if (status == PCCD_OK) {
        for (uint32_t i = 0; i < count; i++) {
            first[ranks_directory(mesh, vertices[i]) + 1]++;
        }
        for (int r = 0; r < link->size; r++) {
            first[r + 1] += first[r];
        }
        status = ranks_ask(link, &question, vertices, first, owners);
    }
    free(first);
    return status;
}

/* ---- once ------------------------------------------------------------------------- */

/* Numbers that a rank tells of vertices that it was given. */
struct registered {
    const struct ranks_mesh *mesh;
    uint32_t width; /* numbers of each: a position, and 4 with its radius */
};

static int answer_registered(void *context, const void *items, uint64_t count,
                             void *answers)
{
    const struct registered *of = context;
    const uint32_t *given = items;
    for (uint64_t i = 0; i < count; i++) {
        double *to = (double *)answers + i * of->width;
        memcpy(to, of->mesh->x[given[i]], sizeof *of->mesh->x);
        if (of->width == 4) {
            to[3] = of->mesh->radii[given[i]];
        }
    }
    return PCCD_OK;
}

/* In order of the rank that has them: first[size + 1], index[count], place[count]. */
static void order_by_rank(const struct ranks_vertex_owner *owners, uint32_t count,
                          int size, uint64_t *first, uint32_t *index, uint32_t *place)
{
    memset(first, 0, ((size_t)size + 1) * sizeof *first);
    for (uint32_t i = 0; i < count; i++) {
        first[owners[i].rank]++;
    }
    uint64_t end = 0;
    for (int r = 0; r <= size; r++) {
        end += first[r];
        first[r] = end;
    }
    for (uint32_t i = count; i-- > 0;) {
        uint64_t at = --first[owners[i].rank];
        index[at] = owners[i].index;
        place[at] = i;
    }
}

int ranks_fetch_registered(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                           const uint32_t *vertices, uint32_t count, double (**x)[3],
                           double **radii)
{
    struct ranks_link *link = &world->link;
    bool with_radii = radii != NULL && mesh->has_radii;
    struct registered of = {mesh, with_radii ? 4 : 3};
    const struct ranks_question question = {sizeof(uint32_t), of.width * sizeof(double),
                                            answer_registered, &of};
    struct ranks_vertex_owner *owners = ranks_array(count, sizeof *owners);
    uint64_t *first = ranks_array((uint64_t)link->size + 1, sizeof *first);
    uint32_t *index = ranks_array(2 * (uint64_t)count, sizeof *index);
    double *told = ranks_array(count, question.answer_bytes);
    double(*values)[3] = ranks_array(count, sizeof *values);
    double *some_radii = with_radii ? ranks_array(count, sizeof *some_radii) : NULL;
    int status = ranks_agree_memory(
        world, owners != NULL && first != NULL && index != NULL && told != NULL &&
                   values != NULL && (!with_radii || some_radii != NULL));
    if (status == PCCD_OK) {
        status = find_places(world, mesh, vertices, count, owners);
    }
    if (status == PCCD_OK) {
        order_by_rank(owners, count, link->size, first, index, index + count);
        status = ranks_ask(link, &question, index, first, told);
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        const double *from = told + (size_t)i * of.width;
        const uint32_t place = index[(size_t)count + i];
        memcpy(values[place], from, sizeof *values);
        if (with_radii) {
            some_radii[place] = from[3];
        }
    }
    free(owners);
    free(first);
    free(index);
    free(told);
    if (status != PCCD_OK) {
        free(values);
        free(some_radii);
        return status;
    }
    *x = values;
    if (radii != NULL) {
        *radii = some_radii;
    }
    return PCCD_OK;
}

/* ---- the plan --------------------------------------------------------------------- */

/* A given vertex of an object. */
struct request {
    uint32_t object;
    uint32_t index;
};

/* Count what the local vertices of object o need, in order of (rank, object) over all
 * objects; placing follows. */
static void count_needs(struct ranks_plan *plan, const struct ranks_vertex_owner *owners,
                        uint32_t count, uint32_t o)
{
    for (uint32_t i = 0; i < count; i++) {
        plan->in_first[(uint64_t)owners[i].rank * plan->object_count + o]++;
    }
}

static void place_needs(struct ranks_plan *plan, const struct ranks_vertex_owner *owners,
                        uint32_t count, uint32_t o, struct request *requests)
{
    for (uint32_t i = count; i-- > 0;) {
        uint64_t at = --plan->in_first[(uint64_t)owners[i].rank * plan->object_count + o];
        requests[at] = (struct request){o, owners[i].index};
        plan->in[at] = i;
    }
}

static int find_owners(struct pccd_mpi *world, struct ranks_vertex_owner **owners)
{
    uint64_t at = 0;
    uint64_t total = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        total += world->objects[o]->local.vertex_count;
    }
    *owners = ranks_array(total, sizeof **owners);
    int status = ranks_agree_memory(world, *owners != NULL);
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        status = find_places(world, object->mesh, object->local.vertices,
                             object->local.vertex_count, *owners + at);
        at += object->local.vertex_count;
    }
    return status;
}

static void sum_up(uint64_t *first, uint64_t cells)
{
    uint64_t end = 0;
    for (uint64_t i = 0; i <= cells; i++) {
        end += first[i];
        first[i] = end;
    }
}

/* From which ranks a run comes. */
static void find_runs(const struct ranks_link *link, struct ranks_plan *plan)
{
    for (int r = 0; r < link->size; r++) {
        uint32_t objects = 0;
        plan->is_run[r] = r != link->rank;
        for (uint32_t o = 0; o < plan->object_count; o++) {
            const uint64_t *cell = plan->in_first + (uint64_t)r * plan->object_count + o;
            uint64_t count = cell[1] - cell[0];
            objects += count > 0;
            plan->is_run[r] = plan->is_run[r] && objects <= 1 &&
                              (count == 0 || plan->in[cell[1] - 1] - plan->in[cell[0]] ==
                                                 count - 1); /* they ascend */
        }
    }
}

/* The other side of the plan: what each rank asks of this one. */
static int hear_requests(struct pccd_mpi *world, const struct request *requests,
                         struct ranks_plan *plan)
{
    struct ranks_link *link = &world->link;
    uint32_t objects = plan->object_count;
    uint64_t *first = ranks_array(2 * ((uint64_t)link->size + 1), sizeof *first);
    struct request *asked = NULL;
    int status = ranks_agree_memory(world, first != NULL);
    if (status == PCCD_OK) {
        uint64_t *first_in = first + link->size + 1;
        for (int r = 0; r <= link->size; r++) {
            first[r] = plan->in_first[(uint64_t)r * objects];
        }
        status = ranks_deal(link, sizeof *requests, requests, first, (void **)&asked,
                            first_in);
        if (status == PCCD_OK) {
            uint64_t count = first_in[link->size];
            plan->out = ranks_array(count, sizeof *plan->out);
            status = ranks_agree_memory(world, plan->out != NULL);
        }
        for (int r = 0; r < link->size && status == PCCD_OK; r++) {
            for (uint64_t i = first_in[r]; i < first_in[r + 1]; i++) {
                plan->out[i] = asked[i].index; /* in order of their objects */
                plan->out_first[(uint64_t)r * objects + asked[i].object]++;
            }
        }
    }
    if (status == PCCD_OK) { /* counts to begins */
        uint64_t before = 0;
        for (uint64_t i = 0; i <= (uint64_t)link->size * objects; i++) {
            uint64_t here = plan->out_first[i];
            plan->out_first[i] = before;
            before += here;
        }
    }
    free(first);
    free(asked);
    return status;
}

int ranks_plan_make(struct pccd_mpi *world)
{
    struct ranks_link *link = &world->link;
    struct ranks_plan plan = {.object_count = world->object_count};
    uint64_t cells = (uint64_t)link->size * plan.object_count;
    struct ranks_vertex_owner *owners = NULL;
    struct request *requests = NULL;
    int status = find_owners(world, &owners);
    if (status == PCCD_OK) {
        uint64_t total = 0;
        for (uint32_t o = 0; o < plan.object_count; o++) {
            total += world->objects[o]->local.vertex_count;
        }
        plan.in_first = calloc(cells + 1, sizeof *plan.in_first);
        plan.out_first = calloc(cells + 1, sizeof *plan.out_first);
        plan.in = ranks_array(total, sizeof *plan.in);
        plan.is_run = ranks_array((uint64_t)link->size, sizeof *plan.is_run);
        requests = ranks_array(total, sizeof *requests);
        status = ranks_agree_memory(
            world, plan.in_first != NULL && plan.out_first != NULL && plan.in != NULL &&
                       plan.is_run != NULL && requests != NULL);
    }
    if (status == PCCD_OK) {
        uint64_t at = 0;
        for (uint32_t o = 0; o < plan.object_count; o++) {
            uint32_t count = world->objects[o]->local.vertex_count;
            count_needs(&plan, owners + at, count, o);
            at += count;
        }
        sum_up(plan.in_first, cells);
        for (uint32_t o = plan.object_count; o-- > 0;) {
            uint32_t count = world->objects[o]->local.vertex_count;
            at -= count;
            place_needs(&plan, owners + at, count, o, requests);
        }
        find_runs(link, &plan);
        status = hear_requests(world, requests, &plan);
    }
    free(owners);
    free(requests);
    if (status != PCCD_OK) {
        ranks_plan_deinit(&plan);
        return status;
    }
    ranks_plan_deinit(&world->plan);
    world->plan = plan;
    return PCCD_OK;
}

/* ---- a step ----------------------------------------------------------------------- */

/* Count how many vertices go to, or come from, each other rank: first[size + 1]. */
static void count_sent(const struct ranks_link *link, const uint64_t *cells,
                       const double (*const *given)[3], uint32_t objects, uint64_t *first)
{
    first[0] = 0;
    for (int r = 0; r < link->size; r++) {
        first[r + 1] = first[r];
        for (uint32_t o = 0; o < objects && r != link->rank; o++) {
            const uint64_t *cell = cells + (uint64_t)r * objects + o;
            first[r + 1] += given[o] != NULL ? cell[1] - cell[0] : 0;
        }
    }
}

/* Memory for all that may be on its way, the first time. */
static int make_buffers(struct pccd_mpi *world)
{
    struct ranks_plan *plan = &world->plan;
    const uint64_t objects = plan->object_count;
    uint64_t out = 0, in = 0;
    for (uint64_t r = 0; r < (uint64_t)world->link.size; r++) {
        bool is_other = r != (uint64_t)world->link.rank;
        const uint64_t *goes = plan->out_first + r * objects;
        const uint64_t *comes = plan->in_first + r * objects;
        out += is_other ? goes[objects] - goes[0] : 0;
        in += is_other && !plan->is_run[r] ? comes[objects] - comes[0] : 0;
    }
    if (plan->out_x == NULL) {
        plan->out_x = ranks_array(out, sizeof *plan->out_x);
    }
    if (plan->in_x == NULL) {
        plan->in_x = ranks_array(in, sizeof *plan->in_x);
    }
    return plan->out_x == NULL || plan->in_x == NULL ? ranks_no_memory(world) : PCCD_OK;
}

/* Choose where what each rank sends is received: in[size]; first: of what comes. */
static void choose_places(const struct ranks_link *link, const struct ranks_plan *plan,
                          double (*const *local)[3], const uint64_t *first, void **in)
{
    double(*next)[3] = plan->in_x;
    for (int r = 0; r < link->size; r++) {
        uint64_t count = first[r + 1] - first[r];
        const uint64_t *cell = plan->in_first + (uint64_t)r * plan->object_count;
        uint32_t o = 0;
        if (!plan->is_run[r] || count == 0) {
            in[r] = next;
            next += count;
            continue;
        }
        while (cell[o + 1] == cell[o]) {
            o++;
        }
        in[r] = local[o][plan->in[cell[o]]];
    }
}

/* Pack what other ranks need, one rank after the other: the vertices begin .. end - 1 of
 * all that go. [team] */
static void pack(const struct ranks_link *link, const struct ranks_plan *plan,
                 const double (*const *given)[3], uint64_t begin, uint64_t end)
{
    uint32_t objects = plan->object_count;
    uint64_t at = 0;
    for (uint64_t cell = 0; cell < (uint64_t)link->size * objects && at < end; cell++) {
        const double(*x)[3] = given[cell % objects];
        if (x == NULL || cell / objects == (uint64_t)link->rank) {
            continue;
        }
        const uint32_t *from = plan->out + plan->out_first[cell];
        uint64_t count = plan->out_first[cell + 1] - plan->out_first[cell], i, last;
        (void)ranks_part_of_run(at, count, begin, end, &i, &last);
        for (; i < last; i++) {
            memcpy(plan->out_x[at + i], x[from[i]], sizeof *plan->out_x);
        }
        at += count;
    }
}

/* Unpack what has come from elsewhere, and what this rank has itself, to its place: the
 * vertices begin .. end - 1 of all that are sent. [team] */
static void unpack(const struct ranks_link *link, const struct ranks_plan *plan,
                   const double (*const *given)[3], double (*const *local)[3],
                   uint64_t begin, uint64_t end)
{
    uint32_t objects = plan->object_count;
    const double(*in)[3] = (const double(*)[3])plan->in_x; /* of the cell */
    uint64_t at = 0;
    for (uint64_t cell = 0; cell < (uint64_t)link->size * objects && at < end; cell++) {
        const double(*x)[3] = given[cell % objects];
        double(*to)[3] = local[cell % objects];
        const uint32_t *place = plan->in + plan->in_first[cell];
        const uint32_t *from = plan->out + plan->out_first[cell];
        uint64_t count = plan->in_first[cell + 1] - plan->in_first[cell], i, last;
        if (x == NULL || plan->is_run[cell / objects]) {
            continue;
        }
        bool is_here = cell / objects == (uint64_t)link->rank;
        (void)ranks_part_of_run(at, count, begin, end, &i, &last);
        for (; is_here && i < last; i++) {
            memcpy(to[place[i]], x[from[i]], sizeof *to);
        }
        for (; !is_here && i < last; i++) {
            memcpy(to[place[i]], in[i], sizeof *to);
        }
        in += is_here ? 0 : count;
        at += count;
    }
}

/* The same by the team, all of it. */
static void pack_all(const struct pccd_mpi *world, const double (*const *given)[3],
                     uint64_t count)
{
    const int team = ranks_team(world, count);
#pragma omp parallel for num_threads(team) schedule(static, 1)
    for (int t = 0; t < team; t++) {
        pack(&world->link, &world->plan, given, ranks_part(count, t, team),
             ranks_part(count, t + 1, team));
    }
}

/* Return how many vertices are unpacked. */
static uint64_t count_unpacked(const struct ranks_link *link,
                               const struct ranks_plan *plan,
                               const double (*const *given)[3])
{
    uint64_t count = 0;
    for (uint64_t cell = 0; cell < (uint64_t)link->size * plan->object_count; cell++) {
        bool is_copied = given[cell % plan->object_count] != NULL &&
                         !plan->is_run[cell / plan->object_count];
        count += is_copied ? plan->in_first[cell + 1] - plan->in_first[cell] : 0;
    }
    return count;
}

static void unpack_all(const struct pccd_mpi *world, const double (*const *given)[3],
                       double (*const *local)[3], uint64_t count)
{
    const int team = ranks_team(world, count);
#pragma omp parallel for num_threads(team) schedule(static, 1)
    for (int t = 0; t < team; t++) {
        unpack(&world->link, &world->plan, given, local, ranks_part(count, t, team),
               ranks_part(count, t + 1, team));
    }
}

int ranks_plan_send(struct pccd_mpi *world, const double (*const *given)[3],
                    double (*const *local)[3])
{
    struct ranks_link *link = &world->link;
    struct ranks_plan *plan = &world->plan;
    uint32_t objects = plan->object_count;
    bool any = false;
    for (uint32_t o = 0; o < objects; o++) {
        any = any || given[o] != NULL;
    }
    if (!any) {
        return PCCD_OK;
    }
    uint64_t *first = ranks_array(2 * ((uint64_t)link->size + 1), sizeof *first);
    void **in = ranks_array((uint64_t)link->size, sizeof *in);
    int status =
        first == NULL || in == NULL ? ranks_no_memory(world) : make_buffers(world);
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        uint64_t *first_in = first + link->size + 1;
        count_sent(link, plan->out_first, given, objects, first);
        count_sent(link, plan->in_first, given, objects, first_in);
        pack_all(world, given, first[link->size]);
        choose_places(link, plan, local, first_in, in);
        status =
            ranks_swap_into(link, sizeof *plan->out_x, plan->out_x, first, in, first_in);
    }
    if (status == PCCD_OK) {
        unpack_all(world, given, local, count_unpacked(link, plan, given));
    }
    free(first);
    free((void *)in);
    return status;
}

void ranks_positions_free(const struct pccd_mpi *world, double (**x)[3])
{
    for (uint32_t o = 0; o < world->object_count && x != NULL; o++) {
        free(x[o]);
    }
    free((void *)x);
}

int ranks_positions_fetch(struct pccd_mpi *world, enum ranks_when when, double (***x)[3])
{
    uint32_t objects = world->object_count;
    const double(**given)[3] = calloc((size_t)objects + 1, sizeof *given);
    double(**local)[3] = calloc((size_t)objects + 1, sizeof *local);
    bool has_memory = given != NULL && local != NULL;
    for (uint32_t o = 0; o < objects && has_memory; o++) {
        const struct ranks_object *object = world->objects[o];
        given[o] = when == RANKS_BEGIN ? object->from
                   : when == RANKS_END ? object->to
                                       : (const double(*)[3])object->x;
        local[o] = ranks_array(object->local.vertex_count, sizeof **local);
        has_memory = local[o] != NULL;
    }
    int status = ranks_agree_memory(world, has_memory);
    if (status == PCCD_OK) {
        status = ranks_plan_send(world, given, local);
    }
    free((void *)given);
    *x = local;
    return status;
}
