/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Bit timing of CAN: 500 kbit/s from the clock of the CAN controller, worked out and checked when this is compiled.
/// Source: RM0090 section 32.7.7; tolerances ISO 11898-1 (in the form of Robert Bosch, The Configuration of the CAN Bit
/// Timing).
///
/// A bit has as many quanta as bring the sample point nearest to 87.5 % (CiA's recommendation for 500 kbit/s) with a
/// whole prescaler and at least two quanta behind the sample point, which is what can be jumped. At 42 MHz these are 14
/// quanta of 6 clocks, sampled after 12: 85.7 %. A clock that gives no such bit does not compile.
///
/// Why there is no CAN from the internal oscillator. A node may be off by at most ELMOPP_CAN_TOLERANCE_PPM, 0.56 %; no
/// timing at any rate is good for more than 1.58 % (ISO 11898-1: four quanta to jump of a bit of ten). The internal
/// oscillator is within 1 % only at 25 degrees, within 4 % from -10 to 85, within -8 to +4.5 % from -40 to 105 (data
/// sheet DS8626, HSI oscillator characteristics). A node that is off by more destroys what others say.

#ifndef ELMOPP_STM32F4_BIT_TIMING_H
#define ELMOPP_STM32F4_BIT_TIMING_H

#include "clock_plan.h"
#include "registers.h"

#define ELMOPP_CAN_BIT_RATE 500000U
#define ELMOPP_CAN_CLOCKS (ELMOPP_PCLK1_HZ / ELMOPP_CAN_BIT_RATE) ///< of the controller in a bit

/// Quanta of a bit, from the best sample point on: 16 (87.5 %), 17, 15, 18, 14, 19, 13; 0: none will do.
#define ELMOPP_CAN_DIVIDES(quanta) ((ELMOPP_CAN_CLOCKS % (quanta)) == 0U)
#define ELMOPP_CAN_QUANTA                                                                                              \
    (ELMOPP_CAN_DIVIDES(16U)   ? 16U                                                                                   \
     : ELMOPP_CAN_DIVIDES(17U) ? 17U                                                                                   \
     : ELMOPP_CAN_DIVIDES(15U) ? 15U                                                                                   \
     : ELMOPP_CAN_DIVIDES(18U) ? 18U                                                                                   \
     : ELMOPP_CAN_DIVIDES(14U) ? 14U                                                                                   \
     : ELMOPP_CAN_DIVIDES(19U) ? 19U                                                                                   \
     : ELMOPP_CAN_DIVIDES(13U) ? 13U                                                                                   \
                               : 0U)
static_assert((ELMOPP_PCLK1_HZ % ELMOPP_CAN_BIT_RATE) == 0U, "500 kbit/s exactly");
static_assert(ELMOPP_CAN_QUANTA != 0U, "no bit of 13 to 19 quanta from this clock");

#define ELMOPP_CAN_PRESCALER (ELMOPP_CAN_CLOCKS / ELMOPP_CAN_QUANTA)
#define ELMOPP_CAN_SEGMENT_2 2U                                              ///< behind the sample point
#define ELMOPP_CAN_SEGMENT_1 (ELMOPP_CAN_QUANTA - 1U - ELMOPP_CAN_SEGMENT_2) ///< after the first quantum
#define ELMOPP_CAN_JUMP ELMOPP_CAN_SEGMENT_2
#define ELMOPP_CAN_SAMPLE_PERMILLE ((1000U * (1U + ELMOPP_CAN_SEGMENT_1)) / ELMOPP_CAN_QUANTA)

static_assert((ELMOPP_CAN_PRESCALER >= 1U) && (ELMOPP_CAN_PRESCALER <= 1024U), "RM0090 32.9.2, BRP");
static_assert((ELMOPP_CAN_SEGMENT_1 >= 1U) && (ELMOPP_CAN_SEGMENT_1 <= 16U), "RM0090 32.9.2, TS1");
static_assert((ELMOPP_CAN_SEGMENT_2 >= 1U) && (ELMOPP_CAN_SEGMENT_2 <= 8U), "RM0090 32.9.2, TS2");
static_assert((ELMOPP_CAN_JUMP >= 1U) && (ELMOPP_CAN_JUMP <= 4U) && (ELMOPP_CAN_JUMP <= ELMOPP_CAN_SEGMENT_2),
              "RM0090 32.9.2, SJW");
static_assert((ELMOPP_PCLK1_HZ / (ELMOPP_CAN_PRESCALER * ELMOPP_CAN_QUANTA)) == ELMOPP_CAN_BIT_RATE, "500 kbit/s");
static_assert((ELMOPP_CAN_SAMPLE_PERMILLE >= 840U) && (ELMOPP_CAN_SAMPLE_PERMILLE <= 900U), "near 87.5 %");

/// The word for CAN_BTR: everything in it is one less than it means.
#define ELMOPP_CAN_BTR                                                                                                 \
    ((ELMOPP_CAN_PRESCALER - 1U) | ((ELMOPP_CAN_SEGMENT_1 - 1U) << ELMOPP_BXCAN_BTR_TS1_AT) |                          \
     ((ELMOPP_CAN_SEGMENT_2 - 1U) << ELMOPP_BXCAN_BTR_TS2_AT) | ((ELMOPP_CAN_JUMP - 1U) << ELMOPP_BXCAN_BTR_SJW_AT))

/// What a clock may be off by, of the two conditions the narrower: jump / (20 quanta), and segment 2 / (2 (13 quanta -
/// segment 2)), in parts of a million.
#define ELMOPP_CAN_TOLERANCE_OF_JUMP_PPM ((1000000U * ELMOPP_CAN_JUMP) / (20U * ELMOPP_CAN_QUANTA))
#define ELMOPP_CAN_TOLERANCE_OF_ERROR_PPM                                                                              \
    ((1000000U * ELMOPP_CAN_SEGMENT_2) / (2U * ((13U * ELMOPP_CAN_QUANTA) - ELMOPP_CAN_SEGMENT_2)))
#define ELMOPP_CAN_TOLERANCE_PPM                                                                                       \
    ((ELMOPP_CAN_TOLERANCE_OF_JUMP_PPM < ELMOPP_CAN_TOLERANCE_OF_ERROR_PPM) ? ELMOPP_CAN_TOLERANCE_OF_JUMP_PPM         \
                                                                            : ELMOPP_CAN_TOLERANCE_OF_ERROR_PPM)

#define ELMOPP_CRYSTAL_OFF_PPM 500U ///< more than any crystal for a microcontroller, age and heat included
#define ELMOPP_HSI_OFF_PPM 80000U   ///< DS8626, -40 to 105 degrees
#define ELMOPP_CAN_BEST_PPM 15800U  ///< ISO 11898-1, whatever the timing
static_assert(ELMOPP_CRYSTAL_OFF_PPM <= ELMOPP_CAN_TOLERANCE_PPM, "the crystal is good enough for CAN");
static_assert(ELMOPP_HSI_OFF_PPM > ELMOPP_CAN_BEST_PPM, "the internal oscillator is not");

#endif
