"""Help in sections, for a command with many options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import click


class SectionedCommand(click.Command):
    """A command whose help groups its options.

    Args:
        sections: By title, options as they are spelled; those in no section come last.
    """

    def __init__(self, *args: Any, sections: Mapping[str, Sequence[str]], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.sections = sections

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes one list for each section."""
        params = [param for param in self.get_params(ctx) if isinstance(param, click.Option)]
        by_name = {option: param for param in params for option in param.opts}
        listed = {name for names in self.sections.values() for name in names}
        rest = [param for param in params if not listed & set(param.opts)]
        parts = [(title, [by_name[name] for name in names]) for title, names in self.sections.items()]
        for title, members in (*parts, ("Other", rest)):
            records = [record for param in members if (record := param.get_help_record(ctx)) is not None]
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)
