# SPDX-License-Identifier: Apache-2.0
# Finds the MuJoCo that is installed as a Python wheel, without importing it.
#
# Result: MuJoCoWheel_FOUND, MuJoCoWheel_VERSION, target mujoco::mujoco.

execute_process(
  COMMAND "${Python_EXECUTABLE}" -c
    "import importlib.metadata as m, importlib.util as u; \
print(m.version('mujoco') + ';' + list(u.find_spec('mujoco').submodule_search_locations)[0])"
  OUTPUT_VARIABLE _wheel
  OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET)

if(_wheel)
  list(GET _wheel 0 MuJoCoWheel_VERSION)
  list(GET _wheel 1 MuJoCoWheel_DIR)
  file(TO_CMAKE_PATH "${MuJoCoWheel_DIR}" MuJoCoWheel_DIR)
  find_path(MuJoCoWheel_INCLUDE_DIR mujoco/mujoco.h
    HINTS "${MuJoCoWheel_DIR}/include" NO_DEFAULT_PATH NO_CACHE)
  find_file(MuJoCoWheel_LIBRARY
    NAMES "libmujoco.so.${MuJoCoWheel_VERSION}" "libmujoco.${MuJoCoWheel_VERSION}.dylib"
      "mujoco.dll"
    HINTS "${MuJoCoWheel_DIR}" NO_DEFAULT_PATH NO_CACHE)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MuJoCoWheel
  REQUIRED_VARS MuJoCoWheel_LIBRARY MuJoCoWheel_INCLUDE_DIR
  VERSION_VAR MuJoCoWheel_VERSION
  REASON_FAILURE_MESSAGE "install the Python package mujoco for ${Python_EXECUTABLE}")

if(MuJoCoWheel_FOUND AND NOT TARGET mujoco::mujoco)
  add_library(mujoco::mujoco SHARED IMPORTED)
  set_target_properties(mujoco::mujoco PROPERTIES
    IMPORTED_LOCATION "${MuJoCoWheel_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${MuJoCoWheel_INCLUDE_DIR}")
  if(WIN32)
    # the wheel has no import library; MinGW links to the DLL itself
    set_target_properties(mujoco::mujoco PROPERTIES IMPORTED_IMPLIB "${MuJoCoWheel_LIBRARY}")
  endif()
endif()
