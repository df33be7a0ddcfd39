# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""The plain LSTM in onnxruntime, as fast as it gets there, and a check that it is the same network.

One thread, batch 1, weights as constants, inputs and outputs bound once so that a run allocates and copies nothing.
What our forecast does besides (clamp, scale) is left out here.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from statistics import median

import numpy as np
import onnxruntime
from numpy.typing import NDArray
from onnx import ModelProto, NodeProto, TensorProto, helper, numpy_helper

from elmopp_tools.bench_report import Theirs
from elmopp_tools.weights_model import INPUTS, UNITS, Network, Tensor

ROLLOUT = 60
LONG = 1060
TOLERANCE = 1e-5
CHECKED_STEPS = 5  # of a rollout; after that a network may make much of a small difference
BLOCKS = 151
OPSET = 17
IR_VERSION = 10

# Shapes of a step: one second, one junction.
ONE_INPUT = (1, 1, INPUTS)
ONE_STATE = (1, 1, UNITS)

Run = Callable[[], None]


class NotTheSameError(Exception):
    """onnxruntime computes something else than the equations of the firmware."""


@dataclass(frozen=True)
class Bound:
    """A run, and the arrays that it reads and writes."""

    run: Run
    given: dict[str, Tensor]
    said: dict[str, Tensor]


# --- the graphs -------------------------------------------------------------------------------------------------------


def _onnx_order(columns: Tensor) -> Tensor:
    """Our gates lie in the order i, f, o, g; ONNX wants i, o, f, c."""
    i, f, o, g = np.split(columns, 4, axis=-1)
    return np.concatenate([i, o, f, g], axis=-1)


def _constants(network: Network) -> list[TensorProto]:
    level = network.levels[0]
    bias = _onnx_order(level.bias)
    tensors = {
        "W": _onnx_order(level.weight[:INPUTS]).T[np.newaxis],
        "R": _onnx_order(level.weight[INPUTS:]).T[np.newaxis],
        "B": np.concatenate([bias, np.zeros_like(bias)])[np.newaxis],
        "head_weight": network.head.weight,
        "head_bias": network.head.bias,
    }
    return [numpy_helper.from_array(np.ascontiguousarray(tensor), name) for name, tensor in tensors.items()]


def _lstm(given: str, step: int) -> NodeProto:
    """From hidden<step> and cell<step> to those of the next step."""
    before = [f"hidden{step}", f"cell{step}"]
    after = [f"hidden{step + 1}", f"cell{step + 1}"]
    return helper.make_node("LSTM", [given, "W", "R", "B", "", *before], ["", *after], hidden_size=UNITS)


def _head(step: int) -> list[NodeProto]:
    """From hidden<step> to input<step>: what the network says is what it sees next."""
    product = helper.make_node("MatMul", [f"hidden{step}", "head_weight"], [f"product{step}"])
    return [product, helper.make_node("Add", [f"product{step}", "head_bias"], [f"input{step}"])]


def _model(network: Network, nodes: list[NodeProto], steps: int, outputs: list[str]) -> ModelProto:
    shapes = {"input0": (steps, 1, INPUTS), "hidden0": ONE_STATE, "cell0": ONE_STATE}
    infos = [helper.make_tensor_value_info(name, TensorProto.FLOAT, shape) for name, shape in shapes.items()]
    results = [helper.make_tensor_value_info(name, TensorProto.FLOAT, _shape(name)) for name in outputs]
    used = {name for node in nodes for name in node.input}
    constants = [constant for constant in _constants(network) if constant.name in used]
    graph = helper.make_graph(nodes, "lstm", infos, results, constants)
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION)


def _shape(name: str) -> tuple[int, ...]:
    return ONE_INPUT if name.startswith("input") else ONE_STATE


def _given_model(network: Network, steps: int) -> ModelProto:
    """Sees `steps` given inputs in one node; no head."""
    return _model(network, [_lstm("input0", 0)], steps, ["hidden1", "cell1"])


def _rollout_model(network: Network, steps: int) -> ModelProto:
    """Sees one input, then `steps` times what it says."""
    nodes = [node for step in range(steps) for node in (_lstm(f"input{step}", step), *_head(step + 1))]
    said = [f"input{step}" for step in range(1, steps + 1)]
    return _model(network, nodes, 1, [*said, f"hidden{steps}", f"cell{steps}"])


# --- sessions ---------------------------------------------------------------------------------------------------------


def _session(model: ModelProto) -> onnxruntime.InferenceSession:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    options.inter_op_num_threads = 1
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_ALL
    return onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])


def _bind(session: onnxruntime.InferenceSession, given: dict[str, Tensor], said: dict[str, Tensor]) -> Bound:
    """The arrays themselves are bound: a run reads them and writes to them."""
    binding = session.io_binding()
    for name, array in given.items():
        binding.bind_input(name, "cpu", 0, np.float32, array.shape, array.ctypes.data)
    for name, array in said.items():
        binding.bind_output(name, "cpu", 0, np.float32, array.shape, array.ctypes.data)
    return Bound(partial(session.run_with_iobinding, binding), given, said)


def _zeros(names: list[str]) -> dict[str, Tensor]:
    return {name: np.zeros(_shape(name), np.float32) for name in names}


def _state(inputs: Tensor) -> dict[str, Tensor]:
    """Inputs [second, input] with a state that is not zero."""
    units = np.arange(UNITS).reshape(ONE_STATE)
    given = np.array(inputs[:, np.newaxis, :], order="C")
    hidden, cell = np.sin(units) / 2, np.cos(units)
    return {"input0": given, "hidden0": hidden.astype(np.float32), "cell0": cell.astype(np.float32)}


def given_run(network: Network, inputs: Tensor) -> Bound:
    """One run over given inputs."""
    return _bind(_session(_given_model(network, len(inputs))), _state(inputs), _zeros(["hidden1", "cell1"]))


def unrolled_run(network: Network, inputs: Tensor) -> Bound:
    """One run of a graph that holds the steps of a whole rollout after the first input."""
    names = [f"input{step}" for step in range(1, ROLLOUT + 1)] + [f"hidden{ROLLOUT}", f"cell{ROLLOUT}"]
    return _bind(_session(_rollout_model(network, ROLLOUT)), _state(inputs[:1]), _zeros(names))


def stepwise_runs(network: Network, inputs: Tensor) -> tuple[Bound, Bound]:
    """Two runs of one step with the head, where each reads what the other wrote: nothing is copied in between."""
    session = _session(_rollout_model(network, 1))
    first = _bind(session, _state(inputs[:1]), _zeros(["input1", "hidden1", "cell1"]))
    swapped_given = {f"{name[:-1]}0": array for name, array in first.said.items()}
    swapped_said = {f"{name[:-1]}1": array for name, array in first.given.items()}
    return first, _bind(session, swapped_given, swapped_said)


# --- is it the same network? ------------------------------------------------------------------------------------------


def _sigmoid(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(1.0 / (1.0 + np.exp(-x)))


def numpy_steps(network: Network, inputs: Tensor) -> Iterator[dict[str, NDArray[np.float64]]]:
    """The firmware's equations in double precision, over given inputs and then, without end, over what is said."""
    level = network.levels[0]
    weight, bias = level.weight.astype(np.float64), level.bias.astype(np.float64)
    start = _state(inputs)
    hidden, cell = start["hidden0"].ravel().astype(np.float64), start["cell0"].ravel().astype(np.float64)
    seen = 0
    said = np.zeros(INPUTS)
    while True:
        given = inputs[seen].astype(np.float64) if seen < len(inputs) else said
        i, f, o, g = np.split(np.concatenate([given, hidden]) @ weight + bias, 4)
        cell = _sigmoid(f) * cell + _sigmoid(i) * np.tanh(g)
        hidden = _sigmoid(o) * np.tanh(cell)
        said = hidden @ network.head.weight + network.head.bias
        seen += 1
        yield {"input": said, "hidden": hidden, "cell": cell}


def _compare(what: str, theirs: Tensor, right: NDArray[np.float64]) -> None:
    difference = float(np.max(np.abs(theirs.ravel() - right)))
    if not difference <= TOLERANCE:
        raise NotTheSameError(f"{what} differs by {difference:.2g} from the firmware's equations")


def _check_given(network: Network, inputs: Tensor) -> None:
    run = given_run(network, inputs)
    run.run()
    right = [step for step, _ in zip(numpy_steps(network, inputs), inputs, strict=False)][-1]
    for name in ("hidden", "cell"):
        _compare(f"onnxruntime's {name} after {len(inputs)} steps", run.said[f"{name}1"], right[name])


def _check_rollouts(network: Network, inputs: Tensor) -> None:
    unrolled = unrolled_run(network, inputs)
    unrolled.run()
    pair = stepwise_runs(network, inputs)
    for step, right in zip(range(1, CHECKED_STEPS + 1), numpy_steps(network, inputs[:1]), strict=False):
        run = pair[(step - 1) % 2]
        run.run()
        _compare(f"step {step} of onnxruntime's stepwise rollout", run.said["input1"], right["input"])
        _compare(f"step {step} of onnxruntime's unrolled rollout", unrolled.said[f"input{step}"], right["input"])


def some_inputs() -> Tensor:
    """Of the size of real ones: arrivals a second in units of their mean."""
    return np.random.default_rng(1).uniform(0.0, 2.0, (LONG, INPUTS)).astype(np.float32)


def check(network: Network) -> None:
    inputs = some_inputs()
    for steps in (1, 1 + ROLLOUT):
        _check_given(network, inputs[:steps])
    _check_rollouts(network, inputs)


# --- how fast is it? --------------------------------------------------------------------------------------------------


class Clocked:
    """The runs that are clocked, made once."""

    def __init__(self, network: Network) -> None:
        inputs = some_inputs()
        self._one = given_run(network, inputs[:1])
        self._sixty = given_run(network, inputs[: 1 + ROLLOUT])
        self._long = given_run(network, inputs)
        self._unrolled = unrolled_run(network, inputs)
        self._pair = stepwise_runs(network, inputs)

    def _rollout(self) -> None:
        first, second = (each.run for each in self._pair)
        for _ in range(ROLLOUT // 2):
            first()
            second()

    def measure(self) -> Theirs:
        """Medians over blocks of about a millisecond in turn: shorter than what another program takes the core for."""
        blocks = [self._block() for _ in range(BLOCKS)]
        one, sixty, long, runs, unrolled = (median(column) for column in zip(*blocks, strict=True))
        return Theirs(
            step_ns=(sixty - one) / ROLLOUT * 1e3,
            long_step_ns=(long - sixty) / (LONG - 1 - ROLLOUT) * 1e3,
            run_us=one,
            rollout60_runs_us=runs,
            rollout60_unrolled_us=unrolled,
        )

    def _block(self) -> list[float]:
        counts = [(self._one.run, 100), (self._sixty.run, 30), (self._long.run, 3)]
        return [_microseconds(*each) for each in [*counts, (self._rollout, 2), (self._unrolled.run, 2)]]


def _microseconds(work: Run, times: int) -> float:
    """A call's share of so many, after one that does not count."""
    work()
    begin = time.perf_counter_ns()
    for _ in range(times):
        work()
    return (time.perf_counter_ns() - begin) / times / 1e3
