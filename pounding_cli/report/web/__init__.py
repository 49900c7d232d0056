"""The report as one self-contained HTML page: content from the tables, a template, a style sheet, scripts."""

from __future__ import annotations

from pounding_cli.report.web.page import PAGE, write_page

__all__ = ["PAGE", "write_page"]
