/* struct_size.c - structs that begin with struct_bytes, and may be of another release. */
#include "struct_size.h"

#include <assert.h>
#include <string.h>

#include "connection.h"

#define STRUCT_BYTES_MAX 4096u /* no release will ever need a longer struct */

static size_t bytes_of(const void *from)
{
    size_t struct_bytes;

    memcpy(&struct_bytes, from, sizeof struct_bytes);
    return struct_bytes;
}

/* No struct has grown since the first release, so that a shorter one is a mistake. The
 * release that makes one longer has to take the former length, too, and to read 0 as the
 * length of the first release. */
int cli_struct_check(struct pccd_client *client, const char *name, size_t struct_bytes,
                     size_t known_bytes)
{
    assert(known_bytes >= sizeof struct_bytes && known_bytes <= STRUCT_BYTES_MAX);
    if (struct_bytes != 0 &&
        (struct_bytes < known_bytes || struct_bytes > STRUCT_BYTES_MAX)) {
        return cli_fail(client, PCCD_E_INVAL, "%s: struct_bytes is %zu, not %zu", name,
                        struct_bytes, known_bytes);
    }
    return 0;
}

int cli_struct_read(struct pccd_client *client, const char *name, const void *asked,
                    void *known, size_t known_bytes)
{
    const unsigned char *bytes = asked;
    size_t asked_bytes = bytes_of(asked);
    int status = cli_struct_check(client, name, asked_bytes, known_bytes);

    if (status != 0) {
        return status;
    }
    for (size_t i = known_bytes; i < asked_bytes; i++) {
        if (bytes[i] != 0) {
            return cli_fail(client, PCCD_E_INVAL,
                            "%s: something is set that libpccd %s does not know", name,
                            pccd_version());
        }
    }
    memcpy(known, asked, known_bytes);
    return 0;
}

void cli_struct_fill(void *to, const void *known, size_t known_bytes)
{
    size_t to_bytes = bytes_of(to);
    size_t head = sizeof to_bytes;

    assert(to_bytes == 0 || (to_bytes >= known_bytes && to_bytes <= STRUCT_BYTES_MAX));
    memcpy((char *)to + head, (const char *)known + head, known_bytes - head);
    if (to_bytes > known_bytes) {
        memset((char *)to + known_bytes, 0, to_bytes - known_bytes);
    }
}
