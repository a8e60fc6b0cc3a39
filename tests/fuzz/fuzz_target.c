/* fuzz_target.c - what a fuzzer calls with bytes of its own making. */
#include "fuzz_target.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fault.h"

#define FOREVER (UINT64_MAX / 2)

fuzz_function *fuzz_target(const char *name)
{
#define FUZZ_NAMED(target)                                                               \
    if (strcmp(name, #target) == 0) {                                                    \
        return fuzz_##target;                                                            \
    }
    FUZZ_TARGETS(FUZZ_NAMED)
#undef FUZZ_NAMED
    return NULL;
}

void fuzz_call(fuzz_function *target, const uint8_t *data, size_t bytes)
{
    if (bytes == 0) {
        return;
    }
    uint64_t first = data[0] < 128 ? data[0] : data[0] - 127u;
    uint64_t length = data[0] == 0 ? 0 : data[0] < 128 ? 1 : FOREVER;
    /* An allocation of its own, so that a read past its end is seen. */
    uint8_t *copy = malloc(bytes > 1 ? bytes - 1 : 1);
    if (copy == NULL) {
        return;
    }
    memcpy(copy, data + 1, bytes - 1);
    fault_order(fault_page, FAULT_memory, first, length, ENOMEM);
    target(copy, bytes - 1);
    fault_recall(fault_page);
    free(copy);
}

void fuzz_scarcity_pause(void)
{
    atomic_store(&fault_page->call, FAULT_NONE);
}

void fuzz_scarcity_resume(void)
{
    atomic_store(&fault_page->call, FAULT_memory);
}

uint64_t fuzz_scarcity_hits(void)
{
    return atomic_load(&fault_page->hits);
}

size_t fuzz_take_bytes(struct fuzz_input *input, void *to, size_t bytes)
{
    size_t count = bytes < input->left ? bytes : input->left;
    if (count > 0) {
        memcpy(to, input->at, count);
    }
    input->at += count;
    input->left -= count;
    return count;
}

uint8_t fuzz_take_u8(struct fuzz_input *input)
{
    uint8_t value = 0;
    fuzz_take_bytes(input, &value, sizeof value);
    return value;
}

uint16_t fuzz_take_u16(struct fuzz_input *input)
{
    uint16_t value = 0;
    fuzz_take_bytes(input, &value, sizeof value);
    return value;
}

uint32_t fuzz_take_u32(struct fuzz_input *input)
{
    uint32_t value = 0;
    fuzz_take_bytes(input, &value, sizeof value);
    return value;
}

uint64_t fuzz_take_u64(struct fuzz_input *input)
{
    uint64_t value = 0;
    fuzz_take_bytes(input, &value, sizeof value);
    return value;
}

void fuzz_wrong(const char *what, const char *file, int line)
{
    fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
    abort();
}
