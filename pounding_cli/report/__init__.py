"""Reports: sections of sentences, tables and figures that a terminal, a page and a notebook show."""
