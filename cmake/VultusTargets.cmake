# Every target of ours: C++20, warnings as errors, no compiler extensions.
add_library(vultus_flags INTERFACE)
target_compile_features(vultus_flags INTERFACE cxx_std_20)
target_compile_options(vultus_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)  # GCC 12 takes "text" + string for an overlap (its bug 105651)
target_include_directories(vultus_flags INTERFACE "${CMAKE_SOURCE_DIR}")
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE}")
endif()

# A folder that has headers only is still a library that others link.
set(VULTUS_EMPTY_SOURCE "${CMAKE_BINARY_DIR}/empty.cpp")
file(CONFIGURE OUTPUT "${VULTUS_EMPTY_SOURCE}" CONTENT "namespace vultus {}\n")

# vultus_stage(NAME USES stage…): the library of one folder, its sources found by name, plus a check that its files
# include headers of the named stages only.
function(vultus_stage name)
  cmake_parse_arguments(STAGE "" "" "USES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/${name}/*.cpp")
  if(NOT sources)
    set(sources "${VULTUS_EMPTY_SOURCE}")
  endif()
  add_library(vultus_${name} STATIC ${sources})
  target_link_libraries(vultus_${name} PUBLIC vultus_flags Eigen3::Eigen nlohmann_json::nlohmann_json)
  foreach(used ${STAGE_USES})
    target_link_libraries(vultus_${name} PUBLIC vultus_${used})
  endforeach()
  set_property(GLOBAL APPEND_STRING PROPERTY VULTUS_HOUSE "${name}: ${name} ${STAGE_USES}\n")
  string(REPLACE ";" "," allowed "${name};${STAGE_USES}")
  add_custom_command(
    OUTPUT "${CMAKE_BINARY_DIR}/house/${name}.checked"
    COMMAND "${CMAKE_COMMAND}" "-DFOLDER=${CMAKE_SOURCE_DIR}/${name}" "-DALLOWED=${allowed}"
            "-DSTAMP=${CMAKE_BINARY_DIR}/house/${name}.checked" -P "${CMAKE_SOURCE_DIR}/cmake/CheckHouse.cmake"
    DEPENDS ${sources} "${CMAKE_SOURCE_DIR}/cmake/CheckHouse.cmake"
    COMMENT "Checking what ${name} includes")
  add_custom_target(house_${name} DEPENDS "${CMAKE_BINARY_DIR}/house/${name}.checked")
  add_dependencies(vultus_${name} house_${name})
endfunction()
