# client/ctl/local.mk - pccdctl.

bin_PROGRAMS += pccdctl
dist_doc_DATA += client/prometheus/pccd.dashboard.json client/prometheus/pccd.rules.yml
noinst_LTLIBRARIES += libctl.la

# Everything but main, so that tests can link what they test.
libctl_la_SOURCES = \
    client/ctl/base64.c \
    client/ctl/common.c \
    client/ctl/completion.c \
    client/ctl/dispatch.c \
    client/ctl/error.c \
    client/ctl/link.c \
    client/ctl/output.c \
    client/ctl/progress.c \
    client/ctl/results.c \
    client/ctl/sequence.c \
    client/ctl/terminal.c \
    client/ctl/check/ask_options.c \
    client/ctl/check/check_options.c \
    client/ctl/check/check_run.c \
    client/ctl/check/contacts_csv.c \
    client/ctl/check/objects.c \
    client/ctl/check/player.c \
    client/ctl/check/report.c client/ctl/check/report_json.c \
    client/ctl/check/report_line.c \
    client/ctl/commands/cloth.c \
    client/ctl/commands/check_jobs.c client/ctl/commands/check_screw.c \
    client/ctl/commands/check_walk.c \
    client/ctl/commands/cmd_check.c \
    client/ctl/commands/cmd_config.c \
    client/ctl/commands/cmd_demo.c \
    client/ctl/commands/cmd_doctor.c \
    client/ctl/commands/cmd_drain.c \
    client/ctl/commands/cmd_export.c \
    client/ctl/commands/cmd_inspect.c \
    client/ctl/commands/cmd_list.c \
    client/ctl/commands/cmd_load.c \
    client/ctl/commands/cmd_mcp.c \
    client/ctl/commands/cmd_metrics.c \
    client/ctl/commands/cmd_near.c \
    client/ctl/commands/cmd_ping.c \
    client/ctl/commands/cmd_record.c \
    client/ctl/commands/cmd_render.c \
    client/ctl/commands/render_draw.c \
    client/ctl/commands/failing.c \
    client/ctl/commands/cmd_replay.c \
    client/ctl/commands/cmd_scene.c \
    client/ctl/commands/cmd_stats.c \
    client/ctl/commands/cmd_status.c \
    client/ctl/commands/cmd_sweep.c client/ctl/commands/sweep_draw.c \
    client/ctl/commands/cmd_top.c \
    client/ctl/commands/cmd_trace.c \
    client/ctl/commands/cmd_verify.c \
    client/ctl/commands/cmd_version.c \
    client/ctl/commands/cmd_watch.c \
    client/ctl/export/colour.c \
    client/ctl/export/gltf.c \
    client/ctl/export/vtp.c \
    client/ctl/inspect/inspect.c \
    client/ctl/inspect/inspect_boxes.c \
    client/ctl/inspect/inspect_pack.c \
    client/ctl/inspect/page_file.c \
    client/ctl/commands/check_lines.c \
    client/ctl/judge/crossings.c client/ctl/judge/follow.c client/ctl/judge/judge.c \
    client/ctl/mcp/fields.c client/ctl/mcp/job.c client/ctl/mcp/kept.c \
    client/ctl/mcp/look.c client/ctl/mcp/message.c client/ctl/mcp/tools.c \
    client/ctl/mesh/meshframes.c \
    client/ctl/mesh/gltf_animation.c \
    client/ctl/mesh/gltf_file.c \
    client/ctl/mesh/gltf_mesh.c \
    client/ctl/mesh/gltf_scene.c \
    client/ctl/mesh/meshcut.c \
    client/ctl/mesh/meshfile.c \
    client/ctl/mesh/meshread.c \
    client/ctl/mesh/obj.c \
    client/ctl/mesh/point_cache.c \
    client/ctl/mesh/ply.c \
    client/ctl/mesh/polygon.c \
    client/ctl/mesh/stl.c \
    client/ctl/mesh/text.c \
    client/ctl/near/near_csv.c \
    client/ctl/near/near_options.c \
    client/ctl/near/near_report.c \
    client/ctl/near/near_run.c \
    client/ctl/columns.c \
    client/ctl/observe/http.c \
    client/ctl/observe/counters.c \
    client/ctl/observe/doctor.c client/ctl/observe/doctor_machine.c \
    client/ctl/observe/health.c \
    client/ctl/observe/sessions.c \
    client/ctl/observe/trace_file.c \
    client/ctl/picture/film.c \
    client/ctl/picture/picture.c \
    client/ctl/picture/picture_file.c \
    client/ctl/picture/raster.c \
    client/ctl/picture/thick.c \
    client/ctl/scene/scene.c \
    client/ctl/scene/scene_file.c \
    client/ctl/sweep/edges.c \
    client/ctl/sweep/robot.c \
    client/ctl/sweep/robot_scene.c \
    client/ctl/sweep/shapes.c \
    client/ctl/sweep/sweep_ask.c \
    client/ctl/sweep/sweep_range.c \
    client/ctl/sweep/sweep_report.c \
    client/ctl/sweep/urdf.c \
    client/ctl/sweep/xml.c \
    client/ctl/record/answers.c \
    client/ctl/record/frames.c \
    client/ctl/record/play.c \
    client/ctl/record/play_options.c client/ctl/record/play_up.c \
    client/ctl/record/recorded_state.c \
    client/ctl/record/replay.c \
    client/ctl/record/replayer.c \
    client/ctl/record/snapshot.c \
    client/ctl/record/step_trace.c \
    client/ctl/record/verify.c \
    client/ctl/record/verify_any.c client/ctl/record/verify_distance.c \
    client/ctl/record/verify_meeting.c \
    client/ctl/record/verify_near.c client/ctl/record/verify_numbers.c \
    client/ctl/record/verify_turning.c \
    client/ctl/record/verify_place.c \
    client/ctl/record/verify_report.c client/ctl/record/verify_touching.c
ctl_cppflags = -iquote $(top_srcdir)/client/ctl \
    -iquote $(top_srcdir)/client/ctl/check -iquote $(top_srcdir)/client/ctl/commands \
    -iquote $(top_srcdir)/client/ctl/mcp \
    -iquote $(top_srcdir)/client/ctl/mesh -iquote $(top_srcdir)/client/ctl/near -iquote $(top_srcdir)/client/ctl/observe \
    -iquote $(top_srcdir)/client/ctl/export -iquote $(top_srcdir)/client/ctl/inspect \
    -iquote $(top_srcdir)/client/ctl/judge \
    -iquote $(top_srcdir)/client/ctl/picture \
    -iquote $(top_srcdir)/client/ctl/record -iquote $(top_srcdir)/client/ctl/scene \
    -iquote $(top_srcdir)/client/ctl/sweep \
    -iquote $(top_srcdir)/client/record -iquote $(top_srcdir)/client/oracle \
    -iquote $(top_srcdir)/client/registry \
    -iquote $(top_srcdir)/client/lib -iquote $(top_srcdir)/proto $(tool_cppflags)
libctl_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(ctl_cppflags) $(JANSSON_CFLAGS) $(PNG_CFLAGS) \
    $(XXHASH_CFLAGS) $(EXPAT_CFLAGS) $(MICROHTTPD_CFLAGS)
# The assembler takes the page in: no compiler tells of it.
noinst_LTLIBRARIES += libpage.la
libpage_la_SOURCES = client/ctl/inspect/page_template.c
libpage_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(ctl_cppflags) -Wa,-I.
$(libpage_la_OBJECTS): client/inspect/page.html
libctl_la_LIBADD = libpage.la libtools.la libregistry.la

pccdctl_SOURCES = client/ctl/main.c
pccdctl_CPPFLAGS = $(libctl_la_CPPFLAGS)
pccdctl_LDADD = libctl.la libclient.la liboracle.la $(JANSSON_LIBS) $(PNG_LIBS) \
    $(EXPAT_LIBS) $(LIBM)

# Of README.md; client/README.md has the command that drew it.

# Completion, where the shells look for it: the program itself knows its options.
bashcompletiondir = $(datadir)/bash-completion/completions
zshcompletiondir = $(datadir)/zsh/site-functions
fishcompletiondir = $(datadir)/fish/vendor_completions.d
bashcompletion_DATA =
zshcompletion_DATA =
fishcompletion_DATA =
if RUNS_PROGRAMS
bashcompletion_DATA += client/ctl/completion/pccdctl
zshcompletion_DATA += client/ctl/completion/_pccdctl
fishcompletion_DATA += client/ctl/completion/pccdctl.fish
endif
CLEANFILES += $(bashcompletion_DATA) $(zshcompletion_DATA) $(fishcompletion_DATA)
client/ctl/completion/pccdctl: pccdctl$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) client/ctl/completion && $(EMULATOR) ./pccdctl$(EXEEXT) completion bash >$@.tmp && mv $@.tmp $@
client/ctl/completion/_pccdctl: pccdctl$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) client/ctl/completion && $(EMULATOR) ./pccdctl$(EXEEXT) completion zsh >$@.tmp && mv $@.tmp $@
client/ctl/completion/pccdctl.fish: pccdctl$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) client/ctl/completion && $(EMULATOR) ./pccdctl$(EXEEXT) completion fish >$@.tmp && mv $@.tmp $@
