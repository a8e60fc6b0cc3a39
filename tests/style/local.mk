# tests/style/local.mk
