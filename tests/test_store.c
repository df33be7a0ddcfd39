/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

/// The store at a memory that is cut off at every step in turn, between two words, within a word and within an erase:
/// what is read back is the old image or the new one, never neither, and the store goes on.

#include "elmopp/store.h"

#include "assert_catcher.h"
#include "image_writer.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define BODY_BYTES 20U
#define IMAGE_BYTES (16U + BODY_BYTES)
#define SLOT_BYTES 56U /* four more than it takes */
#define SECTOR_BYTES 176U
#define MEDIUM_BYTES (3U * SECTOR_BYTES)
#define ORDERS_MAX 4000U

#ifndef SEEDS
#define SEEDS 16U /* of what a cut leaves */
#endif

/* What a cut leaves of the word or sector that it hits. */
typedef enum {
    CUT_BEFORE,      /* as it was */
    CUT_TORN,        /* some bits have changed */
    CUT_ALL_BUT_ONE, /* one bit has not */
    CUT_WEAK,        /* some bits read as they like, anew at each start */
    CUT_AFTER,       /* done, and nobody was told */
    CUT_STYLES
} cut_t;

static const elmopp_image_kind_t kind = {{0x54U, 0x45U, 0x53U, 0x54U}, 7U, BODY_BYTES}; /* "TEST" */

static uint8_t bytes[MEDIUM_BYTES]; /* as they read */
static uint8_t weak[MEDIUM_BYTES];  /* bits that nobody can rely on, */
static uint8_t best[MEDIUM_BYTES];  /* ... and how they read at best */
static elmopp_store_medium_t medium;
static elmopp_store_t store;
static uint8_t image[2][IMAGE_BYTES];
static uint32_t random_state;
static uint32_t erases[3];
static uint32_t orders;

static uint32_t any(void) {
    random_state ^= random_state << 13U;
    random_state ^= random_state >> 17U;
    random_state ^= random_state << 5U;
    return random_state;
}

static void make_image(uint8_t *to, uint8_t content) {
    (void)memset(&to[16], content, BODY_BYTES);
    image_seal(to, "TEST", 7U, BODY_BYTES);
}

static void blank_medium(uint32_t sectors, uint32_t sector_slots, bool erases_any_time) {
    (void)memset(bytes, 0xFF, sizeof bytes);
    (void)memset(weak, 0, sizeof weak);
    (void)memset(best, 0, sizeof best);
    (void)memset(erases, 0, sizeof erases);
    medium = (elmopp_store_medium_t){bytes, sectors, SECTOR_BYTES, sector_slots, SLOT_BYTES, erases_any_time};
    orders = 0U;
}

void setUp(void) {
    random_state = 2463534242U;
    blank_medium(2U, 3U, false);
    make_image(image[0], 1U);
    make_image(image[1], 2U);
}

void tearDown(void) {}

/* --- the memory --- */

static uint32_t word_of(const elmopp_store_order_t *order, uint32_t i) {
    return (order->word >> (8U * i)) & 0xFFU;
}

/* Programming clears bits and sets none, and is not asked to. It makes what was weak strong where it clears. */
static void program(const elmopp_store_order_t *order) {
    for (uint32_t i = 0U; i < 4U; i++) {
        const uint8_t wanted = (uint8_t)word_of(order, i);
        TEST_ASSERT_EQUAL_HEX8_MESSAGE(wanted, bytes[order->at + i] & wanted, "programmed over what is not blank");
        bytes[order->at + i] = (uint8_t)(bytes[order->at + i] & wanted);
        weak[order->at + i] = (uint8_t)(weak[order->at + i] & wanted);
    }
}

static void erase(uint32_t at) {
    (void)memset(&bytes[at], 0xFF, SECTOR_BYTES);
    (void)memset(&weak[at], 0, SECTOR_BYTES);
    erases[at / SECTOR_BYTES]++;
}

static void carry_out(const elmopp_store_order_t *order) {
    orders++;
    if (order->action == ELMOPP_STORE_ERASE) {
        erase(order->at);
    } else {
        program(order);
    }
}

/* The bits that an order would change, changed in part. */
static void cut_within(const elmopp_store_order_t *order, cut_t cut) {
    const bool erasing = order->action == ELMOPP_STORE_ERASE;
    const uint32_t length = erasing ? SECTOR_BYTES : 4U;
    bool spared = false;
    for (uint32_t i = 0U; i < length; i++) {
        uint8_t *cell = &bytes[order->at + i];
        const uint32_t goal = erasing ? 0xFFU : word_of(order, i);
        uint32_t changing = (uint32_t)*cell ^ goal;
        const uint32_t lowest = changing & (~changing + 1U);
        if (cut == CUT_TORN) {
            changing &= any();
        } else if ((cut == CUT_ALL_BUT_ONE) && (!spared)) {
            changing &= ~lowest;
            spared = lowest != 0U;
        } else if (cut == CUT_WEAK) {
            weak[order->at + i] |= (uint8_t)changing;
            best[order->at + i] = (uint8_t)goal;
        } else {
            /* all of them */
        }
        *cell = (uint8_t)(*cell ^ changing);
    }
    if ((cut == CUT_WEAK) && erasing) { /* also what was blank is no longer sure to be */
        (void)memset(&weak[order->at], 0xFF, SECTOR_BYTES);
        (void)memset(&best[order->at], 0xFF, SECTOR_BYTES);
    }
}

/* A start at which weak bits read as if the cut had come later, earlier, or each as it likes. */
typedef enum { WELL, BADLY, ANYHOW } reading_t;

static void settle(reading_t reading) {
    for (uint32_t i = 0U; i < MEDIUM_BYTES; i++) {
        const uint32_t goal = best[i];
        const uint32_t other = (reading == WELL) ? goal : ((reading == BADLY) ? ~goal : any());
        bytes[i] = (uint8_t)((bytes[i] & ~(uint32_t)weak[i]) | (other & weak[i]));
    }
}

static reading_t some_reading(void) {
    return (reading_t)(any() % 3U);
}

/* Carries orders out until nothing is to be done, or until order number `last` is cut. False if it was. */
static bool work(uint32_t last, cut_t cut) {
    elmopp_store_order_t order;
    while (elmopp_store_next(&store, &order)) {
        TEST_ASSERT_TRUE(orders < ORDERS_MAX);
        if (orders == last) {
            if (cut == CUT_AFTER) {
                carry_out(&order);
            } else if (cut != CUT_BEFORE) {
                cut_within(&order, cut);
            } else {
                /* nothing has happened */
            }
            return false;
        }
        carry_out(&order);
        elmopp_store_answer(&store, ELMOPP_STORE_DONE);
    }
    return true;
}

static void work_all(void) {
    TEST_ASSERT_TRUE(work(UINT32_MAX, CUT_BEFORE));
}

static uint32_t content(void) {
    const uint8_t *newest = elmopp_store_newest(&store);
    return (newest == NULL) ? 0U : newest[16];
}

static void power_up(void) {
    elmopp_store_init(&store, &medium, &kind);
}

static bool save(uint8_t value) {
    make_image(image[0], value);
    return elmopp_store_save(&store, image[0]);
}

static void start(void) {
    power_up();
    if (!medium.erases_any_time) {
        elmopp_store_tidy(&store);
        work_all();
    }
}

static void save_surely(uint8_t value) {
    TEST_ASSERT_TRUE(save(value));
    work_all();
    TEST_ASSERT_EQUAL_UINT32(value, content());
}

/* --- without a cut --- */

static void test_an_empty_medium_has_nothing_and_a_missing_one_neither_nor_room(void) {
    start();
    TEST_ASSERT_NULL(elmopp_store_newest(&store));
    TEST_ASSERT_TRUE(elmopp_store_has_room(&store));
    medium.bytes = NULL;
    start();
    TEST_ASSERT_NULL(elmopp_store_newest(&store));
    TEST_ASSERT_FALSE(save(1U));
    elmopp_store_order_t order;
    TEST_ASSERT_FALSE(elmopp_store_next(&store, &order));
}

static void test_what_was_saved_is_there_after_a_reset_byte_for_byte(void) {
    start();
    for (uint8_t value = 1U; value <= 5U; value++) {
        save_surely(value);
        power_up();
        TEST_ASSERT_EQUAL_UINT32(value, content());
        TEST_ASSERT_EQUAL_MEMORY(image[0], elmopp_store_newest(&store), IMAGE_BYTES);
    }
}

static void test_the_old_image_is_in_force_until_the_mark_of_the_new_one_stands(void) {
    start();
    save_surely(1U);
    TEST_ASSERT_TRUE(save(2U));
    elmopp_store_order_t order;
    while (elmopp_store_next(&store, &order)) {
        TEST_ASSERT_EQUAL_UINT32(1U, content());
        carry_out(&order);
        elmopp_store_answer(&store, ELMOPP_STORE_DONE);
        TEST_ASSERT_EQUAL_UINT32((order.action == ELMOPP_STORE_SEAL) ? 2U : 1U, content());
    }
    TEST_ASSERT_EQUAL_UINT16(2U, store.saved);
}

static void test_while_lamps_run_nothing_is_erased_and_after_six_slots_there_is_no_room_until_a_start(void) {
    start();
    (void)memset(erases, 0, sizeof erases);
    for (uint8_t value = 1U; value <= 6U; value++) {
        save_surely(value);
    }
    TEST_ASSERT_FALSE(elmopp_store_has_room(&store));
    TEST_ASSERT_FALSE(save(7U));
    TEST_ASSERT_EQUAL_UINT32(0U, erases[0] + erases[1]);
    start(); /* the newest is in the second sector */
    TEST_ASSERT_EQUAL_UINT32(1U, erases[0]);
    TEST_ASSERT_EQUAL_UINT32(0U, erases[1]);
    TEST_ASSERT_EQUAL_UINT32(6U, content());
    save_surely(7U);
}

static void test_a_start_erases_nothing_that_is_already_blank(void) {
    start();
    save_surely(1U);
    for (uint32_t i = 0U; i < 10U; i++) {
        start();
    }
    TEST_ASSERT_EQUAL_UINT32(1U, erases[0]); /* those of the first start */
    TEST_ASSERT_EQUAL_UINT32(1U, erases[1]);
}

static void test_wear_is_an_erase_for_all_slots_of_a_sector(void) {
    start();
    (void)memset(erases, 0, sizeof erases);
    for (uint32_t i = 0U; i < 300U; i++) {
        start();
        save_surely((uint8_t)(1U + (i % 200U)));
    }
    TEST_ASSERT_UINT32_WITHIN(2U, 50U, erases[0]);
    TEST_ASSERT_UINT32_WITHIN(2U, 50U, erases[1]);
}

static void test_a_medium_that_erases_any_time_always_has_room_and_never_erases_what_is_in_force(void) {
    blank_medium(2U, 1U, true);
    start();
    for (uint32_t i = 0U; i < 50U; i++) {
        const uint32_t before = content();
        TEST_ASSERT_TRUE(save((uint8_t)(1U + i)));
        TEST_ASSERT_EQUAL_UINT32(before, content());
        work_all();
        TEST_ASSERT_EQUAL_UINT32(1U + i, content());
    }
    TEST_ASSERT_EQUAL_UINT16(50U, store.saved);
}

static void test_an_order_that_is_put_off_comes_again_and_one_that_was_not_given_changes_nothing(void) {
    start();
    elmopp_store_answer(&store, ELMOPP_STORE_FAILED);
    TEST_ASSERT_EQUAL_UINT16(0U, store.failed);
    TEST_ASSERT_TRUE(save(3U));
    elmopp_store_order_t first;
    elmopp_store_order_t again;
    TEST_ASSERT_TRUE(elmopp_store_next(&store, &first));
    elmopp_store_answer(&store, ELMOPP_STORE_LATER);
    TEST_ASSERT_TRUE(elmopp_store_next(&store, &again));
    TEST_ASSERT_EQUAL_UINT32(first.at, again.at);
    TEST_ASSERT_FALSE(elmopp_store_save(&store, image[1])); /* one at a time */
    work_all();
    TEST_ASSERT_EQUAL_UINT32(3U, content());
}

static void test_a_medium_without_room_for_the_kind_is_a_bug(void) {
    medium.slot_bytes = IMAGE_BYTES;
    TEST_EXPECT_ASSERT(power_up());
    setUp();
    medium.sectors = 1U;
    TEST_EXPECT_ASSERT(power_up());
    setUp();
    medium.sector_bytes = 3U * SLOT_BYTES; /* no word left */
    TEST_EXPECT_ASSERT(power_up());
}

/* --- what fails --- */

/* Every order of a tidy and of four saves in turn says that it failed, or says that it is done and has done nothing. */
static void test_whatever_order_fails_the_old_image_stays_and_the_next_save_succeeds(void) {
    for (uint32_t lies = 0U; lies < 2U; lies++) {
        bool reached = true;
        for (uint32_t failing = 0U; reached; failing++) {
            setUp();
            start();
            save_surely(1U);
            reached = false;
            uint32_t done = 0U;
            TEST_ASSERT_TRUE(save(2U));
            elmopp_store_order_t order;
            while (elmopp_store_next(&store, &order)) {
                const bool fails = done == failing;
                reached = reached || fails;
                done++;
                if (!fails) {
                    carry_out(&order);
                }
                elmopp_store_answer(&store, (fails && (lies == 0U)) ? ELMOPP_STORE_FAILED : ELMOPP_STORE_DONE);
            }
            TEST_ASSERT_EQUAL_UINT32(reached ? 1U : 2U, content());
            TEST_ASSERT_EQUAL_UINT16(reached ? 1U : 0U, store.failed);
            save_surely(3U);
        }
    }
}

static void test_a_sector_that_cannot_be_erased_is_left_alone_and_the_other_one_used(void) {
    power_up();
    elmopp_store_tidy(&store);
    elmopp_store_answer(&store, ELMOPP_STORE_FAILED);
    work_all();
    TEST_ASSERT_EQUAL_UINT16(1U, store.failed);
    TEST_ASSERT_EQUAL_UINT32(0U, erases[0]);
    save_surely(1U);
    save_surely(2U);
    save_surely(3U);
    TEST_ASSERT_FALSE(elmopp_store_has_room(&store));
}

/* Any bit of the newest slot, of its head and its image. */
static void test_a_flipped_bit_in_the_newest_slot_leaves_the_one_before(void) {
    start();
    save_surely(1U);
    save_surely(2U);
    uint32_t ignored = 0U; /* those of the word that stays blank */
    for (uint32_t bit = 0U; bit < (8U * (16U + IMAGE_BYTES)); bit++) {
        uint8_t *cell = &bytes[SLOT_BYTES + (bit / 8U)];
        *cell ^= (uint8_t)(1U << (bit % 8U));
        power_up();
        const bool old = content() == 1U;
        ignored += old ? 0U : 1U;
        TEST_ASSERT_TRUE(old || (content() == 2U));
        *cell ^= (uint8_t)(1U << (bit % 8U));
    }
    TEST_ASSERT_EQUAL_UINT32(32U, ignored);
}

/* Damage is what was whole once: not an older slot, not one without its mark, and nothing that a cut leaves. */
static void test_a_newest_slot_that_was_whole_and_is_not_is_told_as_damaged(void) {
    start();
    TEST_ASSERT_FALSE(elmopp_store_is_damaged(&store));
    save_surely(1U);
    save_surely(2U);
    bytes[ELMOPP_STORE_HEAD + 20U] ^= 1U; /* the older one */
    power_up();
    TEST_ASSERT_FALSE(elmopp_store_is_damaged(&store));
    bytes[SLOT_BYTES + ELMOPP_STORE_HEAD + 20U] ^= 1U;
    power_up();
    TEST_ASSERT_EQUAL_UINT32(0U, content());
    TEST_ASSERT_TRUE(elmopp_store_is_damaged(&store));
    bytes[ELMOPP_STORE_HEAD + 20U] ^= 1U;
    power_up();
    TEST_ASSERT_EQUAL_UINT32(1U, content());
    TEST_ASSERT_TRUE(elmopp_store_is_damaged(&store));
    save_surely(3U); /* newer than the damage */
    power_up();
    TEST_ASSERT_FALSE(elmopp_store_is_damaged(&store));
    bytes[(2U * SLOT_BYTES) + 8U] ^= 1U; /* without its mark */
    power_up();
    TEST_ASSERT_EQUAL_UINT32(1U, content());
    TEST_ASSERT_TRUE(elmopp_store_is_damaged(&store)); /* slot 2 again */
    medium.bytes = NULL;
    power_up();
    TEST_ASSERT_FALSE(elmopp_store_is_damaged(&store));
}

static void test_rubbish_is_nothing(void) {
    for (uint32_t i = 0U; i < 2000U; i++) {
        for (uint32_t k = 0U; k < MEDIUM_BYTES; k++) {
            bytes[k] = (uint8_t)any();
        }
        power_up();
        TEST_ASSERT_NULL(elmopp_store_newest(&store));
    }
    start();
    save_surely(9U);
}

/* --- the cut --- */

static uint32_t cuts;
static uint32_t outcomes[2]; /* old, new */

/* A life: starts and saves, so that every sector is written, filled and erased. Ends at the cut: what must then be in
   force is `was`, or `will` as well; 0: nothing yet. */
typedef struct {
    uint32_t was;
    uint32_t will;
} expectation_t;

static bool live_until(uint32_t last, cut_t cut, expectation_t *expected) {
    uint8_t value = 0U;
    for (uint32_t run = 0U; run < 4U; run++) {
        power_up();
        *expected = (expectation_t){content(), content()};
        if (!medium.erases_any_time) {
            elmopp_store_tidy(&store);
            if (!work(last, cut)) {
                return false;
            }
        }
        for (uint32_t k = 0U; k < 2U; k++) {
            value++;
            *expected = (expectation_t){content(), value};
            TEST_ASSERT_TRUE(save(value));
            if (!work(last, cut)) {
                return false;
            }
        }
    }
    return true;
}

static void expect_one_of(uint32_t was, uint32_t will, const char *otherwise) {
    power_up();
    const bool old = content() == was;
    TEST_ASSERT_TRUE_MESSAGE(old || (content() == will), otherwise);
    TEST_ASSERT_FALSE_MESSAGE(elmopp_store_is_damaged(&store), "a cut is no damage");
    outcomes[old ? 0U : 1U]++;
}

/* At any number of starts, however weak bits read, it is one of both, also when starts are cut while they tidy. Then
   life goes on, and what is saved then lasts. */
static void expect_old_or_new(const expectation_t *expected, uint32_t seed) {
    for (uint32_t again = 0U; again < 3U; again++) {
        settle((reading_t)again);
        expect_one_of(expected->was, expected->will, "neither");
    }
    for (uint32_t again = 0U; (!medium.erases_any_time) && (again < (seed % 3U)); again++) {
        settle(some_reading());
        power_up();
        elmopp_store_tidy(&store);
        (void)work(orders + (any() % 5U), (cut_t)(any() % (uint32_t)CUT_STYLES));
        settle(some_reading());
        expect_one_of(expected->was, expected->will, "neither, after another cut");
    }
    settle(some_reading());
    start();
    settle(some_reading());
    expect_one_of(expected->was, expected->will, "neither, after a start that was not cut");
    settle(some_reading());
    start();
    save_surely(200U);
    for (uint32_t again = 0U; again < 3U; again++) {
        settle((reading_t)again);
        expect_one_of(200U, 200U, "what was saved after the cut does not last");
    }
}

static void cut_everywhere(uint32_t sectors, uint32_t slots, bool any_time) {
    bool cut_off = true;
    for (uint32_t last = 0U; cut_off; last++) {
        for (uint32_t style = 0U; style < (uint32_t)CUT_STYLES; style++) {
            for (uint32_t seed = 0U; seed < SEEDS; seed++) {
                expectation_t expected;
                random_state = 1U + last + (1000U * seed);
                blank_medium(sectors, slots, any_time);
                cut_off = !live_until(last, (cut_t)style, &expected);
                if (cut_off) {
                    cuts++;
                    expect_old_or_new(&expected, seed);
                }
            }
        }
    }
}

static void test_a_cut_at_every_step_and_within_every_step_leaves_the_old_image_or_the_new_one(void) {
    cuts = 0U;
    outcomes[0] = 0U;
    outcomes[1] = 0U;
    cut_everywhere(2U, 3U, false);
    cut_everywhere(3U, 2U, false);
    cut_everywhere(2U, 1U, true);
    (void)printf("%u cuts; read back: %u times the old image, %u times the new one\n", (unsigned)cuts,
                 (unsigned)outcomes[0], (unsigned)outcomes[1]);
    TEST_ASSERT_TRUE(cuts > (1500U * SEEDS));
    TEST_ASSERT_TRUE(outcomes[1] > (20U * SEEDS));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_an_empty_medium_has_nothing_and_a_missing_one_neither_nor_room);
    RUN_TEST(test_what_was_saved_is_there_after_a_reset_byte_for_byte);
    RUN_TEST(test_the_old_image_is_in_force_until_the_mark_of_the_new_one_stands);
    RUN_TEST(test_while_lamps_run_nothing_is_erased_and_after_six_slots_there_is_no_room_until_a_start);
    RUN_TEST(test_a_start_erases_nothing_that_is_already_blank);
    RUN_TEST(test_wear_is_an_erase_for_all_slots_of_a_sector);
    RUN_TEST(test_a_medium_that_erases_any_time_always_has_room_and_never_erases_what_is_in_force);
    RUN_TEST(test_an_order_that_is_put_off_comes_again_and_one_that_was_not_given_changes_nothing);
    RUN_TEST(test_a_medium_without_room_for_the_kind_is_a_bug);
    RUN_TEST(test_whatever_order_fails_the_old_image_stays_and_the_next_save_succeeds);
    RUN_TEST(test_a_sector_that_cannot_be_erased_is_left_alone_and_the_other_one_used);
    RUN_TEST(test_a_flipped_bit_in_the_newest_slot_leaves_the_one_before);
    RUN_TEST(test_a_newest_slot_that_was_whole_and_is_not_is_told_as_damaged);
    RUN_TEST(test_rubbish_is_nothing);
    RUN_TEST(test_a_cut_at_every_step_and_within_every_step_leaves_the_old_image_or_the_new_one);
    return UNITY_END();
}
