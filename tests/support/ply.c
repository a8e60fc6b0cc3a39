/* ply.c - the binary PLY frames of the public scenes. */
#include "ply.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reader {
    FILE *file;
    bool is_big_endian;
    unsigned vertex_bytes; /* of one vertex, the coordinates first */
    unsigned coordinates;  /* seen so far in the header */
    bool in_vertex;
};

/* Name and size of the scalar types that the frames use. */
static unsigned type_bytes(const char *type)
{
    static const struct {
        const char *name;
        unsigned bytes;
    } types[] = {{"float", 4}, {"double", 8}, {"uchar", 1}, {"int", 4}, {"uint", 4}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (strcmp(types[i].name, type) == 0) {
            return types[i].bytes;
        }
    }
    return 0;
}

static bool read_property(struct reader *reader, struct ply *ply, const char *line)
{
    char type[16];
    char name[16];
    if (strcmp(line, "property list uchar int vertex_indices\n") == 0) {
        return !reader->in_vertex;
    }
    if (!reader->in_vertex || sscanf(line, "property %15s %15s", type, name) != 2 ||
        type_bytes(type) == 0) {
        return false;
    }
    if (strlen(name) == 1 && name[0] == "xyz"[reader->coordinates % 3]) {
        /* x, y and z come first and have one type. */
        if (reader->vertex_bytes != reader->coordinates * type_bytes(type)) {
            return false;
        }
        ply->is_f32 = type_bytes(type) == 4;
        reader->coordinates++;
    }
    reader->vertex_bytes += type_bytes(type);
    return true;
}

static bool read_header(struct reader *reader, struct ply *ply)
{
    char line[256];
    while (fgets(line, sizeof line, reader->file)) {
        if (strcmp(line, "end_header\n") == 0) {
            return reader->coordinates == 3 && ply->vertex_count > 0;
        }
        if (strcmp(line, "format binary_big_endian 1.0\n") == 0) {
            reader->is_big_endian = true;
        } else if (sscanf(line, "element vertex %u", &ply->vertex_count) == 1) {
            reader->in_vertex = true;
        } else if (sscanf(line, "element face %u", &ply->triangle_count) == 1) {
            reader->in_vertex = false;
        } else if (strncmp(line, "property", 8) == 0) {
            if (!read_property(reader, ply, line)) {
                return false;
            }
        } else if (strcmp(line, "format ascii 1.0\n") == 0) {
            return false;
        }
    }
    return false;
}

/* `bytes` bytes of the file as an unsigned number; at most 8. */
static uint64_t number(const struct reader *reader, const unsigned char *from,
                       unsigned bytes)
{
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes; i++) {
        value = value << 8 | from[reader->is_big_endian ? i : bytes - 1 - i];
    }
    return value;
}

static bool read_vertices(struct reader *reader, struct ply *ply)
{
    unsigned char bytes[64];
    unsigned size = ply->is_f32 ? 4 : 8;
    if (reader->vertex_bytes > sizeof bytes) {
        return false;
    }
    for (uint32_t i = 0; i < ply->vertex_count; i++) {
        if (fread(bytes, reader->vertex_bytes, 1, reader->file) != 1) {
            return false;
        }
        for (unsigned k = 0; k < 3; k++) {
            uint64_t bits = number(reader, bytes + k * size, size);
            if (ply->is_f32) {
                uint32_t low = (uint32_t)bits;
                float x;
                memcpy(&x, &low, sizeof x);
                ply->x[i][k] = (double)x;
            } else {
                memcpy(&ply->x[i][k], &bits, sizeof bits);
            }
        }
    }
    return true;
}

static bool read_faces(struct reader *reader, struct ply *ply)
{
    for (uint32_t i = 0; i < ply->triangle_count; i++) {
        unsigned char bytes[13];
        if (fread(bytes, sizeof bytes, 1, reader->file) != 1 || bytes[0] != 3) {
            return false;
        }
        for (unsigned k = 0; k < 3; k++) {
            ply->triangles[i][k] = (uint32_t)number(reader, bytes + 1 + 4 * k, 4);
            if (ply->triangles[i][k] >= ply->vertex_count) {
                return false;
            }
        }
    }
    return true;
}

bool ply_read(const char *path, struct ply *ply)
{
    struct reader reader = {.file = fopen(path, "rb")};
    bool good = false;
    memset(ply, 0, sizeof *ply);
    if (reader.file && read_header(&reader, ply)) {
        ply->x = calloc(ply->vertex_count, sizeof *ply->x);
        ply->triangles = calloc((size_t)ply->triangle_count + 1, sizeof *ply->triangles);
        good = ply->x && ply->triangles && read_vertices(&reader, ply) &&
               read_faces(&reader, ply);
    }
    if (reader.file) {
        fclose(reader.file);
    }
    if (!good) {
        fprintf(stderr, "# %s: not a frame that the tests can read\n", path);
        ply_deinit(ply);
    }
    return good;
}

void ply_deinit(struct ply *ply)
{
    free(ply->x);
    free(ply->triangles);
    memset(ply, 0, sizeof *ply);
}
