# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""The counter on clips that were counted by eye, of a folder that ELMOPP_CLIPS names: they are not ours to ship."""

import os
import sys
from pathlib import Path

import pytest
from elmopp_tools import score_counter

SKIPPED = 77


def test_the_clips_are_counted_as_well_as_the_document_says() -> None:
    report = score_counter.score_folder(Path(os.environ["ELMOPP_CAMERA"]), Path(os.environ["ELMOPP_CLIPS"]), True)
    print(score_counter.table_of(report))
    assert report["pooled"]["lane_error"] <= 0.05
    assert report["pooled"]["f1"] >= 0.95
    for name, clip in report["clips"].items():
        assert not clip["flags"], name
        if clip["truth"]:
            assert clip["lane_error"] <= 0.08, name
        if clip["presence_error"] is not None:
            assert clip["presence_error"] <= 1.0, name
            assert clip["learning"], name


if __name__ == "__main__":
    if not os.environ.get("ELMOPP_CLIPS"):
        print("skipped: ELMOPP_CLIPS names no folder of clips with counted truth")
        sys.exit(SKIPPED)
    sys.exit(pytest.main(["-q", "-s", __file__]))
