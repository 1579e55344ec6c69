"""The command line, one file a family of commands."""

from pondhop.cli.main import app, main

__all__ = ["app", "main"]
