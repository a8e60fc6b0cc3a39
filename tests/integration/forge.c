/* forge.c - copies of recordings, chunk by chunk. */
#include "forge.h"

#include <string.h>
#include <unistd.h>

#include "cases.h"

void forge_recording(const char *from, const char *to, forge_fn change, void *context)
{
    struct record_writer writer = {.fd = -1, .level = 1};
    struct record_reader reader;
    struct record_view view;
    int got;

    (void)unlink(to);
    assert_ok(record_writer_open(&writer, to));
    assert_ok(record_reader_open(&reader, from));
    while ((got = record_reader_next(&reader, &view)) == 1) {
        struct forge_chunk chunk = {view.kind, malloc(view.bytes + 1), view.bytes};
        assert_non_null(chunk.payload);
        memcpy(chunk.payload, view.payload, view.bytes);
        if (change(context, &chunk)) {
            const struct record_part part = {chunk.payload, chunk.bytes};
            assert_ok(record_writer_add(&writer, (enum record_kind)chunk.kind,
                                        view.time_ns, &part, 1));
        }
        free(chunk.payload);
    }
    assert_int_equal(got, 0);
    record_reader_deinit(&reader);
    record_writer_deinit(&writer);
}

const char *forge_name(const char *path, uint32_t object)
{
    static char known[256];
    struct record_reader reader;
    struct record_view view;

    known[0] = '\0';
    assert_ok(record_reader_open(&reader, path));
    while (record_reader_next(&reader, &view) == 1) {
        struct record_name name;

        if (view.kind == RECORD_NAME) {
            memcpy(&name, view.payload, sizeof name);
            if (name.object == object) {
                (void)snprintf(known, sizeof known, "%.*s", (int)name.bytes,
                               (const char *)view.payload + sizeof name);
            }
        }
    }
    record_reader_deinit(&reader);
    return known;
}
