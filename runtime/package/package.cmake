# The files for find_package(sightcell) and pkg-config. They contain relative paths only: the prefix may be moved.
include(CMakePackageConfigHelpers)

set(sightcell_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sightcell)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/sightcell-config-version.cmake
  COMPATIBILITY SameMajorVersion)
install(FILES runtime/package/sightcell-config.cmake runtime/package/sightcell-needs.cmake ${PROJECT_BINARY_DIR}/package/sightcell-config-version.cmake
  DESTINATION ${sightcell_cmake_dir} COMPONENT dev)
install(EXPORT sightcell-runtime NAMESPACE sightcell:: FILE sightcell-runtime-targets.cmake
  DESTINATION ${sightcell_cmake_dir} COMPONENT dev)
if(SIGHTCELL_BUILD_STREAM)
  install(FILES runtime/stream/package/sightcell-stream.cmake DESTINATION ${sightcell_cmake_dir} COMPONENT stream-dev)
  install(EXPORT sightcell-stream NAMESPACE sightcell:: FILE sightcell-stream-targets.cmake
    DESTINATION ${sightcell_cmake_dir} COMPONENT stream-dev)
endif()
if(SIGHTCELL_BUILD_BAKE)
  install(FILES bake/package/sightcell-bake.cmake bake/package/FindRecast.cmake
    DESTINATION ${sightcell_cmake_dir} COMPONENT bake-dev)
  install(EXPORT sightcell-bake NAMESPACE sightcell:: FILE sightcell-bake-targets.cmake
    DESTINATION ${sightcell_cmake_dir} COMPONENT bake-dev)
  install(EXPORT sightcell-tools NAMESPACE sightcell:: FILE sightcell-tools-targets.cmake
    DESTINATION ${sightcell_cmake_dir} COMPONENT tools)
endif()

# A .pc file finds the prefix relative to itself. An absolute folder, as some distributions set, stays absolute.
foreach(folder LIB INCLUDE)
  if(IS_ABSOLUTE ${CMAKE_INSTALL_${folder}DIR})
    set(sightcell_pc_${folder} ${CMAKE_INSTALL_${folder}DIR})
  else()
    set(sightcell_pc_${folder} "\${prefix}/${CMAKE_INSTALL_${folder}DIR}")
  endif()
endforeach()
file(RELATIVE_PATH sightcell_pc_up /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" sightcell_pc_up "${sightcell_pc_up}")
configure_file(runtime/package/sightcell.pc.in ${PROJECT_BINARY_DIR}/package/sightcell.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/package/sightcell.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

# One license file per component, at the path of Debian's packages.
set(sightcell_components runtime dev)
if(SIGHTCELL_BUILD_STREAM)
  list(APPEND sightcell_components stream-dev)
endif()
if(SIGHTCELL_BUILD_BAKE)
  list(APPEND sightcell_components bake-dev tools)
  install(FILES THIRD_PARTY.md CHANGELOG.md
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/sightcell-tools COMPONENT tools)
endif()
set(sightcell_runtime_package libsightcell1)
set(sightcell_dev_package libsightcell-dev)
set(sightcell_stream-dev_package libsightcell-stream-dev)
set(sightcell_bake-dev_package libsightcell-bake-dev)
set(sightcell_tools_package sightcell-tools)
foreach(component IN LISTS sightcell_components)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${sightcell_${component}_package} RENAME copyright
    COMPONENT ${component})
endforeach()

if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT CMAKE_CROSSCOMPILING)
  include(runtime/package/bundle.cmake)
endif()
if(PROJECT_IS_TOP_LEVEL AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
  include(runtime/package/deb.cmake)
endif()
