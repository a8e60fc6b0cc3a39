/* target_record.c - recordings of any content. */
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "fuzz_target.h"
#include "recorded_state.h"

#define FILE_BYTES (1u << 18)

/* Chunks of kinds, lengths and bytes that the input chooses. */
static size_t compose(struct fuzz_input *input, uint8_t *file)
{
    static const uint8_t head[RECORD_HEAD_BYTES] = {'p', 'c', 'c', 'd',           'r',
                                                    'e', 'c', 0,   RECORD_VERSION};
    size_t at = sizeof head;

    memcpy(file, head, sizeof head);
    while (input->left > 3) {
        struct record_chunk chunk = {.magic = RECORD_CHUNK_MAGIC};
        uint8_t *body = file + at + sizeof chunk;

        chunk.kind = fuzz_take_u8(input);
        chunk.encoding = chunk.kind >> 7;
        chunk.kind &= 31;
        chunk.stored_bytes = fuzz_take_u16(input) % 4096;
        chunk.bytes =
            chunk.encoding == RECORD_ZSTD ? fuzz_take_u16(input) : chunk.stored_bytes;
        if (at + sizeof chunk + 4096 + 8 > FILE_BYTES) {
            break;
        }
        memset(body, 0, chunk.stored_bytes + 8);
        (void)fuzz_take_bytes(input, body, chunk.stored_bytes);
        chunk.stored_sum = XXH3_64bits(body, chunk.stored_bytes);
        chunk.header_sum = XXH3_64bits(&chunk, offsetof(struct record_chunk, header_sum));
        memcpy(file + at, &chunk, sizeof chunk);
        at += sizeof chunk + (chunk.stored_bytes + 7) / 8 * 8;
    }
    return at;
}

static int follow(struct registry *state, struct recorded_item *item,
                  const struct record_view *view)
{
    struct ctl_error error = {.text = ""};

    return recorded_item_take(item, view) ? recorded_state_move(state, item, &error)
                                          : recorded_state_follow(state, view, &error);
}

/* The sum of all positions: memory that is not there would be noticed. */
static double sum_of(const struct registry *state)
{
    double sum = 0;

    for (const struct registry_scene *scene = state->scenes; scene != NULL;
         scene = scene->next) {
        for (uint32_t i = 0; i < scene->object_count; i++) {
            const struct registry_object *object = &scene->objects[i];

            for (uint32_t v = 0; v < object->mesh->vertex_count; v++) {
                sum += object->x0[v][0] + object->x1[v][2];
            }
        }
    }
    return sum;
}

/* The first byte chooses: odd, the input is the file; even, it is what to compose. */
void fuzz_record(const uint8_t *data, size_t bytes)
{
    static uint8_t file[FILE_BYTES];
    struct fuzz_input input = {data, bytes};
    struct record_reader reader;
    struct record_view view;
    struct registry state = {.meshes = NULL};
    struct recorded_item item = {.slot = NULL};
    bool is_raw = fuzz_take_u8(&input) % 2 == 1;
    size_t file_bytes = input.left;
    volatile double sum = 0;
    int status;

    if (is_raw) {
        file_bytes = fuzz_take_bytes(&input, file, sizeof file);
    } else {
        file_bytes = compose(&input, file);
    }
    status = record_reader_open_memory(&reader, file, file_bytes);
    while (status == 0 && record_reader_next(&reader, &view) == 1) {
        FUZZ_CHECK(view.payload != NULL && view.offset < file_bytes);
        status = follow(&state, &item, &view);
        sum = sum + sum_of(&state);
    }
    FUZZ_CHECK(status <= 0);
    FUZZ_CHECK(status != PCCD_E_FORMAT || reader.ending != RECORD_ENDING_WHOLE);
    registry_deinit(&state);
    record_reader_deinit(&reader);
}
