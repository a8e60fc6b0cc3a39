/* judge.c - a scene of the engine, and what an independent observer knows about it. */
#include "judge.h"

#include "cases.h"

typedef const double (*points_t)[3];

static struct oracle_object view(const struct judge_object *object)
{
    return (struct oracle_object){.object_id = object->object_id,
                                  .vertex_count = object->mesh.vertex_count,
                                  .triangle_count = object->mesh.triangle_count,
                                  .x0 = (points_t)object->mesh.x0,
                                  .x1 = (points_t)object->mesh.x1,
                                  .triangles =
                                      (const uint32_t(*)[3])object->mesh.triangles};
}

static const struct judge_object *object_of(const struct judge *judge, uint32_t object_id)
{
    for (uint32_t i = 0; i < judge->object_count; i++) {
        if (judge->objects[i].object_id == object_id) {
            return &judge->objects[i];
        }
    }
    return NULL;
}

/* Return whether the record names features that there are. */
static bool has_features(const struct judge *judge, const struct pccd_contact *contact)
{
    const struct judge_object *a = object_of(judge, contact->object_a);
    const struct judge_object *b = object_of(judge, contact->object_b);
    bool is_vf = contact->kind == PCCD_VF;
    return a && b && (is_vf || contact->kind == PCCD_EE) &&
           contact->feature_a < (is_vf ? a->mesh.vertex_count : a->edge_count) &&
           contact->feature_b < (is_vf ? b->mesh.triangle_count : b->edge_count);
}

static void load_points(const struct judge *judge, const struct pccd_contact *contact,
                        double p[8][3])
{
    const struct judge_object *a = object_of(judge, contact->object_a);
    const struct judge_object *b = object_of(judge, contact->object_b);
    struct oracle_object view_a = view(a);
    struct oracle_object view_b = view(b);
    if (contact->kind == PCCD_VF) {
        oracle_vf_points(&view_a, contact->feature_a, &view_b, contact->feature_b, p);
    } else {
        oracle_ee_points(&view_a, a->edges[contact->feature_a], &view_b,
                         b->edges[contact->feature_b], p);
    }
}

void judge_fail(const struct judge *judge, const char *what,
                const struct pccd_contact *about)
{
    char way[WAY_TEXT_MAX];
    way_tell(&judge->settings, way);
    print_message("# %s\n# %s\n", judge->context, judge->scene ? way : "");
    if (about) {
        print_message("# %s %u/%u %u/%u flags %u toi %a toi_hi %a param %g %g\n",
                      about->kind == PCCD_VF ? "vf" : "ee", about->object_a,
                      about->feature_a, about->object_b, about->feature_b, about->flags,
                      about->toi, about->toi_hi, (double)about->param[0],
                      (double)about->param[1]);
    }
    if (about && has_features(judge, about)) {
        double p[8][3];
        load_points(judge, about, p);
        for (int i = 0; i < 8; i++) {
            print_message("# {%a, %a, %a},\n", p[i][0], p[i][1], p[i][2]);
        }
    }
    fail_msg("%s", what);
    abort();
}

static void must(const struct judge *judge, bool holds, const char *what,
                 const struct pccd_contact *about)
{
    if (!holds) {
        judge_fail(judge, what, about);
    }
}

static void *copy_of(const void *block, size_t count, size_t bytes)
{
    void *copy = malloc(count * bytes + 1);
    if (!copy) {
        abort();
    }
    if (count > 0) {
        memcpy(copy, block, count * bytes);
    }
    return copy;
}

void judge_watch_init(struct judge *judge, struct judge_sums *sums, double tolerance)
{
    memset(judge, 0, sizeof *judge);
    judge->sums = sums;
    judge->tolerance = tolerance;
}

void judge_init(struct judge *judge, struct judge_sums *sums, double tolerance)
{
    static uint64_t judges;
    judge_watch_init(judge, sums, tolerance);
    judge->ways.state = prng_seed() + ++judges;
    judge->scene = kit_scene();
}

static void object_deinit(struct judge_object *object)
{
    scenes_deinit(&object->mesh);
    free(object->registered);
    free(object->edges);
}

static void forget_objects(struct judge *judge)
{
    for (uint32_t i = 0; i < judge->object_count; i++) {
        object_deinit(&judge->objects[i]);
    }
    judge->object_count = 0;
}

void judge_watch(struct judge *judge, const struct player *player)
{
    forget_objects(judge);
    judge->filters = player->filters;
    for (uint32_t i = 0; i < player->object_count; i++) {
        const struct player_object *from = &player->objects[i];
        struct judge_object *object = &judge->objects[judge->object_count++];
        uint32_t count = from->vertex_count;
        memset(object, 0, sizeof *object);
        object->object_id = from->id;
        object->mesh.vertex_count = count;
        object->mesh.triangle_count = from->triangle_count;
        object->mesh.x0 = copy_of(from->x0, count, sizeof *from->x0);
        object->mesh.x1 = copy_of(from->x1, count, sizeof *from->x1);
        object->mesh.triangles =
            copy_of(from->triangles, from->triangle_count, sizeof *from->triangles);
        struct oracle_object seen = view(object);
        object->edges = oracle_edges(&seen, &object->edge_count);
    }
}

void judge_deinit(struct judge *judge)
{
    forget_objects(judge);
    eng_scene_free(judge->scene);
    judge->scene = NULL;
}

static void register_mesh(struct judge *judge, struct judge_object *object)
{
    const struct scenes_mesh *mesh = &object->mesh;
    struct eng_mesh *registered = NULL;
    struct eng_mesh_info info;
    uint32_t bad = 0;
    assert_ok(eng_mesh_new(mesh->vertex_count, mesh->triangle_count, &registered));
    assert_ok(eng_mesh_write_vertices(registered, PCCD_FORMAT_F64, 0, mesh->vertex_count,
                                      mesh->x0));
    assert_ok(eng_mesh_write_triangles(registered, 0, mesh->triangle_count,
                                       mesh->triangles, &bad));
    assert_ok(eng_mesh_commit(registered, 1));
    eng_mesh_get_info(registered, &info);
    assert_int_equal(info.edge_count, object->edge_count);
    assert_memory_equal(eng_mesh_edges(registered), object->edges,
                        object->edge_count * sizeof *object->edges);
    assert_ok(
        eng_scene_add(judge->scene, registered, object->object_id, &object->object_idx));
    eng_mesh_release(registered);
}

void judge_add(struct judge *judge, const struct scenes_mesh *mesh, uint32_t object_id)
{
    assert_true(judge->object_count < JUDGE_OBJECTS_MAX);
    struct judge_object *object = &judge->objects[judge->object_count++];
    memset(object, 0, sizeof *object);
    object->object_id = object_id;
    object->mesh = *mesh;
    object->mesh.x0 = copy_of(mesh->x0, mesh->vertex_count, sizeof *mesh->x0);
    object->mesh.x1 = copy_of(mesh->x1, mesh->vertex_count, sizeof *mesh->x1);
    object->mesh.triangles =
        copy_of(mesh->triangles, mesh->triangle_count, sizeof *mesh->triangles);
    object->mesh.vertex_of = NULL;
    object->mesh.triangle_of = NULL;
    object->registered = copy_of(mesh->x0, mesh->vertex_count, sizeof *mesh->x0);
    struct oracle_object seen = view(object);
    object->edges = oracle_edges(&seen, &object->edge_count);
    register_mesh(judge, object);
}

void judge_remove(struct judge *judge, uint32_t at)
{
    assert_ok(eng_scene_remove(judge->scene, judge->objects[at].object_idx));
    filters_forget(&judge->filters, judge->objects[at].object_id);
    object_deinit(&judge->objects[at]);
    judge->objects[at] = judge->objects[--judge->object_count];
}

void judge_draw_filters(struct judge *judge, struct prng *prng)
{
    struct filters_place places[JUDGE_OBJECTS_MAX];
    for (uint32_t i = 0; i < judge->object_count; i++) {
        places[i] = (struct filters_place){judge->objects[i].object_id,
                                           judge->objects[i].object_idx};
    }
    filters_draw(&judge->filters, judge->scene, places, judge->object_count, prng);
}

void judge_stage_whole(struct judge *judge)
{
    eng_stage_begin(judge->scene);
    for (uint32_t i = 0; i < judge->object_count; i++) {
        const struct judge_object *object = &judge->objects[i];
        assert_ok(eng_stage_x0x1(judge->scene, object->object_idx, PCCD_FORMAT_F64, 0,
                                 object->mesh.vertex_count, object->mesh.x0,
                                 object->mesh.x1));
    }
}

void judge_step(struct judge *judge, enum pccd_mode mode, struct eng_step_result *result)
{
    judge->settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    judge->settings.mode = mode;
    judge->settings.tolerance = judge->tolerance;
    way_draw(&judge->ways, 4, &judge->settings);
    assert_ok(eng_step(judge->scene, &judge->settings, result));
    judge->sums->team_steps += result->threads > 1;
    must(judge, result->incomplete == PCCD_COMPLETE, "the answer is incomplete", NULL);
    must(judge, result->mode == mode, "the answer is of another mode", NULL);
}

static bool may_meet(const void *filters, uint32_t a, uint32_t b)
{
    return filters_may_meet(filters, a, b);
}

void judge_find(const struct judge *judge, struct oracle_contacts *truth)
{
    struct oracle_object views[JUDGE_OBJECTS_MAX];
    for (uint32_t i = 0; i < judge->object_count; i++) {
        views[i] = view(&judge->objects[i]);
    }
    oracle_scene_where(views, judge->object_count, may_meet, &judge->filters, truth);
    judge->sums->queries += truth->queries;
}

static struct oracle_pair name_of(const struct pccd_contact *contact)
{
    return (struct oracle_pair){contact->kind, contact->object_a, contact->feature_a,
                                contact->object_b, contact->feature_b};
}

/* The points of a pair, after a check that there are such features and that they share no
 * vertex. */
static void points_of(const struct judge *judge, const struct pccd_contact *contact,
                      double p[8][3])
{
    bool is_vf = contact->kind == PCCD_VF;
    must(judge, has_features(judge, contact), "no such features", contact);
    const struct judge_object *a = object_of(judge, contact->object_a);
    const struct judge_object *b = object_of(judge, contact->object_b);
    const uint32_t *va = is_vf ? &contact->feature_a : a->edges[contact->feature_a];
    const uint32_t *vb =
        is_vf ? b->mesh.triangles[contact->feature_b] : b->edges[contact->feature_b];
    must(judge, filters_may_meet(&judge->filters, contact->object_a, contact->object_b),
         "the objects may not meet", contact);
    for (int i = 0; i < (is_vf ? 3 : 4); i++) {
        must(judge, a != b || va[is_vf ? 0 : i / 2] != vb[is_vf ? i : i % 2],
             "the features share a vertex", contact);
    }
    load_points(judge, contact, p);
}

/* Check what holds for any record, true or not. */
static void check_form(const struct judge *judge, const struct pccd_contact *contact)
{
    double length2 = 0;
    must(judge, contact->flags <= (PCCD_PROVED | PCCD_INITIAL), "unknown flag", contact);
    must(judge,
         contact->toi >= 0 && contact->toi <= contact->toi_hi && contact->toi_hi <= 1,
         "times are out of order", contact);
    must(judge, contact->reserved == 0, "reserved word is not 0", contact);
    for (int k = 0; k < 3; k++) {
        length2 += (double)contact->normal[k] * (double)contact->normal[k];
    }
    must(judge, length2 == 0 || fabs(length2 - 1) < 1e-5, "normal is neither unit nor 0",
         contact);
    for (int k = 0; k < 2; k++) {
        must(judge, contact->param[k] >= 0 && contact->param[k] <= 1,
             "parameter outside 0 .. 1", contact);
    }
    must(judge,
         contact->kind != PCCD_VF ||
             (double)contact->param[0] + (double)contact->param[1] <= 1 + 0x1p-22,
         "barycentric weights are more than 1", contact);
    if (contact->flags & PCCD_PROVED) {
        must(judge, contact->toi_hi - contact->toi <= judge->tolerance,
             "proved, but not within the tolerance", contact);
    }
    if (contact->flags & PCCD_INITIAL) {
        must(judge,
             contact->flags & PCCD_PROVED && contact->toi == 0 && contact->toi_hi == 0,
             "initial, but not proved at 0", contact);
    }
}

/* The points that the parameters name meet at the contact, up to rounding and the
 * motion during toi .. toi_hi. */
static void check_params(const struct judge *judge, const struct pccd_contact *contact,
                         const double p[8][3])
{
    double w[4] = {1, 0, 0, 0};
    double s = (double)contact->param[0];
    double r = (double)contact->param[1];
    if (contact->kind == PCCD_VF) {
        w[1] = -(1 - s - r);
        w[2] = -s;
        w[3] = -r;
    } else {
        w[0] = 1 - s;
        w[1] = s;
        w[2] = -(1 - r);
        w[3] = -r;
    }
    double t = 0.5 * (contact->toi + contact->toi_hi);
    double width = contact->toi_hi - contact->toi;
    double size = 0;
    double gap[3] = {0, 0, 0};
    for (int k = 0; k < 9; k++) { /* relative to point 0: the weights add up to 0 */
        int point = 1 + k / 3;
        double d0 = p[point][k % 3] - p[0][k % 3];
        double d1 = p[4 + point][k % 3] - p[4][k % 3];
        gap[k % 3] += w[point] * (d0 * (1 - t) + d1 * t);
        size = fmax(size, fmax(fabs(d0), fabs(d1)));
    }
    for (int k = 0; k < 3; k++) {
        must(judge, fabs(gap[k]) <= size * (4 * width + 1e-3),
             "parameters miss the contact", contact);
    }
}

static void check_true(const struct judge *judge, const struct pccd_contact *contact)
{
    double moving[8][3];
    points_of(judge, contact, moving);
    points_t p = (points_t)moving;
    enum oracle_kind kind = contact->kind == PCCD_VF ? ORACLE_VF : ORACLE_EE;
    struct oracle_first *first = oracle_first_new(kind, p);
    must(judge, first != NULL, "brute force and query differ", contact);
    bool late = oracle_first_compare(first, contact->toi) < 0;
    bool early = oracle_first_compare(first, contact->toi_hi) > 0;
    oracle_first_free(first);
    must(judge, !late, "toi is after the first contact", contact);
    must(judge, !(contact->flags & PCCD_PROVED) || !early,
         "proved, but the first contact is after toi_hi", contact);
    must(judge, oracle_touching_at(kind, p, 0) == ((contact->flags & PCCD_INITIAL) != 0),
         "touching at t = 0 and the flag differ", contact);
    if (contact->flags & PCCD_PROVED) {
        check_params(judge, contact, p);
    }
}

static void check_extra(const struct judge *judge, const struct pccd_contact *contact)
{
    double p[8][3];
    points_of(judge, contact, p);
    must(judge, contact->flags == 0, "proved, but there is no contact", contact);
}

static void check_counts(const struct judge *judge, const struct eng_step_result *result)
{
    const struct pccd_contact *contacts = result->records;
    uint64_t vf = 0;
    uint64_t possible = 0;
    uint64_t initial = 0;
    double first = 2;
    for (uint64_t i = 0; i < result->count; i++) {
        vf += contacts[i].kind == PCCD_VF;
        possible += !(contacts[i].flags & PCCD_PROVED);
        initial += (contacts[i].flags & PCCD_INITIAL) != 0;
        first = fmin(first, contacts[i].toi);
    }
    must(judge,
         result->counts[PCCD_VF] == vf && result->counts[PCCD_EE] == result->count - vf &&
             result->possible == possible && result->initial == initial &&
             result->toi_first == first && result->verdict == PCCD_VERDICT_NONE,
         "counts and records differ", NULL);
}

/* Records and truth are sorted alike: one walk over both. */
void judge_check_all(struct judge *judge, const struct eng_step_result *result,
                     const struct oracle_contacts *truth)
{
    const struct pccd_contact *contacts = result->records;
    size_t at = 0;
    must(judge, result->record_bytes == sizeof *contacts, "size of a record", NULL);
    for (uint64_t i = 0; i < result->count; i++) {
        struct oracle_pair name = name_of(&contacts[i]);
        if (i > 0) {
            struct oracle_pair before = name_of(&contacts[i - 1]);
            must(judge, oracle_pair_compare(&before, &name) < 0, "records out of order",
                 &contacts[i]);
        }
        check_form(judge, &contacts[i]);
        int order =
            at < truth->count ? oracle_pair_compare(&name, &truth->pairs[at]) : -1;
        must(judge, order <= 0, "a contact is missing before this one", &contacts[i]);
        if (order == 0) {
            check_true(judge, &contacts[i]);
            at++;
        } else {
            check_extra(judge, &contacts[i]);
            judge->sums->extra++;
        }
    }
    must(judge, at == truth->count, "contacts are missing at the end", NULL);
    check_counts(judge, result);
    judge->sums->steps++;
    judge->sums->truths += truth->count;
    judge->sums->records += result->count;
    judge->sums->possible += result->possible;
    judge->sums->initial += result->initial;
}

struct judge_records judge_copy(const struct eng_step_result *result)
{
    return (struct judge_records){
        copy_of(result->records, result->count, sizeof(struct pccd_contact)),
        result->count};
}

void judge_check_first(const struct judge *judge, const struct eng_step_result *result,
                       const struct judge_records *all)
{
    const struct pccd_contact *contacts = result->records;
    double bound = INFINITY;
    uint64_t at = 0;
    for (uint64_t i = 0; i < all->count; i++) {
        if (all->items[i].flags & PCCD_PROVED) {
            bound = fmin(bound, all->items[i].toi_hi);
        }
    }
    for (uint64_t i = 0; i < all->count; i++) {
        if (all->items[i].toi <= bound) {
            must(judge,
                 at < result->count &&
                     memcmp(&contacts[at], &all->items[i], sizeof *contacts) == 0,
                 "mode first: not the same record as in mode all", &all->items[i]);
            at++;
        }
    }
    must(judge, at == result->count, "mode first: a record too many",
         at < result->count ? &contacts[at] : NULL);
    check_counts(judge, result);
}

void judge_check_any(const struct judge *judge, const struct eng_step_result *result,
                     const struct judge_records *all)
{
    enum pccd_verdict verdict = all->count > 0 ? PCCD_VERDICT_POSSIBLE : PCCD_VERDICT_NO;
    for (uint64_t i = 0; i < all->count; i++) {
        if (all->items[i].flags & PCCD_PROVED) {
            verdict = PCCD_VERDICT_YES;
        }
    }
    must(judge, result->verdict == verdict && result->count == 0,
         "mode any: another verdict than the records of mode all", NULL);
}

static bool holds(const struct eng_step_result *result, const struct oracle_pair *pair)
{
    return result->count > 0 && bsearch(pair, result->records, result->count,
                                        sizeof *pair, oracle_pair_compare) != NULL;
}

void judge_check_pairs(const struct judge *judge, const struct eng_step_result *result,
                       const struct oracle_contacts *truth,
                       const struct judge_records *all)
{
    const struct pccd_pair *pairs = result->records;
    uint64_t vf = 0;
    assert_int_equal(sizeof(struct pccd_pair), sizeof(struct oracle_pair));
    must(judge, result->record_bytes == sizeof *pairs, "size of a pair", NULL);
    for (uint64_t i = 0; i < result->count; i++) {
        must(judge, i == 0 || oracle_pair_compare(&pairs[i - 1], &pairs[i]) < 0,
             "mode pairs: out of order", NULL);
        struct pccd_contact named = {pairs[i].kind,
                                     0,
                                     pairs[i].object_a,
                                     pairs[i].feature_a,
                                     pairs[i].object_b,
                                     pairs[i].feature_b,
                                     0,
                                     0,
                                     {0, 0},
                                     {0, 0, 0},
                                     0};
        double p[8][3];
        points_of(judge, &named, p);
        must(judge,
             !oracle_is_apart((enum oracle_kind)pairs[i].kind, (const double(*)[3])p),
             "mode pairs: an axis separates a pair", &named);
        vf += pairs[i].kind == PCCD_VF;
    }
    must(judge,
         result->counts[PCCD_VF] == vf && result->counts[PCCD_EE] == result->count - vf,
         "mode pairs: counts and pairs differ", NULL);
    must(judge, result->count == truth->beside,
         "mode pairs: another number of pairs than no axis separates", NULL);
    for (size_t i = 0; i < truth->count; i++) {
        must(judge, holds(result, &truth->pairs[i]), "mode pairs: a contact is missing",
             NULL);
    }
    for (uint64_t i = 0; i < all->count; i++) {
        struct oracle_pair name = name_of(&all->items[i]);
        must(judge, holds(result, &name), "mode pairs: a record of mode all is missing",
             &all->items[i]);
    }
}

void judge_everything(struct judge *judge)
{
    struct oracle_contacts truth;
    struct eng_step_result result;
    judge_step(judge, PCCD_MODE_ALL, &result);
    uint64_t hash[2] = {result.hash[0], result.hash[1]};
    judge_find(judge, &truth);
    judge_check_all(judge, &result, &truth);
    struct judge_records all = judge_copy(&result);
    judge_stage_whole(judge);
    judge_step(judge, PCCD_MODE_FIRST, &result);
    judge_check_first(judge, &result, &all);
    judge_stage_whole(judge);
    judge_step(judge, PCCD_MODE_ANY, &result);
    judge_check_any(judge, &result, &all);
    judge_stage_whole(judge);
    judge_step(judge, PCCD_MODE_PAIRS, &result);
    judge_check_pairs(judge, &result, &truth, &all);
    judge_stage_whole(judge);
    judge_step(judge, PCCD_MODE_ALL, &result);
    must(judge,
         result.hash[0] == hash[0] && result.hash[1] == hash[1] &&
             result.count == all.count &&
             (all.count == 0 ||
              memcmp(result.records, all.items, all.count * sizeof *all.items) == 0),
         "the same motion again has another answer", NULL);
    free(all.items);
    oracle_contacts_deinit(&truth);
}

void judge_check_play(struct judge_sums *sums, const struct player *player,
                      double tolerance, uint64_t seed, uint32_t step,
                      struct eng_step_result *result)
{
    struct judge judge;
    struct oracle_contacts truth;
    judge_watch_init(&judge, sums, tolerance);
    snprintf(judge.context, sizeof judge.context, "PCCD_SEED=%llu, step %u",
             (unsigned long long)seed, step);
    judge_watch(&judge, player);
    judge_find(&judge, &truth);
    judge_check_all(&judge, result, &truth);
    oracle_contacts_deinit(&truth);
    judge_deinit(&judge);
}
