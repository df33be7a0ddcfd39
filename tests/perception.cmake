# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# The camera room's tests. They draw their own scenes; clips with counted truth are scored where there is a folder of
# them: ../shared/video, or the one that ELMOPP_CLIPS names (option or environment).

set(ELMOPP_CLIPS "$ENV{ELMOPP_CLIPS}" CACHE PATH "Folder of clips with counted truth, for the test camera_clips")

add_library(camera_scene OBJECT perception/scene.cpp perception/roads.cpp)
target_include_directories(camera_scene PUBLIC perception)
target_link_libraries(camera_scene PUBLIC elmopp_perception PRIVATE elmopp_flags)
set_target_properties(camera_scene PROPERTIES INTERPROCEDURAL_OPTIMIZATION OFF)

# Drawn traffic takes most of a minute under -Og and two under the sanitizers, which watch the counter at night.
set(camera_tests test_background test_camera_files test_counter)
if((NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION) AND depends_on_no_build)
    list(APPEND camera_tests test_health)
endif()
foreach(name IN LISTS camera_tests)
    elmopp_add_unity_test(NAME ${name}
        SOURCES perception/${name}.cpp ${PROJECT_SOURCE_DIR}/host_files/core_assert.c $<TARGET_OBJECTS:camera_scene>
        LIBS camera_scene elmopp_perception
        LABELS unit camera
        TIMEOUT 600)
    elmopp_without_lto(${name})
endforeach()
set_tests_properties(test_counter PROPERTIES COST 100) # among the longest: it must not be left alone at the end
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    set_tests_properties(test_counter PROPERTIES LABELS "unit;camera;nightly")
endif()

add_executable(draw_scene perception/draw_scene.cpp ${PROJECT_SOURCE_DIR}/host_files/core_assert.c $<TARGET_OBJECTS:camera_scene>)
set_target_properties(draw_scene PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin/tests")
target_link_libraries(draw_scene PRIVATE camera_scene elmopp_perception elmopp_flags nlohmann_json::nlohmann_json)
elmopp_without_lto(draw_scene)

add_executable(find_vehicles perception/find_vehicles.cpp ${PROJECT_SOURCE_DIR}/host_files/core_assert.c)
set_target_properties(find_vehicles PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin/tests")
target_link_libraries(find_vehicles PRIVATE elmopp_perception elmopp_flags)
elmopp_without_lto(find_vehicles)

add_executable(copy_clip perception/copy_clip.cpp)
set_target_properties(copy_clip PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin/tests")
target_link_libraries(copy_clip PRIVATE elmopp_perception elmopp_flags)
elmopp_without_lto(copy_clip)
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    target_compile_options(copy_clip PRIVATE -O2)
    target_compile_options(camera_scene PRIVATE -O2)
endif()

if(depends_on_no_build)
    set(camera_environment
        "ELMOPP_CAMERA=$<TARGET_FILE:elmopp-camera>;ELMOPP_DRAW_SCENE=$<TARGET_FILE:draw_scene>;ELMOPP_FIND_VEHICLES=$<TARGET_FILE:find_vehicles>;ELMOPP_COPY_CLIP=$<TARGET_FILE:copy_clip>;ELMOPP_CLIPS=${ELMOPP_CLIPS}")
    foreach(name IN ITEMS test_camera_program test_camera_model test_camera_live test_camera_rtsp test_camera_http test_count_scores)
        elmopp_add_python_test(NAME ${name} COMMAND -m pytest -q tests/python/${name}.py LABELS camera TIMEOUT 300)
        set_tests_properties(${name} PROPERTIES ENVIRONMENT "${camera_environment}")
    endforeach()
    # Drawn roads, each with its floor: minutes.
    elmopp_add_python_test(NAME camera_roads COMMAND tests/python/camera_roads.py LABELS camera nightly TIMEOUT 3600)
    set_tests_properties(camera_roads PROPERTIES ENVIRONMENT "${camera_environment};PYTHONPATH=${PROJECT_SOURCE_DIR}/tools")
    # A camera of Video4Linux, which the kernel of a virtual machine has: a minute.
    add_test(NAME camera_v4l2
        COMMAND tools/with-can -m vivid build/venv/check/bin/python -m pytest -q tests/python/test_camera_v4l2.py
        WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
    _elmopp_set_test_properties(camera_v4l2 "camera;nightly" 400)
    set_tests_properties(camera_v4l2 PROPERTIES ENVIRONMENT "${camera_environment}")
    elmopp_add_python_test(NAME camera_clips COMMAND tests/python/camera_clips.py LABELS camera TIMEOUT 300)
    set_tests_properties(camera_clips PROPERTIES ENVIRONMENT "${camera_environment};PYTHONPATH=${PROJECT_SOURCE_DIR}/tools")
endif()
