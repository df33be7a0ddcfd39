/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors
 *
 * The kernel of elmopp/lstm_q15_kernel.h for a Cortex-M4 with its DSP instructions, in place of
 * firmware/src/lstm_q15_kernel.c and with its bits. Deviation D13 of docs/safety.md.
 *
 * What it gains on a compiler: four sums stay in registers while what is fed is read once for all four; two products and
 * their sum are one instruction (SMLAD), a scaled and rounded row with its bias another (SMMLAR), the bound on a table's
 * index and its shift a third (SSAT). No branch and no instruction depends on data: loops end by addresses.
 *
 * Sums may set the sticky flag Q of the status register in no case: they cannot overflow; QDADD sets it where a cell
 * saturates. Nobody reads it. Stack: 52 bytes below the caller's. Registers are kept as the procedure call standard
 * (AAPCS) wants. */

    .syntax unified
    .cpu cortex-m4
    .thumb

    .equ TABLE_ZERO, 4 * 512 /* bytes from a table's begin to the entry of reach 0 */
    .equ GATE_F, 64          /* bytes from gate i to the others */
    .equ GATE_O, 128
    .equ GATE_G, 192

/* One row's weights of a run, from r0, times what is fed, r6 to r9, added to \sum; \first begins the sum. */
    .macro add_row sum, first
    ldm r0!, {r10, r11, r12, lr}
    .if \first
    smuad \sum, r10, r6
    .else
    smlad \sum, r10, r6, \sum
    .endif
    smlad \sum, r11, r7, \sum
    smlad \sum, r12, r8, \sum
    smlad \sum, lr, r9, \sum
    .endm

/* A run of all four rows. */
    .macro add_run first
    add_row r2, \first
    add_row r3, \first
    add_row r4, \first
    add_row r5, \first
    .endm

/* A value's gate: \index and \reach become the entry of the table at r6 and the result. */
    .macro open_two reach_a, reach_b, index_a, index_b
    ssat \index_a, #10, \reach_a, asr #15
    ssat \index_b, #10, \reach_b, asr #15
    ldr \index_a, [r6, \index_a, lsl #2]
    ldr \index_b, [r6, \index_b, lsl #2]
    smlabb \reach_a, \index_a, \reach_a, \index_a
    smlabb \reach_b, \index_b, \reach_b, \index_b
    .endm

/* A function that opens all gates of a level. \runs: a macro with the sums of a band into r2 to r5, from weights at r0 and
 * what is fed at r1, which is moved. On the stack: the table, where the next gates go, where this table's gates end. */
    .macro level name, runs
    .section .text.\name, "ax"
    .align 2
    .global \name
    .type \name, %function
    .thumb_func
\name:
    push {r4-r11, lr}
    sub sp, sp, #16
    add r4, r2, #GATE_G
    ldr r3, =elmopp_lstm_q15_sigmoid + TABLE_ZERO
    strd r3, r2, [sp]
    str r4, [sp, #8]
1:  \runs
    ldm r0!, {r6-r12, lr} /* four scales, four biases */
    smmlar r2, r2, r6, r10
    smmlar r3, r3, r7, r11
    smmlar r4, r4, r8, r12
    smmlar r5, r5, r9, lr
    ldm sp, {r6-r8}
    open_two r2, r3, r9, r10
    open_two r4, r5, r11, r12
    stm r7!, {r2-r5}
    str r7, [sp, #4]
    cmp r7, r8
    bne.w 1b
    ldr r9, =elmopp_lstm_q15_tanh + TABLE_ZERO
    add r8, r7, #64
    cmp r6, r9
    ittt ne
    movne r6, r9
    stmne sp, {r6-r8}
    bne.w 1b
    add sp, sp, #16
    pop {r4-r11, pc}
    .ltorg
    .size \name, . - \name
    .endm

    .macro outer_runs
    ldm r1!, {r6-r9}
    add_run 1
    ldm r1!, {r6-r9}
    add_run 0
    ldm r1, {r6, r7}
    sub r1, r1, #32
    ldm r0!, {r8-r11}
    smlad r2, r8, r6, r2
    smlad r2, r9, r7, r2
    smlad r3, r10, r6, r3
    smlad r3, r11, r7, r3
    ldm r0!, {r8-r11}
    smlad r4, r8, r6, r4
    smlad r4, r9, r7, r4
    smlad r5, r10, r6, r5
    smlad r5, r11, r7, r5
    .endm

    .macro inner_runs
    ldm r1!, {r6-r9}
    add_run 1
    ldm r1!, {r6-r9}
    add_run 0
    ldm r1!, {r6-r9}
    add_run 0
    ldm r1, {r6-r9}
    sub r1, r1, #48
    add_run 0
    .endm

/* elmopp_lstm_q15_kernel_outer(r0 band, r1 fed, r2 gate), elmopp_lstm_q15_kernel_inner likewise */
    level elmopp_lstm_q15_kernel_outer, outer_runs
    level elmopp_lstm_q15_kernel_inner, inner_runs

/* elmopp_lstm_q15_kernel_descend(r0 gate, r1 cell, r2 fed): two values at a time; r12 and lr round. */
    .section .text.elmopp_lstm_q15_kernel_descend, "ax"
    .align 2
    .global elmopp_lstm_q15_kernel_descend
    .type elmopp_lstm_q15_kernel_descend, %function
    .thumb_func
elmopp_lstm_q15_kernel_descend:
    push {r4-r7, lr}
    mov r12, #0x4000
    mov lr, #0x2000
    .set at, 0
    .rept 8
    ldrd r4, r5, [r0, #at]
    ldrd r6, r7, [r0, #GATE_G + at]
    smmla r4, r4, r6, r12
    smmla r5, r5, r7, r12
    asr r4, r4, #15
    pkhbt r4, r4, r5, lsl #1
    str r4, [r2, #at / 2]
    ldrd r4, r5, [r0, #GATE_F + at]
    ldrd r6, r7, [r1, #at]
    smmla r4, r4, r6, lr
    smmla r5, r5, r7, lr
    asr r4, r4, #14
    pkhbt r4, r4, r5, lsl #2
    str r4, [r2, #32 + at / 2]
    .set at, at + 8
    .endr
    pop {r4-r7, pc}
    .size elmopp_lstm_q15_kernel_descend, . - elmopp_lstm_q15_kernel_descend

/* elmopp_lstm_q15_kernel_advance(r0 gate, r1 cell, r2 back) */
    .section .text.elmopp_lstm_q15_kernel_advance, "ax"
    .align 2
    .global elmopp_lstm_q15_kernel_advance
    .type elmopp_lstm_q15_kernel_advance, %function
    .thumb_func
elmopp_lstm_q15_kernel_advance:
    push {r4-r11, lr}
    ldr r6, =elmopp_lstm_q15_tanh + TABLE_ZERO
    .set at, 0
    .rept 8
    ldrd r4, r5, [r0, #at]
    ldrd r8, r9, [r0, #GATE_G + at]
    smmulr r4, r4, r8
    smmulr r5, r5, r9
    ldrd r8, r9, [r0, #GATE_F + at]
    ldrd r10, r11, [r1, #at]
    smmulr r8, r8, r10
    smmulr r9, r9, r11
    asr r4, r4, #9
    asr r5, r5, #9
    qdadd r4, r4, r8
    qdadd r5, r5, r9
    strd r4, r5, [r1, #at]
    open_two r4, r5, r8, r9
    ldrd r8, r9, [r0, #GATE_O + at]
    smmulr r4, r4, r8
    smmulr r5, r5, r9
    strd r4, r5, [r2, #at]
    .set at, at + 8
    .endr
    pop {r4-r11, pc}
    .ltorg
    .size elmopp_lstm_q15_kernel_advance, . - elmopp_lstm_q15_kernel_advance

/* elmopp_lstm_q15_kernel_release(r0 gate, r1 back, r2 cell) */
    .section .text.elmopp_lstm_q15_kernel_release, "ax"
    .align 2
    .global elmopp_lstm_q15_kernel_release
    .type elmopp_lstm_q15_kernel_release, %function
    .thumb_func
elmopp_lstm_q15_kernel_release:
    push {r4-r9, lr}
    ldr r6, =elmopp_lstm_q15_tanh + TABLE_ZERO
    .set at, 0
    .rept 8
    ldrd r4, r5, [r1, #at]
    strd r4, r5, [r2, #at]
    asr r4, r4, #9
    asr r5, r5, #9
    open_two r4, r5, r8, r9
    ldrd r8, r9, [r0, #GATE_O + at]
    smmulr r4, r4, r8
    smmulr r5, r5, r9
    strd r4, r5, [r1, #at]
    .set at, at + 8
    .endr
    pop {r4-r9, pc}
    .ltorg
    .size elmopp_lstm_q15_kernel_release, . - elmopp_lstm_q15_kernel_release

/* elmopp_lstm_q15_kernel_hide(r0 back, r1 hidden): four values at a time. */
    .section .text.elmopp_lstm_q15_kernel_hide, "ax"
    .align 2
    .global elmopp_lstm_q15_kernel_hide
    .type elmopp_lstm_q15_kernel_hide, %function
    .thumb_func
elmopp_lstm_q15_kernel_hide:
    push {r4, r5}
    mov r12, #0x4000
    .rept 4
    ldm r0!, {r2-r5}
    add r2, r2, r12
    add r3, r3, r12
    add r4, r4, r12
    add r5, r5, r12
    asr r2, r2, #15
    asr r4, r4, #15
    pkhbt r2, r2, r3, lsl #1
    pkhbt r4, r4, r5, lsl #1
    stm r1!, {r2, r4}
    .endr
    pop {r4, r5}
    bx lr
    .size elmopp_lstm_q15_kernel_hide, . - elmopp_lstm_q15_kernel_hide
