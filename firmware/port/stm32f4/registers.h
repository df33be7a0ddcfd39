/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Registers of the STM32F405 that this port uses, and no others. Source: reference manual RM0090; the section of each
/// block stands by it, the base addresses are those of section 2.3, memory map.
///
/// Offsets are held by static asserts, so that a forgotten gap does not compile. It decides nothing.

#ifndef ELMOPP_STM32F4_REGISTERS_H
#define ELMOPP_STM32F4_REGISTERS_H

#include "register_access.h"

#include <assert.h>
#include <stddef.h>

#define ELMOPP_BIT(n) ((uint32_t)1U << (n))

/* --- bxCAN, section 32.9 --- */

#define ELMOPP_BXCAN_MAILBOXES 3U ///< to send from
#define ELMOPP_BXCAN_FIFOS 2U     ///< ... of three frames each
#define ELMOPP_BXCAN_BANKS 28U    ///< filter banks, of both controllers together

/// A mailbox or the output of a FIFO, section 32.9.3.
typedef struct {
    elmopp_register_t id;     ///< TIxR, RIxR
    elmopp_register_t length; ///< TDTxR, RDTxR
    elmopp_register_t low;    ///< TDLxR, RDLxR: bytes 0 to 3
    elmopp_register_t high;   ///< TDHxR, RDHxR: bytes 4 to 7
} elmopp_bxcan_slot_t;

typedef struct {
    elmopp_register_t mcr; ///< section 32.9.2 from here
    elmopp_register_t msr;
    elmopp_register_t tsr;
    elmopp_register_t rfr[ELMOPP_BXCAN_FIFOS];
    elmopp_register_t ier;
    elmopp_register_t esr;
    elmopp_register_t btr;
    uint32_t gap_0x20[88];
    elmopp_bxcan_slot_t mailbox[ELMOPP_BXCAN_MAILBOXES]; ///< section 32.9.3 from here
    elmopp_bxcan_slot_t fifo[ELMOPP_BXCAN_FIFOS];
    uint32_t gap_0x1d0[12];
    elmopp_register_t fmr; ///< section 32.9.4 from here
    elmopp_register_t fm1r;
    uint32_t gap_0x208;
    elmopp_register_t fs1r;
    uint32_t gap_0x210;
    elmopp_register_t ffa1r;
    uint32_t gap_0x218;
    elmopp_register_t fa1r;
    uint32_t gap_0x220[8];
    elmopp_register_t bank[ELMOPP_BXCAN_BANKS][2];
} elmopp_bxcan_registers_t;

static_assert(offsetof(elmopp_bxcan_registers_t, btr) == 0x01CU, "RM0090 32.9.2");
static_assert(offsetof(elmopp_bxcan_registers_t, mailbox) == 0x180U, "RM0090 32.9.3");
static_assert(offsetof(elmopp_bxcan_registers_t, fifo) == 0x1B0U, "RM0090 32.9.3");
static_assert(offsetof(elmopp_bxcan_registers_t, fmr) == 0x200U, "RM0090 32.9.4");
static_assert(offsetof(elmopp_bxcan_registers_t, fs1r) == 0x20CU, "RM0090 32.9.4");
static_assert(offsetof(elmopp_bxcan_registers_t, fa1r) == 0x21CU, "RM0090 32.9.4");
static_assert(offsetof(elmopp_bxcan_registers_t, bank) == 0x240U, "RM0090 32.9.4");

#define ELMOPP_BXCAN_MCR_INRQ ELMOPP_BIT(0U)
#define ELMOPP_BXCAN_MCR_RESET ELMOPP_BIT(15U)

#define ELMOPP_BXCAN_MSR_INAK ELMOPP_BIT(0U)
#define ELMOPP_BXCAN_MSR_SLAK ELMOPP_BIT(1U)

/* The bits of mailbox 0; those of mailbox n are 8n further, TME by n. */
#define ELMOPP_BXCAN_TSR_RQCP ELMOPP_BIT(0U)
#define ELMOPP_BXCAN_TSR_TXOK ELMOPP_BIT(1U)
#define ELMOPP_BXCAN_TSR_ABRQ ELMOPP_BIT(7U)
#define ELMOPP_BXCAN_TSR_PER_MAILBOX 8U
#define ELMOPP_BXCAN_TSR_TME ELMOPP_BIT(26U)

#define ELMOPP_BXCAN_RFR_FMP 3U
#define ELMOPP_BXCAN_RFR_FOVR ELMOPP_BIT(4U)
#define ELMOPP_BXCAN_RFR_RFOM ELMOPP_BIT(5U)

#define ELMOPP_BXCAN_IER_FMPIE0 ELMOPP_BIT(1U)

#define ELMOPP_BXCAN_ESR_EPVF ELMOPP_BIT(1U)
#define ELMOPP_BXCAN_ESR_BOFF ELMOPP_BIT(2U)

#define ELMOPP_BXCAN_BTR_TS1_AT 16U
#define ELMOPP_BXCAN_BTR_TS2_AT 20U
#define ELMOPP_BXCAN_BTR_SJW_AT 24U

#define ELMOPP_BXCAN_ID_TXRQ ELMOPP_BIT(0U)
#define ELMOPP_BXCAN_ID_RTR ELMOPP_BIT(1U)
#define ELMOPP_BXCAN_ID_IDE ELMOPP_BIT(2U)
#define ELMOPP_BXCAN_ID_STANDARD_AT 21U
#define ELMOPP_BXCAN_ID_STANDARD 0x7FFU
#define ELMOPP_BXCAN_LENGTH_DLC 15U

#define ELMOPP_BXCAN_FMR_FINIT ELMOPP_BIT(0U)
#define ELMOPP_BXCAN_FMR_CAN2SB_AT 8U
/// An 11-bit id in one of the four places of a bank of 16-bit ids; RTR and IDE are 0 there, so that neither passes.
#define ELMOPP_BXCAN_BANK_ID_AT 5U

/* --- clocks and resets, section 7.3 --- */

typedef struct {
    elmopp_register_t cr;
    elmopp_register_t pllcfgr;
    elmopp_register_t cfgr;
    elmopp_register_t cir;
    uint32_t gap_0x10[8];
    elmopp_register_t ahb1enr;
    uint32_t gap_0x34[3];
    elmopp_register_t apb1enr;
    elmopp_register_t apb2enr;
    uint32_t gap_0x48[11];
    elmopp_register_t csr;
} elmopp_rcc_registers_t;

static_assert(offsetof(elmopp_rcc_registers_t, ahb1enr) == 0x30U, "RM0090 7.3.10");
static_assert(offsetof(elmopp_rcc_registers_t, apb1enr) == 0x40U, "RM0090 7.3.13");
static_assert(offsetof(elmopp_rcc_registers_t, csr) == 0x74U, "RM0090 7.3.21");

#define ELMOPP_RCC_CR_HSEON ELMOPP_BIT(16U)
#define ELMOPP_RCC_CR_HSERDY ELMOPP_BIT(17U)
#define ELMOPP_RCC_CR_CSSON ELMOPP_BIT(19U)
#define ELMOPP_RCC_CR_PLLON ELMOPP_BIT(24U)
#define ELMOPP_RCC_CR_PLLRDY ELMOPP_BIT(25U)

#define ELMOPP_RCC_PLLCFGR_N_AT 6U
#define ELMOPP_RCC_PLLCFGR_P_AT 16U
#define ELMOPP_RCC_PLLCFGR_SRC_HSE ELMOPP_BIT(22U)
#define ELMOPP_RCC_PLLCFGR_Q_AT 24U

#define ELMOPP_RCC_CFGR_SW 3U
#define ELMOPP_RCC_CFGR_SW_PLL 2U
#define ELMOPP_RCC_CFGR_SWS_AT 2U
#define ELMOPP_RCC_CFGR_PPRE1_BY_4 (5U << 10U)
#define ELMOPP_RCC_CFGR_PPRE2_BY_2 (4U << 13U)

#define ELMOPP_RCC_AHB1ENR_GPIOB ELMOPP_BIT(1U)
#define ELMOPP_RCC_AHB1ENR_GPIOC ELMOPP_BIT(2U)
#define ELMOPP_RCC_APB1ENR_CAN1 ELMOPP_BIT(25U)
#define ELMOPP_RCC_APB1ENR_PWR ELMOPP_BIT(28U)
#define ELMOPP_RCC_APB2ENR_USART1 ELMOPP_BIT(4U)

#define ELMOPP_RCC_CSR_RMVF ELMOPP_BIT(24U)
#define ELMOPP_RCC_CSR_BORRSTF ELMOPP_BIT(25U)
#define ELMOPP_RCC_CSR_PINRSTF ELMOPP_BIT(26U)
#define ELMOPP_RCC_CSR_PORRSTF ELMOPP_BIT(27U)
#define ELMOPP_RCC_CSR_SFTRSTF ELMOPP_BIT(28U)
#define ELMOPP_RCC_CSR_IWDGRSTF ELMOPP_BIT(29U)
#define ELMOPP_RCC_CSR_WWDGRSTF ELMOPP_BIT(30U)
#define ELMOPP_RCC_CSR_LPWRRSTF ELMOPP_BIT(31U)

/* --- power, section 5.4 --- */

typedef struct {
    elmopp_register_t cr;
    elmopp_register_t csr;
} elmopp_pwr_registers_t;

#define ELMOPP_PWR_CR_VOS ELMOPP_BIT(14U) ///< scale 1, needed above 144 MHz

/* --- flash interface, section 3.9 --- */

typedef struct {
    elmopp_register_t acr;
    elmopp_register_t keyr;
    elmopp_register_t optkeyr;
    elmopp_register_t sr;
    elmopp_register_t cr;
    elmopp_register_t optcr;
} elmopp_flash_registers_t;

static_assert(offsetof(elmopp_flash_registers_t, optcr) == 0x14U, "RM0090 3.9, FLASH_OPTCR");

#define ELMOPP_FLASH_ACR_LATENCY 7U
#define ELMOPP_FLASH_ACR_PRFTEN ELMOPP_BIT(8U)
#define ELMOPP_FLASH_ACR_ICEN ELMOPP_BIT(9U)
#define ELMOPP_FLASH_ACR_DCEN ELMOPP_BIT(10U)
#define ELMOPP_FLASH_ACR_ICRST ELMOPP_BIT(11U)
#define ELMOPP_FLASH_ACR_DCRST ELMOPP_BIT(12U)

#define ELMOPP_FLASH_KEY_1 0x45670123U ///< section 3.6.1
#define ELMOPP_FLASH_KEY_2 0xCDEF89ABU

#define ELMOPP_FLASH_SR_EOP ELMOPP_BIT(0U)
#define ELMOPP_FLASH_SR_OPERR ELMOPP_BIT(1U)
#define ELMOPP_FLASH_SR_WRPERR ELMOPP_BIT(4U)
#define ELMOPP_FLASH_SR_PGAERR ELMOPP_BIT(5U)
#define ELMOPP_FLASH_SR_PGPERR ELMOPP_BIT(6U)
#define ELMOPP_FLASH_SR_PGSERR ELMOPP_BIT(7U)
#define ELMOPP_FLASH_SR_BSY ELMOPP_BIT(16U)

#define ELMOPP_FLASH_CR_PG ELMOPP_BIT(0U)
#define ELMOPP_FLASH_CR_SER ELMOPP_BIT(1U)
#define ELMOPP_FLASH_CR_SNB_AT 3U
#define ELMOPP_FLASH_CR_PSIZE_32 ELMOPP_BIT(9U) ///< needs 2.7 V or more
#define ELMOPP_FLASH_CR_STRT ELMOPP_BIT(16U)
#define ELMOPP_FLASH_CR_LOCK ELMOPP_BIT(31U)
#define ELMOPP_FLASH_OPTCR_BOR_LEV (3U << 2U)
#define ELMOPP_FLASH_OPTCR_BOR_LEVEL_3 0U ///< the highest threshold, 2.7 V at least: what 168 MHz need

/* --- general-purpose I/O, section 8.4 --- */

typedef struct {
    elmopp_register_t moder;
    elmopp_register_t otyper;
    elmopp_register_t ospeedr;
    elmopp_register_t pupdr;
    elmopp_register_t idr;
    elmopp_register_t odr;
    elmopp_register_t bsrr;
    elmopp_register_t lckr;
    elmopp_register_t afr[2];
} elmopp_gpio_registers_t;

static_assert(offsetof(elmopp_gpio_registers_t, afr) == 0x20U, "RM0090 8.4.9");

/* --- independent watchdog, section 21.4 --- */

typedef struct {
    elmopp_register_t kr;
    elmopp_register_t pr;
    elmopp_register_t rlr;
    elmopp_register_t sr;
} elmopp_iwdg_registers_t;

#define ELMOPP_IWDG_KR_RELOAD 0xAAAAU
#define ELMOPP_IWDG_KR_UNLOCK 0x5555U
#define ELMOPP_IWDG_KR_START 0xCCCCU
#define ELMOPP_IWDG_SR_BUSY 3U ///< PVU, RVU

/* --- serial port, section 30.6 --- */

typedef struct {
    elmopp_register_t sr;
    elmopp_register_t dr;
    elmopp_register_t brr;
    elmopp_register_t cr1;
    elmopp_register_t cr2;
    elmopp_register_t cr3;
} elmopp_usart_registers_t;

#define ELMOPP_USART_SR_TXE ELMOPP_BIT(7U)
#define ELMOPP_USART_CR1_TE ELMOPP_BIT(3U)
#define ELMOPP_USART_CR1_UE ELMOPP_BIT(13U)

/* --- where they are, section 2.3 --- */

#define ELMOPP_IWDG ((elmopp_iwdg_registers_t *)0x40003000U)
#define ELMOPP_CAN1 ((elmopp_bxcan_registers_t *)0x40006400U)
#define ELMOPP_PWR ((elmopp_pwr_registers_t *)0x40007000U)
#define ELMOPP_USART1 ((elmopp_usart_registers_t *)0x40011000U)
#define ELMOPP_GPIOB ((elmopp_gpio_registers_t *)0x40020400U)
#define ELMOPP_GPIOC ((elmopp_gpio_registers_t *)0x40020800U)
#define ELMOPP_RCC ((elmopp_rcc_registers_t *)0x40023800U)
#define ELMOPP_FLASH ((elmopp_flash_registers_t *)0x40023C00U)

/// Number of the interrupt CAN1_RX0, section 12.2, vector table.
#define ELMOPP_CAN1_RX0_INTERRUPT 20U

#endif
