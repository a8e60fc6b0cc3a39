# daemon/systemd/local.mk - the units, with the path of the installed program.
#
# With the default folders, /usr/local/lib/systemd/system or /usr/lib/systemd/system, systemd
# finds them: systemd-sysusers && systemctl daemon-reload && systemctl enable --now pccdd.socket

systemdunit_DATA = daemon/systemd/pccdd.service daemon/systemd/pccdd.socket
sysusersdir = $(prefix)/lib/sysusers.d
EXTRA_DIST += daemon/systemd/pccdd.service.in daemon/systemd/pccdd.socket.in \
    daemon/systemd/pccd.sysusers
CLEANFILES += $(systemdunit_DATA)

daemon/systemd/pccdd.service: daemon/systemd/pccdd.service.in Makefile
	$(AM_V_GEN)$(MKDIR_P) daemon/systemd && \
	    sed 's|@bindir[@]|$(bindir)|' $(srcdir)/daemon/systemd/pccdd.service.in >$@.tmp && \
	    mv $@.tmp $@
daemon/systemd/pccdd.socket: daemon/systemd/pccdd.socket.in Makefile
	$(AM_V_GEN)$(MKDIR_P) daemon/systemd && \
	    cp $(srcdir)/daemon/systemd/pccdd.socket.in $@.tmp && mv $@.tmp $@

# The folder has files of all packages, so this one is named after ours.
install-data-local:
	$(MKDIR_P) '$(DESTDIR)$(sysusersdir)'
	$(INSTALL_DATA) $(srcdir)/daemon/systemd/pccd.sysusers '$(DESTDIR)$(sysusersdir)/pccd.conf'
uninstall-local:
	rm -f '$(DESTDIR)$(sysusersdir)/pccd.conf'

TESTS += tests/integration/unit_check.sh
dist_check_SCRIPTS += tests/integration/unit_check.sh
