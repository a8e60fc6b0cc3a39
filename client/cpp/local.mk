# client/cpp/local.mk - for programs in C++ and for projects that are built by CMake.
#
# pccd.hpp is all there is for C++; nothing of it is compiled here. CMake is told the same of
# what is installed and, with -Dpccd_DIR=BUILD, of what lies in the build folder. Folders are
# told from that of the file, so that an installation may be moved as a whole.

include_HEADERS += client/cpp/pccd.hpp
cmakedir = $(libdir)/cmake/pccd
cmake_DATA = client/cpp/pccdConfig.cmake pccdConfigVersion.cmake
noinst_DATA += pccdConfig.cmake
CLEANFILES += client/cpp/pccdConfig.cmake pccdConfig.cmake

cmake_from = $(SED) -e "s|@LIBRARIES@|$$libraries|" -e "s|@INCLUDES@|$$includes|" \
    $(srcdir)/client/cpp/pccdConfig.cmake.in > $@.new && mv $@.new $@
client/cpp/pccdConfig.cmake: client/cpp/pccdConfig.cmake.in Makefile
	$(AM_V_GEN)$(MKDIR_P) client/cpp && \
	    libraries=`realpath -ms --relative-to='$(cmakedir)' '$(libdir)'` && \
	    includes=`realpath -ms --relative-to='$(cmakedir)' '$(includedir)'` && $(cmake_from)
pccdConfig.cmake: client/cpp/pccdConfig.cmake.in Makefile
	$(AM_V_GEN)libraries=.libs includes=include && $(cmake_from)
