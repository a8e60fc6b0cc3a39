/* scene_options.c - what a command line says of the objects of a scene. */
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "scene.h"

static char **grow(struct argp_state *state, char **list, uint32_t count)
{
    char **grown = realloc(list, (count + 2u) * sizeof *grown);
    if (grown == NULL || count + 2u > SCENE_OBJECTS_MAX) {
        option_misused(state, "too many objects");
    }
    return grown;
}

static void take_with(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct scene_options *options = to;
    (void)row;
    options->with = grow(state, options->with, options->with_count);
    options->with[options->with_count++] = strdup(text);
}

static void take_between(struct argp_state *state, const struct option_row *row,
                         const char *text, void *to)
{
    struct scene_options *options = to;
    const char *comma = strchr(text, ',');
    if (comma == NULL || comma == text || comma[1] == '\0') {
        option_misused(state, "--%s: \"%s\" is not two names with a comma between them",
                       row->name, text);
    }
    options->between = grow(state, options->between, 2 * options->between_count);
    options->between[2 * options->between_count] = strndup(text, (size_t)(comma - text));
    options->between[2 * options->between_count++ + 1] = strdup(comma + 1);
}

#define AT(member) offsetof(struct scene_options, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"with", 0, "FILE",
     "Add another object, which stands, or moves along if it has as many frames; may be "
     "repeated",
     OPTION_OWN, .take = take_with},
    {"no-self", 0, NULL, "Leave out the pairs of each object with itself", OPTION_FLAG,
     .at = AT(has_no_self)},
    {"between", 0, "A,B",
     "Ask about the pairs of these two objects alone, by their names: those of the scene "
     "file, or those of their first files without folder and ending; may be repeated",
     OPTION_OWN, .take = take_between},
    {0}};
#undef AT

const struct option_table scene_table = {.name = "SCENE", .rows = rows};

void scene_options_deinit(struct scene_options *options)
{
    for (uint32_t i = 0; i < options->with_count; i++) {
        free(options->with[i]);
    }
    for (uint32_t i = 0; i < 2 * options->between_count; i++) {
        free(options->between[i]);
    }
    free(options->with);
    free(options->between);
}
