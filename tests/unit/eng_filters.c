/* eng_filters.c - which objects may meet, kept beside a scene. */
#include "eng_filters.h"

static uint32_t find_object(const struct filters *filters, uint32_t id)
{
    uint32_t at = 0;
    while (at < filters->object_count && filters->objects[at].id != id) {
        at++;
    }
    return at;
}

static uint32_t find_ignored(const struct filters *filters, uint32_t id_a, uint32_t id_b)
{
    uint32_t at = 0;
    uint32_t low = id_a < id_b ? id_a : id_b;
    while (at < filters->ignored_count &&
           (filters->ignored[at][0] != low ||
            filters->ignored[at][1] != id_a + id_b - low)) {
        at++;
    }
    return at;
}

static struct eng_object_filter bits_of(const struct filters *filters, uint32_t id)
{
    uint32_t at = find_object(filters, id);
    struct eng_object_filter begins = {.group = 1, .mask = ~(uint64_t)0, .self = true};
    return at < filters->object_count ? filters->objects[at].bits : begins;
}

bool filters_may_meet(const struct filters *filters, uint32_t id_a, uint32_t id_b)
{
    struct eng_object_filter a = bits_of(filters, id_a);
    struct eng_object_filter b = bits_of(filters, id_b);
    bool a_wants = false;
    bool b_wants = false;
    if (id_a == id_b) {
        return a.self;
    }
    for (int bit = 0; bit < 64; bit++) {
        a_wants = a_wants || ((b.group >> bit & 1) == 1 && (a.mask >> bit & 1) == 1);
        b_wants = b_wants || ((a.group >> bit & 1) == 1 && (b.mask >> bit & 1) == 1);
    }
    return a_wants && b_wants &&
           find_ignored(filters, id_a, id_b) == filters->ignored_count;
}

void filters_set(struct filters *filters, struct eng_scene *scene,
                 struct filters_place place, struct eng_object_filter bits)
{
    struct eng_object_filter now;
    uint32_t at = find_object(filters, place.id);
    assert_true(at < FILTERS_OBJECTS_MAX);
    filters->object_count += at == filters->object_count;
    filters->objects[at] = (struct filters_object){place.id, bits};
    assert_ok(eng_scene_set_filter(scene, place.idx, &bits));
    assert_ok(eng_scene_get_filter(scene, place.idx, &now));
    assert_true(now.group == bits.group && now.mask == bits.mask &&
                now.self == bits.self);
}

void filters_ignore(struct filters *filters, struct eng_scene *scene,
                    struct filters_place a, struct filters_place b, bool ignored)
{
    uint32_t at = find_ignored(filters, a.id, b.id);
    bool was_ignored = at < filters->ignored_count;
    assert_true(!ignored || at < FILTERS_IGNORED_MAX);
    assert_ok(eng_scene_ignore(scene, a.idx, b.idx, ignored));
    if (ignored && !was_ignored) {
        filters->ignored[at][0] = a.id < b.id ? a.id : b.id;
        filters->ignored[at][1] = a.id < b.id ? b.id : a.id;
        filters->ignored_count++;
    } else if (!ignored && was_ignored) {
        memcpy(filters->ignored[at], filters->ignored[--filters->ignored_count],
               sizeof filters->ignored[at]);
    }
    assert_int_equal(eng_scene_ignored_count(scene), filters->ignored_count);
}

static struct eng_object_filter some_bits(struct prng *prng)
{
    struct eng_object_filter bits = ENG_OBJECT_FILTER_DEFAULT;
    if (prng_below(prng, 4) > 0) {
        uint32_t shift = prng_u32(prng, 2) * 61; /* the highest bits, too */
        bits.group = prng_below(prng, 8) << shift;
        bits.mask = (prng_below(prng, 8) << shift) | prng_below(prng, 2);
    }
    bits.self = prng_below(prng, 3) > 0;
    return bits;
}

void filters_draw(struct filters *filters, struct eng_scene *scene,
                  const struct filters_place *places, uint32_t count, struct prng *prng)
{
    if (count == 0) {
        return;
    }
    bool begins_anew = prng_below(prng, 8) == 0;
    for (uint32_t i = 0; i < count; i++) {
        struct eng_object_filter begins = ENG_OBJECT_FILTER_DEFAULT;
        if (begins_anew) {
            filters_set(filters, scene, places[i], begins);
        } else if (prng_below(prng, 4) == 0) {
            filters_set(filters, scene, places[i], some_bits(prng));
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        struct filters_place a = places[prng_below(prng, count)];
        struct filters_place b = places[prng_below(prng, count)];
        if (a.id != b.id) {
            filters_ignore(filters, scene, a, b,
                           filters->ignored_count < FILTERS_IGNORED_MAX &&
                               prng_below(prng, 2) == 0);
        }
    }
}

void filters_forget(struct filters *filters, uint32_t id)
{
    uint32_t at = find_object(filters, id);
    if (at < filters->object_count) {
        filters->objects[at] = filters->objects[--filters->object_count];
    }
    for (uint32_t i = filters->ignored_count; i-- > 0;) {
        if (filters->ignored[i][0] == id || filters->ignored[i][1] == id) {
            memmove(filters->ignored[i], filters->ignored[--filters->ignored_count],
                    sizeof filters->ignored[i]);
        }
    }
}

void filters_apply(const struct filters *filters, struct eng_scene *scene,
                   const struct filters_place *places, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        struct eng_object_filter bits = bits_of(filters, places[i].id);
        assert_ok(eng_scene_set_filter(scene, places[i].idx, &bits));
        for (uint32_t k = 0; k < i; k++) {
            if (find_ignored(filters, places[i].id, places[k].id) <
                filters->ignored_count) {
                assert_ok(eng_scene_ignore(scene, places[k].idx, places[i].idx, true));
            }
        }
    }
}
