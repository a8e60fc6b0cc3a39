/* sequence.c - files by the numbers in their names. */
#include "sequence.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "confined.h"
#include "ctl.h"
#include "pccd_types.h"

#define FILES_MAX  ((uint32_t)1 << 20)
#define DIGITS_MAX 18 /* of a number in a name */

/* State of a file by which a change is noticed; {0}: it cannot be looked at. */
struct ctl_stamp {
    uint64_t device, inode, bytes;
    struct timespec changed;
};

/* A name around its %d. */
struct pattern {
    const char *name;
    const char *file; /* behind its last slash */
    size_t head_length;
    const char *tail; /* behind the %d */
    int width;        /* digits at least */
};

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the names of the frames");
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Return where a %d or %0Nd ends that begins here; NULL: here is none. */
static const char *end_of_conversion(const char *at, int *width)
{
    *width = 1;
    if (at[0] != '%') {
        return NULL;
    }
    at++;
    if (at[0] == '0' && at[1] >= '1' && at[1] <= '9') {
        *width = at[1] - '0';
        at += 2;
        if (is_digit(at[0])) {
            *width = 10 * *width + at[0] - '0';
            at++;
        }
    }
    return at[0] == 'd' ? at + 1 : NULL;
}

static bool find_pattern(const char *name, struct pattern *pattern)
{
    const char *slash = strrchr(name, '/');
    uint32_t found = 0;
    *pattern = (struct pattern){.name = name, .file = slash != NULL ? slash + 1 : name};
    for (const char *at = pattern->file; *at != '\0'; at++) {
        int width;
        const char *end = end_of_conversion(at, &width);
        if (end != NULL) {
            found++;
            pattern->head_length = (size_t)(at - pattern->file);
            pattern->tail = end;
            pattern->width = width;
        }
    }
    return found == 1 && access(name, F_OK) != 0;
}

bool ctl_sequence_is_pattern(const char *name)
{
    struct pattern pattern;
    return find_pattern(name, &pattern);
}

/* ---- the files of a pattern -------------------------------------------------------- */

struct numbers {
    uint64_t *of;
    uint32_t count, capacity;
    char near[64]; /* a file that differs by the zeros before its number alone */
};

/* The number of a file of the pattern; with other zeros it is none, but `near`. */
static bool is_of(const struct pattern *pattern, const char *file,
                  struct numbers *numbers, uint64_t *number)
{
    size_t length = strlen(file), tail_length = strlen(pattern->tail);
    if (length <= pattern->head_length + tail_length ||
        strncmp(file, pattern->file, pattern->head_length) != 0 ||
        strcmp(file + length - tail_length, pattern->tail) != 0) {
        return false;
    }
    const char *digits = file + pattern->head_length;
    size_t count = length - pattern->head_length - tail_length;
    *number = 0;
    for (size_t i = 0; i < count; i++) {
        if (!is_digit(digits[i]) || count > DIGITS_MAX) {
            return false;
        }
        *number = 10 * *number + (uint64_t)(digits[i] - '0');
    }
    bool is_one = count == (size_t)pattern->width ||
                  (count > (size_t)pattern->width && digits[0] != '0');
    if (!is_one) {
        (void)snprintf(numbers->near, sizeof numbers->near, "%.60s", file);
    }
    return is_one;
}

static int add_number(struct numbers *numbers, uint64_t number, const char *name,
                      struct ctl_error *error)
{
    if (numbers->count == FILES_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: more than %" PRIu32 " files", name,
                             FILES_MAX);
    }
    if (numbers->count == numbers->capacity) {
        uint32_t capacity = numbers->capacity > 0 ? 2 * numbers->capacity : 64;
        uint64_t *grown = realloc(numbers->of, capacity * sizeof *grown);
        if (grown == NULL) {
            return no_memory(error);
        }
        numbers->of = grown;
        numbers->capacity = capacity;
    }
    numbers->of[numbers->count++] = number;
    return PCCD_OK;
}

static int list_numbers(const struct pattern *pattern, struct numbers *numbers,
                        struct ctl_error *error)
{
    size_t length = (size_t)(pattern->file - pattern->name);
    char *folder = length > 0 ? strndup(pattern->name, length) : strdup(".");
    int fd = folder != NULL ? tool_open(folder) : -1;
    DIR *entries = fd >= 0 ? fdopendir(fd) : NULL;
    int status = folder == NULL ? no_memory(error) : PCCD_OK;
    if (status == PCCD_OK && entries == NULL) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot read the folder: %s",
                               pattern->name, tool_why(errno));
        if (fd >= 0) {
            (void)close(fd);
        }
    }
    while (status == PCCD_OK) {
        const struct dirent *entry = readdir(entries);
        uint64_t number;
        if (entry == NULL) {
            break;
        }
        if (is_of(pattern, entry->d_name, numbers, &number)) {
            status = add_number(numbers, number, pattern->name, error);
        }
    }
    if (entries != NULL) {
        (void)closedir(entries);
    }
    free(folder);
    return status;
}

static int compare_numbers(const void *a, const void *b)
{
    const uint64_t *left = a, *right = b;
    return *left < *right ? -1 : *left > *right;
}

/* Sorted numbers: there is one, and none is missing between them. */
static int judge_numbers(const struct pattern *pattern, const struct numbers *numbers,
                         struct ctl_error *error)
{
    if (numbers->count == 0) {
        return ctl_error_set(
            error, PCCD_E_INVAL, "%s: no file has such a name with a number%s%s%s",
            pattern->name, numbers->near[0] != '\0' ? "; " : "", numbers->near,
            numbers->near[0] != '\0'
                ? " has other zeros: %0Nd is N digits at least, %d as "
                  "many as it takes"
                : "");
    }
    for (uint32_t i = 1; i < numbers->count; i++) {
        if (numbers->of[i] != numbers->of[i - 1] + 1) {
            return ctl_error_set(error, PCCD_E_INVAL,
                                 "%s: number %" PRIu64 " is missing: there are %" PRIu64
                                 " and %" PRIu64,
                                 pattern->name, numbers->of[i - 1] + 1,
                                 numbers->of[i - 1], numbers->of[i]);
        }
    }
    return PCCD_OK;
}

/* ---- warnings ---------------------------------------------------------------------- */

/* The first one stays. */
__attribute__((format(printf, 3, 4))) static int
warn(struct ctl_sequence *sequence, struct ctl_error *error, const char *format, ...)
{
    struct ctl_error text;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text.text, sizeof text.text, format, arguments);
    va_end(arguments);
    if (sequence->warning == NULL) {
        sequence->warning = strdup(text.text);
    }
    return sequence->warning != NULL ? PCCD_OK : no_memory(error);
}

/* ---- the list ---------------------------------------------------------------------- */

static int reserve(struct ctl_sequence *sequence, uint32_t more, struct ctl_error *error)
{
    size_t count = (size_t)sequence->count + more;
    char **grown = realloc(sequence->paths, count * sizeof *grown);
    if (grown == NULL) {
        return no_memory(error);
    }
    sequence->paths = grown;
    return PCCD_OK;
}

static int expand(struct ctl_sequence *sequence, const struct pattern *pattern,
                  struct ctl_error *error)
{
    struct numbers numbers = {.count = 0};
    int head_length = (int)(pattern->file - pattern->name) + (int)pattern->head_length;
    int status = list_numbers(pattern, &numbers, error);
    if (status == PCCD_OK && numbers.count > 0) {
        qsort(numbers.of, numbers.count, sizeof *numbers.of, compare_numbers);
    }
    if (status == PCCD_OK) {
        status = judge_numbers(pattern, &numbers, error);
    }
    if (status == PCCD_OK && numbers.near[0] != '\0') {
        status = warn(sequence, error, "%s leaves out %s, which has other zeros",
                      pattern->name, numbers.near);
    }
    if (status == PCCD_OK) {
        status = reserve(sequence, numbers.count, error);
    }
    for (uint32_t i = 0; i < numbers.count && status == PCCD_OK; i++) {
        size_t bytes = strlen(pattern->name) + 128;
        char *path = malloc(bytes);
        if (path == NULL) {
            status = no_memory(error);
            break;
        }
        (void)snprintf(path, bytes, "%.*s%0*" PRIu64 "%s", head_length, pattern->name,
                       pattern->width, numbers.of[i], pattern->tail);
        sequence->paths[sequence->count++] = path;
    }
    free(numbers.of);
    return status;
}

static int add_name(struct ctl_sequence *sequence, const char *name,
                    struct ctl_error *error)
{
    int status = reserve(sequence, 1, error);
    char *path = status == PCCD_OK ? strdup(name) : NULL;
    if (path == NULL) {
        return no_memory(error);
    }
    sequence->paths[sequence->count++] = path;
    return PCCD_OK;
}

/* ---- order ------------------------------------------------------------------------- */

/* Return whether two names differ by their numbers alone, and the first that differs is
 * less in b. */
static bool goes_down(const char *a, const char *b)
{
    int order = 0; /* below 0: a comes first */
    while (*a != '\0' && *b != '\0') {
        if (!is_digit(*a) || !is_digit(*b)) {
            if (*a++ != *b++) {
                return false;
            }
            continue;
        }
        a += strspn(a, "0");
        b += strspn(b, "0");
        size_t length_a = strspn(a, "0123456789"), length_b = strspn(b, "0123456789");
        if (order == 0) {
            order = length_a != length_b ? (length_a < length_b ? -1 : 1)
                                         : strncmp(a, b, length_a);
        }
        a += length_a;
        b += length_b;
    }
    return order > 0 && *a == *b;
}

/* Return whether a file was named before: who names it twice has chosen the order. */
static bool was_named(const struct ctl_sequence *sequence, uint32_t before,
                      const char *path)
{
    for (uint32_t i = 0; i < before; i++) {
        if (strcmp(sequence->paths[i], path) == 0) {
            return true;
        }
    }
    return false;
}

static int judge_order(struct ctl_sequence *sequence, struct ctl_error *error)
{
    char *const *paths = sequence->paths;
    for (uint32_t i = 1; i < sequence->count; i++) {
        if (goes_down(paths[i - 1], paths[i]) && !was_named(sequence, i, paths[i]) &&
            strncmp(paths[i], "/dev/fd/", 8) != 0) { /* the shell numbers these */
            return warn(sequence, error,
                        "%s comes after %s, as they were named; by their numbers it "
                        "comes before. A name with %%d takes files by their numbers, as "
                        "seq%%d.obj",
                        paths[i], paths[i - 1]);
        }
    }
    return PCCD_OK;
}

/* ---- all of it --------------------------------------------------------------------- */

static struct ctl_stamp stamp_of(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0
               ? (struct ctl_stamp){info.st_dev, info.st_ino, (uint64_t)info.st_size,
                                    info.st_mtim}
               : (struct ctl_stamp){.bytes = 0};
}

int ctl_sequence_expand(struct ctl_sequence *sequence, char *const *names, uint32_t count,
                        struct ctl_error *error)
{
    int status = PCCD_OK;
    *sequence = (struct ctl_sequence){.count = 0};
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        struct pattern pattern;
        status = find_pattern(names[i], &pattern) ? expand(sequence, &pattern, error)
                                                  : add_name(sequence, names[i], error);
    }
    sequence->stamps = calloc((size_t)sequence->count + 1, sizeof *sequence->stamps);
    if (status == PCCD_OK && sequence->stamps == NULL) {
        status = no_memory(error);
    }
    for (uint32_t i = 0; i < sequence->count && status == PCCD_OK; i++) {
        sequence->stamps[i] = stamp_of(sequence->paths[i]);
    }
    return status == PCCD_OK ? judge_order(sequence, error) : status;
}

const char *ctl_sequence_changed(const struct ctl_sequence *sequence)
{
    for (uint32_t i = 0; i < sequence->count; i++) {
        const struct ctl_stamp *was = &sequence->stamps[i];
        const struct ctl_stamp is = stamp_of(sequence->paths[i]);
        if (is.device != was->device || is.inode != was->inode ||
            is.bytes != was->bytes || is.changed.tv_sec != was->changed.tv_sec ||
            is.changed.tv_nsec != was->changed.tv_nsec) {
            return sequence->paths[i];
        }
    }
    return NULL;
}

void ctl_sequence_warn(const struct ctl_sequence *sequence)
{
    if (sequence->warning != NULL) {
        (void)ctl_complain("warning: %s", sequence->warning);
    }
}

void ctl_sequence_deinit(struct ctl_sequence *sequence)
{
    for (uint32_t i = 0; i < sequence->count; i++) {
        free(sequence->paths[i]);
    }
    free(sequence->paths);
    free(sequence->stamps);
    free(sequence->warning);
    *sequence = (struct ctl_sequence){.count = 0};
}
