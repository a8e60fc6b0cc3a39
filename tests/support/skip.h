/* skip.h - skip a case of cmocka, and say why. */
#ifndef TEST_SKIP_H
#define TEST_SKIP_H

#include <stdio.h>
#include <stdlib.h>

/* Does not return. `why` is a text of one line without '#'. The includer has cmocka.h. */
#define test_skip(why)                                                                   \
    do {                                                                                 \
        printf("# skipped: %s\n", (why));                                                \
        skip();                                                                          \
    } while (0)

/* Skips where an emulator runs the program, as $PCCD_EMULATOR of `make check` says. */
#define test_skip_emulated(why)                                                          \
    do {                                                                                 \
        const char *test_emulator = getenv("PCCD_EMULATOR");                             \
        if (test_emulator != NULL && test_emulator[0] != '\0') {                         \
            test_skip(why);                                                              \
        }                                                                                \
    } while (0)

#define TEST_ONLY_ROOT "only root can act as another user"

#endif
