/* play_options.h - the options that all commands which read a recording have in common.
 */
#ifndef CTL_PLAY_OPTIONS_H
#define CTL_PLAY_OPTIONS_H

#include "frames.h"
#include "link.h"
#include "option_table.h"
#include "play.h"

/* It takes the arguments: a recording, or with takes_frames also the files of a mesh
 * (play_frames_table). */
struct play_options {
    struct ctl_link link;
    struct play_settings play;
    bool is_json;
    bool takes_frames; /* set before parsing */
    bool takes_files;  /* set before parsing: several recordings */
    struct option_arguments files;
    struct ctl_frames_options how; /* frames are read */
    struct scene_options scene;
    struct frames_recording frames;
    char *output; /* ours, of play_options_output */
};
extern const struct option_table play_table;
/* The same of a command that takes frames, with the options of ask_options.h. */
extern const struct option_table play_frames_table;
/* The same, but --rate is the command's own. */
extern const struct option_table play_film_table;
/* As play_table, without the daemon's options. */
extern const struct option_table play_files_table;

/* Set what holds before parsing: all steps, and the daemon at $PCCD_URL or else a private
 * one; an option may name another one. */
void play_options_init(struct play_options *options, const char *label);
/* Return whether frames are named, and not a recording; once parsed. */
bool play_options_are_frames(const struct play_options *options);
/* Set play.path to the recording, once parsed; where frames are named, record them first.
 * Errors: those of scene_take and frames_record. */
int play_options_open(struct play_options *options, struct ctl_error *error);
void play_options_deinit(struct play_options *options);
/* Return the name of what is made of the first file where nobody has given one: that of
 * the file with this ending, in the current folder. It lives as long as the options.
 * NULL: no memory. */
const char *play_options_output(struct play_options *options, const char *ending);

/* Tell on stderr how the file ended, if it did not end well. */
void play_options_warn(const struct play_settings *settings,
                       const struct play_summary *summary);

#endif
