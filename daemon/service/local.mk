# daemon/service/local.mk - what serves a request; whoever links it does the talking.

noinst_LTLIBRARIES += libservice.la
libservice_la_SOURCES = \
    daemon/service/call.h \
    daemon/service/claim.h \
    daemon/service/compute.c daemon/service/compute.h \
    daemon/service/config.c daemon/service/config.h \
    daemon/service/crashnote.c daemon/service/crashnote.h \
    daemon/service/diary.c daemon/service/diary.h \
    daemon/service/dispatch.c daemon/service/dispatch.h \
    daemon/service/enginemem.c daemon/service/enginemem.h \
    daemon/service/fairqueue.c daemon/service/fairqueue.h \
    daemon/service/handlers_admin.c \
    daemon/service/handlers_config.c \
    daemon/service/handlers_boxes.c \
    daemon/service/handlers_fetch.c \
    daemon/service/handlers_filter.c \
    daemon/service/handlers_frame.c \
    daemon/service/handlers_hello.c \
    daemon/service/handlers_journal.c \
    daemon/service/handlers_list.c \
    daemon/service/handlers_mesh.c \
    daemon/service/handlers_scene.c \
    daemon/service/handlers_watch.c \
    daemon/service/desk.c daemon/service/desk.h \
    daemon/service/frame.h \
    daemon/service/handles.c daemon/service/handles.h \
    daemon/service/held.c daemon/service/held.h \
    daemon/service/host.h \
    daemon/service/invariant.c daemon/service/invariant.h \
    daemon/service/laststep.c daemon/service/laststep.h \
    daemon/service/linger.c daemon/service/linger.h \
    daemon/service/log.c daemon/service/log.h \
    daemon/service/loop.c daemon/service/loop.h \
    daemon/service/meshes.c daemon/service/meshes.h \
    daemon/service/metrics.c daemon/service/metrics.h \
    daemon/service/monitor.c daemon/service/monitor.h \
    daemon/service/now.h \
    daemon/service/options.h \
    daemon/service/overdue.c daemon/service/overdue.h \
    daemon/service/quota.c daemon/service/quota.h \
    daemon/service/region.c daemon/service/region.h \
    daemon/service/relief.c daemon/service/relief.h \
    daemon/service/replies.c daemon/service/replies.h \
    daemon/service/request.c daemon/service/request.h \
    daemon/service/resource.c daemon/service/resource.h \
    daemon/service/ringio.c daemon/service/ringio.h \
    daemon/service/session.c daemon/service/session.h \
    daemon/service/shared.c daemon/service/shared.h \
    daemon/service/stuck.c daemon/service/stuck.h \
    daemon/service/tracing.c daemon/service/tracing.h \
    daemon/service/wire.c daemon/service/wire.h
service_cppflags = $(AM_CPPFLAGS) -iquote $(top_srcdir)/daemon/service \
    $(ENGINE_CPPFLAGS) -iquote $(top_srcdir)/proto $(text_cppflags)
libservice_la_CPPFLAGS = $(service_cppflags)
libservice_la_LIBADD = libtext.la
libservice_la_CFLAGS = $(AM_CFLAGS) -pthread
