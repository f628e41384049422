#include "proof.h"

#include <avr/pgmspace.h>
#include <stddef.h>

#include "block.h"
#include "config.h"
#include "schedule.h"
#include "stepper.h"
#include "stop.h"
#include "uart.h"

#define IDENTITY_SIZE 32
#define NO_SECTION 0xffffffffUL

static volatile enum { UNKNOWN, PRESENTED, RUNNING } state;
static bool finishing; /* cert_finish came: nothing follows */
static bool presented; /* ever since the reset */
static uint8_t identity[IDENTITY_SIZE];
static uint32_t section = NO_SECTION;
static uint32_t section_clock;
static uint32_t promised;
static uint32_t end;

static uint32_t hash_byte(uint32_t crc, uint8_t byte)
{
    return crc >> 8 ^ pgm_read_dword(&crc_table[(uint8_t)(crc ^ byte)]);
}

static uint32_t hash(uint32_t crc, const void *from, uint8_t size)
{
    const uint8_t *bytes = from;
    while (size-- > 0)
        crc = hash_byte(crc, *bytes++);
    return crc;
}

static uint32_t hash_record(uint32_t crc, const struct record *record)
{
    if (record->count == 0)
        return crc;
    crc = hash_byte(crc, 'R');
    crc = hash(crc, &record->interval, 4);
    crc = hash(crc, &record->count, 4);
    crc = hash(crc, &record->add, 2);
    return hash_byte(crc, record->forward);
}

void proof_made(struct account *account, const struct run *run, uint16_t made)
{
    struct record *open = &account->open;
    uint32_t interval = run->interval & ~BACKWARD;
    bool forward = !(run->interval & BACKWARD);
    account->steps += made;
    if (open->count > 0 && forward == open->forward && run->add == open->add
        && interval == open->interval + open->count * (uint32_t)(int32_t)open->add) {
        open->count += made;
        return;
    }
    account->crc = hash_record(account->crc, open);
    open->interval = interval;
    open->count = made;
    open->add = run->add;
    open->forward = forward;
}

void proof_base(struct account *account, uint32_t clock)
{
    if (state != RUNNING)
        return;
    account->crc = hash_record(account->crc, &account->open);
    account->open.count = 0;
    clock -= section_clock;
    account->crc = hash(hash_byte(account->crc, 'B'), &clock, 4);
}

/* Fires one tick past the promise, before any step of that tick. */
static bool expire(struct timer *timer)
{
    (void)timer;
    stop_from_interrupt(STOP_PROMISE);
    return false;
}

static struct timer promise = {.fire = expire};

static void watch(uint32_t clock)
{
    promised = clock;
    uint8_t before = lock();
    schedule_remove(&promise);
    promise.wake = clock + 1;
    if (clock - clock_locked() > FURTHEST)
        stop_from_interrupt(STOP_PROMISE);
    else
        schedule_add_before_equals(&promise);
    unlock(before);
}

static void unwatch(void)
{
    uint8_t before = lock();
    schedule_remove(&promise);
    unlock(before);
}

void proof_halt(void)
{
    schedule_remove(&promise);
    state = UNKNOWN;
}

void proof_reset(void)
{
    proof_halt();
    presented = false;
    section = NO_SECTION;
}

/* The section ends when its time is over and all motors rest. */
void proof_task(void)
{
    if (state != RUNNING || !finishing || !steppers_idle() || (int32_t)(clock_now() - end) < 0)
        return;
    uint8_t before = lock();
    if (state == RUNNING)
        state = PRESENTED;
    unlock(before);
}

bool proof_allows(void)
{
    if (state == RUNNING && !finishing)
        return true;
    stop(STOP_NOT_CERTIFIED);
    return false;
}

void command_cert_begin(uint32_t *arguments)
{
    proof_task();
    if (arguments[1] != IDENTITY_SIZE || !config_finished() || state == RUNNING || !steppers_idle()) {
        stop(STOP_NOT_CERTIFIED);
        return;
    }
    for (uint8_t i = 0; i < IDENTITY_SIZE; i++)
        identity[i] = rx_at((uint8_t)arguments[0] + i);
    presented = true;
    state = PRESENTED;
}

void command_cert_section(uint32_t *arguments)
{
    proof_task();
    if (state != PRESENTED || !steppers_idle()) {
        stop(STOP_NOT_CERTIFIED);
        return;
    }
    steppers_settle();
    section = arguments[0];
    section_clock = arguments[1];
    uint32_t crc = hash(hash(0xffffffffUL, identity, IDENTITY_SIZE), &section, 4);
    for (struct stepper *stepper = stepper_next(NULL); stepper != NULL; stepper = stepper_next(stepper)) {
        stepper->account.steps = 0;
        stepper->account.crc = crc;
        stepper->account.open.count = 0;
    }
    finishing = false;
    state = RUNNING;
    watch(section_clock);
}

/* True inside a section; otherwise the board stops. */
static bool inside(void)
{
    proof_task();
    if (state == RUNNING)
        return true;
    stop(STOP_NOT_CERTIFIED);
    return false;
}

void command_cert_commit(uint32_t *arguments)
{
    if (inside())
        watch(arguments[0]);
}

void command_cert_rest(uint32_t *arguments)
{
    (void)arguments;
    if (inside())
        unwatch();
}

void command_cert_finish(uint32_t *arguments)
{
    if (!inside())
        return;
    unwatch();
    end = arguments[0];
    finishing = true;
}

void command_cert_get_state(uint32_t *arguments)
{
    (void)arguments;
    proof_task();
    reply(RESPONSE_cert_state);
    reply_number(stopped ? 3 : state);
    reply_number(section);
    reply_number(promised);
    reply_number(stop_clock());
    reply_end();
}

void command_cert_get_motor(uint32_t *arguments)
{
    struct stepper *stepper = stepper_of(arguments[0]);
    if (stepper == NULL)
        return;
    uint16_t made = stepper_made(stepper);
    struct account account = stepper->account;
    int32_t position = stepper->position;
    if (made > 0) {
        struct run *run = &runs[stepper->first];
        proof_made(&account, run, made);
        position += run->interval & BACKWARD ? -(int32_t)made : (int32_t)made;
    }
    reply(RESPONSE_cert_motor);
    reply_number(arguments[0]);
    reply_number(account.steps);
    reply_number(position);
    reply_number(~hash_record(account.crc, &account.open));
    reply_end();
}

void command_cert_get_identity(uint32_t *arguments)
{
    (void)arguments;
    uint8_t size = presented ? IDENTITY_SIZE : 0;
    reply(RESPONSE_cert_identity);
    reply_byte_string(size);
    for (uint8_t i = 0; i < size; i++)
        reply_raw(identity[i]);
    reply_end();
}
