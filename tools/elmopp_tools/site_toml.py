# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Reads a site file: TOML bytes to a document whose keys and types are those of site_schema.json."""

import json
import math
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema

from elmopp_tools.site_model import SiteError

SCHEMA_PATH = Path(__file__).with_name("site_schema.json")
TOML_INTEGER_BITS = 63


def read_document(source: bytes) -> dict[str, Any]:
    """Parses and schema-checks the bytes of a site file; SiteError names the key and the value."""
    document = _parse(source)
    for path, value in _leaves(document, ""):
        _check_number(path, value)
    _check_schema(document)
    return document


def _parse(source: bytes) -> dict[str, Any]:
    try:
        text = source.decode("utf-8")
    except UnicodeDecodeError as error:
        raise SiteError("is not UTF-8", f"byte {error.start}", "TOML is UTF-8 text") from None
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise SiteError("is nested too deep", "arrays or tables", "at most two levels are needed") from None
    except ValueError as error:
        raise SiteError(f"is not TOML: {error}", _line_of(text, str(error)), "TOML 1.0, every key once") from None


def _line_of(text: str, message: str) -> str:
    """The line of the text that the parser's message points at."""
    found = re.search(r"at line (\d+)", message)
    lines = text.split("\n")
    return lines[int(found[1]) - 1].strip() if found else lines[-1].strip()


def _leaves(value: Any, path: str) -> Iterator[tuple[str, object]]:
    """Every value that is neither table nor array, with its key path."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _leaves(item, f"{path}[{index}]")
    else:
        yield path, value


def _check_number(path: str, value: object) -> None:
    """TOML knows nan and inf, a junction does not; a comparison with nan would let it through every limit."""
    if isinstance(value, float) and not math.isfinite(value):
        raise SiteError(f"{path} is not finite", str(value), "a finite number")
    if isinstance(value, int) and value.bit_length() > TOML_INTEGER_BITS:
        raise SiteError(f"{path} is too large", value, "TOML integers have 64 bits")


def _check_schema(document: dict[str, Any]) -> None:
    schema = json.loads(SCHEMA_PATH.read_text(encoding="utf-8"))
    errors = list(jsonschema.Draft202012Validator(schema).iter_errors(document))
    if errors:
        raise _explain(min(errors, key=_reading_order))


def _reading_order(error: jsonschema.ValidationError) -> tuple[bool, list[str]]:
    """Unknown keys first: a misspelt key is also a missing one, and the misspelling is the cause."""
    return error.validator != "additionalProperties", [f"{part:>8}" for part in error.absolute_path]


def _explain(error: jsonschema.ValidationError) -> SiteError:
    path = _key_path(error)
    where = path or "the file"
    limit: Any = error.validator_value
    schema: Any = error.schema
    instance: Any = error.instance
    match error.validator:
        case "additionalProperties":
            known = list(schema["properties"])
            unknown = [key for key in instance if key not in known]
            full = f"{path}.{unknown[0]}" if path else unknown[0]
            return SiteError(
                "has an unknown key", full, f"known {'in ' + path if path else 'here'}: {', '.join(known)}"
            )
        case "required":
            missing = [key for key in limit if key not in instance]
            return SiteError(f"{where} lacks a key", missing[0], f"needed: {', '.join(limit)}")
        case "type":
            return SiteError(f"{path} has the wrong type", instance, _type_names(limit))
        case "enum":
            return SiteError(f"{path} is not known", instance, f"one of {', '.join(limit)}")
        case "minItems" | "maxItems":
            bound = "at least" if error.validator == "minItems" else "at most"
            return SiteError(f"{path} has {len(instance)} entries", instance, f"{bound} {limit}")
        case "uniqueItems":
            return SiteError(f"{path} names something twice", instance, "every name once")
        case "minimum" | "maximum":
            too = "small" if error.validator == "minimum" else "large"
            bound = "at least" if error.validator == "minimum" else "at most"
            return SiteError(f"{path} is too {too}", instance, f"{bound} {limit}")
        case _:
            return SiteError(f"{where}: {error.message}", instance, f"see {SCHEMA_PATH.name}")


def _type_names(types: str | list[str]) -> str:
    """JSON Schema's type names in TOML's words."""
    words = {"object": "a table", "array": "an array", "integer": "an integer"}
    return " or ".join(words.get(name, f"a {name}") for name in ([types] if isinstance(types, str) else types))


def _key_path(error: jsonschema.ValidationError) -> str:
    text = ""
    for part in error.absolute_path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{part}" if text else str(part)
    return text
