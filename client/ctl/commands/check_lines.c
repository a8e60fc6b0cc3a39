/* check_lines.c - results of a check as lines, written or compared. */
#include "check_lines.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "columns.h"
#include "confined.h"
#include "ctl.h"
#include "dispatch.h"
#include "names.h"
#include "output.h"
#include "shown.h"

#define PIECE_BYTES    ((size_t)1 << 20)
#define DIFFERENT_TOLD 10u
static const char begin[] = "{\"pccd_check\":1,";

/* ---- inputs ------------------------------------------------------------------------ */

static int fail(const char *path, const char *what, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_SYSTEM, "%s: %s: %s", path, what, tool_why(errno));
}

/* Hash a file, by pieces of `piece`. */
static int hash_file(const char *path, char *piece, XXH3_state_t *state, uint64_t *bytes,
                     struct ctl_error *error)
{
    int fd = tool_open(path);
    if (fd < 0) {
        return fail(path, "cannot open", error);
    }
    ssize_t got = 1;
    *bytes = 0;
    XXH3_128bits_reset(state);
    while (got > 0 || (got < 0 && errno == EINTR)) {
        got = read(fd, piece, PIECE_BYTES);
        if (got > 0) {
            XXH3_128bits_update(state, piece, (size_t)got);
            *bytes += (uint64_t)got;
        }
    }
    int status = got == 0 ? PCCD_OK : fail(path, "cannot read", error);
    (void)close(fd);
    return status;
}

struct inputs {
    json_t *list; /* the caller's */
    char *piece;
    XXH3_state_t *state;
};

/* Append what a file is called and what is in it. */
static int add_input(void *context, const char *path, struct ctl_error *error)
{
    const struct inputs *inputs = context;
    uint64_t bytes = 0;
    char text[33];
    bool ok = true;
    if (ctl_mesh_is_pipe(path)) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s is no regular file: what it has cannot be told", path);
    }
    int status = hash_file(path, inputs->piece, inputs->state, &bytes, error);
    if (status != PCCD_OK) {
        return status;
    }
    XXH128_hash_t hash = XXH3_128bits_digest(inputs->state);
    (void)snprintf(text, sizeof text, "%016" PRIx64 "%016" PRIx64, hash.high64,
                   hash.low64);
    json_t *input = json_object();
    json_set(input, "file", json_text(tool_base_name(path)), &ok);
    json_set_count(input, "bytes", bytes, &ok);
    json_set(input, "xxh128", json_string(text), &ok);
    json_append(inputs->list, input, &ok);
    return ok ? PCCD_OK : ctl_error_set(error, PCCD_E_NOMEM, "no memory for the files");
}

/* All files, in the order of the objects, each before those that it names; a scene file
 * first. */
static int add_inputs(json_t *list, const struct scene *scene, struct ctl_error *error)
{
    struct inputs inputs = {list, malloc(PIECE_BYTES), XXH3_createState()};
    int status = inputs.piece != NULL && inputs.state != NULL
                     ? PCCD_OK
                     : ctl_error_set(error, PCCD_E_NOMEM, "no memory for the files");
    if (status == PCCD_OK && scene->path != NULL) {
        status = add_input(&inputs, scene->path, error);
    }
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        const struct ctl_sequence *files = &scene->objects[i].files.sequence;
        for (uint32_t k = 0; k < files->count && status == PCCD_OK; k++) {
            status = add_input(&inputs, files->paths[k], error);
            if (status == PCCD_OK) {
                status = ctl_mesh_beside(files->paths[k], add_input, &inputs, error);
            }
        }
    }
    XXH3_freeState(inputs.state);
    free(inputs.piece);
    return status;
}

/* ---- settings ---------------------------------------------------------------------- */

#define OF(member) COLUMN_OF(struct check_command, member)
static const struct column settings[] = {
    {"tolerance", .type = COLUMN_REAL, OF(check.settings.tolerance)},
    {"separation", .type = COLUMN_REAL, OF(check.settings.separation)},
    {"approach", .type = COLUMN_REAL, OF(check.settings.approach)},
    {"touching", .type = COLUMN_NUMBER, OF(check.settings.touching)},
    {"thickness", .type = COLUMN_REAL, OF(check.ask.object.radius)},
    {"rest_exclusion", .type = COLUMN_REAL, OF(check.ask.object.rest_distance)},
    {"rings", .type = COLUMN_NUMBER, OF(check.ask.object.rest_rings)},
    {"weld", .type = COLUMN_REAL, OF(check.ask.frames.weld)}, /* 0: auto, -1: off */
    {"rate", .type = COLUMN_REAL, OF(check.ask.frames.wish.rate)},
    {"no_self", .type = COLUMN_FLAG, OF(scene.has_no_self)},
    {0}};
static const struct column parts[] = {{"part", .type = COLUMN_NUMBER, OF(results.part)},
                                      {"parts", .type = COLUMN_NUMBER, OF(results.parts)},
                                      {0}};

static json_t *settings_json(const struct check_command *command, bool *ok)
{
    json_t *object = json_object(), *between = json_array();
    const char *animation = command->check.ask.frames.wish.animation;
    json_set(object, "mode", json_string(common_mode_name(command->check.settings.mode)),
             ok);
    *ok = *ok && columns_add(object, settings, command);
    json_set(object, "animation", animation != NULL ? json_text(animation) : json_null(),
             ok);
    json_set_count(object, "with", command->scene.with.count, ok);
    for (size_t i = 0; i < command->scene.between.count; i++) {
        json_append(between, json_text(command->scene.between.list[i]), ok);
    }
    json_set(object, "between", between, ok);
    return object;
}

json_t *check_head(const struct check_command *command, const struct scene *scene,
                   struct ctl_error *error)
{
    bool ok = true;
    json_t *inputs = json_array(), *head = json_object();
    int status = add_inputs(inputs, scene, error);
    json_set_count(head, "pccd_check", 1, &ok);
    json_set(head, "version",
             json_string(CTL_STRING(PCCD_VERSION_MAJOR) "." CTL_STRING(
                 PCCD_VERSION_MINOR) "." CTL_STRING(PCCD_VERSION_PATCH)),
             &ok);
    json_set(head, "inputs", inputs, &ok);
    json_set(head, "settings", settings_json(command, &ok), &ok);
    json_set_count(head, "steps", scene->count - 1, &ok);
    if (command->results.parts > 0) {
        ok = ok && columns_add(head, parts, command);
    }
    if (!ok || status != PCCD_OK) {
        json_decref(head);
        head = NULL;
    }
    if (status == PCCD_OK && !ok) {
        (void)ctl_error_set(error, PCCD_E_NOMEM, "no memory for the head of the results");
    }
    return head;
}

static bool mode_read(const json_t *object, struct check_command *command)
{
    const char *name = json_string_value(json_object_get(object, "mode"));
    for (uint32_t mode = 0; name != NULL && mode < PCCD_MODE_COUNT; mode++) {
        if (strcmp(name, common_mode_name(mode)) == 0) {
            command->check.settings.mode = mode;
            return true;
        }
    }
    return false;
}

bool check_head_read(const json_t *head, struct check_command *command)
{
    const json_t *object = json_object_get(head, "settings");
    const json_t *between = json_object_get(object, "between");
    struct pccd_object_settings *set = &command->check.ask.object;
    if (!columns_read(object, settings, command) || !mode_read(object, command) ||
        !json_is_integer(json_object_get(object, "with"))) {
        return false;
    }
    set->what = (set->radius != 0 ? PCCD_OBJECT_RADIUS : 0u) |
                (set->rest_distance != 0 ? PCCD_OBJECT_REST_DISTANCE : 0u) |
                (set->rest_rings != 0 ? PCCD_OBJECT_REST_RINGS : 0u);
    command->check.ask.frames.wish.animation =
        json_string_value(json_object_get(object, "animation"));
    size_t count = json_array_size(between);
    command->scene.between.list = calloc(count + 1, sizeof *command->scene.between.list);
    for (size_t i = 0; command->scene.between.list != NULL && i < count; i++) {
        const char *text = json_string_value(json_array_get(between, i));
        if (text == NULL) {
            return false;
        }
        command->scene.between.list[command->scene.between.count++] =
            (char *)(uintptr_t)text;
    }
    return command->scene.between.list != NULL &&
           ((json_object_get(head, "part") == NULL &&
             json_object_get(head, "parts") == NULL) ||
            (columns_read(head, parts, command) && results_part_is(&command->results)));
}

/* ---- lines ------------------------------------------------------------------------- */

/* A value as its JSON, which is ASCII. */
static void print_value(const char *before, const json_t *value)
{
    char *text =
        value != NULL
            ? json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_ENSURE_ASCII)
            : NULL;
    printf("%s%s", before, text != NULL ? text : "not there");
    free(text);
}

/* Say which members of a line are not those that are expected. */
static void tell_different(const struct check_lines *lines, const char *expected,
                           const json_t *line)
{
    const json_t *step = json_object_get(line, "step");
    json_t *old = json_loads(expected, 0, NULL);
    const char *key;
    json_t *value;
    printf("different  line %" PRIu32, lines->number);
    if (step != NULL) {
        print_value(", step ", step);
    }
    putchar('\n');
    if (!json_is_object(old)) {
        printf("           it %s\n", expected[0] != '\0' ? "is no JSON" : "is not there");
    }
    json_object_foreach((json_t *)(uintptr_t)line, key, value)
    {
        const json_t *was = json_object_get(old, key);
        if (json_is_object(old) && !json_equal(was, value)) {
            printf("           %s", key);
            print_value(" was ", was);
            print_value(", is ", value);
            putchar('\n');
        }
    }
    json_decref(old);
}

static int cannot_read(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_SYSTEM, "the certificate cannot be read: %s",
                         strerror(errno));
}

/* Compare with the next line of the certificate. */
static int compare(struct check_lines *lines, const json_t *line, const char *text,
                   struct ctl_error *error)
{
    char *expected = NULL;
    size_t room = 0;
    ssize_t length = getline(&expected, &room, lines->expected);
    int status = length < 0 && ferror(lines->expected) ? cannot_read(error) : PCCD_OK;
    lines->number++;
    if (status == PCCD_OK && (length < 0 || strcmp(expected, text) != 0)) {
        lines->different++;
        if (lines->different <= DIFFERENT_TOLD) {
            tell_different(lines, length < 0 ? "" : expected, line);
        }
    }
    free(expected);
    return status;
}

int check_lines_put(struct check_lines *lines, json_t *line, struct ctl_error *error)
{
    size_t bytes = 0;
    int status = PCCD_OK;
    if (lines->results.fd >= 0 && line != NULL) {
        status = results_append(&lines->results, line, error);
    } else if (lines->to != NULL || lines->expected != NULL || line == NULL) {
        char *text = line != NULL ? results_text(line, &bytes) : NULL;
        if (text == NULL) {
            status = ctl_error_set(error, PCCD_E_NOMEM, "no memory for a result");
        } else if (lines->expected != NULL) {
            status = compare(lines, line, text, error);
        } else if (fwrite(text, 1, bytes, lines->to) != bytes || fflush(lines->to) != 0) {
            status = ctl_error_set(error, PCCD_E_SYSTEM, "results cannot be written: %s",
                                   strerror(errno));
        }
        free(text);
    }
    json_decref(line);
    return status;
}

int check_lines_end(struct check_lines *lines, struct ctl_error *error)
{
    int next = lines->expected != NULL ? getc(lines->expected) : EOF;
    if (next != EOF) {
        lines->different++;
        printf("different  line %" PRIu32 ", behind the verdict: none is expected\n",
               lines->number + 1);
    }
    return lines->expected != NULL && ferror(lines->expected) ? cannot_read(error)
                                                              : PCCD_OK;
}

void check_lines_close(struct check_lines *lines)
{
    results_close(&lines->results);
    if (lines->expected != NULL) {
        (void)fclose(lines->expected);
    }
    *lines = (struct check_lines)CHECK_LINES_INIT;
}

/* ---- certificates ------------------------------------------------------------------ */

bool check_is_certificate(const char *path)
{
    char text[sizeof begin - 1];
    int fd = ctl_mesh_is_pipe(path) ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    bool is_it = fd >= 0 && read(fd, text, sizeof text) == (ssize_t)sizeof text &&
                 memcmp(text, begin, sizeof text) == 0;
    if (fd >= 0) {
        (void)close(fd);
    }
    return is_it;
}

/* Return whether the last line is whole, and a verdict. */
static bool has_verdict(FILE *file)
{
    static const char verdict[] = "{\"verdict\":";
    char *line = NULL;
    size_t room = 0;
    bool has = false;
    for (ssize_t length; (length = getline(&line, &room, file)) > 0;) {
        has = line[length - 1] == '\n' && strncmp(line, verdict, sizeof verdict - 1) == 0;
    }
    free(line);
    return has;
}

int check_lines_expect(struct check_lines *lines, const char *path, json_t **head,
                       struct ctl_error *error)
{
    char *line = NULL;
    size_t room = 0;
    FILE *file = lines->expected = fopen(path, "re");
    if (file == NULL) {
        return fail(path, "cannot open", error);
    }
    ssize_t length = getline(&line, &room, file);
    *head = length > 0 ? json_loadb(line, (size_t)length, JSON_REJECT_DUPLICATES, NULL)
                       : NULL;
    free(line);
    if (*head == NULL) {
        return ctl_error_set(error, PCCD_E_FORMAT, "%s: its first line is no JSON", path);
    }
    long first = ftell(file);
    if (!has_verdict(file)) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s has no verdict at its end: its check has not ended",
                             path);
    }
    lines->number = 1;
    return fseek(file, first, SEEK_SET) == 0 ? PCCD_OK : fail(path, "cannot read", error);
}

static const char *text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return tool_shown(text != NULL ? text : "");
}

static void different_file(struct check_lines *lines, const json_t *expected,
                           const json_t *input)
{
    lines->different++;
    printf("different  %s: was %s with %" JSON_INTEGER_FORMAT
           " bytes, hash %s; has %" JSON_INTEGER_FORMAT " bytes, hash %s\n",
           text_of(input, "file"), text_of(expected, "file"),
           json_integer_value(json_object_get(expected, "bytes")),
           text_of(expected, "xxh128"),
           json_integer_value(json_object_get(input, "bytes")), text_of(input, "xxh128"));
}

void check_lines_compare_heads(struct check_lines *lines, const json_t *expected,
                               const json_t *head)
{
    const json_t *old_inputs = json_object_get(expected, "inputs");
    const json_t *inputs = json_object_get(head, "inputs");
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)(uintptr_t)head, key, value)
    {
        const json_t *old = json_object_get(expected, key);
        if (strcmp(key, "version") == 0 && !json_equal(old, value)) {
            printf("note       by pccdctl %s, now %s\n", text_of(expected, key),
                   text_of(head, key));
        } else if (strcmp(key, "inputs") != 0 && !json_equal(old, value)) {
            lines->different++;
            printf("different  %s\n", key);
        }
    }
    json_object_foreach((json_t *)(uintptr_t)expected, key, value)
    {
        if (json_object_get(head, key) == NULL) {
            lines->different++;
            printf("different  %s: no check has it\n", tool_shown(key));
        }
    }
    size_t count = json_array_size(inputs), old_count = json_array_size(old_inputs);
    if (count != old_count) {
        lines->different++;
        printf("different  %zu files, and there are %zu\n", old_count, count);
    }
    for (size_t i = 0; i < count && i < old_count; i++) {
        if (!json_equal(json_array_get(old_inputs, i), json_array_get(inputs, i))) {
            different_file(lines, json_array_get(old_inputs, i),
                           json_array_get(inputs, i));
        }
    }
}
