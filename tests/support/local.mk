# tests/support/local.mk
