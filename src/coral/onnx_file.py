"""Opens ONNX files with onnxruntime (extra `vision`), and says in one line what is wrong with one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, first_line, install_extra

SINGLE, HALF = "tensor(float)", "tensor(float16)"


@dataclass(frozen=True)
class OnnxFile:
    """A network that is ready to run, on one thread."""

    path: str
    session: Any
    inputs: Mapping[str, tuple[int | None, ...]]
    """Shape by name; None for a size that is free."""
    outputs: Mapping[str, tuple[int | None, ...]]
    metadata: Mapping[str, str]
    kinds: Mapping[str, str] = field(default_factory=dict)
    """Type by name of input or output, as onnxruntime names it; by default tensor(float)."""

    @property
    def input_shape(self) -> tuple[int | None, ...]:
        """Shape of the first input."""
        return next(iter(self.inputs.values()))

    def run(self, tensor: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        """Return the outputs by name for the first input.

        Numbers of half precision are converted on the way in and out, and whole numbers on the way out.

        Raises:
            InputError: The network refuses this input.
        """
        name = next(iter(self.inputs))
        try:
            given = tensor.astype(np.float16) if self.kinds.get(name) == HALF else tensor
            values = self.session.run(None, {name: given})
        except Exception as error:  # its errors have no common base but Exception
            found = f"shapes that it refuses ({first_line(error)})"
            raise InputError(self.path, "inputs", found, "the shapes of its kind") from None
        return {name: np.asarray(value, np.float32) for name, value in zip(self.outputs, values, strict=True)}

    def with_shapes_of(self, width: int, height: int) -> OnnxFile:
        """Return the network with the shapes of its outputs for pictures of a size, where the file leaves them open."""
        if all(shape and None not in shape for shape in self.outputs.values()):
            return self
        channels = self.input_shape[1] or 3
        made = self.run(np.zeros((1, channels, height, width), np.float32))
        return replace(self, outputs={name: value.shape for name, value in made.items()})


def open_onnx(path: Path, where: str = "--perception") -> OnnxFile:
    """Open a network.

    Raises:
        InputError: onnxruntime is not installed, or the file cannot be used.
    """
    if not path.is_file():
        raise InputError(str(path), "", "no file", "an ONNX file")
    try:
        import onnxruntime
    except ImportError:
        raise InputError(where, "", "no package onnxruntime", install_extra("vision")) from None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # its errors have no common base but Exception
        found = f"a file that onnxruntime refuses ({first_line(error)})"
        raise InputError(str(path), "", found, "an ONNX file") from None
    inputs, outputs = session.get_inputs(), session.get_outputs()
    return OnnxFile(
        str(path),
        session,
        {i.name: _sizes(i.shape) for i in inputs},
        {o.name: _sizes(o.shape) for o in outputs},
        dict(session.get_modelmeta().custom_metadata_map),
        {one.name: one.type for one in (*inputs, *outputs)},
    )


def open_picture_network(path: Path, where: str = "--perception") -> OnnxFile:
    """Open a network whose only input is a picture.

    Raises:
        InputError: onnxruntime is not installed, or the file cannot be used.
    """
    found = open_onnx(path, where)
    kinds = [found.kinds[name] for name in found.inputs]
    shape = found.input_shape if len(found.inputs) == 1 else ()
    if len(shape) != 4 or shape[0] not in (1, None) or kinds[0] not in (SINGLE, HALF):
        told = ", ".join(f"{name} {kind} {of}" for (name, of), kind in zip(found.inputs.items(), kinds, strict=True))
        raise InputError(str(path), "inputs", told, "one float input of shape (1, channels, height, width)")
    return found


def _sizes(shape: list[Any]) -> tuple[int | None, ...]:
    return tuple(size if isinstance(size, int) else None for size in shape)
