# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# The guided tour, docs/tour.md: every command of it, with the programs of the preset release, which tools/check builds
# before this one.

elmopp_add_python_test(NAME test_tour COMMAND -m pytest -q -m "not others" tests/python/test_tour.py LABELS sim web TIMEOUT 900)
elmopp_add_python_test(NAME tour_board COMMAND -m pytest -q -m others tests/python/test_tour.py LABELS sim nightly TIMEOUT 1800)
set_tests_properties(test_tour tour_board PROPERTIES RESOURCE_LOCK out_tour)
set_tests_properties(test_tour PROPERTIES COST 90) # longer than any other of this preset: it must not be left alone at the end
