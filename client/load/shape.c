/* shape.c - a scene for each client, unlike any other's. */
#include "shape.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define TURN 6.283185307179586

/* Numbers of the waves: height of the sheet above the floor, and of a crest above that. A
 * quarter of a wave that is half as high as that is below the floor. */
#define WAVE_ABOVE  0.35
#define WAVE_HEIGHT 0.5
#define WAVE_APART  0.75

/* No mesh of a real cloth is a grid along the floor's edges: parallel edges that meet are
 * the rare case that takes exact arithmetic. */
#define WAVE_UNEVEN 0.2

uint64_t load_mix(uint64_t seed, uint64_t index)
{
    uint64_t z = seed + (index + 1) * 0x9e3779b97f4a7c15ull; /* splitmix64 */
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ z >> 27) * 0x94d049bb133111ebull;
    return z ^ z >> 31;
}

double load_unit(uint64_t bits)
{
    return (double)(bits >> 11) * 0x1p-53;
}

/* Between -1 and 1. */
static double noise(uint64_t client_seed, uint32_t frame, uint32_t index)
{
    return 2 * load_unit(load_mix(client_seed, (uint64_t)frame << 32 | index)) - 1;
}

static uint64_t client_seed(const struct load_shape *shape)
{
    return load_mix(shape->seed, shape->client);
}

static void grid(uint32_t side, uint32_t (*triangles)[3])
{
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t corner = i / side * (side + 1) + i % side;
        triangles[2 * i][0] = corner;
        triangles[2 * i][1] = corner + 1;
        triangles[2 * i][2] = corner + side + 1;
        triangles[2 * i + 1][0] = corner + 1;
        triangles[2 * i + 1][1] = corner + side + 2;
        triangles[2 * i + 1][2] = corner + side + 1;
    }
}

uint32_t load_sheet_side(uint32_t triangles)
{
    double squares = ((double)triangles - LOAD_FLOOR_TRIANGLES) / 2;
    return squares > 1 ? (uint32_t)lround(sqrt(squares)) : 1;
}

void load_floor(const struct load_shape *shape, float (*x)[3], uint32_t (*triangles)[3])
{
    float spacing = ((float)shape->side + 2) / LOAD_FLOOR_SIDE;
    for (uint32_t i = 0; i < LOAD_FLOOR_VERTICES; i++) {
        x[i][0] = spacing * (float)(i % (LOAD_FLOOR_SIDE + 1)) - 1.0f;
        x[i][1] = spacing * (float)(i / (LOAD_FLOOR_SIDE + 1)) - 1.0f;
        x[i][2] = 0.0f;
    }
    grid(LOAD_FLOOR_SIDE, triangles);
}

void load_sheet(const struct load_shape *shape, uint32_t (*triangles)[3])
{
    grid(shape->side, triangles);
}

/* Above the floor and below it by turns, crumpled so that some of it touches always. */
static void crumple(uint64_t seed, uint32_t side, uint32_t frame, uint32_t i, double x[3])
{
    x[0] = i % (side + 1) + 0.3 * noise(seed, frame, 3 * i);
    x[1] = i / (side + 1) + 0.3 * noise(seed, frame, 3 * i + 1);
    x[2] = (frame % 2 ? -0.4 : 0.4) + 0.6 * noise(seed, frame, 3 * i + 2);
}

/* Two waves, of twelve and seven squares, that run across each other: what each adds to a
 * column and to a row. */
struct waves {
    double columns[LOAD_SIDE_MAX + 1];
    double rows[LOAD_SIDE_MAX + 1];
};

static void make_waves(const struct load_shape *shape, uint64_t seed, uint32_t frame,
                       struct waves *waves)
{
    double turns = (double)frame / LOAD_FRAMES;
    double above = shape->scene == LOAD_SCENE_apart ? WAVE_APART : WAVE_ABOVE;
    for (uint32_t i = 0; i <= shape->side; i++) {
        double column = i / 12.0 + turns + load_unit(seed);
        double row = i / 7.0 - turns + load_unit(load_mix(seed, 1));
        waves->columns[i] = above + 0.7 * WAVE_HEIGHT * sin(TURN * column);
        waves->rows[i] = 0.3 * WAVE_HEIGHT * sin(TURN * row);
    }
}

static void at(const struct load_shape *shape, uint64_t seed, uint32_t frame,
               const struct waves *waves, uint32_t i, double x[3])
{
    uint32_t column = i % (shape->side + 1);
    uint32_t row = i / (shape->side + 1);
    if (shape->scene == LOAD_SCENE_crumple) {
        crumple(seed, shape->side, frame, i, x);
        return;
    }
    x[0] = column + WAVE_UNEVEN * noise(seed, LOAD_FRAMES, 2 * i);
    x[1] = row + WAVE_UNEVEN * noise(seed, LOAD_FRAMES, 2 * i + 1);
    x[2] = waves->columns[column] + waves->rows[row];
}

void load_sheet_at(const struct load_shape *shape, uint32_t frame,
                   enum pccd_format format, void *x)
{
    uint64_t seed = client_seed(shape);
    uint32_t count = load_sheet_vertices(shape);
    struct waves waves;
    make_waves(shape, seed, frame, &waves);
    for (uint32_t i = 0; i < count; i++) {
        double exact[3];
        at(shape, seed, frame, &waves, i, exact);
        for (uint32_t k = 0; k < 3; k++) {
            if (format == PCCD_FORMAT_F64) {
                ((double *)x)[3 * i + k] = exact[k];
            } else {
                ((float *)x)[3 * i + k] = (float)exact[k];
            }
        }
    }
}

/* A large sheet is turned by less, so that its corners move as far. */
void load_sheet_pose(const struct load_shape *shape, uint32_t frame, double m[12])
{
    uint64_t seed = client_seed(shape);
    bool apart = shape->scene == LOAD_SCENE_apart;
    double turn = apart ? 0 : 0.8 / shape->side;
    for (uint32_t i = 0; i < 12; i++) {
        m[i] = (i % 5 == 0 ? 1.0 : 0.0) + turn * noise(seed, frame, i);
    }
    m[11] = (frame % 2 && !apart ? -0.4 : 0.4) + 0.3 * noise(seed, frame, 12);
}

/* ---- How many triangles each client has. */

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* "20", "1k" or "1.5k", but "20..30" is 20. Returns what follows, or NULL. */
static const char *read_count(const char *text, uint32_t *count)
{
    double value = 0;
    double unit = 1;
    if (!is_digit(*text)) {
        return NULL;
    }
    for (; is_digit(*text); text++) {
        value = 10 * value + (*text - '0');
    }
    if (text[0] == '.' && is_digit(text[1])) {
        for (text++; is_digit(*text); text++) {
            unit /= 10;
            value += unit * (*text - '0');
        }
    }
    if (*text == 'k' || *text == 'K') {
        value *= 1000;
        text++;
    }
    if (!(value >= 1 && value <= LOAD_TRIANGLES_MAX)) {
        return NULL;
    }
    *count = (uint32_t)lround(value);
    return text;
}

static const char *read_part(const char *text, struct load_size_part *part)
{
    char *end;
    text = read_count(text, &part->low);
    part->high = part->low;
    part->weight = 1;
    if (text && strncmp(text, "..", 2) == 0) {
        text = read_count(text + 2, &part->high);
    }
    if (text && *text == ':') {
        part->weight = strtod(text + 1, &end);
        text = is_digit(text[1]) ? end : NULL;
    }
    return text && part->low <= part->high && part->weight > 0 && isfinite(part->weight)
               ? text
               : NULL;
}

bool load_sizes_parse(struct load_sizes *sizes, const char *text)
{
    struct load_sizes read = {0};
    for (;;) {
        text = read.count < LOAD_SIZE_PARTS ? read_part(text, &read.parts[read.count++])
                                            : NULL;
        if (!text || (*text != ',' && *text != '\0')) {
            return false;
        }
        if (*text == '\0') {
            *sizes = read;
            return true;
        }
        text++;
    }
}

uint32_t load_sizes_draw(const struct load_sizes *sizes, uint64_t luck)
{
    double sum = 0;
    for (uint32_t i = 0; i < sizes->count; i++) {
        sum += sizes->parts[i].weight;
    }
    double at = sum * load_unit(luck);
    uint32_t part = 0;
    while (part + 1 < sizes->count && at >= sizes->parts[part].weight) {
        at -= sizes->parts[part++].weight;
    }
    double low = sizes->parts[part].low;
    double octaves = log2((double)sizes->parts[part].high / low);
    double drawn = low * exp2(octaves * load_unit(load_mix(luck, 1)));
    return (uint32_t)lround(fmin(drawn, sizes->parts[part].high));
}

uint32_t load_sizes_largest(const struct load_sizes *sizes)
{
    uint32_t largest = 0;
    for (uint32_t i = 0; i < sizes->count; i++) {
        largest = sizes->parts[i].high > largest ? sizes->parts[i].high : largest;
    }
    return largest;
}
