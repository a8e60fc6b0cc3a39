/* page_file.c - a page with data in it, as a file. */
#include "inspect.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "base64.h"
#include "pccd_types.h"

#define BLOB_OPEN  "<script type=\"application/octet-stream\" id=\"pccd-%08" PRIu32 "\">"
#define BLOB_CLOSE "</script>\n"
#define META_OPEN  "<script type=\"application/json\" id=\"pccd-meta\">"
/* Bytes of BLOB_OPEN and BLOB_CLOSE together: the number has its eight digits. */
#define BLOB_AROUND 69u

/* Outside of its strings JSON has none of these, and in them they may be written so. */
static const char *escape_of(char letter)
{
    return letter == '<'   ? "\\u003c"
           : letter == '>' ? "\\u003e"
           : letter == '&' ? "\\u0026"
                           : NULL;
}

static int write_json(const char *text, size_t count, void *to)
{
    for (size_t i = 0; i < count; i++) {
        const char *escape = escape_of(text[i]);
        if (escape != NULL ? fputs(escape, to) < 0 : putc(text[i], to) == EOF) {
            return -1;
        }
    }
    return 0;
}

static int count_json(const char *text, size_t count, void *bytes)
{
    uint64_t *sum = bytes;
    for (size_t i = 0; i < count; i++) {
        const char *escape = escape_of(text[i]);
        *sum += escape != NULL ? strlen(escape) : 1;
    }
    return 0;
}

static int failed(const struct page_file *page, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", page->path,
                         strerror(errno));
}

int page_file_begin(struct page_file *page, FILE *to, const char *path,
                    const char *template, size_t template_bytes, struct ctl_error *error)
{
    const size_t mark = strlen(PAGE_FILE_MARK);
    const char *at = memmem(template, template_bytes, PAGE_FILE_MARK, mark);
    if (at == NULL) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "the page of this build has no place for data");
    }
    size_t before = (size_t)(at - template);
    *page = (struct page_file){.to = to,
                               .path = path,
                               .rest = at + mark,
                               .rest_bytes = template_bytes - before - mark};
    page->bytes = before + page->rest_bytes + strlen(META_OPEN) + strlen(BLOB_CLOSE);
    return fwrite(template, 1, before, to) == before ? PCCD_OK : failed(page, error);
}

uint64_t page_file_blob_bytes(size_t count)
{
    return BLOB_AROUND + ((uint64_t)count + 2) / 3 * 4;
}

int page_file_blob(struct page_file *page, const void *bytes, size_t count,
                   struct ctl_error *error)
{
    if (fprintf(page->to, BLOB_OPEN, page->blob_count) < 0 ||
        !base64_write(bytes, count, page->to) || fputs(BLOB_CLOSE, page->to) < 0) {
        return failed(page, error);
    }
    page->blob_count++;
    page->bytes += page_file_blob_bytes(count);
    return PCCD_OK;
}

uint64_t page_file_json_bytes(const json_t *value)
{
    uint64_t bytes = 0;
    json_dump_callback(value, count_json, &bytes, JSON_COMPACT | JSON_ENSURE_ASCII);
    return bytes;
}

int page_file_finish(struct page_file *page, const json_t *meta, struct ctl_error *error)
{
    if (fputs(META_OPEN, page->to) < 0 ||
        json_dump_callback(meta, write_json, page->to,
                           JSON_COMPACT | JSON_ENSURE_ASCII) != 0 ||
        fputs(BLOB_CLOSE, page->to) < 0 ||
        fwrite(page->rest, 1, page->rest_bytes, page->to) != page->rest_bytes ||
        fflush(page->to) != 0) {
        return failed(page, error);
    }
    return PCCD_OK;
}
