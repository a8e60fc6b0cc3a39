# client/load/local.mk - pccd-load, the load harness.

bin_PROGRAMS += pccd-load
dist_doc_DATA += client/load/pccd-load.gp
noinst_LTLIBRARIES += libload.la

# Everything but main, so that tests can link what they test.
libload_la_SOURCES = \
    client/load/actor.c \
    client/load/couple.c \
    client/load/assault.c \
    client/load/crowd.c \
    client/load/findings.c \
    client/load/flock.c \
    client/load/judge.c \
    client/load/options.c \
    client/load/report.c \
    client/load/series.c \
    client/load/shape.c \
    client/load/tally.c \
    client/load/target.c \
    client/load/watch.c
load_cppflags = -iquote $(top_srcdir)/client/load -iquote $(top_srcdir)/client/lib \
    -iquote $(top_srcdir)/proto $(tool_cppflags)
libload_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(load_cppflags)
libload_la_LIBADD = libtools.la

pccd_load_SOURCES = client/load/main.c
pccd_load_CPPFLAGS = $(libload_la_CPPFLAGS)
pccd_load_LDADD = libload.la libclient.la $(LIBM)

# Long runs; each fails unless everything is as it must be. README.md has the figures reached.
LOAD_CLIENTS = 1000
LOAD_REQUESTS = 1000
KILL_CLIENTS = 10000
KILL_WORKERS = 1000
SOAK_MINUTES = 30
GAMES = 64
GAME_TRIANGLES = 1k
GAME_HZ = 60
GAME_SECONDS = 60
GAME_PROCESSES = 4
GAME_OPTIONS =
.PHONY: load kills soak games
# Games that ask at each of their frames, whatever the answers do: 99 of a hundred answers
# within the frame. GAME_OPTIONS='--url direct:' for the engine in each process.
games: pccd-load$(EXEEXT) pccdd$(EXEEXT)
	./pccd-load --daemon ./pccdd --clients $(GAMES) --processes $(GAME_PROCESSES) \
	    --triangles $(GAME_TRIANGLES) --scene wave --kinds follow --hz $(GAME_HZ) \
	    --warm-up 2 --seconds $(GAME_SECONDS) \
	    --p99-ms $$(awk 'BEGIN { print 1000 / $(GAME_HZ) }') $(GAME_OPTIONS)
load: pccd-load$(EXEEXT) pccdd$(EXEEXT)
	./pccd-load --daemon ./pccdd --clients $(LOAD_CLIENTS) --requests $(LOAD_REQUESTS) \
	    --processes 8
kills: pccd-load$(EXEEXT) pccdd$(EXEEXT)
	./pccd-load --daemon ./pccdd --clients 64 --requests 1000 --victims 16 \
	    --kill-clients $(KILL_CLIENTS) --kill-worker $(KILL_WORKERS)
# Clients that ask some 60 times a second; one is killed four times a second, and the daemon
# once for each six minutes, all in the first sixth of the time: over the rest one worker's
# memory is to be flat.
soak: pccd-load$(EXEEXT) pccdd$(EXEEXT)
	./pccd-load --daemon ./pccdd --clients 50 --think-ms 16 --minutes $(SOAK_MINUTES) --flat \
	    --kill-clients $$(( 240 * $(SOAK_MINUTES) )) \
	    --kill-worker $$(( $(SOAK_MINUTES) / 6 ))
