# tests/property/local.mk
