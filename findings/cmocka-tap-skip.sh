#!/bin/sh
# cmocka-tap-skip.sh - cmocka: a skipped test is "not ok" in TAP.
#
# Seen with cmocka 1.1.5 (Debian 12), CMOCKA_MESSAGE_OUTPUT=TAP. TAP writes a test that was
# skipped as `ok N # SKIP reason`. cmocka writes `not ok N # SKIP name`: readers of TAP that go
# by the first word count a failure, and skip() takes no reason that could be shown. The release
# of Debian 13 writes `ok`. Who counts results over several releases has to rewrite these lines.

. "$(dirname "$0")/unpack.sh"
unpack libcmocka-dev=1.1.5-2.1 libcmocka0=1.1.5-2.1
cat >"$folder/skipped.c" <<'PROGRAM'
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void skipped(void **state)
{
    (void)state;
    skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(skipped)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
PROGRAM
library=$folder/root/usr/lib/x86_64-linux-gnu
gcc -I"$folder/root/usr/include" -o "$folder/skipped" "$folder/skipped.c" -L"$library" \
    -l:libcmocka.so.0 || exit 2
seen=$(CMOCKA_MESSAGE_OUTPUT=TAP LD_LIBRARY_PATH=$library "$folder/skipped" 2>&1 | grep SKIP)
expect "$seen" 'not ok 1 # SKIP skipped'
