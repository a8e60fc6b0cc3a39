# tests/mpi/local.mk - one scene over the ranks of an MPI program. Without --with-mpi the
# scripts skip their cases by name.

mpi_test_sources = tests/mpi/same_as_one.c
EXTRA_DIST += $(mpi_test_sources)
if HAVE_MPI
check_PROGRAMS += tests/mpi/same_as_one
tests_mpi_same_as_one_SOURCES = tests/mpi/same_as_one.c
tests_mpi_same_as_one_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/client/mpi \
    -iquote $(top_srcdir)/client/lib -iquote $(top_srcdir)/tests/support $(MPI_CPPFLAGS)
tests_mpi_same_as_one_LDADD = libpccd-mpi.la libpccd.la libtestscenes.la $(MPI_LIBS) $(LIBM)
endif
