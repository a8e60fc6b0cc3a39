/* data.c - where the public scenes are, and their lists. */
#include "data.h"

#include <glob.h>
#include <gmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const struct data_scene data_scenes[DATA_SCENES] = {
    {"cloth-ball",
     {"cloth-ball/frames/cloth_ball92.ply", "cloth-ball/frames/cloth_ball93.ply"},
     {"cloth-ball/boxes/92vf.json", "cloth-ball/boxes/92ee.json"},
     {"cloth-ball/mma_bool/92vf_mma_bool.json", "cloth-ball/mma_bool/92ee_mma_bool.json"},
     {NULL, NULL}},
    {"n-body",
     {"n-body-simulation/frames/balls16_18.ply",
      "n-body-simulation/frames/balls16_19.ply"},
     {"n-body-simulation/boxes/18vf.json", "n-body-simulation/boxes/18ee.json"},
     {"n-body-simulation/mma_bool/18vf_mma_bool.json",
      "n-body-simulation/mma_bool/18ee_mma_bool.json"},
     {"n-body-simulation/queries/18vf.csv", NULL}},
    {"cloth-funnel",
     {"cloth-funnel/frames/227.ply", "cloth-funnel/frames/228.ply"},
     {"cloth-funnel/boxes/227vf.json", "cloth-funnel/boxes/227ee.json"},
     {"cloth-funnel/mma_bool/227vf_mma_bool.json",
      "cloth-funnel/mma_bool/227ee_mma_bool.json"},
     {"cloth-funnel/queries/227vf.csv", "cloth-funnel/queries/227ee.csv"}},
};

/* "/nowhere": nobody said where. */
static const char *folder(void)
{
    const char *data = getenv("PCCD_DATA");
    return data && data[0] ? data : "/nowhere";
}

bool data_find(const char *name, char path[DATA_PATH_MAX])
{
    int length = snprintf(path, DATA_PATH_MAX, "%s/%s", folder(), name);
    return length > 0 && length < DATA_PATH_MAX && access(path, R_OK) == 0;
}

/* The whole file with a zero behind it; NULL if it cannot be read. */
static char *slurp(const char *path)
{
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    long size = -1;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        size = ftell(file);
        rewind(file);
    }
    if (size >= 0) {
        text = malloc((size_t)size + 1);
    }
    if (text && fread(text, 1, (size_t)size, file) != (size_t)size) {
        free(text);
        text = NULL;
    }
    if (text) {
        text[size] = '\0';
    }
    if (file) {
        fclose(file);
    }
    return text;
}

static size_t count_of(const char *text, char wanted)
{
    size_t count = 0;
    for (; *text; text++) {
        count += *text == wanted;
    }
    return count;
}

static bool parse_pairs(const char *ids, const char *truth, struct data_pairs *pairs)
{
    size_t capacity = count_of(ids, '[');
    pairs->ids = calloc(capacity + 1, sizeof *pairs->ids);
    pairs->truth = calloc(capacity + 1, sizeof *pairs->truth);
    if (!pairs->ids || !pairs->truth) {
        return false;
    }
    size_t numbers = 0;
    for (const char *at = strpbrk(ids, "0123456789"); at;
         at = strpbrk(at, "0123456789")) {
        char *end;
        if (numbers == 2 * capacity) {
            return false;
        }
        pairs->ids[numbers / 2][numbers % 2] = (uint32_t)strtoul(at, &end, 10);
        numbers++;
        at = end;
    }
    pairs->count = numbers / 2;
    size_t truths = 0;
    for (const char *at = strpbrk(truth, "tf"); at; at = strpbrk(at, "tf")) {
        bool hits = strncmp(at, "true", 4) == 0;
        if (truths == pairs->count || (!hits && strncmp(at, "false", 5) != 0)) {
            return false;
        }
        pairs->truth[truths++] = hits;
        at += hits ? 4 : 5;
    }
    return truths == pairs->count && numbers % 2 == 0;
}

bool data_pairs_read(const char *ids_path, const char *truth_path,
                     struct data_pairs *pairs)
{
    char *ids = slurp(ids_path);
    char *truth = slurp(truth_path);
    memset(pairs, 0, sizeof *pairs);
    bool good = ids && truth && parse_pairs(ids, truth, pairs);
    if (!good) {
        fprintf(stderr, "# %s: not a list of pairs\n", ids_path);
        data_pairs_deinit(pairs);
    }
    free(ids);
    free(truth);
    return good;
}

void data_pairs_deinit(struct data_pairs *pairs)
{
    free(pairs->ids);
    free(pairs->truth);
    memset(pairs, 0, sizeof *pairs);
}

/* One integer and the separator behind it. */
static bool parse_integer(char **at, mpz_t value)
{
    size_t length = strspn(*at, "-0123456789");
    char separator = (*at)[length];
    (*at)[length] = '\0';
    bool good = mpz_set_str(value, *at, 10) == 0;
    (*at)[length] = separator;
    *at += length + (separator != '\0');
    return good;
}

/* One row; the truth column stays -1 where there is none. */
static bool parse_row(char **at, double x[3], int *truth)
{
    bool good = true;
    mpq_t value;
    mpq_t back;
    mpq_inits(value, back, NULL);
    for (int k = 0; k < 3 && good; k++) {
        good = parse_integer(at, mpq_numref(value)) &&
               parse_integer(at, mpq_denref(value)) && mpz_sgn(mpq_denref(value)) > 0;
        if (good) {
            mpq_canonicalize(value);
            x[k] = mpq_get_d(value);
            mpq_set_d(back, x[k]);
            good = mpq_equal(value, back) != 0;
        }
    }
    if (good && (*at)[-1] == ',') {
        *truth = **at == '1';
        *at += 1;
        *at += strspn(*at, "\r\n");
    }
    mpq_clears(value, back, NULL);
    return good;
}

bool data_queries_read(const char *path, struct data_queries *queries)
{
    char *text = slurp(path);
    bool good = text != NULL;
    memset(queries, 0, sizeof *queries);
    if (good) {
        size_t rows = count_of(text, '\n') + 1;
        queries->p = calloc(rows / 8 + 1, sizeof *queries->p);
        queries->truth = calloc(rows / 8 + 1, sizeof *queries->truth);
        good = queries->p && queries->truth;
    }
    for (char *at = text; good && *at;) {
        int truth = -1;
        for (int row = 0; row < 8 && good; row++) {
            good = parse_row(&at, queries->p[queries->count][row], &truth);
        }
        queries->has_truth = truth >= 0;
        queries->truth[queries->count] = truth == 1;
        queries->count += good;
    }
    if (!good) {
        fprintf(stderr, "# %s: not a list of queries\n", path);
        data_queries_deinit(queries);
    }
    free(text);
    return good;
}

void data_queries_deinit(struct data_queries *queries)
{
    free(queries->p);
    free(queries->truth);
    memset(queries, 0, sizeof *queries);
}

size_t data_handmade(data_use_t *use, void *context)
{
    char pattern[DATA_PATH_MAX + 64];
    glob_t found;
    size_t files = 0;
    snprintf(pattern, sizeof pattern, "%s/queries-handmade/*/*/*.csv", folder());
    if (glob(pattern, 0, NULL, &found) != 0) {
        return 0;
    }
    for (size_t i = 0; i < found.gl_pathc; i++) {
        struct data_queries queries;
        const char *path = found.gl_pathv[i];
        if (data_queries_read(path, &queries)) {
            use(context, strstr(path, "/vertex-face/") != NULL, path, &queries);
            files++;
        }
        data_queries_deinit(&queries);
    }
    globfree(&found);
    return files;
}
