/* cmd_stats.c - pccdctl stats. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "json_text.h"
#include "link.h"
#include "stats_threads.h"

struct stats_options {
    struct ctl_link link;
    bool is_json;
    bool of_threads;
};

enum { OPTION_JSON = 256 + 64, OPTION_THREADS };

static const struct argp_option option_list[] = {
    {"json", OPTION_JSON, NULL, 0, "One JSON object with a member for each counter", 0},
    {"threads", OPTION_THREADS, NULL, 0,
     "Show what each thread of the daemon's last step did, instead of the counters", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct stats_options *options = state->input;
    (void)text;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->link;
        return 0;
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    case OPTION_THREADS:
        options->of_threads = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_stats = {.options = option_list,
                                    .parser = parse,
                                    .doc = "List the daemon's counters.",
                                    .children = children};

/* The library says no name's length beforehand, so the list is walked twice: once for the
 * widths, once to print. The second walk asks again; its values are the later ones. */
struct widths {
    int name, value;
};

/* What is printed besides the counters. */
static const char cpu_text[] = "instruction set that steps use";
static const char share_text[] =
    "of the candidates, the share that took exact arithmetic";

struct shares {
    uint64_t exact, candidates;
};

struct listing {
    struct widths widths;
    struct shares shares;
};

static void widen(struct widths *widths, int name, int value)
{
    widths->name = name > widths->name ? name : widths->name;
    widths->value = value > widths->value ? value : widths->value;
}

static void measure(void *context, const char *name, uint64_t value, const char *text)
{
    struct listing *listing = context;
    (void)text;
    widen(&listing->widths, (int)strlen(name), snprintf(NULL, 0, "%" PRIu64, value));
}

static void note_share(struct shares *shares, const char *name, uint64_t value)
{
    if (strcmp(name, "exact") == 0) {
        shares->exact = value;
    } else if (strcmp(name, "candidates") == 0) {
        shares->candidates = value;
    }
}

/* 0 before the first candidate. */
static double share(const struct shares *shares)
{
    return shares->candidates ? (double)shares->exact / (double)shares->candidates : 0;
}

static void print_line(void *context, const char *name, uint64_t value, const char *text)
{
    struct listing *listing = context;
    note_share(&listing->shares, name, value);
    printf("%-*s  %*" PRIu64 "  %s\n", listing->widths.name, name, listing->widths.value,
           value, text);
}

struct members {
    json_t *object;
    struct shares shares;
};

static void add_member(void *context, const char *name, uint64_t value, const char *text)
{
    struct members *members = context;
    (void)text;
    note_share(&members->shares, name, value);
    json_object_set_new(members->object, name, json_integer((json_int_t)value));
}

static int print_json(struct pccd_client *client)
{
    struct members members = {.object = json_object()};
    int status = pccd_stats(client, add_member, &members);
    if (status == PCCD_OK) {
        json_object_set_new(members.object, "exact_share",
                            json_real(share(&members.shares)));
        json_object_set_new(members.object, "cpu", json_string(pccd_daemon_cpu(client)));
        json_dumpf(members.object, stdout, JSON_TEXT_FLAGS);
        putchar('\n');
    }
    json_decref(members.object);
    return status;
}

static int print_list(struct pccd_client *client)
{
    struct listing listing = {{0, 0}, {0, 0}};
    const struct widths *widths = &listing.widths;
    const char *cpu = pccd_daemon_cpu(client);
    char number[32];
    int status = pccd_stats(client, measure, &listing);
    widen(&listing.widths, (int)strlen("exact_share"), (int)strlen(cpu));
    if (status == PCCD_OK) {
        status = pccd_stats(client, print_line, &listing);
    }
    if (status == PCCD_OK) {
        snprintf(number, sizeof number, "%.4g", share(&listing.shares));
        printf("%-*s  %*s  %s\n", widths->name, "exact_share", widths->value, number,
               share_text);
        printf("%-*s  %*s  %s\n", widths->name, "cpu", widths->value, tool_shown(cpu),
               cpu_text);
    }
    return status;
}

static int print(struct pccd_client *client, const struct stats_options *options)
{
    if (options->of_threads) {
        return stats_threads_print(client, stdout, options->is_json);
    }
    return options->is_json ? print_json(client) : print_list(client);
}

int ctl_cmd_stats(int argc, char **argv)
{
    struct stats_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct pccd_client *client = NULL;
    if (argp_parse(&ctl_argp_stats, argc, argv, 0, NULL, &options) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE && print(client, &options) != PCCD_OK) {
        status = ctl_complain("stats: %s", pccd_error_text(client));
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}
