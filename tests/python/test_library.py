# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""libelmopp.so as a program in Python sees it."""

import ctypes
import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from elmopp_tools import library, weights_image
from elmopp_tools.library import NO_STAGE, CoreJunction, FaultError, LibraryError
from elmopp_tools.site import load_site
from elmopp_tools.site_image import image_bytes
from elmopp_tools.weights_model import network as network_of
from elmopp_tools.weights_model import read_tensors

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = Path(os.environ["ELMOPP_LIBRARY"])
HEADER = (ROOT / "library" / "elmopp.h").read_text(encoding="utf-8")

JUNCTION = load_site(ROOT / "sites" / "four_way.toml")[0]
IMAGE = image_bytes(JUNCTION)


def test_it_shows_what_the_header_declares_and_nothing_else() -> None:
    listed = subprocess.run(
        ["nm", "-D", "--defined-only", LIBRARY], capture_output=True, text=True, check=True
    ).stdout.split()
    shown = {name.partition("@")[0] for name in listed if name.startswith("elmopp_")}
    declared = set(re.findall(r"\b(elmopp_\w+)\(", re.sub(r"///.*", "", HEADER)))
    assert shown == declared
    assert len(shown) == 14


def test_the_header_is_c_and_cplusplus(tmp_path: Path) -> None:
    for suffix, standard in ((".c", "c99"), (".cpp", "c++98")):
        source = tmp_path / f"user{suffix}"
        source.write_text('#include "elmopp.h"\nint main(void) { return (int)elmopp_abi_version() - 1; }\n')
        program = tmp_path / f"user{suffix}.out"
        words = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-std={standard}", f"-I{ROOT / 'library'}", str(source)]
        links = [str(LIBRARY), f"-Wl,-rpath,{LIBRARY.parent}", "-o", str(program)]
        subprocess.run(["g++" if suffix == ".cpp" else "gcc", *words, *links], check=True, timeout=60)
        assert subprocess.run([program], check=False, timeout=10).returncode == 0


def test_structs_have_the_sizes_of_the_header(tmp_path: Path) -> None:
    names = {"elmopp_options_t": library._Options, "elmopp_second_t": library._Second, "elmopp_shape_t": library.Shape}
    source = tmp_path / "sizes.c"
    prints = "".join(f'printf("%u ", (unsigned)sizeof({name}));' for name in names)
    source.write_text(f'#include "elmopp.h"\n#include <stdio.h>\nint main(void) {{ {prints} return 0; }}\n')
    subprocess.run(["gcc", "-I", ROOT / "library", source, "-o", tmp_path / "sizes"], check=True, timeout=60)
    said = subprocess.run([tmp_path / "sizes"], check=True, capture_output=True, text=True, timeout=10).stdout
    assert [int(word) for word in said.split()] == [ctypes.sizeof(struct) for struct in names.values()]


def test_a_junction_runs() -> None:
    with CoreJunction(IMAGE, "cumulative:lstm") as junction:
        assert junction.shape.movements == len(JUNCTION.movements)
        assert junction.shape.stages == len(JUNCTION.stages)
        assert junction.stage == NO_STAGE
        seen = set()
        for second in range(300):
            counts = [float((second // 40 + j) % 4 == 0) * 6.0 for j in range(junction.shape.movements)]
            junction.count(counts, [0.2] * junction.shape.movements)
            for _ in range(10):
                aspects = junction.tick()
                assert re.fullmatch("[1-4]{12}0000", aspects)
            if junction.stage != NO_STAGE:
                assert junction.stage_groups(junction.stage) == JUNCTION.stages[junction.stage]
                assert [a == "3" for a in aspects[:12]] == [
                    bool(JUNCTION.stages[junction.stage] >> g & 1) for g in range(12)
                ]
            seen.add(junction.stage)
        assert len(seen) > 3
        assert junction.foreseen_veh(0) > 0.0
        assert any(junction.score(stage) > 0.0 for stage in range(junction.shape.stages))
        assert junction.served(JUNCTION.stages[0]) != 0


def test_whoever_calls_may_choose_for_himself() -> None:
    with CoreJunction(IMAGE, "naive") as junction:
        for stage in range(len(JUNCTION.stages)):
            # A street's green rests where nobody waits.
            waiting = [5.0 * JUNCTION.serves(stage, movement) for movement in JUNCTION.movements]
            for _ in range(60):
                junction.count(waiting, waiting)
                for _ in range(10):
                    junction.tick(stage)
            assert junction.stage == junction.target == stage


def ticks_until(stage: int, *, occupied: bool) -> int:
    """From all red, with a site whose changes wait 4 s at most."""
    site = image_bytes(replace(JUNCTION, junction_wait_ds=40, red_bound_ds=3000))
    with CoreJunction(site, "naive") as junction:
        everybody = [5.0] * junction.shape.movements
        ticks = 0
        while junction.stage != stage and ticks < 600:
            junction.count(everybody, everybody, occupied=occupied)
            for _ in range(10):
                junction.tick(stage)
                ticks += junction.stage != stage
    return ticks


def test_a_change_waits_for_an_occupied_junction() -> None:
    # The wait runs from the first group's start; those whose intergreens are longer lose less.
    assert 20 <= ticks_until(3, occupied=True) - ticks_until(3, occupied=False) <= 40


@pytest.mark.parametrize(
    "chooser", ["max-pressure", "surtrac", "random", "pressure@h=2", "naive@frozen", "rollout:gcn"]
)
def test_rivals_and_options_are_known(chooser: str) -> None:
    with CoreJunction(IMAGE, chooser, travel_s=8, seed=5) as junction:
        full = [5.0] * junction.shape.movements
        for _ in range(30):
            junction.count(full, full, downstream_veh=[1.0] * junction.shape.movements)
            for _ in range(10):
                junction.tick()
        assert junction.target != NO_STAGE


def image_of(network: str) -> bytes:
    tensors, _ = read_tensors(ROOT / "weights" / "forecast.safetensors")
    return weights_image.image_bytes(network_of(tensors, network))


@pytest.mark.parametrize(
    ("network", "forecast"), [("lstm", "lstm"), ("lstm", "lstm-q15"), ("lstm", "ann"), ("nlstm", "gcn")]
)
def test_weights_serve_every_network_that_is_in_them(network: str, forecast: str) -> None:
    with CoreJunction(IMAGE, f"rollout:{forecast}", weights=image_of(network)) as junction:
        junction.count([1.0] * junction.shape.movements, [0.1] * junction.shape.movements)
        junction.tick()
        assert junction.target != NO_STAGE


def test_weights_of_another_recurrent_network_are_refused() -> None:
    with pytest.raises(
        LibraryError, match="networks for the forecasts nlstm, nlstm-q15, ann or gcn, the forecast is lstm"
    ):
        CoreJunction(IMAGE, "cumulative:lstm", weights=image_of("nlstm"))


def test_bad_requests_name_the_value() -> None:
    with pytest.raises(LibraryError, match='unknown chooser "nave"; right would be one of naive'):
        CoreJunction(IMAGE, "nave")
    with pytest.raises(LibraryError, match="right would be an image made by tools/site"):
        CoreJunction(IMAGE[:-1])
    with pytest.raises(LibraryError, match="right would be an image made by tools/weights"):
        CoreJunction(IMAGE, "cumulative:lstm", weights=b"ELMW")
    with pytest.raises(LibraryError, match="is missing"):
        library.load(Path("no/libelmopp.so"))
    with CoreJunction(IMAGE) as junction:
        full = [1.0] * junction.shape.movements
        with pytest.raises(LibraryError, match="finite numbers"):
            junction.count([float("nan"), *full[1:]], full)
        with pytest.raises(ValueError, match="size"):
            junction.count(full[1:], full)
        with pytest.raises(LibraryError, match="wish 99"):
            junction.tick(99)
        with pytest.raises(LibraryError, match="4 foreseen rows ; none, or forecast oracle"):
            junction.count(full, full, foreseen_veh=[[1.0]] * 4)
    with CoreJunction(IMAGE, "rollout:oracle") as junction:
        for rows, wrong in (
            ([], "0 foreseen rows ; a row of seconds an approach"),
            ([[1.0]] * 3, "4 of one length"),
            ([[1.0], [1.0], [1.0], [1.0, 2.0]], r"\[1, 1, 1, 2\] seconds ; 4 of one length"),
            ([[]] * 4, "of 0 seconds ; 1 to 150"),
            ([[1.0] * 151] * 4, "of 151 seconds ; 1 to 150"),
            ([[1.0], [1.0], [1.0], [-1.0]], "finite numbers"),
        ):
            with pytest.raises(LibraryError, match=wrong):
                junction.count(full, full, foreseen_veh=rows)
    assert issubclass(FaultError, Exception)


def test_an_oracles_rows_are_what_is_foreseen() -> None:
    with CoreJunction(IMAGE, "rollout:oracle") as junction:
        nobody = [0.0] * junction.shape.movements
        junction.count(nobody, nobody, foreseen_veh=[[float(approach)] * 50 for approach in range(4)])
        assert [junction.foreseen_veh(approach) for approach in range(4)] == [0.0, 50.0, 100.0, 150.0]
        junction.count(nobody, nobody, foreseen_veh=[[0.0, 1.0]] * 4)
        assert [junction.foreseen_veh(approach) for approach in range(4)] == [1.0] * 4


def test_junctions_are_independent() -> None:
    with CoreJunction(IMAGE, "naive") as first, CoreJunction(IMAGE, "naive") as second:
        for _ in range(300):
            first.tick(0)
        assert first.stage == 0
        assert second.stage == NO_STAGE
        first.close()
        first.close()
        second.tick()
