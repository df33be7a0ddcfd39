/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The flash writer at a model of its registers, alone and under the store: the sequences of the manual, every fault at
/// every access, and a loss of power at every access: the old image or the new one.

#include "flash_writer.h"

#include "assert_catcher.h"
#include "elmopp/store.h"
#include "flash_model.h"
#include "image_writer.h"
#include "unity.h"

#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#define BODY_BYTES 24U
#define IMAGE_BYTES (16U + BODY_BYTES)
#define SLOT_BYTES 0xA000U
#define LOOKS 1000U
#define FOREVER UINT32_MAX

#ifndef STRIDE
#define STRIDE 1U
#endif

static elmopp_flash_registers_t registers;
static elmopp_flash_writer_t writer;
static const elmopp_image_kind_t kind = {{0x54U, 0x45U, 0x53U, 0x54U}, 3U, BODY_BYTES};
static elmopp_store_t store;
static uint8_t image[IMAGE_BYTES];
static jmp_buf dark;

void setUp(void) {
    flash_model_reset();
    writer = (elmopp_flash_writer_t){&registers, flash_model_memory, LOOKS};
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(flash_model_complaint(), flash_model_complaint());
}

/* --- the registers --- */

static uint32_t offset_of(const elmopp_register_t *place) {
    return (uint32_t)((uintptr_t)place - (uintptr_t)&registers);
}

uint32_t elmopp_register_read(const elmopp_register_t *place) {
    TEST_ASSERT_TRUE(offset_of(place) < sizeof registers);
    return flash_model_read(offset_of(place));
}

void elmopp_register_write(elmopp_register_t *place, uint32_t value) {
    if (offset_of(place) < sizeof registers) {
        flash_model_write(offset_of(place), value);
    } else {
        flash_model_program((uint32_t)((uintptr_t)place - (uintptr_t)flash_model_memory), value);
    }
}

void flash_model_power_lost(void) {
    longjmp(dark, 1);
}

/* --- alone --- */

static void test_a_word_is_programmed_and_the_flash_locked_again(void) {
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_WELL, elmopp_flash_writer_program(&writer, 8U, 0x12345678U));
    TEST_ASSERT_EQUAL_HEX32(0x12345678U, flash_model_memory[2]);
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFU, flash_model_memory[1]);
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFU, flash_model_memory[3]);
    TEST_ASSERT_TRUE(flash_model_is_locked());
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_WELL, elmopp_flash_writer_program(&writer, FLASH_MODEL_BYTES - 4U, 0U));
    TEST_ASSERT_EQUAL_HEX32(0U, flash_model_memory[(FLASH_MODEL_BYTES / 4U) - 1U]);
}

static void test_a_sector_is_erased_as_a_whole_and_no_other_and_the_caches_forget_it(void) {
    flash_model_fill(0U);
    flash_model_write(0U, 0x705U); /* caches and prefetch on, five wait states */
    for (uint32_t sector = 0U; sector < 4U; sector++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_WELL,
                              elmopp_flash_writer_erase(&writer, sector * FLASH_MODEL_SECTOR_BYTES));
        for (uint32_t k = 0U; k < 4U; k++) {
            const volatile uint32_t *words = &flash_model_memory[k * (FLASH_MODEL_SECTOR_BYTES / 4U)];
            TEST_ASSERT_EQUAL_HEX32((k <= sector) ? UINT32_MAX : 0U, words[0]);
            TEST_ASSERT_EQUAL_HEX32((k <= sector) ? UINT32_MAX : 0U, words[(FLASH_MODEL_SECTOR_BYTES / 4U) - 1U]);
        }
    }
    TEST_ASSERT_EQUAL_HEX32(0x705U, flash_model_read(0U)); /* as before */
    TEST_ASSERT_EQUAL_UINT32(4U, flash_model_erases());
    TEST_ASSERT_TRUE(flash_model_is_locked());
}

static void test_a_place_that_is_none_touches_no_register(void) {
    static const uint32_t places[] = {FLASH_MODEL_BYTES, FLASH_MODEL_BYTES + FLASH_MODEL_SECTOR_BYTES, UINT32_MAX,
                                      0x80000000U};
    for (uint32_t i = 0U; i < (sizeof places / sizeof places[0]); i++) {
        TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_PLACE, elmopp_flash_writer_erase(&writer, places[i]));
        TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_PLACE, elmopp_flash_writer_program(&writer, places[i], 0U));
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_PLACE, elmopp_flash_writer_erase(&writer, 4U));
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_PLACE, elmopp_flash_writer_program(&writer, 2U, 0U));
    TEST_ASSERT_EQUAL_UINT32(0U, flash_model_accesses());
}

static void test_each_trouble_is_named_and_waited_for_so_long_and_no_longer(void) {
    flash_model_break(FLASH_FAULT_LOCKED, 0U, FOREVER);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_LOCKED, elmopp_flash_writer_program(&writer, 0U, 0U));
    flash_model_break(FLASH_FAULT_ERROR, 0U, FOREVER);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_ERROR, elmopp_flash_writer_program(&writer, 0U, 0U));
    TEST_ASSERT_TRUE(flash_model_is_locked());
    flash_model_break(FLASH_FAULT_NONE, 0U, 0U); /* the error of before is cleared */
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_WELL, elmopp_flash_writer_program(&writer, 0U, 0U));
    const uint32_t before = flash_model_accesses();
    flash_model_break(FLASH_FAULT_BUSY, 0U, FOREVER);
    TEST_ASSERT_EQUAL_INT(ELMOPP_FLASH_WRITER_BUSY, elmopp_flash_writer_erase(&writer, 0U));
    TEST_ASSERT_TRUE((flash_model_accesses() - before) <= (ELMOPP_FLASH_WRITER_WORD_LOOKS + 20U));
    TEST_ASSERT_EQUAL_STRING("it does not come to its end", elmopp_flash_writer_trouble_name(ELMOPP_FLASH_WRITER_BUSY));
    TEST_ASSERT_EQUAL_STRING("unknown", elmopp_flash_writer_trouble_name((elmopp_flash_writer_trouble_t)77));
}

/* --- under the store --- */

static const elmopp_store_medium_t medium = {
    (const uint8_t *)(uintptr_t)flash_model_memory, 2U, FLASH_MODEL_SECTOR_BYTES, 3U, SLOT_BYTES, false};

static void work(void) {
    elmopp_store_order_t order;
    for (uint32_t k = 0U; (k < 200U) && elmopp_store_next(&store, &order); k++) {
        const elmopp_flash_writer_trouble_t trouble = (order.action == ELMOPP_STORE_ERASE)
                                                          ? elmopp_flash_writer_erase(&writer, order.at)
                                                          : elmopp_flash_writer_program(&writer, order.at, order.word);
        elmopp_store_answer(&store, (trouble == ELMOPP_FLASH_WRITER_WELL) ? ELMOPP_STORE_DONE : ELMOPP_STORE_FAILED);
    }
    TEST_ASSERT_EQUAL_INT(ELMOPP_STORE_IDLE, store.phase);
}

static void start(void) {
    elmopp_store_init(&store, &medium, &kind);
    elmopp_store_tidy(&store);
    work();
}

static bool save(uint8_t value) {
    (void)memset(&image[16], value, BODY_BYTES);
    image_seal(image, "TEST", 3U, BODY_BYTES);
    const uint16_t before = store.saved;
    const bool begun = elmopp_store_save(&store, image);
    work();
    return begun && (store.saved != before);
}

static uint32_t content(void) {
    elmopp_store_init(&store, &medium, &kind);
    const uint8_t *newest = elmopp_store_newest(&store);
    return (newest == NULL) ? 0U : newest[16];
}

/* A life in which every kind of order occurs, from a sector full of rubbish on: what was kept at its end. */
static uint32_t kept;
static uint32_t unsure; /* what was being saved last and, it is said, was not; 0: none */

static void live(void) {
    kept = 0U;
    unsure = 0U;
    for (uint32_t run = 0U; run < 2U; run++) {
        start();
        kept = content();
        elmopp_store_init(&store, &medium, &kind);
        for (uint32_t k = 1U; k <= 2U; k++) {
            const uint32_t value = (2U * run) + k;
            const bool saved = save((uint8_t)value);
            kept = saved ? value : kept;
            unsure = saved ? 0U : value;
        }
    }
}

static void rubbish_first(void) {
    flash_model_reset();
    for (uint32_t k = 0U; k < 100U; k++) {
        flash_model_memory[k * 7U] = k;
    }
}

/* Whatever fails, and for however long: what the store says is kept is there, and afterwards it goes on. */
static void expect_recovery(flash_fault_t fault, uint32_t from, uint32_t to) {
    rubbish_first();
    flash_model_break(fault, from, to);
    live();
    flash_model_break(FLASH_FAULT_NONE, 0U, 0U);
    flash_model_restart();
    const uint32_t found = content();
    TEST_ASSERT_TRUE_MESSAGE((found == kept) || ((unsure != 0U) && (found == unsure)),
                             "what was said to be kept is not there");
    start();
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(found, content(), "lost by a start");
    TEST_ASSERT_TRUE_MESSAGE(save(100U), "it does not go on");
    TEST_ASSERT_EQUAL_UINT32(100U, content());
}

static void test_every_fault_at_every_access_for_a_while_and_for_ever_loses_nothing_that_was_kept(void) {
    rubbish_first();
    live();
    TEST_ASSERT_EQUAL_UINT32(4U, kept);
    const uint32_t accesses = flash_model_accesses();
    (void)printf("%u accesses to registers, %u erases\n", (unsigned)accesses, (unsigned)flash_model_erases());
    for (uint32_t from = 0U; from < accesses; from += STRIDE) {
        for (uint32_t fault = FLASH_FAULT_DEAD; fault < (uint32_t)FLASH_FAULT_POWER; fault++) {
            expect_recovery((flash_fault_t)fault, from, from + 9U);
        }
    }
    for (uint32_t fault = FLASH_FAULT_DEAD; fault < (uint32_t)FLASH_FAULT_POWER; fault++) {
        expect_recovery((flash_fault_t)fault, accesses / 2U, FOREVER);
    }
}

static void test_a_loss_of_power_at_every_access_leaves_the_old_image_or_the_new_one(void) {
    rubbish_first();
    live();
    const uint32_t accesses = flash_model_accesses();
    for (uint32_t from = 1U; from <= accesses; from += STRIDE) {
        rubbish_first();
        flash_model_break(FLASH_FAULT_POWER, from, FOREVER);
        if (setjmp(dark) == 0) {
            live();
            TEST_FAIL_MESSAGE("the power has not gone");
        }
        flash_model_break(FLASH_FAULT_NONE, 0U, 0U);
        flash_model_restart();
        const uint32_t found = content();
        TEST_ASSERT_TRUE_MESSAGE((found == kept) || (found == (kept + 1U)), "neither");
        start();
        TEST_ASSERT_EQUAL_UINT32(found, content());
        TEST_ASSERT_TRUE(save(100U));
        TEST_ASSERT_EQUAL_UINT32(100U, content());
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_word_is_programmed_and_the_flash_locked_again);
    RUN_TEST(test_a_sector_is_erased_as_a_whole_and_no_other_and_the_caches_forget_it);
    RUN_TEST(test_a_place_that_is_none_touches_no_register);
    RUN_TEST(test_each_trouble_is_named_and_waited_for_so_long_and_no_longer);
    RUN_TEST(test_every_fault_at_every_access_for_a_while_and_for_ever_loses_nothing_that_was_kept);
    RUN_TEST(test_a_loss_of_power_at_every_access_leaves_the_old_image_or_the_new_one);
    return UNITY_END();
}
