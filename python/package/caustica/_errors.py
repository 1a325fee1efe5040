"""Exceptions and diagnostics."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Related:
    """A further place of a diagnostic."""

    text: str
    file: str | None
    line: int | None
    column: int | None


@dataclass(frozen=True)
class Diagnostic:
    """A message about a scene and the place it is about."""

    severity: str
    """`"error"`, `"warning"` or `"note"`."""
    text: str
    """What is wrong."""
    file: str | None
    """The scene file; `None` for what stands in no file."""
    line: int | None
    """From 1."""
    column: int | None
    """From 1, in characters."""
    source: str | None
    """The line of the file."""
    help: tuple[str, ...]
    """What to do about it."""
    related: tuple[Related, ...]
    """Further places."""
    unsupported: bool
    """Something known is left out of the picture or replaced."""

    def __init__(
        self,
        severity: str,
        text: str,
        file: str | None,
        line: int | None,
        column: int | None,
        source: str | None,
        help: list[str],
        related: list[tuple[str, str | None, int | None, int | None]],
        unsupported: bool,
    ) -> None:
        fields: dict[str, object] = {
            "severity": severity,
            "text": text,
            "file": file,
            "line": line,
            "column": column,
            "source": source,
            "help": tuple(help),
            "related": tuple(Related(*place) for place in related),
            "unsupported": unsupported,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def suggestion(self) -> str | None:
        """The first piece of advice, such as ``did you mean `radius`?``."""
        return self.help[0] if self.help else None

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: " if self.file is not None else ""
        return f"{place}{self.severity}: {self.text}"


class Error(Exception):
    """Why caustica could not do its work; the base of its other exceptions."""

    diagnostics: list[Diagnostic]
    """What is wrong with the scene, where that is why."""
    suggestion: str | None
    """What was probably meant."""

    def __init__(
        self, message: str, diagnostics: list[Diagnostic] | None = None, suggestion: str | None = None
    ) -> None:
        super().__init__(message)
        self.diagnostics = diagnostics if diagnostics is not None else []
        self.suggestion = suggestion

    def __str__(self) -> str:
        return str(self.args[0])

    def __reduce__(self) -> tuple[object, ...]:
        return (type(self), (self.args[0], self.diagnostics, self.suggestion))


class SceneError(Error):
    """A scene cannot be read or rendered; `diagnostics` lists every problem with its place."""


class SettingError(Error, ValueError):
    """There is no such setting, layer or option, or it cannot have this value."""


class UnknownNameError(Error, KeyError):
    """A scene has no such value, or a picture no such layer."""


class ArrayError(Error, ValueError):
    """A value of a scene cannot be read, or cannot have this shape or these numbers."""


class SceneWarning(UserWarning):
    """A scene is not rendered exactly as it is written."""
