/* fields.c - what tools take and tell: schemas, checks, command lines. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "confined.h"
#include "mcp.h"
#include "option_table.h"
#include "output.h"
#include "pccd_types.h"

#define TEXT_BYTES_MAX 4095u /* of a name or text that is asked with */
#define TEXTS_MAX      1024u

static const struct mcp_field *field_of(const struct mcp_field *fields, const char *name)
{
    while (fields->name != NULL && strcmp(fields->name, name) != 0) {
        fields++;
    }
    return fields;
}

/* ---- schemas ----------------------------------------------------------------------- */

static json_t *list_of(json_t *items)
{
    return json_pack("{s:s, s:o}", "type", "array", "items", items);
}

static json_t *words_of(const char *words)
{
    json_t *list = json_array();
    while (*words != '\0') {
        size_t bytes = strcspn(words, "|");
        (void)json_array_append_new(list, json_stringn(words, bytes));
        words += bytes + (words[bytes] == '|');
    }
    return json_pack("{s:s, s:o}", "type", "string", "enum", list);
}

static json_t *number_of(const struct mcp_field *field, bool is_asked)
{
    bool is_whole = field->form == MCP_WHOLE, ok = true;
    json_t *schema = json_pack("{s:s}", "type", is_whole ? "integer" : "number");
    if (is_asked) {
        json_set(schema, "minimum",
                 is_whole ? json_integer((json_int_t)field->min) : json_real(field->min),
                 &ok);
        json_set(schema, "maximum",
                 is_whole ? json_integer((json_int_t)field->max) : json_real(field->max),
                 &ok);
    }
    return schema;
}

static json_t *schema_of(const struct mcp_field *field, bool is_asked)
{
    switch (field->form) {
    case MCP_TEXT:
    case MCP_FILE:
        return json_pack("{s:s}", "type", "string");
    case MCP_TEXTS:
    case MCP_FILES:
        return list_of(json_pack("{s:s}", "type", "string"));
    case MCP_WORD:
        return words_of(field->words);
    case MCP_REAL:
    case MCP_WHOLE:
        return number_of(field, is_asked);
    case MCP_TRUTH:
        return json_pack("{s:s}", "type", "boolean");
    case MCP_REALS:
        return list_of(json_pack("{s:s}", "type", "number"));
    case MCP_POINTS:
        return list_of(list_of(json_pack("{s:s}", "type", "number")));
    case MCP_OBJECT:
        return field->of != NULL ? mcp_fields_schema(field->of, is_asked)
                                 : json_pack("{s:s}", "type", "object");
    case MCP_ROWS:
        return list_of(field->of != NULL ? mcp_fields_schema(field->of, is_asked)
                                         : json_pack("{s:s}", "type", "object"));
    }
    return NULL;
}

/* Tables have tables in them, two deep. */
json_t *mcp_fields_schema(const struct mcp_field *fields, bool is_asked)
{
    bool ok = true;
    json_t *properties = json_object(), *needed = json_array();
    for (; fields->name != NULL; fields++) {
        json_t *schema = schema_of(fields, is_asked);
        json_set(schema, "description", json_string(fields->meaning), &ok);
        json_set(properties, fields->name, schema, &ok);
        if (fields->is_needed) {
            json_append(needed, json_string(fields->name), &ok);
        }
    }
    json_t *all = json_pack("{s:s, s:o, s:o, s:b}", "type", "object", "properties",
                            properties, "required", needed, "additionalProperties", 0);
    if (!ok) {
        json_decref(all);
    }
    return ok ? all : NULL;
}

/* ---- checks ------------------------------------------------------------------------ */

static int check_file(const struct mcp_field *field, const char *name,
                      struct ctl_error *error)
{
    int why = tool_is_outside(name, false);
    if (why == 0 || why == ENOENT || why == ENOTDIR) {
        return PCCD_OK; /* the reader says what is not there, or it is a pattern */
    }
    return ctl_error_set(error, PCCD_E_INVAL, "\"%s\": \"%.700s\": %s", field->name, name,
                         tool_why(why));
}

static int check_text(const struct mcp_field *field, const json_t *value,
                      struct ctl_error *error)
{
    bool is_file = field->form == MCP_FILE || field->form == MCP_FILES;
    size_t bytes = json_string_length(value);
    if (!json_is_string(value) || bytes > TEXT_BYTES_MAX || (is_file && bytes == 0)) {
        return ctl_error_set(
            error, PCCD_E_INVAL, "\"%s\" is no text%s of 1 to %u bytes", field->name,
            field->form == MCP_TEXTS || field->form == MCP_FILES ? ", or list of texts,"
                                                                 : "",
            TEXT_BYTES_MAX);
    }
    return is_file ? check_file(field, json_string_value(value), error) : PCCD_OK;
}

static int check_texts(const struct mcp_field *field, const json_t *value,
                       struct ctl_error *error)
{
    int status = PCCD_OK;
    if (!json_is_array(value)) {
        return check_text(field, value, error);
    }
    if (json_array_size(value) < 1 || json_array_size(value) > TEXTS_MAX) {
        return ctl_error_set(error, PCCD_E_INVAL, "\"%s\" has %zu elements, not 1 to %u",
                             field->name, json_array_size(value), TEXTS_MAX);
    }
    for (size_t i = 0; i < json_array_size(value) && status == PCCD_OK; i++) {
        status = check_text(field, json_array_get(value, i), error);
    }
    return status;
}

static int check_word(const struct mcp_field *field, const json_t *value,
                      struct ctl_error *error)
{
    const char *word = json_is_string(value) ? json_string_value(value) : "";
    size_t length = strlen(word);
    for (const char *at = field->words; length > 0 && *at != '\0';) {
        size_t bytes = strcspn(at, "|");
        if (bytes == length && memcmp(at, word, bytes) == 0) {
            return PCCD_OK;
        }
        at += bytes + (at[bytes] == '|');
    }
    return ctl_error_set(error, PCCD_E_INVAL, "\"%s\" is one of %s", field->name,
                         field->words);
}

static int check_number(const struct mcp_field *field, const json_t *value,
                        struct ctl_error *error)
{
    bool is_whole = field->form == MCP_WHOLE;
    double number = json_number_value(value);
    bool is_right = (is_whole ? json_is_integer(value) : json_is_number(value)) &&
                    number >= field->min && number <= field->max;
    return is_right ? PCCD_OK
                    : ctl_error_set(error, PCCD_E_INVAL, "\"%s\" is no %s from %g to %g",
                                    field->name, is_whole ? "whole number" : "number",
                                    field->min, field->max);
}

static int check_value(const struct mcp_field *field, const json_t *value,
                       struct ctl_error *error)
{
    switch (field->form) {
    case MCP_TEXT:
    case MCP_FILE:
        return check_text(field, value, error);
    case MCP_TEXTS:
    case MCP_FILES:
        return check_texts(field, value, error);
    case MCP_WORD:
        return check_word(field, value, error);
    case MCP_REAL:
    case MCP_WHOLE:
        return check_number(field, value, error);
    default:
        return json_is_boolean(value)
                   ? PCCD_OK
                   : ctl_error_set(error, PCCD_E_INVAL, "\"%s\" is true or false",
                                   field->name);
    }
}

/* "files, with, mode" */
static const char *name_all(const struct mcp_field *fields, char *names, size_t bytes)
{
    size_t used = 0;
    names[0] = '\0';
    for (; fields->name != NULL && used < bytes; fields++) {
        used += (size_t)snprintf(names + used, bytes - used, "%s%s", used > 0 ? ", " : "",
                                 fields->name);
    }
    return names;
}

int mcp_fields_check(const struct mcp_field *fields, const json_t *asked,
                     struct ctl_error *error)
{
    char names[512];
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)asked, key, value)
    {
        const struct mcp_field *field = field_of(fields, key);
        if (field->name == NULL) {
            return ctl_error_set(error, PCCD_E_INVAL,
                                 "no argument \"%.100s\"; there are %s", key,
                                 name_all(fields, names, sizeof names));
        }
        int status = check_value(field, value, error);
        if (status != PCCD_OK) {
            return status;
        }
    }
    for (; fields->name != NULL; fields++) {
        if (fields->is_needed && json_object_get(asked, fields->name) == NULL) {
            return ctl_error_set(error, PCCD_E_INVAL, "\"%s\" is missing: %s",
                                 fields->name, fields->meaning);
        }
    }
    return PCCD_OK;
}

/* ---- command lines ----------------------------------------------------------------- */

static void add_value(struct mcp_job *job, const struct mcp_field *field,
                      const json_t *value)
{
    const char *option = field->option;
    if (json_is_boolean(value)) {
        size_t bytes = strcspn(option, "|");
        const char *other = option + bytes + (option[bytes] == '|');
        if (json_is_true(value) ? bytes > 0 : *other != '\0') {
            mcp_job_add(job, "%.*s", json_is_true(value) ? (int)bytes : INT_MAX,
                        json_is_true(value) ? option : other);
        }
    } else if (json_is_string(value)) {
        const char *text = json_string_value(value);
        bool is_file = field->form == MCP_FILE || field->form == MCP_FILES;
        mcp_job_add(job, "%s%s%s", option, option[0] != '\0' ? "=" : "",
                    is_file ? tool_from_folder(text) : text);
    } else if (json_is_integer(value)) {
        mcp_job_add(job, "%s=%" JSON_INTEGER_FORMAT, option, json_integer_value(value));
    } else {
        mcp_job_add(job, "%s=%.17g", option, json_real_value(value));
    }
}

static void add_field(struct mcp_job *job, const struct mcp_field *field,
                      const json_t *asked)
{
    const json_t *value = json_object_get(asked, field->name);
    if (value == NULL) {
        return;
    }
    for (size_t i = 0; i < json_array_size(value); i++) {
        add_value(job, field, json_array_get(value, i));
    }
    if (!json_is_array(value)) {
        add_value(job, field, value);
    }
}

void mcp_job_add_fields(struct mcp_job *job, const struct mcp_field *fields,
                        const json_t *asked)
{
    for (const struct mcp_field *field = fields; field->name != NULL; field++) {
        if (field->option != NULL && field->option[0] != '\0') {
            add_field(job, field, asked);
        }
    }
    mcp_job_add(job, "--"); /* a file may be called as an option is */
    for (const struct mcp_field *field = fields; field->name != NULL; field++) {
        if (field->option != NULL && field->option[0] == '\0') {
            add_field(job, field, asked);
        }
    }
}
