/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "slcan.h"

#define GOOD '\r'
#define BAD '\a'
#define HEX 16U
#define NO_DIGIT 0xFFU
#define ID_DIGITS 3U
#define LONG_ID_DIGITS 8U
#define ID_MAX 0x7FFU
#define LONG_ID_MAX 0x1FFFFFFFU
#define STAMP_DIGITS 4U
#define STAMP_RANGE_MS 60000U
#define ALL_CODES 0x00000000U
#define ALL_MASKS 0xFFFFFFFFU
#define BUS_BTR 0x001CU /* 500 kbit/s of an SJA1000 with 16 MHz */

/* --- characters --- */

static uint32_t digit_of(char character) {
    uint32_t digit = NO_DIGIT;
    if ((character >= '0') && (character <= '9')) {
        digit = (uint32_t)character - (uint32_t)'0';
    } else if ((character >= 'A') && (character <= 'F')) {
        digit = 10U + (uint32_t)character - (uint32_t)'A';
    } else if ((character >= 'a') && (character <= 'f')) {
        digit = 10U + (uint32_t)character - (uint32_t)'a';
    } else {
        /* none */
    }
    return digit;
}

static bool read_hex(const char *text, uint32_t digits, uint32_t *value) {
    uint32_t sum = 0U;
    for (uint32_t k = 0U; k < digits; k++) {
        const uint32_t digit = digit_of(text[k]);
        if (digit == NO_DIGIT) {
            return false;
        }
        sum = (sum * HEX) + digit;
    }
    *value = sum;
    return true;
}

static uint32_t write_hex(char *text, uint32_t digits, uint32_t value) {
    uint32_t left = value;
    for (uint32_t k = digits; k > 0U; k--) {
        text[k - 1U] = "0123456789ABCDEF"[left % HEX];
        left /= HEX;
    }
    return digits;
}

/* --- frames --- */

uint32_t elmopp_slcan_write(const elmopp_frame_t *frame, char text[ELMOPP_SLCAN_TEXT_MAX]) {
    uint32_t length = 1U;
    text[0] = 't';
    length += write_hex(&text[length], ID_DIGITS, frame->id);
    length += write_hex(&text[length], 1U, frame->length);
    for (uint32_t k = 0U; (k < frame->length) && (k < ELMOPP_LINK_BYTES); k++) {
        length += write_hex(&text[length], 2U, frame->data[k]);
    }
    return length;
}

/* A frame of any of the four kinds; it is for us if it has data and 11 bits. */
static bool read_any(const char *line, uint32_t length, elmopp_frame_t *frame, bool *for_us) {
    const bool is_long = (line[0] == 'T') || (line[0] == 'R');
    const bool is_remote = (line[0] == 'r') || (line[0] == 'R');
    const uint32_t digits = is_long ? LONG_ID_DIGITS : ID_DIGITS;
    const uint32_t head = 1U + digits + 1U;
    uint32_t id = 0U;
    uint32_t bytes = 0U;
    if ((length < head) || (!read_hex(&line[1], digits, &id)) || (!read_hex(&line[1U + digits], 1U, &bytes)) ||
        (bytes > ELMOPP_LINK_BYTES) || (id > (is_long ? LONG_ID_MAX : ID_MAX))) {
        return false;
    }
    const uint32_t data_digits = is_remote ? 0U : (2U * bytes);
    if ((length != (head + data_digits)) && (length != (head + data_digits + STAMP_DIGITS))) {
        return false;
    }
    elmopp_frame_t read = {.id = (uint16_t)(id & ID_MAX), .length = (uint8_t)bytes, .data = {0U}};
    for (uint32_t k = 0U; k < (data_digits / 2U); k++) {
        uint32_t value = 0U;
        if (!read_hex(&line[head + (2U * k)], 2U, &value)) {
            return false;
        }
        read.data[k] = (uint8_t)value;
    }
    *frame = read;
    *for_us = (!is_long) && (!is_remote);
    return true;
}

bool elmopp_slcan_read(const char *line, uint32_t length, elmopp_frame_t *frame) {
    elmopp_frame_t read;
    bool for_us = false;
    if ((length == 0U) || (line[0] != 't') || (!read_any(line, length, &read, &for_us))) {
        return false;
    }
    *frame = read;
    return for_us;
}

uint32_t elmopp_slcan_say(const elmopp_slcan_t *self, const elmopp_frame_t *frame, uint32_t now_ms,
                          char text[ELMOPP_SLCAN_TEXT_MAX]) {
    if (!self->open) {
        return 0U;
    }
    uint32_t length = elmopp_slcan_write(frame, text);
    if (self->stamps) {
        length += write_hex(&text[length], STAMP_DIGITS, now_ms % STAMP_RANGE_MS);
    }
    text[length] = GOOD;
    return length + 1U;
}

/* --- commands --- */

static void put(elmopp_slcan_event_t *event, char character) {
    event->answer[event->answer_length] = character;
    event->answer_length++;
}

static void put_text(elmopp_slcan_event_t *event, const char *text) {
    for (uint32_t k = 0U; text[k] != '\0'; k++) {
        put(event, text[k]);
    }
}

/* How a command ended. */
typedef enum {
    OBEYED,
    NOT_NOW, /* it is one of ours, but the channel is open, or shut */
    NO_COMMAND
} outcome_t;

static outcome_t if_now(bool now) {
    return now ? OBEYED : NOT_NOW;
}

static outcome_t obey_open(elmopp_slcan_t *self, bool listens) {
    const bool now = (!self->open) && self->rate_is_good;
    if (now) {
        self->open = true;
        self->listens = listens;
    }
    return if_now(now);
}

static outcome_t obey_close(elmopp_slcan_t *self) {
    const bool now = self->open;
    self->open = false;
    return if_now(now);
}

/* After a rate that the bus does not have the channel stays shut until a good one is named. */
static outcome_t obey_rate(elmopp_slcan_t *self, uint32_t digits, uint32_t right) {
    uint32_t value = 0U;
    if ((self->length != (1U + digits)) || (!read_hex(&self->line[1], digits, &value))) {
        return NO_COMMAND;
    }
    if (self->open) {
        return NOT_NOW;
    }
    self->rate_is_good = value == right;
    return if_now(self->rate_is_good);
}

static outcome_t obey_filter(const elmopp_slcan_t *self, uint32_t all) {
    uint32_t value = 0U;
    if ((self->length != (1U + LONG_ID_DIGITS)) || (!read_hex(&self->line[1], LONG_ID_DIGITS, &value))) {
        return NO_COMMAND;
    }
    return if_now((!self->open) && (value == all));
}

static outcome_t obey_stamps(elmopp_slcan_t *self) {
    const bool known = (self->length == 2U) && ((self->line[1] == '0') || (self->line[1] == '1'));
    if (known && (!self->open)) {
        self->stamps = self->line[1] == '1';
    }
    return known ? if_now(!self->open) : NO_COMMAND;
}

static outcome_t obey_flags(elmopp_slcan_t *self, elmopp_slcan_event_t *event) {
    if (!self->open) {
        return NOT_NOW;
    }
    put(event, 'F');
    event->answer_length = (uint8_t)(1U + write_hex(&event->answer[1], 2U, self->flags));
    self->flags = 0U;
    return OBEYED;
}

static outcome_t obey_frame(const elmopp_slcan_t *self, elmopp_slcan_event_t *event) {
    bool for_us = false;
    if (!read_any(self->line, self->length, &event->frame, &for_us)) {
        return NO_COMMAND;
    }
    const bool now = self->open && (!self->listens);
    event->has_frame = now && for_us;
    if (now) {
        put(event, ((self->line[0] == 'T') || (self->line[0] == 'R')) ? 'Z' : 'z');
    }
    return if_now(now);
}

/* Commands of one letter. */
static outcome_t obey_letter(elmopp_slcan_t *self, elmopp_slcan_event_t *event) {
    outcome_t outcome = NO_COMMAND;
    switch (self->line[0]) {
    case 'O':
    case 'L':
        outcome = obey_open(self, self->line[0] == 'L');
        break;
    case 'C':
        outcome = obey_close(self);
        break;
    case 'F':
        outcome = obey_flags(self, event);
        break;
    case 'V':
        put_text(event, "V1013");
        outcome = OBEYED;
        break;
    case 'N':
        put_text(event, "NE386");
        outcome = OBEYED;
        break;
    default:
        outcome = NO_COMMAND;
        break;
    }
    return outcome;
}

/* Commands with something behind the letter. */
static outcome_t obey_longer(elmopp_slcan_t *self, elmopp_slcan_event_t *event) {
    outcome_t outcome = NO_COMMAND;
    switch (self->line[0]) {
    case 't':
    case 'T':
    case 'r':
    case 'R':
        outcome = obey_frame(self, event);
        break;
    case 'S':
        outcome = obey_rate(self, 1U, 6U);
        break;
    case 's':
        outcome = obey_rate(self, 4U, BUS_BTR);
        break;
    case 'M':
        outcome = obey_filter(self, ALL_CODES);
        break;
    case 'm':
        outcome = obey_filter(self, ALL_MASKS);
        break;
    case 'Z':
        outcome = obey_stamps(self);
        break;
    case 'X':
        outcome = ((self->length == 2U) && (self->line[1] == '1')) ? OBEYED : NO_COMMAND;
        break;
    default:
        outcome = NO_COMMAND;
        break;
    }
    return outcome;
}

static void end_line(elmopp_slcan_t *self, elmopp_slcan_event_t *event) {
    outcome_t outcome = NO_COMMAND;
    if (!self->overlong) {
        outcome = (self->length == 1U) ? obey_letter(self, event) : obey_longer(self, event);
    }
    if (outcome == NO_COMMAND) {
        self->dropped++;
    }
    put(event, (outcome == OBEYED) ? GOOD : BAD);
    self->length = 0U;
    self->overlong = false;
}

/* --- the room --- */

void elmopp_slcan_init(elmopp_slcan_t *self) {
    *self = (elmopp_slcan_t){.length = 0U, .rate_is_good = true};
}

void elmopp_slcan_flag(elmopp_slcan_t *self, uint8_t flag) {
    self->flags = (uint8_t)(self->flags | flag);
}

/* Lines that are empty, and line feeds between them, are what people and programs send to begin with a new line. */
void elmopp_slcan_take(elmopp_slcan_t *self, char character, elmopp_slcan_event_t *event) {
    event->has_frame = false;
    event->answer_length = 0U;
    const bool begins = (self->length == 0U) && (!self->overlong);
    if (begins && ((character == GOOD) || (character == '\n'))) {
        return;
    }
    if (character == GOOD) {
        end_line(self, event);
    } else if (self->length < ELMOPP_SLCAN_LINE_MAX) {
        self->line[self->length] = character;
        self->length++;
    } else {
        self->overlong = true;
    }
}
