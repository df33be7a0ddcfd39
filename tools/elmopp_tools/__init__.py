# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors
"""What the programs in tools/ share."""
