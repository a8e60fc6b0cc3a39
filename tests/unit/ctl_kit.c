/* ctl_kit.c - files of one mesh, for the tests of the mesh readers.
 *
 * Source: "The PLY Polygon File Format" (Turk 1994).
 */
#include "ctl_kit.h"

#include <dirent.h>
#include <unistd.h>

char kit_folder[] = "/tmp/pccd-meshfile-XXXXXX";

const double kit_x[KIT_VERTICES][3] = {
    {-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 300, 0}};
/* The faces as they stand in the files: a count, then vertices. */
static const int faces[] = {4, 0, 1, 2, 3, 3, 0, 4, 1, 3, 1,
                            4, 2, 3, 2, 4, 3, 3, 3, 4, 0};
#define KIT_FACES 5

void kit_put_text(struct kit_bytes *bytes, const char *text)
{
    size_t length = strlen(text);
    assert_true(bytes->count + length <= KIT_FILE_BYTES_MAX);
    memcpy(bytes->data + bytes->count, text, length);
    bytes->count += length;
}

/* A PLY type by its name: its bits in the wanted byte order. */
static void put_value(struct kit_bytes *bytes, const char *type, bool is_big,
                      double value)
{
    uint8_t raw[8];
    size_t size;
    float narrow = (float)value;
    int64_t whole = (int64_t)value;
    if (strcmp(type, "float") == 0) {
        size = 4;
        memcpy(raw, &narrow, size);
    } else if (strcmp(type, "double") == 0) {
        size = 8;
        memcpy(raw, &value, size);
    } else {
        size = strstr(type, "char") != NULL ? 1 : strstr(type, "short") != NULL ? 2 : 4;
        memcpy(raw, &whole, size); /* little-endian: the low bytes come first */
    }
    assert_true(bytes->count + size <= KIT_FILE_BYTES_MAX);
    for (size_t i = 0; i < size; i++) {
        bytes->data[bytes->count++] = (char)raw[is_big ? size - 1 - i : i];
    }
}

static void put(struct kit_bytes *bytes, const struct kit_variant *variant,
                const char *type, double value)
{
    char text[64];
    if (strcmp(variant->encoding, "ascii") == 0) {
        snprintf(text, sizeof text, "%.17g ", value);
        kit_put_text(bytes, text);
    } else {
        put_value(bytes, type, strcmp(variant->encoding, "binary_big_endian") == 0,
                  value);
    }
}

static void end_row(struct kit_bytes *bytes, const struct kit_variant *variant)
{
    if (strcmp(variant->encoding, "ascii") == 0) {
        kit_put_text(bytes, "\n");
    }
}

static void put_header(struct kit_bytes *bytes, const struct kit_variant *variant)
{
    char text[1024];
    const char *extra_element =
        variant->has_extras ? "element material 2\nproperty list uchar short tag\n"
                              "property double shine\n"
                            : "";
    const char *extra_vertex =
        variant->has_extras ? "property uchar red\nproperty list ushort float weights\n"
                            : "";
    const char *extra_face = variant->has_extras ? "property int group\n" : "";
    snprintf(text, sizeof text,
             "ply\nformat %s 1.0\ncomment a pyramid\n%selement vertex %d\n%s"
             "property %s x\nproperty %s y\nproperty %s z\nelement face %d\n"
             "property list %s %s vertex_indices\n%send_header\n",
             variant->encoding, extra_element, KIT_VERTICES, extra_vertex,
             variant->coordinate, variant->coordinate, variant->coordinate, KIT_FACES,
             variant->count, variant->index, extra_face);
    kit_put_text(bytes, text);
}

void kit_make_ply(struct kit_bytes *bytes, const struct kit_variant *variant)
{
    const int *face = faces;
    bytes->count = 0;
    put_header(bytes, variant);
    for (int row = 0; row < 2 && variant->has_extras; row++) {
        put(bytes, variant, "uchar", row);
        for (int i = 0; i < row; i++) {
            put(bytes, variant, "short", 7);
        }
        put(bytes, variant, "double", 0.25);
        end_row(bytes, variant);
    }
    for (int v = 0; v < KIT_VERTICES; v++) {
        if (variant->has_extras) {
            put(bytes, variant, "uchar", 200);
            put(bytes, variant, "ushort", 2);
            put(bytes, variant, "float", 0.5);
            put(bytes, variant, "float", 0.5);
        }
        for (int k = 0; k < 3; k++) {
            put(bytes, variant, variant->coordinate, kit_x[v][k]);
        }
        end_row(bytes, variant);
    }
    for (int f = 0; f < KIT_FACES; f++) {
        int corners = *face++;
        put(bytes, variant, variant->count, corners);
        for (int k = 0; k < corners; k++) {
            put(bytes, variant, variant->index, *face++);
        }
        if (variant->has_extras) {
            put(bytes, variant, "int", -3);
        }
        end_row(bytes, variant);
    }
}

void kit_write_file(const char *name, const void *data, size_t bytes, char *path)
{
    snprintf(path, KIT_PATH_BYTES, "%s/%s", kit_folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, bytes, file), bytes);
    assert_int_equal(fclose(file), 0);
}

struct ctl_mesh kit_read_mesh;
struct ctl_error kit_read_error;

int kit_read(const char *name, const void *data, size_t bytes)
{
    char path[KIT_PATH_BYTES];
    kit_write_file(name, data, bytes, path);
    ctl_mesh_deinit(&kit_read_mesh);
    kit_read_mesh = (struct ctl_mesh){0};
    kit_read_error.text[0] = '\0';
    return ctl_mesh_read(path, &kit_read_mesh, &kit_read_error);
}

int kit_make_folder(void **state)
{
    (void)state;
    return mkdtemp(kit_folder) != NULL ? 0 : -1;
}

int kit_remove_folder(void **state)
{
    DIR *entries = opendir(kit_folder);
    (void)state;
    if (entries == NULL) {
        return -1;
    }
    for (struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        unlinkat(dirfd(entries), entry->d_name, 0); /* "." and ".." stay */
    }
    closedir(entries);
    return rmdir(kit_folder);
}
