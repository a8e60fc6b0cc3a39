# daemon/systemd/local.mk - the units, with the path of the installed program.
#
# With the default folders, /usr/local/lib/systemd/system or /usr/lib/systemd/system, systemd
# finds them: systemd-sysusers && systemctl daemon-reload && systemctl enable --now pccdd.socket
# One's own: systemctl --user daemon-reload && systemctl --user enable --now pccdd.socket

systemdunit_DATA = daemon/systemd/pccdd.service daemon/systemd/pccdd.socket
systemduserunit_DATA = daemon/systemd/user/pccdd.service daemon/systemd/user/pccdd.socket
sysusersdir = $(prefix)/lib/sysusers.d
CLEANFILES += $(systemdunit_DATA) $(systemduserunit_DATA)

make_unit = $(AM_V_GEN)$(MKDIR_P) $(@D) && \
    sed 's|@bindir[@]|$(bindir)|; s|@sysconfdir[@]|$(sysconfdir)|' $(srcdir)/$@.in >$@.tmp && mv $@.tmp $@
daemon/systemd/pccdd.service: daemon/systemd/pccdd.service.in Makefile
	$(make_unit)
daemon/systemd/pccdd.socket: daemon/systemd/pccdd.socket.in Makefile
	$(make_unit)
daemon/systemd/user/pccdd.service: daemon/systemd/user/pccdd.service.in Makefile
	$(make_unit)
daemon/systemd/user/pccdd.socket: daemon/systemd/user/pccdd.socket.in Makefile
	$(make_unit)

# The folder has files of all packages, so this one is named after ours.
install-data-local:
	$(MKDIR_P) '$(DESTDIR)$(sysusersdir)'
	$(INSTALL_DATA) $(srcdir)/daemon/systemd/pccd.sysusers '$(DESTDIR)$(sysusersdir)/pccd.conf'
	$(MKDIR_P) '$(DESTDIR)$(sysconfdir)/pccd'
	test -e '$(DESTDIR)$(sysconfdir)/pccd/pccdd.conf' || \
	    $(INSTALL_DATA) $(srcdir)/daemon/systemd/pccdd.conf '$(DESTDIR)$(sysconfdir)/pccd/pccdd.conf'
uninstall-local:
	rm -f '$(DESTDIR)$(sysusersdir)/pccd.conf' '$(DESTDIR)$(sysconfdir)/pccd/pccdd.conf'
