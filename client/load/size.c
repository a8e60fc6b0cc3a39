/* size.c - how many triangles each client has. */
#include "size.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shape.h"

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
