/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Elementary functions, our own, because results must be the same bits on every target and libm's are not.
///
/// Only IEEE 754 single-precision additions and multiplications in a fixed order (build: -ffp-contract=off), no table,
/// no libm.

#ifndef ELMOPP_ELEMENTARY_H
#define ELMOPP_ELEMENTARY_H

/// Arguments beyond these are taken as these, so that the result is always finite and above zero.
#define ELMOPP_EXP_MIN (-87.0F)
#define ELMOPP_EXP_MAX 88.0F

/// e^x. Relative error at most 1.5e-7 for every float in [-87, 88] (tests/test_elementary.c tries each 64th of them,
/// and --all each one). A NaN is taken as ELMOPP_EXP_MIN.
float elmopp_exp(float x);

#endif
