"""CORAL and CoRAL: foundation models decide what to do, sampling-based optimal control decides how."""

from importlib.metadata import version

__version__ = version("coral-robotics")
