# Recast: Debian's comes without a CMake or pkg-config file, others bring a package of the name that is asked first.
# Gives RecastNavigation::Recast. Used by the build and by the installed sightcell-config.cmake.
find_package(recastnavigation CONFIG QUIET)
if(TARGET RecastNavigation::Recast)
  set(Recast_FOUND TRUE)
  return()
endif()

find_path(Recast_INCLUDE_DIR Recast.h PATH_SUFFIXES recastnavigation)
find_library(Recast_LIBRARY Recast)
mark_as_advanced(Recast_INCLUDE_DIR Recast_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Recast DEFAULT_MSG Recast_LIBRARY Recast_INCLUDE_DIR)
if(Recast_FOUND)
  add_library(RecastNavigation::Recast UNKNOWN IMPORTED)
  set_target_properties(RecastNavigation::Recast PROPERTIES
    IMPORTED_LOCATION ${Recast_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${Recast_INCLUDE_DIR})
endif()
