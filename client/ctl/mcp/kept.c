/* kept.c - records and pictures that are kept, and answers that fit. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "mcp.h"
#include "output.h"
#include "pccd_types.h"
#include "shown.h"

#define ROWS_SHOWN     40u /* tried at once; then as many as fit */
#define TEXT_BYTES_MIN 16u /* texts are cut down to that; no word of an enum is longer */
#define FAILURE_BYTES  800 /* of what went wrong, before it is JSON */
#define DEPTH_MAX      5   /* of an answer */

/* ---- tables ------------------------------------------------------------------------ */

void mcp_forget(struct mcp_table *table)
{
    json_decref((json_t *)table->asked);
    json_decref(table->names);
    json_decref(table->rows);
    *table = (struct mcp_table){.handle = ""};
}

struct mcp_table *mcp_keep(struct mcp *mcp, const char *name, struct mcp_table table)
{
    struct mcp_table *to = &mcp->tables[mcp->table_count++ % MCP_TABLES_MAX];
    mcp_forget(to);
    *to = table;
    (void)json_incref((json_t *)to->asked);
    snprintf(to->handle, sizeof to->handle, "%.10s-%" PRIu64, name, mcp->table_count);
    return to;
}

int mcp_find(struct mcp *mcp, const char *handle, struct mcp_table **table,
             struct ctl_error *error)
{
    for (size_t i = 0; i < MCP_TABLES_MAX; i++) {
        *table = &mcp->tables[i];
        if (handle[0] != '\0' && strcmp((*table)->handle, handle) == 0) {
            return PCCD_OK;
        }
    }
    *table = NULL;
    const char *dash = strrchr(handle, '-');
    char *stop = NULL;
    unsigned long long number = dash != NULL ? strtoull(dash + 1, &stop, 10) : 0;
    bool was_there =
        number >= 1 && *stop == '\0' && number + MCP_TABLES_MAX <= mcp->table_count;
    return ctl_error_set(error, PCCD_E_INVAL,
                         was_there
                             ? "handle \"%.40s\" is gone: the last %u are kept; ask again"
                             : "no handle \"%.40s\": an answer gives one, as \"handle\" "
                               "or \"contacts_handle\", and the last %u are kept",
                         handle, MCP_TABLES_MAX);
}

void mcp_show_rows(json_t *answer, const struct mcp_table *table, uint64_t offset,
                   bool *ok)
{
    json_t *rows = json_array();
    for (size_t i = 0; i < ROWS_SHOWN && offset + i < json_array_size(table->rows); i++) {
        const json_t *row = json_array_get(table->rows, (size_t)offset + i);
        json_append(rows,
                    table->show != NULL ? table->show(row, table->names)
                                        : json_incref((json_t *)row),
                    ok);
    }
    json_set(answer, "handle", json_string(table->handle), ok);
    json_set_count(answer, "row_count", table->count, ok);
    json_set_count(answer, "offset", offset, ok);
    json_set(answer, "rows", rows, ok);
    if (table->count > json_array_size(table->rows)) {
        json_set_count(answer, "rows_kept", json_array_size(table->rows), ok);
    }
}

/* ---- answers ----------------------------------------------------------------------- */

char *mcp_dump(const json_t *value)
{
    return json_dumps(value, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_ENCODE_ANY |
                                 JSON_REAL_PRECISION(9));
}

/* Cut a text behind whole characters, and say so. */
static json_t *cut_text(const json_t *text, size_t bytes)
{
    char cut[512];
    const char *all = json_string_value(text);
    size_t length = bytes - 3;
    while (length > 0 && ((unsigned char)all[length] & 0xc0) == 0x80) {
        length--;
    }
    snprintf(cut, sizeof cut, "%.*s...", (int)length, all);
    return json_string(cut);
}

/* Cut all texts of an answer, a tree of our own making, to so many bytes. */
static void cut_texts(json_t *value, size_t bytes, int depth)
{
    const char *key;
    json_t *member;
    void *next;
    json_object_foreach_safe(value, next, key, member)
    {
        if (json_is_string(member) && json_string_length(member) > bytes &&
            strstr(key, "handle") == NULL && strcmp(key, "picture") != 0) {
            (void)json_object_set_new(value, key, cut_text(member, bytes));
        } else if (depth < DEPTH_MAX) {
            cut_texts(member, bytes, depth + 1);
        }
    }
    for (size_t i = 0; i < json_array_size(value); i++) {
        member = json_array_get(value, i);
        if (json_is_string(member) && json_string_length(member) > bytes) {
            (void)json_array_set_new(value, i, cut_text(member, bytes));
        } else if (depth < DEPTH_MAX) {
            cut_texts(member, bytes, depth + 1);
        }
    }
}

/* Say where the rows go on that an answer has not. */
static void set_next(json_t *answer)
{
    const json_t *rows = json_object_get(answer, "rows");
    const json_t *kept = json_object_get(answer, "rows_kept");
    json_int_t count =
        json_integer_value(kept != NULL ? kept : json_object_get(answer, "row_count"));
    json_int_t next = json_integer_value(json_object_get(answer, "offset")) +
                      (json_int_t)json_array_size(rows);
    if (rows != NULL && next < count) {
        (void)json_object_set_new(answer, "next_offset", json_integer(next));
    }
}

static json_t *result_of(json_t *answer)
{
    set_next(answer);
    char *text = mcp_dump(answer);
    json_t *result = json_pack("{s:[{s:s, s:s}], s:O}", "content", "type", "text", "text",
                               text != NULL ? text : "", "structuredContent", answer);
    const char *uri = json_string_value(json_object_get(answer, "picture"));
    if (uri != NULL) {
        (void)json_array_append_new(
            json_object_get(result, "content"),
            json_pack("{s:s, s:s, s:s, s:s}", "type", "resource_link", "uri", uri, "name",
                      uri + strlen("pccd://"), "mimeType", "image/png"));
    }
    free(text);
    return text != NULL ? result : NULL;
}

/* Make an answer shorter; false: it cannot be. */
static bool shorten(json_t *answer, size_t *text_bytes)
{
    json_t *rows = json_object_get(answer, "rows");
    size_t count = json_array_size(rows);
    if (count > 1 || (count == 1 && *text_bytes <= 64)) {
        return json_array_remove(rows, count - 1) == 0;
    }
    if (*text_bytes < TEXT_BYTES_MIN) {
        return false;
    }
    cut_texts(answer, *text_bytes, 0);
    *text_bytes /= 2;
    return true;
}

json_t *mcp_result(json_t *answer)
{
    json_t *result = NULL;
    size_t text_bytes = 256;
    for (bool goes_on = answer != NULL; goes_on;) {
        json_decref(result);
        result = result_of(answer);
        char *text = result != NULL ? mcp_dump(result) : NULL;
        goes_on = text != NULL && strlen(text) > MCP_ANSWER_BYTES &&
                  shorten(answer, &text_bytes);
        free(text);
    }
    json_decref(answer);
    return result;
}

json_t *mcp_failure(const char *text)
{
    json_t *result = NULL;
    bool is_long = true;
    for (int bytes = FAILURE_BYTES; is_long; bytes -= bytes / 4) {
        char cut[FAILURE_BYTES + 1];
        snprintf(cut, sizeof cut, "%.*s", bytes, tool_shown(text));
        json_decref(result);
        result = json_pack("{s:[{s:s, s:o}], s:b}", "content", "type", "text", "text",
                           json_text(cut), "isError", 1);
        char *dump = result != NULL ? mcp_dump(result) : NULL;
        is_long = dump != NULL && strlen(dump) > MCP_ANSWER_BYTES;
        free(dump);
    }
    return result;
}

/* ---- pictures ---------------------------------------------------------------------- */

const char *mcp_keep_picture(struct mcp *mcp, char *bytes, size_t count)
{
    if (count < 8 || count > MCP_PICTURE_BYTES || memcmp(bytes, "\x89PNG", 4) != 0) {
        free(bytes);
        return NULL;
    }
    struct mcp_picture *picture = &mcp->pictures[mcp->picture_count++ % MCP_PICTURES_MAX];
    free(picture->bytes);
    snprintf(picture->uri, sizeof picture->uri, "pccd://picture/%" PRIu64,
             mcp->picture_count);
    picture->bytes = bytes;
    picture->count = count;
    return picture->uri;
}

const struct mcp_picture *mcp_find_picture(const struct mcp *mcp, const char *uri)
{
    for (size_t i = 0; i < MCP_PICTURES_MAX; i++) {
        if (uri[0] != '\0' && strcmp(mcp->pictures[i].uri, uri) == 0) {
            return &mcp->pictures[i];
        }
    }
    return NULL;
}
