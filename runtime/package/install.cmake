# sightcell_install(TARGET EXPORT runtime|stream|bake|tools COMPONENT dev|stream-dev|bake-dev|tools): one line per target
# that is installed. Components: runtime (libsightcell.so.1), dev (to build against it, shared or static), stream-dev (for
# clients of streamed scenes), bake-dev (the bake half as libraries), tools (the programs), bundle (a folder that needs no
# packages; see bundle.cmake).
function(sightcell_install target)
  if(NOT SIGHTCELL_INSTALL)
    return()
  endif()
  cmake_parse_arguments(arg "" "EXPORT;COMPONENT" "" ${ARGN})
  get_target_property(header_sets ${target} HEADER_SETS)
  set(headers)
  if(header_sets)
    set(headers FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${arg_COMPONENT})
  endif()
  get_target_property(type ${target} TYPE)
  set(program_component ${arg_COMPONENT})
  if(type STREQUAL "SHARED_LIBRARY")
    set(program_component runtime)  # a DLL
  endif()
  install(TARGETS ${target} EXPORT sightcell-${arg_EXPORT}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${program_component}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${arg_COMPONENT}
    ${headers})
endfunction()

# sightcell_install_in_bundle(TARGET): a program that only the bundle has, for a machine where nothing can be built.
function(sightcell_install_in_bundle target)
  if(SIGHTCELL_INSTALL)
    install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT bundle EXCLUDE_FROM_ALL)
  endif()
endfunction()
