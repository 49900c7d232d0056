"""Tests that take long and run once a night, with `make reference`."""

from __future__ import annotations

import os

import pytest

NIGHTLY = pytest.mark.skipif("POUND_NIGHTLY" not in os.environ, reason="make reference runs it every night")
