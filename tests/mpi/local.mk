# tests/mpi/local.mk - one scene over the ranks of an MPI program. Without --with-mpi the
# scripts skip their cases by name.

mpi_test_scripts = tests/mpi/mpi_check.sh tests/mpi/namespaces_check.sh \
    tests/mpi/python_check.sh tests/mpi/recordings_check.sh
mpi_test_programs = tests/mpi/large tests/mpi/misuse tests/mpi/rounding tests/mpi/same_as_one \
    tests/mpi/stop
mpi_check_programs = $(mpi_test_programs) client/mpi/example/cloth_mpi
test_scripts += $(mpi_test_scripts)
if HAVE_MPI
check_PROGRAMS += $(mpi_test_programs)
mpi_test_libs = libpccd-mpi.la libpccd.la $(MPI_LIBS) $(LIBM)
tests_mpi_large_LDADD = $(mpi_test_libs)
tests_mpi_misuse_LDADD = $(mpi_test_libs)
tests_mpi_rounding_LDADD = $(mpi_test_libs)
tests_mpi_same_as_one_LDADD = libtests.la $(mpi_test_libs) $(GMP_LIBS)
tests_mpi_stop_LDADD = $(mpi_test_libs) -lpthread
check_LTLIBRARIES += tests/mpi/rest.la
tests_mpi_rest_la_SOURCES = tests/mpi/rest.c
tests_mpi_rest_la_LDFLAGS = -module -avoid-version -rpath $(abs_builddir)/tests/mpi
endif

# All of it, by both MPIs, each in a build of its own.
.PHONY: mpi-check
mpi-check:
	status=0; for mpi in openmpi mpich; do \
	    $(MKDIR_P) mpi-check/$$mpi && cd mpi-check/$$mpi && \
	    { test -e Makefile || \
	        $(abs_top_srcdir)/configure -q CC='$(CC)' --with-mpi=$$mpi \
	            --with-inspect=no --with-scenes='$(PCCD_SCENES)'; } && \
	    $(MAKE) all tests/mpi/rest.la $(mpi_check_programs) && \
	    RANKS_SECONDS=1800 $(MAKE) check-TESTS PCCD_MPI_ALL=1 \
	        check_PROGRAMS='$(mpi_check_programs)' \
	        TESTS='$(mpi_test_scripts)' || status=1; \
	    cd $(abs_top_builddir) || exit 1; \
	done; exit $$status
# 24 million triangles, which no rank has all of, on four ranks within 16 GiB: that much memory,
# and some minutes.
MPI_LARGE = 4 tests/mpi/large 2450 3 16384
.PHONY: mpi-large
mpi-large: tests/mpi/large libpccd-direct.la
	PCCD_MPI='$(with_mpi)' MPIEXEC='$(MPIEXEC)' RANKS_SECONDS=3600 PCCD_DIRECT=$(abs_builddir)/.libs/libpccd-direct.so.0 \
	    bash -c '. $(top_srcdir)/tests/mpi/ranks.sh && ranks $(MPI_LARGE)'
clean-local: clean-mpi
.PHONY: clean-mpi
clean-mpi:
	rm -rf mpi-check
