/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Start of a test program on the emulated board MPS2 AN386 (Cortex-M4 with FPU), as an ordinary C program.
///
/// The vectors lead to newlib's start-up (--specs=rdimon.specs), which takes the arguments from the emulator, calls
/// main() and hands the emulator its result; files and output are the emulator's, by semihosting. A fault ends the
/// emulator with an exit code of its own instead of hanging.

#include <stdint.h>

#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88U)
#define FPU_FULL_ACCESS (0xFU << 20U)
#define FAULT_STATUS (*(volatile uint32_t *)0xE000ED28U)
#define STACK_IS_BAD 0x1010U ///< STKERR and MSTKERR: what the frame holds was never written

#define SEMIHOSTING_WRITE0 0x04U
#define SEMIHOSTING_EXIT_EXTENDED 0x20U
#define EXIT_BY_PROGRAM 0x20026U
#define EXIT_CODE_OF_FAULT 99U

#define VECTORS 16U
#define HEX_DIGITS 8U

typedef void (*handler_t)(void);

typedef struct {
    uint32_t *stack;
    handler_t handler[VECTORS - 1U];
} vectors_t;

extern uint32_t __stack[]; /* from the linker script */
extern void _start(void);  /* newlib's */

static void ask_emulator(uint32_t operation, const void *argument) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

static void say(const char *text) {
    ask_emulator(SEMIHOSTING_WRITE0, text);
}

static void say_hex(uint32_t value) {
    char text[HEX_DIGITS + 1U];
    for (uint32_t i = 0U; i < HEX_DIGITS; i++) {
        text[i] = "0123456789abcdef"[(value >> (28U - (4U * i))) & 0xFU];
    }
    text[HEX_DIGITS] = '\0';
    say(text);
}

/* `frame` is what the processor pushed: r0 to r3, r12, lr, pc, xpsr. */
__attribute__((noreturn, used)) static void end_by_fault(const uint32_t *frame) {
    const uint32_t status = FAULT_STATUS;
    say("fault, status 0x");
    say_hex(status);
    if ((status & STACK_IS_BAD) == 0U) {
        say(" at pc 0x");
        say_hex(frame[6]);
    }
    say("\n");
    static const uint32_t reason[2] = {EXIT_BY_PROGRAM, EXIT_CODE_OF_FAULT};
    ask_emulator(SEMIHOSTING_EXIT_EXTENDED, reason);
    for (;;) {
    }
}

__attribute__((naked)) static void fault(void) {
    __asm__ volatile("mov r0, sp\n\tb end_by_fault");
}

static void reset(void) {
    COPROCESSOR_ACCESS |= FPU_FULL_ACCESS;
    __asm__ volatile("dsb\n\tisb");
    _start();
}

/* No interrupt is ever enabled: every other exception is a fault. */
__attribute__((section(".vectors"), used)) static const vectors_t vectors = {
    __stack, {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault}};
