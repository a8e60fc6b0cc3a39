/* size.h - chooses how many triangles each simulated client has. */
#ifndef LOAD_SIZE_H
#define LOAD_SIZE_H

#include <stdbool.h>
#include <stdint.h>

#define LOAD_SIZE_PARTS    16u
#define LOAD_TRIANGLES_MAX 1000000u

struct load_sizes {
    uint32_t count;
    struct load_size_part {
        uint32_t low, high; /* triangles */
        double weight;
    } parts[LOAD_SIZE_PARTS];
};

/* False: the text says nothing of the kind; *sizes is as it was. */
bool load_sizes_parse(struct load_sizes *sizes, const char *text);

/* luck: 64 random bits. */
uint32_t load_sizes_draw(const struct load_sizes *sizes, uint64_t luck);
uint32_t load_sizes_largest(const struct load_sizes *sizes);

#endif
