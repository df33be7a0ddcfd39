/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// AR(8): the linear autoregression over eight seconds, the peer that a network has to beat.
///
///   y(t+1) = a0 + sum a_i y(t+1-i), i = 1..8, iterated on its own output; y = arrivals / demand scale.
///
/// It keeps no state and knows no vehicles: whoever calls it divides by the demand scale and multiplies again. Its
/// coefficients are fitted outside of the core: host_sim for one trajectory, tools/train for the street.

#ifndef ELMOPP_AR8_H
#define ELMOPP_AR8_H

#include <stdint.h>

#define ELMOPP_AR8_LAGS 8U

/// Coefficients, in units of the demand scale.
typedef struct {
    float intercept;
    float lag[ELMOPP_AR8_LAGS]; ///< [0] is the newest second
    float low;                  ///< smallest output: training minimum, widened by a tenth of the range, at least 0
    float high;                 ///< largest output
} elmopp_ar8_t;

/// Iterates from the last eight values (`last`[0] is the newest) and writes `steps` outputs, each inside [low, high].
void elmopp_ar8_roll_out(const elmopp_ar8_t *model, const float last[ELMOPP_AR8_LAGS], float *output, uint32_t steps);

#endif
