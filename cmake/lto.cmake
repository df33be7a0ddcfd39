# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# What link-time optimization is for (CMAKE_INTERPROCEDURAL_OPTIMIZATION, preset release): the simulator and the library,
# which run the core a million times. A program that is in no hurry would pay for the whole core's compilation anew at
# each link, so it links the machine code that the core's objects hold as well.

if(CMAKE_INTERPROCEDURAL_OPTIMIZATION AND CMAKE_C_COMPILER_ID STREQUAL "GNU")
    set(CMAKE_C_COMPILE_OPTIONS_IPO -flto=auto -ffat-lto-objects) # CMake's own choice leaves the machine code out
endif()

# elmopp_without_lto(<target>...): compiles and links these without link-time optimization.
function(elmopp_without_lto)
    foreach(target IN LISTS ARGV)
        set_target_properties(${target} PROPERTIES INTERPROCEDURAL_OPTIMIZATION OFF)
        target_link_options(${target} PRIVATE -fno-lto)
    endforeach()
endfunction()
