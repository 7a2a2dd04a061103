"""Opens ONNX files with onnxruntime (extra `vision`), and says in one line what is wrong with one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.errors import InputError, first_line


@dataclass(frozen=True)
class OnnxFile:
    """A network that is ready to run, on one thread."""

    path: str
    session: Any
    inputs: Mapping[str, tuple[int | None, ...]]
    """Shape by name; None for a size that is free."""
    outputs: Mapping[str, tuple[int | None, ...]]
    metadata: Mapping[str, str]

    @property
    def input_shape(self) -> tuple[int | None, ...]:
        """Shape of the first input."""
        return next(iter(self.inputs.values()))

    def run_named(self, tensors: Mapping[str, NDArray[np.float32]]) -> dict[str, NDArray[np.float32]]:
        """Return the outputs by name for inputs by name.

        Raises:
            InputError: The network refuses these inputs.
        """
        try:
            values = self.session.run(None, dict(tensors))
        except Exception as error:  # its errors have no common base but Exception
            raise InputError(
                self.path, "inputs", f"shapes that it refuses ({first_line(error)})", "the shapes of its kind"
            ) from None
        return {name: np.asarray(value, np.float32) for name, value in zip(self.outputs, values, strict=True)}

    def run(self, tensor: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        """Return the outputs by name for the first input."""
        return self.run_named({next(iter(self.inputs)): tensor})


def open_onnx(path: Path, where: str = "--perception") -> OnnxFile:
    """Open a network.

    Args:
        path: The file.
        where: Flag that named it, for errors about the installation.

    Raises:
        InputError: onnxruntime is not installed, or the file cannot be used.
    """
    if not path.is_file():
        raise InputError(str(path), "", "no file", "an ONNX file")
    try:
        import onnxruntime
    except ImportError:
        raise InputError(
            where, "", "no package onnxruntime", "the extra `vision`: pip install 'coral-robotics[vision]'"
        ) from None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # its errors have no common base but Exception
        raise InputError(
            str(path), "", f"a file that onnxruntime refuses ({first_line(error)})", "an ONNX file"
        ) from None
    return OnnxFile(
        str(path),
        session,
        {i.name: _sizes(i.shape) for i in session.get_inputs()},
        {o.name: _sizes(o.shape) for o in session.get_outputs()},
        dict(session.get_modelmeta().custom_metadata_map),
    )


def open_picture_network(path: Path, where: str = "--perception") -> OnnxFile:
    """Open a network whose only input is a picture.

    Args:
        path: The file.
        where: Flag that named it, for errors about the installation.

    Raises:
        InputError: onnxruntime is not installed, or the file cannot be used.
    """
    found = open_onnx(path, where)
    if len(found.inputs) != 1 or len(found.input_shape) != 4 or found.session.get_inputs()[0].type != "tensor(float)":
        raise InputError(
            str(path), "inputs", f"{dict(found.inputs)}", "one float input of shape (1, channels, height, width)"
        )
    return found


def _sizes(shape: list[Any]) -> tuple[int | None, ...]:
    return tuple(size if isinstance(size, int) else None for size in shape)
