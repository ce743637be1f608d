"""Braided pneumatic actuators on data frames: `fit`, `predict` and `diagnose`, by the program `pipeline`."""

from .errors import PipelineError, PipelineWarning, ReadingsError
from .findings import Findings
from .fit import Fit, diagnose, fit, predict
from .program import find_program
from .project import Project

__all__ = ["Findings", "Fit", "PipelineError", "PipelineWarning", "Project", "ReadingsError", "diagnose", "find_program", "fit", "predict"]
