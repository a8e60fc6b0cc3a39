/* moving.c - which vertices move, from what was staged. */
#include "moving.h"

#include <assert.h>
#include <string.h>

/* In scene->moving.moves. */
#define NOW    1u
#define BEFORE 2u

/* Vertices that are compared at once: two of them are a tenth of a small first cache. */
#define BLOCK 64u

/* Vertices that are looked at before all are: if each of them moves, all count as moving,
 * so that a step in which everything moves does not pay for the comparison. */
#define SAMPLES 64u

typedef const double (*positions)[3];

/* Both ends that a write gives, and the current end, of its vertices. */
struct ends {
    positions x0;
    positions x1;
    positions last;
};

static struct ends ends_of(const struct eng_scene *scene, const struct eng_write *write)
{
    uint32_t v = scene->objects[write->object].vertices.first + write->first;
    positions last = (positions)scene->x[scene->now] + v;
    return (struct ends){.x0 = write->has_start ? (positions)scene->start + v : last,
                         .x1 = (positions)scene->x[1 - scene->now] + v,
                         .last = last};
}

static bool differ(positions a, positions b, uint32_t first, uint32_t count)
{
    return memcmp(a + first, b + first, count * sizeof *a) != 0;
}

static bool moves(const struct ends *ends, uint32_t first, uint32_t count)
{
    return differ(ends->x0, ends->x1, first, count) ||
           (ends->x0 != ends->last && differ(ends->x0, ends->last, first, count));
}

/* Return whether a write of a whole object seems to move all of it. */
static bool moves_all(const struct ends *ends, uint32_t count)
{
    uint32_t samples = count < SAMPLES ? count : SAMPLES;
    for (uint32_t i = 0; i < samples; i++) {
        if (!moves(ends, (uint32_t)((uint64_t)count * i / samples), 1)) {
            return false;
        }
    }
    return true;
}

static const struct eng_span nowhere = {UINT32_MAX, 0};

static struct eng_span around(struct eng_span a, struct eng_span b)
{
    return (struct eng_span){a.first < b.first ? a.first : b.first,
                             a.end > b.end ? a.end : b.end};
}

/* Mark the vertices of a write, from `begin` on, that move now. */
static void mark(unsigned char *marks, const struct ends *ends, uint32_t begin,
                 uint32_t count, struct eng_span *span)
{
    for (uint32_t first = 0; first < count; first += BLOCK) {
        uint32_t n = count - first < BLOCK ? count - first : BLOCK;
        if (!moves(ends, first, n)) {
            continue;
        }
        for (uint32_t i = first; i < first + n; i++) {
            if (moves(ends, i, 1)) {
                marks[begin + i] |= NOW;
                *span = around(*span, (struct eng_span){begin + i, begin + i + 1});
            }
        }
    }
}

/* Eight marks at a time: as a rule none of them is set. */
#define WORD      8u
#define EACH(bit) (0x0101010101010101u * (bit))

/* Make the motion of the last step that before it; now nothing is known to move. */
static void age(unsigned char *marks, struct eng_object *object)
{
    if (object->moved_last_step != ENG_MOVES_SOME) { /* it has no marks */
        memset(marks, 0, object->vertices.count);
        object->marked = nowhere;
        object->moved_span = nowhere;
        return;
    }
    static_assert(BEFORE == NOW << 1, "one place to the left");
    uint32_t i = object->marked.first;
    for (; i + WORD <= object->marked.end; i += WORD) {
        uint64_t word;
        memcpy(&word, marks + i, WORD);
        word = (word & EACH(NOW)) << 1;
        memcpy(marks + i, &word, WORD);
    }
    for (; i < object->marked.end; i++) {
        marks[i] = marks[i] & NOW ? BEFORE : 0;
    }
    object->marked = object->moved_span;
    object->moved_span = nowhere;
}

/* From mark `i` on, the next that is not 0; `count` if there is none. */
static uint32_t next_mark(const unsigned char *marks, uint32_t i, uint32_t count)
{
    for (; i + WORD <= count; i += WORD) {
        uint64_t word;
        memcpy(&word, marks + i, WORD);
        if (word != 0) {
            break;
        }
    }
    while (i < count && marks[i] == 0) {
        i++;
    }
    return i;
}

void eng_moving_catch_up(struct eng_scene *scene, const struct eng_object *object)
{
    uint32_t first = object->vertices.first;
    uint32_t count = object->vertices.count;
    double(*to)[3] = scene->x[1 - scene->now] + first;
    positions from = (positions)scene->x[scene->now] + first;
    if (object->is_previous_overwritten || object->moved_last_step == ENG_MOVES_ALL) {
        memcpy(to, from, count * sizeof *to);
        return;
    }
    if (object->moved_last_step == ENG_STANDS) {
        return;
    }
    const unsigned char *marks = scene->moving.moves + first;
    uint32_t end = object->marked.end;
    for (uint32_t i = next_mark(marks, object->marked.first, end); i < end;
         i = next_mark(marks, i + 1, end)) {
        memcpy(to[i], from[i], sizeof *to);
    }
}

/* Return how much of an object its own writes [count] move in this step. */
static enum eng_movement compare(struct eng_scene *scene, struct eng_object *object,
                                 const struct eng_write *writes, uint32_t count)
{
    unsigned char *marks = scene->moving.moves + object->vertices.first;
    if (writes->joint != PCCD_NO_JOINT) { /* it may end where it began */
        return ENG_MOVES_ALL;
    }
    if (count == 1 && writes->count == object->vertices.count) {
        struct ends ends = ends_of(scene, writes);
        if (moves_all(&ends, writes->count)) {
            return ENG_MOVES_ALL;
        }
    }
    age(marks, object);
    for (uint32_t i = 0; i < count; i++) {
        struct ends ends = ends_of(scene, &writes[i]);
        mark(marks, &ends, writes[i].first, writes[i].count, &object->moved_span);
    }
    object->marked = around(object->marked, object->moved_span);
    if (writes->has_poses && object->moved_span.end > 0) {
        return ENG_MOVES_ALL; /* an axis stands: what moves as a whole is so told */
    }
    return object->moved_span.end > 0 ? ENG_MOVES_SOME : ENG_STANDS;
}

static uint32_t count_moving(const struct eng_scene *scene,
                             const struct eng_object *object)
{
    const unsigned char *marks = scene->moving.moves + object->vertices.first;
    uint32_t end = object->marked.end;
    uint32_t moving = 0;
    for (uint32_t i = next_mark(marks, object->marked.first, end); i < end;
         i = next_mark(marks, i + 1, end)) {
        moving++;
    }
    return moving;
}

/* An object moved so much before this step, and `now` in it, of which the marks tell if
 * it is some of it. */
static void settle(struct eng_scene *scene, struct eng_object *object,
                   enum eng_movement now)
{
    enum eng_movement before = object->moved_last_step;
    object->moved_last_step = now;
    if (now != ENG_STANDS) {
        object->moved_number = scene->moving.number;
    }
    object->moves = now > before ? now : before;
    if (object->is_new) {
        object->moves = ENG_MOVES_ALL;
        object->is_new = false;
    }
    if (object->moves == ENG_MOVES_ALL) {
        scene->moving.vertices += object->vertices.count;
    } else if (object->moves == ENG_MOVES_SOME) {
        scene->moving.vertices += count_moving(scene, object);
    }
    scene->moving.all += object->vertices.count;
    scene->moving.objects += object->moves != ENG_STANDS;
}

void eng_moving_commit(struct eng_scene *scene)
{
    assert(scene->staging);
    scene->moving.number++;
    scene->moving.vertices = 0;
    scene->moving.all = 0;
    scene->moving.objects = 0;
    scene->moving.is_spread = false;
    for (uint32_t i = 0; i < scene->write_count;) {
        uint32_t first = i;
        struct eng_object *object = &scene->objects[scene->writes[first].object];
        assert(object->mesh && object->staged == scene->stage);
        while (i < scene->write_count &&
               scene->writes[i].object == scene->writes[first].object) {
            i++;
        }
        settle(scene, object, compare(scene, object, &scene->writes[first], i - first));
    }
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_object *object = &scene->objects[i];
        if (!object->mesh || object->staged == scene->stage) {
            continue;
        }
        if (object->moved_last_step == ENG_MOVES_SOME) {
            age(scene->moving.moves + object->vertices.first, object);
        }
        settle(scene, object, ENG_STANDS);
    }
}

bool eng_moving_turns_alone(const struct eng_scene *scene)
{
    bool alone = scene->turning_count > 0;
    for (uint32_t i = 0; i < scene->object_capacity && alone; i++) {
        const struct eng_object *object = &scene->objects[i];
        alone = !object->mesh || object->joint != PCCD_NO_JOINT ||
                object->moves == ENG_STANDS;
    }
    return alone;
}
