#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
#
# venv_python.sh ARGUMENT...: runs the Python of build/venv/check with these arguments.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
python=$root/build/venv/check/bin/python
if [ ! -x "$python" ]; then
    echo "build/venv/check is missing, so this test cannot run: run ./tools/check or ./tools/setup check" >&2
    exit 2
fi
exec "$python" "$@"
