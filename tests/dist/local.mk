# tests/dist/local.mk - what is handed out: the tarball and Debian's packages.
#
# make dist-check-reproducible   two tarballs of this commit have the same bytes, and all of it
# make deb-check                 the packages are built, in a copy, and lintian judges them
#
# Both take minutes and want what a build wants; the second debhelper, dh-python and lintian.

TESTS += tests/dist/bootstrap_check.sh tests/dist/container_check.sh \
    tests/dist/cross_check.sh tests/dist/install_check.sh
dist_check_SCRIPTS += tests/dist/bootstrap_check.sh tests/dist/container_check.sh \
    tests/dist/cross_check.sh tests/dist/install_check.sh

EXTRA_DIST += tests/dist/deb_check.sh tests/dist/dist_check.sh
.PHONY: dist-check-reproducible deb-check
dist-check-reproducible:
	$(BASH) $(srcdir)/tests/dist/dist_check.sh '$(abs_top_srcdir)' '$(distdir).tar.gz'
deb-check:
	$(BASH) $(srcdir)/tests/dist/deb_check.sh '$(abs_top_srcdir)' '$(abs_top_builddir)/deb'

EXTRA_DIST += \
    debian/changelog debian/control debian/copyright debian/rules \
    debian/libpccd0.install debian/libpccd0.symbols \
    debian/libpccd-direct0.install debian/libpccd-direct0.symbols \
    debian/libpccd-dev.examples debian/libpccd-dev.install \
    debian/libpccd-mpi0.install debian/libpccd-mpi0.symbols \
    debian/libpccd-mpi-dev.install debian/libpccd-mpi-dev.examples \
    debian/pccd.install \
    debian/pccd-blender.docs debian/pccd-blender.install \
    debian/pccd-mpi.install \
    debian/python3-pccd.examples debian/python3-pccd.install \
    debian/source/format \
    debian/tests/blender debian/tests/control debian/tests/library debian/tests/python debian/tests/service
