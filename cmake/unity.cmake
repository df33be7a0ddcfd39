# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# Provides the target `unity`, the test framework, from the first of these that is there:
#   1. an installed copy: a CMake package `unity` with double support (not for another processor), or the sources that the
#      Debian package cmock installs
#   2. UNITY_SOURCE_DIR, a folder with unity.c and unity.h
#   3. build/unity of the source folder, shared by all presets; cmake/fetch_unity.sh fills it once from
#      Debian trixie's package cmock or else Debian bookworm's source package cjson, by pinned SHA-256

# Tests compare doubles, so the library and every test must be compiled with them.
set(ELMOPP_UNITY_DEFINITIONS UNITY_INCLUDE_DOUBLE)

# An installed library is of use only if it was itself compiled with double support.
function(_elmopp_use_installed_unity_library found_var)
    set(${found_var} FALSE PARENT_SCOPE)
    find_package(unity CONFIG QUIET)
    if(NOT TARGET unity::framework)
        return()
    endif()
    include(CheckCSourceCompiles)
    set(CMAKE_REQUIRED_LIBRARIES unity::framework)
    set(CMAKE_REQUIRED_DEFINITIONS -DUNITY_INCLUDE_DOUBLE)
    check_c_source_compiles("
        #include <unity.h>
        void setUp(void) {}
        void tearDown(void) {}
        int main(void) { UNITY_BEGIN(); TEST_ASSERT_EQUAL_DOUBLE(1.0, 1.0); return UNITY_END(); }
        " ELMOPP_UNITY_LIBRARY_HAS_DOUBLE)
    if(ELMOPP_UNITY_LIBRARY_HAS_DOUBLE)
        add_library(unity INTERFACE)
        target_link_libraries(unity INTERFACE unity::framework)
        target_compile_definitions(unity INTERFACE ${ELMOPP_UNITY_DEFINITIONS})
        set(${found_var} TRUE PARENT_SCOPE)
    endif()
endfunction()

function(_elmopp_find_unity_source source_dir_var)
    find_path(ELMOPP_UNITY_INSTALLED_DIR NAMES unity.c
        PATHS /usr/local/share /usr/share
        PATH_SUFFIXES cmock/vendor/unity/src unity/src unity
        NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
    mark_as_advanced(ELMOPP_UNITY_INSTALLED_DIR)
    if(ELMOPP_UNITY_INSTALLED_DIR)
        set(${source_dir_var} "${ELMOPP_UNITY_INSTALLED_DIR}" PARENT_SCOPE)
        return()
    endif()

    if(UNITY_SOURCE_DIR)
        foreach(file IN ITEMS unity.c unity.h)
            if(NOT EXISTS "${UNITY_SOURCE_DIR}/${file}")
                message(FATAL_ERROR "UNITY_SOURCE_DIR=${UNITY_SOURCE_DIR}: no ${file} there; name the folder that holds unity.c and unity.h.")
            endif()
        endforeach()
        set(${source_dir_var} "${UNITY_SOURCE_DIR}" PARENT_SCOPE)
        return()
    endif()

    set(fetched_dir "${PROJECT_SOURCE_DIR}/build/unity")
    execute_process(COMMAND "${PROJECT_SOURCE_DIR}/cmake/fetch_unity.sh" "${fetched_dir}"
        RESULT_VARIABLE status ERROR_VARIABLE reasons ERROR_STRIP_TRAILING_WHITESPACE)
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "${reasons}")
    endif()
    set(${source_dir_var} "${fetched_dir}" PARENT_SCOPE)
endfunction()

set(unity_is_installed FALSE)
if(NOT CMAKE_CROSSCOMPILING)
    _elmopp_use_installed_unity_library(unity_is_installed)
endif()
if(unity_is_installed)
    message(STATUS "Unity: installed CMake package ${unity_DIR}")
else()
    _elmopp_find_unity_source(unity_dir)
    message(STATUS "Unity: ${unity_dir}")
    add_library(unity STATIC "${unity_dir}/unity.c")
    target_include_directories(unity SYSTEM PUBLIC "${unity_dir}")
    target_compile_definitions(unity PUBLIC ${ELMOPP_UNITY_DEFINITIONS})
    target_compile_options(unity PRIVATE -w)
endif()
