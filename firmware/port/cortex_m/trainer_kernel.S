/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors
 *
 * The kernel of elmopp/trainer_kernel.h for a Cortex-M4 with its single-precision FPU (FPv4-SP), in place of
 * firmware/src/trainer_kernel.c and with its bits. Deviation D13 of docs/safety.md.
 *
 * What it gains on a compiler: sixteen sums stay in registers over all steps of a window, or sixteen slopes over all
 * rows; weights of Adam go four at a time. VMLA and VMLS round the product and then the sum, as the contract asks;
 * VFMA, which rounds once, must not be used here. No branch and no instruction depends on data: loops end by counters.
 *
 * It relies on the FPU as the reset leaves it, as lstm_kernel.S does. Stack: 100 bytes below the caller's at most.
 * Registers are kept as the procedure call standard (AAPCS, hard float) wants. */

    .syntax unified
    .cpu cortex-m4
    .fpu fpv4-sp-d16
    .thumb

/* The beginning of an inverse root, of elmopp_inverse_root() in firmware/src/elementary.c. */
    .equ ROOT_BITS, 0x5F3759DF

/* elmopp_trainer_kernel_release(r0 gate, r1 cell, r2 back_slope, r3 cell_slope) */
    .macro release_one back, open, cell_slope, bent
    vmul.f32 s28, \back, \open
    vmul.f32 s29, s28, \bent
    vmls.f32 s28, s29, \bent
    vadd.f32 \cell_slope, \cell_slope, s28
    vmul.f32 s30, \back, \bent
    vmov.f32 s31, \open
    vmls.f32 s31, \open, \open
    vmul.f32 \open, s30, s31
    .endm

    .macro release_four b0, b1, b2, b3
    vldmia r2!, {s16-s19}
    vldmia r0, {s20-s23}
    vldmia r3, {s24-s27}
    release_one s16, s20, s24, \b0
    release_one s17, s21, s25, \b1
    release_one s18, s22, s26, \b2
    release_one s19, s23, s27, \b3
    vstmia r0!, {s20-s23}
    vstmia r3!, {s24-s27}
    .endm

    .section .text.elmopp_trainer_kernel_release, "ax"
    .align 2
    .global elmopp_trainer_kernel_release
    .type elmopp_trainer_kernel_release, %function
    .thumb_func
elmopp_trainer_kernel_release:
    push {r4-r11, lr}
    vpush {s16-s31}
    vldmia r1, {s0-s15}
    bl elmopp_lstm_kernel_sixteen_tanhs
    add r0, r0, #128 /* o */
    release_four s0, s1, s2, s3
    release_four s4, s5, s6, s7
    release_four s8, s9, s10, s11
    release_four s12, s13, s14, s15
    vpop {s16-s31}
    pop {r4-r11, pc}
    .size elmopp_trainer_kernel_release, . - elmopp_trainer_kernel_release

/* elmopp_trainer_kernel_advance(r0 gate, r1 cell, r2 made_slope, r3 kept_slope, on the stack: cell_slope) */
    .macro advance_one in, keep, given, cell, made, kept
    vmul.f32 s24, \made, \in
    vmul.f32 s25, \made, \given
    vmov.f32 s26, \in
    vmls.f32 s26, \in, \in
    vmul.f32 \in, s25, s26
    vmul.f32 s27, \kept, \cell
    vmov.f32 s28, \keep
    vmls.f32 s28, \keep, \keep
    vmul.f32 \cell, \kept, \keep
    vmul.f32 \keep, s27, s28
    vmul.f32 s29, s24, \given
    vmls.f32 s24, s29, \given
    vmov.f32 \given, s24
    .endm

    .section .text.elmopp_trainer_kernel_advance, "ax"
    .align 2
    .global elmopp_trainer_kernel_advance
    .type elmopp_trainer_kernel_advance, %function
    .thumb_func
elmopp_trainer_kernel_advance:
    push {r4-r7}
    ldr r4, [sp, #16]
    vpush {s16-s29}
    add r5, r0, #64   /* f */
    add r6, r0, #192  /* g */
    .rept 4
    vldmia r0, {s0-s3}
    vldmia r5, {s4-s7}
    vldmia r6, {s8-s11}
    vldmia r1!, {s12-s15}
    vldmia r2!, {s16-s19}
    vldmia r3!, {s20-s23}
    advance_one s0, s4, s8, s12, s16, s20
    advance_one s1, s5, s9, s13, s17, s21
    advance_one s2, s6, s10, s14, s18, s22
    advance_one s3, s7, s11, s15, s19, s23
    vstmia r0!, {s0-s3}
    vstmia r5!, {s4-s7}
    vstmia r6!, {s8-s11}
    vstmia r4!, {s12-s15}
    .endr
    vpop {s16-s29}
    pop {r4-r7}
    bx lr
    .size elmopp_trainer_kernel_advance, . - elmopp_trainer_kernel_advance

/* elmopp_trainer_kernel_answer(r0 row, r1 said_slope, r2 hidden, r3 hidden_slope, on the stack: row_slope) */
    .macro answer_one hidden, hidden_slope
    vldmia r0!, {s24-s27}
    vldmia r4, {s28-s31}
    vmla.f32 s28, \hidden, s16
    vmla.f32 s29, \hidden, s17
    vmla.f32 s30, \hidden, s18
    vmla.f32 s31, \hidden, s19
    vstmia r4!, {s28-s31}
    vmul.f32 s24, s24, s16
    vmul.f32 s26, s26, s18
    vmla.f32 s24, s25, s17
    vmla.f32 s26, s27, s19
    vadd.f32 s24, s24, s26
    vadd.f32 \hidden_slope, \hidden_slope, s24
    .endm

    .section .text.elmopp_trainer_kernel_answer, "ax"
    .align 2
    .global elmopp_trainer_kernel_answer
    .type elmopp_trainer_kernel_answer, %function
    .thumb_func
elmopp_trainer_kernel_answer:
    push {r4}
    ldr r4, [sp, #4]
    vpush {s16-s31}
    vldmia r1, {s16-s19}
    .rept 4
    vldmia r2!, {s0-s3}
    vldmia r3, {s4-s7}
    answer_one s0, s4
    answer_one s1, s5
    answer_one s2, s6
    answer_one s3, s7
    vstmia r3!, {s4-s7}
    .endr
    vpop {s16-s31}
    pop {r4}
    bx lr
    .size elmopp_trainer_kernel_answer, . - elmopp_trainer_kernel_answer

/* elmopp_trainer_kernel_project(r0 row, r1 rows, r2 gate_slope, r3 fed_slope). Sixteen slopes at a time, all rows. */
    .macro project_row
    vldmia r5!, {s1-s8}
    vmla.f32 s0, s1, s16
    vmla.f32 s0, s2, s17
    vmla.f32 s0, s3, s18
    vmla.f32 s0, s4, s19
    vmla.f32 s0, s5, s20
    vmla.f32 s0, s6, s21
    vmla.f32 s0, s7, s22
    vmla.f32 s0, s8, s23
    vldmia r5, {s8-s15}
    vmla.f32 s0, s8, s24
    vmla.f32 s0, s9, s25
    vmla.f32 s0, s10, s26
    vmla.f32 s0, s11, s27
    vmla.f32 s0, s12, s28
    vmla.f32 s0, s13, s29
    vmla.f32 s0, s14, s30
    vmla.f32 s0, s15, s31
    vstmia r8!, {s0}
    subs r6, r6, #1
    add r5, r5, #224
    .endm

    .macro sixteen_slopes
    vldmia r2!, {s16-s31}
    mov r5, r0
    mov r6, r1
    mov r8, r3
    .endm

    .section .text.elmopp_trainer_kernel_project, "ax"
    .align 2
    .global elmopp_trainer_kernel_project
    .type elmopp_trainer_kernel_project, %function
    .thumb_func
elmopp_trainer_kernel_project:
    push {r4-r8, lr}
    vpush {s16-s31}
    cmp r1, #0
    beq.w 4f
    mov r4, #3
    mov r7, #0
    sixteen_slopes
1:  vmov s0, r7
    project_row
    bne 1b
2:  add r0, r0, #64
    sixteen_slopes
3:  vldr s0, [r8]
    project_row
    bne 3b
    subs r4, r4, #1
    bne 2b
4:  vpop {s16-s31}
    pop {r4-r8, pc}
    .size elmopp_trainer_kernel_project, . - elmopp_trainer_kernel_project

/* elmopp_trainer_kernel_gather(r0 fed, r1 stride, r2 gate_slope, r3 steps, on the stack: row_slope). Sixteen columns at
 * a time, all steps. */
    .section .text.elmopp_trainer_kernel_gather, "ax"
    .align 2
    .global elmopp_trainer_kernel_gather
    .type elmopp_trainer_kernel_gather, %function
    .thumb_func
elmopp_trainer_kernel_gather:
    push {r4-r8, lr}
    ldr r4, [sp, #24]
    vpush {s16-s28}
    lsl r1, r1, #2
    mov r8, #4
    cmp r3, #0
    beq.w 3f
1:  vldmia r4, {s0-s15}
    mov r5, r2
    mov r6, r0
    mov r7, r3
2:  vldmia r5!, {s17-s24}
    vldr s16, [r6]
    add r6, r6, r1
    vmla.f32 s0, s16, s17
    vmla.f32 s1, s16, s18
    vmla.f32 s2, s16, s19
    vmla.f32 s3, s16, s20
    vmla.f32 s4, s16, s21
    vmla.f32 s5, s16, s22
    vmla.f32 s6, s16, s23
    vmla.f32 s7, s16, s24
    vldmia r5, {s17-s24}
    subs r7, r7, #1
    add r5, r5, #224
    vmla.f32 s8, s16, s17
    vmla.f32 s9, s16, s18
    vmla.f32 s10, s16, s19
    vmla.f32 s11, s16, s20
    vmla.f32 s12, s16, s21
    vmla.f32 s13, s16, s22
    vmla.f32 s14, s16, s23
    vmla.f32 s15, s16, s24
    bne 2b
    vstmia r4!, {s0-s15}
    add r2, r2, #64
    subs r8, r8, #1
    bne 1b
3:  vpop {s16-s28}
    pop {r4-r8, pc}
    .size elmopp_trainer_kernel_gather, . - elmopp_trainer_kernel_gather

/* elmopp_trainer_kernel_squares(r0 slope, r1 count, s0 sum) */
    .section .text.elmopp_trainer_kernel_squares, "ax"
    .align 2
    .global elmopp_trainer_kernel_squares
    .type elmopp_trainer_kernel_squares, %function
    .thumb_func
elmopp_trainer_kernel_squares:
    cbz r1, 2f
1:  vldmia r0!, {s1-s4}
    subs r1, r1, #4
    vmla.f32 s0, s1, s1
    vmla.f32 s0, s2, s2
    vmla.f32 s0, s3, s3
    vmla.f32 s0, s4, s4
    bne 1b
2:  bx lr
    .size elmopp_trainer_kernel_squares, . - elmopp_trainer_kernel_squares

/* elmopp_trainer_kernel_descend(r0 descent, r1 weight, r2 slope, r3 mean, on the stack: square, count) */
    .macro averages slope, mean, square
    vmul.f32 \slope, s16, \slope
    vsub.f32 s24, \slope, \mean
    vmla.f32 \mean, s17, s24
    vmul.f32 s25, \slope, \slope
    vsub.f32 s25, s25, \square
    vmla.f32 \square, s18, s25
    vadd.f32 \slope, \square, s20
    .endm

/* On entry \x is the square and the floor. */
    .macro descend_one x, root, mean, weight
    vmul.f32 \x, s21, \x
    vmul.f32 s26, \x, \root
    vmov.f32 s27, s22
    vmls.f32 s27, s26, \root
    vmul.f32 \root, \root, s27
    vmul.f32 s26, \x, \root
    vmov.f32 s27, s22
    vmls.f32 s27, s26, \root
    vmul.f32 \root, \root, s27
    vmul.f32 s26, s19, \mean
    vmls.f32 \weight, s26, \root
    .endm

    .section .text.elmopp_trainer_kernel_descend, "ax"
    .align 2
    .global elmopp_trainer_kernel_descend
    .type elmopp_trainer_kernel_descend, %function
    .thumb_func
elmopp_trainer_kernel_descend:
    push {r4-r11}
    ldr r4, [sp, #32]
    ldr r5, [sp, #36]
    vpush {s16-s31}
    vldmia r0, {s16-s20}
    vmov.f32 s21, #0.5
    vmov.f32 s22, #1.5
    ldr r6, =ROOT_BITS
    mov r7, #0
    cmp r5, #0
    beq.w 2f
1:  vldmia r2, {s0-s3}
    vldmia r3, {s4-s7}
    vldmia r4, {s8-s11}
    vldmia r1, {s12-s15}
    averages s0, s4, s8
    averages s1, s5, s9
    averages s2, s6, s10
    averages s3, s7, s11
    vstmia r3!, {s4-s7}
    vstmia r4!, {s8-s11}
    vmov r8, r9, s0, s1
    vmov r10, r11, s2, s3
    sub r8, r6, r8, lsr #1
    sub r9, r6, r9, lsr #1
    sub r10, r6, r10, lsr #1
    sub r11, r6, r11, lsr #1
    vmov s28, s29, r8, r9
    vmov s30, s31, r10, r11
    descend_one s0, s28, s4, s12
    descend_one s1, s29, s5, s13
    descend_one s2, s30, s6, s14
    descend_one s3, s31, s7, s15
    vstmia r1!, {s12-s15}
    str r7, [r2], #4
    str r7, [r2], #4
    str r7, [r2], #4
    str r7, [r2], #4
    subs r5, r5, #4
    bne.w 1b
2:  vpop {s16-s31}
    pop {r4-r11}
    bx lr
    .ltorg
    .size elmopp_trainer_kernel_descend, . - elmopp_trainer_kernel_descend
