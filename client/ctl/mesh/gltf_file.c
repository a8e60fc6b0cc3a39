/* client/ctl/mesh/gltf_file.c - the JSON and the buffers of a glTF 2.0 file.
 *
 * Room:     client/ctl.
 * Does:     chunks, JSON, extensions, buffers.
 * Threads:  one at a time.
 * Source:   gltf_file.h.
 */
#include "gltf_file.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base64.h"
#include "meshfile.h"
#include "pccd_types.h"

#define CHUNK_JSON  0x4e4f534au
#define CHUNK_BIN   0x004e4942u
#define NUMBER_MAX  9007199254740992.0 /* integers are exact in a double up to here */
#define UTF8_MARK   "\xef\xbb\xbf"     /* the mark in UTF-8 */
#define DATA_BASE64 ";base64,"

int gltf_fail(struct gltf *gltf, int status, const char *format, ...)
{
    char what[CTL_ERROR_TEXT_BYTES / 2];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return ctl_error_set(gltf->error, status, "%s: %s", gltf->file->path, what);
}

/* ---- members of the JSON ----------------------------------------------------------- */

int64_t gltf_number(const json_t *object, const char *name, int64_t otherwise)
{
    const json_t *value = json_object_get(object, name);
    if (value == NULL) {
        return otherwise;
    }
    double number = json_is_number(value) ? json_number_value(value) : -1;
    return number >= 0 && number <= NUMBER_MAX && number == floor(number)
               ? (int64_t)number
               : -1;
}

const json_t *gltf_entry(const struct gltf *gltf, const char *array, int64_t index)
{
    return index < 0 ? NULL
                     : json_array_get(json_object_get(gltf->root, array), (size_t)index);
}

size_t gltf_entry_count(const struct gltf *gltf, const char *array)
{
    return json_array_size(json_object_get(gltf->root, array));
}

int gltf_numbers(struct gltf *gltf, const json_t *object, const char *name, size_t count,
                 double *values, const char *what, size_t index)
{
    const json_t *array = json_object_get(object, name);
    if (array != NULL && json_array_size(array) != count) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "%s %zu: %s has %zu numbers, not %zu", what,
                         index, name, json_array_size(array), count);
    }
    for (size_t i = 0; array != NULL && i < count; i++) {
        const json_t *value = json_array_get(array, i);
        if (!json_is_number(value) || !isfinite(json_number_value(value))) {
            return gltf_fail(gltf, PCCD_E_FORMAT, "%s %zu: %s[%zu] is no number", what,
                             index, name, i);
        }
        values[i] = json_number_value(value);
    }
    return PCCD_OK;
}

/* ---- extensions -------------------------------------------------------------------- */

/* Extensions that are read, and those that leave every position as it is; what ends with
 * a star stands for all that begin so. */
static const char *const known_extensions[] = {
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
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
    "EXT_instance_features",
};

static bool is_known_extension(const char *name)
{
    for (size_t i = 0; i < sizeof known_extensions / sizeof known_extensions[0]; i++) {
        const char *known = known_extensions[i];
        size_t length = strlen(known);
        if (known[length - 1] == '*' ? strncmp(name, known, length - 1) == 0
                                     : strcmp(name, known) == 0) {
            return true;
        }
    }
    return false;
}

static int judge_extensions(struct gltf *gltf)
{
    const json_t *required = json_object_get(gltf->root, "extensionsRequired");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (name == NULL || !is_known_extension(name)) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "it requires the extension \"%.80s\", which is not read",
                             name != NULL ? name : "");
        }
    }
    return PCCD_OK;
}

/* ---- the file ---------------------------------------------------------------------- */

static bool is_binary(const struct ctl_file *file)
{
    return file->bytes >= 4 && memcmp(file->data, "glTF", 4) == 0;
}

/* Of the beginning of a .glb: its first chunk is JSON, and it is as long as it says. */
static int check_head(const char *path, const char *data, size_t bytes,
                      uint64_t all_bytes, struct ctl_error *error)
{
    if (bytes < 20) {
        return ctl_error_set(error, PCCD_E_FORMAT, "%s: no binary glTF", path);
    }
    if (ctl_file_word(data + 4) != 2) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: glTF of version %" PRIu32 ", not 2", path,
                             ctl_file_word(data + 4));
    }
    if (ctl_file_word(data + 8) > all_bytes || ctl_file_word(data + 16) != CHUNK_JSON ||
        (uint64_t)ctl_file_word(data + 12) + 20 > ctl_file_word(data + 8)) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s: its header tells of %" PRIu32
                             " bytes, of which %" PRIu32 " describe it; it has %" PRIu64,
                             path, ctl_file_word(data + 8), ctl_file_word(data + 12),
                             all_bytes);
    }
    return PCCD_OK;
}

int ctl_gltf_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    *is_text = !is_binary(begin);
    return *is_text ? PCCD_OK
                    : check_head(begin->path, begin->data, begin->bytes,
                                 begin->bytes + begin->rest_bytes, error);
}

/* The chunk of data, behind the others that a later version may have. */
static void find_binary(struct gltf *gltf, size_t at, size_t end)
{
    const char *data = gltf->file->data;
    while (end - at >= 8 && ctl_file_word(data + at) <= end - at - 8) {
        size_t bytes = ctl_file_word(data + at);
        if (ctl_file_word(data + at + 4) == CHUNK_BIN) {
            gltf->binary = data + at + 8;
            gltf->binary_bytes = bytes;
            return;
        }
        at += 8 + bytes;
    }
}

static int parse_json(struct gltf *gltf)
{
    const char *text = gltf->file->data;
    size_t bytes = gltf->file->bytes;
    json_error_t wrong;
    if (is_binary(gltf->file)) {
        int status = check_head(gltf->file->path, text, bytes, bytes, gltf->error);
        if (status != PCCD_OK) {
            return status;
        }
        find_binary(gltf, (size_t)20 + ctl_file_word(text + 12), ctl_file_word(text + 8));
        bytes = ctl_file_word(text + 12);
        text += 20;
    }
    if (bytes >= strlen(UTF8_MARK) && memcmp(text, UTF8_MARK, strlen(UTF8_MARK)) == 0) {
        text += strlen(UTF8_MARK);
        bytes -= strlen(UTF8_MARK);
    }
    gltf->root = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &wrong);
    return gltf->root != NULL
               ? PCCD_OK
               : gltf_fail(gltf, PCCD_E_FORMAT, "its JSON, line %d, byte %d: %s",
                           wrong.line, wrong.position, wrong.text);
}

int gltf_open(struct ctl_file *file, struct ctl_error *error, struct gltf *gltf)
{
    *gltf = (struct gltf){.file = file, .error = error, .bytes = file->bytes};
    int status = parse_json(gltf);
    if (status != PCCD_OK) {
        return status;
    }
    const json_t *asset = json_object_get(gltf->root, "asset");
    const char *version = json_string_value(json_object_get(asset, "version"));
    const char *least = json_string_value(json_object_get(asset, "minVersion"));
    const char *maker = json_string_value(json_object_get(asset, "generator"));
    gltf->is_export = maker != NULL && strcmp(maker, "pccdctl export") == 0;
    version = least != NULL ? least : version;
    if (version != NULL && strncmp(version, "2.", 2) != 0) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "glTF of version %.20s, not 2", version);
    }
    if (least != NULL && strcmp(least, "2.0") != 0) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "glTF of version %.20s, not 2.0", least);
    }
    gltf->buffer_count = gltf_entry_count(gltf, "buffers");
    gltf->buffer_count += gltf->buffer_count == 0; /* a .glb that does not list its own */
    gltf->buffers = calloc(gltf->buffer_count, sizeof *gltf->buffers);
    if (gltf->buffers == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu buffers",
                         gltf->buffer_count);
    }
    return judge_extensions(gltf);
}

void gltf_close(struct gltf *gltf)
{
    for (size_t i = 0; gltf->buffers != NULL && i < gltf->buffer_count; i++) {
        struct gltf_buffer *buffer = &gltf->buffers[i];
        if (buffer->path != NULL) {
            ctl_file_deinit(&buffer->file);
        }
        free(buffer->path);
        free(buffer->decoded);
    }
    free(gltf->buffers);
    json_decref(gltf->root);
    *gltf = (struct gltf){.file = gltf->file, .error = gltf->error};
}

/* ---- buffers ----------------------------------------------------------------------- */

static int decode(struct gltf *gltf, size_t index, const char *uri,
                  struct gltf_buffer *buffer)
{
    const char *data = strstr(uri, DATA_BASE64);
    if (data == NULL) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "buffer %zu: its data: URI has no base64",
                         index);
    }
    data += strlen(DATA_BASE64);
    size_t count = strlen(data);
    buffer->decoded = malloc(count / 4 * 3 + 2);
    if (buffer->decoded == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "buffer %zu: no memory for %zu bytes", index,
                         count / 4 * 3);
    }
    if (!base64_read(data, count, buffer->decoded, &buffer->bytes)) {
        free(buffer->decoded);
        buffer->decoded = NULL;
        return gltf_fail(gltf, PCCD_E_FORMAT, "buffer %zu: its data: URI is no base64",
                         index);
    }
    buffer->at = buffer->decoded;
    return PCCD_OK;
}

static int digit_of(char character)
{
    return character >= '0' && character <= '9'   ? character - '0'
           : character >= 'a' && character <= 'f' ? character - 'a' + 10
           : character >= 'A' && character <= 'F' ? character - 'A' + 10
                                                  : -1;
}

/* The name that a URI stands for: "%20" is a blank. False: none that a file can have. */
static bool unescape(const char *uri, char *name)
{
    while (*uri != '\0') {
        char character = *uri++;
        if (character == '%') {
            int high = digit_of(uri[0]), low = high < 0 ? -1 : digit_of(uri[1]);
            if (low < 0 || high + low == 0) {
                return false;
            }
            character = (char)(high << 4 | low);
            uri += 2;
        }
        *name++ = character;
    }
    *name = '\0';
    return true;
}

/* Whether a name begins a folder above, at the root, or with a scheme such as "http:". */
static bool leaves_folder(const char *name)
{
    size_t word = strcspn(name, ":/");
    bool leaves = name[0] == '/' || name[word] == ':' || strchr(name, '\\') != NULL;
    for (const char *at = name; !leaves && at != NULL; at = strchr(at, '/')) {
        at += *at == '/';
        leaves = strncmp(at, "..", 2) == 0 && (at[2] == '/' || at[2] == '\0');
    }
    return leaves;
}

static int judge_nothing(const struct ctl_file *begin, bool *is_text,
                         struct ctl_error *error)
{
    (void)begin;
    (void)error;
    *is_text = false;
    return PCCD_OK;
}

static int read_beside(struct gltf *gltf, size_t index, const char *uri,
                       struct gltf_buffer *buffer)
{
    const char *path = gltf->file->path;
    const char *slash = strrchr(path, '/');
    size_t folder = slash == NULL ? 0 : (size_t)(slash + 1 - path);
    struct ctl_error why;
    char *name = malloc(folder + strlen(uri) + 1);
    if (name == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "buffer %zu: no memory for its name", index);
    }
    memcpy(name, path, folder);
    if (!unescape(uri, name + folder) || leaves_folder(name + folder)) {
        free(name);
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "buffer %zu: \"%.200s\" is no file of this folder", index, uri);
    }
    int status = ctl_file_open(name, judge_nothing, &buffer->file, &why);
    if (status == PCCD_OK) {
        status = ctl_file_load(&buffer->file, &why);
        if (status != PCCD_OK) {
            ctl_file_deinit(&buffer->file);
        }
    }
    if (status != PCCD_OK) {
        free(name);
        return gltf_fail(gltf, status, "buffer %zu: %s", index, why.text);
    }
    buffer->path = name;
    buffer->at = buffer->file.data;
    buffer->bytes = buffer->file.bytes;
    return PCCD_OK;
}

int gltf_buffer(struct gltf *gltf, int64_t index, const struct gltf_buffer **buffer)
{
    if (index < 0 || (size_t)index >= gltf->buffer_count) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "buffer %" PRId64 ": there is none", index);
    }
    struct gltf_buffer *made = &gltf->buffers[index];
    const json_t *entry = gltf_entry(gltf, "buffers", index);
    const char *uri = json_string_value(json_object_get(entry, "uri"));
    *buffer = made;
    if (made->at != NULL) {
        return PCCD_OK;
    }
    int status = PCCD_OK;
    if (uri == NULL && index == 0 && gltf->binary != NULL) {
        made->at = gltf->binary;
        made->bytes = gltf->binary_bytes;
    } else if (uri == NULL) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "buffer %" PRId64 ": has no URI, and no data in the file",
                         index);
    } else {
        status = strncmp(uri, "data:", 5) == 0
                     ? decode(gltf, (size_t)index, uri, made)
                     : read_beside(gltf, (size_t)index, uri, made);
    }
    if (status != PCCD_OK) {
        return status;
    }
    int64_t bytes = gltf_number(entry, "byteLength", (int64_t)made->bytes);
    if (bytes < 0 || (uint64_t)bytes > made->bytes) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "buffer %" PRId64 ": has %zu bytes, not %" PRId64, index,
                         made->bytes, bytes);
    }
    gltf->bytes += made->at == gltf->binary ? 0 : made->bytes;
    made->bytes = (size_t)bytes;
    return PCCD_OK;
}
