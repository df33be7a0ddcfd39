/* SPDX-License-Identifier: Apache-2.0
 * Copyright 2026 The ELMOPP authors */

#include "bxcan_model.h"

#include "unity.h"

#include <string.h>

#define MCR_AFTER_RESET 0x00010002U
#define FMR_AFTER_RESET 0x2A1C0E01U
#define BTR_AFTER_RESET 0x01230000U
#define STAGES 3U
#define IDLE_BITS 11U  /* before a frame: what ends one, and the pause between frames */
#define SEQUENCES 128U /* of 11 recessive bits, to return from bus-off */
#define FRAME_BITS 47U /* and 8 a byte */
#define ERROR_FRAME_BITS 20U
#define NOBODY 0xFFU    /* no mailbox */
#define FLOOD_ID 0x080U /* LampCommand of another controller: nothing goes before it */

typedef struct {
    uint32_t word[4]; /* id, length, low, high */
    bool pending;
    bool aborting;
    uint32_t status; /* RQCP, TXOK, ALST, TERR as of mailbox 0 */
} mailbox_t;

typedef struct {
    elmopp_frame_t frame[BXCAN_MODEL_LOG];
    uint32_t first;
    uint32_t count;
} frames_t;

static struct {
    uint32_t mcr;
    uint32_t btr;
    uint32_t ier;
    uint32_t filter[8]; /* fmr, fm1r, -, fs1r, -, ffa1r, -, fa1r */
    uint32_t bank[ELMOPP_BXCAN_BANKS][2];
    bool initialising; /* INAK */
    bool asleep;       /* SLAK */
    bool off;          /* BOFF */
    bool returning;    /* counts sequences */
    uint32_t sequences;
    uint32_t transmit_errors;
    uint32_t receive_errors;
    mailbox_t mailbox[ELMOPP_BXCAN_MAILBOXES];
    mailbox_t stage[STAGES]; /* of the FIFO */
    uint32_t stages;
    bool overrun;
    bool release_hangs;
    uint32_t recessive; /* bits in a row */
    uint32_t wire_bits; /* left of the frame on the wire */
    uint32_t sender;    /* mailbox, or NOBODY of ours */
    elmopp_frame_t foreign;
    frames_t waiting; /* at other nodes */
    frames_t sent;
    uint32_t accesses;
    uint32_t violations;
    uint32_t faults;
    uint32_t from_access;
    uint32_t until_access;
} model;

void bxcan_model_reset(void) {
    memset(&model, 0, sizeof model);
    model.mcr = MCR_AFTER_RESET;
    model.btr = BTR_AFTER_RESET;
    model.filter[0] = FMR_AFTER_RESET;
    model.asleep = true;
    model.sender = NOBODY;
}

void bxcan_model_break(uint32_t faults, uint32_t from_access, uint32_t until_access) {
    model.faults = faults;
    model.from_access = from_access;
    model.until_access = until_access;
}

static bool suffers(bxcan_fault_t fault) {
    const bool now = (model.accesses >= model.from_access) && (model.accesses < model.until_access);
    return now && ((model.faults & (uint32_t)fault) != 0U);
}

uint32_t bxcan_model_accesses(void) {
    return model.accesses;
}

uint32_t bxcan_model_violations(void) {
    return model.violations;
}

uint32_t bxcan_model_transmit_errors(void) {
    return model.transmit_errors;
}

void bxcan_model_set_transmit_errors(uint32_t count) {
    model.transmit_errors = count;
    if (model.transmit_errors > 255U) {
        model.off = true;
        model.returning = false;
        model.sequences = 0U;
    }
}

/* What there is no room for is forgotten: a bus that is stuck, or a mailbox that never empties. */
static void append(frames_t *frames, const elmopp_frame_t *frame) {
    if (frames->count < BXCAN_MODEL_LOG) {
        frames->frame[(frames->first + frames->count) % BXCAN_MODEL_LOG] = *frame;
        frames->count++;
    }
}

void bxcan_model_hear(const elmopp_frame_t *frame) {
    append(&model.waiting, frame);
}

uint32_t bxcan_model_sent(void) {
    return model.sent.count;
}

elmopp_frame_t bxcan_model_sent_frame(uint32_t index) {
    TEST_ASSERT_LESS_THAN_UINT32(model.sent.count, index);
    return model.sent.frame[(model.sent.first + index) % BXCAN_MODEL_LOG];
}

bool bxcan_model_take_sent(elmopp_frame_t *frame) {
    const bool there = model.sent.count > 0U;
    if (there) {
        *frame = model.sent.frame[model.sent.first];
        model.sent.first = (model.sent.first + 1U) % BXCAN_MODEL_LOG;
        model.sent.count--;
    }
    return there;
}

static bool takes_part(void) {
    return (!model.initialising) && (!model.asleep) && (!model.off);
}

/* --- the FIFO and its filters --- */

static bool passes(uint16_t id) {
    const uint32_t wanted = (uint32_t)id << 5U;
    bool found = false;
    for (uint32_t b = 0U; b < 14U; b++) {
        const bool works = ((model.filter[7] >> b) & 1U) != 0U;
        const bool lists = ((model.filter[1] >> b) & 1U) != 0U;
        const bool narrow = ((model.filter[3] >> b) & 1U) == 0U;
        for (uint32_t k = 0U; works && lists && narrow && (k < 4U); k++) {
            found = found || (((model.bank[b][k / 2U] >> (16U * (k % 2U))) & 0xFFFFU) == wanted);
        }
    }
    return found && ((model.filter[0] & 1U) == 0U);
}

static void keep(const elmopp_frame_t *frame) {
    if (!passes(frame->id)) {
        return;
    }
    if (model.stages == STAGES) {
        model.overrun = true; /* RFLM 0: the last one is replaced */
        model.stages = STAGES - 1U;
    }
    mailbox_t *stage = &model.stage[model.stages];
    stage->word[0] = (uint32_t)frame->id << 21U;
    stage->word[1] = frame->length;
    memcpy(&stage->word[2], frame->data, sizeof frame->data); /* both are little-endian here */
    model.stages++;
}

static void release_stage(void) {
    if (model.stages > 0U) {
        memmove(&model.stage[0], &model.stage[1], sizeof model.stage - sizeof model.stage[0]);
        model.stages--;
    }
}

bool bxcan_model_interrupt(void) {
    return (!suffers(BXCAN_FAULT_NO_INTERRUPT)) && (!suffers(BXCAN_FAULT_DEAD)) &&
           ((model.ier & ELMOPP_BIT(1U)) != 0U) && (model.stages > 0U);
}

/* --- mailboxes --- */

static uint32_t id_of(const mailbox_t *mailbox) {
    return mailbox->word[0] >> 21U;
}

static uint32_t next_mailbox(void) {
    uint32_t best = NOBODY;
    for (uint32_t m = 0U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        if (model.mailbox[m].pending &&
            ((best == NOBODY) || (id_of(&model.mailbox[m]) < id_of(&model.mailbox[best])))) {
            best = m;
        }
    }
    return takes_part() ? best : NOBODY;
}

static void empty(mailbox_t *mailbox, uint32_t status) {
    if (!suffers(BXCAN_FAULT_MAILBOX)) {
        mailbox->pending = false;
        mailbox->aborting = false;
        mailbox->status = ELMOPP_BIT(0U) | status;
    }
}

static elmopp_frame_t frame_of(const mailbox_t *mailbox) {
    elmopp_frame_t frame = {.id = (uint16_t)id_of(mailbox), .length = (uint8_t)(mailbox->word[1] & 15U)};
    memcpy(frame.data, &mailbox->word[2], sizeof frame.data);
    return frame;
}

/* --- the bus --- */

static void end_own_frame(mailbox_t *mailbox) {
    const bool alone = suffers(BXCAN_FAULT_ALONE);
    if (suffers(BXCAN_FAULT_DESTROYED) || alone) {
        if ((!alone) || (model.transmit_errors <= 127U)) { /* error-passive, a missing acknowledge does not count */
            bxcan_model_set_transmit_errors(model.transmit_errors + 8U);
        }
        mailbox->status |= ELMOPP_BIT(3U);
        if (mailbox->aborting) {
            empty(mailbox, ELMOPP_BIT(3U));
        }
    } else {
        const elmopp_frame_t frame = frame_of(mailbox);
        append(&model.sent, &frame);
        model.transmit_errors -= (model.transmit_errors > 0U) ? 1U : 0U;
        empty(mailbox, ELMOPP_BIT(1U));
    }
}

static void end_foreign_frame(void) {
    if (!takes_part()) {
        return;
    }
    if (suffers(BXCAN_FAULT_SPOILT)) {
        model.receive_errors += (model.receive_errors < 255U) ? 1U : 0U;
    } else {
        model.receive_errors -= (model.receive_errors > 0U) ? 1U : 0U;
        keep(&model.foreign);
    }
}

static void count_sequence(void) {
    if (model.off && model.returning && (!suffers(BXCAN_FAULT_NO_LEAVE))) {
        model.sequences++;
        if (model.sequences >= SEQUENCES) {
            model.off = false;
            model.returning = false;
            model.transmit_errors = 0U;
            model.receive_errors = 0U;
        }
    }
}

/* Modes change between frames. */
static void change_mode(void) {
    const bool busy = (model.wire_bits > 0U) && (model.sender != NOBODY);
    const bool asked = (model.mcr & ELMOPP_BIT(0U)) != 0U;
    if (suffers(BXCAN_FAULT_FALLS_ASLEEP)) {
        model.asleep = true;
        model.mcr |= ELMOPP_BIT(1U);
    } else if (asked && (!model.initialising) && (!busy) && (!suffers(BXCAN_FAULT_NO_INIT))) {
        model.initialising = true;
        model.asleep = false;
        model.recessive = 0U;
    } else if ((!asked) && model.initialising && (model.recessive >= IDLE_BITS) && (!suffers(BXCAN_FAULT_NO_LEAVE))) {
        model.initialising = false;
        model.returning = model.off;
    } else {
        model.asleep = ((model.mcr & ELMOPP_BIT(1U)) != 0U) && (!model.initialising);
    }
}

static void end_frame(void) {
    if (model.sender != NOBODY) {
        end_own_frame(&model.mailbox[model.sender]);
    } else {
        end_foreign_frame();
    }
    model.sender = NOBODY;
    model.recessive = IDLE_BITS;
    count_sequence();
}

static void start_frame(void) {
    const uint32_t mailbox = next_mailbox();
    const elmopp_frame_t flood = {.id = FLOOD_ID, .length = 0U};
    const bool flooded = suffers(BXCAN_FAULT_FLOOD);
    const bool foreign = flooded || (model.waiting.count > 0U);
    const elmopp_frame_t *other = flooded ? &flood : &model.waiting.frame[model.waiting.first];
    if (foreign && ((mailbox == NOBODY) || (other->id <= id_of(&model.mailbox[mailbox])))) {
        if (mailbox != NOBODY) {
            model.mailbox[mailbox].status |= ELMOPP_BIT(2U);
        }
        model.foreign = *other;
        if (!flooded) {
            model.waiting.first = (model.waiting.first + 1U) % BXCAN_MODEL_LOG;
            model.waiting.count--;
        }
        model.wire_bits = FRAME_BITS + (8U * model.foreign.length);
    } else if (mailbox != NOBODY) {
        model.sender = mailbox;
        model.wire_bits = FRAME_BITS + (8U * (model.mailbox[mailbox].word[1] & 15U));
        model.wire_bits += suffers(BXCAN_FAULT_DESTROYED) ? ERROR_FRAME_BITS : 0U;
    } else {
        /* nobody has anything to say */
    }
    model.recessive = (model.wire_bits > 0U) ? 0U : model.recessive;
}

static uint32_t least(uint32_t a, uint32_t b) {
    return (a < b) ? a : b;
}

/* Lets at most so many bits pass, up to the next thing that happens; returns how many. */
static uint32_t pass_some(uint32_t bits) {
    uint32_t passed = bits;
    change_mode();
    if (suffers(BXCAN_FAULT_DOMINANT)) {
        model.recessive = 0U;
        model.wire_bits = 0U;
        model.sender = NOBODY;
        return bits;
    }
    if ((model.wire_bits == 0U) && (model.recessive >= IDLE_BITS)) {
        start_frame();
    }
    if (model.wire_bits > 0U) {
        passed = least(bits, model.wire_bits);
        model.wire_bits -= passed;
        if (model.wire_bits == 0U) {
            end_frame();
        }
    } else if (takes_part() && (model.recessive >= IDLE_BITS)) {
        passed = bits; /* nothing happens before somebody has something to send */
    } else {
        passed = least(bits, IDLE_BITS - (model.recessive % IDLE_BITS));
        model.recessive += passed;
        if ((model.recessive % IDLE_BITS) == 0U) {
            count_sequence();
            model.recessive = IDLE_BITS;
        }
    }
    change_mode();
    return passed;
}

void bxcan_model_pass_bits(uint32_t bits) {
    for (uint32_t left = bits; left > 0U;) {
        left -= pass_some(left);
    }
}

/* --- registers: what is read --- */

static uint32_t tsr(void) {
    uint32_t word = 0U;
    for (uint32_t m = 0U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        const mailbox_t *mailbox = &model.mailbox[m];
        word |= mailbox->status << (8U * m);
        word |= mailbox->aborting ? (ELMOPP_BIT(7U) << (8U * m)) : 0U;
        word |= mailbox->pending ? 0U : (ELMOPP_BIT(26U) << m);
    }
    return word;
}

static uint32_t rf0r(void) {
    return model.stages | ((model.stages == STAGES) ? ELMOPP_BIT(3U) : 0U) | (model.overrun ? ELMOPP_BIT(4U) : 0U) |
           (model.release_hangs ? ELMOPP_BIT(5U) : 0U);
}

static uint32_t esr(void) {
    const uint32_t transmit = model.transmit_errors;
    const uint32_t receive = model.receive_errors;
    const bool warns = (transmit >= 96U) || (receive >= 96U);
    const bool passive = (transmit > 127U) || (receive > 127U);
    return (warns ? ELMOPP_BIT(0U) : 0U) | (passive ? ELMOPP_BIT(1U) : 0U) | (model.off ? ELMOPP_BIT(2U) : 0U) |
           ((transmit & 0xFFU) << 16U) | (receive << 24U);
}

static uint32_t read_low(uint32_t offset) {
    switch (offset) {
    case 0x00U:
        return model.mcr | (suffers(BXCAN_FAULT_NO_RESET) ? ELMOPP_BIT(15U) : 0U);
    case 0x04U:
        return 0xC00U | (model.initialising ? 1U : 0U) | (model.asleep ? 2U : 0U);
    case 0x08U:
        return tsr();
    case 0x0CU:
        return rf0r();
    case 0x14U:
        return model.ier;
    case 0x18U:
        return esr();
    case 0x1CU:
        return suffers(BXCAN_FAULT_NO_TIMING) ? BTR_AFTER_RESET : model.btr;
    default:
        return 0U;
    }
}

uint32_t bxcan_model_read(uint32_t offset) {
    model.accesses++;
    if (suffers(BXCAN_FAULT_DEAD)) {
        return 0U;
    }
    if (suffers(BXCAN_FAULT_ONES)) {
        return UINT32_MAX;
    }
    if (offset < 0x180U) {
        return read_low(offset);
    }
    if ((offset >= 0x1B0U) && (offset < 0x1C0U)) {
        return model.stage[0].word[(offset - 0x1B0U) / 4U];
    }
    if ((offset >= 0x200U) && (offset < 0x220U)) {
        return model.filter[(offset - 0x200U) / 4U];
    }
    return 0U;
}

/* --- registers: what is written --- */

static void violate(bool violates) {
    model.violations += violates ? 1U : 0U;
}

static void write_mcr(uint32_t value) {
    if ((value & ELMOPP_BIT(15U)) != 0U) {
        model.mcr = MCR_AFTER_RESET;
        model.initialising = false;
        model.asleep = true;
        model.stages = 0U;
        return;
    }
    violate((value & 3U) == 3U);                                /* asleep and initialising */
    violate((value & (ELMOPP_BIT(6U) | ELMOPP_BIT(2U))) != 0U); /* back from bus-off by itself; in order of requests */
    model.mcr = value;
}

static void write_tsr(uint32_t value) {
    for (uint32_t m = 0U; m < ELMOPP_BXCAN_MAILBOXES; m++) {
        mailbox_t *mailbox = &model.mailbox[m];
        const uint32_t bits = value >> (8U * m);
        if ((bits & 1U) != 0U) {
            mailbox->status = 0U;
        }
        if (((bits & ELMOPP_BIT(7U)) != 0U) && mailbox->pending) {
            mailbox->aborting = true;
            if (model.sender != m) {
                empty(mailbox, 0U);
            }
        }
    }
}

static void write_rf0r(uint32_t value) {
    if ((value & ELMOPP_BIT(4U)) != 0U) {
        model.overrun = false;
    }
    if ((value & ELMOPP_BIT(5U)) != 0U) {
        model.release_hangs = suffers(BXCAN_FAULT_RELEASE);
        if (!model.release_hangs) {
            release_stage();
        }
    }
}

static void write_low(uint32_t offset, uint32_t value) {
    switch (offset) {
    case 0x00U:
        write_mcr(value);
        break;
    case 0x08U:
        write_tsr(value);
        break;
    case 0x0CU:
        write_rf0r(value);
        break;
    case 0x14U:
        model.ier = value;
        break;
    case 0x1CU:
        violate(!model.initialising);
        model.btr = model.initialising ? value : model.btr;
        break;
    default:
        violate(true);
        break;
    }
}

static void write_mailbox(uint32_t offset, uint32_t value) {
    mailbox_t *mailbox = &model.mailbox[offset / 16U];
    violate(mailbox->pending);
    if (!mailbox->pending) {
        mailbox->word[(offset % 16U) / 4U] = value;
        mailbox->pending = ((offset % 16U) == 0U) && ((value & 1U) != 0U);
        violate(mailbox->pending && (!takes_part()) && (!model.off));
    }
}

static void write_filter(uint32_t offset, uint32_t value) {
    const bool changing = (model.filter[0] & 1U) != 0U;
    if (offset < 0x220U) {
        const uint32_t index = (offset - 0x200U) / 4U;
        violate((index != 0U) && (index != 7U) && (!changing));
        model.filter[index] = value;
    } else {
        const uint32_t index = (offset - 0x240U) / 4U;
        violate((!changing) && (((model.filter[7] >> (index / 2U)) & 1U) != 0U));
        model.bank[index / 2U][index % 2U] = value;
    }
}

void bxcan_model_write(uint32_t offset, uint32_t value) {
    model.accesses++;
    if (suffers(BXCAN_FAULT_DEAD) || suffers(BXCAN_FAULT_ONES)) {
        return;
    }
    if (offset < 0x180U) {
        write_low(offset, value);
    } else if (offset < 0x1B0U) {
        write_mailbox(offset - 0x180U, value);
    } else if (offset >= 0x200U) {
        write_filter(offset, value);
    } else {
        violate(true); /* what is received cannot be written */
    }
}
