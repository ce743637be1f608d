"""What can go wrong."""


class PipelineError(RuntimeError):
    """The program refused: its own message, and its exit code (`None` where it could not be started)."""

    def __init__(self, message: str, code: int | None = None) -> None:
        super().__init__(message)
        self.code = code


class ReadingsError(ValueError):
    """A data frame that no session can be made of, or no prediction: says which column or row, and what to do."""


class PipelineWarning(UserWarning):
    """Rows or sessions that were left out, and what the program warned of."""
