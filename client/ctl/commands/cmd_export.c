/* client/ctl/commands/cmd_export.c - pccdctl export.
 *
 * Room:     client/ctl.
 * Does:     writes one step of a recording for Blender (glTF) or ParaView (VTK).
 * Does not: draw: see cmd_render.c.
 * Threads:  one.
 * Source:   gltf.h, vtp.h.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "ctl.h"
#include "file_name.h"
#include "gltf.h"
#include "output.h"
#include "play_options.h"
#include "shown.h"
#include "still.h"
#include "vtp.h"

enum { OPTION_TIME = 256 + 64, OPTION_NEAR, OPTION_OUTPUT = 'o' };

struct export
{
    struct play_options options;
    const char *path;
    double t; /* NAN: not given */
    bool is_near;
};

static const struct argp_option option_list[] = {
    {"output", OPTION_OUTPUT, "FILE", 0,
     "Where it goes: FILE.glb is glTF 2.0, FILE.vtp VTK PolyData", 0},
    {"time", OPTION_TIME, "T", 0, "Show the step at time T, 0 to 1 (default: 1, its end)",
     0},
    {"near", OPTION_NEAR, NULL, 0,
     "Write the last answer about what is near instead of contacts: lines between "
     "nearest points, and edges that cross",
     0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct export *export = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &export->options;
        return 0;
    case OPTION_OUTPUT:
        if (!tool_ends_with(text, ".glb") && !tool_ends_with(text, ".vtp")) {
            tool_misused(state, "-o: \"%s\" ends with neither .glb nor .vtp", text);
        }
        export->path = text;
        return 0;
    case OPTION_TIME:
        export->t = ctl_option_real(state, "time", text, 0, 1);
        return 0;
    case OPTION_NEAR:
        export->is_near = true;
        return 0;
    case ARGP_KEY_END:
        if (export->is_near && !isnan(export->t)) {
            tool_misused(state, "--near is of one moment: no --time");
        }
        if (export->path == NULL) {
            tool_misused(state, "-o FILE.glb or -o FILE.vtp says what to write");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&play_options_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_export = {
    .options = option_list,
    .parser = parse,
    .args_doc = "FILE\nFRAME [FRAME...]",
    .doc = "Write a step of a recording, or of the frames of a mesh, with its contacts, "
           "for other programs.\vWithout "
           "--steps it is the last step that was answered, with --steps the last of the "
           "range; with --near it is the last answer about what is near instead. The "
           "contacts are those of the recording, or of a daemon that repeats the "
           "step.",
    .children = children};

static int write_still(const struct export *export, const struct still *still,
                       struct ctl_error *error)
{
    struct whole_file file = {.to = NULL};
    int status = still->object_count > 0
                     ? output_open(&file, export->path, false, error)
                     : ctl_error_set(error, PCCD_E_INVAL,
                                     "step %" PRIu64 " is of a scene without objects",
                                     still->step);
    if (status == PCCD_OK) {
        status = tool_ends_with(export->path, ".glb")
                     ? gltf_write(still, file.to, export->path, error)
                     : vtp_write(still, file.to, export->path, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(&file, export->path, error);
    }
    whole_file_discard(&file);
    return status;
}

int ctl_cmd_export(int argc, char **argv)
{
    struct export export = {.t = NAN};
    struct still still = {.object_count = 0};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    play_options_init(&export.options, "steps");
    export.options.play.source = PLAY_RECORDS;
    export.options.play.needs_records = true;
    export.options.play.only_last = true;
    export.options.takes_frames = true;
    if (argp_parse(&ctl_argp_export, argc, argv, 0, NULL, &export) != 0) {
        return CTL_USAGE;
    }
    const struct still_at at = {.t = isnan(export.t) ? 1 : export.t};
    int status = play_options_open(&export.options, &error);
    if (status == PCCD_OK) {
        status = export.is_near
                     ? still_take_near(&export.options.play, &still, &summary, &error)
                     : still_take(&export.options.play, &at, &still, &summary, &error);
    }
    if (status == PCCD_OK) {
        status = write_still(&export, &still, &error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&export.options.play, &summary);
        still_report(&still, export.path, export.options.is_json);
    } else {
        ctl_error_tell(&error);
    }
    still_deinit(&still);
    play_options_deinit(&export.options);
    return (int)ctl_exit_of(status, true);
}
