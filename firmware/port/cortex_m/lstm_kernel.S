/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors
 *
 * The kernel of elmopp/lstm_kernel.h for a Cortex-M4 with its single-precision FPU (FPv4-SP), in place of
 * firmware/src/lstm_kernel.c and with its bits. Deviation D13 of docs/safety.md.
 *
 * What it gains on a compiler: sixteen sums, their weights and inputs stay in registers; constants come eight at a time;
 * a bound on a float's size is two saturating additions. VMLA rounds the product and then the sum, as the contract asks;
 * VFMA, which rounds once, must not be used here. No branch and no instruction depends on data: loops end by counters.
 *
 * It relies on the FPU as the reset leaves it: round to nearest, subnormal numbers kept, NaNs propagated (FPSCR 0).
 * Stack: 100 bytes below the caller's. Registers are kept as the procedure call standard (AAPCS, hard float) wants. */

    .syntax unified
    .cpu cortex-m4
    .fpu fpv4-sp-d16
    .thumb

/* The largest sizes that tanh tells apart, 7.9, and sigmoid, 15.8, as bits; and what makes them 0x7FFFFFFF. */
    .equ TANH_MAX, 0x40FCCCCD
    .equ SIGMOID_MAX, 0x417CCCCD
    .equ TANH_ROOM, 0x7FFFFFFF - TANH_MAX
    .equ SIGMOID_ROOM, 0x7FFFFFFF - SIGMOID_MAX

/* The coefficients of tanh in firmware/src/elementary.c, in the order of use here: p1 p3 q1 q3 q4, then p2 p0 q2 q0, which
 * every value uses up, twice for two values. Those of the sigmoid are for x in place of x/2 and for half the quotient:
 * other powers of two, so that nothing is rounded that was not. */
    .section .rodata.elmopp_lstm_kernel, "a"
    .align 2
tanh_coefficients:
    .word 0x3E6CB2C9, 0x37ACE080, 0x3F53AC54, 0x39E0E160, 0x34EF253D
    .word 0x3BAD5D41, 0x3FE4BFA1, 0x3D2E9C5F, 0x3FE4BFA3
    .word 0x3BAD5D41, 0x3FE4BFA1, 0x3D2E9C5F, 0x3FE4BFA3
sigmoid_coefficients:
    .word 0x3C6CB2C9, 0x33ACE080, 0x3E53AC54, 0x36E0E160, 0x30EF253D
    .word 0x38AD5D41, 0x3EE4BFA1, 0x3B2E9C5F, 0x3FE4BFA3
    .word 0x38AD5D41, 0x3EE4BFA1, 0x3B2E9C5F, 0x3FE4BFA3

/* One row's weights into sums s0 to s15: \fed times what r5 points at. r5 then points at the next row. */
    .macro add_row fed
    vldmia r5!, {s20-s27}
    vmla.f32 s0, s20, \fed
    vmla.f32 s1, s21, \fed
    vmla.f32 s2, s22, \fed
    vmla.f32 s3, s23, \fed
    vmla.f32 s4, s24, \fed
    vmla.f32 s5, s25, \fed
    vmla.f32 s6, s26, \fed
    vmla.f32 s7, s27, \fed
    vldmia r5, {s20-s27}
    add r5, r5, #224
    vmla.f32 s8, s20, \fed
    vmla.f32 s9, s21, \fed
    vmla.f32 s10, s22, \fed
    vmla.f32 s11, s23, \fed
    vmla.f32 s12, s24, \fed
    vmla.f32 s13, s25, \fed
    vmla.f32 s14, s26, \fed
    vmla.f32 s15, s27, \fed
    .endm

/* The quotient of a value: \x becomes (above * x) / below. On entry \square is x^2, and \p2 \p0 \q2 \q0 are loaded;
 * s26 to s30 are p1 p3 q1 q3 q4. The order is that of tanh_of() in elementary.c. */
    .macro quotient x, square, p2, p0, q2, q0
    vmla.f32 \p2, \square, s27
    vmla.f32 \p0, \square, s26
    vmla.f32 \q2, \square, s29
    vmla.f32 \q0, \square, s28
    vmul.f32 \square, \square, \square
    vmla.f32 \p0, \p2, \square
    vmla.f32 \q2, \square, s30
    vmla.f32 \q0, \q2, \square
    vmul.f32 \x, \p0, \x
    vdiv.f32 \x, \x, \q0
    .endm

/* The quotients of two values, bounded first: their sizes, as whole numbers, saturate at 0x7FFFFFFF with r10 added. */
    .macro two_quotients a, b
    vmov r6, r7, \a, \b
    bic r8, r6, #0x80000000
    bic r9, r7, #0x80000000
    qadd r8, r8, r10
    qadd r9, r9, r10
    sub r8, r8, r10
    sub r9, r9, r10
    bfi r6, r8, #0, #31
    bfi r7, r9, #0, #31
    vmov \a, \b, r6, r7
    vmul.f32 s24, \a, \a
    vmul.f32 s25, \b, \b
    vldmia r11, {s16-s23}
    quotient \a, s24, s16, s17, s18, s19
    quotient \b, s25, s20, s21, s22, s23
    .endm

    .macro two_sigmoids a, b
    two_quotients \a, \b
    vadd.f32 \a, \a, s31
    vadd.f32 \b, \b, s31
    .endm

    .section .text.elmopp_lstm_kernel, "ax"
    .align 2

/* Sums of the sixteen gates whose weights begin at r0 (bias) and r1 (rows): s0 to s15. r2: what is fed, r3: how many
 * rows. Both pointers then point at the next sixteen gates. Uses r5 to r7, s16 to s27. */
    .thumb_func
sixteen_sums:
    vldmia r0!, {s0-s15}
    mov r5, r1
    mov r6, r2
    mov r7, r3
1:  vldmia r6!, {s16-s19}
    add_row s16
    add_row s17
    add_row s18
    add_row s19
    subs r7, r7, #4
    bne 1b
    add r1, r1, #64
    bx lr

/* s0 to s15 become their tanh. Uses r6 to r11, s16 to s30. For trainer_kernel.S, too; no function that C can call. */
    .global elmopp_lstm_kernel_sixteen_tanhs
    .hidden elmopp_lstm_kernel_sixteen_tanhs
    .type elmopp_lstm_kernel_sixteen_tanhs, %function
    .thumb_func
elmopp_lstm_kernel_sixteen_tanhs:
    ldr r10, =TANH_ROOM
    ldr r11, =tanh_coefficients
    vldmia r11!, {s26-s30}
    two_quotients s0, s1
    two_quotients s2, s3
    two_quotients s4, s5
    two_quotients s6, s7
    two_quotients s8, s9
    two_quotients s10, s11
    two_quotients s12, s13
    two_quotients s14, s15
    bx lr
    .ltorg

/* elmopp_lstm_kernel_open(r0 bias, r1 row, r2 fed, r3 rows, on the stack: gate) */
    .section .text.elmopp_lstm_kernel_open, "ax"
    .align 2
    .global elmopp_lstm_kernel_open
    .type elmopp_lstm_kernel_open, %function
    .thumb_func
elmopp_lstm_kernel_open:
    push {r4-r11, lr}
    vpush {s16-s31}
    ldr r4, [sp, #100]
    mov r12, #3
2:  bl sixteen_sums
    ldr r10, =SIGMOID_ROOM
    ldr r11, =sigmoid_coefficients
    vldmia r11!, {s26-s30}
    vmov.f32 s31, #0.5
    two_sigmoids s0, s1
    two_sigmoids s2, s3
    two_sigmoids s4, s5
    two_sigmoids s6, s7
    two_sigmoids s8, s9
    two_sigmoids s10, s11
    two_sigmoids s12, s13
    two_sigmoids s14, s15
    vstmia r4!, {s0-s15}
    subs r12, r12, #1
    bne.w 2b
    bl sixteen_sums
    bl elmopp_lstm_kernel_sixteen_tanhs
    vstmia r4, {s0-s15}
    vpop {s16-s31}
    pop {r4-r11, pc}
    .ltorg
    .size elmopp_lstm_kernel_open, . - elmopp_lstm_kernel_open

/* elmopp_lstm_kernel_advance(r0 gate, r1 cell, r2 next) */
    .section .text.elmopp_lstm_kernel_advance, "ax"
    .align 2
    .global elmopp_lstm_kernel_advance
    .type elmopp_lstm_kernel_advance, %function
    .thumb_func
elmopp_lstm_kernel_advance:
    add r3, r0, #64   /* f */
    add r12, r0, #192 /* g */
    .rept 4
    vldmia r3!, {s0-s3}
    vldmia r1!, {s4-s7}
    vldmia r0!, {s8-s11}
    vldmia r12!, {s12-s15}
    vmul.f32 s0, s0, s4
    vmul.f32 s1, s1, s5
    vmul.f32 s2, s2, s6
    vmul.f32 s3, s3, s7
    vmla.f32 s0, s8, s12
    vmla.f32 s1, s9, s13
    vmla.f32 s2, s10, s14
    vmla.f32 s3, s11, s15
    vstmia r2!, {s0-s3}
    .endr
    bx lr
    .size elmopp_lstm_kernel_advance, . - elmopp_lstm_kernel_advance

/* elmopp_lstm_kernel_release(r0 gate, r1 back, r2 cell) */
    .section .text.elmopp_lstm_kernel_release, "ax"
    .align 2
    .global elmopp_lstm_kernel_release
    .type elmopp_lstm_kernel_release, %function
    .thumb_func
elmopp_lstm_kernel_release:
    push {r4-r11, lr}
    vpush {s16-s31}
    vldmia r1, {s0-s15}
    vstmia r2, {s0-s15}
    bl elmopp_lstm_kernel_sixteen_tanhs
    add r0, r0, #128 /* o */
    vldmia r0, {s16-s31}
    vmul.f32 s0, s0, s16
    vmul.f32 s1, s1, s17
    vmul.f32 s2, s2, s18
    vmul.f32 s3, s3, s19
    vmul.f32 s4, s4, s20
    vmul.f32 s5, s5, s21
    vmul.f32 s6, s6, s22
    vmul.f32 s7, s7, s23
    vmul.f32 s8, s8, s24
    vmul.f32 s9, s9, s25
    vmul.f32 s10, s10, s26
    vmul.f32 s11, s11, s27
    vmul.f32 s12, s12, s28
    vmul.f32 s13, s13, s29
    vmul.f32 s14, s14, s30
    vmul.f32 s15, s15, s31
    vstmia r1, {s0-s15}
    vpop {s16-s31}
    pop {r4-r11, pc}
    .size elmopp_lstm_kernel_release, . - elmopp_lstm_kernel_release
