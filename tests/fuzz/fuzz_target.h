/* fuzz_target.h - the functions that a fuzzer calls with random bytes.
 *
 * Threads: one calls; a target may have threads of its own.
 *
 * Every input begins with a byte for the allocator: 0, none fails; 1 .. 127, the
 * allocation of that number fails; 128 .. 255, all from number (byte - 127) on fail.
 */
#ifndef FUZZ_FUZZ_TARGET_H
#define FUZZ_FUZZ_TARGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* X(name): `void fuzz_name(const uint8_t *data, size_t bytes)` in target_name.c. */
#define FUZZ_TARGETS(X)                                                                  \
    X(decoder)                                                                           \
    X(dispatch)                                                                          \
    X(slot)                                                                              \
    X(mesh)                                                                              \
    X(reader)                                                                            \
    X(query)                                                                             \
    X(travel)                                                                            \
    X(record)

#define FUZZ_DECLARE(name) void fuzz_##name(const uint8_t *data, size_t bytes);
FUZZ_TARGETS(FUZZ_DECLARE)
#undef FUZZ_DECLARE

typedef void fuzz_function(const uint8_t *data, size_t bytes);
/* Return the target of that name, or NULL. */
fuzz_function *fuzz_target(const char *name);
/* Take the allocator's byte off, and call. */
void fuzz_call(fuzz_function *target, const uint8_t *data, size_t bytes);

/* Between these two no allocation fails: for what judges and not what is judged. */
void fuzz_scarcity_pause(void);
void fuzz_scarcity_resume(void);
/* Allocations that have failed in this input. */
uint64_t fuzz_scarcity_hits(void);

/* Rest of an input. Beyond its end there are zeros. */
struct fuzz_input {
    const uint8_t *at;
    size_t left;
};

uint8_t fuzz_take_u8(struct fuzz_input *input);
uint16_t fuzz_take_u16(struct fuzz_input *input);
uint32_t fuzz_take_u32(struct fuzz_input *input);
uint64_t fuzz_take_u64(struct fuzz_input *input);
/* At most `bytes` of them to `to`; returns how many. */
size_t fuzz_take_bytes(struct fuzz_input *input, void *to, size_t bytes);

/* Abort with a line of text unless the condition holds. */
#define FUZZ_CHECK(condition)                                                            \
    ((condition) ? (void)0 : fuzz_wrong(#condition, __FILE__, __LINE__))
void fuzz_wrong(const char *what, const char *file, int line) __attribute__((noreturn));

#endif
