/* xml.c - reads XML by expat. */
#include "xml.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAVE_EXPAT
#include <expat.h>
#endif

#include "pccd_types.h"
#include "shown.h"
#include "text.h"

#define DEPTH_MAX    64u
#define ELEMENTS_MAX 1000000u

#ifdef HAVE_EXPAT
/* State while expat goes through a file. */
struct reading {
    struct xml *xml;
    XML_Parser parser;
    struct xml_element *open; /* the innermost element */
    uint32_t depth, count;
};

/* Copy an element's name and attributes behind it. */
static struct xml_element *copy(const char *name, const char **attributes)
{
    size_t count = 0, bytes = strlen(name) + 1;
    for (; attributes[count] != NULL; count++) {
        bytes += strlen(attributes[count]) + 1;
    }
    struct xml_element *made =
        calloc(1, sizeof *made + (count + 1) * sizeof *made->attributes + bytes);
    if (made == NULL) {
        return NULL;
    }
    made->attributes = (const char **)(made + 1);
    char *text = (char *)(made->attributes + count + 1);
    made->name = strcpy(text, name);
    for (size_t i = 0; i < count; i++) {
        text += strlen(text) + 1;
        made->attributes[i] = strcpy(text, attributes[i]);
    }
    return made;
}

static void stop(struct reading *reading, int status, const char *what)
{
    struct xml *xml = reading->xml;
    xml->status = ctl_error_set(xml->error, status, "%s:%lu: %s", xml->path,
                                XML_GetCurrentLineNumber(reading->parser), what);
    (void)XML_StopParser(reading->parser, XML_FALSE);
}

static void begin_element(void *context, const char *name, const char **attributes)
{
    struct reading *reading = context;
    if (reading->xml->status != PCCD_OK) {
        return;
    }
    if (reading->depth == DEPTH_MAX || reading->count == ELEMENTS_MAX) {
        stop(reading, PCCD_E_FORMAT, "too many elements, or too deep in each other");
        return;
    }
    struct xml_element *made = copy(name, attributes);
    if (made == NULL) {
        stop(reading, PCCD_E_NOMEM, "out of memory");
        return;
    }
    struct xml_element *parent = reading->open;
    made->line = (uint32_t)XML_GetCurrentLineNumber(reading->parser);
    made->parent = parent;
    made->older = reading->xml->newest;
    reading->xml->newest = made;
    if (parent == NULL) {
        reading->xml->root = made;
    } else if (parent->last == NULL) {
        parent->child = made;
    } else {
        parent->last->next = made;
    }
    if (parent != NULL) {
        parent->last = made;
    }
    reading->open = made;
    reading->depth++;
    reading->count++;
}

static void end_element(void *context, const char *name)
{
    struct reading *reading = context;
    (void)name;
    if (reading->xml->status == PCCD_OK) {
        reading->open = reading->open->parent;
        reading->depth--;
    }
}

static void begin_doctype(void *context, const char *name, const char *system,
                          const char *public, int has_subset)
{
    (void)name;
    (void)system;
    (void)public;
    (void)has_subset;
    stop(context, PCCD_E_FORMAT, "a DOCTYPE, which no URDF and no SRDF has");
}

static void parse(struct xml *xml, const struct ctl_file *file)
{
    struct reading reading = {.xml = xml, .parser = XML_ParserCreate(NULL)};
    if (reading.parser == NULL || file->bytes > INT32_MAX) {
        xml->status =
            ctl_error_set(xml->error, PCCD_E_NOMEM, "%s: no memory for it", xml->path);
    } else {
        XML_SetUserData(reading.parser, &reading);
        XML_SetElementHandler(reading.parser, begin_element, end_element);
        XML_SetStartDoctypeDeclHandler(reading.parser, begin_doctype);
        if (XML_Parse(reading.parser, file->data, (int)file->bytes, 1) != XML_STATUS_OK &&
            xml->status == PCCD_OK) {
            stop(&reading, PCCD_E_FORMAT,
                 XML_ErrorString(XML_GetErrorCode(reading.parser)));
        }
    }
    if (reading.parser != NULL) {
        XML_ParserFree(reading.parser);
    }
}
#else
static void parse(struct xml *xml, const struct ctl_file *file)
{
    (void)file;
    xml->status =
        ctl_error_set(xml->error, PCCD_E_VERSION,
                      "%s: this pccdctl was built without expat (libexpat1-dev), which "
                      "reads URDF and SRDF; a scene file can have joints, too",
                      xml->path);
}
#endif

int xml_open(struct xml *xml, const char *path, struct ctl_error *error)
{
    struct ctl_file file = {.data = NULL};
    *xml = (struct xml){.path = path, .error = error};
    xml->status = ctl_file_open(path, &file, error);
    if (xml->status == PCCD_OK) {
        xml->status = ctl_file_load(&file, error);
    }
    if (xml->status == PCCD_OK) {
        parse(xml, &file);
    }
    ctl_file_deinit(&file);
    return xml->status;
}

void xml_close(struct xml *xml)
{
    while (xml->newest != NULL) {
        struct xml_element *gone = xml->newest;
        xml->newest = gone->older;
        free(gone);
    }
    xml->root = NULL;
}

void xml_refuse(struct xml *xml, const struct xml_element *of, const char *format, ...)
{
    char what[CTL_ERROR_TEXT_BYTES];
    va_list arguments;
    if (xml->status != PCCD_OK) {
        return;
    }
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    xml->status = ctl_error_set(xml->error, PCCD_E_FORMAT, "%s:%" PRIu32 ": %.700s",
                                xml->path, of->line, what);
}

const struct xml_element *xml_find(const struct xml_element *from, const char *name)
{
    while (from != NULL && strcmp(from->name, name) != 0) {
        from = from->next;
    }
    return from;
}

const char *xml_text(const struct xml_element *of, const char *name)
{
    const char **at = of->attributes;
    while (at[0] != NULL && strcmp(at[0], name) != 0) {
        at += 2;
    }
    return at[0] != NULL ? at[1] : NULL;
}

bool xml_numbers(struct xml *xml, const struct xml_element *of, const char *name,
                 uint32_t count, double *values, const char *whose)
{
    const char *text = xml_text(of, name);
    struct ctl_word rest = {text, text != NULL ? text + strlen(text) : NULL}, word;
    double found[4];
    uint32_t given = 0;
    if (text == NULL) {
        return false;
    }
    for (; ctl_word_next(&rest, &word); given++) {
        double value = NAN;
        if (!ctl_word_double(&word, &value) || !isfinite(value)) {
            xml_refuse(xml, of, "%s: %s=\"%s\" of <%s>: \"%.*s\" is no finite number",
                       whose, name, tool_shown(text), of->name, CTL_QUOTE(word));
            return true;
        }
        if (given < count) {
            found[given] = value;
        }
    }
    if (given != count) {
        xml_refuse(xml, of,
                   "%s: %s=\"%s\" of <%s> has %" PRIu32 " of %" PRIu32 " numbers", whose,
                   name, tool_shown(text), of->name, given, count);
        return true;
    }
    memcpy(values, found, count * sizeof *values);
    return true;
}
