#include "config.h"

#include <avr/pgmspace.h>
#include <avr/wdt.h>
#include <stddef.h>

#include "block.h"
#include "command.h"
#include "endstop.h"
#include "output.h"
#include "proof.h"
#include "schedule.h"
#include "stepper.h"
#include "stop.h"

struct object {
    uint8_t kind;
    void *data;
};

static struct object *objects;
static uint8_t object_count;
static bool finished;
static uint32_t config_crc;

bool config_finished(void)
{
    return finished;
}

void *object_of(uint8_t oid, enum kind kind)
{
    if (!finished)
        stop(STOP_NOT_CONFIGURED);
    else if (oid >= object_count || objects[oid].kind != kind)
        stop(STOP_OID_TYPE);
    else
        return objects[oid].data;
    return NULL;
}

void *object_new(uint8_t oid, enum kind kind, uint16_t size)
{
    if (finished) {
        stop(STOP_CONFIGURED);
        return NULL;
    }
    if (oid >= object_count || objects[oid].kind != KIND_NONE) {
        stop(STOP_OID);
        return NULL;
    }
    void *data = arena_take(size);
    if (data == NULL) {
        stop(STOP_MEMORY);
        return NULL;
    }
    objects[oid].kind = kind;
    objects[oid].data = data;
    return data;
}

bool output_pin(uint32_t pin, bool high)
{
    if (!pin_claim(pin)) {
        stop(STOP_PIN);
        return false;
    }
    pin_drive(pin, high);
    return true;
}

link_t place_take(void)
{
    link_t place = run_take();
    if (place == NONE) {
        steppers_settle();
        outputs_settle();
        place = run_take();
    }
    if (place == NONE)
        stop(STOP_OVERFLOW);
    return place;
}

void command_identify(uint32_t *arguments)
{
    uint32_t offset = arguments[0];
    uint8_t count = arguments[1];
    if (count > 40)
        count = 40;
    if (offset >= DICTIONARY_SIZE)
        count = 0;
    else if (count > DICTIONARY_SIZE - offset)
        count = DICTIONARY_SIZE - offset;
    reply(RESPONSE_identify_response);
    reply_number(offset);
    reply_byte_string(count);
    for (uint8_t i = 0; i < count; i++)
        reply_raw(pgm_read_byte(&dictionary[(uint16_t)offset + i]));
    reply_end();
}

void command_get_config(uint32_t *arguments)
{
    (void)arguments;
    reply(RESPONSE_config);
    reply_number(finished);
    reply_number(config_crc);
    reply_number(stopped != 0);
    reply_number(run_places);
    reply_end();
}

void command_allocate_oids(uint32_t *arguments)
{
    uint8_t count = arguments[0];
    if (objects != NULL) {
        stop(STOP_OIDS_ALLOCATED);
        return;
    }
    objects = arena_take(count * sizeof *objects);
    if (objects == NULL)
        stop(STOP_MEMORY);
    else
        object_count = count;
}

void command_finalize_config(uint32_t *arguments)
{
    if (finished) {
        stop(STOP_CONFIGURED);
        return;
    }
    if (!arena_finish()) {
        stop(STOP_MEMORY);
        return;
    }
    config_crc = arguments[0];
    finished = true;
}

void command_config_reset(uint32_t *arguments)
{
    (void)arguments;
    if (!stopped) {
        stop(STOP_RESET);
        return;
    }
    uint8_t before = lock();
    schedule_clear();
    steppers_reset();
    outputs_reset();
    endstops_reset();
    proof_reset();
    pins_release();
    unlock(before);
    objects = NULL;
    object_count = 0;
    config_crc = 0;
    finished = false;
    arena_reset();
    stopped = 0;
}

void command_reset(uint32_t *arguments)
{
    (void)arguments;
    stop(STOP_COMMAND);
    cli();
    wdt_enable(WDTO_15MS);
    for (;;) {
    }
}

void command_get_clock(uint32_t *arguments)
{
    (void)arguments;
    reply(RESPONSE_clock);
    reply_number(clock_now());
    reply_end();
}

void command_get_uptime(uint32_t *arguments)
{
    (void)arguments;
    uint32_t low, high = clock_high(&low);
    reply(RESPONSE_uptime);
    reply_number(high);
    reply_number(low);
    reply_end();
}
