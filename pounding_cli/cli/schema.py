"""`pound schema`: the JSON Schema of study files, for editors."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("schema")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Write to this file. Default: print it.")
@click.option("--keys", is_flag=True, help="Print tables of all keys instead.")
def command(output: Path | None, keys: bool) -> None:
    """Print the JSON Schema of study files, with which editors complete keys and mark mistakes.

    Editors check a study that begins with `# yaml-language-server: $schema=pound.schema.json` as you type.

    \b
    Example:
      pound schema -o pound.schema.json
      pound schema --keys
    """
    from pounding_cli.errors import InputError, Problem
    from pounding_cli.outputs import check_output
    from pounding_cli.study.template import schema_text

    if keys:
        from pounding_cli.study.keys import key_tables

        text = key_tables() + "\n"
    else:
        text = schema_text()
    if output is None:
        click.echo(text, nl=False)
        return
    check_output(output, mine=lambda _, head: head.startswith(text.encode()[:60]) or head.startswith(b"| "))
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(
            Problem(f"cannot write {output}: {error.strerror}", "name a file in a folder that exists")
        ) from None
    click.echo(f"wrote {output}")
