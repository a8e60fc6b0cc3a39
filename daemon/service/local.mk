# daemon/service/local.mk - what serves a request; whoever links it does the talking.

noinst_LTLIBRARIES += libservice.la
libservice_la_SOURCES = \
    daemon/service/base/handles.c \
    daemon/service/base/invariant.c \
    daemon/service/base/log.c \
    daemon/service/base/settings_file.c \
    daemon/service/base/metrics.c \
    daemon/service/queue/compute.c \
    daemon/service/queue/crash_context.c \
    daemon/service/queue/deadlines.c \
    daemon/service/queue/turns.c \
    daemon/service/queue/fairqueue.c \
    daemon/service/queue/runners.c \
    daemon/service/memory/enginemem.c \
    daemon/service/memory/quota.c \
    daemon/service/memory/reclaim.c \
    daemon/service/memory/region.c \
    daemon/service/memory/resource.c \
    daemon/service/memory/ringio.c \
    daemon/service/sessions/laststep.c \
    daemon/service/sessions/linger.c \
    daemon/service/sessions/watcher.c \
    daemon/service/sessions/replies.c \
    daemon/service/sessions/session.c \
    daemon/service/sessions/stray.c \
    daemon/service/sessions/tracing.c \
    daemon/service/requests/srv_batch.c \
    daemon/service/scenes/srv_journal.c \
    daemon/service/scenes/held.c \
    daemon/service/scenes/meshes.c \
    daemon/service/scenes/replacement.c \
    daemon/service/scenes/shared.c \
    daemon/service/scenes/srv_scene.c \
    daemon/service/scenes/staging.c \
    daemon/service/requests/call.c \
    daemon/service/requests/answer.c \
    daemon/service/requests/config.c \
    daemon/service/requests/dispatch.c \
    daemon/service/requests/handlers_admin.c \
    daemon/service/requests/handlers_fetch.c \
    daemon/service/requests/handlers_filter.c \
    daemon/service/requests/handlers_step.c \
    daemon/service/requests/handlers_hello.c \
    daemon/service/requests/handlers_journal.c \
    daemon/service/requests/handlers_list.c \
    daemon/service/requests/handlers_mesh.c \
    daemon/service/requests/srv_step.c \
    daemon/service/requests/handlers_scene.c \
    daemon/service/requests/handlers_watch.c \
    daemon/service/requests/hold.c \
    daemon/service/requests/request.c \
    daemon/service/requests/step_tell.c \
    daemon/service/setup.c
# In the room every header has a name of its own, and is included by that alone.
service_cppflags = $(PCCD_CPPFLAGS) \
    -iquote $(top_srcdir)/daemon/service \
    -iquote $(top_srcdir)/daemon/service/base \
    -iquote $(top_srcdir)/daemon/service/queue \
    -iquote $(top_srcdir)/daemon/service/memory \
    -iquote $(top_srcdir)/daemon/service/sessions \
    -iquote $(top_srcdir)/daemon/service/scenes \
    -iquote $(top_srcdir)/daemon/service/requests \
    $(ENGINE_CPPFLAGS) -iquote $(top_srcdir)/proto $(text_cppflags)
libservice_la_CPPFLAGS = $(service_cppflags)
libservice_la_LIBADD = libtext.la
libservice_la_CFLAGS = $(AM_CFLAGS) -pthread
