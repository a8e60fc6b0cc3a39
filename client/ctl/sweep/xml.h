/* xml.h - an XML file as a tree of elements, each with its line.
 *
 * What is wrong is told once, with the line: the first text is in `error`, its status in
 * `status`. Who goes on to use what was read looks there.
 */
#ifndef CTL_XML_H
#define CTL_XML_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"

struct xml_element {
    const char *name;
    const char **attributes; /* name, value, ..., NULL */
    uint32_t line;
    struct xml_element *child, *next; /* the first; the next of the same parent */
    struct xml_element *parent, *last, *older; /* of the reader */
};

/* Fill with {0}. */
struct xml {
    const char *path;        /* the caller's */
    struct ctl_error *error; /* the caller's */
    int status;
    struct xml_element *root, *newest;
};

/* Read a file; text between elements is left out. xml_close's to give back, also on
 * error. Errors: E_SYSTEM, E_NOMEM; E_FORMAT: no XML, a DOCTYPE, elements deeper than 64
 * or more than a million; E_VERSION: this pccdctl was built without expat. */
int xml_open(struct xml *xml, const char *path, struct ctl_error *error);
void xml_close(struct xml *xml);

/* Refuse what an element says: E_FORMAT, with path and line. The first text stays. */
void xml_refuse(struct xml *xml, const struct xml_element *of, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Return the next element of that name from `from` on, which may be NULL, or NULL. */
const struct xml_element *xml_find(const struct xml_element *from, const char *name);
/* Return an attribute; NULL: there is none. */
const char *xml_text(const struct xml_element *of, const char *name);
/* Fill values[count] from an attribute of `count` finite decimal numbers with blanks
 * between them; they stay as they are where there is none. `whose` names in the error
 * what it belongs to, as "link \"arm\"". Returns whether there was one. */
bool xml_numbers(struct xml *xml, const struct xml_element *of, const char *name,
                 uint32_t count, double *values, const char *whose);

#endif
