"""A tiny ONNX file without the package onnx: action = goal @ weights, by the wire format of protocol buffers."""

import numpy as np


def _varint(value: int) -> bytes:
    out = b""
    while value > 127:
        out, value = out + bytes([value & 127 | 128]), value >> 7
    return out + bytes([value])


def _number(field: int, value: int) -> bytes:
    return _varint(field << 3) + _varint(value)


def _bytes(field: int, value: bytes | str) -> bytes:
    body = value.encode() if isinstance(value, str) else value
    return _varint(field << 3 | 2) + _varint(len(body)) + body


def _value(name: str, elements: int, shape: tuple[int | str, ...]) -> bytes:
    """ValueInfoProto of a tensor; elements: 1 float, 2 uint8."""
    dims = b"".join(_bytes(1, _number(1, n) if isinstance(n, int) else _bytes(2, n)) for n in shape)
    return _bytes(1, name) + _bytes(2, _bytes(1, _number(1, elements) + _bytes(2, dims)))


def linear_policy(weights: np.ndarray, batch: int | str = "n", image: tuple[int | str, ...] | None = None) -> bytes:
    """ModelProto of goal (batch, 2) -> goal @ weights (2, 2).

    Args:
      image: shape of a second input `rgb` of floats, whose mean is added to the action.
    """
    nodes = [_bytes(1, "goal_vector") + _bytes(1, "weights") + _bytes(2, "turned") + _bytes(4, "MatMul")]
    inputs = [_value("goal_vector", 1, (batch, 2))]
    if image is None:
        nodes.append(_bytes(1, "turned") + _bytes(2, "action") + _bytes(4, "Identity"))
    else:
        inputs.append(_value("rgb", 1, image))
        nodes.append(_bytes(1, "rgb") + _bytes(2, "grey") + _bytes(4, "GlobalAveragePool"))
        nodes.append(_bytes(1, "grey") + _bytes(2, "flat") + _bytes(4, "Flatten"))
        # ReduceMean by a product with thirds: it has no attributes to write.
        nodes.append(_bytes(1, "flat") + _bytes(1, "thirds") + _bytes(2, "light") + _bytes(4, "MatMul"))
        nodes.append(_bytes(1, "turned") + _bytes(1, "light") + _bytes(2, "action") + _bytes(4, "Add"))
    tensors = [_tensor("weights", weights)]
    if image is not None:
        tensors.append(_tensor("thirds", np.full((3, 2), 1 / 3)))
    graph = b"".join(_bytes(1, n) for n in nodes) + _bytes(2, "policy") + b"".join(_bytes(5, t) for t in tensors)
    graph += b"".join(_bytes(11, i) for i in inputs) + _bytes(12, _value("action", 1, (batch, 2)))
    return _number(1, 8) + _bytes(7, graph) + _bytes(8, _bytes(1, "") + _number(2, 13))


def _tensor(name: str, values: np.ndarray) -> bytes:
    dims = b"".join(_number(1, n) for n in values.shape)
    return dims + _number(2, 1) + _bytes(8, name) + _bytes(9, values.astype("<f4").tobytes())
