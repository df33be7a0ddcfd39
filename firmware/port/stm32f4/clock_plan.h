/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Clock plan: which frequencies there are, worked out and checked when this is compiled. Source: RM0090 section 7.2.
///
/// From the board's crystal (ELMOPP_STM32F4_HSE_HZ, a setting of the build) the PLL makes 168 MHz, the most that an
/// STM32F405 may run at, and from that 42 and 84 MHz for the two peripheral buses. Without the crystal everything runs
/// at the internal oscillator's 16 MHz. Decides nothing at run time; clocks.c carries it out.

#ifndef ELMOPP_STM32F4_CLOCK_PLAN_H
#define ELMOPP_STM32F4_CLOCK_PLAN_H

#include <assert.h>
#include <stdint.h>

#ifndef ELMOPP_STM32F4_HSE_HZ
#error "ELMOPP_STM32F4_HSE_HZ is not set: right would be the frequency of the board's crystal, as 8000000U"
#endif

#define ELMOPP_HSI_HZ 16000000U
#define ELMOPP_SYSCLK_HZ 168000000U
#define ELMOPP_PCLK1_HZ (ELMOPP_SYSCLK_HZ / 4U) ///< at most 42 MHz
#define ELMOPP_PCLK2_HZ (ELMOPP_SYSCLK_HZ / 2U) ///< at most 84 MHz

/// What goes into the PLL: 2 MHz, which RM0090 7.3.2 recommends against jitter, or 1 MHz where the crystal gives no 2.
#define ELMOPP_PLL_INPUT_HZ (((ELMOPP_STM32F4_HSE_HZ % 2000000U) == 0U) ? 2000000U : 1000000U)
#define ELMOPP_PLL_M (ELMOPP_STM32F4_HSE_HZ / ELMOPP_PLL_INPUT_HZ)
#define ELMOPP_PLL_VCO_HZ (2U * ELMOPP_SYSCLK_HZ)
#define ELMOPP_PLL_N (ELMOPP_PLL_VCO_HZ / ELMOPP_PLL_INPUT_HZ)
#define ELMOPP_PLL_P_CODE 0U ///< divides by 2
#define ELMOPP_PLL_Q 7U      ///< 48 MHz, for what is not used here; must be valid all the same

static_assert((ELMOPP_STM32F4_HSE_HZ >= 4000000U) && (ELMOPP_STM32F4_HSE_HZ <= 26000000U), "a crystal of 4 to 26 MHz");
static_assert((ELMOPP_STM32F4_HSE_HZ % ELMOPP_PLL_INPUT_HZ) == 0U, "a crystal of whole megahertz");
static_assert((ELMOPP_PLL_M >= 2U) && (ELMOPP_PLL_M <= 63U), "RM0090 7.3.2, PLLM");
static_assert((ELMOPP_PLL_N >= 50U) && (ELMOPP_PLL_N <= 432U), "RM0090 7.3.2, PLLN");
static_assert((ELMOPP_PLL_VCO_HZ >= 100000000U) && (ELMOPP_PLL_VCO_HZ <= 432000000U), "RM0090 7.3.2, VCO");
static_assert((ELMOPP_PLL_INPUT_HZ * ELMOPP_PLL_N) == ELMOPP_PLL_VCO_HZ, "168 MHz exactly");

/// Wait states of the flash at 168 MHz and 2.7 V or more, RM0090 table 10.
#define ELMOPP_FLASH_WAIT_STATES 5U

#endif
