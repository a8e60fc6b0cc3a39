/* client/ctl/inspect/page_template.h - the HTML page of `pccdctl inspect`, without data.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     hold what client/inspect/ was bundled into when this program was built.
 * Does not: fill it (page_file.h).
 * Threads:  [any].
 */
#ifndef CTL_PAGE_TEMPLATE_H
#define CTL_PAGE_TEMPLATE_H

#include <stddef.h>

/* NULL: this program was built without it. */
const char *page_template(size_t *bytes);

#endif
