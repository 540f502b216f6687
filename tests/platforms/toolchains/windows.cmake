# 64-bit Windows: Debian's mingw-w64 with posix threads (std::thread); programs run under wine.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
# The libraries of the compiler are linked statically, so that programs and DLLs need no other files.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -fno-use-linker-plugin -B${CMAKE_CURRENT_LIST_DIR}/windows_linker")
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static)
# The prefix of wine is inside the build tree.
set(CMAKE_CROSSCOMPILING_EMULATOR ${CMAKE_CURRENT_LIST_DIR}/../run_wine ${CMAKE_BINARY_DIR}/wine)
set(CMAKE_FIND_ROOT_PATH /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
