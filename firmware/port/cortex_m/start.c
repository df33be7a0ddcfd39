/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// Start of a board: vectors, memory test, the C environment, main. A fault ends in elmopp_port_fail().
///
/// The stack moves while RAM is tested, so that all of it is: first it lies in the upper half, then, in what has been
/// found good, in the lower one. Only elmopp_note is left alone. A second block of RAM, if the board has one, is tested
/// after that; it holds nothing but variables that begin with zero.

#include "board.h"
#include "elmopp/assert.h"
#include "memory_test.h"
#include "note.h"
#include "port.h"
#include "systick.h"

#define COPROCESSOR_ACCESS (*(volatile uint32_t *)0xE000ED88U)
#define FPU_FULL_ACCESS (0xFU << 20U)
#define EXCEPTIONS 16U

typedef void (*handler_t)(void);

typedef struct {
    uint32_t *stack;
    handler_t handler[EXCEPTIONS - 1U];
} vectors_t;

/* From the linker script. */
extern uint32_t elmopp_ram_start[], elmopp_ram_middle[], elmopp_ram_end[];
extern uint32_t elmopp_aside_start[], elmopp_aside_end[];
extern uint32_t elmopp_data_load[], elmopp_data_start[], elmopp_data_end[];
extern uint32_t elmopp_bss_start[], elmopp_bss_end[];

void elmopp_reset_handler(void);

__attribute__((used)) static bool lower_half_is_good(void) {
    return elmopp_memory_test(elmopp_ram_start, elmopp_ram_middle);
}

__attribute__((used)) static bool upper_half_is_good(void) {
    return elmopp_memory_test(elmopp_ram_middle, elmopp_ram_end);
}

__attribute__((used)) static bool second_block_is_good(void) {
    return elmopp_memory_test(elmopp_aside_start, elmopp_aside_end);
}

static void clear(uint32_t *begin, const uint32_t *end) {
    for (uint32_t *to = begin; to < end; to++) {
        *to = 0U;
    }
}

__attribute__((used, noreturn)) static void make_c_environment(bool memory_is_good) {
    const uint32_t *from = elmopp_data_load;
    for (uint32_t *to = elmopp_data_start; to < elmopp_data_end; to++) {
        *to = *from;
        from++;
    }
    clear(elmopp_bss_start, elmopp_bss_end);
    clear(elmopp_aside_start, elmopp_aside_end);
    COPROCESSOR_ACCESS |= FPU_FULL_ACCESS;
    __asm__ volatile("dsb\n\tisb" : : : "memory");
    elmopp_board_run(memory_is_good);
}

/* Neither half may be called with its own stack under it; r4 keeps the answers so far. */
__attribute__((naked)) void elmopp_reset_handler(void) {
    __asm__ volatile("cpsid i\n\t"
                     "ldr r0, =elmopp_ram_end\n\t"
                     "mov sp, r0\n\t"
                     "bl lower_half_is_good\n\t"
                     "mov r4, r0\n\t"
                     "ldr r0, =elmopp_ram_middle\n\t"
                     "mov sp, r0\n\t"
                     "bl upper_half_is_good\n\t"
                     "and r4, r0, r4\n\t"
                     "bl second_block_is_good\n\t"
                     "and r0, r0, r4\n\t"
                     "ldr r1, =elmopp_ram_end\n\t"
                     "mov sp, r1\n\t"
                     "b make_c_environment\n\t"
                     ".ltorg");
}

static void fault(void) {
    elmopp_note_fault();
    elmopp_port_fail("fault handler");
}

/* An interrupt that nobody asked for is a fault, too. */
void elmopp_unexpected_handler(void) {
    elmopp_note_fault();
    elmopp_port_fail("unexpected interrupt");
}

void elmopp_assert_failed(const char *file, int line) {
    (void)line;
    elmopp_note_fault();
    elmopp_port_fail(file);
}

/* The board's own interrupts follow in section .vectors.device. */
__attribute__((section(".vectors"), used)) static const vectors_t vectors = {
    elmopp_ram_end,
    {elmopp_reset_handler, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault,
     elmopp_systick_handler}};
