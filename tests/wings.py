"""The wings, as `pyproject.toml` lists them, and a copy of the package without some of them."""

import os
import shutil
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "coral"


def wings():
    """Return the modules of each wing, and who may import them, by the wing's package."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    listed = [one for one in contracts if one["type"] == "protected"]
    return {one["protected_modules"][0]: (one["protected_modules"], one["allowed_importers"]) for one in listed}


def path_of(module, source):
    """Return the file or folder of a module under `source`."""
    path = source.joinpath(*module.split("."))
    return path if path.is_dir() else path.with_suffix(".py")


def copy_without(names, source):
    """Copy the package to `source` without the wings of these names. Files are links, so that no kernel is compiled."""
    linked = Path(source) / "coral"
    try:
        shutil.copytree(PACKAGE, linked, copy_function=os.link)
    except (OSError, shutil.Error):  # another file system
        shutil.rmtree(linked, ignore_errors=True)
        shutil.copytree(PACKAGE, linked)
    for name in names:
        for module in wings()[name][0]:
            path = path_of(module, Path(source))
            shutil.rmtree(path) if path.is_dir() else path.unlink()
