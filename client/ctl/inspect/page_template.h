/* page_template.h - the HTML page of `pccdctl inspect`, without data. */
#ifndef CTL_PAGE_TEMPLATE_H
#define CTL_PAGE_TEMPLATE_H

#include <stddef.h>

/* NULL: this program was built without it. */
const char *page_template(size_t *bytes);

#endif
