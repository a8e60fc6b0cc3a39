/* client/ctl/record/frames.c - a recording of the frames of a mesh.
 *
 * Room:     client/ctl.
 * Does:     play them once while the library records.
 * Threads:  one.
 * Source:   frames.h, player.h.
 */
#include "frames.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "file_name.h"
#include "player.h"
#include "terminal.h"

#define NAME_PART 100 /* bytes of each file's name */

/* A folder of our own, and the recording's path there. */
static int make_folder(struct frames_recording *recording, char *const *files,
                       uint32_t count, struct ctl_error *error)
{
    const char *temporary = getenv("TMPDIR");
    char name[2 * NAME_PART + 16];
    temporary = temporary != NULL && temporary[0] == '/' ? temporary : "/tmp";
    int length = snprintf(recording->folder, sizeof recording->folder, "%s/pccd-XXXXXX",
                          temporary);
    if (length < 0 || length >= FRAMES_PATH_BYTES - (int)sizeof name) {
        recording->folder[0] = '\0';
        return ctl_error_set(error, PCCD_E_INVAL, "$TMPDIR: the name is too long");
    }
    if (mkdtemp(recording->folder) == NULL) {
        int status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot make a folder: %s",
                                   temporary, strerror(errno));
        recording->folder[0] = '\0';
        return status;
    }
    snprintf(name, sizeof name, "%.*s%s%.*s", NAME_PART, tool_base_name(files[0]),
             count > 1 ? " to " : "", count > 1 ? NAME_PART : 0,
             tool_base_name(files[count - 1]));
    snprintf(recording->path, sizeof recording->path, "%.*s/%s", length,
             recording->folder, name);
    return PCCD_OK;
}

/* With their contacts, so that nobody has to compute the steps once more. */
static int play_recorded(struct player *player, const char *path, struct ctl_error *error)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    int status = pccd_record_start(player->client, path, &settings);
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "%s: %s", path,
                             pccd_error_text(player->client));
    }
    int played = player_play(player, error);
    status = pccd_record_stop(player->client, NULL);
    if (played == PCCD_OK && status != PCCD_OK) {
        played = ctl_error_set(error, status, "%s: cannot be written whole: %s", path,
                               pccd_error_text(player->client));
    }
    if (played == PCCD_OK && terminal_was_interrupted()) {
        played = ctl_error_set(error, PCCD_E_CANCELLED, "interrupted");
    }
    return played;
}

int frames_record(struct frames_recording *recording, char *const *files, uint32_t count,
                  const struct ctl_link *link, struct ctl_error *error)
{
    const struct player_settings settings = {
        .frames = files, .frame_count = count, .times = 1};
    struct player player = {.settings = &settings};
    int status = player_read(&player, &settings, error);
    if (status == PCCD_OK && ctl_link_open(link, &player.client) != 0) {
        error->text[0] = '\0'; /* told already */
        status = PCCD_E_NODAEMON;
    }
    if (status == PCCD_OK) {
        status = make_folder(recording, files, count, error);
    }
    if (status == PCCD_OK) {
        status = play_recorded(&player, recording->path, error);
    }
    pccd_close(player.client);
    player_deinit(&player);
    return status;
}

void frames_remove(struct frames_recording *recording)
{
    if (recording->folder[0] != '\0') {
        unlink(recording->path);
        rmdir(recording->folder);
        recording->folder[0] = '\0';
    }
}
