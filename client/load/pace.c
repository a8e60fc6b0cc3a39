/* pace.c - when each request of a client is due. */
#include "actor.h"

#include <math.h>

#define NS_PER_S 1e9

static double luck(const struct load_pace *pace, const struct load *load, uint64_t what)
{
    uint64_t bits = load_mix(load->settings.seed ^ what, pace->client);
    return load_unit(load_mix(bits, pace->count));
}

uint64_t load_measured_from_ns(const struct load *load)
{
    const struct load_settings *settings = &load->settings;
    return atomic_load(&load->shared->go_ns) +
           (uint64_t)(NS_PER_S * (settings->ramp_s + settings->warm_up_s));
}

void load_pace_begin(struct load_pace *pace, const struct load *load, uint32_t client)
{
    const struct load_settings *settings = &load->settings;
    double share = (double)client / settings->clients;
    double phase_s = settings->hz > 0 ? share / settings->hz : 0;
    *pace = (struct load_pace){.client = client};
    pace->due_ns = atomic_load(&load->shared->go_ns) +
                   (uint64_t)(NS_PER_S * (settings->ramp_s * share + phase_s));
}

void load_pace_next(struct load_pace *pace, const struct load *load, uint64_t now_ns)
{
    const struct load_settings *settings = &load->settings;
    pace->count++;
    if (settings->hz > 0) {
        double periods = settings->poisson ? -log1p(-luck(pace, load, 0x9a1e)) : 1;
        pace->due_ns += (uint64_t)(periods * NS_PER_S / settings->hz);
    } else if (settings->think_ms > 0) {
        pace->due_ns = now_ns + (uint64_t)((0.5 + luck(pace, load, 0x781c)) * 1e6 *
                                           settings->think_ms);
    }
}

uint64_t load_pace_stall_ns(const struct load_pace *pace, const struct load *load)
{
    const struct load_settings *settings = &load->settings;
    bool stalls =
        settings->stall_share > 0 && luck(pace, load, 0x57a11) < settings->stall_share;
    return stalls ? settings->stall_ms * 1000000ull : 0;
}
