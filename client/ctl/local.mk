# client/ctl/local.mk - pccdctl, the command line.
