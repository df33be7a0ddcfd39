# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The deepest stack of an image for a Cortex-M: frames, who calls whom, and the deepest way through.

A function's frame is what gcc says (-fstack-usage, the .su files) or what its instructions take off the stack
pointer, whichever is more; assembly and the libraries have the second only. Who calls whom is read from the
disassembly: branches with and without a link. Calls through a pointer are on a written list, which must name every
function that makes one: what is not on it, and recursion, is an error.

Interrupts come on top: all handlers of one level cannot interrupt one another (nobody sets priorities), faults
interrupt them. Each pushes the processor's frame with the floating-point registers.
"""

import json
import re
import subprocess
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

EXCEPTION_FRAME = 108  # 8 words, 18 of the FPU, and 4 bytes to align (Armv7-M, B1.5.7)

_LABEL = re.compile(r"^([0-9a-f]+) <(.+)>:$")
_INSTRUCTION = re.compile(r"^\s*([0-9a-f]+):\t(\S+)(?:\t(.*))?$")
_TARGET = re.compile(r"\b([0-9a-f]+) <[^>]+>$")
_BRANCH = re.compile(r"^(b|bl|blx|cbz|cbnz|b(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le))(\.[nw])?$")
_REGISTER = re.compile(r"^([rsd])(\d+)$")
_NAMED = {"sl": 10, "fp": 11, "ip": 12, "sp": 13, "lr": 14, "pc": 15}


class StackError(Exception):
    """The stack cannot be worked out; the text is the one line that the user sees."""


@dataclass
class Function:
    """One label of the disassembly."""

    name: str
    address: int
    frame: int = 0
    calls: set[int] = field(default_factory=set)
    through_pointer: bool = False


@dataclass(frozen=True)
class Depth:
    """Bytes of the deepest way, and the functions on it."""

    bytes: int
    way: tuple[str, ...]


@dataclass(frozen=True)
class Calls:
    """The written list."""

    pointers: Mapping[str, Sequence[str]]
    vectors: Sequence[str]
    faults: Sequence[str]


@dataclass(frozen=True)
class StackUse:
    """Of an image."""

    main: Depth
    interrupt: Depth
    fault: Depth

    @property
    def bytes(self) -> int:
        return sum(depth.bytes for depth in (self.main, self.interrupt, self.fault))


def read_calls(path: Path) -> Calls:
    values = json.loads(path.read_text(encoding="utf-8"))
    return Calls(values["pointers"], values["vectors"], values["faults"])


def stack_use(image: Path, objects: Path, calls: Calls, prefix: str = "arm-none-eabi-") -> StackUse:
    """Of an ELF image, with the .su files anywhere under `objects`."""
    graph, symbols = read_graph(image, objects, calls, prefix)
    handlers = _handlers(image, symbols, calls, prefix)
    faults = {address for address in handlers if graph.name(address) in calls.faults}
    reset = handlers[0]
    return StackUse(
        graph.deepest([reset]),
        graph.deepest(set(handlers) - faults - {reset}, EXCEPTION_FRAME),
        graph.deepest(faults, EXCEPTION_FRAME),
    )


def read_graph(image: Path, objects: Path, calls: Calls, prefix: str = "arm-none-eabi-") -> tuple["Graph", list[str]]:
    """Who calls whom in an image, and its symbols as readelf lists them."""
    functions = read_functions(_tool(f"{prefix}objdump", "-d", "--no-show-raw-insn", str(image)).splitlines())
    symbols = _tool(f"{prefix}readelf", "-sW", str(image)).splitlines()
    raise_frames(functions, symbols, read_frames(objects))
    return Graph(functions, calls), symbols


def _tool(*command: str) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise StackError(f"{command[0]}: {error.strerror} ; run ./tools/setup check") from error
    if done.returncode != 0:
        raise StackError(f"{' '.join(command)} failed: {done.stderr.strip()}")
    return done.stdout


# --- the disassembly --------------------------------------------------------------------------------------------------


def read_functions(lines: Iterable[str]) -> dict[int, Function]:
    """By address."""
    functions: dict[int, Function] = {}
    branches: list[tuple[Function, int]] = []
    current: Function | None = None
    for line in lines:
        label = _LABEL.match(line)
        if label is not None:
            current = Function(label[2], int(label[1], 16))
            functions[current.address] = current
            continue
        found = _INSTRUCTION.match(line)
        if found is not None and current is not None:
            target = _read_instruction(current, found[2], (found[3] or "").split("@")[0].split(";")[0].strip())
            if target is not None:
                branches.append((current, target))
    starts = sorted(functions)
    for function, target in branches:
        owner = functions[starts[bisect_right(starts, target) - 1]]
        if owner is not function or target == function.address:
            function.calls.add(owner.address)
    return functions


def _read_instruction(function: Function, name: str, operands: str) -> int | None:
    """Adds what it does to the frame; returns where it branches to."""
    function.frame += _pushed(name, operands)
    # gcc loads the program counter for switches (from a table of the function's own) and returns only.
    is_jump = name in ("blx", "bx") or (name.startswith("mov") and operands.startswith("pc, "))
    if is_jump and operands.removeprefix("pc, ") != "lr" and "<" not in operands:
        function.through_pointer = True
    if _BRANCH.match(name) is None:
        return None
    target = _TARGET.search(operands)
    return int(target[1], 16) if target is not None else None


def _pushed(name: str, operands: str) -> int:
    """Bytes by which an instruction moves the stack pointer down."""
    if name.startswith(("push", "vpush")):
        return _bytes_of(operands)
    if name.startswith(("stmdb", "vstmdb")) and operands.startswith("sp!"):
        return _bytes_of(operands.partition(",")[2])
    if name.startswith("sub") and operands.startswith("sp"):
        amount = operands.rpartition("#")[2]
        if not amount.isdigit():
            raise StackError(f"'{name} {operands}' takes an amount from the stack that is not known")
        return int(amount)
    taken = re.search(r"\[sp, #-(\d+)\]!", operands)
    return int(taken[1]) if name.startswith("str") and taken else 0


def _bytes_of(registers: str) -> int:
    count = 0
    size = 4
    for part in registers.strip(" {}").split(","):
        first, _, last = part.strip().partition("-")
        low, size = _register(first)
        high, _ = _register(last or first)
        count += high - low + 1
    return count * size


def _register(name: str) -> tuple[int, int]:
    """Number and bytes."""
    found = _REGISTER.match(name)
    if found is None:
        return _NAMED[name], 4
    return int(found[2]), 8 if found[1] == "d" else 4


# --- gcc's frames -----------------------------------------------------------------------------------------------------


def read_frames(objects: Path) -> dict[tuple[str, str], int]:
    """By name of the source and of the function."""
    frames: dict[tuple[str, str], int] = {}
    for path in sorted(objects.rglob("*.su")):
        for line in path.read_text(encoding="utf-8").splitlines():
            place, size, kind = line.rsplit("\t", 2)
            source, _, _, name = place.rsplit(":", 3)
            if "dynamic" in kind and "bounded" not in kind:
                raise StackError(f"{source}: {name}() takes stack without a bound")
            key = (Path(source).name, name)
            frames[key] = max(frames.get(key, 0), int(size))
    if not frames:
        raise StackError(f"{objects} has no .su files ; compile with -fstack-usage")
    return frames


def raise_frames(
    functions: Mapping[int, Function], symbols: Iterable[str], frames: Mapping[tuple[str, str], int]
) -> None:
    """Each function's frame becomes at least what gcc says. A local one is known by the source that it stands under."""
    by_name: dict[str, int] = {}
    for (_, name), size in frames.items():
        by_name[name] = max(by_name.get(name, 0), size)
    source = ""
    for line in symbols:
        words = line.split()
        if len(words) < 8 or not words[0].rstrip(":").isdigit():
            continue
        address, kind, bind, name = int(words[1], 16) & ~1, words[3], words[4], words[7]
        if kind == "FILE":
            source = name
        elif kind == "FUNC" and address in functions:
            plain = name.partition(".")[0]
            said = frames.get((source, plain), 0) if bind == "LOCAL" else by_name.get(name, 0)
            functions[address].frame = max(functions[address].frame, said)


# --- the graph --------------------------------------------------------------------------------------------------------


class Graph:
    """Who calls whom, with the written list."""

    def __init__(self, functions: Mapping[int, Function], calls: Calls) -> None:
        self._functions = functions
        self._depths: dict[int, Depth] = {}
        self._open: list[int] = []
        self._unlisted: set[int] = set()
        named: dict[str, list[int]] = {}
        for address, function in functions.items():
            named.setdefault(function.name.partition(".")[0], []).append(address)
        for function in functions.values():
            if function.through_pointer:
                # What is on the list and not in the image cannot be called.
                listed = calls.pointers.get(function.name.partition(".")[0])
                function.calls.update(address for name in listed or () for address in named.get(name, ()))
                self._unlisted.update(() if listed is not None else (function.address,))

    def name(self, address: int) -> str:
        return self._functions[address].name

    def named(self, name: str) -> list[int]:
        return [address for address, function in self._functions.items() if function.name == name]

    def deepest(self, roots: Iterable[int], below: int = 0) -> Depth:
        found = max((self._depth(root) for root in roots), key=lambda depth: depth.bytes, default=None)
        return Depth(0, ()) if found is None else Depth(found.bytes + below, found.way)

    def _depth(self, address: int) -> Depth:
        if address in self._depths:
            return self._depths[address]
        function = self._functions[address]
        if address in self._unlisted:
            raise StackError(
                f"{function.name}() calls through a pointer ; name what it may call in the list of pointers"
            )
        if address in self._open:
            way = [self.name(at) for at in self._open[self._open.index(address) :]]
            raise StackError(f"{' calls '.join([*way, function.name])}: recursion has no bound")
        self._open.append(address)
        deepest = self.deepest(function.calls)
        self._open.pop()
        self._depths[address] = Depth(function.frame + deepest.bytes, (function.name, *deepest.way))
        return self._depths[address]


def _handlers(image: Path, symbols: Iterable[str], calls: Calls, prefix: str) -> list[int]:
    """What the vector tables hold, the reset first. The first word of the first table is the stack."""
    tables = {}
    for line in symbols:
        words = line.split()
        if len(words) >= 8 and words[3] == "OBJECT" and words[7] in calls.vectors:
            tables[words[7]] = (int(words[1], 16), int(words[2]))
    if calls.vectors[0] not in tables:
        raise StackError(f"{image} has no table '{calls.vectors[0]}' of vectors")
    handlers: list[int] = []
    for name in calls.vectors:
        if name in tables:
            begin, size = tables[name]
            words_of_table = _words(image, begin, size, prefix)
            handlers += [word & ~1 for word in words_of_table[1 if name == calls.vectors[0] else 0 :] if word != 0]
    return handlers


def _words(image: Path, begin: int, size: int, prefix: str) -> list[int]:
    text = _tool(
        f"{prefix}objdump", "-s", f"--start-address={begin:#x}", f"--stop-address={begin + size:#x}", str(image)
    )
    data = b""
    for line in text.splitlines():
        found = re.match(r"^ [0-9a-f]+ ((?:[0-9a-f]{2,8} ){1,4})", line)
        if found is not None:
            data += bytes.fromhex(found[1].replace(" ", ""))
    return [int.from_bytes(data[k : k + 4], "little") for k in range(0, size, 4)]
