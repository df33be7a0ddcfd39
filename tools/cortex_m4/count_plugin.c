/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// A plugin of QEMU's translator (TCG) that counts the instructions of a Cortex-M4 program between two marks, exactly,
/// and weighs them as the Cortex-M4's manual does: tools/bench-cortex-m4 builds and loads it.
///
///     cc -O2 -shared -fPIC count_plugin.c -o count_plugin.so
///     qemu-system-arm -M mps2-an386 -plugin count_plugin.so,out=FILE -kernel PROGRAM ...
///
/// The marks are two instructions that do nothing, hints without a meaning (tests/board/count_marks.h). For each pair
/// FILE gets a line `instructions cycles`, without the marks. Pairs do not nest.
///
/// Cycles are a model, never compared with silicon: the timings of the Cortex-M4 r0p1 technical reference manual,
/// tables 3-1 and 7-1, for memory without wait states; every jump refills the pipeline in 2 cycles; a division of whole
/// numbers takes its longest, 12. What an instruction waits for another's result, and what overlaps, is left out.
///
/// The processor has one core, so nothing is locked. QEMU's own header is in no Debian package: what is used of its
/// interface (version 1, stable since QEMU 4.2) is declared here.

#include <inttypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef uint64_t plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef void (*on_translation_fn_t)(plugin_id_t id, struct qemu_plugin_tb *block);
typedef void (*on_execution_fn_t)(unsigned int processor, void *data);
typedef void (*on_exit_fn_t)(plugin_id_t id, void *data);

enum { NO_REGISTERS = 0, ADD_U64 = 0 };

void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id_t id, on_translation_fn_t function);
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *block, on_execution_fn_t function, int flags,
                                          void *data);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *insn, on_execution_fn_t function, int flags,
                                            void *data);
void qemu_plugin_register_vcpu_insn_exec_inline(struct qemu_plugin_insn *insn, int operation, void *counter,
                                                uint64_t value);
void qemu_plugin_register_atexit_cb(plugin_id_t id, on_exit_fn_t function, void *data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *block);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *block, size_t index);
const void *qemu_plugin_insn_data(const struct qemu_plugin_insn *insn);

/* What QEMU looks for. */
__attribute__((visibility("default"))) extern int qemu_plugin_version;
int qemu_plugin_version = 1;
__attribute__((visibility("default"))) int qemu_plugin_install(plugin_id_t id, const void *info, int argc, char **argv);

#define MARK_BEGIN 0xF3AF8040U
#define MARK_END 0xF3AF8041U
#define REFILL_CYCLES 2U

static FILE *out;
static uint64_t instructions;
static uint64_t cycles;
static uint64_t expected_address; ///< of the next block, if nobody jumps
static uint64_t instructions_before;
static uint64_t cycles_before;
static bool counting;

/* --- the model -------------------------------------------------------------------------------------------------- */

static uint32_t ones(uint32_t mask) {
    return (uint32_t)__builtin_popcount(mask);
}

static uint32_t cycles_of_narrow(uint32_t insn) {
    const uint32_t top = insn >> 12U;
    if ((insn & 0xFE00U) == 0xB400U || (insn & 0xFE00U) == 0xBC00U) {
        return 1U + ones(insn & 0x1FFU); /* PUSH, POP */
    }
    if (top == 0xCU) {
        return 1U + ones(insn & 0xFFU); /* STM, LDM */
    }
    const bool loads_or_stores = ((insn & 0xF800U) == 0x4800U) || ((top >= 0x5U) && (top <= 0x9U));
    return loads_or_stores ? 2U : 1U;
}

/* LDM, STM, LDRD, STRD, exclusive accesses, TBB. */
static uint32_t cycles_of_multiple(uint32_t first, uint32_t second) {
    if ((first & 0x0040U) == 0U) {
        return 1U + ones(second);
    }
    const bool is_pair = (first & 0x0120U) != 0U;
    return is_pair ? 3U : 2U;
}

static uint32_t cycles_of_float_memory(uint32_t first, uint32_t second) {
    if ((first & 0xFFE0U) == 0xEC40U) {
        return 2U; /* VMOV of two registers */
    }
    const bool is_double = (second & 0x0100U) != 0U;
    if ((first & 0x0120U) == 0x0100U) {
        return is_double ? 3U : 2U; /* VLDR, VSTR */
    }
    return 1U + (second & 0xFFU); /* VLDM, VSTM, VPUSH, VPOP */
}

static uint32_t cycles_of_float(uint32_t first, uint32_t second) {
    if ((second & 0x0010U) != 0U) {
        return 1U; /* VMOV to and from a core register, VMRS */
    }
    switch ((first >> 4U) & 0xBU) {
    case 0x0U: /* VMLA, VMLS */
    case 0x1U: /* VNMLA, VNMLS */
    case 0x9U: /* VFNMA, VFNMS */
    case 0xAU: /* VFMA, VFMS */
        return 3U;
    case 0x8U:
        return 14U; /* VDIV */
    case 0xBU: {
        const bool is_root = ((first & 0xFU) == 1U) && ((second & 0xC0U) == 0xC0U);
        return is_root ? 14U : 1U;
    }
    default:
        return 1U;
    }
}

static uint32_t cycles_of_wide(uint32_t first, uint32_t second) {
    const bool is_float = (second & 0x0E00U) == 0x0A00U;
    if ((first & 0xFE00U) == 0xE800U) {
        return cycles_of_multiple(first, second);
    }
    if ((first & 0xFE00U) == 0xF800U) {
        return 2U; /* LDR, STR of any size */
    }
    if (((first & 0xFFF0U) == 0xFB90U) || ((first & 0xFFF0U) == 0xFBB0U)) {
        return 12U; /* SDIV, UDIV */
    }
    if (is_float && ((first & 0xFE00U) == 0xEC00U)) {
        return cycles_of_float_memory(first, second);
    }
    if (is_float && ((first & 0xFF00U) == 0xEE00U)) {
        return cycles_of_float(first, second);
    }
    const bool is_special = ((first & 0xFFE0U) == 0xF380U) && ((second & 0xD000U) == 0x8000U);
    return (is_special || (first == 0xF3EFU)) ? 2U : 1U; /* MSR, MRS */
}

/* --- counting --------------------------------------------------------------------------------------------------- */

typedef struct {
    uint64_t begin;
    uint64_t end;
} block_t;

/* Somebody jumped here if the last block did not end where this one begins. */
static void enter_block(unsigned int processor, void *data) {
    const block_t *block = data;
    (void)processor;
    if (block->begin != expected_address) {
        cycles += REFILL_CYCLES;
    }
    expected_address = block->end;
}

static void begin(unsigned int processor, void *data) {
    (void)processor;
    (void)data;
    if (counting) {
        (void)fprintf(stderr, "count_plugin: a mark begins what has begun already\n");
        exit(1);
    }
    counting = true;
    instructions_before = instructions;
    cycles_before = cycles;
}

/* The marks themselves are not counted: the first is in the sum already when it is seen, or neither is. */
static void end(unsigned int processor, void *data) {
    (void)processor;
    (void)data;
    if (!counting) {
        (void)fprintf(stderr, "count_plugin: a mark ends what has not begun\n");
        exit(1);
    }
    counting = false;
    (void)fprintf(out, "%" PRIu64 " %" PRIu64 "\n", instructions - instructions_before - 1U,
                  cycles - cycles_before - 1U);
}

static uint32_t first_half(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8U);
}

/* How many bytes it has. QEMU's own answer is wrong for the last one of a page, where it looks one further. */
static uint32_t instrument(struct qemu_plugin_insn *insn) {
    const uint8_t *bytes = qemu_plugin_insn_data(insn);
    const uint32_t first = first_half(bytes);
    const bool is_wide = first >= 0xE800U;
    const uint32_t second = is_wide ? first_half(&bytes[2]) : 0U;
    const uint32_t weight = is_wide ? cycles_of_wide(first, second) : cycles_of_narrow(first);
    const uint32_t whole = (first << 16U) | second;
    if (is_wide && ((whole == MARK_BEGIN) || (whole == MARK_END))) {
        on_execution_fn_t function = (whole == MARK_BEGIN) ? begin : end;
        qemu_plugin_register_vcpu_insn_exec_cb(insn, function, NO_REGISTERS, NULL);
    }
    qemu_plugin_register_vcpu_insn_exec_inline(insn, ADD_U64, &instructions, 1U);
    qemu_plugin_register_vcpu_insn_exec_inline(insn, ADD_U64, &cycles, weight);
    return is_wide ? 4U : 2U;
}

static void on_translation(plugin_id_t id, struct qemu_plugin_tb *translated) {
    (void)id;
    const size_t count = qemu_plugin_tb_n_insns(translated);
    block_t *block = malloc(sizeof *block); /* lives as long as the translation, that is to the end */
    if (block == NULL) {
        abort();
    }
    block->begin = qemu_plugin_tb_vaddr(translated);
    block->end = block->begin;
    for (size_t i = 0U; i < count; i++) {
        block->end += instrument(qemu_plugin_tb_get_insn(translated, i));
    }
    qemu_plugin_register_vcpu_tb_exec_cb(translated, enter_block, NO_REGISTERS, block);
}

static void finish(plugin_id_t id, void *data) {
    (void)id;
    (void)data;
    if (fclose(out) != 0) {
        (void)fprintf(stderr, "count_plugin: the counts cannot be written\n");
    }
}

int qemu_plugin_install(plugin_id_t id, const void *info, int argc, char **argv) {
    (void)info;
    if ((argc != 1) || (strncmp(argv[0], "out=", 4U) != 0)) {
        (void)fprintf(stderr, "count_plugin: usage: -plugin count_plugin.so,out=FILE\n");
        return 2;
    }
    out = fopen(&argv[0][4], "w");
    if (out == NULL) {
        (void)fprintf(stderr, "count_plugin: %s cannot be written\n", &argv[0][4]);
        return 2;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    qemu_plugin_register_atexit_cb(id, finish, NULL);
    return 0;
}
