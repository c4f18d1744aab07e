"""Converts TensorFlow.js graph models (`model.json` and its binary weights) to ONNX.

The format is that of `tensorflowjs_converter`: a TensorFlow graph of constants, whose values are in the binary file,
and of operations on arrays with the channels last. Operations whose inputs are all constant are computed here. Only the
operations in `_OPERATIONS` and `_FOLDED` are known, which are those of the detector that `weights` converts.
"""

import base64
import dataclasses
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from ....datatypes import validation as v

OPSET = 17
_TYPES = {"float32": np.float32, "int32": np.int32, "bool": np.bool_, "float16": np.float16, "uint8": np.uint8}
_CHANNELS_FIRST, _CHANNELS_LAST = (0, 3, 1, 2), (0, 2, 3, 1)


def to_onnx(model: pathlib.Path) -> onnx.ModelProto:
    """Converts `model` (the JSON file); the weights lie beside it under the names it states.

    Raises:
      ValidationError: not such a model, weights of another size, or an operation that is not known.
    """
    body = v.read_json(model, "TensorFlow.js model")
    try:
        nodes, signature = body["modelTopology"]["node"], body["signature"]
        values = _weights(model.parent, body["weightsManifest"])
    except (KeyError, TypeError, ValueError) as error:
        raise v.fail(str(model), f"no graph model ({error})", "one of tensorflowjs_converter", "check it") from error
    graph = _Graph(values)
    for node in _ordered(nodes):
        graph.add(node)
    inputs = [_value_info(spec["name"], spec) for spec in signature["inputs"].values()]
    outputs = []
    for spec in sorted(signature["outputs"].values(), key=lambda s: s["name"]):
        graph.emit("Identity", [_name(spec["name"])], spec["name"])
        outputs.append(_value_info(spec["name"], spec))
    for info in inputs:
        plain = _name(info.name)
        if plain != info.name:
            graph.made.insert(0, helper.make_node("Identity", [info.name], [plain]))
    made = helper.make_graph(graph.made, model.stem, inputs, outputs, graph.initializers())
    out = helper.make_model(made, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=8)
    onnx.checker.check_model(out)
    return out


def _weights(folder: pathlib.Path, manifest: list[dict[str, Any]]) -> dict[str, np.ndarray]:
    """The values of all constants by name."""
    values: dict[str, np.ndarray] = {}
    for group in manifest:
        data = b"".join((folder / path).read_bytes() for path in group["paths"])
        at = 0
        for spec in group["weights"]:
            stored = spec.get("quantization", spec)["dtype"]
            count = int(np.prod(spec["shape"], dtype=np.int64))
            size = count * np.dtype(_TYPES[stored]).itemsize
            if at + size > len(data):
                raise ValueError(f"weights of {len(data)} bytes end before those of {spec['name']}")
            array = np.frombuffer(data, _TYPES[stored], count, at).reshape(spec["shape"])
            if stored == "uint8":
                array = array.astype(np.float32) * spec["quantization"]["scale"] + spec["quantization"]["min"]
            values[spec["name"]] = array.astype(_TYPES[spec["dtype"]])
            at += size
        if at != len(data):
            raise ValueError(f"weights of {len(data)} bytes, of which the manifest names {at}")
    return values


def _ordered(nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The nodes so that each follows its inputs; the format promises no order."""
    by_name = {node["name"]: node for node in nodes}
    done: dict[str, dict[str, Any]] = {}
    stack = [(node, False) for node in reversed(nodes)]
    while stack:
        node, visited = stack.pop()
        if node["name"] in done:
            continue
        if visited:
            done[node["name"]] = node
            continue
        stack.append((node, True))
        for source in node.get("input", []):
            name = source.removeprefix("^").split(":")[0]
            if name not in done:
                stack.append((by_name[name], False))
    return list(done.values())


def _name(source: str) -> str:
    """TensorFlow's "name:0" is the array "name"."""
    return source.removesuffix(":0")


def _value_info(name: str, spec: dict[str, Any]) -> onnx.ValueInfoProto:
    if spec["dtype"] != "DT_FLOAT":
        raise v.fail(name, f"type {spec['dtype']}", "DT_FLOAT", "use another model")
    return helper.make_tensor_value_info(name, TensorProto.FLOAT, [int(d["size"]) for d in spec["tensorShape"]["dim"]])


@dataclasses.dataclass
class _Graph:
    """The ONNX graph while it is built.

    Attributes:
      values: constants by name, those computed here among them.
      made: nodes of the ONNX graph.
      used: names of the constants that nodes use.
    """

    values: dict[str, np.ndarray]
    made: list[onnx.NodeProto] = dataclasses.field(default_factory=list)
    used: set[str] = dataclasses.field(default_factory=set)

    def add(self, node: dict[str, Any]) -> None:
        """Adds a node of the TensorFlow graph."""
        kind, name = node["op"], node["name"]
        inputs = [_name(s) for s in node.get("input", []) if not s.startswith("^")]
        if kind in ("Const", "Placeholder"):
            return
        if kind in _FOLDED and all(source in self.values for source in inputs):
            self.values[name] = np.asarray(_FOLDED[kind](*(self.values[s] for s in inputs)))
        elif kind in _OPERATIONS:
            _OPERATIONS[kind](self, _Node(name, kind, inputs, node.get("attr", {})))
        else:
            known = ", ".join(sorted({*_OPERATIONS, *_FOLDED}))
            raise v.fail(name, f"the operation {kind}", f"one of {known}", "use another model")

    def emit(self, kind: str, inputs: list[str], *outputs: str, **attributes: Any) -> None:
        """Adds a node of the ONNX graph."""
        self.used.update(name for name in inputs if name in self.values)
        self.made.append(helper.make_node(kind, inputs, list(outputs), **attributes))

    def constant(self, name: str, value: np.ndarray) -> str:
        """Stores a constant and returns its name."""
        self.values[name] = value
        return name

    def initializers(self) -> list[onnx.TensorProto]:
        """The constants that are used."""
        return [numpy_helper.from_array(np.ascontiguousarray(self.values[n]), n) for n in sorted(self.used)]


@dataclasses.dataclass(frozen=True)
class _Node:
    """A node of the TensorFlow graph."""

    name: str
    kind: str
    inputs: list[str]
    attributes: dict[str, Any]

    def text(self, key: str) -> str:
        """An attribute that is a word; the format stores it in base 64."""
        return base64.b64decode(self.attributes[key]["s"]).decode()

    def numbers(self, key: str) -> list[int]:
        """An attribute that is a list of whole numbers."""
        return [int(x) for x in self.attributes.get(key, {}).get("list", {}).get("i", [])]

    def value(self, graph: _Graph, number: int) -> np.ndarray:
        """An input that has to be constant."""
        if self.inputs[number] not in graph.values:
            raise v.fail(
                self.name, f"{self.kind} with computed {self.inputs[number]}", "a constant", "use another model"
            )
        return graph.values[self.inputs[number]]

    def spatial(self, key: str) -> list[int]:
        """The two middle ones of four numbers for batch, rows, columns and channels."""
        four = self.numbers(key) or [1, 1, 1, 1]
        if self.attributes.get("data_format") is not None and self.text("data_format") != "NHWC":
            raise v.fail(self.name, f"the format {self.text('data_format')}", "NHWC", "use another model")
        return four[1:3]

    def padding(self) -> dict[str, str]:
        """ONNX's name of the padding."""
        names = {"VALID": "VALID", "SAME": "SAME_UPPER"}
        if self.text("padding") not in names:
            raise v.fail(self.name, f"the padding {self.text('padding')}", "VALID or SAME", "use another model")
        return {"auto_pad": names[self.text("padding")]}


def _with_channels_first(graph: _Graph, node: _Node, kind: str, more: list[str], **attributes: Any) -> None:
    """An operation of ONNX, whose images have the channels first, between two transpositions; ONNX Runtime removes
    those that cancel."""
    name = node.name
    graph.emit("Transpose", [node.inputs[0]], f"{name}/first", perm=_CHANNELS_FIRST)
    graph.emit(kind, [f"{name}/first", *more], f"{name}/made", **attributes)
    graph.emit("Transpose", [f"{name}/made"], name, perm=_CHANNELS_LAST)


def _convolution(graph: _Graph, node: _Node) -> None:
    kernel = graph.constant(f"{node.name}/kernel", node.value(graph, 1).transpose(3, 2, 0, 1))
    strides, dilations = node.spatial("strides"), node.spatial("dilations")
    _with_channels_first(graph, node, "Conv", [kernel], strides=strides, dilations=dilations, **node.padding())


def _max_pool(graph: _Graph, node: _Node) -> None:
    size, strides = node.spatial("ksize"), node.spatial("strides")
    _with_channels_first(graph, node, "MaxPool", [], kernel_shape=size, strides=strides, **node.padding())


def _resize(graph: _Graph, node: _Node) -> None:
    flags = {key: node.attributes.get(key, {}).get("b", False) for key in ("half_pixel_centers", "align_corners")}
    if flags["align_corners"] or not flags["half_pixel_centers"]:
        raise v.fail(node.name, f"ResizeBilinear with {flags}", "centres of pixels", "use another model")
    rows, columns = (int(x) for x in node.value(graph, 1))
    # Sizes of batch and channels, which ONNX asks for as well, are taken from the array itself.
    first = f"{node.name}/first"
    graph.emit("Transpose", [node.inputs[0]], first, perm=_CHANNELS_FIRST)
    graph.emit("Shape", [first], f"{node.name}/batch", start=0, end=2)
    size = graph.constant(f"{node.name}/size", np.array([rows, columns], np.int64))
    graph.emit("Concat", [f"{node.name}/batch", size], f"{node.name}/sizes", axis=0)
    how = {"mode": "linear", "coordinate_transformation_mode": "half_pixel"}
    graph.emit("Resize", [first, "", "", f"{node.name}/sizes"], f"{node.name}/made", **how)
    graph.emit("Transpose", [f"{node.name}/made"], node.name, perm=_CHANNELS_LAST)


def _pad(graph: _Graph, node: _Node) -> None:
    amounts = graph.constant(f"{node.name}/pads", node.value(graph, 1).T.ravel().astype(np.int64))
    graph.emit("Pad", [node.inputs[0], amounts, *node.inputs[2:3]], node.name, mode="constant")


def _concat(graph: _Graph, node: _Node) -> None:
    graph.emit("Concat", node.inputs[:-1], node.name, axis=int(node.value(graph, len(node.inputs) - 1)))


def _split(graph: _Graph, node: _Node) -> None:
    sizes = graph.constant(f"{node.name}/sizes", node.value(graph, 1).astype(np.int64))
    names = [node.name, *(f"{node.name}:{k}" for k in range(1, len(graph.values[sizes])))]
    graph.emit("Split", [node.inputs[0], sizes], *names, axis=int(node.value(graph, 2)))


def _reshape(graph: _Graph, node: _Node) -> None:
    shape = graph.constant(f"{node.name}/shape", node.value(graph, 1).astype(np.int64))
    graph.emit("Reshape", [node.inputs[0], shape], node.name)


def _transpose(graph: _Graph, node: _Node) -> None:
    graph.emit("Transpose", node.inputs[:1], node.name, perm=[int(x) for x in node.value(graph, 1)])


def _leaky(graph: _Graph, node: _Node) -> None:
    graph.emit("LeakyRelu", node.inputs, node.name, alpha=float(node.attributes["alpha"]["f"]))


def _same(kind: str) -> Callable[[_Graph, _Node], None]:
    """An operation that ONNX has under the name `kind`."""
    return lambda graph, node: graph.emit(kind, node.inputs, node.name)


def _dense(rows: np.ndarray, shape: np.ndarray, values: np.ndarray, default: np.ndarray) -> np.ndarray:
    out = np.full(shape, default)
    out[tuple(rows.T)] = values
    return out


_OPERATIONS: dict[str, Callable[[_Graph, _Node], None]] = {
    "Add": _same("Add"),
    "AddV2": _same("Add"),
    "ConcatV2": _concat,
    "Conv2D": _convolution,
    "Identity": _same("Identity"),
    "LeakyRelu": _leaky,
    "MaxPool": _max_pool,
    "Pad": _pad,
    "PadV2": _pad,
    "Reshape": _reshape,
    "ResizeBilinear": _resize,
    "Sigmoid": _same("Sigmoid"),
    "SplitV": _split,
    "Transpose": _transpose,
}
_FOLDED: dict[str, Callable[..., np.ndarray]] = {"Add": np.add, "AddV2": np.add, "SparseToDense": _dense}
