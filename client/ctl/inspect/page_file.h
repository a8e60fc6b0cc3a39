/* page_file.h - writes an HTML page with binary data inside.
 *
 * Threads: one.
 */
#ifndef CTL_PAGE_FILE_H
#define CTL_PAGE_FILE_H

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"

#define PAGE_FILE_MARK "<!--pccd:data-->"

struct page_file {
    FILE *to;         /* the caller's */
    const char *path; /* for messages */
    const char *rest; /* of the template, behind the mark */
    size_t rest_bytes;
    uint64_t bytes; /* of the file, with the rest but without the JSON text */
    uint32_t blob_count;
};

/* Write the template up to its mark. E_FORMAT: it has none; E_SYSTEM. */
int page_file_begin(struct page_file *page, FILE *to, const char *path,
                    const char *template, size_t template_bytes, struct ctl_error *error);
/* One more piece of data, as base64; the first is number 0. */
int page_file_blob(struct page_file *page, const void *bytes, size_t count,
                   struct ctl_error *error);
/* The JSON text, and the rest of the template; flushed, not closed. */
int page_file_finish(struct page_file *page, const json_t *meta, struct ctl_error *error);

/* What these add to the file. */
uint64_t page_file_blob_bytes(size_t count);
uint64_t page_file_json_bytes(const json_t *value);

#endif
