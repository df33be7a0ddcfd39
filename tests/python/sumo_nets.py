# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Small SUMO networks for tests, made with SUMO's own netconvert."""

import subprocess
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NETCONVERT = ROOT / "build" / "venv" / "sumo" / "bin" / "netconvert"

ARMS = {"N": (0, 300), "E": (300, 0), "S": (0, -300), "W": (-300, 0)}

# 12 links: right, straight, left of N, E, S, W. Left turns give way in the same phase; 3 s of amber.
CROSS = """\
<additional><tlLogic id="C" type="static" programID="0" offset="0">
<phase duration="31" state="GGgrrrGGgrrr"/><phase duration="3" state="yyyrrryyyrrr"/>
<phase duration="25" state="rrrGGgrrrGGg"/><phase duration="3" state="rrryyyrrryyy"/>
</tlLogic></additional>"""


def cross(
    folder: Path, *, pieces: int = 1, signal: str = "traffic_light", tls: str = CROSS, walked: bool = False
) -> Path:
    """Four arms of one lane each; the last 120 m before the stop line are cut into so many edges.

    `walked`: with sidewalks and crossings, and netconvert's own phases. A logic for N1 makes that place a signal too.
    """
    nodes = [f'<node id="C" x="0" y="0" type="{signal}"/>']
    edges = []
    for name, (x, y) in ARMS.items():
        stops = [(x, y), *((x * f / 300, y * f / 300) for f in (120 - 120 * i / pieces for i in range(pieces)))]
        names = [name, *(f"{name}{i}" for i in range(1, pieces + 1))] if pieces > 1 else [name]
        kinds = {"N1": 'type="traffic_light"'} if 'id="N1"' in tls else {}
        nodes += [
            f'<node id="{n}" x="{p[0]}" y="{p[1]}" {kinds.get(n, "")}/>' for n, p in zip(names, stops, strict=False)
        ]
        ways = [*names, "C"]
        for first, second in pairwise(ways):
            edges.append(f'<edge id="{first}_{second}" from="{first}" to="{second}" numLanes="1" speed="13.8"/>')
        edges.append(f'<edge id="C_{name}" from="C" to="{name}" numLanes="1" speed="13.8"/>')
    (folder / "n.nod.xml").write_text(f"<nodes>{''.join(nodes)}</nodes>")
    (folder / "n.edg.xml").write_text(f"<edges>{''.join(edges)}</edges>")
    (folder / "n.tll.xml").write_text(tls)
    net = folder / "cross.net.xml"
    words = ["-n", "n.nod.xml", "-e", "n.edg.xml", "-o", net.name, "--no-turnarounds", "--no-warnings"]
    if walked:
        words += ["--sidewalks.guess", "--crossings.guess"]
    elif tls and signal == "traffic_light":
        words += ["--tllogic-files", "n.tll.xml"]
    subprocess.run([NETCONVERT, *words], check=True, cwd=folder, capture_output=True, timeout=60)
    return net


def traffic(folder: Path, *, pieces: int = 1, end_s: int = 600, per_s: float = 0.1) -> Path:
    """Vehicles from everywhere to everywhere else, drawn by SUMO from its seed."""
    first = {name: f"{name}_{name}1" if pieces > 1 else f"{name}_C" for name in ARMS}
    flows = "".join(
        f'<flow id="{a}{b}" from="{first[a]}" to="C_{b}" begin="0" end="{end_s}" period="exp({per_s / 3:.4f})"/>'
        for a in ARMS
        for b in ARMS
        if a != b
    )
    file = folder / "cross.rou.xml"
    file.write_text(f"<routes>{flows}</routes>")
    return file
