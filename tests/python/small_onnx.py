# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""Writes small ONNX detectors whose detections are known: a vehicle is wherever a cell of 16 x 16 pixels is light.

The bytes are protobuf, written by hand, opset 12: the test needs no package for it.
"""

import struct
from collections.abc import Sequence

SIDE = 96  # of the input
CELL = 16
CELLS = SIDE // CELL
OPSET = 12
FLOAT = 1
INT64 = 7


def _varint(value: int) -> bytes:
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def _number(field: int, value: int) -> bytes:
    return _varint(field << 3) + _varint(value)


def _bytes(field: int, value: bytes | str) -> bytes:
    raw = value.encode() if isinstance(value, str) else value
    return _varint(field << 3 | 2) + _varint(len(raw)) + raw


def _tensor(name: str, dims: Sequence[int], values: Sequence[float], kind: int = FLOAT) -> bytes:
    raw = struct.pack(f"<{len(values)}{'f' if kind == FLOAT else 'q'}", *values)
    head = b"".join(_number(1, dim) for dim in dims)
    return head + _number(2, kind) + _bytes(8, name) + _bytes(9, raw)


def _shape(name: str, dims: Sequence[int]) -> bytes:
    shape = b"".join(_bytes(1, _number(1, dim)) for dim in dims)
    return _bytes(1, name) + _bytes(2, _bytes(1, _number(1, FLOAT) + _bytes(2, shape)))


def _whole(name: str, value: int) -> bytes:
    return _bytes(1, name) + _number(3, value) + _number(20, 2)


def _wholes(name: str, values: Sequence[int]) -> bytes:
    return _bytes(1, name) + b"".join(_number(8, value) for value in values) + _number(20, 7)


def _node(kind: str, inputs: Sequence[str], output: str, attributes: Sequence[bytes] = ()) -> bytes:
    body = b"".join(_bytes(1, name) for name in inputs) + _bytes(2, output) + _bytes(4, kind)
    return body + b"".join(_bytes(5, attribute) for attribute in attributes)


def _model(nodes: Sequence[bytes], tensors: Sequence[bytes], out: Sequence[int], side: int = SIDE) -> bytes:
    graph = b"".join(_bytes(1, node) for node in nodes) + _bytes(2, "cells")
    graph += b"".join(_bytes(5, tensor) for tensor in tensors)
    graph += _bytes(11, _shape("picture", [1, 3, side, side])) + _bytes(12, _shape("out", out))
    return _number(1, 7) + _bytes(7, graph) + _bytes(8, _bytes(1, "") + _number(2, OPSET))


def _cells() -> list[tuple[int, int]]:
    return [(x * CELL, y * CELL) for y in range(CELLS) for x in range(CELLS)]


def _light(shape: Sequence[int]) -> tuple[list[bytes], list[bytes]]:
    """The mean grey of each cell, in this shape."""
    nodes = [
        _node("Conv", ["picture", "mean"], "grey", [_wholes("kernel_shape", [1, 1])]),
        _node(
            "AveragePool", ["grey"], "cell", [_wholes("kernel_shape", [CELL, CELL]), _wholes("strides", [CELL, CELL])]
        ),
        _node("Reshape", ["cell", "shape"], "score"),
    ]
    tensors = [
        _tensor("mean", [1, 3, 1, 1], [1 / 3] * 3),
        _tensor("shape", [len(shape)], list(shape), INT64),
    ]
    return nodes, tensors


def yolo8() -> bytes:
    """[1, 4 + 1, N]."""
    many = CELLS * CELLS
    middles = [x + CELL / 2 for x, _ in _cells()] + [y + CELL / 2 for _, y in _cells()] + [float(CELL)] * 2 * many
    nodes, tensors = _light([1, 1, many])
    nodes.append(_node("Concat", ["boxes", "score"], "out", [_whole("axis", 1)]))
    return _model(nodes, [*tensors, _tensor("boxes", [1, 4, many], middles)], [1, 5, many])


def yolo5() -> bytes:
    """[1, N, 5 + 1]; the one kind is certain."""
    many = CELLS * CELLS
    boxes = [v for x, y in _cells() for v in (x + CELL / 2, y + CELL / 2, float(CELL), float(CELL))]
    nodes, tensors = _light([1, many, 1])
    nodes.append(_node("Concat", ["boxes", "score", "kind"], "out", [_whole("axis", 2)]))
    tensors += [_tensor("boxes", [1, many, 4], boxes), _tensor("kind", [1, many, 1], [1.0] * many)]
    return _model(nodes, tensors, [1, many, 6])


def ssd() -> bytes:
    """[1, 1, N, 7]: all of them cars by COCO's number."""
    many = CELLS * CELLS
    before = [v for _ in _cells() for v in (0.0, 3.0)]
    after = [v / SIDE for x, y in _cells() for v in (x, y, x + CELL, y + CELL)]
    nodes, tensors = _light([1, 1, many, 1])
    nodes.append(_node("Concat", ["kinds", "score", "boxes"], "out", [_whole("axis", 3)]))
    tensors += [_tensor("kinds", [1, 1, many, 2], before), _tensor("boxes", [1, 1, many, 4], after)]
    return _model(nodes, tensors, [1, 1, many, 7])


def no_detector() -> bytes:
    """A model that OpenCV runs, whose output is no detector's."""
    nodes, tensors = _light([1, CELLS * CELLS])
    nodes[2] = _node("Reshape", ["cell", "shape"], "out")
    return _model(nodes, tensors, [1, CELLS * CELLS])
