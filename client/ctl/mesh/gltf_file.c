/* client/ctl/mesh/gltf_file.c - the JSON, buffers and accessors of a glTF 2.0 file. */
#include "gltf_file.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "base64.h"
#include "meshfile.h"

#define CHUNK_JSON  0x4e4f534au
#define CHUNK_BIN   0x004e4942u
#define HEAD_BYTES  20u                /* of a .glb, before its JSON */
#define NUMBER_MAX  9007199254740992.0 /* integers are exact in a double up to here */
#define DATA_BASE64 ";base64,"
#define STRIDE_MAX  252 /* of the specification */

/* Bytes that accessors lie in. Those that are asked for are read of a large file, and not
 * its pictures. */
struct gltf_buffer {
    bool is_found;
    const char *at;          /* of a data: URI; otherwise NULL, */
    struct ctl_file *source; /* and it begins at byte `first` of this one */
    uint64_t first;
    size_t bytes;
    struct ctl_file file; /* another file that has it, or nothing */
};

struct gltf_piece {
    const struct gltf_buffer *buffer;
    size_t first, bytes;
    const char *at;
};

bool gltf_check_as(struct gltf *gltf, bool is_right, int status, const char *format, ...)
{
    char what[CTL_ERROR_TEXT_BYTES / 2];
    va_list arguments;
    va_start(arguments, format);
    if (!is_right && gltf->status == PCCD_OK) {
        vsnprintf(what, sizeof what, format, arguments);
        gltf->status =
            ctl_error_set(gltf->error, status, "%s: %s", gltf->file->path, what);
    }
    va_end(arguments);
    return is_right;
}

void *gltf_alloc(struct gltf *gltf, size_t count, size_t bytes, const char *what)
{
    void *blocks = gltf->blocks, *made = NULL;
    if (array_reserve(&blocks, gltf->block_count, &gltf->block_room, sizeof made)) {
        gltf->blocks = blocks;
        made = gltf->blocks[gltf->block_count++] = calloc(count + 1, bytes);
    }
    gltf_check_as(gltf, made != NULL, PCCD_E_NOMEM, "no memory for %zu %s", count, what);
    return made;
}

/* ---- members of the JSON ----------------------------------------------------------- */

long long gltf_value(const json_t *value, long long otherwise)
{
    double number = json_is_number(value) ? json_number_value(value) : -1;
    bool is_whole = number >= 0 && number <= NUMBER_MAX && number == floor(number);
    return value == NULL ? otherwise : is_whole ? (long long)number : -1;
}

long long gltf_number(const json_t *object, const char *name, long long otherwise)
{
    return gltf_value(json_object_get(object, name), otherwise);
}

const json_t *gltf_entry(const struct gltf *gltf, const char *array, long long index)
{
    return json_array_get(json_object_get(gltf->root, array), (size_t)index);
}

size_t gltf_entry_count(const struct gltf *gltf, const char *array)
{
    return json_array_size(json_object_get(gltf->root, array));
}

void gltf_numbers(struct gltf *gltf, struct gltf_named object, const char *name,
                  size_t count, double *values)
{
    const json_t *array = json_object_get(object.json, name);
    size_t has = array != NULL ? json_array_size(array) : count;
    gltf_check(gltf, has == count, "%s %zu: %s has %zu numbers, not %zu", object.what,
               object.index, name, has, count);
    for (size_t i = 0; array != NULL && i < count; i++) {
        const json_t *value = json_array_get(array, i);
        values[i] = json_number_value(value);
        gltf_check(gltf, json_is_number(value) && isfinite(values[i]),
                   "%s %zu: %s[%zu] is no number", object.what, object.index, name, i);
    }
}

/* ---- extensions -------------------------------------------------------------------- */

/* Extensions that are read, and those that leave every position as it is; what ends with
 * a star stands for all that begin so. */
static const char *const known_extensions[] = {"KHR_mesh_quantization",
                                               "EXT_mesh_gpu_instancing",
                                               "KHR_node_visibility",
                                               "KHR_materials_*",
                                               "KHR_texture_*",
                                               "KHR_lights_*",
                                               "EXT_lights_*",
                                               "EXT_texture_*",
                                               "MSFT_texture_*",
                                               "MSFT_packing_*",
                                               "KHR_xmp*",
                                               "KHR_techniques_webgl",
                                               "ADOBE_materials_*",
                                               "EXT_structural_metadata",
                                               "EXT_mesh_features",
                                               "EXT_instance_features"};

static bool is_known_extension(const char *name)
{
    bool is_known = false;
    for (size_t i = 0; i < sizeof known_extensions / sizeof known_extensions[0]; i++) {
        const char *known = known_extensions[i];
        size_t length = strcspn(known, "*");
        is_known |= strncmp(name, known, length) == 0 &&
                    (known[length] == '*' || name[length] == '\0');
    }
    return is_known;
}

const char *gltf_compression(const json_t *object)
{
    const char *name;
    json_t *value;
    json_object_foreach(json_object_get(object, "extensions"), name, value)
    {
        if (strstr(name, "compression") != NULL) {
            return name;
        }
    }
    return NULL;
}

/* ---- the file ---------------------------------------------------------------------- */

static bool is_binary(const struct ctl_file *file)
{
    return file->bytes >= 4 && memcmp(file->data, "glTF", 4) == 0;
}

/* Check the beginning of a .glb: its first chunk is JSON, and the file is as long as it
 * says. */
static void check_head(struct gltf *gltf)
{
    const struct ctl_file *file = gltf->file;
    uint64_t all_bytes = file->bytes + file->rest_bytes;
    if (!gltf_check(gltf, file->bytes >= HEAD_BYTES, "no binary glTF")) {
        return;
    }
    uint32_t version = ctl_file_word(file->data + 4);
    uint32_t bytes = ctl_file_word(file->data + 8);
    uint32_t json_bytes = ctl_file_word(file->data + 12);
    gltf_check(gltf, version == 2, "glTF of version %" PRIu32 ", not 2", version);
    gltf_check(gltf,
               bytes <= all_bytes && ctl_file_word(file->data + 16) == CHUNK_JSON &&
                   (uint64_t)json_bytes + HEAD_BYTES <= bytes,
               "its header tells of %" PRIu32 " bytes, of which %" PRIu32
               " describe it; it has %" PRIu64,
               bytes, json_bytes, all_bytes);
}

static void load(struct gltf *gltf)
{
    if (gltf->status == PCCD_OK) {
        gltf->status = ctl_file_load(gltf->file, gltf->error);
    }
}

/* Parse the JSON. Of a .glb that is not in memory as a whole, the data are left where
 * they are. */
static void parse_json(struct gltf *gltf)
{
    const struct ctl_file *file = gltf->file;
    size_t first = is_binary(file) ? HEAD_BYTES : 0, bytes = 0;
    json_error_t wrong;
    if (first > 0) {
        check_head(gltf);
        bytes = gltf->status == PCCD_OK ? ctl_file_word(file->data + 12) : 0;
    }
    if (first == 0) {
        ctl_file_expect_text(gltf->file);
    }
    if (first == 0 || first + bytes > file->bytes) {
        load(gltf);
        bytes = first == 0 ? file->bytes : bytes;
        gltf_check(gltf, first + bytes <= file->bytes, "it ends too soon");
    }
    if (gltf->status != PCCD_OK) {
        return;
    }
    const struct ctl_file json = {.data = file->data + first, .bytes = bytes};
    const char *text = ctl_file_start(&json);
    gltf->root = json_loadb(text, (size_t)(json.data + bytes - text),
                            JSON_REJECT_DUPLICATES, &wrong);
    gltf_check(gltf, gltf->root != NULL, "its JSON, line %d, byte %d: %s", wrong.line,
               wrong.position, wrong.text);
}

bool gltf_open(struct ctl_file *file, struct ctl_error *error, struct gltf *gltf)
{
    *gltf = (struct gltf){
        .file = file, .error = error, .bytes = file->bytes + file->rest_bytes};
    parse_json(gltf);
    const json_t *asset = json_object_get(gltf->root, "asset"), *value;
    const char *version = json_string_value(json_object_get(asset, "version"));
    const char *least = json_string_value(json_object_get(asset, "minVersion"));
    const char *maker = json_string_value(json_object_get(asset, "generator"));
    version = least != NULL ? least : version != NULL ? version : "2.0";
    gltf_check(gltf, strncmp(version, "2.", 2) == 0, "glTF of version %.20s, not 2",
               version);
    gltf_check(gltf, least == NULL || strcmp(version, "2.0") == 0,
               "glTF of version %.20s, not 2.0", version);
    size_t i;
    json_array_foreach(json_object_get(gltf->root, "extensionsRequired"), i, value)
    {
        const char *name = json_is_string(value) ? json_string_value(value) : "";
        gltf_check(gltf, is_known_extension(name),
                   "it requires the extension \"%.80s\", which is not read", name);
    }
    gltf->is_export = maker != NULL && strcmp(maker, "pccdctl export") == 0;
    gltf->buffer_count = gltf_entry_count(gltf, "buffers");
    gltf->buffer_count += gltf->buffer_count == 0; /* a .glb that does not list its own */
    gltf->buffers =
        gltf_alloc(gltf, gltf->buffer_count, sizeof *gltf->buffers, "buffers");
    return gltf->status == PCCD_OK;
}

void gltf_close(struct gltf *gltf)
{
    for (size_t i = 0; gltf->buffers != NULL && i < gltf->buffer_count; i++) {
        if (gltf->buffers[i].file.path != NULL) {
            ctl_file_deinit(&gltf->buffers[i].file);
        }
    }
    for (size_t i = 0; i < gltf->block_count; i++) {
        free(gltf->blocks[i]);
    }
    free(gltf->blocks);
    free(gltf->pieces);
    json_decref(gltf->root);
    *gltf = (struct gltf){.file = NULL};
}

/* ---- buffers ----------------------------------------------------------------------- */

/* Copy `bytes` of a file. Return whether they were there. */
static bool copy(struct gltf *gltf, struct ctl_file *file, uint64_t first, size_t bytes,
                 char *to)
{
    struct ctl_error why = {.text = ""};
    file->error = &why;
    int status = ctl_file_read_at(file, first, bytes, to);
    file->error = gltf->error;
    return gltf_check_as(gltf, status == PCCD_OK, status, "%s", why.text);
}

/* The chunk of data, behind the others that a later version may have. */
static void find_binary(struct gltf *gltf, struct gltf_buffer *buffer)
{
    struct ctl_file *file = gltf->file;
    uint64_t at = 0, end = 0;
    char head[8];
    if (file->size == 0) { /* a pipe */
        load(gltf);
    }
    if (gltf->status == PCCD_OK && is_binary(file)) {
        at = HEAD_BYTES + (uint64_t)ctl_file_word(file->data + 12);
        end = ctl_file_word(file->data + 8);
    }
    while (buffer->source == NULL && end >= at + 8 && copy(gltf, file, at, 8, head) &&
           ctl_file_word(head) <= end - at - 8) {
        buffer->bytes = ctl_file_word(head);
        buffer->first = at + 8;
        buffer->source = ctl_file_word(head + 4) == CHUNK_BIN ? file : NULL;
        at += 8 + buffer->bytes;
    }
    gltf_check(gltf, buffer->source != NULL,
               "buffer 0: has no URI, and no data in the file");
}

static void decode(struct gltf *gltf, long long index, const char *uri,
                   struct gltf_buffer *buffer)
{
    const char *data = strstr(uri, DATA_BASE64);
    if (!gltf_check(gltf, data != NULL, "buffer %lld: its data: URI has no base64",
                    index)) {
        return;
    }
    data += strlen(DATA_BASE64);
    size_t count = strlen(data);
    char *decoded = gltf_alloc(gltf, count / 4 * 3 + 2, 1, "bytes of a data: URI");
    buffer->at = decoded;
    gltf_check(gltf, decoded != NULL && base64_read(data, count, decoded, &buffer->bytes),
               "buffer %lld: its data: URI is no base64", index);
}

/* The name that a URI stands for: "%20" is a blank. False: none that a file can have. */
static bool unescape(const char *uri, char *name)
{
    while (*uri != '\0') {
        *name = *uri++;
        if (*name == '%') {
            const char digits[3] = {uri[0], uri[0] != '\0' ? uri[1] : '\0', '\0'};
            *name = (char)strtol(digits, NULL, 16);
            if (*name == '\0' || !isxdigit((unsigned char)digits[0]) ||
                !isxdigit((unsigned char)digits[1])) {
                return false;
            }
            uri += 2;
        }
        name++;
    }
    *name = '\0';
    return true;
}

/* Return whether a name begins at the root or with a scheme such as "http:", or leads to
 * a folder above. */
static bool leaves_folder(const char *name)
{
    bool leaves =
        name[0] == '/' || name[strcspn(name, ":/")] == ':' || strchr(name, '\\') != NULL;
    for (const char *at = name; !leaves && at != NULL; at = strchr(at, '/')) {
        at += *at == '/';
        leaves = strncmp(at, "..", 2) == 0 && (at[2] == '/' || at[2] == '\0');
    }
    return leaves;
}

/* The path of another file that has a buffer. NULL: it can have none. */
static const char *path_beside(struct gltf *gltf, long long index, const char *uri)
{
    const char *path = gltf->file->path;
    const char *slash = strrchr(path, '/');
    size_t folder = slash == NULL ? 0 : (size_t)(slash + 1 - path);
    char *name = gltf_alloc(gltf, folder + strlen(uri), 1, "bytes of a name");
    if (name == NULL) {
        return NULL;
    }
    memcpy(name, path, folder);
    return gltf_check(gltf, unescape(uri, name + folder) && !leaves_folder(name + folder),
                      "buffer %lld: \"%.200s\" is no file of this folder", index, uri)
               ? name
               : NULL;
}

static void read_beside(struct gltf *gltf, long long index, const char *uri,
                        struct gltf_buffer *buffer)
{
    const char *name = path_beside(gltf, index, uri);
    struct ctl_error why;
    if (name == NULL) {
        return;
    }
    int status = ctl_file_open(name, &buffer->file, &why);
    if (status == PCCD_OK && buffer->file.size == 0) { /* a pipe */
        status = ctl_file_load(&buffer->file, &why);
    }
    buffer->source = &buffer->file;
    buffer->bytes = (size_t)ctl_file_size(&buffer->file);
    gltf_check_as(gltf, status == PCCD_OK, status, "buffer %lld: %s", index, why.text);
}

static bool is_data(const char *uri)
{
    return strncmp(uri, "data:", 5) == 0;
}

int ctl_gltf_beside(const char *path, ctl_mesh_file_fn each, void *context,
                    struct ctl_error *error)
{
    struct ctl_file file;
    struct gltf gltf;
    int status = ctl_file_open(path, &file, error);
    if (status != PCCD_OK) {
        return status;
    }
    gltf_open(&file, error, &gltf);
    size_t count = gltf_entry_count(&gltf, "buffers");
    for (size_t i = 0; i < count && gltf.status == PCCD_OK; i++) {
        const json_t *entry = gltf_entry(&gltf, "buffers", (long long)i);
        const char *uri = json_string_value(json_object_get(entry, "uri"));
        const char *name =
            uri != NULL && !is_data(uri) ? path_beside(&gltf, (long long)i, uri) : NULL;
        if (name != NULL) {
            gltf.status = each(context, name, error);
        }
    }
    status = gltf.status;
    gltf_close(&gltf);
    ctl_file_deinit(&file);
    return status;
}

/* A buffer: the file's own, of a data: URI, or of a file in the folder of this one or
 * below it. NULL: it is not there. */
static const struct gltf_buffer *find_buffer(struct gltf *gltf, long long index)
{
    const json_t *entry = gltf_entry(gltf, "buffers", index);
    const char *uri = json_string_value(json_object_get(entry, "uri"));
    if (gltf->status != PCCD_OK ||
        !gltf_check(gltf, index >= 0 && (size_t)index < gltf->buffer_count,
                    "buffer %lld: there is none", index)) {
        return NULL;
    }
    struct gltf_buffer *buffer = &gltf->buffers[index];
    if (buffer->is_found) {
        return buffer;
    }
    if (uri == NULL) {
        gltf_check(gltf, index == 0, "buffer %lld: has no URI", index);
        find_binary(gltf, buffer);
    } else if (is_data(uri)) {
        decode(gltf, index, uri, buffer);
    } else {
        read_beside(gltf, index, uri, buffer);
    }
    long long bytes = gltf_number(entry, "byteLength", (long long)buffer->bytes);
    gltf_check(gltf, bytes >= 0 && (size_t)bytes <= buffer->bytes,
               "buffer %lld: has %zu bytes, not %lld", index, buffer->bytes, bytes);
    gltf->bytes += uri != NULL ? buffer->bytes : 0;
    buffer->bytes = (size_t)bytes;
    buffer->is_found = gltf->status == PCCD_OK;
    return buffer->is_found ? buffer : NULL;
}

/* Bytes of a buffer, which has them. */
static const char *bytes_at(struct gltf *gltf, const struct gltf_buffer *buffer,
                            size_t first, size_t bytes)
{
    if (buffer->at != NULL || ctl_file_is_loaded(buffer->source)) {
        return (buffer->at != NULL ? buffer->at : buffer->source->data + buffer->first) +
               first;
    }
    for (size_t i = 0; i < gltf->piece_count; i++) {
        const struct gltf_piece *piece = &gltf->pieces[i];
        if (piece->buffer == buffer && piece->first == first && piece->bytes == bytes) {
            return piece->at;
        }
    }
    void *pieces = gltf->pieces;
    char *at = gltf_alloc(gltf, bytes, 1, "bytes of a buffer");
    if (at == NULL || !copy(gltf, buffer->source, buffer->first + first, bytes, at) ||
        !gltf_check_as(gltf,
                       array_reserve(&pieces, gltf->piece_count, &gltf->piece_room,
                                     sizeof *gltf->pieces),
                       PCCD_E_NOMEM, "no memory for %zu pieces", gltf->piece_count)) {
        return NULL;
    }
    gltf->pieces = pieces;
    gltf->pieces[gltf->piece_count++] = (struct gltf_piece){buffer, first, bytes, at};
    return at;
}

/* ---- accessors --------------------------------------------------------------------- */

#define BIT(type)  (1u << (GLTF_##type - GLTF_I8))
#define NORMALIZED (1u << 31) /* integers only if they stand for fractions */
#define INTEGERS   (BIT(U8) | BIT(U16) | BIT(U32))
#define POSITIONS  (BIT(FLOAT) | BIT(I8) | BIT(U8) | BIT(I16) | BIT(U16))
#define FRACTIONS  (POSITIONS | NORMALIZED)

static const struct {
    size_t bytes;
    double greatest; /* what stands for 1 */
} types[] = {{1, 127}, {1, 255}, {2, 32767}, {2, 65535}, {0, 0}, {4, 0}, {4, 0}};

static const struct {
    const char *kind;
    size_t components;
    unsigned types; /* that it may have, as bits */
} roles[] = {
    [GLTF_POSITIONS] = {"VEC3", 3, POSITIONS},
    [GLTF_JOINTS] = {"VEC4", 4, BIT(U8) | BIT(U16)},
    [GLTF_JOINT_WEIGHTS] = {"VEC4", 4, BIT(FLOAT) | BIT(U8) | BIT(U16) | NORMALIZED},
    [GLTF_INDICES] = {"SCALAR", 1, INTEGERS},
    [GLTF_MATRICES] = {"MAT4", 16, BIT(FLOAT)},
    [GLTF_TIMES] = {"SCALAR", 1, BIT(FLOAT)},
    [GLTF_VECTORS] = {"VEC3", 3, BIT(FLOAT)},
    [GLTF_ROTATIONS] = {"VEC4", 4, FRACTIONS},
    [GLTF_FRACTIONS] = {"SCALAR", 1, FRACTIONS},
};

/* The type that a code stands for, if it is one of these bits; 0: it is not. */
static enum gltf_type type_of(long long code, unsigned bits)
{
    bool is_type = code >= GLTF_I8 && code <= GLTF_FLOAT;
    return is_type && (bits >> (code - GLTF_I8) & 1) != 0 ? (enum gltf_type)code : 0;
}

static size_t bytes_of(enum gltf_type type)
{
    return type != 0 ? types[type - GLTF_I8].bytes : 0;
}

static inline double value_at(const char *at, enum gltf_type type)
{
    uint32_t bits;
    float value;
    switch (type) {
    case GLTF_I8:
        return (double)(signed char)at[0];
    case GLTF_I16:
        return (double)(int16_t)ctl_file_integer(at, 2);
    case GLTF_FLOAT:
        bits = ctl_file_integer(at, 4);
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    default:
        return (double)ctl_file_integer(at, bytes_of(type));
    }
}

static size_t sparse_index(const struct gltf_accessor *accessor, size_t k)
{
    size_t bytes = bytes_of(accessor->sparse_type);
    return ctl_file_integer(accessor->sparse_at + k * bytes, bytes);
}

/* Return where `count` elements of `bytes` each lie, by the bufferView and byteOffset of
 * an object of the accessor. NULL: nowhere. */
static const char *find_bytes(struct gltf *gltf, size_t accessor, const json_t *object,
                              size_t count, size_t bytes, size_t *stride)
{
    long long index = gltf_number(object, "bufferView", -1);
    long long offset = gltf_number(object, "byteOffset", 0);
    const json_t *view = gltf_entry(gltf, "bufferViews", index);
    long long begin = gltf_number(view, "byteOffset", 0);
    long long length = gltf_number(view, "byteLength", -1);
    long long step = gltf_number(view, "byteStride", (long long)bytes);
    long long rest = length - offset - (long long)bytes; /* behind the first one */
    const char *compression = gltf_compression(view);
    gltf_check(gltf, view != NULL, "accessor %zu: there is no bufferView %lld", accessor,
               index);
    gltf_check(gltf, compression == NULL,
               "bufferView %lld: is compressed by \"%.80s\", which is not read", index,
               compression);
    const struct gltf_buffer *buffer = find_buffer(gltf, gltf_number(view, "buffer", -1));
    if (buffer == NULL) {
        return NULL;
    }
    long long has = (long long)buffer->bytes;
    gltf_check(gltf, begin >= 0 && length >= 0 && begin <= has - length,
               "bufferView %lld: goes beyond its buffer, which has %lld bytes", index,
               has);
    gltf_check(gltf, step >= (long long)bytes && step <= STRIDE_MAX,
               "bufferView %lld: a stride of %lld bytes for elements of %zu", index, step,
               bytes);
    gltf_check(
        gltf,
        offset >= 0 && offset <= length &&
            (count == 0 || (rest >= 0 && step > 0 && count - 1 <= (size_t)(rest / step))),
        "accessor %zu: goes beyond bufferView %lld, which has %lld bytes", accessor,
        index, length);
    *stride = (size_t)step;
    size_t span = count > 0 ? (count - 1) * (size_t)step + bytes : 0;
    return gltf->status == PCCD_OK
               ? bytes_at(gltf, buffer, (size_t)(begin + offset), span)
               : NULL;
}

static void find_sparse(struct gltf *gltf, const json_t *sparse,
                        struct gltf_accessor *accessor)
{
    const json_t *indices = json_object_get(sparse, "indices");
    const json_t *values = json_object_get(sparse, "values");
    long long number = gltf_number(sparse, "count", -1);
    size_t count = (size_t)number, stride;
    accessor->sparse_type = type_of(gltf_number(indices, "componentType", -1), INTEGERS);
    gltf_check(
        gltf, number >= 0 && count <= accessor->count && accessor->sparse_type != 0,
        "accessor %zu: its sparse elements have no valid count or type", accessor->index);
    accessor->sparse_at = find_bytes(gltf, accessor->index, indices, count,
                                     bytes_of(accessor->sparse_type), &stride);
    accessor->sparse_values = find_bytes(gltf, accessor->index, values, count,
                                         accessor->bytes * accessor->components, &stride);
    for (size_t k = 0; k < count && gltf->status == PCCD_OK; k++) {
        size_t here = sparse_index(accessor, k);
        gltf_check_as(
            gltf,
            here < accessor->count && (k == 0 || here > sparse_index(accessor, k - 1)),
            PCCD_E_INDEX, "accessor %zu: sparse index %zu is %zu of %zu, and they ascend",
            accessor->index, k, here, accessor->count);
    }
    accessor->sparse_count = count;
}

struct gltf_accessor gltf_find(struct gltf *gltf, const json_t *number,
                               enum gltf_role role)
{
    long long index = gltf_value(number, -1);
    const json_t *entry = gltf_entry(gltf, "accessors", index);
    const json_t *sparse = json_object_get(entry, "sparse");
    const char *kind = json_string_value(json_object_get(entry, "type"));
    long long code = gltf_number(entry, "componentType", -1);
    long long count = gltf_number(entry, "count", -1);
    bool is_normalized = json_is_true(json_object_get(entry, "normalized"));
    struct gltf_accessor found = {.index = (size_t)index,
                                  .type = type_of(code, roles[role].types),
                                  .count = (size_t)count,
                                  .components = roles[role].components};
    found.bytes = bytes_of(found.type);
    found.greatest =
        is_normalized && found.type != 0 ? types[found.type - GLTF_I8].greatest : 0;
    gltf_check(gltf, entry != NULL, "accessor %lld: there is none", index);
    gltf_check(gltf, count >= 0, "accessor %lld: has no count", index);
    gltf_check(gltf,
               found.type != 0 && kind != NULL && strcmp(kind, roles[role].kind) == 0,
               "accessor %lld: has %.16s of component type %lld where %s is needed",
               index, kind != NULL ? kind : "elements", code, roles[role].kind);
    gltf_check(gltf,
               (roles[role].types & NORMALIZED) == 0 || found.type == GLTF_FLOAT ||
                   is_normalized,
               "accessor %lld: has integers that are not normalized, where fractions are "
               "needed",
               index);
    if (json_object_get(entry, "bufferView") != NULL) {
        found.at = find_bytes(gltf, found.index, entry, found.count,
                              found.bytes * found.components, &found.stride);
    }
    if (sparse != NULL) {
        find_sparse(gltf, sparse, &found);
    }
    /* Zeros that nobody has written take no bytes: there are no more of them than
     * bytes. */
    gltf_check(gltf, found.at != NULL || found.count <= gltf->bytes,
               "accessor %lld: has %zu zeros in a file of %" PRIu64 " bytes", index,
               found.count, gltf->bytes);
    return gltf->status == PCCD_OK ? found : (struct gltf_accessor){.count = 0};
}

/* Return where element i lies; NULL: it is zero. */
static const char *place_of(const struct gltf_accessor *accessor, size_t i)
{
    size_t low = 0, high = accessor->sparse_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        size_t here = sparse_index(accessor, middle);
        if (here == i) {
            return accessor->sparse_values +
                   middle * accessor->bytes * accessor->components;
        }
        low = here < i ? middle + 1 : low;
        high = here < i ? high : middle;
    }
    return accessor->at == NULL ? NULL : accessor->at + i * accessor->stride;
}

void gltf_read(const struct gltf_accessor *accessor, size_t i, double *values)
{
    const char *at = place_of(accessor, i);
    size_t bytes = accessor->bytes;
    for (size_t k = 0; k < accessor->components; k++) {
        values[k] = at == NULL ? 0
                    : accessor->type == GLTF_FLOAT
                        ? value_at(at + k * 4, GLTF_FLOAT)
                        : value_at(at + k * bytes, accessor->type);
        if (accessor->greatest > 0) {
            values[k] /= accessor->greatest;
            values[k] = values[k] < -1 ? -1 : values[k];
        }
    }
}
