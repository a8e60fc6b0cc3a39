# tests/truth/local.mk
