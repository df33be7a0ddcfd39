# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Every way in which tools/mutate breaks a C file: one token or one statement at a time."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

# What a token may become. Masks are numbers here: & and | are swapped like && and ||.
SWAPS: dict[str, tuple[str, ...]] = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
    "+": ("-",),
    "-": ("+",),
    "*": ("+",),
    "&&": ("||",),
    "||": ("&&",),
    "&": ("|",),
    "|": ("&",),
    "^": ("|",),
    "|=": ("=", "&="),
    "^=": ("=",),
    "<<": (">>",),
    ">>": ("<<",),
    "!": ("",),
    "~": ("",),
    "++": ("--",),
    "true": ("false",),
    "false": ("true",),
}
TOKEN = re.compile(
    r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"])*\"|'(?:\\.|[^'])*'|^\s*#[^\n]*(?:\\\n[^\n]*)*"
    r"|->|\+\+|--|<<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|0[xX][0-9A-Fa-f]+U?|\d+\.\d+F?|\d+U?|\w+|\S",
    re.DOTALL | re.MULTILINE,
)
# `*` and `&` after one of these, and `-` too, have one operand.
BEFORE_UNARY = re.compile(r"[(,=!&|?:{;<>+*/-]$|return$|\)$")
STATEMENT = re.compile(r"^( +)(?! |return\b|const\b|static\b|typedef\b|break\b|case\b|else\b)[^\n{}]*;$", re.MULTILINE)
DECLARATION = re.compile(r"^ *(?:u?int\d+_t|bool|float|elmopp_\w+_t)\b \*?\w+(?:\[\w+\])?(?: =.*)?;$")


@dataclass(frozen=True)
class Mutant:
    """A changed room. `key` says what was changed, and stays the same when other lines change."""

    room: str
    key: str
    line: int
    text: str


def mutants_of(root: Path, room: str) -> list[Mutant]:
    """All mutants of a room, in the order of its text."""
    text = (root / "firmware" / "src" / f"{room}.c").read_text(encoding="utf-8")
    seen: dict[str, int] = {}
    mutants = []
    for start, end, after in sorted(_changes(text)):
        line = text.count("\n", 0, start) + 1
        code = text.splitlines()[line - 1].strip()
        before = text[start:end]
        name = f"{room}: {code} : dropped" if before == code else f"{room}: {code} : {before} -> {after or 'nothing'}"
        seen[name] = seen.get(name, 0) + 1
        key = name if seen[name] == 1 else f"{name} ({seen[name]})"
        mutants.append(Mutant(room, key, line, text[:start] + after + text[end:]))
    return mutants


def _changes(text: str) -> Iterator[tuple[int, int, str]]:
    yield from _token_changes(text)
    for match in STATEMENT.finditer(text):
        if not DECLARATION.match(match[0]):
            yield match.start() + len(match[1]), match.end(), ";"


def _token_changes(text: str) -> Iterator[tuple[int, int, str]]:
    last = ""
    for match in TOKEN.finditer(text):
        token = match[0]
        if token.startswith(("/*", "//", '"', "'")) or token.lstrip().startswith("#"):
            continue
        unary = token in ("*", "&", "-", "+") and (not last or BEFORE_UNARY.search(last) is not None)
        pointer = match[0] == "*" and re.search(r"_t$|^const$|^void$|^char$", last) is not None
        if token in SWAPS and not unary and not pointer:
            for other in SWAPS[token]:
                yield match.start(), match.end(), other
        elif re.fullmatch(r"(?:0[xX][0-9A-Fa-f]+|\d+)U?", token):
            yield from ((match.start(), match.end(), other) for other in _next_numbers(token))
        last = token


def _next_numbers(token: str) -> list[str]:
    suffix = "U" if token.endswith("U") else ""
    value = int(token.rstrip("U"), 0)
    return [f"{other}{suffix}" for other in (value + 1, value - 1) if other >= 0]
