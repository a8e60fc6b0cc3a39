# tests/dist/local.mk - what is handed out: the tarball and Debian's packages.
#
# make dist-check-reproducible   two tarballs of this commit have the same bytes, and all of it
# make deb-check                 the packages are built, in a copy, and lintian judges them
#
# Both take minutes and want what a build wants; the second debhelper, dh-python and lintian.

test_scripts += tests/dist/bootstrap_check.sh tests/dist/container_check.sh \
    tests/dist/cross_check.sh tests/dist/install_check.sh

.PHONY: dist-check-reproducible deb-check
dist-check-reproducible:
	$(BASH) $(srcdir)/tests/dist/dist_check.sh '$(abs_top_srcdir)' '$(distdir).tar.gz'
deb-check:
	$(BASH) $(srcdir)/tests/dist/deb_check.sh '$(abs_top_srcdir)' '$(abs_top_builddir)/deb'
