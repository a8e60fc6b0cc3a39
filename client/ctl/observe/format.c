/* format.c - numbers as people read them. */
#include "format.h"

#include <inttypes.h>
#include <pwd.h>
#include <stdio.h>

#define PLACES      8u
#define PLACE_BYTES 48u

static char *place(void)
{
    static char places[PLACES][PLACE_BYTES];
    static uint32_t next;
    return places[next++ % PLACES];
}

static const char *scaled(double value, double step, const char *const *units,
                          uint32_t unit_count)
{
    char *text = place();
    uint32_t unit = 0;
    while (value >= 999.5 && unit + 1 < unit_count) {
        value /= step;
        unit++;
    }
    snprintf(text, PLACE_BYTES, unit == 0 ? "%.0f%s" : "%.3g%s", value, units[unit]);
    return text;
}

const char *format_count(double count)
{
    static const char *const units[] = {"", " k", " M", " G", " T"};
    return scaled(count, 1000, units, 5);
}

const char *format_bytes(double bytes)
{
    static const char *const units[] = {" B", " KiB", " MiB", " GiB", " TiB"};
    return scaled(bytes, 1024, units, 5);
}

const char *format_span(uint64_t nanoseconds)
{
    char *text = place();
    uint64_t s = nanoseconds / 1000000000u;
    if (s < 60) {
        snprintf(text, PLACE_BYTES, "%.1f s", (double)nanoseconds / 1e9);
    } else if (s < 3600) {
        snprintf(text, PLACE_BYTES, "%" PRIu64 " min %02" PRIu64 " s", s / 60, s % 60);
    } else if (s < 86400) {
        snprintf(text, PLACE_BYTES, "%" PRIu64 " h %02" PRIu64 " min", s / 3600,
                 s / 60 % 60);
    } else {
        snprintf(text, PLACE_BYTES, "%" PRIu64 " d %" PRIu64 " h", s / 86400,
                 s / 3600 % 24);
    }
    return text;
}

const char *format_ms(double milliseconds)
{
    char *text = place();
    snprintf(text, PLACE_BYTES, milliseconds < 10 ? "%.3f ms" : "%.1f ms", milliseconds);
    return text;
}

const char *format_user(uint32_t uid)
{
    char *text = place();
    const struct passwd *user = getpwuid(uid);
    if (user != NULL) {
        snprintf(text, PLACE_BYTES, "%s", user->pw_name);
    } else {
        snprintf(text, PLACE_BYTES, "%" PRIu32, uid);
    }
    return text;
}
