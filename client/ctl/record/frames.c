/* frames.c - a recording of frames from files. */
#include "frames.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "player.h"
#include "terminal.h"
#include "whole_file.h"

#define NAME_PART 100 /* bytes of each file's name */

#define PATH_BYTES 4096

/* A folder of our own. */
static int make_folder(char folder[PATH_BYTES], struct ctl_error *error)
{
    const char *temporary = getenv("TMPDIR");
    temporary = temporary != NULL && temporary[0] == '/' ? temporary : "/tmp";
    int length = snprintf(folder, PATH_BYTES, "%s/pccd-XXXXXX", temporary);
    if (length < 0 || length >= PATH_BYTES) {
        return ctl_error_set(error, PCCD_E_INVAL, "$TMPDIR: the name is too long");
    }
    return mkdtemp(folder) != NULL
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot make a folder: %s",
                               temporary, strerror(errno));
}

/* Begin the file, open it, and take its name and the folder away again. */
int frames_begin(struct frames_recording *recording, struct pccd_client *client,
                 struct ctl_error *error)
{
    /* With their contacts, so that nobody has to compute the steps once more. */
    const struct pccd_record_settings settings = {.contacts = 1};
    char folder[PATH_BYTES], path[PATH_BYTES + 16];
    int made = make_folder(folder, error);
    if (made != PCCD_OK) {
        return made;
    }
    snprintf(path, sizeof path, "%s/frames", folder);
    int status = pccd_record_start(client, path, &settings);
    if (status != PCCD_OK) {
        ctl_error_set(error, status, "%s: %s", path, pccd_error_text(client));
    } else {
        recording->fd = open(path, O_RDONLY | O_CLOEXEC);
        status = recording->fd >= 0 ? PCCD_OK
                                    : ctl_error_set(error, PCCD_E_SYSTEM, "%s: %s", path,
                                                    strerror(errno));
    }
    (void)unlink(path);
    (void)rmdir(folder);
    if (status == PCCD_OK) {
        snprintf(recording->from, sizeof recording->from, "/proc/self/fd/%d",
                 recording->fd);
    }
    return status;
}

static int play_recorded(struct player *player, const struct frames_recording *recording,
                         struct ctl_error *error)
{
    int played = player_play(player, error);
    int status = pccd_record_stop(player->client, NULL);
    if (played == PCCD_OK && status != PCCD_OK) {
        played = ctl_error_set(error, status, "%s: cannot be written whole: %s",
                               recording->name, pccd_error_text(player->client));
    }
    if (played == PCCD_OK && terminal_was_interrupted()) {
        played = ctl_error_set(error, PCCD_E_CANCELLED, "interrupted");
    }
    return played;
}

int frames_record(struct frames_recording *recording, struct scene *scene,
                  const struct option_arguments *files, const struct ctl_link *link,
                  struct ctl_error *error)
{
    const struct player_settings settings = {.times = 1,
                                             .tells_start = recording->tells_start};
    struct player player = {.settings = &settings};
    uint32_t count = files->count;
    snprintf(recording->name, sizeof recording->name, "%.*s%s%.*s", NAME_PART,
             tool_base_name(files->list[0]), count > 1 ? " to " : "",
             count > 1 ? NAME_PART : 0, tool_base_name(files->list[count - 1]));
    int status = scene_open(scene, error);
    if (status == PCCD_OK) {
        status = player_read(&player, scene, &settings, error);
    }
    if (status == PCCD_OK && ctl_link_open(link, &player.client) != 0) {
        error->text[0] = '\0'; /* told already */
        status = PCCD_E_NODAEMON;
    }
    if (status == PCCD_OK) {
        status = frames_begin(recording, player.client, error);
    }
    if (status == PCCD_OK) {
        status = play_recorded(&player, recording, error);
    }
    pccd_close(player.client);
    player_deinit(&player);
    return status;
}

void frames_forget(struct frames_recording *recording)
{
    if (recording->from[0] != '\0') {
        (void)close(recording->fd);
        recording->from[0] = '\0';
    }
}
