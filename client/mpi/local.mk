# client/mpi/local.mk - libpccd-mpi and pccd-mpi, where configure was told of an MPI.
#
# As with libpccd, all of the library is a convenience library, which our own program has within.

ranks_sources = \
    client/mpi/answer.c \
    client/mpi/side_scene.c \
    client/mpi/balance.c \
    client/mpi/bounds.c \
    client/mpi/boxes.c \
    client/mpi/cut.c \
    client/mpi/depth.c \
    client/mpi/features.c \
    client/mpi/gather.c \
    client/mpi/ghosts.c \
    client/mpi/local.c \
    client/mpi/merge.c \
    client/mpi/meshes.c \
    client/mpi/motions.c \
    client/mpi/near.c \
    client/mpi/near_objects.c \
    client/mpi/nearest.c \
    client/mpi/neighbours.c \
    client/mpi/objects.c \
    client/mpi/parts.c \
    client/mpi/pieces.c \
    client/mpi/vertex_owners.c \
    client/mpi/rank_link.c \
    client/mpi/rank_sort.c \
    client/mpi/rank_stop.c \
    client/mpi/records.c \
    client/mpi/margins.c \
    client/mpi/sending.c \
    client/mpi/sides.c \
    client/mpi/step.c \
    client/mpi/world.c
mpi_program_sources = \
    client/mpi/program/check.c \
    client/mpi/program/deal.c \
    client/mpi/program/first.c \
    client/mpi/program/main.c \
    client/mpi/program/near.c \
    client/mpi/program/part.c \
    client/mpi/program/part_open.c \
    client/mpi/program/part_weld.c \
    client/mpi/program/recordings.c \
    client/mpi/program/replay.c \
    client/mpi/program/together.c \
    client/mpi/program/verify.c
ranks_cppflags = -iquote $(top_srcdir)/client/mpi -iquote $(top_srcdir)/client/lib

if HAVE_MPI
noinst_LTLIBRARIES += libranks.la
lib_LTLIBRARIES += libpccd-mpi.la
bin_PROGRAMS += pccd-mpi
include_HEADERS += client/mpi/pccd_mpi.h
pkgconfig_DATA += client/mpi/pccd-mpi.pc

libranks_la_SOURCES = $(ranks_sources)
libranks_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(ranks_cppflags) $(MPI_CPPFLAGS) $(XXHASH_CFLAGS)
libranks_la_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
libranks_la_LDFLAGS = $(OPENMP_CFLAGS)
libpccd_mpi_la_SOURCES =
libpccd_mpi_la_LIBADD = libranks.la libpccd.la $(MPI_LIBS) $(LIBM)
libpccd_mpi_la_LDFLAGS = $(AM_LDFLAGS) -no-undefined -version-info 0:0:0 \
    -Wl,--version-script=$(top_srcdir)/client/mpi/libpccd-mpi.map
EXTRA_libpccd_mpi_la_DEPENDENCIES = client/mpi/libpccd-mpi.map

pccd_mpi_SOURCES = $(mpi_program_sources)
pccd_mpi_CPPFLAGS = $(PCCD_CPPFLAGS) $(ctl_cppflags) -iquote $(top_srcdir)/client/mpi $(MPI_CPPFLAGS) \
    $(JANSSON_CFLAGS)
pccd_mpi_LDADD = libranks.la libctl.la libclient.la liboracle.la $(MPI_LIBS) $(JANSSON_LIBS) $(LIBM)

# Completion, as of pccdctl.
mpi_completion = client/mpi/program/completion
if RUNS_PROGRAMS
bashcompletion_DATA += $(mpi_completion)/pccd-mpi
zshcompletion_DATA += $(mpi_completion)/_pccd-mpi
fishcompletion_DATA += $(mpi_completion)/pccd-mpi.fish
endif
$(mpi_completion)/pccd-mpi: pccd-mpi$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) $(mpi_completion) && $(EMULATOR) ./pccd-mpi$(EXEEXT) completion bash >$@.tmp && mv $@.tmp $@
$(mpi_completion)/_pccd-mpi: pccd-mpi$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) $(mpi_completion) && $(EMULATOR) ./pccd-mpi$(EXEEXT) completion zsh >$@.tmp && mv $@.tmp $@
$(mpi_completion)/pccd-mpi.fish: pccd-mpi$(EXEEXT)
	$(AM_V_GEN)$(MKDIR_P) $(mpi_completion) && $(EMULATOR) ./pccd-mpi$(EXEEXT) completion fish >$@.tmp && mv $@.tmp $@

# For mpirun; tests/mpi/mpi_check.sh runs it.
check_PROGRAMS += client/mpi/example/cloth_mpi
client_mpi_example_cloth_mpi_LDADD = libpccd-mpi.la libpccd.la $(MPI_LIBS) $(LIBM)
endif
