# find_package(sightcell [0.1] [COMPONENTS runtime stream bake tools])
#   runtime (also when none is named): sightcell::runtime, static, and sightcell::runtime_shared; needs nothing else
#   stream: sightcell::stream, static, for clients of streamed scenes; needs zlib and libmd
#   bake: sightcell::bake, sightcell::scene, sightcell::picture, sightcell::format_write; needs its libraries
#   tools: the programs sightcell::cli and sightcell::city, for add_custom_command
# Each component is a file in this folder, present if the component is installed.
if(NOT sightcell_FIND_COMPONENTS)
  set(sightcell_FIND_COMPONENTS runtime)
endif()

# Sets sightcell_<component>_FOUND, and sightcell_missing to the reason when it is not.
macro(sightcell_load component)
  set(sightcell_missing)
  if(NOT "${component}" MATCHES "^(runtime|stream|bake|tools)$")
    set(sightcell_missing "there is no component '${component}', only runtime, stream, bake and tools")
  elseif(NOT EXISTS "${CMAKE_CURRENT_LIST_DIR}/sightcell-${component}-targets.cmake")
    set(sightcell_missing "component '${component}' is not installed in ${CMAKE_CURRENT_LIST_DIR}")
    if("${component}" STREQUAL "bake")
      string(APPEND sightcell_missing ", only the runtime is: install the component bake-dev "
        "(Debian: libsightcell-bake-dev) of a build with SIGHTCELL_BUILD_BAKE=ON")
    elseif("${component}" STREQUAL "stream")
      string(APPEND sightcell_missing ": install the component stream-dev (Debian: libsightcell-stream-dev) of a build "
        "with SIGHTCELL_BUILD_STREAM=ON")
    else()
      string(APPEND sightcell_missing ": install the component tools (Debian: sightcell-tools)")
    endif()
  elseif("${component}" MATCHES "^(stream|bake)$")
    include("${CMAKE_CURRENT_LIST_DIR}/sightcell-${component}.cmake")  # finds the libraries that it needs
  endif()
  if(sightcell_missing)
    set(sightcell_${component}_FOUND FALSE)
  else()
    include("${CMAKE_CURRENT_LIST_DIR}/sightcell-${component}-targets.cmake")
    set(sightcell_${component}_FOUND TRUE)
  endif()
endmacro()

set(sightcell_FOUND TRUE)
set(sightcell_reasons)
# The other components use the targets of the runtime.
sightcell_load(runtime)
foreach(sightcell_component IN LISTS sightcell_FIND_COMPONENTS)
  if(NOT sightcell_component STREQUAL "runtime")
    sightcell_load(${sightcell_component})
    if(sightcell_missing AND sightcell_FIND_REQUIRED_${sightcell_component})
      set(sightcell_FOUND FALSE)
      list(APPEND sightcell_reasons "${sightcell_missing}")
    elseif(sightcell_missing AND NOT sightcell_FIND_QUIETLY)
      message(STATUS "sightcell: ${sightcell_missing}")
    endif()
  endif()
endforeach()
if(sightcell_reasons)
  list(JOIN sightcell_reasons "\n  sightcell: " sightcell_NOT_FOUND_MESSAGE)
  set(sightcell_NOT_FOUND_MESSAGE "sightcell: ${sightcell_NOT_FOUND_MESSAGE}")
endif()
